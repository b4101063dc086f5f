"""Which impact a request for one means: the bodies, their states just before, the contacts and the laws."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from contact_dynamics.errors import InvalidFieldError, NoContactError, NotSupportedError
from contact_dynamics.impact import RestitutionLaw, SeveralContactsLaw
from contact_dynamics.landing.earliest import next_landing
from contact_dynamics.nodes.subject import (
    Knowledge,
    Subject,
    check_has_shape,
    contacts_of,
    distance_tolerance_of,
    or_configured,
    other_subject_of,
    subject_of,
    velocity_tolerance_of,
)
from msg_adapters.impact import Before

if TYPE_CHECKING:
    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class Strike:
    """An impact that is to be resolved."""

    subject: Subject
    other: Subject | None
    seconds: float  # s from the state's stamp
    state: BodyState  # just before
    contacts: ContactSet
    restitution_law: RestitutionLaw
    several_contacts_law: SeveralContactsLaw  # of one instant
    velocity_tolerance: float  # m/s
    gravity_W: FloatArray  # (3,), m/s^2, of the flight before

    @property
    def before(self) -> Before:
        """What the adapters need of the first body."""
        subject = self.subject
        return Before(body=subject.body.mass_properties, state=self.state, state_to_msg=subject.state_to_msg)


def strike_of(request: Any, knowledge: Knowledge) -> Strike:
    """Return the impact that a request means: at the contacts that it carries, or at the next landing.

    Raises:
        ContactDynamicsError: nothing strikes, or a part of the question is wrong or not supported.
    """
    subject = subject_of(request, knowledge)
    other = other_subject_of(request, knowledge)
    seconds, state, contacts = 0.0, subject.state, None
    if request.contact_source != request.CONTACTS_FROM_GEOMETRY:
        contacts = contacts_of(request, subject, knowledge)
    elif other is not None:
        message = "contact_source: found CONTACTS_FROM_GEOMETRY (0) for two bodies, allowed is 1 (explicit)"
        raise NotSupportedError(message)
    else:
        seconds, state, contacts = _landing(request, subject, knowledge)
    _check_supported(request, has_other=other is not None, contact_count=len(contacts))
    return Strike(
        subject=subject,
        other=other,
        seconds=seconds,
        state=state,
        contacts=contacts,
        restitution_law=_restitution_law(request.restitution_law),
        several_contacts_law=_several_contacts_law(request),
        velocity_tolerance=velocity_tolerance_of(request, knowledge),
        gravity_W=knowledge.parameters.world.gravity_W,
    )


def _check_supported(request: Any, *, has_other: bool, contact_count: int) -> None:
    """Raise `NotSupportedError` for what the interface can carry together and no law here answers."""
    in_time = request.several_contacts_law == request.SEQUENTIAL_IN_TIME
    if has_other and (request.want_orders or request.problem == request.PLANAR or in_time):
        message = (
            "other_body_name: found a second body, allowed with it are SPATIAL or AUTOMATIC, SEQUENTIAL (0) "
            "or SIMULTANEOUS (1), and no want_orders"
        )
        raise NotSupportedError(message)
    if in_time and request.problem == request.PLANAR:
        message = "problem: found PLANAR (1), allowed with SEQUENTIAL_IN_TIME is SPATIAL: space has the plane"
        raise NotSupportedError(message)
    if in_time and request.want_orders:
        message = "want_orders: found true, allowed with SEQUENTIAL_IN_TIME is false: time is the order"
        raise NotSupportedError(message)
    one_contact = contact_count == 1 and request.problem != request.PLANAR and not in_time
    if request.want_covariance and (has_other or not one_contact):
        message = (
            "want_covariance: found true, allowed at one contact with the world in space, and not with "
            "SEQUENTIAL_IN_TIME"
        )
        raise NotSupportedError(message)


def _restitution_law(value: int) -> RestitutionLaw:
    try:
        return RestitutionLaw(value)
    except ValueError:
        allowed = ", ".join(f"{law.name} ({law.value})" for law in RestitutionLaw)
        raise InvalidFieldError("restitution_law", value, allowed) from None


def _several_contacts_law(request: Any) -> SeveralContactsLaw:
    if request.several_contacts_law == request.SEQUENTIAL_IN_TIME:
        return SeveralContactsLaw.SEQUENTIAL  # at one instant
    try:
        return SeveralContactsLaw(request.several_contacts_law)
    except ValueError:
        allowed = "SEQUENTIAL (0), SIMULTANEOUS (1), SEQUENTIAL_IN_TIME (2)"
        raise InvalidFieldError("several_contacts_law", request.several_contacts_law, allowed) from None


def _landing(request: Any, subject: Subject, knowledge: Knowledge) -> tuple[float, BodyState, ContactSet]:
    check_has_shape(subject.body)
    horizon = or_configured("horizon", request.horizon, knowledge.parameters.horizon)
    tolerance = velocity_tolerance_of(request, knowledge)
    landing = next_landing(
        subject.body,
        subject.state,
        knowledge.parameters.world,
        horizon=horizon,
        distance_tolerance=distance_tolerance_of(request, knowledge),
        velocity_tolerance=tolerance,
    )
    name = subject.body.name
    if landing is None:
        raise NoContactError(f"contacts: {name!r} touches no surface within the horizon of {horizon:g} s")
    in_time = request.several_contacts_law == request.SEQUENTIAL_IN_TIME
    if not landing.strikes and not in_time:  # in time, another corner may strike while this one rests
        raise NoContactError(
            f"contacts: {name!r} touches {landing.contacts.surfaces[0]!r} and does not approach it by more "
            f"than {tolerance:g} m/s (~/predict_contact_mode says what follows)"
        )
    return landing.seconds, landing.state, landing.contacts
