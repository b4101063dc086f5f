# SPDX-License-Identifier: Apache-2.0
"""The result of an impact at any number of contacts, at one instant or over time.

An answer of `questions` contains it as it is, and a message has its fields. One contact in space or in the
plane has a result of its own (`spatial.result`, `planar.result`), which costs less and says more of the
contact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.impact.law import ImpactOutcome, PathEvent, RestitutionLaw
from contact_dynamics.records import NamedInt, Record
from contact_dynamics.rigid_body.body import BodyState, MassProperties, kinetic_energy
from contact_dynamics.validation import FloatArray

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.impact.spatial.result import SpatialImpact


class SeveralContactsLaw(NamedInt):
    """Law for several contacts at one instant: one after the other, or all at once."""

    SEQUENTIAL = 0
    SIMULTANEOUS = 1


class SequenceEnd(NamedInt):
    """Reason for the end of a sequence of impacts."""

    NOTHING_STRIKES = 0
    """There is no impact within the window after the last one. The body flies, and may land later."""
    STAYS = 1
    """A contact neither approaches nor separates, and free motion would penetrate, so the flight is over."""
    CHATTERS = 2
    """The rebounds of a contact decrease by a constant ratio. Infinitely many impacts accumulate
    at the limit time, and from then on the contact stays closed."""
    MAX_STRIKES = 3
    """The limit on the number of impacts was reached."""
    WINDOW_ENDED = 4
    """There is no impact within the window after the initial state. The body may land later."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SequenceStrike(Record):
    """One impact of a sequence over time.

    Attributes:
        seconds: Time of the impact, s after the initial state's stamp; in an answer, s after the first one.
        contact: Index into the contacts of the sequence.
        outcome: Motion of the contact during the impact.
        p_WC_W: (3,), m, position of the contact at that time, world.
        impulse_W: (3,), N s, impulse on the body, world axes.
        state_before: State of the body just before the impact, stamped with its time.
        state_after: State of the body just after the impact. Contacts of equal approach speed are resolved
            together, and share it.
    """

    seconds: float
    contact: int
    outcome: ImpactOutcome
    p_WC_W: FloatArray
    impulse_W: FloatArray
    state_before: BodyState
    state_after: BodyState


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ResolvedImpact(Record):
    """Result of an impact. Row i of an array belongs to contact i, and vectors are in world axes.

    Attributes:
        restitution_law: Law of restitution.
        several_contacts_law: Law for several contacts.
        outcome: Motion of the contact, or of the contact with the largest impulse if there are several. None
            if the law does not define it (SIMULTANEOUS).
        jams: Whether sliding drove this contact into compression although it did not approach.
        converged: Whether the law converged. If false, it reached its limit on impacts or iterations, and the
            states are the last ones.
        states: State of each body just after the impact: the pose before it, with the new velocities.
        impulses_W: (n, 3), N s, impulses on the first body of each contact.
        compression_impulses_W: (n, 3), N s, impulses up to the end of compression. It has no rows if the law
            does not define them.
        velocities_before_W: (n, 3), m/s, velocities of the contact points just before the impact, relative to
            what they touch.
        velocities_after_W: (n, 3), m/s, velocities of the contact points just after the impact.
        path_W: (k, 3), N s, vertices of the impulse path. Impacts in sequence are listed one after the other,
            each from the impulse that its contact had before. It has no rows if the law does not define a
            path.
        path_events: (k,), event at each vertex. START begins the impact of one contact.
        path_contacts: (k,), index of the contact of each vertex.
        kinetic_energy_before: J, kinetic energy of all moving bodies just before the impact.
        kinetic_energy_after: J, the same just after the impact.
        creates_energy: Whether the energy increased by more than rounding error, apart from the work of
            moving surfaces.
        order_is_open: Whether several contacts approached at the same time under SEQUENTIAL, so that
            rigid-body mechanics also admits other orders. `outcomes_over_orders` returns their outcomes. A
            response has a warning instead.
        orders: (m,), contacts that struck, for each admissible order. Empty if not requested.
        order_velocities_W: (m, 6), m/s and rad/s, linear then angular velocity after each order.
        orders_complete: Whether every order was tried. False if not requested.
        orders_not_converged: Number of orders that are omitted because they reached the limit on impacts.
        covariance: (12, 12), covariance of the state just after the impact, in the order of `UncertainState`,
            or None if not requested.
        outcome_probabilities: (7,), probability of each outcome, by its value, or None if not requested.
        miss_probability: Probability that the contact separates, without an impact, or NaN if not requested.
        strikes: Impacts in the order of time. Empty if all impacts are simultaneous.
        end: Reason for which there is no further impact, or None if all impacts are simultaneous.
        staying: Indices of the contacts that stay closed at the end.
        limit_seconds: Time from which they stay closed, on the clock of ``strikes``, or None if none does.
    """

    restitution_law: RestitutionLaw
    several_contacts_law: SeveralContactsLaw
    outcome: ImpactOutcome | None = None
    jams: bool = False
    converged: bool
    states: tuple[BodyState, ...]
    impulses_W: FloatArray
    compression_impulses_W: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))
    velocities_before_W: FloatArray
    velocities_after_W: FloatArray
    path_W: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))
    path_events: tuple[PathEvent, ...] = ()
    path_contacts: tuple[int, ...] = ()
    kinetic_energy_before: float
    kinetic_energy_after: float
    creates_energy: bool
    order_is_open: bool = False
    orders: tuple[tuple[int, ...], ...] = ()
    order_velocities_W: FloatArray = field(default_factory=lambda: np.zeros((0, 6)))
    orders_complete: bool = False
    orders_not_converged: int = 0
    covariance: FloatArray | None = None
    outcome_probabilities: FloatArray | None = None
    miss_probability: float = math.nan
    strikes: tuple[SequenceStrike, ...] = ()
    end: SequenceEnd | None = None
    staying: tuple[int, ...] = ()
    limit_seconds: float | None = None

    @property
    def state(self) -> BodyState:
        """Return the state of the only body, or of the first one, just after the impact."""
        return self.states[0]

    @property
    def other_state(self) -> BodyState | None:
        """Return the state of the second body just after the impact, or None if there is one body."""
        return self.states[1] if len(self.states) > 1 else None

    @property
    def order(self) -> tuple[int, ...]:
        """Return the contacts that were struck, in order. SIMULTANEOUS strikes none in turn."""
        vertices = zip(self.path_contacts, self.path_events, strict=True)
        return tuple(contact for contact, event in vertices if event is PathEvent.START)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ImpactSequence(ResolvedImpact):
    """Impacts of a landing at separate times, with free flight between them.

    `ResolvedImpact` documents the other fields. Impulses are sums over all impacts of a contact, velocities
    those before its first and after its last impact.

    Attributes:
        contacts: The given contacts. If contacts were detected from the shape, those with an impact or that
            stay closed, each at the position of the first such event.
        end: Reason for which there is no further impact.
    """

    contacts: ContactSet
    end: SequenceEnd

    @property
    def seconds(self) -> float:
        """Return the time of the last impact, s after the initial state's stamp, or 0 without an impact."""
        return self.strikes[-1].seconds if self.strikes else 0.0


def in_terms_of_strikes(
    strikes: Sequence[tuple[int, SpatialImpact]],
    bodies: Sequence[MassProperties],
    before: Sequence[BodyState],
    after: Sequence[BodyState],
    *,
    count: int,
) -> dict[str, Any]:
    """Return the fields of a `ResolvedImpact` that follow from impacts one after the other, and from states.

    Each impact, with the index of its contact among ``count``, comes in order. ``before`` and ``after`` are
    the states of all bodies. The outcome is that of the largest impulse.
    """
    total, compression = np.zeros((2, count, 3))
    path = []
    for contact, strike in strikes:
        path.append(total[contact] + strike.path_W)
        total[contact] += strike.impulse_W
        compression[contact] += strike.compression_W
    found: dict[str, Any] = {
        "states": tuple(after),
        "kinetic_energy_before": sum(map(kinetic_energy, bodies, before)),
        "kinetic_energy_after": sum(map(kinetic_energy, bodies, after)),
        "impulses_W": total,
    }
    if strikes:
        hardest = max((one for _, one in strikes), key=lambda each: float(each.impulse_W @ each.impulse_W))
        found |= {
            "outcome": hardest.outcome,
            "jams": hardest.jams,
            "compression_impulses_W": compression,
            "path_W": np.concatenate(path),
            "path_events": tuple(event for _, strike in strikes for event in strike.path_events),
            "path_contacts": tuple(contact for contact, strike in strikes for _ in strike.path_events),
        }
    return found


def of_one_contact(
    impact: SpatialImpact, bodies: Sequence[MassProperties], before: Sequence[BodyState]
) -> ResolvedImpact:
    """Return an impact at one contact in space, of a body with the world or with another body."""
    after = (impact.state,) if impact.other_state is None else (impact.state, impact.other_state)
    return ResolvedImpact(
        restitution_law=impact.restitution_law,
        several_contacts_law=SeveralContactsLaw.SEQUENTIAL,
        outcome=impact.outcome,
        jams=impact.jams,
        converged=True,
        states=after,
        impulses_W=impact.impulse_W[None],
        compression_impulses_W=impact.compression_W[None],
        velocities_before_W=impact.velocity_before_W[None],
        velocities_after_W=impact.velocity_after_W[None],
        path_W=impact.path_W,
        path_events=impact.path_events,
        path_contacts=(0,) * len(impact.path_events),
        kinetic_energy_before=sum(map(kinetic_energy, bodies, before)),
        kinetic_energy_after=sum(map(kinetic_energy, bodies, after)),
        creates_energy=impact.creates_energy,
    )
