# SPDX-License-Identifier: Apache-2.0
"""Converts requests about whole tosses to questions, and answers to responses and back.

The distribution of an uncertain toss has regions, the tree of events, and rest.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.impact import ImpactOutcome, RestitutionLaw, SeveralContactsLaw
from contact_dynamics.questions.many import ManyStates
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
from contact_dynamics.toss.distribution import (
    Branch,
    BranchKind,
    EventRegions,
    Ghosts,
    Region,
    RestSpread,
    TossDistribution,
)
from contact_dynamics_interfaces.msg import TossBranch, TossEventRegions, TossRegion
from contact_dynamics_interfaces.msg import TossDistribution as TossDistributionMsg
from contact_dynamics_interfaces.msg import TossEvent as TossEventMsg
from contact_dynamics_interfaces.msg import TossPath as TossPathMsg
from contact_dynamics_interfaces.srv import PredictToss
from msg_adapters import fields
from msg_adapters.asked_fields import asked_member, asked_subject, optional
from msg_adapters.batches import body_states_from_msg, body_states_to_msg
from msg_adapters.field_names import renamed
from msg_adapters.rejected_fields import TOSS, check_unread
from msg_adapters.tumbling import TRAJECTORY

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import World


def _region(mean: FloatArray, covariance: FloatArray, radii: FloatArray) -> Region:
    """Return a region, whose covariance is flat in the message."""
    return Region(mean=mean, covariance=covariance.reshape(len(mean), len(mean)), radii=radii)


REGION: Final = fields.Table(
    _region,
    TossRegion,
    fields.Row("mean", "mean", fields.NUMBERS),
    fields.Row("covariance", "covariance", fields.NUMBERS),
    fields.Row("radii", "radii", fields.FIXED),
)
"""A region that holds a mean and a covariance."""

EVENT_REGIONS: Final = fields.Table(
    EventRegions,
    TossEventRegions,
    fields.Row("probability", "probability"),
    fields.Row("seconds", "time", REGION.nested()),
    fields.Row("position", "position", REGION.nested()),
    fields.Row("q_WB", "orientation", fields.QUATERNION),
    fields.Row("turn", "turn", REGION.nested()),
    fields.Row("velocity", "linear_velocity", REGION.nested()),
    fields.Row("spin", "angular_velocity", REGION.nested()),
)
"""The regions of a strike."""

BRANCH: Final = fields.Table(
    Branch,
    TossBranch,
    fields.Row("parent", "parent"),
    fields.Row("strike", "strike"),
    fields.Row("kind", "kind", fields.one_of(BranchKind)),
    fields.Row("surface", "surface"),
    fields.Row("corner", "corner"),
    fields.Row("probability", "probability"),
    fields.Row("regions", "regions", EVENT_REGIONS.at_most_one()),
)
"""A branch of the tree of events."""

_REST: Final = fields.Table(
    RestSpread,
    TossDistributionMsg,
    fields.Row("seconds", "rest_time_quantiles", fields.NUMBERS),
    fields.Row("positions", "rest_position_quantiles", fields.rows_of(3)),
    fields.Row("position", "rest_position", REGION.at_most_one()),
)


def _write_ghosts(msg: TossDistributionMsg, field: str, ghosts: Ghosts, frame: fields.Frame) -> None:
    states = ManyStates(p_WB_W=ghosts.p_WB_W, q_WB=ghosts.q_WB, v_WB_W=ghosts.v_WB_W, w_WB_W=ghosts.w_WB_W)
    body_states_to_msg(states, p_FB_F=frame.p_FB_F, into=getattr(msg, field))
    msg.ghost_samples, msg.ghost_strikes = ghosts.samples.tolist(), ghosts.strikes.tolist()


def _read_ghosts(msg: TossDistributionMsg, field: str, frame: fields.Frame) -> Ghosts:
    states = body_states_from_msg(getattr(msg, field), p_FB_F=frame.p_FB_F)
    return Ghosts(
        samples=np.array(msg.ghost_samples, dtype=np.int64),
        strikes=np.array(msg.ghost_strikes, dtype=np.int64),
        p_WB_W=states.p_WB_W,
        q_WB=states.q_WB,
        v_WB_W=states.v_WB_W,
        w_WB_W=states.w_WB_W,
    )


DISTRIBUTION: Final = fields.Table(
    TossDistribution,
    TossDistributionMsg,
    fields.Row("samples", "samples"),
    fields.Row("strikes", "strikes", EVENT_REGIONS.listed()),
    fields.Row("branches", "branches", BRANCH.listed()),
    fields.Row("face_normals_B", "face_normals", fields.rows_of(3)),
    fields.Row("face_probabilities", "face_probabilities", fields.NUMBERS),
    fields.Row("face_positions", "face_positions", REGION.listed()),
    fields.Row("rest", "", _REST.nested(lambda msg: not msg.rest_position)),
    fields.Row("ghosts", "ghosts", fields.Kind(_write_ghosts, _read_ghosts)),
    fields.Row("to_rest", "to_rest"),
)
"""What can happen in an uncertain toss."""


def toss_question_from_msg(request: PredictToss.Request, *, world: World, world_frame: str) -> TossQuestion:
    """Return the question of a `PredictToss` request; see `tumbling_question_from_msg`."""
    body, state = asked_subject(request, world, world_frame, fit_window=request.fit_window)
    check_unread(request, TOSS)
    return TossQuestion(
        body=body,
        state=state,
        restitution_law=asked_member("restitution_law", RestitutionLaw, request.restitution_law),
        several_contacts_law=asked_member(
            "several_contacts_law", SeveralContactsLaw, request.several_contacts_law
        ),
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


_UNDECIDED: Final = fields.Table(
    Undecided,
    TossPathMsg,
    fields.Row("seconds", "undecided_times"),
    fields.Row("reason", "undecided_reasons", fields.one_of(UndecidedReason)),
    fields.Row("options", "undecided_options"),
    fields.Row("taken", "undecided_taken"),
)

_ENERGY: Final = fields.Table(
    TossEnergy,
    TossPathMsg,
    fields.Row("first", "energy_first"),
    fields.Row("left", "energy_left"),
    fields.Row("lost_in_strikes", "energy_lost_in_strikes"),
    fields.Row("lost_in_contact", "energy_lost_in_contact"),
)

EVENT: Final = fields.Table(
    TossEvent,
    TossEventMsg,
    fields.Row("seconds", "time"),
    fields.Row("kind", "kind", fields.one_of(TossEventKind)),
    fields.Row("surfaces", "surfaces", fields.TUPLE),
    fields.Row("corners", "corners", fields.TUPLE),
    fields.Row("p_WC_W", "points", fields.rows_of(3)),
    fields.Row("impulse_W", "impulse", fields.VECTOR),
    fields.Row("outcome", "outcome", fields.one_of(ImpactOutcome, none=TossEventMsg.NO_OUTCOME)),
    fields.Row("mode", "mode"),
    fields.Row("state", "state", fields.STATE),
)
"""An event of a toss."""

PATH: Final = fields.Table(
    TossPath,
    TossPathMsg,
    fields.Row("end", "end", fields.one_of(TossEnd)),
    fields.Row("seconds", "end_time"),
    fields.Row("trajectory", "trajectory", TRAJECTORY),
    fields.Row("events", "events", EVENT.listed()),
    fields.Row("resting_corners", "resting_corners", fields.TUPLE),
    fields.Row("resting_normal_B", "resting_normal", fields.VECTOR),
    fields.Row("energy", "", _ENERGY.nested()),
    fields.Row("undecided", "", _UNDECIDED.columns()),
)
"""One way of a toss."""

_ANSWER: Final = fields.AnswerTable(
    TossAnswer,
    PredictToss.Response,
    fields.Row("state", "state", fields.STATE),
    fields.Row("fit", "", fields.FIT),
    fields.Row("toss", "toss", PATH.nested()),
    fields.Row("alternatives", "alternatives", PATH.listed()),
    fields.Row("all_followed", "all_followed"),
    fields.Row("distribution", "distribution", DISTRIBUTION.at_most_one()),
    fields.Row("warnings", "message", fields.WARNINGS),
)
toss_answer_to_msg: Final = _ANSWER.response_of
toss_answer_from_msg: Final = _ANSWER.answer_of
