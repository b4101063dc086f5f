# SPDX-License-Identifier: Apache-2.0
"""The result of an impact at several contacts, of one body or of several, and the names of the laws.

`SeveralImpact` and `BodiesImpact` have all fields in common but one, the state or the states. They are two
types, so that a caller with one body does not take it out of a tuple.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from contact_dynamics.impact.energy import energy_change
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.spatial.result import SpatialImpact
from contact_dynamics.records import NamedInt, Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.validation import FloatArray


class SeveralContactsLaw(NamedInt):
    """The law for several contacts at once."""

    SEQUENTIAL = 0
    SIMULTANEOUS = 1


class SeveralVerdict(NamedInt):
    """Whether the law has an answer."""

    RESOLVED = 0
    """No contact approaches afterwards."""
    NOT_CONVERGED = 1
    """The bound on strikes or iterations was reached. The answer's state is the last one."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SeveralImpact(Record):
    """The answer for several contacts of one body. Contact i is row i, and axes are the world's.

    Attributes:
        several_contacts_law: The law for several contacts.
        restitution_law: The law of restitution.
        verdict: Whether the answer holds.
        state: The state afterwards. It has the pose of before and new velocities.
        impulses_W: (n, 3), N s, total impulses on the body.
        velocities_before_W: (n, 3), m/s, velocities of the contacts before.
        velocities_after_W: (n, 3), m/s, velocities of the contacts afterwards.
        strikes: Each contact that was struck, in order, with its impact. Contacts that approach equally fast
            strike as one. They follow each other, each with its share of the impulse and the state after all
            of them. SIMULTANEOUS has none.
        order_is_open: Whether several contacts approached at one time under SEQUENTIAL, so that rigid-body
            mechanics allows other orders. `outcomes_over_orders` gives what they lead to.
    """

    several_contacts_law: SeveralContactsLaw
    restitution_law: RestitutionLaw
    verdict: SeveralVerdict
    state: BodyState
    impulses_W: FloatArray
    velocities_before_W: FloatArray
    velocities_after_W: FloatArray
    strikes: tuple[tuple[int, SpatialImpact], ...]
    order_is_open: bool = False

    @property
    def energy_change(self) -> float:
        """Return the change of kinetic energy, J: the impulses times the contacts' mean velocities."""
        return _energy_change(self)

    @property
    def order(self) -> tuple[int, ...]:
        """Return the contacts that were struck, in order. SIMULTANEOUS strikes none in turn."""
        return tuple(contact for contact, _ in self.strikes)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class BodiesImpact(Record):
    """The answer for several contacts of several bodies. Contact i is row i, and axes are the world's.

    Attributes:
        several_contacts_law: The law for several contacts.
        restitution_law: The law of restitution.
        verdict: Whether the answer holds.
        states: The state of each body afterwards. It has the pose of before and new velocities.
        impulses_W: (n, 3), N s, total impulses on the first body of each contact.
        velocities_before_W: (n, 3), m/s, velocities of the first body's points relative to the second's.
        velocities_after_W: (n, 3), m/s, the same velocities afterwards.
        strikes: Each contact that was struck, in order, with its impact. Contacts that approach equally fast
            strike as one. They follow each other, each with its share of the impulse and the state after all
            of them. SIMULTANEOUS has none.
        order_is_open: Whether several contacts approached at one time under SEQUENTIAL, so that rigid-body
            mechanics allows other orders. `outcomes_over_orders` gives what they lead to.
    """

    several_contacts_law: SeveralContactsLaw
    restitution_law: RestitutionLaw
    verdict: SeveralVerdict
    states: tuple[BodyState, ...]
    impulses_W: FloatArray
    velocities_before_W: FloatArray
    velocities_after_W: FloatArray
    strikes: tuple[tuple[int, SpatialImpact], ...]
    order_is_open: bool = False

    @property
    def energy_change(self) -> float:
        """Return the change of kinetic energy, J: the impulses times the contacts' mean velocities."""
        return _energy_change(self)

    @property
    def order(self) -> tuple[int, ...]:
        """Return the contacts that were struck, in order. SIMULTANEOUS strikes none in turn."""
        return tuple(contact for contact, _ in self.strikes)


def _energy_change(impact: SeveralImpact | BodiesImpact) -> float:
    return math.fsum(
        energy_change(*of_contact)
        for of_contact in zip(
            impact.impulses_W.tolist(),
            impact.velocities_before_W.tolist(),
            impact.velocities_after_W.tolist(),
            strict=True,
        )
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class OrderedOutcomes(Record):
    """The outcomes that a law for several contacts reaches over orders. Row i belongs to order i.

    Attributes:
        orders: The contacts struck in each sequence, or the order that led to a simultaneous solution. It is
            empty for the law's own answer where that has no order, because contacts strike at once.
        velocities_W: (m, 6), m/s and rad/s, linear then angular velocity afterwards, world axes.
        complete: Whether every order of the contacts was tried.
        not_converged: How many orders were left out because they reached the bound on strikes or iterations.
    """

    orders: tuple[tuple[int, ...], ...]
    velocities_W: FloatArray
    complete: bool
    not_converged: int

    @property
    def spread(self) -> FloatArray:
        """Return the largest difference between outcomes, (6,), m/s and rad/s, axis by axis."""
        spread: FloatArray = np.ptp(self.velocities_W, axis=0)
        return spread


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class InterleavedOutcomes(Record):
    """Outcomes of impacts that interleave, some of them and bounds on all. World axes.

    Attributes:
        velocities_W: (m, 6), m/s and rad/s, linear then angular velocity after each interleaving that was
            tried. The first are those of orders of the contacts. The others were drawn.
        lowest_W: (6,), m/s and rad/s. No interleaving leads below it on any axis.
        highest_W: (6,), m/s and rad/s. No interleaving leads above it on any axis.
        not_converged: How many interleavings were left out because they reached the bound on increments.
    """

    velocities_W: FloatArray
    lowest_W: FloatArray
    highest_W: FloatArray
    not_converged: int

    @property
    def spread(self) -> FloatArray:
        """Return the largest difference between outcomes that were found, (6,), m/s and rad/s, by axis."""
        spread: FloatArray = np.ptp(self.velocities_W, axis=0)
        return spread

    @property
    def gap(self) -> FloatArray:
        """Return by how much the bounds are wider than the spread, (6,), m/s and rad/s, axis by axis."""
        gap: FloatArray = self.highest_W - self.lowest_W - self.spread
        return gap
