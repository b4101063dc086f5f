"""Answers about contact modes to the service's response, in world axes."""

from __future__ import annotations

import math
from itertools import repeat
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics_interfaces.msg import ContactMode, ModeWrenches
from contact_dynamics_interfaces.srv import PredictContactMode
from msg_adapters.body_state import body_state_to_msg
from msg_adapters.contacts import contacts_to_msg, flat
from msg_adapters.geometry import vector_to_msg
from msg_adapters.impact import resolved_impact_to_msg

if TYPE_CHECKING:
    from contact_dynamics.contact_modes import (
        BodyStatics,
        RefusedMode,
        SpatialMode,
        SpatialModeMargin,
        SpatialWrenchSet,
    )
    from contact_dynamics.questions.contact_modes import ContactModeAnswer
    from contact_dynamics.questions.settled_impact import SettledImpact


def contact_mode_answer_to_msg(
    answer: ContactModeAnswer, *, world_frame: str, into: PredictContactMode.Response | None = None
) -> PredictContactMode.Response:
    """Return an answer as a response: a new one, or the empty one to fill."""
    msg = PredictContactMode.Response() if into is None else into
    margins = repeat(None) if answer.margins is None else answer.margins
    msg.verdict = int(answer.verdict)
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
    return msg


def mode_to_msg(mode: SpatialMode, margin: SpatialModeMargin | None = None) -> ContactMode:
    """Return a mode, with its margin where that was asked for."""
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


def _write_refused(msg: PredictContactMode.Response, modes: tuple[RefusedMode, ...]) -> None:
    """Write which modes mechanics refuses, and why."""
    msg.refused_modes = [refused.mode for refused in modes]
    msg.refusals = [int(refused.refusal) for refused in modes]
    msg.refused_contacts = [refused.contact for refused in modes]
    msg.refusal_amounts = flat(np.array([refused.amount for refused in modes]))


def _write_statics(msg: PredictContactMode.Response, statics: BodyStatics | None) -> None:
    """Write the answers to the static questions."""
    msg.stable_disturbance = math.nan
    if statics is not None:
        msg.equilibrium = int(statics.equilibrium)
        msg.jammed = int(statics.jammed)
        msg.wedged = msg.POSSIBLE if statics.wedged else msg.NO
        msg.stable_disturbance = statics.stable_disturbance


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
