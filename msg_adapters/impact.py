"""Converts questions and answers about impacts to the service's request and response, and back.

Messages are new, unless ``into`` is an empty one that a response has already. A message costs more to build
than to fill.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.constants import ns_after
from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_dynamics.impact.in_time.result import SequenceEnd
from contact_dynamics.impact.in_time.sequence import MAX_STRIKES, STRIKE_WINDOW
from contact_dynamics.impact.law import ImpactOutcome, PathEvent, RestitutionLaw
from contact_dynamics.impact.several.result import SeveralContactsLaw
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions.impact_answer import ImpactAnswer, StruckBody
from contact_dynamics.questions.impact_question import ImpactQuestion, InTime
from contact_dynamics.questions.problem import Problem
from contact_dynamics.questions.resolved_impact import ResolvedImpact, SequenceStrike
from contact_dynamics.questions.subject import PublishedState
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rigid_body.published_frame import centers_of_mass, origin_of_published_frame
from contact_dynamics_interfaces.msg import Impact as ImpactMsg
from contact_dynamics_interfaces.srv import PredictImpact
from msg_adapters.asked_fields import (
    asked_contacts,
    asked_plane,
    asked_problem,
    asked_restitution_law,
    optional,
    write_contacts,
    write_given,
    write_problem,
)
from msg_adapters.asked_subject import asked_inertia, asked_other, asked_subject, write_fitted_subject
from msg_adapters.body_state import body_state_from_msg, body_state_to_msg, center_of_mass, known_state_to_msg
from msg_adapters.contacts import contacts_from_msg, contacts_to_msg, flat, rows
from msg_adapters.geometry import vector_from_msg, vector_to_msg
from msg_adapters.stamps import stamp_ns_from_msg
from msg_adapters.status import with_warnings, without_warnings
from msg_adapters.tumbling import read_fit, write_fit
from msg_adapters.unread_fields import IMPACT, check_unread

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.questions.subject import StateSource
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body, World
    from contact_dynamics_interfaces.msg import BodyState as BodyStateMsg


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
    problem, law = asked_problem(request.problem), _several_contacts_law(request)
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


def _several_contacts_law(request: PredictImpact.Request) -> SeveralContactsLaw | InTime:
    """Return the law for several contacts that a request asks for, or raise `InvalidFieldError`."""
    value = request.several_contacts_law
    if value == request.SEQUENTIAL_IN_TIME:
        window = optional(request.strike_window)
        most = optional(request.max_strikes)
        return InTime(
            strike_window=STRIKE_WINDOW if window is None else window,
            max_strikes=MAX_STRIKES if most is None else most,
            hold_step=request.hold_step or None,
        )
    try:
        return SeveralContactsLaw(value)
    except ValueError:
        allowed = "SEQUENTIAL (0), SIMULTANEOUS (1), SEQUENTIAL_IN_TIME (2)"
        raise InvalidFieldError("several_contacts_law", value, allowed) from None


def impact_question_to_msg(
    question: ImpactQuestion, *, world: World, world_frame: str
) -> PredictImpact.Request:
    """Return the request of a question about an impact, with arguments as in `tumbling_question_to_msg`."""
    msg = PredictImpact.Request()
    write_fitted_subject(msg, question.body, question.state, world, world_frame)
    if question.other is not None:
        _write_other(msg, question.other, question.other_state, world, world_frame)
    write_contacts(msg, question.contacts)
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
    write_problem(msg, question)
    return msg


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


def impact_answer_to_msg(
    answer: ImpactAnswer, *, world_frame: str, into: PredictImpact.Response | None = None
) -> PredictImpact.Response:
    """Return an answer as a response, which is new unless an empty one to fill is given."""
    msg = PredictImpact.Response() if into is None else into
    name, p_FB_F, other = answer.body_name, answer.p_FB_F, answer.other
    resolved_impact_to_msg(
        answer.impact, body_name=name, p_FB_F=p_FB_F, world_frame=world_frame, other=other, into=msg.impact
    )
    msg.message = with_warnings("", answer.warnings)
    write_fit(msg, answer.fit)
    msg.time_to_contact = answer.seconds_to_contact
    msg.problem = int(answer.problem)
    body_state_to_msg(
        answer.state, body_name=name, world_frame=world_frame, p_FB_F=p_FB_F, into=msg.state_before
    )
    if other is not None:
        msg.other_state_before = [struck_body_to_msg(other, world_frame=world_frame)]
    contacts_to_msg(answer.contacts, into=msg.contacts)
    if answer.plane is not None:
        msg.plane_normal = vector_to_msg(answer.plane.normal_W)
    msg.out_of_plane = answer.out_of_plane
    msg.velocity_tolerance = answer.velocity_tolerance
    msg.distance_tolerance = answer.distance_tolerance
    return msg


def impact_answer_from_msg(msg: PredictImpact.Response, *, world: World) -> ImpactAnswer:
    """Return the answer that a response contains. ``world`` knows the bodies' centres of mass.

    Raises:
        InvalidFieldError: arrays have unequal lengths, or a number is not allowed.
    """
    p_FB_F = center_of_mass(msg.state_before.body_name, world)
    other = struck_body_from_msg(msg.other_state_before[0], world=world) if msg.other_state_before else None
    is_planar = msg.problem == PredictImpact.Request.PLANAR
    return ImpactAnswer(
        body_name=msg.state_before.body_name,
        p_FB_F=p_FB_F,
        state=body_state_from_msg(
            msg.state_before, world_frame=msg.state_before.header.frame_id, p_FB_F=p_FB_F
        ),
        fit=read_fit(msg),
        other=other,
        seconds_to_contact=msg.time_to_contact,
        contacts=contacts_from_msg(msg.contacts),
        impact=resolved_impact_from_msg(
            msg.impact, p_FB_F=p_FB_F, other_p_FB_F=None if other is None else other.p_FB_F
        ),
        problem=Problem(msg.problem),
        plane=PlaneOfMotion(normal_W=vector_from_msg(msg.plane_normal)) if is_planar else None,
        out_of_plane=msg.out_of_plane,
        velocity_tolerance=msg.velocity_tolerance,
        distance_tolerance=msg.distance_tolerance,
        warnings=without_warnings(msg.message)[1],
    )


def struck_body_to_msg(other: StruckBody, *, world_frame: str) -> BodyStateMsg:
    """Return the second body just before the impact as a message."""
    return body_state_to_msg(other.state, body_name=other.name, world_frame=world_frame, p_FB_F=other.p_FB_F)


def struck_body_from_msg(msg: BodyStateMsg, *, world: World) -> StruckBody:
    """Return the second body just before the impact. ``world`` knows its centre of mass."""
    p_FB_F = center_of_mass(msg.body_name, world)
    state = body_state_from_msg(msg, world_frame=msg.header.frame_id, p_FB_F=p_FB_F)
    return StruckBody(name=msg.body_name, p_FB_F=p_FB_F, state=state)


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
    msg.orders_complete = impact.orders_complete
    msg.orders_not_converged = impact.orders_not_converged
    if impact.covariance is not None:
        msg.state_after.covariance = flat(impact.covariance)
    msg.miss_probability = math.nan
    if impact.outcome_probabilities is not None:
        msg.outcome_probabilities = flat(impact.outcome_probabilities)
        msg.miss_probability = impact.miss_probability
    msg.limit_time = math.nan if impact.limit_seconds is None else impact.limit_seconds
    if impact.strikes:
        _write_strikes(msg, impact, p_FB_F)
    return msg


def resolved_impact_from_msg(
    msg: ImpactMsg, *, p_FB_F: FloatArray, other_p_FB_F: FloatArray | None = None
) -> ResolvedImpact:
    """Return an impact of a body whose centre of mass is at ``p_FB_F``, (3,), m, in its published frame.

    ``other_p_FB_F`` is the second body's centre of mass in its published frame, if there is one.
    """
    in_time = len(msg.strike_times) > 0
    law = SeveralContactsLaw.SEQUENTIAL if in_time else SeveralContactsLaw(msg.several_contacts_law)
    other_state = None
    if other_p_FB_F is not None:
        after = msg.other_state_after[0]
        other_state = body_state_from_msg(after, world_frame=after.header.frame_id, p_FB_F=other_p_FB_F)
    covariance, probabilities = msg.state_after.covariance, msg.outcome_probabilities
    return ResolvedImpact(
        restitution_law=RestitutionLaw(msg.restitution_law),
        several_contacts_law=law,
        outcome=None if msg.outcome == msg.NOT_TOLD else ImpactOutcome(msg.outcome),
        jams=msg.jams,
        converged=msg.converged,
        state=body_state_from_msg(
            msg.state_after, world_frame=msg.state_after.header.frame_id, p_FB_F=p_FB_F
        ),
        other_state=other_state,
        impulses_W=rows(msg.impulses),
        compression_impulses_W=rows(msg.compression_impulses),
        velocities_before_W=rows(msg.contact_velocities_before),
        velocities_after_W=rows(msg.contact_velocities_after),
        path_W=rows(msg.path),
        path_events=tuple(PathEvent(event) for event in msg.path_events),
        path_contacts=tuple(msg.path_contacts),
        kinetic_energy_before=msg.kinetic_energy_before,
        kinetic_energy_after=msg.kinetic_energy_after,
        creates_energy=msg.creates_energy,
        orders=tuple(tuple(int(i) for i in order.split(",") if i) for order in msg.orders),
        order_velocities_W=rows(msg.order_velocities, 6),
        orders_complete=msg.orders_complete,
        orders_not_converged=msg.orders_not_converged,
        covariance=rows(covariance, 12) if len(covariance) > 0 else None,
        outcome_probabilities=np.array(probabilities) if len(probabilities) > 0 else None,
        miss_probability=msg.miss_probability if len(probabilities) > 0 else 0.0,
        strikes=_read_strikes(msg, p_FB_F),
        end=SequenceEnd(msg.sequence_end) if in_time else None,
        staying=tuple(msg.staying_contacts),
        limit_seconds=msg.limit_time if len(msg.staying_contacts) > 0 else None,
    )


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


def _read_strikes(msg: ImpactMsg, p_FB_F: FloatArray) -> tuple[SequenceStrike, ...]:
    """Return strikes in time, if there are any. The last of them leads to the state after the impact."""
    orientations = rows(msg.strike_body_orientations, 4)
    places = centers_of_mass(rows(msg.strike_body_positions), orientations, p_FB_F)
    last_ns = stamp_ns_from_msg(msg.state_after.header.stamp)
    strikes = []
    for i, (seconds, contact) in enumerate(zip(msg.strike_times, msg.strike_contacts, strict=True)):
        before, after = (
            BodyState(
                p_WB_W=places[i],
                q_WB=orientations[i],
                v_WB_W=twist[:3],
                w_WB_W=twist[3:],
                stamp_ns=ns_after(last_ns, seconds - msg.strike_times[-1]),
            )
            for twist in (
                rows(msg.strike_velocities_before, 6)[i],
                rows(msg.strike_velocities_after, 6)[i],
            )
        )
        strikes.append(
            SequenceStrike(
                seconds=seconds,
                contact=contact,
                outcome=ImpactOutcome(msg.strike_outcomes[i]),
                p_WC_W=rows(msg.strike_positions)[i],
                impulse_W=rows(msg.strike_impulses)[i],
                state_before=before,
                state_after=after,
            )
        )
    return tuple(strikes)


def _twists(states: Sequence[BodyState]) -> FloatArray:
    return np.array([np.concatenate([state.v_WB_W, state.w_WB_W]) for state in states])
