"""Answers `~/predict_contact_mode`: in a plane of motion, or in space."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.contact.velocities import spatial_contact_velocities
from contact_dynamics.contact_modes import (
    PlanarContactProblem,
    contact_modes,
    mode_margins,
    refused_modes,
    spatial_kinematic_modes,
    statics,
    wrench_sets,
)
from contact_dynamics.contact_modes.planar.problem import MOST_PLANAR_CONTACTS
from contact_dynamics.contact_modes.spatial.problem import FRICTION_FACETS
from contact_dynamics.contact_modes.spatial.wrench_sets import WRENCH_FACETS
from contact_dynamics.errors import InvalidFieldError, OutOfPlaneError, TooLargeError
from contact_dynamics.nodes.settled_impact import Question, settle_in_plane, settle_in_space
from contact_dynamics.nodes.subject import (
    contacts_of,
    distance_tolerance_of,
    gravity_of,
    planar_problem_of,
    subject_of,
    velocity_tolerance_of,
)
from contact_dynamics.plane.lifting import check_mirrored, mirror_partners
from contact_dynamics.validation import check_array, check_not_negative
from msg_adapters.contact_mode import (
    spatial_wrench_set_to_msg,
    wrench_set_to_msg,
    write_planar_answer,
    write_planar_margins,
    write_refused,
    write_spatial_answer,
    write_spatial_margins,
    write_statics,
)
from msg_adapters.contacts import contacts_to_msg
from msg_adapters.geometry import vector_from_msg, vector_to_msg

if TYPE_CHECKING:
    from contact_dynamics.nodes.subject import Knowledge
    from contact_dynamics.plane.projection import PlanarProblem

MOST_FRICTION_FACETS: Final = 32
"""More edges of a friction pyramid are refused: 32 hold 99.5 % of the round cone, and more cost more."""


def predict_contact_mode(request: Any, response: Any, knowledge: Knowledge) -> None:
    """Answer one request, or raise a `ContactDynamicsError` that says what is wrong with it."""
    if request.problem not in {request.AUTOMATIC, request.PLANAR, request.SPATIAL}:
        raise InvalidFieldError("problem", request.problem, "AUTOMATIC (0), PLANAR (1) or SPATIAL (2)")
    question = _question(request, knowledge)
    view, reason = _in_plane(request, question, knowledge)
    if view is None:
        response.problem, response.out_of_plane_reason = request.SPATIAL, reason
        _answer_in_space(request, response, question)
    else:
        response.problem = request.PLANAR
        _answer_in_plane(request, response, question, *view)
    question.subject.state_to_msg(question.subject.state, into=response.state)
    contacts_to_msg(question.contacts, into=response.contacts)
    response.distance_tolerance = question.distance_tolerance


def _question(request: Any, knowledge: Knowledge) -> Question:
    subject = subject_of(request, knowledge)
    contacts = contacts_of(request, subject, knowledge)
    if len(contacts) > MOST_PLANAR_CONTACTS:
        raise TooLargeError("contacts", f"{len(contacts)} contacts", f"at most {MOST_PLANAR_CONTACTS}")
    force_W = check_array("applied_wrench.force", vector_from_msg(request.applied_wrench.force), (3,))
    return Question(
        subject=subject,
        contacts=contacts,
        force_W=force_W + subject.body.mass_properties.mass * gravity_of(request, knowledge),
        torque_W=check_array("applied_wrench.torque", vector_from_msg(request.applied_wrench.torque), (3,)),
        velocity_tolerance=velocity_tolerance_of(request, knowledge),
        distance_tolerance=distance_tolerance_of(request, knowledge),
        friction_facets=_friction_facets(request),
    )


def _in_plane(
    request: Any, question: Question, knowledge: Knowledge
) -> tuple[tuple[PlanarProblem, tuple[int, ...]] | None, str]:
    """Return the problem in its plane of motion, with the mirror image of each contact in that plane.

    Or None, and what AUTOMATIC found to be out of the plane.
    """
    if request.problem == request.SPATIAL:
        return None, ""
    subject, contacts = question.subject, question.contacts
    try:
        problem = planar_problem_of(
            request,
            subject.body,
            subject.state,
            contacts,
            knowledge,
            force_W=question.force_W,
            torque_W=question.torque_W,
        )
        partners = mirror_partners(
            problem.plane, subject.state, contacts, distance_tolerance=question.distance_tolerance
        )
        if request.problem == request.AUTOMATIC:
            check_mirrored(problem.plane, subject.state, contacts, partners)
    except OutOfPlaneError as error:
        if request.problem == request.PLANAR:
            raise
        return None, str(error)
    return (problem, partners), ""


def _answer_in_plane(
    request: Any, response: Any, question: Question, problem: PlanarProblem, partners: tuple[int, ...]
) -> None:
    asked = PlanarContactProblem(
        body=problem.body,
        velocity=problem.velocity,
        contacts=problem.contacts,
        wrench=problem.wrench,
        velocity_tolerance=question.velocity_tolerance,
    )
    answer = contact_modes(asked)
    write_planar_answer(response, answer, problem, partners)
    if request.want_margins:
        margins = mode_margins(asked, answer, margin_length=_margin_length(request))
        write_planar_margins(response, margins, problem.plane)
    if request.want_wrenches:
        sets = wrench_sets(asked)
        response.wrench_sets = [wrench_set_to_msg(wrenches, problem.plane) for wrenches in sets]
    if request.want_statics:
        write_statics(response, statics(asked, margin_length=_margin_length(request)))
    if request.want_impact:
        settle_in_plane(response, question, problem, answer.verdict, partners)
    response.plane_normal = vector_to_msg(problem.plane.normal_W)
    response.out_of_plane = problem.out_of_plane


def _answer_in_space(request: Any, response: Any, question: Question) -> None:
    asked, state, contacts = question.in_space, question.subject.state, question.contacts
    answer = contact_modes(asked)
    write_spatial_answer(
        response,
        answer,
        kinematic_modes=spatial_kinematic_modes(
            state, contacts, velocity_tolerance=question.velocity_tolerance
        ),
        contact_velocities_W=spatial_contact_velocities(
            state, contacts, velocity_tolerance=question.velocity_tolerance
        ),
    )
    if request.want_margins:
        margins = mode_margins(asked, answer, margin_length=_margin_length(request))
        write_spatial_margins(response, margins)
        write_refused(response, refused_modes(asked, answer, margin_length=_margin_length(request)))
    if request.want_wrenches:
        response.wrench_facets = int(request.friction_facets) or WRENCH_FACETS
        sets = wrench_sets(replace(asked, friction_facets=response.wrench_facets))
        response.wrench_sets = [spatial_wrench_set_to_msg(wrenches) for wrenches in sets]
    if request.want_statics:
        write_statics(response, statics(asked, margin_length=_margin_length(request)))
    if request.want_impact:
        settle_in_space(response, question, answer.verdict)
    response.out_of_plane = math.nan


def _margin_length(request: Any) -> float | None:
    """Return the metric's length that a request asks for, m; None: the radius of gyration."""
    return check_not_negative("margin_length", request.margin_length) or None


def _friction_facets(request: Any) -> int:
    facets = int(request.friction_facets)
    if facets != 0 and not 3 <= facets <= MOST_FRICTION_FACETS:
        allowed = f"0, or a whole number from 3 to {MOST_FRICTION_FACETS}"
        raise InvalidFieldError("friction_facets", facets, allowed)
    return facets or FRICTION_FACETS
