"""Answers about impacts to the service's response, and impacts to messages.

Messages are new, or, for ``into``, the empty ones that a response has already: they cost more to build than
to fill.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.rigid_body.published_frame import origin_of_published_frame
from contact_dynamics_interfaces.msg import Impact as ImpactMsg
from contact_dynamics_interfaces.srv import PredictImpact
from msg_adapters.body_state import body_state_to_msg
from msg_adapters.contacts import contacts_to_msg, flat
from msg_adapters.geometry import vector_to_msg
from msg_adapters.tumbling import write_fit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.questions.impact import ImpactAnswer, StruckBody
    from contact_dynamics.questions.resolved_impact import ResolvedImpact
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray


def impact_answer_to_msg(
    answer: ImpactAnswer, *, world_frame: str, into: PredictImpact.Response | None = None
) -> PredictImpact.Response:
    """Return an answer as a response: a new one, or the empty one to fill."""
    msg = PredictImpact.Response() if into is None else into
    name, p_FB_F, other = answer.body_name, answer.p_FB_F, answer.other
    resolved_impact_to_msg(
        answer.impact, body_name=name, p_FB_F=p_FB_F, world_frame=world_frame, other=other, into=msg.impact
    )
    write_fit(msg, answer.fit)
    msg.time_to_contact = answer.seconds_to_contact
    msg.problem = int(answer.problem)
    body_state_to_msg(
        answer.state, body_name=name, world_frame=world_frame, p_FB_F=p_FB_F, into=msg.state_before
    )
    if other is not None:
        msg.other_state_before = [
            body_state_to_msg(other.state, body_name=other.name, world_frame=world_frame, p_FB_F=other.p_FB_F)
        ]
    contacts_to_msg(answer.contacts, into=msg.contacts)
    if answer.plane is not None:
        msg.plane_normal = vector_to_msg(answer.plane.normal_W)
    msg.out_of_plane = answer.out_of_plane
    msg.velocity_tolerance = answer.velocity_tolerance
    msg.distance_tolerance = answer.distance_tolerance
    return msg


def resolved_impact_to_msg(
    impact: ResolvedImpact,
    *,
    body_name: str,
    p_FB_F: FloatArray,
    world_frame: str,
    other: StruckBody | None = None,
    into: ImpactMsg | None = None,
) -> ImpactMsg:
    """Return an impact of a body whose centre of mass is at ``p_FB_F``, (3,), m, in its published frame."""
    msg = ImpactMsg() if into is None else into
    msg.restitution_law = int(impact.restitution_law)
    msg.several_contacts_law = (
        PredictImpact.Request.SEQUENTIAL_IN_TIME if impact.strikes else int(impact.several_contacts_law)
    )
    msg.outcome = ImpactMsg.NOT_TOLD if impact.outcome is None else int(impact.outcome)
    msg.jams = impact.jams
    msg.converged = impact.converged
    body_state_to_msg(
        impact.state, body_name=body_name, world_frame=world_frame, p_FB_F=p_FB_F, into=msg.state_after
    )
    if other is not None and impact.other_state is not None:
        msg.other_state_after = [
            body_state_to_msg(
                impact.other_state, body_name=other.name, world_frame=world_frame, p_FB_F=other.p_FB_F
            )
        ]
    msg.impulses = flat(impact.impulses_W)
    msg.compression_impulses = flat(impact.compression_impulses_W)
    msg.contact_velocities_before = flat(impact.velocities_before_W)
    msg.contact_velocities_after = flat(impact.velocities_after_W)
    msg.path = flat(impact.path_W)
    msg.path_events = [int(event) for event in impact.path_events]
    msg.path_contacts = list(impact.path_contacts)
    msg.kinetic_energy_before = impact.kinetic_energy_before
    msg.kinetic_energy_after = impact.kinetic_energy_after
    msg.creates_energy = impact.creates_energy
    if impact.orders:
        msg.orders = [",".join(map(str, order)) for order in impact.orders]
        msg.order_velocities = flat(impact.order_velocities_W)
    if impact.covariance is not None:
        msg.state_after.covariance = flat(impact.covariance)
    if impact.outcome_probabilities is not None:
        msg.outcome_probabilities = flat(impact.outcome_probabilities)
        msg.miss_probability = impact.miss_probability
    if impact.strikes:
        _write_strikes(msg, impact, p_FB_F)
    return msg


def _write_strikes(msg: ImpactMsg, impact: ResolvedImpact, p_FB_F: FloatArray) -> None:
    """Write strikes in time, and why there is no further one."""
    strikes = impact.strikes
    msg.strike_times = [strike.seconds for strike in strikes]
    msg.strike_contacts = [strike.contact for strike in strikes]
    msg.strike_outcomes = [int(strike.outcome) for strike in strikes]
    msg.strike_positions = flat(np.array([strike.p_WC_W for strike in strikes]))
    msg.strike_impulses = flat(np.array([strike.impulse_W for strike in strikes]))
    msg.strike_body_positions = flat(
        np.array([origin_of_published_frame(strike.state_before, p_FB_F) for strike in strikes])
    )
    msg.strike_body_orientations = flat(np.array([strike.state_before.q_WB for strike in strikes]))
    msg.strike_velocities_before = flat(_twists([strike.state_before for strike in strikes]))
    msg.strike_velocities_after = flat(_twists([strike.state_after for strike in strikes]))
    if impact.end is not None:
        msg.sequence_end = int(impact.end)
    msg.staying_contacts = list(impact.staying)
    msg.limit_time = 0.0 if impact.limit_seconds is None else impact.limit_seconds


def _twists(states: Sequence[BodyState]) -> FloatArray:
    return np.array([np.concatenate([state.v_WB_W, state.w_WB_W]) for state in states])
