# SPDX-License-Identifier: Apache-2.0
"""A log of the server holds states as they came, and answers as they were given."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.questions.services import service_of_type
from contact_dynamics.recording.bag_reader import BagReader
from contact_dynamics.recording.errors import DamagedLogWarning
from contact_dynamics.recording.message_types import Message
from contact_dynamics.recording.service_calls import ServiceCall
from contact_dynamics.replay.compare import differences
from contact_dynamics.replay.events import OK, UNREADABLE, Answered, Events, StateCame, WorldChanged
from contact_dynamics.replay.of_log import server_of_log
from contact_dynamics.replay.timeline import EVERYTHING, in_order, part_of

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from contact_dynamics.questions.services import Answer, Question
    from contact_dynamics.recording.file_messages import Span
    from contact_dynamics.replay.events import Event


class LoggedEvents(Events):
    """A log of the server as a source of events."""

    def __init__(self, path: Path, *, span: Span = EVERYTHING, states: bool = True) -> None:
        """Read how the run was configured.

        Args:
            path: the log: its folder, or one of its files.
            span: which part of it is read.
            states: whether states are read.

        Raises:
            NotALogError: it is no log, or none of the server.
            ConfigurationError: its record of the run lacks a parameter, or has one that is not allowed.
        """
        _, server = server_of_log(path)
        super().__init__(BagReader(path), server)
        self._topics = self._server.topics if states else self._server.topics_of_changes
        self._span = span
        self._numbers: dict[str, int] = {}
        self._path = path

    @property
    def why_empty(self) -> str:
        """Why there is no question, in words, where there is none."""
        return "the log contains no requests with a response; --ask makes predictions from its states"

    def __iter__(self) -> Iterator[Event]:
        """Read the log; each answer comes after the states that were known when its question came."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DamagedLogWarning)  # told by `damage`
            again = BagReader(self._path)
            for each in in_order(self._reader, again, self._topics, span=self._span):
                if isinstance(each, ServiceCall):
                    answered = self._answered(each)
                    if answered is not None:
                        yield answered
                    continue
                before = self._server.world
                for body_name, state in self._server.receive(each):
                    yield StateCame(body_name=body_name, state=state)
                if self._server.world is not before:
                    yield WorldChanged(world=self._server.world, stamp_ns=each.publish_time_ns)

    def _answered(self, call: ServiceCall) -> Answered | None:
        if call.request_event is None or call.response_event is None:
            return None
        number = self._numbers[call.service] = self._numbers.get(call.service, 0) + 1
        question: dict[str, object] = {}
        asked: Question[Answer] | None = None
        answer: Answer | None = None
        try:
            request = part_of(call.request_event, "request")
            response = part_of(call.response_event, "response")
            question = not_default(request)
            status, message = status_of(response), str(response.message)
            seconds = float(response.computation_time)
            if status == OK:
                asked = self._server.question_from(call.service_type, request)
                answer = self._server.answer_from(call.service_type, response)
        except (ContactDynamicsError, AttributeError) as error:  # the latter of a log with other fields
            status, message, seconds = UNREADABLE, f"this version cannot read it: {error}", 0.0
        return Answered(
            service_name=call.service.rpartition("/")[2],
            service=service_of_type(call.service_type),
            number=number,
            log_time_ns=call.request_event.log_time_ns,
            asked_ns=call.request_event.publish_time_ns,
            question=question,
            asked=asked,
            answer=answer,
            status=status,
            message=message,
            computation_time=seconds,
        )


def not_default(message: Message) -> dict[str, object]:
    """Return the fields of a message that differ from an empty one, as plain numbers, texts and lists."""
    changed = {each.field.removeprefix("number of ") for each in differences(message, type(message)())}
    names = {name.partition(".")[0].partition("[")[0] for name in changed}
    return {
        field.name: _plain(getattr(message, field.name)) for field in message.FIELDS if field.name in names
    }


def _plain(value: Any) -> object:
    if isinstance(value, Message):
        return {field.name: _plain(getattr(value, field.name)) for field in value.FIELDS}
    if isinstance(value, (str, bool, int, float)):
        return value
    return [_plain(each) for each in (value.tolist() if isinstance(value, np.ndarray) else value)]


def status_of(response: Any) -> str:
    """Return the name of a response's status; its codes are above those of its other constants."""
    if response.status == response.OK:
        return OK
    constants = vars(type(response)).items()
    return next((name for name, value in constants if name.isupper() and value == response.status), "UNKNOWN")
