"""One impact as an answer tells it, by whichever law and at however many contacts it was resolved.

The impact chapter has a result of its own for one contact and for several, in the plane and in space, for one
body and for two. An answer tells all of them in the same words, in world axes.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from contact_dynamics.impact import ImpactOutcome, PathEvent, RestitutionLaw, SequenceEnd, SeveralContactsLaw
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.validation import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SequenceStrike(Record):
    """One strike of several in time.

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
    """What an impact comes to; row i of an array belongs to contact i, axes are the world's.

    Attributes:
        restitution_law: What the coefficients of restitution meant.
        several_contacts_law: The law for several contacts of one instant.
        outcome: What the contact did; of several, the one with the largest impulse. None: the law does not
            tell (SIMULTANEOUS).
        jams: Whether sliding drove that contact into compression though it did not approach.
        converged: Whether the law came to an end. False: it reached its bound, and the state is the last one.
        state: The body just after: the pose of before, new velocities.
        other_state: The second body just after. None: the contact is with the world.
        impulses_W: (n, 3), N s, on the body.
        compression_impulses_W: (n, 3), N s, up to the end of compression. Without rows where the law does not
            tell.
        velocities_before_W: (n, 3), m/s, of the contact points relative to what they touch.
        velocities_after_W: (n, 3), m/s, likewise.
        path_W: (k, 3), N s, vertices of the impulse path; of several strikes one after the other, each from
            what its contact had before. Without rows where the law does not tell.
        path_events: (k,), what each vertex stands for.
        path_contacts: (k,), the contact that each vertex belongs to.
        kinetic_energy_before: J, of all bodies that move.
        kinetic_energy_after: J, likewise.
        creates_energy: Whether the law made energy out of nothing, beyond rounding.
        orders: (m,), the contacts struck, in each admissible order. Empty: not asked for.
        order_velocities_W: (m, 6), m/s and rad/s, linear then angular velocity after each order.
        covariance: (12, 12), of the state just after, in the order of `UncertainState`. None: not asked for.
        outcome_probabilities: (7,), of each outcome, by its value. None: not asked for.
        miss_probability: Probability that the contact separates, so that nothing strikes.
        strikes: Strikes in time, in their order. Empty: all happened at one instant.
        end: Why there is no further strike. None: all happened at one instant.
        staying: The contacts that stay from then on.
        limit_seconds: s after the first strike, from when on they stay. None: none does.
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
    covariance: FloatArray | None = None
    outcome_probabilities: FloatArray | None = None
    miss_probability: float = 0.0
    strikes: tuple[SequenceStrike, ...] = ()
    end: SequenceEnd | None = None
    staying: tuple[int, ...] = ()
    limit_seconds: float | None = None
