"""Answers `~/predict_contact_mode`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from contact_dynamics.contact_modes import (
    ModeVerdict,
    planar_contact_modes,
    planar_mode_map,
    planar_mode_margins,
    planar_statics,
)
from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_dynamics.impact import planar_impact
from contact_dynamics.nodes.subject import (
    contacts_of,
    distance_tolerance_of,
    gravity_of,
    planar_problem_of,
    subject_of,
    velocity_tolerance_of,
)
from contact_dynamics.validation import check_array, check_not_negative
from msg_adapters.contact_mode import (
    wrench_set_to_msg,
    write_planar_answer,
    write_planar_margins,
    write_planar_statics,
)
from msg_adapters.contacts import contacts_to_msg
from msg_adapters.geometry import vector_from_msg, vector_to_msg
from msg_adapters.impact import Before, planar_impact_to_msg

if TYPE_CHECKING:
    from contact_dynamics.nodes.subject import Knowledge, Subject
    from contact_dynamics.plane_of_motion import PlanarProblem
    from contact_dynamics_interfaces.msg import Impact as ImpactMsg


def predict_contact_mode(request: Any, response: Any, knowledge: Knowledge) -> None:
    """Answer one request, or raise a `ContactDynamicsError` that says what is wrong with it."""
    if request.problem == request.SPATIAL:
        message = "problem: found SPATIAL (2), allowed are AUTOMATIC (0) and PLANAR (1) in this version"
        raise NotSupportedError(message)
    if request.problem not in (request.AUTOMATIC, request.PLANAR):
        raise InvalidFieldError("problem", request.problem, "AUTOMATIC (0), PLANAR (1) or SPATIAL (2)")
    subject = subject_of(request, knowledge)
    contacts = contacts_of(request, subject, knowledge)
    body = subject.body.mass_properties
    force_W = check_array("applied_wrench.force", vector_from_msg(request.applied_wrench.force), (3,))
    force_W = force_W + body.mass * gravity_of(request, knowledge)
    torque_W = check_array("applied_wrench.torque", vector_from_msg(request.applied_wrench.torque), (3,))
    problem = planar_problem_of(
        request, subject.body, subject.state, contacts, knowledge, force_W=force_W, torque_W=torque_W
    )
    answer = planar_contact_modes(
        problem.body,
        problem.velocity,
        problem.contacts,
        problem.wrench,
        velocity_tolerance=velocity_tolerance_of(request, knowledge),
    )
    write_planar_answer(response, answer, problem)
    if request.want_margins:
        margins = planar_mode_margins(
            problem.body,
            problem.velocity,
            problem.contacts,
            problem.wrench,
            margin_length=_margin_length(request),
            velocity_tolerance=answer.velocity_tolerance,
        )
        write_planar_margins(response, margins, problem.plane)
    if request.want_wrenches:
        sets = planar_mode_map(
            problem.body,
            problem.contacts,
            velocity=problem.velocity,
            velocity_tolerance=answer.velocity_tolerance,
        )
        response.wrench_sets = [wrench_set_to_msg(wrenches, problem.plane) for wrenches in sets]
    if request.want_statics:
        statics = planar_statics(
            problem.body, problem.contacts, problem.wrench, margin_length=_margin_length(request)
        )
        write_planar_statics(response, statics)
    if request.want_impact and answer.verdict in {ModeVerdict.INCONSISTENT, ModeVerdict.IMPACT}:
        response.impact = [_settling_impact(subject, problem, answer.velocity_tolerance)]
    response.problem = request.PLANAR
    response.state = subject.state_to_msg(subject.state)
    response.contacts = contacts_to_msg(contacts)
    response.plane_normal = vector_to_msg(problem.plane.normal_W)
    response.out_of_plane = problem.out_of_plane
    response.distance_tolerance = distance_tolerance_of(request, knowledge)


def _margin_length(request: Any) -> float | None:
    """Return the metric's length that a request asks for, m; None: the radius of gyration."""
    return check_not_negative("margin_length", request.margin_length) or None


def _settling_impact(subject: Subject, problem: PlanarProblem, velocity_tolerance: float) -> ImpactMsg:
    """Return the impact that an approaching or inconsistent contact comes to (lecture 26's last remark)."""
    if len(problem.contacts) > 1:
        message = f"want_impact: found {len(problem.contacts)} contacts, allowed is 1 in this version"
        raise NotSupportedError(message)
    impact = planar_impact(
        problem.body, problem.velocity, problem.contacts[0], velocity_tolerance=velocity_tolerance
    )
    before = Before(body=subject.body.mass_properties, state=subject.state, state_to_msg=subject.state_to_msg)
    return planar_impact_to_msg(impact, problem, before)
