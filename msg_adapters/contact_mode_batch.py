"""Converts requests and responses about the contact modes of many candidates, and back."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.questions.many_contact_modes import ManyContactModesAnswer, ManyContactModesQuestion
from contact_dynamics_interfaces.srv import PredictContactModeBatch
from msg_adapters.batches import flat_rows
from msg_adapters.body_state import body_state_from_msg, body_state_to_msg, center_of_mass
from msg_adapters.contact_mode import asked_contact_modes, write_contact_modes
from msg_adapters.contacts import contacts_from_msg, contacts_to_msg, flat
from msg_adapters.field_names import renamed
from msg_adapters.status import with_warnings, without_warnings
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


def contact_modes_answer_to_msg(
    answer: ManyContactModesAnswer, *, world_frame: str, into: PredictContactModeBatch.Response | None = None
) -> PredictContactModeBatch.Response:
    """Return an answer as a response: a new one, or the empty one to fill."""
    msg = PredictContactModeBatch.Response() if into is None else into
    msg.body_name = answer.body_name
    msg.verdicts, msg.problems = answer.verdicts.tolist(), answer.problems.tolist()
    msg.mode_counts, msg.modes = answer.mode_counts.tolist(), list(answer.modes)
    msg.linear_accelerations = flat(answer.accelerations_W)
    msg.angular_accelerations = flat(answer.angular_accelerations_W)
    if answer.margins is not None:
        msg.margins = flat(answer.margins)
    body_state_to_msg(
        answer.state,
        body_name=answer.body_name,
        world_frame=world_frame,
        p_FB_F=answer.p_FB_F,
        into=msg.state,
    )
    contacts_to_msg(answer.contacts, into=msg.contacts)
    msg.contact_counts = list(answer.contact_counts)
    msg.message = with_warnings("", answer.warnings)
    return msg


def contact_modes_answer_from_msg(
    msg: PredictContactModeBatch.Response, *, world: World
) -> ManyContactModesAnswer:
    """Return the answer that a response carries; ``world`` knows the body's centre of mass.

    If there is no mode, the response does not say whether margins were asked for.
    """
    p_FB_F = center_of_mass(msg.body_name, world)
    return ManyContactModesAnswer(
        body_name=msg.body_name,
        p_FB_F=p_FB_F,
        state=body_state_from_msg(msg.state, world_frame=msg.state.header.frame_id, p_FB_F=p_FB_F),
        contacts=contacts_from_msg(msg.contacts),
        contact_counts=tuple(msg.contact_counts),
        verdicts=np.array(msg.verdicts, dtype=np.int64),
        problems=np.array(msg.problems, dtype=np.int64),
        mode_counts=np.array(msg.mode_counts, dtype=np.int64),
        modes=tuple(msg.modes),
        accelerations_W=flat_rows("linear_accelerations", msg.linear_accelerations, 3),
        angular_accelerations_W=flat_rows("angular_accelerations", msg.angular_accelerations, 3),
        margins=np.array(msg.margins, dtype=np.float64) if len(msg.margins) > 0 else None,
        warnings=without_warnings(msg.message)[1],
    )
