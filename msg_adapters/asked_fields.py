"""Reads the fields that requests of several services share: numbers that may be left out, contacts, laws.

`questions` and its neighbours make questions of them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Protocol, TypeVar

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.impact.in_time.sequence import MAX_STRIKES, STRIKE_WINDOW
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.several.result import SeveralContactsLaw
from contact_dynamics.motion.forces import NO_DRAG, NO_WRENCH, ConstantWrench, Drag, WrenchAxes
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions.impact_question import InTime
from contact_dynamics.questions.problem import Problem
from contact_dynamics.questions.sample_times import AtRate, AtStamps, AtTimes, UntilContact, UntilPlane
from msg_adapters.contacts import contacts_from_msg
from msg_adapters.field_names import WRENCH_FIELDS, renamed
from msg_adapters.geometry import vector_from_msg

if TYPE_CHECKING:
    from geometry_msgs.msg import Vector3

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.questions.sample_times import Sampling
    from contact_dynamics.validation import FloatArray
    from contact_dynamics_interfaces.msg import ContactSet as ContactSetMsg
    from contact_dynamics_interfaces.srv import PredictImpact, PredictTumbling

LEFT_OUT: Final = -1
"""The default of a number that a request may leave out. No such number may be negative, and zero is zero."""

NOTHING: Final = np.zeros(3)
"""No force, no torque or no gravity."""

Number = TypeVar("Number", int, float)
Law = TypeVar("Law", RestitutionLaw, SeveralContactsLaw)


class ContactRequest(Protocol):
    """The fields about contacts."""

    CONTACTS_FROM_GEOMETRY: int
    CONTACTS_EXPLICIT: int
    contact_source: int
    contacts: ContactSetMsg


class GravityRequest(Protocol):
    """The field about gravity."""

    GRAVITY_AS_CONFIGURED: int
    GRAVITY_NONE: int
    gravity: int


def optional(number: Number) -> Number | None:
    """Return the number of a field that may be left out, or None if it is: its default is then `LEFT_OUT`."""
    return None if number == LEFT_OUT else number


def asked_contacts(request: ContactRequest) -> ContactSet | None:
    """Return the contacts of a request, or None if they are to be found from geometry."""
    if request.contact_source == request.CONTACTS_EXPLICIT:
        return contacts_from_msg(request.contacts)
    if request.contact_source == request.CONTACTS_FROM_GEOMETRY:
        return None
    raise InvalidFieldError(
        "contact_source", request.contact_source, "CONTACTS_FROM_GEOMETRY (0) or CONTACTS_EXPLICIT (1)"
    )


def asked_gravity(request: GravityRequest) -> FloatArray | None:
    """Return the acceleration of gravity that a request asks for, or None for the configured one."""
    if request.gravity == request.GRAVITY_AS_CONFIGURED:
        return None
    if request.gravity == request.GRAVITY_NONE:
        return NOTHING
    raise InvalidFieldError("gravity", request.gravity, "GRAVITY_AS_CONFIGURED (0) or GRAVITY_NONE (1)")


def asked_wrench(request: PredictTumbling.Request) -> ConstantWrench:
    """Return the wrench that acts on the body of a request."""
    wrench = request.applied_wrench
    force, torque = wrench.force, wrench.torque
    if not any((force.x, force.y, force.z, torque.x, torque.y, torque.z)):
        return NO_WRENCH
    try:
        return ConstantWrench(
            force=vector_from_msg(force),
            torque=vector_from_msg(torque),
            axes=WrenchAxes.BODY if request.wrench_in_body_axes else WrenchAxes.WORLD,
        )
    except InvalidFieldError as error:
        raise renamed(error, WRENCH_FIELDS) from None


def asked_drag(request: PredictTumbling.Request) -> Drag:
    """Return the drag that acts on the body of a request."""
    linear, quadratic = request.linear_drag, request.quadratic_drag
    linear_angular, quadratic_angular = request.linear_angular_drag, request.quadratic_angular_drag
    if not any((linear, quadratic, linear_angular, quadratic_angular)):
        return NO_DRAG
    return Drag(
        linear=linear,
        quadratic=quadratic,
        linear_angular=linear_angular,
        quadratic_angular=quadratic_angular,
    )


def asked_sampling(request: PredictTumbling.Request) -> Sampling:
    """Return the times that a request asks about, or raise `InvalidFieldError`."""
    if request.sampling == request.AT_TIMES:
        if len(request.times) == 0:
            raise InvalidFieldError("times", "none", "at least one time, unless sampling is AT_RATE (2)")
        return AtTimes(times=request.times)
    if request.sampling == request.AT_STAMPS:
        return AtStamps(stamps_ns=request.stamps_ns)
    rate, duration = optional(request.rate), optional(request.duration)
    if request.sampling == request.AT_RATE:
        return AtRate(rate=rate, duration=duration)
    if request.sampling == request.UNTIL_CONTACT:
        return UntilContact(rate=rate, duration=duration)
    if request.sampling == request.UNTIL_PLANE:
        return UntilPlane(
            rate=rate,
            duration=duration,
            plane_point=vector_from_msg(request.plane_point),
            plane_normal=vector_from_msg(request.plane_normal),
            body_point=vector_from_msg(request.body_point),
        )
    allowed = "AT_TIMES (0), AT_STAMPS (1), AT_RATE (2), UNTIL_CONTACT (3) or UNTIL_PLANE (4)"
    raise InvalidFieldError("sampling", request.sampling, allowed)


def asked_problem(value: int) -> Problem:
    """Return the kind of problem of a request's number, or raise `InvalidFieldError`."""
    try:
        return Problem(value)
    except ValueError:
        raise InvalidFieldError("problem", value, "AUTOMATIC (0), PLANAR (1) or SPATIAL (2)") from None


def asked_plane(normal: Vector3) -> PlaneOfMotion | None:
    """Return the plane of motion of a request, or None if the best fitting plane is to be found."""
    if not any((normal.x, normal.y, normal.z)):
        return None
    try:
        return PlaneOfMotion(normal_W=vector_from_msg(normal))
    except InvalidFieldError as error:
        raise renamed(error, {"normal_W": "plane_normal"}) from None


def asked_restitution_law(value: int) -> RestitutionLaw:
    """Return the law of a request's number, or raise `InvalidFieldError`."""
    return _asked_law("restitution_law", RestitutionLaw, value)


def asked_instant_law(value: int) -> SeveralContactsLaw:
    """Return the law for contacts at one instant of a request's number, or raise `InvalidFieldError`."""
    return _asked_law("several_contacts_law", SeveralContactsLaw, value)


def _asked_law(field: str, kind: type[Law], value: int) -> Law:
    try:
        return kind(value)
    except ValueError:
        allowed = ", ".join(f"{law.name} ({law.value})" for law in kind)
        raise InvalidFieldError(field, value, allowed) from None


def asked_several_contacts_law(request: PredictImpact.Request) -> SeveralContactsLaw | InTime:
    """Return the law for several contacts that a request asks for, or raise `InvalidFieldError`."""
    value = request.several_contacts_law
    if value == request.SEQUENTIAL_IN_TIME:
        window = optional(request.strike_window)
        most = optional(request.max_strikes)
        return InTime(
            strike_window=STRIKE_WINDOW if window is None else window,
            max_strikes=MAX_STRIKES if most is None else most,
            hold_step=request.hold_step or None,
        )
    try:
        return SeveralContactsLaw(value)
    except ValueError:
        allowed = "SEQUENTIAL (0), SIMULTANEOUS (1), SEQUENTIAL_IN_TIME (2)"
        raise InvalidFieldError("several_contacts_law", value, allowed) from None
