"""What an impact at several contacts comes to, of one body or of several, and the laws' names."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.spatial.result import SpatialImpact
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.validation import FloatArray


class SeveralContactsLaw(IntEnum):
    """The law for several contacts at once."""

    SEQUENTIAL = 0
    SIMULTANEOUS = 1


class SeveralVerdict(IntEnum):
    """Whether the law has an answer."""

    RESOLVED = 0
    """No contact approaches afterwards."""
    NOT_CONVERGED = 1
    """The bound on strikes or iterations was reached; the state is the last one."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SeveralImpact:
    """The answer for several contacts; contact i is row i, impulses act on the body, axes are the world's."""

    several_contacts_law: SeveralContactsLaw  # the law for several contacts
    restitution_law: RestitutionLaw  # the law of restitution
    verdict: SeveralVerdict  # whether the answer holds
    state: BodyState  # afterwards: the pose of before, new velocities
    impulses_W: FloatArray  # (n, 3), N s, total
    velocities_before_W: FloatArray  # (n, 3), m/s, of the contacts
    velocities_after_W: FloatArray  # (n, 3), m/s, of the contacts
    strikes: tuple[tuple[int, SpatialImpact], ...]  # sequential: each contact struck, in order, its impact

    @property
    def order(self) -> tuple[int, ...]:
        """Return the contacts that were struck, in order; empty for a simultaneous law."""
        return tuple(contact for contact, _ in self.strikes)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BodiesImpact:
    """The answer for several contacts of several bodies; contact i is row i, axes are the world's."""

    several_contacts_law: SeveralContactsLaw  # the law for several contacts
    restitution_law: RestitutionLaw  # the law of restitution
    verdict: SeveralVerdict  # whether the answer holds
    states: tuple[BodyState, ...]  # of each body afterwards: the pose of before, new velocities
    impulses_W: FloatArray  # (n, 3), N s, total, on the first body of each contact
    velocities_before_W: FloatArray  # (n, 3), m/s, of the first body's point relative to the second's
    velocities_after_W: FloatArray  # (n, 3), m/s, likewise
    strikes: tuple[tuple[int, SpatialImpact], ...]  # sequential: each contact struck, in order, its impact

    @property
    def order(self) -> tuple[int, ...]:
        """Return the contacts that were struck, in order; empty for a simultaneous law."""
        return tuple(contact for contact, _ in self.strikes)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class OrderedOutcomes:
    """What the sequential law comes to over its admissible orders; row i belongs to order i."""

    orders: tuple[tuple[int, ...], ...]  # the contacts struck, in order
    velocities_W: FloatArray  # (m, 6), m/s and rad/s, linear then angular velocity afterwards, world axes
    complete: bool  # whether every priority of the contacts was tried
    not_converged: int  # how many sequences were left out because they reached the bound on strikes

    @property
    def spread(self) -> FloatArray:
        """Return the largest difference between outcomes, (6,), m/s and rad/s, axis by axis."""
        spread: FloatArray = np.ptp(self.velocities_W, axis=0)
        return spread
