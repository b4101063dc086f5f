# SPDX-License-Identifier: Apache-2.0
"""The question about an impact: which velocities does a body have just after it?"""

from __future__ import annotations

from dataclasses import dataclass

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.impact import RestitutionLaw, SeveralContactsLaw
from contact_dynamics.impact.in_time.sequence import MAX_STRIKES, STRIKE_WINDOW
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions.context import check_optional
from contact_dynamics.questions.impact_answer import ImpactAnswer
from contact_dynamics.questions.problem import Problem
from contact_dynamics.questions.services import Question
from contact_dynamics.questions.subject import NEWEST, StateSource
from contact_dynamics.records import Record
from contact_dynamics.validation import check_positive, check_whole
from contact_dynamics.world import Body


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
