"""Reads the answers of a log as the server gave them, each with the bodies that its question was about."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from contact_dynamics.nodes.services import Answer, service_of_type
from contact_dynamics.questions.many_contact_modes import ManyContactModesQuestion
from contact_dynamics.recording.bag_reader import BagReader
from contact_dynamics.recording.errors import DamagedLogWarning
from contact_dynamics.recording.service_calls import ServiceCall
from contact_dynamics.records import Record
from contact_dynamics.replay.event_parts import part_of
from contact_dynamics.replay.of_log import server_of_log
from contact_dynamics.replay.timeline import in_order
from contact_dynamics.validation import FloatArray
from contact_dynamics.world import Body

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from contact_dynamics.world import World

OK: Final = 0
"""The status of a response that has an answer, in all services."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class LoggedAnswer(Record):
    """An answer of a log.

    Attributes:
        number: Number of its question among all of the log, from 1.
        kind: The kind of its service's answers, in words.
        answer: The answer as the server gave it.
        body: The body that the question was about, or None if the log does not describe it.
        other: A second body that was struck, or None.
        gravity_W: (3,), m/s^2, world axes.
    """

    number: int
    kind: str
    answer: Answer
    body: Body | None
    other: Body | None
    gravity_W: FloatArray


def logged_answers(path: Path) -> Iterator[LoggedAnswer]:
    """Yield the answers of a log, in the order in which the questions came.

    Refused questions are left out.

    Raises:
        NotALogError: the path has no log, or a log of something else than the server.
        ConfigurationError: its record of the run lacks a parameter, or has one that is not allowed.
        NotSupportedError: the log's services have other fields than this version's.
        InvalidFieldError: a call has no contents.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DamagedLogWarning)  # what is whole is drawn
        _, server = server_of_log(path)
        log = BagReader(path)
        number = 0
        for call in in_order(log, BagReader(path), server.topics_of_changes):
            if not isinstance(call, ServiceCall):
                server.receive(call)
                continue
            number += 1
            if call.request_event is None or call.response_event is None:
                continue
            response = part_of(call.response_event, "response")
            if response.status != OK:
                continue
            question = server.question_from(call.service_type, part_of(call.request_event, "request"))
            answer = server.answer_from(call.service_type, response)
            about = question.asked if isinstance(question, ManyContactModesQuestion) else question
            gravity_W = getattr(about, "gravity_W", None)  # an impact needs none
            yield LoggedAnswer(
                number=number,
                kind=service_of_type(call.service_type).kind,
                answer=answer,
                body=_body(about.body, server.world),
                other=_body(getattr(about, "other", None), server.world),
                gravity_W=server.world.gravity_W if gravity_W is None else gravity_W,
            )


def _body(body: Body | str | None, world: World) -> Body | None:
    """Return a body that a question describes or names, or None if the world does not have it."""
    if body is None or isinstance(body, Body):
        return body
    return next((each for each in world.bodies if each.name == body), None)
