# SPDX-License-Identifier: Apache-2.0
"""Reads and writes fields that requests of several services share: optional numbers, contacts, laws.

A number with its field's default (`LEFT_OUT`) is left out. A value in a field that has no effect, such as a
horizon if the contacts are given, is an error (`unread_fields`). A question with a gravity of its own has no
request, and raises `NotSupportedError`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Protocol, TypeVar

import numpy as np

from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.several.result import SeveralContactsLaw
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions.problem import Problem
from msg_adapters.contacts import contacts_from_msg, contacts_to_msg
from msg_adapters.field_names import renamed
from msg_adapters.geometry import vector_from_msg, vector_to_msg

if TYPE_CHECKING:
    from geometry_msgs.msg import Vector3

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.questions.contact_modes import ContactModeQuestion
    from contact_dynamics.questions.impact_question import ImpactQuestion
    from contact_dynamics.validation import FloatArray
    from contact_dynamics_interfaces.msg import ContactSet as ContactSetMsg

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


class ProblemRequest(Protocol):
    """The fields about a plane of motion."""

    problem: int
    plane_normal: Vector3


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


def write_contacts(msg: ContactRequest, contacts: ContactSet | None) -> None:
    """Write contacts, with None for those that are found from geometry."""
    msg.contact_source = msg.CONTACTS_FROM_GEOMETRY if contacts is None else msg.CONTACTS_EXPLICIT
    if contacts is not None:
        contacts_to_msg(contacts, into=msg.contacts)


def write_gravity(msg: GravityRequest, gravity_W: FloatArray | None) -> None:
    """Write a gravity, with None for the configured one.

    Raises:
        NotSupportedError: it is neither the configured one nor zero.
    """
    if gravity_W is not None and gravity_W.any():
        message = f"gravity_W must be the server's, or zero, got {gravity_W.tolist()}"
        raise NotSupportedError(message)
    msg.gravity = msg.GRAVITY_AS_CONFIGURED if gravity_W is None else msg.GRAVITY_NONE


def write_problem(msg: ProblemRequest, question: ContactModeQuestion | ImpactQuestion) -> None:
    """Write whether a question is about a plane, the plane, and the tolerances."""
    msg.problem = int(question.problem)
    if question.plane is not None:
        msg.plane_normal = vector_to_msg(question.plane.normal_W)
    write_given(
        msg,
        out_of_plane_tolerance=question.out_of_plane_tolerance,
        velocity_tolerance=question.velocity_tolerance,
        distance_tolerance=question.distance_tolerance,
    )


def write_given(msg: object, **numbers: float | None) -> None:
    """Write the numbers that a question has. The others keep their fields' defaults, which leave them out."""
    for field, number in numbers.items():
        if number is not None:
            setattr(msg, field, number)
