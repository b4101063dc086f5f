"""Converts questions to requests of the three services. `questions` converts them back.

A number that a question leaves out has its field's default in a request. A question with a gravity of its
own has no request, and raises `NotSupportedError`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from contact_dynamics.errors import NotSupportedError
from contact_dynamics.motion.forces import WrenchAxes
from contact_dynamics.questions.impact_question import InTime
from contact_dynamics.questions.sample_times import AtStamps, AtTimes, UntilContact, UntilPlane
from contact_dynamics.questions.subject import PublishedState
from contact_dynamics_interfaces.srv import PredictContactMode, PredictImpact, PredictTumbling
from msg_adapters.body_state import known_state_to_msg
from msg_adapters.contacts import contacts_to_msg
from msg_adapters.geometry import mass_properties_to_msg, point_to_msg, vector_to_msg, wrench_to_msg
from msg_adapters.geometry_margins import write_uncertainty
from msg_adapters.stamps import stamp_ns_from_msg, stamp_to_msg

if TYPE_CHECKING:
    from typing import TypeAlias

    from geometry_msgs.msg import Inertia

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.questions.contact_modes import ContactModeQuestion
    from contact_dynamics.questions.impact_question import ImpactQuestion
    from contact_dynamics.questions.sample_times import Sampling
    from contact_dynamics.questions.subject import StateSource
    from contact_dynamics.questions.tumbling import TumblingQuestion
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body, World
    from contact_dynamics_interfaces.srv import (
        PredictContactModeBatch,
        PredictToss,
        PredictTumblingBatch,
    )

    ContactRequest: TypeAlias = (
        PredictContactMode.Request | PredictContactModeBatch.Request | PredictImpact.Request
    )
    FittedRequest: TypeAlias = PredictImpact.Request | PredictToss.Request | PredictTumbling.Request
    Request: TypeAlias = ContactRequest | PredictToss.Request | PredictTumbling.Request
    GravityRequest: TypeAlias = (
        PredictContactMode.Request
        | PredictContactModeBatch.Request
        | PredictTumbling.Request
        | PredictTumblingBatch.Request
    )


def tumbling_question_to_msg(
    question: TumblingQuestion, *, world: World, world_frame: str
) -> PredictTumbling.Request:
    """Return the request of a question about tumbling.

    Args:
        question: The question.
        world: The bodies that the server knows by name.
        world_frame: The frame of its world.

    Raises:
        UnknownBodyError: the question names a body that the world does not have.
        NotSupportedError: the question has no request.
    """
    msg = PredictTumbling.Request()
    write_fitted_subject(msg, question.body, question.state, world, world_frame)
    _write_sampling(msg, question.sampling)
    write_gravity(msg, question.gravity_W)
    msg.applied_wrench = wrench_to_msg(question.wrench.force, question.wrench.torque)
    msg.wrench_in_body_axes = question.wrench.axes is WrenchAxes.BODY
    msg.linear_drag, msg.quadratic_drag = question.drag.linear, question.drag.quadratic
    msg.linear_angular_drag = question.drag.linear_angular
    msg.quadratic_angular_drag = question.drag.quadratic_angular
    msg.include_covariance = question.include_covariance
    msg.curve_points = question.curve_points
    return msg


def impact_question_to_msg(
    question: ImpactQuestion, *, world: World, world_frame: str
) -> PredictImpact.Request:
    """Return the request of a question about an impact, with arguments as in `tumbling_question_to_msg`."""
    msg = PredictImpact.Request()
    write_fitted_subject(msg, question.body, question.state, world, world_frame)
    if question.other is not None:
        _write_other(msg, question.other, question.other_state, world, world_frame)
    _write_contacts(msg, question.contacts)
    write_given(msg, horizon=question.horizon)
    msg.restitution_law = int(question.restitution_law)
    law = question.several_contacts_law
    if isinstance(law, InTime):
        msg.several_contacts_law = msg.SEQUENTIAL_IN_TIME
        msg.strike_window, msg.max_strikes = law.strike_window, law.max_strikes
        msg.hold_step = law.hold_step or 0.0
    else:
        msg.several_contacts_law = int(law)
    msg.include_orders = question.include_orders
    msg.include_covariance = question.include_covariance
    _write_problem(msg, question)
    return msg


def contact_mode_question_to_msg(
    question: ContactModeQuestion, *, world: World, world_frame: str
) -> PredictContactMode.Request:
    """Return the request of a question about contact modes, as in `tumbling_question_to_msg`."""
    msg = PredictContactMode.Request()
    write_contact_modes(msg, question, world, world_frame)
    msg.applied_wrench = wrench_to_msg(question.force_W, question.torque_W)
    msg.include_wrenches = question.include_wrenches
    msg.include_statics = question.include_statics
    msg.include_impact = question.include_impact
    write_uncertainty(question.uncertainty, msg)
    msg.include_geometry_margins = question.include_geometry_margins
    msg.include_probabilities = question.include_probabilities
    return msg


def write_contact_modes(
    msg: PredictContactMode.Request | PredictContactModeBatch.Request,
    question: ContactModeQuestion,
    world: World,
    world_frame: str,
) -> None:
    """Write what requests about one candidate and about many have in common."""
    write_subject(msg, question.body, question.state, world, world_frame)
    if isinstance(question.state, PublishedState) and question.state.fit_window > 0.0:
        message = f"fit_window must be 0 for contact modes, got {question.state.fit_window:g}"
        raise NotSupportedError(message)
    _write_contacts(msg, question.contacts)
    write_gravity(msg, question.gravity_W)
    _write_problem(msg, question)
    write_given(msg, friction_facets=question.friction_facets, margin_length=question.margin_length)
    msg.include_margins = question.include_margins


def write_fitted_subject(
    msg: FittedRequest, body: Body | str, source: StateSource, world: World, world_frame: str
) -> None:
    """Write what `write_subject` writes, and the window of the fit to published states."""
    write_subject(msg, body, source, world, world_frame)
    if isinstance(source, PublishedState):
        msg.fit_window = source.fit_window


def write_subject(
    msg: Request, body: Body | str, source: StateSource, world: World, world_frame: str
) -> None:
    """Write the body that a request is about, and where its state comes from.

    Raises:
        UnknownBodyError: the world does not have the body.
        NotSupportedError: the body has no request.
    """
    body = world.body(body) if isinstance(body, str) else body
    msg.body_name = body.name
    inertia = asked_inertia(body, world)
    if inertia is not None:
        msg.inertia = inertia
    if isinstance(source, PublishedState):
        msg.state_source = msg.STATE_NEWEST
        if source.stamp_ns is not None:
            msg.state_source = msg.STATE_AT_STAMP
            msg.stamp = stamp_to_msg(source.stamp_ns)
        return
    msg.state_source = msg.STATE_EXPLICIT
    known_state_to_msg(
        source, body_name=body.name, world_frame=world_frame, p_FB_F=body.p_FB_F, into=msg.state
    )


def _write_other(
    msg: PredictImpact.Request, body: Body | str, source: StateSource, world: World, world_frame: str
) -> None:
    """Write the second body of an impact."""
    body = world.body(body) if isinstance(body, str) else body
    msg.other_body_name = body.name
    inertia = asked_inertia(body, world)
    if inertia is not None:
        msg.other_inertia = inertia
    stamp_ns = stamp_ns_from_msg(msg.stamp) if msg.state_source == msg.STATE_AT_STAMP else None
    if not isinstance(source, PublishedState):
        state = known_state_to_msg(source, body_name=body.name, world_frame=world_frame, p_FB_F=body.p_FB_F)
        msg.other_state = [state]
    elif source.stamp_ns != stamp_ns or source.fit_window > 0.0:
        message = "other_state must be that of the request's stamp, without a fit, got a published one"
        raise NotSupportedError(message)


def asked_inertia(body: Body, world: World) -> Inertia | None:
    """Return the inertia of a body that differs from the known one, or None if the body is the known one."""
    named = [known for known in world.bodies if known.name == body.name]
    if body in named:
        return None
    if not named and (body.name or not body.shape.is_empty):
        message = f"body must be one of the world's, or one without name and shape, got {body.name!r}"
        raise NotSupportedError(message)
    return mass_properties_to_msg(body.mass_properties, body.p_FB_F)


def _write_contacts(msg: ContactRequest, contacts: ContactSet | None) -> None:
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


def _write_sampling(msg: PredictTumbling.Request, sampling: Sampling) -> None:
    if isinstance(sampling, AtTimes):
        msg.sampling, msg.times = msg.AT_TIMES, sampling.times.tolist()
        return
    if isinstance(sampling, AtStamps):
        msg.sampling, msg.stamps_ns = msg.AT_STAMPS, list(sampling.stamps_ns)
        return
    msg.sampling = msg.AT_RATE
    if isinstance(sampling, UntilContact):
        msg.sampling = msg.UNTIL_CONTACT
    elif isinstance(sampling, UntilPlane):
        msg.sampling = msg.UNTIL_PLANE
        msg.plane_point = point_to_msg(sampling.plane_point)
        msg.plane_normal = vector_to_msg(sampling.plane_normal)
        msg.body_point = point_to_msg(sampling.body_point)
    write_given(msg, rate=sampling.rate, duration=sampling.duration)


def _write_problem(msg: ContactRequest, question: ContactModeQuestion | ImpactQuestion) -> None:
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
