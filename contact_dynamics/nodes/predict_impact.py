"""Answers `~/predict_impact`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from contact_dynamics.errors import InvalidFieldError, NoContactError, NotSupportedError
from contact_dynamics.impact import RestitutionLaw, planar_impact, spatial_impact
from contact_dynamics.landing import next_landing
from contact_dynamics.nodes.subject import (
    Knowledge,
    Subject,
    check_has_shape,
    contacts_of,
    distance_tolerance_of,
    or_configured,
    planar_problem_of,
    subject_of,
    velocity_tolerance_of,
)
from msg_adapters.contacts import contacts_to_msg
from msg_adapters.geometry import vector_to_msg
from msg_adapters.impact import planar_impact_to_msg, spatial_impact_to_msg

if TYPE_CHECKING:
    from contact_dynamics.contact import ContactSet
    from contact_dynamics.rigid_body import BodyState
    from contact_dynamics_interfaces.msg import Impact as ImpactMsg

_NO_WRENCH = np.zeros(3)


def predict_impact(request: Any, response: Any, knowledge: Knowledge) -> None:
    """Answer one request, or raise a `ContactDynamicsError` that says what is wrong with it."""
    _refuse_what_is_not_answered_yet(request)
    law = _law_of(request)
    subject = subject_of(request, knowledge)
    seconds, before, contacts = _strike(request, subject, knowledge)
    if len(contacts) > 1:
        message = f"contacts: found {len(contacts)} at once, allowed is 1 in this version"
        raise NotSupportedError(message)
    if request.problem == request.PLANAR:
        response.problem = request.PLANAR
        response.impact = _in_plane(request, response, subject, before, contacts, law, knowledge)
    elif request.problem in (request.AUTOMATIC, request.SPATIAL):  # space contains the plane
        response.problem = request.SPATIAL
        response.impact = _in_space(request, subject, before, contacts, law, knowledge)
    else:
        raise InvalidFieldError("problem", request.problem, "AUTOMATIC (0), PLANAR (1) or SPATIAL (2)")
    response.time_to_contact = seconds
    response.state_before = subject.state_to_msg(before)
    response.contacts = contacts_to_msg(contacts)
    response.velocity_tolerance = velocity_tolerance_of(request, knowledge)
    response.distance_tolerance = distance_tolerance_of(request, knowledge)


def _refuse_what_is_not_answered_yet(request: Any) -> None:
    for field in ("want_orders", "want_covariance"):
        if getattr(request, field):
            raise NotSupportedError(f"{field}: found true, allowed is false in this version")
    if request.other_body_name or request.other_inertia.m != 0.0 or len(request.other_state) > 0:
        message = "other_body_name, other_state, other_inertia: found a second body, allowed is none in this version"
        raise NotSupportedError(message)
    if request.several_contacts_law != request.SEQUENTIAL:
        message = f"several_contacts_law: found {request.several_contacts_law}, allowed is SEQUENTIAL (0) in this version"
        raise NotSupportedError(message)


def _law_of(request: Any) -> RestitutionLaw:
    try:
        return RestitutionLaw(request.restitution_law)
    except ValueError:
        raise InvalidFieldError(
            "restitution_law", request.restitution_law, "POISSON (0), NEWTON (1) or ENERGETIC (2)"
        ) from None


def _strike(request: Any, subject: Subject, knowledge: Knowledge) -> tuple[float, BodyState, ContactSet]:
    """Return when the impact is, s after the state's stamp, the state just before it, and the contacts that strike."""
    if request.contact_source != request.CONTACTS_FROM_GEOMETRY:
        return 0.0, subject.state, contacts_of(request, subject, knowledge)
    check_has_shape(subject.body)
    horizon = or_configured("horizon", request.horizon, knowledge.parameters.horizon)
    landing = next_landing(
        subject.body,
        subject.state,
        knowledge.parameters.world,
        horizon=horizon,
        distance_tolerance=distance_tolerance_of(request, knowledge),
        velocity_tolerance=velocity_tolerance_of(request, knowledge),
    )
    if landing is None:
        message = f"contacts: {subject.body.name!r} touches no surface within the horizon of {horizon:g} s"
        raise NoContactError(message)
    if not landing.strikes:
        message = (
            f"contacts: {subject.body.name!r} touches {landing.contacts.surfaces[0]!r} and does not approach it by "
            f"more than {velocity_tolerance_of(request, knowledge):g} m/s (~/predict_contact_mode says what follows)"
        )
        raise NoContactError(message)
    return landing.seconds, landing.state, landing.contacts


def _in_space(
    request: Any,
    subject: Subject,
    before: BodyState,
    contacts: ContactSet,
    law: RestitutionLaw,
    knowledge: Knowledge,
) -> ImpactMsg:
    body = subject.body.mass_properties
    impact = spatial_impact(
        body,
        before,
        p_WC_W=contacts.p_WC_W[0],
        n_W=contacts.normals_W[0],
        friction=float(contacts.frictions[0]),
        restitution=float(contacts.restitutions[0]),
        law=law,
        velocity_tolerance=velocity_tolerance_of(request, knowledge),
    )
    return spatial_impact_to_msg(impact, body=body, before=before, state_to_msg=subject.state_to_msg)


def _in_plane(
    request: Any,
    response: Any,
    subject: Subject,
    before: BodyState,
    contacts: ContactSet,
    law: RestitutionLaw,
    knowledge: Knowledge,
) -> ImpactMsg:
    body = subject.body.mass_properties
    problem = planar_problem_of(
        request, subject.body, before, contacts, knowledge, force_W=_NO_WRENCH, torque_W=_NO_WRENCH
    )
    impact = planar_impact(
        problem.body,
        problem.velocity,
        problem.contacts[0],
        law=law,
        velocity_tolerance=velocity_tolerance_of(request, knowledge),
    )
    response.plane_normal = vector_to_msg(problem.plane.normal_W)
    response.out_of_plane = problem.out_of_plane
    return planar_impact_to_msg(
        impact, problem, contact=0, body=body, before=before, state_to_msg=subject.state_to_msg
    )
