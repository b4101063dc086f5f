# SPDX-License-Identifier: Apache-2.0
"""Converts requests about many states or candidates to questions, and answers to responses and back.

The arrays of a request are read as they are. A length that is no multiple of the row's raises
`InvalidFieldError` with the field.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.impact import ImpactOutcome, RestitutionLaw
from contact_dynamics.questions.many import (
    ManyImpactsAnswer,
    ManyImpactsQuestion,
    ManyStates,
    ManyTumblingsAnswer,
    ManyTumblingsQuestion,
)
from contact_dynamics.questions.many_contact_modes import ManyContactModesAnswer, ManyContactModesQuestion
from contact_dynamics.rigid_body.published_frame import centers_of_mass, origins_of_published_frame
from contact_dynamics_interfaces.msg import BodyStates
from contact_dynamics_interfaces.srv import PredictContactModeBatch, PredictImpactBatch, PredictTumblingBatch
from msg_adapters import fields
from msg_adapters.asked_fields import asked_body, asked_gravity, asked_member, optional
from msg_adapters.contact_mode import asked_contact_modes
from msg_adapters.contacts import flat
from msg_adapters.field_names import renamed
from msg_adapters.rejected_fields import CONTACT_MODE_BATCH

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import World

_STATE_FIELDS: Final = {
    "p_WB_W": "states.positions",
    "q_WB": "states.orientations",
    "v_WB_W": "states.linear_velocities",
    "w_WB_W": "states.angular_velocities",
}


def body_states_from_msg(msg: BodyStates, *, p_FB_F: FloatArray) -> ManyStates:
    """Return the states of a body whose centre of mass is at ``p_FB_F``, (3,), m, in its published frame.

    Raise `InvalidFieldError` if the arrays have different lengths, or a number is not finite.
    """
    q_WB = flat_rows("states.orientations", msg.orientations, 4)
    origins = flat_rows("states.positions", msg.positions, 3)
    if len(q_WB) != len(origins):
        raise InvalidFieldError("states.orientations", f"{len(q_WB)} rows", f"{len(origins)} as positions")
    try:
        return ManyStates(
            p_WB_W=centers_of_mass(origins, q_WB, p_FB_F),
            q_WB=q_WB,
            v_WB_W=flat_rows("states.linear_velocities", msg.linear_velocities, 3),
            w_WB_W=flat_rows("states.angular_velocities", msg.angular_velocities, 3),
        )
    except InvalidFieldError as error:
        raise renamed(error, _STATE_FIELDS) from None


def body_states_to_msg(states: ManyStates, *, p_FB_F: FloatArray, into: BodyStates) -> None:
    """Write states into an empty message."""
    into.positions = flat(origins_of_published_frame(states.p_WB_W, states.q_WB, p_FB_F))
    into.orientations = flat(states.q_WB)
    into.linear_velocities = flat(states.v_WB_W)
    into.angular_velocities = flat(states.w_WB_W)


def tumblings_question_from_msg(
    request: PredictTumblingBatch.Request,
    *,
    world: World,
    world_frame: str,  # noqa: ARG001  all is in it
) -> ManyTumblingsQuestion:
    """Return the question of a `PredictTumblingBatch` request."""
    body = asked_body(request.body_name, request.inertia, world)
    states = body_states_from_msg(request.states, p_FB_F=body.p_FB_F)
    gravity_W = asked_gravity(request)
    try:
        return ManyTumblingsQuestion(
            body=body, states=states, seconds=np.array(request.times), gravity_W=gravity_W
        )
    except InvalidFieldError as error:
        raise renamed(error) from None


def impacts_question_from_msg(
    request: PredictImpactBatch.Request,
    *,
    world: World,
    world_frame: str,  # noqa: ARG001  all is in it
) -> ManyImpactsQuestion:
    """Return the question of a `PredictImpactBatch` request."""
    body = asked_body(request.body_name, request.inertia, world)
    states = body_states_from_msg(request.states, p_FB_F=body.p_FB_F)
    try:
        return ManyImpactsQuestion(
            body=body,
            states=states,
            p_WC_W=flat_rows("contact_positions", request.contact_positions, 3),
            normals_W=flat_rows("contact_normals", request.contact_normals, 3),
            frictions=np.array(request.frictions),
            restitutions=np.array(request.restitutions),
            restitution_law=asked_member("restitution_law", RestitutionLaw, request.restitution_law),
            velocity_tolerance=optional(request.velocity_tolerance),
        )
    except InvalidFieldError as error:
        raise renamed(error, {"p_WC_W": "contact_positions", "normals_W": "contact_normals"}) from None


def flat_rows(field: str, numbers: Sequence[float], width: int) -> FloatArray:
    """Return the numbers of a flat field as rows, or raise `InvalidFieldError` if a row is incomplete."""
    if len(numbers) % width:
        raise InvalidFieldError(field, f"{len(numbers)} numbers", f"rows of {width}")
    return np.array(numbers, dtype=np.float64).reshape(-1, width)


STATES: Final = fields.Kind(
    lambda msg, field, states, frame: body_states_to_msg(
        states, p_FB_F=frame.p_FB_F, into=getattr(msg, field)
    ),
    lambda msg, field, frame: body_states_from_msg(getattr(msg, field), p_FB_F=frame.p_FB_F),
)
"""Many states of one body."""

_TUMBLINGS: Final = fields.AnswerTable(
    ManyTumblingsAnswer,
    PredictTumblingBatch.Response,
    fields.Row("body_name", "body_name"),
    fields.Row("states", "states", STATES),
    body_name="body_name",
)
tumblings_answer_to_msg: Final = _TUMBLINGS.response_of
tumblings_answer_from_msg: Final = _TUMBLINGS.answer_of


_SEPARATES: Final = PredictImpactBatch.Response.SEPARATES

_OUTCOMES: Final = fields.Converted(
    np.ndarray.tolist,
    lambda told: np.where(_separates(told), int(ImpactOutcome.NO_IMPULSE), np.array(told, dtype=np.int64)),
)
"""Outcomes, among which are those that separate."""


def _write_separates(
    msg: PredictImpactBatch.Response, field: str, value: NDArray[np.bool_], _: fields.Frame
) -> None:
    """Write which contacts separate in place of their outcomes."""
    setattr(msg, field, np.where(value, _SEPARATES, getattr(msg, field)).tolist())


def _separates(told: Sequence[int]) -> NDArray[np.bool_]:
    found: NDArray[np.bool_] = np.equal(told, _SEPARATES)
    return found


_IMPACTS: Final = fields.AnswerTable(
    ManyImpactsAnswer,
    PredictImpactBatch.Response,
    fields.Row("body_name", "body_name"),
    fields.Row("outcomes", "outcomes", _OUTCOMES),
    fields.Row(
        "separates",
        "outcomes",
        fields.Kind(_write_separates, lambda msg, field, _: _separates(getattr(msg, field))),
    ),
    fields.Row("states", "states_after", STATES),
    fields.Row("impulses_W", "impulses", fields.rows_of(3)),
    fields.Row("warnings", "message", fields.WARNINGS),
    body_name="body_name",
)
impacts_answer_to_msg: Final = _IMPACTS.response_of
impacts_answer_from_msg: Final = _IMPACTS.answer_of


def contact_modes_question_from_msg(
    request: PredictContactModeBatch.Request, *, world: World, world_frame: str
) -> ManyContactModesQuestion:
    """Return the question of a `PredictContactModeBatch` request; see `tumbling_question_from_msg`."""
    forces = flat_rows("forces", request.forces, 3)
    torques = flat_rows("torques", request.torques, 3)
    none = np.zeros((max(len(forces), len(torques), 1), 3))
    asked = asked_contact_modes(request, world, world_frame, read_if=CONTACT_MODE_BATCH)
    try:
        return ManyContactModesQuestion(
            asked=asked,
            forces_W=forces if len(forces) > 0 else none,
            torques_W=torques if len(torques) > 0 else none,
            contact_counts=request.contact_counts,
        )
    except InvalidFieldError as error:
        raise renamed(error, {"forces_W": "forces", "torques_W": "torques"}) from None


_ANSWER: Final = fields.AnswerTable(
    ManyContactModesAnswer,
    PredictContactModeBatch.Response,
    fields.Row("body_name", "body_name"),
    fields.Row("state", "state", fields.STATE),
    fields.Row("contacts", "contacts", fields.CONTACTS),
    fields.Row("contact_counts", "contact_counts", fields.TUPLE),
    fields.Row("verdicts", "verdicts", fields.array_of(np.int64)),
    fields.Row("problems", "problems", fields.array_of(np.int64)),
    fields.Row("mode_counts", "mode_counts", fields.array_of(np.int64)),
    fields.Row("modes", "modes", fields.TUPLE),
    fields.Row("accelerations_W", "linear_accelerations", fields.rows_of(3)),
    fields.Row("angular_accelerations_W", "angular_accelerations", fields.rows_of(3)),
    # If there is no mode, the response does not say whether margins were asked for.
    fields.Row("margins", "margins", fields.NUMBERS_OR_NONE),
    fields.Row("warnings", "message", fields.WARNINGS),
    body_name="body_name",
)
contact_modes_answer_to_msg: Final = _ANSWER.response_of
contact_modes_answer_from_msg: Final = _ANSWER.answer_of
