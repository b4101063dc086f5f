"""Converts questions and answers about contact modes to the service's request and response, and back.

All vectors are in world axes.
"""

from __future__ import annotations

import math
from itertools import repeat
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact.uncertainty import EXACT_CONTACTS, ContactUncertainty
from contact_dynamics.contact_modes.result import (
    BodyStatics,
    Certainty,
    ModeProbability,
    ModeVerdict,
    Refusal,
    RefusedMode,
)
from contact_dynamics.contact_modes.spatial.margins import SpatialModeMargin
from contact_dynamics.contact_modes.spatial.result import SpatialMode
from contact_dynamics.contact_modes.spatial.wrench_sets import SpatialWrenchSet
from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions.contact_modes import ContactModeAnswer, ContactModeQuestion
from contact_dynamics.questions.problem import Problem
from contact_dynamics.questions.settled_impact import SettledImpact
from contact_dynamics.questions.subject import PublishedState
from contact_dynamics_interfaces.msg import ContactMode, ModeWrenches
from contact_dynamics_interfaces.srv import PredictContactMode
from msg_adapters.asked_fields import (
    NOTHING,
    asked_contacts,
    asked_gravity,
    asked_plane,
    asked_problem,
    optional,
    write_contacts,
    write_given,
    write_gravity,
    write_problem,
)
from msg_adapters.asked_subject import asked_subject, write_subject
from msg_adapters.body_state import body_state_from_msg, body_state_to_msg, center_of_mass
from msg_adapters.contacts import contacts_from_msg, contacts_to_msg, flat, rows
from msg_adapters.field_names import WRENCH_FIELDS, renamed
from msg_adapters.geometry import vector_from_msg, vector_to_msg, wrench_to_msg
from msg_adapters.geometry_margins import (
    geometry_margin_from_msg,
    geometry_margin_to_msg,
    uncertainty_from_msg,
    within_from_msg,
    write_uncertainty,
    write_within,
)
from msg_adapters.impact import resolved_impact_from_msg, resolved_impact_to_msg
from msg_adapters.status import with_warnings, without_warnings
from msg_adapters.unread_fields import CONTACT_MODE, check_unread

if TYPE_CHECKING:
    from collections.abc import Iterable

    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import World
    from contact_dynamics_interfaces.srv import PredictContactModeBatch
    from msg_adapters.unread_fields import ReadIf

_WEDGED: Final = {True: Certainty.POSSIBLE, False: Certainty.NO, None: Certainty.UNKNOWN}
"""Answers to whether a body is wedged, as they are in the message."""


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
            friction_facets=optional(request.friction_facets),
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
    friction_facets: int | None = None,
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
        friction_facets: As the question's.
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
        friction_facets=friction_facets,
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


def contact_mode_question_to_msg(
    question: ContactModeQuestion, *, world: World, world_frame: str
) -> PredictContactMode.Request:
    """Return the request of a question about contact modes, as in `tumbling_question_to_msg`."""
    msg = PredictContactMode.Request()
    write_contact_modes(msg, question, world, world_frame)
    write_given(msg, friction_facets=question.friction_facets)
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
    write_contacts(msg, question.contacts)
    write_gravity(msg, question.gravity_W)
    write_problem(msg, question)
    write_given(msg, margin_length=question.margin_length)
    msg.include_margins = question.include_margins


def contact_mode_answer_to_msg(
    answer: ContactModeAnswer, *, world_frame: str, into: PredictContactMode.Response | None = None
) -> PredictContactMode.Response:
    """Return an answer as a response, which is new unless an empty one to fill is given."""
    msg = PredictContactMode.Response() if into is None else into
    margins = repeat(None) if answer.margins is None else answer.margins
    msg.verdict = int(answer.verdict)
    msg.message = with_warnings(answer.undecided, answer.warnings)
    msg.modes = [mode_to_msg(mode, margin) for mode, margin in zip(answer.modes, margins, strict=False)]
    msg.approaching_contacts = list(answer.approaching)
    msg.contact_velocities = flat(answer.contact_velocities_W)
    msg.kinematic_modes = list(answer.kinematic_modes)
    _write_refused(msg, answer.refused)
    if answer.wrench_sets is not None:
        msg.wrench_sets = [wrench_set_to_msg(wrenches) for wrenches in answer.wrench_sets]
    _write_statics(msg, answer.statics)
    if answer.settled is not None:
        _write_settled(msg, answer, answer.settled, world_frame)
    msg.problem = int(answer.problem)
    body_state_to_msg(
        answer.state,
        body_name=answer.body_name,
        world_frame=world_frame,
        p_FB_F=answer.p_FB_F,
        into=msg.state,
    )
    contacts_to_msg(answer.contacts, into=msg.contacts)
    if answer.plane is not None:
        msg.plane_normal = vector_to_msg(answer.plane.normal_W)
    msg.out_of_plane = answer.out_of_plane
    msg.out_of_plane_reason = answer.out_of_plane_reason
    msg.velocity_tolerance = answer.velocity_tolerance
    msg.acceleration_tolerance = answer.acceleration_tolerance
    msg.distance_tolerance = answer.distance_tolerance
    msg.friction_facets = answer.friction_facets
    msg.wrench_facets = answer.wrench_facets
    msg.undecided_modes = list(answer.undecided_modes)
    write_within(answer.within, msg)
    msg.geometry_margins = [geometry_margin_to_msg(margin) for margin in answer.geometry_margins or ()]
    msg.probable_modes = [each.mode for each in answer.probabilities or ()]
    msg.mode_probabilities = [each.probability for each in answer.probabilities or ()]
    return msg


def contact_mode_answer_from_msg(msg: PredictContactMode.Response, *, world: World) -> ContactModeAnswer:
    """Return the answer that a response contains. ``world`` knows the body's centre of mass.

    If there is no mode, the response does not say whether margins were asked for.

    Raises:
        InvalidFieldError: arrays have unequal lengths, or a number is not allowed.
    """
    p_FB_F = center_of_mass(msg.state.body_name, world)
    margins = tuple(filter(None, map(margin_from_msg, msg.modes)))
    wrench_sets = tuple(wrench_set_from_msg(wrenches) for wrenches in msg.wrench_sets)
    is_planar = msg.problem == PredictContactMode.Request.PLANAR
    undecided, warnings = without_warnings(msg.message)
    return ContactModeAnswer(
        body_name=msg.state.body_name,
        p_FB_F=p_FB_F,
        state=body_state_from_msg(msg.state, world_frame=msg.state.header.frame_id, p_FB_F=p_FB_F),
        contacts=contacts_from_msg(msg.contacts),
        verdict=ModeVerdict(msg.verdict),
        modes=tuple(mode_from_msg(mode) for mode in msg.modes),
        margins=margins or None,
        approaching=tuple(msg.approaching_contacts),
        contact_velocities_W=rows(msg.contact_velocities),
        refused=_read_refused(msg),
        kinematic_modes=tuple(msg.kinematic_modes),
        wrench_sets=wrench_sets or None,
        statics=_read_statics(msg),
        settled=_read_settled(msg, p_FB_F) if msg.impact else None,
        problem=Problem(msg.problem),
        plane=PlaneOfMotion(normal_W=vector_from_msg(msg.plane_normal)) if is_planar else None,
        out_of_plane=msg.out_of_plane,
        out_of_plane_reason=msg.out_of_plane_reason,
        velocity_tolerance=msg.velocity_tolerance,
        acceleration_tolerance=msg.acceleration_tolerance,
        distance_tolerance=msg.distance_tolerance,
        friction_facets=msg.friction_facets,
        wrench_facets=msg.wrench_facets,
        undecided=undecided,
        warnings=warnings,
        undecided_modes=tuple(msg.undecided_modes),
        within=within_from_msg(msg),
        geometry_margins=tuple(geometry_margin_from_msg(margin) for margin in msg.geometry_margins) or None,
        probabilities=tuple(
            ModeProbability(mode=mode, probability=probability)
            for mode, probability in zip(msg.probable_modes, msg.mode_probabilities, strict=True)
        )
        or None,
    )


def mode_to_msg(mode: SpatialMode, margin: SpatialModeMargin | None = None) -> ContactMode:
    """Return a mode as a message, with its margin if that was asked for."""
    msg = ContactMode(
        mode=mode.mode,
        linear_acceleration=mode.acceleration_W,
        angular_acceleration=mode.angular_acceleration_W,
        contact_forces=flat(mode.contact_forces_W),
        forces_unique=mode.forces_unique,
        motion_unique=mode.motion_unique,
        contact_accelerations=flat(mode.contact_accelerations_W),
        tangential_directions=flat(mode.tangential_directions_W),
        misdirection=mode.misdirection,
        margin=math.nan,
    )
    if margin is not None:
        msg.margin = margin.margin
        msg.margin_length = margin.length
        msg.margin_wrench = margin.change_W
        msg.margin_verdict = int(margin.verdict_beyond)
        msg.margin_modes = list(margin.modes_beyond)
    return msg


def mode_from_msg(msg: ContactMode) -> SpatialMode:
    """Return the mode in a message, without its margin."""
    return SpatialMode(
        mode=msg.mode,
        acceleration_W=np.array(msg.linear_acceleration),
        angular_acceleration_W=np.array(msg.angular_acceleration),
        contact_forces_W=rows(msg.contact_forces),
        contact_accelerations_W=rows(msg.contact_accelerations),
        tangential_directions_W=rows(msg.tangential_directions),
        misdirection=msg.misdirection,
        forces_unique=msg.forces_unique,
        motion_unique=msg.motion_unique,
    )


def margin_from_msg(msg: ContactMode) -> SpatialModeMargin | None:
    """Return the margin of the mode in a message, or None if it was not asked for."""
    if msg.margin_length == 0.0:
        return None
    return SpatialModeMargin(
        mode=msg.mode,
        margin=msg.margin,
        length=msg.margin_length,
        change_W=np.array(msg.margin_wrench),
        verdict_beyond=ModeVerdict(msg.margin_verdict),
        modes_beyond=tuple(msg.margin_modes),
    )


def wrench_set_to_msg(wrenches: SpatialWrenchSet) -> ModeWrenches:
    """Return the applied wrenches of one mode, in space with one way of sliding."""
    return ModeWrenches(
        mode=wrenches.mode,
        vertices=flat(wrenches.vertices),
        generators=flat(wrenches.generators),
        half_spaces=flat(wrenches.half_spaces),
        sliding_from=flat(wrenches.sliding_from_W),
        sliding_to=flat(wrenches.sliding_to_W),
    )


def wrench_set_from_msg(msg: ModeWrenches) -> SpatialWrenchSet:
    """Return the applied wrenches of one mode, in space with one way of sliding."""
    return SpatialWrenchSet(
        mode=msg.mode,
        sliding_from_W=rows(msg.sliding_from),
        sliding_to_W=rows(msg.sliding_to),
        vertices=rows(msg.vertices, 6),
        generators=rows(msg.generators, 6),
        half_spaces=rows(msg.half_spaces, 7),
    )


def _write_refused(msg: PredictContactMode.Response, modes: tuple[RefusedMode, ...]) -> None:
    """Write the modes that mechanics refuses, with the reasons."""
    msg.refused_modes = [refused.mode for refused in modes]
    msg.refusals = [int(refused.refusal) for refused in modes]
    msg.refused_contacts = [refused.contact for refused in modes]
    msg.refusal_amounts = flat(np.array([refused.amount for refused in modes]))


def _read_refused(msg: PredictContactMode.Response) -> tuple[RefusedMode, ...]:
    """Return the modes that mechanics refuses, with the reasons."""
    columns = zip(msg.refused_modes, msg.refusals, msg.refused_contacts, msg.refusal_amounts, strict=True)
    return tuple(
        RefusedMode(mode=mode, refusal=Refusal(refusal), contact=contact, amount=amount)
        for mode, refusal, contact, amount in columns
    )


def _write_statics(msg: PredictContactMode.Response, statics: BodyStatics | None) -> None:
    """Write the answers to the static questions."""
    msg.stable_disturbance = math.nan
    if statics is not None:
        msg.equilibrium = int(statics.equilibrium)
        msg.jammed = int(statics.jammed)
        msg.wedged = int(_WEDGED[statics.wedged])
        msg.stable_disturbance = statics.stable_disturbance


def _read_statics(msg: PredictContactMode.Response) -> BodyStatics | None:
    """Return the answers to the static questions. The length that compares torques is not in the message."""
    if msg.equilibrium == msg.NOT_ASKED:
        return None
    return BodyStatics(
        equilibrium=Certainty(msg.equilibrium),
        jammed=Certainty(msg.jammed),
        wedged=next(wedged for wedged, certainty in _WEDGED.items() if certainty == msg.wedged),
        stable_disturbance=msg.stable_disturbance,
        margin_length=math.nan,
    )


def _write_settled(
    msg: PredictContactMode.Response, answer: ContactModeAnswer, settled: SettledImpact, world_frame: str
) -> None:
    """Write the impact that settles a case, and the modes after it."""
    msg.impact = [
        resolved_impact_to_msg(
            settled.impact,
            body_name=answer.body_name,
            p_FB_F=answer.p_FB_F,
            world_frame=world_frame,
        )
    ]
    msg.verdict_after_impact = int(settled.verdict)
    msg.modes_after_impact = [mode_to_msg(mode) for mode in settled.modes]


def _read_settled(msg: PredictContactMode.Response, p_FB_F: FloatArray) -> SettledImpact:
    """Return the impact that settles a case, and the modes after it."""
    return SettledImpact(
        impact=resolved_impact_from_msg(msg.impact[0], p_FB_F=p_FB_F),
        verdict=ModeVerdict(msg.verdict_after_impact),
        modes=tuple(mode_from_msg(mode) for mode in msg.modes_after_impact),
    )
