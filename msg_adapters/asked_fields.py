# SPDX-License-Identifier: Apache-2.0
"""Reads the common parts of the requests of several services: body, state, contacts, laws and numbers.

A body is named, or described by an inertia, or both. Its state is in the request, or a published one. A
number with its field's default (`LEFT_OUT`) is left out. A value in a field without effect, such as a horizon
for given contacts, is an error (`rejected_fields`).
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, Final, Protocol, TypeVar

import numpy as np
from geometry_msgs.msg import Inertia

from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions.context import Problem
from contact_dynamics.questions.subject import NEWEST, PublishedState, changed_body
from contact_dynamics.world import LONGEST_NAME, Body
from msg_adapters.body_state import known_state_from_msg
from msg_adapters.contacts import contacts_from_msg
from msg_adapters.field_names import renamed
from msg_adapters.geometry import mass_properties_from_msg, vector_from_msg
from msg_adapters.rejected_fields import STATE_OF_BODY, check_unread
from msg_adapters.stamps import stamp_ns_from_msg

if TYPE_CHECKING:
    from enum import IntEnum

    from builtin_interfaces.msg import Time
    from geometry_msgs.msg import Vector3

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.numerics.vectors import Vector3 as Vector
    from contact_dynamics.questions.subject import StateSource
    from contact_dynamics.questions.uncertain_state import KnownState
    from contact_dynamics.rigid_body.body import MassProperties
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import World
    from contact_dynamics_interfaces.msg import BodyState as BodyStateMsg
    from contact_dynamics_interfaces.msg import ContactSet as ContactSetMsg
    from contact_dynamics_interfaces.srv import PredictBodiesContactMode, PredictImpact

LEFT_OUT: Final = -1
"""The default of an optional number in a request. Such numbers are never negative."""

NOTHING: Final = np.zeros(3)  # no force, no torque or no gravity

Number = TypeVar("Number", int, float)
Member = TypeVar("Member", bound="IntEnum")


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
    """Return the number of an optional field, or None if it has its default `LEFT_OUT`."""
    return None if number == LEFT_OUT else number


def asked_contacts(request: ContactRequest) -> ContactSet | None:
    """Return the contacts of a request, or None if they are detected."""
    if request.contact_source == request.CONTACTS_EXPLICIT:
        return contacts_from_msg(request.contacts)
    if request.contact_source == request.CONTACTS_FROM_GEOMETRY:
        return None
    raise InvalidFieldError(
        "contact_source", request.contact_source, "CONTACTS_FROM_GEOMETRY (0) or CONTACTS_EXPLICIT (1)"
    )


def asked_gravity(request: GravityRequest) -> FloatArray | None:
    """Return the acceleration of gravity in a request, or None for the configured one."""
    if request.gravity == request.GRAVITY_AS_CONFIGURED:
        return None
    if request.gravity == request.GRAVITY_NONE:
        return NOTHING
    raise InvalidFieldError("gravity", request.gravity, "GRAVITY_AS_CONFIGURED (0) or GRAVITY_NONE (1)")


def asked_problem(value: int) -> Problem:
    """Return the kind of problem of a request's number, or raise `InvalidFieldError`."""
    return asked_member("problem", Problem, value)


def asked_plane(normal: Vector3) -> PlaneOfMotion | None:
    """Return the plane of motion of a request, or None for the best fitting plane."""
    if not any((normal.x, normal.y, normal.z)):
        return None
    try:
        return PlaneOfMotion(normal_W=vector_from_msg(normal))
    except InvalidFieldError as error:
        raise renamed(error, {"normal_W": "plane_normal"}) from None


def asked_member(field: str, kind: type[Member], value: int, *others: str) -> Member:
    """Return the member of a number, or raise an error that lists all members and the ``others``."""
    try:
        return kind(value)
    except ValueError:
        allowed = ", ".join([*(f"{each.name} ({each.value})" for each in kind), *others])
        raise InvalidFieldError(field, value, allowed) from None


_REMEMBERED: Final = 16  # number of cached bodies, since a client sends an inertia with every request


class _SubjectRequest(Protocol):
    """The fields about the body in the requests of all services."""

    STATE_NEWEST: int
    STATE_EXPLICIT: int
    STATE_AT_STAMP: int
    body_name: str
    inertia: Inertia
    state_source: int
    stamp: Time
    state: BodyStateMsg


def asked_subject(
    request: _SubjectRequest, world: World, world_frame: str, *, fit_window: float = 0.0
) -> tuple[Body, StateSource]:
    """Return the body of a request, and the source of its state.

    Raise `ContactDynamicsError` if the body is unknown, or a field about the state is not allowed.
    """
    stamp_ns = _stamp_ns(request)
    body = asked_body(request.body_name, request.inertia, world)
    if request.state_source == request.STATE_EXPLICIT:
        return body, _explicit("state", request.state, body, world_frame)
    return body, _published(stamp_ns, fit_window)


def asked_subjects(
    request: PredictBodiesContactMode.Request, world: World, world_frame: str
) -> tuple[tuple[Body, ...], tuple[StateSource, ...]]:
    """Return the bodies of a request, and the sources of their states.

    The errors are those of `asked_subject`, and of bodies with the same name and lists of different lengths.
    """
    stamp_ns, count = _stamp_ns(request), len(request.states)
    for field in ("inertias", "applied_wrenches"):
        if len(found := getattr(request, field)) not in {0, count}:
            raise InvalidFieldError(field, f"{len(found)} elements", f"{count}, one for each state, or none")
    known = {body.name for body in world.bodies}
    bodies: list[Body] = []
    states: list[StateSource] = []
    for i, msg in enumerate(request.states):
        name, field = msg.body_name, f"states[{i}].body_name"
        if not name or name in {body.name for body in bodies}:
            raise InvalidFieldError(field, repr(name), "a name that no other body has")
        inertia = request.inertias[i] if request.inertias else Inertia()
        is_new = name not in known and _is_described(inertia)
        body = asked_body("" if is_new else name, inertia, world, field=field, described=f"inertias[{i}]")
        bodies.append(replace(body, name=name) if is_new else body)
        check_unread(request, STATE_OF_BODY, part=msg, path=f"states[{i}].")
        is_explicit = request.state_source == request.STATE_EXPLICIT
        states.append(
            _explicit(f"states[{i}]", msg, bodies[i], world_frame) if is_explicit else _published(stamp_ns)
        )
    return tuple(bodies), tuple(states)


def asked_other(
    request: PredictImpact.Request, world: World, world_frame: str
) -> tuple[Body | None, StateSource]:
    """Return the second body of an impact, or None for one with the world, and the source of its state."""
    explicit = request.other_state[0] if request.other_state else None
    if not request.other_body_name and explicit is None and not _is_described(request.other_inertia):
        return None, NEWEST
    body = asked_body(request.other_body_name, request.other_inertia, world, field="other_body_name")
    if explicit is None:
        return body, _published(_stamp_ns(request))
    return body, _explicit("other_state[0]", explicit, body, world_frame)


def _explicit(field: str, msg: BodyStateMsg, body: Body, world_frame: str) -> KnownState:
    """Return the state in a request, which may repeat the name of the request's body."""
    if body.name and msg.body_name not in {"", body.name}:
        raise InvalidFieldError(f"{field}.body_name", repr(msg.body_name), f"{body.name!r}, or left out")
    return known_state_from_msg(msg, world_frame=world_frame, p_FB_F=body.p_FB_F, field=field)


def asked_body(
    name: str, inertia: Inertia, world: World, *, field: str = "body_name", described: str = ""
) -> Body:
    """Return the body that a request names in one field, or describes in another.

    Raise `ContactDynamicsError` if the name is unknown or too long, or the numbers are invalid.
    """
    if len(name) > LONGEST_NAME:
        raise TooLargeError(field, f"{len(name)} characters", f"at most {LONGEST_NAME}")
    is_described = _is_described(inertia)
    described = described or field.replace("body_name", "inertia")
    if not name and not is_described:
        raise InvalidFieldError(field, name, f"the name of a configured body, unless {described}.m is > 0")
    # The body is looked up here, because an explicit state is that of the body's published frame.
    known = world.body(name) if name else None
    if known is not None and not is_described:
        return known
    try:
        mass_properties, p_FB_F = mass_properties_from_msg(inertia)
    except InvalidFieldError as error:
        raise renamed(error, {"mass": f"{described}.m", "I_B": described}) from None
    return _described_body(mass_properties, tuple(p_FB_F.tolist()), known)


@lru_cache(maxsize=_REMEMBERED)
def _described_body(mass_properties: MassProperties, com: Vector, known: Body | None) -> Body:
    """Return a body with the mass properties of a request, and the name and shape of a known body."""
    if known is None:
        return Body(name="", mass_properties=mass_properties, p_FB_F=com)
    return changed_body(known, mass_properties, np.array(com))


def _is_described(inertia: Inertia) -> bool:
    """Return whether a request contains an inertia, possibly with mass zero, which is an error."""
    com = inertia.com
    numbers = (inertia.m, inertia.ixx, inertia.ixy, inertia.ixz, inertia.iyy, inertia.iyz, inertia.izz)
    return any(numbers) or any((com.x, com.y, com.z))


def _stamp_ns(request: _SubjectRequest) -> int | None:
    """Return the stamp of the published state in a request, or None if it has none."""
    if request.state_source == request.STATE_AT_STAMP:
        return stamp_ns_from_msg(request.stamp)
    if request.state_source not in {request.STATE_NEWEST, request.STATE_EXPLICIT}:
        allowed = "STATE_NEWEST (0), STATE_EXPLICIT (1) or STATE_AT_STAMP (2)"
        raise InvalidFieldError("state_source", request.state_source, allowed)
    return None


def _published(stamp_ns: int | None, fit_window: float = 0.0) -> PublishedState:
    if stamp_ns is None and fit_window == 0.0:
        return NEWEST
    return PublishedState(stamp_ns=stamp_ns, fit_window=fit_window)
