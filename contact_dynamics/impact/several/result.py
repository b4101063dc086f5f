# SPDX-License-Identifier: Apache-2.0
"""The result of an impact at several contacts, of one body or of several, and the names of the laws.

`SeveralImpact` and `BodiesImpact` are two types, so that a caller with one body does not take its state out
of a tuple.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np

from contact_dynamics.impact.energy import energy_change
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.spatial.result import SpatialImpact
from contact_dynamics.records import NamedInt, Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.validation import FloatArray


class SeveralContactsLaw(NamedInt):
    """Law for several contacts at one instant: one after the other, or all at once."""

    SEQUENTIAL = 0
    SIMULTANEOUS = 1


class SeveralVerdict(NamedInt):
    """Whether the law converged."""

    RESOLVED = 0
    """No contact approaches after the impact."""
    NOT_CONVERGED = 1
    """The limit on strikes or iterations was reached. The state is the last one."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class AtContacts(Record):
    """Outcome of an impact at several contacts, of one body or of several.

    Row i belongs to contact i, and all axes are those of the world.

    Attributes:
        several_contacts_law: Law for several contacts.
        restitution_law: Law of restitution.
        verdict: Whether the law converged.
        impulses_W: (n, 3), N s, total impulses on the first body of each contact.
        velocities_before_W: (n, 3), m/s, velocities of the first body's points relative to the second's, or
            to the surface, before the impact.
        velocities_after_W: (n, 3), m/s, the same velocities after the impact.
        strikes: Contacts that struck, in order, with their impacts. Contacts of equal approach speed strike
            as one: they are listed one after the other, each with its share of the impulse and the state
            after all of them. Empty with SIMULTANEOUS.
        order_is_open: Whether several contacts approached at the same time under SEQUENTIAL, so that
            rigid-body mechanics also admits other orders. `outcomes_over_orders` returns their outcomes.
    """

    several_contacts_law: SeveralContactsLaw
    restitution_law: RestitutionLaw
    verdict: SeveralVerdict
    impulses_W: FloatArray
    velocities_before_W: FloatArray
    velocities_after_W: FloatArray
    strikes: tuple[tuple[int, SpatialImpact], ...]
    order_is_open: bool = False

    @property
    def energy_change(self) -> float:
        """Return the change of kinetic energy, J: the impulses times the contacts' mean velocities.

        The work of moving surfaces, the impulses times their velocities, is not part of it.
        """
        rows = (self.impulses_W, self.velocities_before_W, self.velocities_after_W)
        return math.fsum(energy_change(*each) for each in zip(*(of.tolist() for of in rows), strict=True))

    @property
    def order(self) -> tuple[int, ...]:
        """Return the contacts that were struck, in order. SIMULTANEOUS strikes none in turn."""
        return tuple(contact for contact, _ in self.strikes)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class BodiesImpact(AtContacts):
    """Outcome of an impact at several contacts of several bodies; `AtContacts` documents the other fields.

    Attributes:
        states: State of each body after the impact: the pose before it, with the new velocities.
    """

    states: tuple[BodyState, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SeveralImpact(AtContacts):
    """Outcome of an impact at several contacts of one body; `AtContacts` documents the other fields.

    Attributes:
        state: State after the impact: the pose before it, with the new velocities.
    """

    state: BodyState


def of_only_body(impact: BodiesImpact) -> SeveralImpact:
    """Return the impact of one body, which is the only one."""
    shared = {field.name: getattr(impact, field.name) for field in fields(AtContacts)}
    return SeveralImpact(state=impact.states[0], **shared)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class OrderedOutcomes(Record):
    """Outcomes of a law for several contacts over orders of the contacts. Row i belongs to order i.

    Attributes:
        orders: Contacts that struck in each sequence, or the order that led to a simultaneous solution. Empty
            for the law's own solution if it has no order, because contacts strike at once.
        velocities_W: (m, 6), m/s and rad/s, linear then angular velocity after the impact, world axes.
        complete: Whether every order of the contacts was tried.
        not_converged: Number of orders that are omitted because they reached the limit on strikes or
            iterations.
    """

    orders: tuple[tuple[int, ...], ...]
    velocities_W: FloatArray
    complete: bool
    not_converged: int

    @property
    def spread(self) -> FloatArray:
        """Return the largest difference between outcomes in each component, (6,), m/s and rad/s."""
        spread: FloatArray = np.ptp(self.velocities_W, axis=0)
        return spread


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class InterleavedOutcomes(Record):
    """Outcomes of interleaved impacts, and bounds on the outcomes of all interleavings. World axes.

    Attributes:
        velocities_W: (m, 6), m/s and rad/s, linear then angular velocity after each interleaving that was
            tried. The first rows belong to orders of the contacts, and the others to random interleavings.
        lowest_W: (6,), m/s and rad/s, lower bounds on the components after any interleaving.
        highest_W: (6,), m/s and rad/s, upper bounds on the components after any interleaving.
        not_converged: Number of interleavings that are omitted because they reached the limit on increments.
    """

    velocities_W: FloatArray
    lowest_W: FloatArray
    highest_W: FloatArray
    not_converged: int

    @property
    def spread(self) -> FloatArray:
        """Return the largest difference between the outcomes found, (6,), m/s and rad/s."""
        spread: FloatArray = np.ptp(self.velocities_W, axis=0)
        return spread

    @property
    def gap(self) -> FloatArray:
        """Return the amount by which the bounds are wider than the spread, (6,), m/s and rad/s."""
        gap: FloatArray = self.highest_W - self.lowest_W - self.spread
        return gap
