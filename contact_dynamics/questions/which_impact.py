"""Which impact a question is about: the bodies, their states just before, the contacts and the laws."""

from __future__ import annotations

from dataclasses import dataclass

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.impact import RestitutionLaw, SeveralContactsLaw
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions.knowledge import check_optional
from contact_dynamics.questions.problem import Problem
from contact_dynamics.questions.subject import NEWEST, StateSource
from contact_dynamics.records import Record
from contact_dynamics.world import Body


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class InTime(Record):
    """The law for several contacts by which they strike one after the other, with free flight in between.

    Attributes:
        strike_window: s, the longest flight after which a strike still belongs to the same landing. None or
            zero: `STRIKE_WINDOW`.
        most_strikes: How many strikes to resolve at most. None or zero: `MOST_STRIKES`.
        hold_step: s. Where a contact stays on its surface, the body goes on in steps of this length until
            another corner strikes or it leaves. None or zero: the sequence ends there.

    Raises:
        InvalidFieldError: a number is negative or not finite.
    """

    strike_window: float | None = None
    most_strikes: int | None = None
    hold_step: float | None = None

    def __post_init__(self) -> None:
        """Check both times."""
        for name in ("strike_window", "hold_step"):
            object.__setattr__(self, name, check_optional(name, getattr(self, name)) or None)
        object.__setattr__(self, "most_strikes", self.most_strikes or None)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ImpactQuestion(Record):
    """Which velocities does a body have just after an impact?

    Attributes:
        body: The body, or the name of one of the known world.
        state: Its state, with a covariance or without, or which published one.
        other: A second moving body that the first one strikes. None: it strikes the world.
        other_state: The second body's state.
        contacts: The contacts, at the state taken. None: the body flies on to its first contact with the
            known world, and the impact is the one that happens there.
        horizon: s, >= 0. How far ahead to look for that first contact. None: the default.
        restitution_law: What the coefficients of restitution mean.
        several_contacts_law: What happens at several contacts: a law for one instant, or strikes in time.
        want_orders: Whether to list the outcomes over the admissible orders of several contacts.
        want_covariance: Whether to carry the state's covariance through flight and impact.
        problem: In a plane of motion, or in space.
        plane: The plane of motion of a planar problem. None: the one that fits best.
        out_of_plane_tolerance: m/s, >= 0. Motion out of the plane up to this counts as planar. None: the
            default.
        velocity_tolerance: m/s, >= 0. A slower approach counts as none. None: the default.
        distance_tolerance: m, >= 0. A body with a smaller gap touches. None: the default.

    Raises:
        InvalidFieldError: a number is negative or not finite.
    """

    body: Body | str
    state: StateSource = NEWEST
    other: Body | str | None = None
    other_state: StateSource = NEWEST
    contacts: ContactSet | None = None
    horizon: float | None = None
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON
    several_contacts_law: SeveralContactsLaw | InTime = SeveralContactsLaw.SEQUENTIAL
    want_orders: bool = False
    want_covariance: bool = False
    problem: Problem = Problem.AUTOMATIC
    plane: PlaneOfMotion | None = None
    out_of_plane_tolerance: float | None = None
    velocity_tolerance: float | None = None
    distance_tolerance: float | None = None

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name in ("horizon", "out_of_plane_tolerance", "velocity_tolerance", "distance_tolerance"):
            object.__setattr__(self, name, check_optional(name, getattr(self, name)))
