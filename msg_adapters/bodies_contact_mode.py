# SPDX-License-Identifier: Apache-2.0
"""Converts requests about contact modes of several bodies to questions, and answers to responses and back."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from contact_dynamics.contact_modes.result import BodiesMode, ModeVerdict
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.questions.bodies_contact_modes import BodiesContactModeAnswer, BodiesContactModeQuestion
from contact_dynamics_interfaces.msg import BodiesContactMode
from contact_dynamics_interfaces.srv import PredictBodiesContactMode
from msg_adapters import fields
from msg_adapters.asked_fields import NOTHING, asked_gravity, asked_subjects, optional
from msg_adapters.contact_mode import OF_CONTACTS
from msg_adapters.contacts import contacts_from_msg
from msg_adapters.field_names import CONTACT_FIELDS, renamed
from msg_adapters.geometry import vector_from_msg
from msg_adapters.rejected_fields import BODIES_CONTACT_MODE, check_unread

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.world import World

_WORLD: Final = -1  # index of the other body if a body touches the world

_FIELDS: Final = {
    **{f"contacts.{name}": field for name, field in CONTACT_FIELDS.items()},
    "forces_W": "applied_wrenches",
    "torques_W": "applied_wrenches",
    "bodies": "states",
}


def bodies_contact_mode_question_from_msg(
    request: PredictBodiesContactMode.Request, *, world: World, world_frame: str
) -> BodiesContactModeQuestion:
    """Return the question of a `PredictBodiesContactMode` request; see `tumbling_question_from_msg`."""
    gravity_W, contacts = asked_gravity(request), contacts_from_msg(request.contacts)
    bodies, states = asked_subjects(request, world, world_frame)
    check_unread(request, BODIES_CONTACT_MODE)
    wrenches = request.applied_wrenches
    try:
        return BodiesContactModeQuestion(
            bodies=bodies,
            states=states,
            contacts=contacts,
            pairs=_asked_pairs(request, len(contacts)),
            forces_W=[vector_from_msg(wrench.force) for wrench in wrenches] or NOTHING,
            torques_W=[vector_from_msg(wrench.torque) for wrench in wrenches] or NOTHING,
            gravity_W=gravity_W,
            velocity_tolerance=optional(request.velocity_tolerance),
        )
    except InvalidFieldError as error:
        raise renamed(error, _FIELDS) from None


def _asked_pairs(request: PredictBodiesContactMode.Request, n: int) -> tuple[tuple[int, int | None], ...]:
    """Return the bodies that touch at each of n contacts."""
    count = len(request.states)
    for field in ("contact_bodies", "other_bodies"):
        if len(given := getattr(request, field)) != n:
            raise InvalidFieldError(field, f"{len(given)} indices", f"{n}, one for each contact")
    for i, (first, second) in enumerate(zip(request.contact_bodies, request.other_bodies, strict=True)):
        if first >= count:
            raise InvalidFieldError(f"contact_bodies[{i}]", first, f"an index of states, below {count}")
        if second == first or not _WORLD <= second < count:
            allowed = f"another index of states, below {count}, or {_WORLD} for the world"
            raise InvalidFieldError(f"other_bodies[{i}]", second, allowed)
    return _read_pairs(request)


def _write_pairs(
    msg: PredictBodiesContactMode.Response, _: str, pairs: Sequence[tuple[int, int | None]], __: fields.Frame
) -> None:
    msg.contact_bodies = [first for first, _ in pairs]
    msg.other_bodies = [_WORLD if second is None else second for _, second in pairs]


def _read_pairs(
    msg: PredictBodiesContactMode.Request | PredictBodiesContactMode.Response, *_: object
) -> tuple[tuple[int, int | None], ...]:
    pairs = zip(msg.contact_bodies, msg.other_bodies, strict=True)
    return tuple((int(first), None if second == _WORLD else int(second)) for first, second in pairs)


MODE_OF_BODIES: Final = fields.Table(
    BodiesMode,
    BodiesContactMode,
    fields.Row("accelerations_W", "linear_accelerations", fields.rows_of(3)),
    fields.Row("angular_accelerations_W", "angular_accelerations", fields.rows_of(3)),
    *OF_CONTACTS,
)
"""A mode of several bodies."""


_ANSWER: Final = fields.AnswerTable(
    BodiesContactModeAnswer,
    PredictBodiesContactMode.Response,
    fields.Row("bodies", "states", fields.NAMED_STATE.listed()),
    fields.Row("contacts", "contacts", fields.CONTACTS),
    fields.Row("pairs", "", fields.Kind(_write_pairs, _read_pairs)),
    fields.Row("verdict", "verdict", fields.one_of(ModeVerdict)),
    fields.Row("modes", "modes", MODE_OF_BODIES.listed()),
    fields.Row("approaching", "approaching_contacts", fields.TUPLE),
    fields.Row("undecided", "message", fields.TEXT_BEFORE_WARNINGS),
    fields.Row("warnings", "message", fields.WARNINGS),
    fields.Row("undecided_modes", "undecided_modes", fields.TUPLE),
    fields.Row("velocity_tolerance", "velocity_tolerance"),
    body_name=None,
)
bodies_contact_mode_answer_to_msg: Final = _ANSWER.response_of
bodies_contact_mode_answer_from_msg: Final = _ANSWER.answer_of
