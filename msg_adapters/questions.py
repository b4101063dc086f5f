"""Converts requests about tumbling, impacts and contact modes to questions.

Its neighbours `batches`, `contact_mode_batch` and `toss` read the requests of the other services. All of them
read shared fields with `asked_fields`.

A number with its field's default (`LEFT_OUT`) is left out. A value in a field that has no effect, such as a
horizon if the contacts are given, is an error (`unread_fields`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from contact_dynamics.contact.uncertainty import EXACT_CONTACTS, ContactUncertainty
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.questions.contact_modes import ContactModeQuestion
from contact_dynamics.questions.impact_question import ImpactQuestion
from contact_dynamics.questions.tumbling import TumblingQuestion
from msg_adapters.asked_fields import (
    NOTHING,
    asked_contacts,
    asked_drag,
    asked_gravity,
    asked_plane,
    asked_problem,
    asked_restitution_law,
    asked_sampling,
    asked_several_contacts_law,
    asked_wrench,
    optional,
)
from msg_adapters.asked_subject import asked_other, asked_subject
from msg_adapters.field_names import WRENCH_FIELDS, renamed
from msg_adapters.geometry import vector_from_msg
from msg_adapters.geometry_margins import uncertainty_from_msg
from msg_adapters.unread_fields import CONTACT_MODE, IMPACT, TUMBLING, check_unread

if TYPE_CHECKING:
    from collections.abc import Iterable

    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import World
    from contact_dynamics_interfaces.srv import (
        PredictContactMode,
        PredictContactModeBatch,
        PredictImpact,
        PredictTumbling,
    )
    from msg_adapters.unread_fields import ReadIf


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
    gravity_W, wrench, drag = asked_gravity(request), asked_wrench(request), asked_drag(request)
    body, state = asked_subject(request, world, world_frame, fit_window=request.fit_window)
    sampling = asked_sampling(request)
    check_unread(request, TUMBLING)
    return TumblingQuestion(
        body=body,
        state=state,
        sampling=sampling,
        gravity_W=gravity_W,
        wrench=wrench,
        drag=drag,
        include_covariance=request.include_covariance,
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
    problem, law = asked_problem(request.problem), asked_several_contacts_law(request)
    body, state = asked_subject(request, world, world_frame, fit_window=request.fit_window)
    other, other_state = asked_other(request, world, world_frame)
    contacts = asked_contacts(request)
    check_unread(request, IMPACT)
    return ImpactQuestion(
        body=body,
        state=state,
        other=other,
        other_state=other_state,
        contacts=contacts,
        horizon=optional(request.horizon),
        restitution_law=asked_restitution_law(request.restitution_law),
        several_contacts_law=law,
        include_orders=request.include_orders,
        include_covariance=request.include_covariance,
        problem=problem,
        plane=asked_plane(request.plane_normal),
        out_of_plane_tolerance=optional(request.out_of_plane_tolerance),
        velocity_tolerance=optional(request.velocity_tolerance),
        distance_tolerance=optional(request.distance_tolerance),
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
            read_if=CONTACT_MODE,
            force_W=vector_from_msg(request.applied_wrench.force),
            torque_W=vector_from_msg(request.applied_wrench.torque),
            include_wrenches=request.include_wrenches,
            include_statics=request.include_statics,
            include_impact=request.include_impact,
            uncertainty=uncertainty_from_msg(request),
            include_geometry_margins=request.include_geometry_margins,
            include_probabilities=request.include_probabilities,
        )
    except InvalidFieldError as error:
        raise renamed(error, WRENCH_FIELDS) from None


def asked_contact_modes(
    request: PredictContactMode.Request | PredictContactModeBatch.Request,
    world: World,
    world_frame: str,
    *,
    read_if: Iterable[ReadIf],
    force_W: FloatArray = NOTHING,
    torque_W: FloatArray = NOTHING,
    include_wrenches: bool = False,
    include_statics: bool = False,
    include_impact: bool = False,
    uncertainty: ContactUncertainty = EXACT_CONTACTS,
    include_geometry_margins: bool = False,
    include_probabilities: bool = False,
) -> ContactModeQuestion:
    """Return the question of what requests about one candidate and about many have in common.

    Args:
        request: The request.
        world: The bodies that it can name.
        world_frame: The frame that an explicit state must be in.
        read_if: The fields of it that are not always read.
        force_W: The question's own, as what follows.
        torque_W: As the question's.
        include_wrenches: As the question's.
        include_statics: As the question's.
        include_impact: As the question's.
        uncertainty: As the question's.
        include_geometry_margins: As the question's.
        include_probabilities: As the question's.

    Raises:
        ContactDynamicsError: a field holds what is not allowed, or names a body that is not known.
    """
    problem, contacts, gravity_W = (
        asked_problem(request.problem),
        asked_contacts(request),
        asked_gravity(request),
    )
    body, state = asked_subject(request, world, world_frame)
    check_unread(request, read_if)
    return ContactModeQuestion(
        body=body,
        state=state,
        contacts=contacts,
        gravity_W=gravity_W,
        problem=problem,
        plane=asked_plane(request.plane_normal),
        out_of_plane_tolerance=optional(request.out_of_plane_tolerance),
        velocity_tolerance=optional(request.velocity_tolerance),
        distance_tolerance=optional(request.distance_tolerance),
        friction_facets=optional(request.friction_facets),
        margin_length=optional(request.margin_length),
        force_W=force_W,
        torque_W=torque_W,
        include_margins=request.include_margins,
        include_wrenches=include_wrenches,
        include_statics=include_statics,
        include_impact=include_impact,
        uncertainty=uncertainty,
        include_geometry_margins=include_geometry_margins,
        include_probabilities=include_probabilities,
    )
