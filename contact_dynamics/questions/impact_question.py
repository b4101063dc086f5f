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
    """One impact of a sequence over time.

    Attributes:
        seconds: Time of the impact, s after the first one.
        contact: Index into the answer's contacts.
        outcome: Motion of the contact during the impact.
        p_WC_W: (3,), m, position of the contact at that time, world.
        impulse_W: (3,), N s, impulse on the body, world axes.
        state_before: State of the body just before the impact.
        state_after: State of the body just after the impact.
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
        converged: Whether the law converged. If false, it reached its iteration limit, and the state is the
            last one.
        state: State of the body just after the impact: the pose before it, with the new velocities.
        other_state: State of the second body just after the impact, or None if the contact is with the world.
        impulses_W: (n, 3), N s, impulses on the body.
        compression_impulses_W: (n, 3), N s, impulses up to the end of compression. It has no rows if the law
            does not define them.
        velocities_before_W: (n, 3), m/s, velocities of the contact points just before the impact, relative to
            what they touch.
        velocities_after_W: (n, 3), m/s, the same velocities just after the impact.
        path_W: (k, 3), N s, vertices of the impulse path. Impacts in sequence are listed one after the other,
            each from the impulse that its contact had before. It has no rows if the law does not define a
            path.
        path_events: (k,), event at each vertex.
        path_contacts: (k,), index of the contact of each vertex.
        kinetic_energy_before: J, kinetic energy of all moving bodies just before the impact.
        kinetic_energy_after: J, the same just after the impact.
        creates_energy: Whether the energy increased by more than rounding error.
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
        limit_seconds: Time from which they stay closed, s after the first impact, or None if none does.
    """

    restitution_law: RestitutionLaw
    several_contacts_law: SeveralContactsLaw = SeveralContactsLaw.SEQUENTIAL
    outcome: ImpactOutcome | None = None
    jams: bool = False
    converged: bool = True
    state: BodyState
    other_state: BodyState | None = None
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
    """Second body of an impact, just before it.

    Attributes:
        name: Name of the body, which may be empty.
        p_FB_F: (3,), m, centre of mass in the published frame F.
        state: State just before the impact.
    """

    name: str
    p_FB_F: FloatArray
    state: BodyState


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ImpactAnswer(Answer):
    """Impact, with the state and the contacts just before it.

    Attributes:
        body_name: Name of the body, which may be empty.
        p_FB_F: (3,), m, centre of mass in the published frame F.
        state: State just before the impact, or before the first of several impacts over time.
        fit: Quality of the fit to published states, or None without a fit.
        other: Second body just before the impact, or None if the body hits the world. Its state after the
            impact is in ``impact``.
        seconds_to_contact: Time from the question's state to the impact, s. It is zero if the body already
            touches.
        contacts: Contacts of the impact. For impacts over time, these are the contacts with an impact or that
            stay closed.
        impact: Result of the impact.
        problem: PLANAR or SPATIAL.
        plane: Plane of motion, or None for a spatial problem.
        out_of_plane: m/s, largest motion out of the plane, or NaN for a spatial problem.
        velocity_tolerance: m/s, tolerance that was used.
        distance_tolerance: m, tolerance that was used.
        warnings: Texts about limited validity: an order of impacts that mechanics does not determine, or a
            contact outside the body's shape.
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
        """Return the stamp of the question's state, ns, or 0 without one."""
        stamp_ns = self.state.stamp_ns
        return stamp_ns and ns_after(stamp_ns, -self.seconds_to_contact)

    @property
    def predicted_state(self) -> BodyState:
        """Return the state just after the impact."""
        return self.impact.state

    @property
    def is_after_impact(self) -> bool:
        """Return whether the predicted state is just after an impact, which is true."""
        return True


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class InTime(Record):
    """Law for impacts of several contacts over time, with free flight between them.

    Attributes:
        strike_window: s, > 0. Longest flight between two impacts of one landing.
        max_strikes: Largest number of impacts, >= 1.
        hold_step: s, > 0. Time step with which the sequence continues if a contact stays closed, until
            another corner touches or the contact separates. If it is None, the sequence ends there.

    Raises:
        InvalidFieldError: a number is out of range or not finite.
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
    """Question about the velocities of a body just after an impact.

    Attributes:
        body: The body, or the name of a body of the context's world.
        state: State of the body, with or without a covariance, or a reference to a published state.
        other: Second moving body that the first one hits, or None if it hits the world.
        other_state: State of the second body.
        contacts: Contacts in the given state. If it is None, the flight to the first contact with the
            context's world is predicted, and the impact there.
        horizon: s, >= 0. Look-ahead time for the first contact. None means the default.
        restitution_law: Law of restitution.
        several_contacts_law: Law for several contacts, such as those of an edge or a face that lands: at one
            instant, or `InTime`.
        include_orders: Whether the answer lists the outcomes over the admissible orders of several contacts.
        include_covariance: Whether to propagate the state's covariance through flight and impact. The answer
            contains no standard deviation of the time of impact.
        problem: Whether to solve a planar or a spatial problem.
        plane: Plane of motion of a planar problem. If it is None, the plane that fits best is used.
        out_of_plane_tolerance: m/s, >= 0. Largest motion out of the plane that counts as planar. None means
            the default.
        velocity_tolerance: m/s, >= 0. Approach speed up to which a contact has no impact. None means the
            default.
        distance_tolerance: m, >= 0. Largest gap at which a body counts as touching. None means the default.

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
