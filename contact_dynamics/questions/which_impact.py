"""Which impact a question is about: the bodies, their states just before, the contacts and the laws."""

from __future__ import annotations

from dataclasses import dataclass

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.errors import NoContactError, NotSupportedError
from contact_dynamics.impact import RestitutionLaw, SeveralContactsLaw
from contact_dynamics.landing.earliest import next_landing
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions.extent import check_contacts, check_extent
from contact_dynamics.questions.knowledge import Knowledge, check_optional, or_default
from contact_dynamics.questions.problem import Problem
from contact_dynamics.questions.resolved_impact import Before
from contact_dynamics.questions.subject import NEWEST, StateSource, Subject, subject_of
from contact_dynamics.questions.touching import check_has_shape, contacts_of
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.validation import check_choice
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
        InvalidFieldError: a number is negative or not finite, or a choice is no member of its enumeration.
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
        """Check the numbers and the choices."""
        check_choice("problem", self.problem, Problem)
        check_choice("restitution_law", self.restitution_law, RestitutionLaw)
        if not isinstance(self.several_contacts_law, InTime):
            check_choice("several_contacts_law", self.several_contacts_law, SeveralContactsLaw)
        for name in ("horizon", "out_of_plane_tolerance", "velocity_tolerance", "distance_tolerance"):
            object.__setattr__(self, name, check_optional(name, getattr(self, name)))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Strike(Record):
    """An impact that is to be resolved.

    Attributes:
        subject: The first body, in the state that was taken.
        other: The second body. None: the world.
        seconds: s, from that state to the impact.
        state: The first body just before.
        contacts: Where it strikes.
        velocity_tolerance: m/s.
        distance_tolerance: m.
    """

    subject: Subject
    other: Subject | None
    seconds: float
    state: BodyState
    contacts: ContactSet
    velocity_tolerance: float
    distance_tolerance: float

    @property
    def before(self) -> Before:
        """The first body just before."""
        return Before(body=self.subject.body.mass_properties, state=self.state)


def strike_of(question: ImpactQuestion, knowledge: Knowledge) -> Strike:
    """Return the impact that a question means: at the contacts that it names, or at the next landing.

    Raises:
        ContactDynamicsError: nothing strikes, or a part of the question is not known or not supported.
    """
    subject = subject_of(question.body, question.state, knowledge)
    other = None if question.other is None else subject_of(question.other, question.other_state, knowledge)
    for one in (subject, other):
        if one is not None:
            check_extent(one.body.mass_properties, one.state)
    velocity_tolerance = or_default(question.velocity_tolerance, knowledge.defaults.velocity_tolerance)
    distance_tolerance = or_default(question.distance_tolerance, knowledge.defaults.distance_tolerance)
    seconds, state = 0.0, subject.state
    if question.contacts is not None:
        contacts = contacts_of(
            question.contacts, subject, knowledge.world, distance_tolerance=distance_tolerance
        )
    elif other is not None:
        message = "contact_source: found CONTACTS_FROM_GEOMETRY (0) for two bodies, allowed is 1 (explicit)"
        raise NotSupportedError(message)
    else:
        seconds, state, contacts = _landing(
            question,
            subject,
            knowledge,
            velocity_tolerance=velocity_tolerance,
            distance_tolerance=distance_tolerance,
        )
    check_contacts(contacts)
    _check_supported(question, contact_count=len(contacts))
    return Strike(
        subject=subject,
        other=other,
        seconds=seconds,
        state=state,
        contacts=contacts,
        velocity_tolerance=velocity_tolerance,
        distance_tolerance=distance_tolerance,
    )


def _check_supported(question: ImpactQuestion, *, contact_count: int) -> None:
    """Raise `NotSupportedError` for what can be asked together and no law here answers."""
    in_time = isinstance(question.several_contacts_law, InTime)
    is_planar, has_other = question.problem is Problem.PLANAR, question.other is not None
    if has_other and (question.want_orders or is_planar or in_time):
        message = (
            "other_body_name: found a second body, allowed with it are SPATIAL or AUTOMATIC, SEQUENTIAL (0) "
            "or SIMULTANEOUS (1), and no want_orders"
        )
        raise NotSupportedError(message)
    if in_time and is_planar:
        message = "problem: found PLANAR (1), allowed with SEQUENTIAL_IN_TIME is SPATIAL: space has the plane"
        raise NotSupportedError(message)
    if in_time and question.want_orders:
        message = "want_orders: found true, allowed with SEQUENTIAL_IN_TIME is false: time is the order"
        raise NotSupportedError(message)
    one_contact = contact_count == 1 and not is_planar and not in_time
    if question.want_covariance and (has_other or not one_contact):
        message = (
            "want_covariance: found true, allowed at one contact with the world in space, and not with "
            "SEQUENTIAL_IN_TIME"
        )
        raise NotSupportedError(message)


def _landing(
    question: ImpactQuestion,
    subject: Subject,
    knowledge: Knowledge,
    *,
    velocity_tolerance: float,
    distance_tolerance: float,
) -> tuple[float, BodyState, ContactSet]:
    """Return when a body lands, s after its state, its state then, and where it touches."""
    check_has_shape(subject.body)
    horizon = or_default(question.horizon, knowledge.defaults.horizon)
    landing = next_landing(
        subject.body,
        subject.state,
        knowledge.world,
        horizon=horizon,
        distance_tolerance=distance_tolerance,
        velocity_tolerance=velocity_tolerance,
    )
    name = subject.body.name
    if landing is None:
        raise NoContactError(f"contacts: {name!r} touches no surface within the horizon of {horizon:g} s")
    in_time = isinstance(question.several_contacts_law, InTime)
    if not landing.strikes and not in_time:  # in time, another corner may strike while this one rests
        raise NoContactError(
            f"contacts: {name!r} touches {landing.contacts.surfaces[0]!r} and does not approach it by more "
            f"than {velocity_tolerance:g} m/s (~/predict_contact_mode says what follows)"
        )
    return landing.seconds, landing.state, landing.contacts
