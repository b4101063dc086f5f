# SPDX-License-Identifier: Apache-2.0
"""Every impact in an answer has one form, whichever law resolved it and at however many contacts.

The impact chapter has separate results for one contact and for several, in the plane and in space, for one
body and for two. An answer gives all of them in one form, in world axes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from contact_dynamics.impact import (
    ImpactOutcome,
    PathEvent,
    RestitutionLaw,
    SequenceEnd,
    SeveralContactsLaw,
)
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.validation import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SequenceStrike(Record):
    """One of several strikes in time.

    Attributes:
        seconds: s after the first strike.
        contact: Index into the answer's contacts.
        outcome: What the contact did.
        p_WC_W: (3,), m, where the contact is then, world.
        impulse_W: (3,), N s, on the body, world axes.
        state_before: The body just before.
        state_after: The body just after.
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
    """The result of an impact. Row i of an array belongs to contact i, and vectors are in world axes.

    Attributes:
        restitution_law: What the coefficients of restitution meant.
        several_contacts_law: The law for several contacts of one instant.
        outcome: What the contact did, or the contact with the largest impulse if there are several. It is
            None if the law does not say (SIMULTANEOUS).
        jams: Whether sliding drove that contact into compression although it did not approach.
        converged: Whether the law came to an end. If not, it reached its bound, and the state is the last
            one.
        state: The body just after, with the pose from before and new velocities.
        other_state: The second body just after, or None if the contact is with the world.
        impulses_W: (n, 3), N s, on the body.
        compression_impulses_W: (n, 3), N s, up to the end of compression. It has no rows if the law does not
            say.
        velocities_before_W: (n, 3), m/s, of the contact points relative to what they touch, just before.
        velocities_after_W: (n, 3), m/s, the same just after.
        path_W: (k, 3), N s, vertices of the impulse path. Several strikes come one after the other, each from
            the impulse that its contact had before. It has no rows if the law does not say.
        path_events: (k,), what each vertex stands for.
        path_contacts: (k,), the contact that each vertex belongs to.
        kinetic_energy_before: J, of all bodies that move, just before.
        kinetic_energy_after: J, the same just after.
        creates_energy: Whether there is more energy after the impact than before, beyond rounding.
        orders: (m,), the contacts struck, in each admissible order. It is empty if that was not asked for.
        order_velocities_W: (m, 6), m/s and rad/s, linear then angular velocity after each order.
        orders_complete: Whether every order was tried. It is False if that was not asked for.
        orders_not_converged: How many orders were left out because they reached the bound on strikes.
        covariance: (12, 12), of the state just after, in the order of `UncertainState`, or None if that was
            not asked for.
        outcome_probabilities: (7,), the probability of each outcome, by its value, or None if that was not
            asked for.
        miss_probability: Probability that the contact separates, so that nothing strikes, or NaN if that was
            not asked for.
        strikes: Strikes in time, in their order. It is empty if all happened at one instant.
        end: Why there is no further strike, or None if all happened at one instant.
        staying: The contacts that stay from then on.
        limit_seconds: The time from which on they stay, s after the first strike, or None if none stays.
    """

    restitution_law: RestitutionLaw
    several_contacts_law: SeveralContactsLaw
    outcome: ImpactOutcome | None
    jams: bool
    converged: bool
    state: BodyState
    other_state: BodyState | None = None
    impulses_W: FloatArray
    compression_impulses_W: FloatArray
    velocities_before_W: FloatArray
    velocities_after_W: FloatArray
    path_W: FloatArray
    path_events: tuple[PathEvent, ...]
    path_contacts: tuple[int, ...]
    kinetic_energy_before: float
    kinetic_energy_after: float
    creates_energy: bool
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Before(Record):
    """A body just before an impact: its mass properties and its state.

    Attributes:
        body: Mass and angular inertia.
        state: Its state.
    """

    body: MassProperties
    state: BodyState
