"""Converts requests about tumbling, impacts and contact modes to questions.

Its neighbours `batches`, `contact_mode_batch` and `toss` read the requests of the other services with its
parts.

A number that a question leaves out is an empty list in a request. Fields without meaning for a question, such
as a horizon if the contacts are given, are not read.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Protocol, TypeVar

import numpy as np

from contact_dynamics.contact.uncertainty import EXACT_CONTACTS, ContactUncertainty
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.impact.in_time.sequence import MOST_STRIKES, STRIKE_WINDOW
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.several.result import SeveralContactsLaw
from contact_dynamics.motion.forces import NO_DRAG, NO_WRENCH, ConstantWrench, Drag, WrenchAxes
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions.contact_mode_question import ContactModeQuestion
from contact_dynamics.questions.impact_question import ImpactQuestion, InTime
from contact_dynamics.questions.problem import Problem
from contact_dynamics.questions.sample_times import AtRate, AtStamps, AtTimes, UntilContact, UntilPlane
from contact_dynamics.questions.tumbling import TumblingQuestion
from msg_adapters.asked_subject import asked_other, asked_subject
from msg_adapters.contacts import contacts_from_msg
from msg_adapters.geometry import vector_from_msg
from msg_adapters.geometry_margins import uncertainty_from_msg

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from geometry_msgs.msg import Vector3

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.questions.sample_times import Sampling
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import World
    from contact_dynamics_interfaces.msg import ContactSet as ContactSetMsg
    from contact_dynamics_interfaces.srv import (
        PredictContactMode,
        PredictContactModeBatch,
        PredictImpact,
        PredictTumbling,
    )


_NOTHING: Final = np.zeros(3)
_WRENCH_FIELDS: Final = {
    "force": "applied_wrench.force",
    "torque": "applied_wrench.torque",
    "force_W": "applied_wrench.force",
    "torque_W": "applied_wrench.torque",
}
"""The request's names of the fields of a wrench, by their names in the package."""

T = TypeVar("T", bound=InvalidFieldError)
Number = TypeVar("Number", int, float)


class _ContactRequest(Protocol):
    """The fields about contacts."""

    CONTACTS_FROM_GEOMETRY: int
    CONTACTS_EXPLICIT: int
    contact_source: int
    contacts: ContactSetMsg
    out_of_plane_tolerance: Sequence[float]


class _GravityRequest(Protocol):
    """The field about gravity."""

    GRAVITY_AS_CONFIGURED: int
    GRAVITY_NONE: int
    gravity: int


def tumbling_question_from_msg(
    request: PredictTumbling.Request, *, world: World, world_frame: str
) -> TumblingQuestion:
    """Return the question of a `PredictTumbling` request.

    Args:
        request: The request.
        world: The bodies that it can name.
        world_frame: The frame that an explicit state must be in.

    Raises:
        ContactDynamicsError: a field holds what is not allowed, or names a body that is not known.
    """
    gravity_W, wrench, drag = asked_gravity(request), _wrench(request), _drag(request)
    body, state = asked_subject(request, world, world_frame, fit_window=request.fit_window)
    return TumblingQuestion(
        body=body,
        state=state,
        sampling=_sampling(request),
        gravity_W=gravity_W,
        wrench=wrench,
        drag=drag,
        want_covariance=request.want_covariance,
        curve_points=request.curve_points,
    )


def impact_question_from_msg(
    request: PredictImpact.Request, *, world: World, world_frame: str
) -> ImpactQuestion:
    """Return the question of a `PredictImpact` request.

    Args:
        request: The request.
        world: The bodies that it can name.
        world_frame: The frame that explicit states must be in.

    Raises:
        ContactDynamicsError: a field holds what is not allowed, or names a body that is not known.
    """
    problem = _problem(request.problem)
    is_planar = problem is Problem.PLANAR
    body, state = asked_subject(request, world, world_frame, fit_window=request.fit_window)
    other, other_state = asked_other(request, world, world_frame)
    contacts = _contacts(request)
    return ImpactQuestion(
        body=body,
        state=state,
        other=other,
        other_state=other_state,
        contacts=contacts,
        horizon=optional("horizon", request.horizon) if contacts is None else None,
        restitution_law=asked_restitution_law(request.restitution_law),
        several_contacts_law=_several_contacts_law(request),
        want_orders=request.want_orders,
        want_covariance=request.want_covariance,
        problem=problem,
        plane=_plane(request.plane_normal) if is_planar else None,
        out_of_plane_tolerance=_out_of_plane_tolerance(request) if is_planar else None,
        velocity_tolerance=optional("velocity_tolerance", request.velocity_tolerance),
        distance_tolerance=optional("distance_tolerance", request.distance_tolerance),
    )


def contact_mode_question_from_msg(
    request: PredictContactMode.Request, *, world: World, world_frame: str
) -> ContactModeQuestion:
    """Return the question of a `PredictContactMode` request.

    Args:
        request: The request.
        world: The bodies that it can name.
        world_frame: The frame that an explicit state must be in.

    Raises:
        ContactDynamicsError: a field holds what is not allowed, or names a body that is not known.
    """
    try:
        return asked_contact_modes(
            request,
            world,
            world_frame,
            compares_torques=request.want_margins or request.want_statics,
            force_W=vector_from_msg(request.applied_wrench.force),
            torque_W=vector_from_msg(request.applied_wrench.torque),
            want_wrenches=request.want_wrenches,
            want_statics=request.want_statics,
            want_impact=request.want_impact,
            uncertainty=uncertainty_from_msg(request),
            want_geometry_margins=request.want_geometry_margins,
        )
    except InvalidFieldError as error:
        raise _renamed(error, _WRENCH_FIELDS) from None


def asked_contact_modes(
    request: PredictContactMode.Request | PredictContactModeBatch.Request,
    world: World,
    world_frame: str,
    *,
    compares_torques: bool,
    force_W: FloatArray = _NOTHING,
    torque_W: FloatArray = _NOTHING,
    want_wrenches: bool = False,
    want_statics: bool = False,
    want_impact: bool = False,
    uncertainty: ContactUncertainty = EXACT_CONTACTS,
    want_geometry_margins: bool = False,
) -> ContactModeQuestion:
    """Return the question of what requests about one candidate and about many have in common.

    Args:
        request: The request.
        world: The bodies that it can name.
        world_frame: The frame that an explicit state must be in.
        compares_torques: Whether its margin_length matters.
        force_W: The question's own, as what follows.
        torque_W: As the question's.
        want_wrenches: As the question's.
        want_statics: As the question's.
        want_impact: As the question's.
        uncertainty: As the question's.
        want_geometry_margins: As the question's.

    Raises:
        ContactDynamicsError: a field holds what is not allowed, or names a body that is not known.
    """
    problem = _problem(request.problem)
    may_be_planar = problem is not Problem.SPATIAL
    body, state = asked_subject(request, world, world_frame)
    return ContactModeQuestion(
        body=body,
        state=state,
        contacts=_contacts(request),
        gravity_W=asked_gravity(request),
        problem=problem,
        plane=_plane(request.plane_normal) if may_be_planar else None,
        out_of_plane_tolerance=_out_of_plane_tolerance(request) if may_be_planar else None,
        velocity_tolerance=optional("velocity_tolerance", request.velocity_tolerance),
        distance_tolerance=optional("distance_tolerance", request.distance_tolerance),
        friction_facets=optional("friction_facets", request.friction_facets),
        margin_length=optional("margin_length", request.margin_length) if compares_torques else None,
        force_W=force_W,
        torque_W=torque_W,
        want_margins=request.want_margins,
        want_wrenches=want_wrenches,
        want_statics=want_statics,
        want_impact=want_impact,
        uncertainty=uncertainty,
        want_geometry_margins=want_geometry_margins,
    )


def optional(field: str, numbers: Sequence[Number]) -> Number | None:
    """Return the number of a field that may be left out, or None if it is."""
    if len(numbers) > 1:
        raise InvalidFieldError(field, f"{len(numbers)} numbers", "one, or none")
    return numbers[0] if numbers else None


def _out_of_plane_tolerance(request: _ContactRequest) -> float | None:
    return optional("out_of_plane_tolerance", request.out_of_plane_tolerance)


def _contacts(request: _ContactRequest) -> ContactSet | None:
    """Return the contacts of a request, or None if they are to be found from geometry."""
    if request.contact_source == request.CONTACTS_EXPLICIT:
        return contacts_from_msg(request.contacts)
    if request.contact_source == request.CONTACTS_FROM_GEOMETRY:
        return None
    raise InvalidFieldError(
        "contact_source", request.contact_source, "CONTACTS_FROM_GEOMETRY (0) or CONTACTS_EXPLICIT (1)"
    )


def asked_gravity(request: _GravityRequest) -> FloatArray | None:
    """Return the acceleration of gravity that a request asks for, or None for the configured one."""
    if request.gravity == request.GRAVITY_AS_CONFIGURED:
        return None
    if request.gravity == request.GRAVITY_NONE:
        return _NOTHING
    raise InvalidFieldError("gravity", request.gravity, "GRAVITY_AS_CONFIGURED (0) or GRAVITY_NONE (1)")


def _wrench(request: PredictTumbling.Request) -> ConstantWrench:
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
        raise _renamed(error, _WRENCH_FIELDS) from None


def _drag(request: PredictTumbling.Request) -> Drag:
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


def _sampling(request: PredictTumbling.Request) -> Sampling:
    if request.sampling == request.AT_TIMES:
        return AtTimes(times=request.times)
    if request.sampling == request.AT_STAMPS:
        return AtStamps(stamps_ns=request.stamps_ns)
    rate, duration = optional("rate", request.rate), optional("duration", request.duration)
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


def _problem(value: int) -> Problem:
    try:
        return Problem(value)
    except ValueError:
        raise InvalidFieldError("problem", value, "AUTOMATIC (0), PLANAR (1) or SPATIAL (2)") from None


def _plane(normal: Vector3) -> PlaneOfMotion | None:
    """Return the plane of motion of a request, or None if the best fitting plane is to be found."""
    if not any((normal.x, normal.y, normal.z)):
        return None
    return PlaneOfMotion(normal_W=vector_from_msg(normal))


def asked_restitution_law(value: int) -> RestitutionLaw:
    """Return the law of a request's number, or raise `InvalidFieldError`."""
    try:
        return RestitutionLaw(value)
    except ValueError:
        allowed = ", ".join(f"{law.name} ({law.value})" for law in RestitutionLaw)
        raise InvalidFieldError("restitution_law", value, allowed) from None


def _several_contacts_law(request: PredictImpact.Request) -> SeveralContactsLaw | InTime:
    value = request.several_contacts_law
    if value == request.SEQUENTIAL_IN_TIME:
        window = optional("strike_window", request.strike_window)
        most = optional("most_strikes", request.most_strikes)
        return InTime(
            strike_window=STRIKE_WINDOW if window is None else window,
            most_strikes=MOST_STRIKES if most is None else most,
            hold_step=request.hold_step or None,
        )
    try:
        return SeveralContactsLaw(value)
    except ValueError:
        allowed = "SEQUENTIAL (0), SIMULTANEOUS (1), SEQUENTIAL_IN_TIME (2)"
        raise InvalidFieldError("several_contacts_law", value, allowed) from None


def _renamed(error: T, names: Mapping[str, str]) -> T:
    """Return the same error with the request's name of the field."""
    return type(error)(names.get(error.field, error.field), error.found, error.allowed)
