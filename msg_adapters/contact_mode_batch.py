# SPDX-License-Identifier: Apache-2.0
"""Converts requests and responses about the contact modes of many candidates, and back."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.questions.many_contact_modes import ManyContactModesAnswer, ManyContactModesQuestion
from contact_dynamics_interfaces.srv import PredictContactModeBatch
from msg_adapters import fields
from msg_adapters.batches import flat_rows
from msg_adapters.contact_mode import asked_contact_modes, write_contact_modes
from msg_adapters.contacts import flat
from msg_adapters.field_names import renamed
from msg_adapters.unread_fields import CONTACT_MODE_BATCH

if TYPE_CHECKING:
    from contact_dynamics.world import World


def contact_modes_question_from_msg(
    request: PredictContactModeBatch.Request, *, world: World, world_frame: str
) -> ManyContactModesQuestion:
    """Return the question of a `PredictContactModeBatch` request.

    Raises:
        ContactDynamicsError: a field holds what is not allowed, or names a body that is not known.
    """
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


def contact_modes_question_to_msg(
    question: ManyContactModesQuestion, *, world: World, world_frame: str
) -> PredictContactModeBatch.Request:
    """Return the request of a question about the contact modes of many candidates."""
    msg = PredictContactModeBatch.Request()
    write_contact_modes(msg, question.asked, world, world_frame)
    msg.forces, msg.torques = flat(question.forces_W), flat(question.torques_W)
    msg.contact_counts = list(question.contact_counts)
    return msg


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
