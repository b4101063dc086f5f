"""Converts questions and answers about whole tosses to the service's request and response, and back."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.impact import ImpactOutcome
from contact_dynamics.questions.toss import TossAnswer, TossPath, TossQuestion, TossSampling
from contact_dynamics.toss import (
    TossEnd,
    TossEnergy,
    TossEvent,
    TossEventKind,
    TossUncertainty,
    Undecided,
    UndecidedReason,
)
from contact_dynamics_interfaces.msg import TossEvent as TossEventMsg
from contact_dynamics_interfaces.msg import TossPath as TossPathMsg
from contact_dynamics_interfaces.srv import PredictToss
from msg_adapters.asked_fields import asked_instant_law, asked_restitution_law, optional, write_given
from msg_adapters.asked_subject import asked_subject, write_fitted_subject
from msg_adapters.body_state import body_state_from_msg, body_state_to_msg, center_of_mass
from msg_adapters.contacts import flat, rows
from msg_adapters.field_names import renamed
from msg_adapters.geometry import vector_from_msg, vector_to_msg
from msg_adapters.toss_distribution import distribution_from_msg, distribution_to_msg
from msg_adapters.tumbling import read_fit, trajectory_from_msg, trajectory_to_msg, write_fit
from msg_adapters.unread_fields import TOSS, check_unread

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import World


def toss_question_from_msg(request: PredictToss.Request, *, world: World, world_frame: str) -> TossQuestion:
    """Return the question of a `PredictToss` request.

    Args:
        request: The request.
        world: The bodies that it can name.
        world_frame: The frame that an explicit state must be in.

    Raises:
        ContactDynamicsError: a field holds what is not allowed, or names a body that is not known.
    """
    body, state = asked_subject(request, world, world_frame, fit_window=request.fit_window)
    check_unread(request, TOSS)
    return TossQuestion(
        body=body,
        state=state,
        restitution_law=asked_restitution_law(request.restitution_law),
        several_contacts_law=asked_instant_law(request.several_contacts_law),
        horizon=optional(request.horizon),
        rate=optional(request.rate),
        max_alternatives=optional(request.max_alternatives),
        sampling=_sampling(request) if request.samples else None,
        lasting_factors=np.array(request.lasting_factors),
    )


def _sampling(request: PredictToss.Request) -> TossSampling:
    return TossSampling(
        count=request.samples,
        strikes=optional(request.strikes),
        to_rest=request.to_rest,
        seed=request.seed,
        uncertainty=_uncertainty(request),
    )


def _uncertainty(request: PredictToss.Request) -> TossUncertainty:
    numbers = len(request.parameter_covariance)
    side = math.isqrt(numbers)
    if side * side != numbers:
        raise InvalidFieldError("parameter_covariance", f"{numbers} numbers", "a square number of them")
    names = {
        "covariance": "parameter_covariance",
        "velocity": "velocity_spread",
        "spin": "spin_spread",
        "height": "height_spread",
    }
    try:
        return TossUncertainty(
            covariance=np.array(request.parameter_covariance).reshape(side, side),
            velocity=request.velocity_spread,
            spin=request.spin_spread,
            height=request.height_spread,
            lasting_factors=request.lasting_factors,
            lasting_factor_stds=request.lasting_factor_stds,
        )
    except InvalidFieldError as error:
        raise renamed(error, names) from None


def toss_question_to_msg(question: TossQuestion, *, world: World, world_frame: str) -> PredictToss.Request:
    """Return the request of a question about a toss.

    Args:
        question: The question.
        world: The bodies that the server knows by name.
        world_frame: The frame of its world.

    Raises:
        UnknownBodyError: the question names a body that the world does not have.
        NotSupportedError: the question has no request.
    """
    msg = PredictToss.Request()
    write_fitted_subject(msg, question.body, question.state, world, world_frame)
    msg.restitution_law = int(question.restitution_law)
    msg.several_contacts_law = int(question.several_contacts_law)
    write_given(msg, horizon=question.horizon, rate=question.rate, max_alternatives=question.max_alternatives)
    msg.lasting_factors = flat(question.lasting_factors)
    sampling = question.sampling
    if sampling is not None:
        msg.samples, msg.seed, msg.to_rest = sampling.count, sampling.seed, sampling.to_rest
        write_given(msg, strikes=sampling.strikes)
        msg.parameter_covariance = flat(sampling.uncertainty.covariance)
        msg.velocity_spread, msg.spin_spread = sampling.uncertainty.velocity, sampling.uncertainty.spin
        msg.height_spread = sampling.uncertainty.height
        msg.lasting_factor_stds = flat(sampling.uncertainty.lasting_factor_stds)
    return msg


def toss_answer_to_msg(
    answer: TossAnswer, *, world_frame: str, into: PredictToss.Response | None = None
) -> PredictToss.Response:
    """Return an answer as a response, which is new unless an empty one to fill is given."""
    msg = PredictToss.Response() if into is None else into
    name, p_FB_F = answer.body_name, answer.p_FB_F
    write = partial(
        toss_path_to_msg,
        stamp_ns=answer.state.stamp_ns,
        body_name=name,
        world_frame=world_frame,
        p_FB_F=p_FB_F,
    )
    write(answer.toss, into=msg.toss)
    msg.alternatives = [write(each) for each in answer.alternatives]
    msg.all_followed = answer.all_followed
    if answer.distribution is not None:
        msg.distribution = [distribution_to_msg(answer.distribution, p_FB_F=p_FB_F)]
    body_state_to_msg(answer.state, body_name=name, world_frame=world_frame, p_FB_F=p_FB_F, into=msg.state)
    write_fit(msg, answer.fit)
    return msg


def toss_answer_from_msg(msg: PredictToss.Response, *, world: World) -> TossAnswer:
    """Return the answer that a response contains. ``world`` knows the bodies' centres of mass.

    Raises:
        InvalidFieldError: a number is not finite, or a quaternion is not unit.
    """
    p_FB_F = center_of_mass(msg.state.body_name, world)
    return TossAnswer(
        body_name=msg.state.body_name,
        p_FB_F=p_FB_F,
        state=body_state_from_msg(msg.state, world_frame=msg.state.header.frame_id, p_FB_F=p_FB_F),
        fit=read_fit(msg),
        toss=toss_path_from_msg(msg.toss, p_FB_F=p_FB_F),
        alternatives=tuple(toss_path_from_msg(each, p_FB_F=p_FB_F) for each in msg.alternatives),
        all_followed=msg.all_followed,
        distribution=next((distribution_from_msg(each, p_FB_F=p_FB_F) for each in msg.distribution), None),
    )


def toss_path_to_msg(
    path: TossPath,
    *,
    stamp_ns: int,
    body_name: str,
    world_frame: str,
    p_FB_F: FloatArray,
    into: TossPathMsg | None = None,
) -> TossPathMsg:
    """Return one way of a toss as a message, which is new unless an empty one to fill is given."""
    msg = TossPathMsg() if into is None else into
    msg.end, msg.end_time = int(path.end), path.seconds
    trajectory_to_msg(
        path.trajectory, stamp_ns=stamp_ns, world_frame=world_frame, p_FB_F=p_FB_F, into=msg.trajectory
    )
    msg.events = [
        toss_event_to_msg(event, body_name=body_name, world_frame=world_frame, p_FB_F=p_FB_F)
        for event in path.events
    ]
    msg.resting_corners = list(path.resting_corners)
    msg.resting_normal = vector_to_msg(path.resting_normal_B)
    msg.energy_first, msg.energy_left = path.energy.first, path.energy.left
    msg.energy_lost_in_strikes = path.energy.lost_in_strikes
    msg.energy_lost_in_contact = path.energy.lost_in_contact
    msg.undecided_times = [point.seconds for point in path.undecided]
    msg.undecided_reasons = [int(point.reason) for point in path.undecided]
    msg.undecided_options = [point.options for point in path.undecided]
    msg.undecided_taken = [point.taken for point in path.undecided]
    return msg


def toss_path_from_msg(msg: TossPathMsg, *, p_FB_F: FloatArray) -> TossPath:
    """Return one way of a toss, of the body whose centre of mass is at ``p_FB_F``, (3,), m."""
    undecided = zip(
        msg.undecided_times, msg.undecided_reasons, msg.undecided_options, msg.undecided_taken, strict=True
    )
    return TossPath(
        end=TossEnd(msg.end),
        seconds=msg.end_time,
        trajectory=trajectory_from_msg(msg.trajectory, p_FB_F=p_FB_F),
        events=tuple(toss_event_from_msg(each, p_FB_F=p_FB_F) for each in msg.events),
        resting_corners=tuple(int(corner) for corner in msg.resting_corners),
        resting_normal_B=vector_from_msg(msg.resting_normal),
        energy=TossEnergy(
            first=msg.energy_first,
            lost_in_strikes=msg.energy_lost_in_strikes,
            lost_in_contact=msg.energy_lost_in_contact,
            left=msg.energy_left,
        ),
        undecided=tuple(
            Undecided(
                seconds=float(seconds), reason=UndecidedReason(reason), options=int(options), taken=int(taken)
            )
            for seconds, reason, options, taken in undecided
        ),
    )


def toss_event_to_msg(
    event: TossEvent, *, body_name: str, world_frame: str, p_FB_F: FloatArray
) -> TossEventMsg:
    """Return an event as a message."""
    msg = TossEventMsg()
    msg.time, msg.kind = event.seconds, int(event.kind)
    msg.surfaces, msg.corners = list(event.surfaces), list(event.corners)
    msg.points = flat(event.p_WC_W)
    msg.impulse = vector_to_msg(event.impulse_W)
    msg.outcome = msg.NO_OUTCOME if event.outcome is None else int(event.outcome)
    msg.mode = event.mode
    body_state_to_msg(
        event.state, body_name=body_name, world_frame=world_frame, p_FB_F=p_FB_F, into=msg.state
    )
    return msg


def toss_event_from_msg(msg: TossEventMsg, *, p_FB_F: FloatArray) -> TossEvent:
    """Return an event of the body whose centre of mass is at ``p_FB_F``, (3,), m, in its published frame."""
    return TossEvent(
        seconds=msg.time,
        kind=TossEventKind(msg.kind),
        surfaces=tuple(msg.surfaces),
        corners=tuple(int(corner) for corner in msg.corners),
        p_WC_W=rows(msg.points),
        impulse_W=vector_from_msg(msg.impulse),
        outcome=None if msg.outcome == msg.NO_OUTCOME else ImpactOutcome(msg.outcome),
        mode=msg.mode,
        state=body_state_from_msg(msg.state, world_frame=msg.state.header.frame_id, p_FB_F=p_FB_F),
    )
