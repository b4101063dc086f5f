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

_FIELDS: Final = {
    **{f"contacts.{name}": field for name, field in CONTACT_FIELDS.items()},
    "forces_W": "applied_wrenches",
    "torques_W": "applied_wrenches",
    "bodies": "body_names",
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


def _asked_pairs(request: PredictBodiesContactMode.Request, n: int) -> list[tuple[int, int | None]]:
    """Return the bodies that touch at each of n contacts."""
    names = list(request.body_names)
    others = request.other_bodies or [""] * n
    for field, given in (("contact_bodies", request.contact_bodies), ("other_bodies", others)):
        if len(given) != n:
            raise InvalidFieldError(field, f"{len(given)} names", f"{n}, one for each contact")
    for i, (first, second) in enumerate(zip(request.contact_bodies, others, strict=True)):
        if first not in names:
            raise InvalidFieldError(f"contact_bodies[{i}]", repr(first), f"one of body_names, {names}")
        if second not in {"", *names} - {first}:
            allowed = f"another one of body_names, {names}, or left empty for the world"
            raise InvalidFieldError(f"other_bodies[{i}]", repr(second), allowed)
    return _pairs(names, request.contact_bodies, others)


def _pairs(
    names: Sequence[str], firsts: Sequence[str], seconds: Sequence[str]
) -> list[tuple[int, int | None]]:
    numbers = {name: i for i, name in enumerate(names)}
    return [(numbers[first], numbers.get(second)) for first, second in zip(firsts, seconds, strict=True)]


def _write_pairs(
    msg: PredictBodiesContactMode.Response,
    _: str,
    pairs: Sequence[tuple[int, int | None]],
    frame: fields.Frame,
) -> None:
    names = [body.name for body in frame.answer.bodies]  # type: ignore[attr-defined]  # of this answer
    msg.contact_bodies = [names[first] for first, _ in pairs]
    msg.other_bodies = ["" if second is None else names[second] for _, second in pairs]


def _read_pairs(
    msg: PredictBodiesContactMode.Response, _: str, __: fields.Frame
) -> tuple[tuple[int, int | None], ...]:
    return tuple(_pairs([state.body_name for state in msg.states], msg.contact_bodies, msg.other_bodies))


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
