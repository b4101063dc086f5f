# SPDX-License-Identifier: Apache-2.0
"""The question about an impact, its answer, and the one form that the results of all impacts have in answers.

The impact chapter has separate results for one contact and for several, in the plane and in space, for one
body and for two. An answer gives all of them as a `ResolvedImpact`, in world axes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from contact_dynamics.constants import ns_after
from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.impact import (
    ImpactOutcome,
    PathEvent,
    RestitutionLaw,
    SequenceEnd,
    SeveralContactsLaw,
)
from contact_dynamics.impact.in_time.sequence import MAX_STRIKES, STRIKE_WINDOW
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions.context import check_optional
from contact_dynamics.questions.plane_of_motion import Problem
from contact_dynamics.questions.services import Answer, Question
from contact_dynamics.questions.subject import NEWEST, FitQuality, StateSource
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.validation import FloatArray, check_positive, check_whole
from contact_dynamics.world import Body


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
class StruckBody(Record):
    """The second body of an impact, just before it.

    Attributes:
        name: The body's name, which may be empty.
        p_FB_F: (3,), m, its centre of mass in its published frame F.
        state: Its state just before the impact.
    """

    name: str
    p_FB_F: FloatArray
    state: BodyState


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ImpactAnswer(Answer):
    """The impact, and the state and contacts just before it.

    Attributes:
        body_name: The body's name, which may be empty.
        p_FB_F: (3,), m, its centre of mass in its published frame F.
        state: Its state just before the impact, or before the first of several strikes in time.
        fit: How well the motion fits the published states that the state was found from, or None without a
            fit.
        other: The second body just before, or None if the world is struck. Its state after the impact is in
            ``impact``.
        seconds_to_contact: s, from the question's state to the impact. It is zero if the body touches
            already.
        contacts: The contacts. For strikes in time, these are the contacts that strike or stay.
        impact: The result of the impact.
        problem: PLANAR or SPATIAL.
        plane: The plane of motion, or None in space.
        out_of_plane: m/s, the largest motion out of the plane, or NaN in space.
        velocity_tolerance: m/s, the tolerance that was used.
        distance_tolerance: m, the tolerance that was used.
        warnings: What makes the answer doubtful, in words: an order of strikes that mechanics does not
            decide, a contact outside of the body's shape.
    """

    body_name: str
    p_FB_F: FloatArray
    state: BodyState
    fit: FitQuality | None
    other: StruckBody | None
    seconds_to_contact: float
    contacts: ContactSet
    impact: ResolvedImpact
    problem: Problem
    plane: PlaneOfMotion | None
    out_of_plane: float
    velocity_tolerance: float
    distance_tolerance: float
    warnings: tuple[str, ...] = ()

    @property
    def stamp_ns(self) -> int:
        """The stamp, ns, of the state that the question was about, or 0 without one."""
        stamp_ns = self.state.stamp_ns
        return stamp_ns and ns_after(stamp_ns, -self.seconds_to_contact)

    @property
    def predicted_state(self) -> BodyState:
        """The state just after the impact."""
        return self.impact.state

    @property
    def is_after_impact(self) -> bool:
        """Whether the predicted state is just after an impact, which it is."""
        return True


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class InTime(Record):
    """A law for several contacts. They strike one after the other, with free flight in between.

    Attributes:
        strike_window: s, > 0. The longest flight after which a strike still belongs to the same landing.
        max_strikes: How many strikes are resolved at most, >= 1.
        hold_step: s, > 0. Where a contact stays on its surface, the body goes on in steps of this length
            until another corner strikes or it leaves. If it is None, the sequence ends there.

    Raises:
        InvalidFieldError: a number is out of its range or not finite.
    """

    strike_window: float = STRIKE_WINDOW
    max_strikes: int = MAX_STRIKES
    hold_step: float | None = None

    def __post_init__(self) -> None:
        """Check the three numbers."""
        object.__setattr__(self, "strike_window", check_positive("strike_window", self.strike_window))
        object.__setattr__(self, "max_strikes", check_whole("max_strikes", self.max_strikes, 1))
        if self.hold_step is not None:
            object.__setattr__(self, "hold_step", check_positive("hold_step", self.hold_step))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ImpactQuestion(Question[ImpactAnswer]):
    """Which velocities does a body have just after an impact?

    Attributes:
        body: The body, or the name of one of the known world.
        state: Its state, with or without a covariance, or a reference to a published one.
        other: A second moving body that the first one strikes, or None if it strikes the world.
        other_state: The second body's state.
        contacts: The contacts in the given state. If it is None, the body flies on to its first contact with
            the known world, and the question is about the impact there.
        horizon: s, >= 0. How far ahead to look for that first contact. None means the default.
        restitution_law: What the coefficients of restitution mean.
        several_contacts_law: The law for several contacts, which is one for a single instant, or strikes in
            time.
        include_orders: Whether the answer lists the outcomes over the admissible orders of several contacts.
        include_covariance: Whether the state's covariance is carried through flight and impact.
        problem: Whether to solve the problem in a plane of motion or in space.
        plane: The plane of motion of a planar problem. If it is None, the best fitting plane is found.
        out_of_plane_tolerance: m/s, >= 0. Motion out of the plane up to this counts as planar. None means the
            default.
        velocity_tolerance: m/s, >= 0. A slower approach counts as none. None means the default.
        distance_tolerance: m, >= 0. A body with a smaller gap touches. None means the default.

    Raises:
        InvalidFieldError: a number is negative or not finite, or a choice is not a member of its enumeration.
    """

    body: Body | str
    state: StateSource = NEWEST
    other: Body | str | None = None
    other_state: StateSource = NEWEST
    contacts: ContactSet | None = None
    horizon: float | None = None
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON
    several_contacts_law: SeveralContactsLaw | InTime = SeveralContactsLaw.SEQUENTIAL
    include_orders: bool = False
    include_covariance: bool = False
    problem: Problem = Problem.AUTOMATIC
    plane: PlaneOfMotion | None = None
    out_of_plane_tolerance: float | None = None
    velocity_tolerance: float | None = None
    distance_tolerance: float | None = None

    def __post_init__(self) -> None:
        """Check the numbers and the choices."""
        for name in ("horizon", "out_of_plane_tolerance", "velocity_tolerance", "distance_tolerance"):
            object.__setattr__(self, name, check_optional(name, getattr(self, name)))
