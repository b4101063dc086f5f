# SPDX-License-Identifier: Apache-2.0
"""The question about an impact, and its answer."""

from __future__ import annotations

from dataclasses import dataclass

from contact_dynamics.constants import ns_after
from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.impact import ResolvedImpact, RestitutionLaw, SeveralContactsLaw
from contact_dynamics.impact.in_time.sequence import MAX_STRIKES, STRIKE_WINDOW
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions.context import Problem, check_optional, check_read
from contact_dynamics.questions.services import Answer, Question
from contact_dynamics.questions.subject import NEWEST, FitQuality, NamedState, StateSource
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.validation import FloatArray, check_positive, check_whole
from contact_dynamics.world import Body


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
        warnings: Texts about limited validity: an order of impacts that mechanics does not determine, a
            contact outside the body's shape, a body that moves into a surface that it touches elsewhere, or a
            surface whose friction of slow impacts differs in tosses.
    """

    body_name: str
    p_FB_F: FloatArray
    state: BodyState
    fit: FitQuality | None
    other: NamedState | None
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
        other_state: State of the second body, at the time of the first one's. The newest published state is
            moved to that time.
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
        InvalidFieldError: a number is negative or not finite, a choice is not a member of its enumeration, or
            a value would be ignored.
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
        """Check the numbers and the choices, and that no field is ignored."""
        for name in ("horizon", "out_of_plane_tolerance", "velocity_tolerance", "distance_tolerance"):
            object.__setattr__(self, name, check_optional(name, getattr(self, name)))
        stated = None if self.other_state is NEWEST else self.other_state
        check_read("other is given", is_met=self.other is not None, other_state=stated)
        check_read("contacts are detected", is_met=self.contacts is None, horizon=self.horizon)
        in_plane = {"plane": self.plane, "out_of_plane_tolerance": self.out_of_plane_tolerance}
        check_read("problem is PLANAR", is_met=self.problem is Problem.PLANAR, **in_plane)

    @property
    def detects_contacts(self) -> bool:
        """Whether the contacts are not given."""
        return self.contacts is None
