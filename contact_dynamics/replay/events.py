# SPDX-License-Identifier: Apache-2.0
"""Events in the order of their arrival: states of bodies, and responses to requests about them.

`LoggedEvents` are read from a log of the server. `AskedEvents` are the states of any recording, and the
responses that a server would have returned to requests made on replay. Their clock is that of the states'
stamps. Each request is made at a state, and uses only the states published by then.
"""

from __future__ import annotations

import warnings
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import numpy as np

from contact_dynamics.constants import ns_after
from contact_dynamics.errors import ContactDynamicsError, InvalidFieldError
from contact_dynamics.questions.contact_modes import ContactModeQuestion
from contact_dynamics.questions.impact_question import ImpactQuestion
from contact_dynamics.questions.sample_times import UntilContact
from contact_dynamics.questions.services import ask, service_of, service_of_type
from contact_dynamics.questions.subject import PublishedState
from contact_dynamics.questions.tumbling import TumblingQuestion
from contact_dynamics.recording.bag_reader import BagReader, kind_of
from contact_dynamics.recording.cdr import decode_without_ros
from contact_dynamics.recording.errors import DamagedLogWarning
from contact_dynamics.recording.message_types import Message
from contact_dynamics.recording.service_calls import ServiceCall
from contact_dynamics.replay.of_log import server_of_log, stand_in
from contact_dynamics.replay.timeline import CLOCK, EVERYTHING, MONITOR_EVENT, in_order, part_of
from contact_dynamics.replay.verify import differences
from msg_adapters.status import code_name

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from pathlib import Path

    from contact_dynamics.nodes.parameter_reader import ParameterSource
    from contact_dynamics.questions.carried_surface import CarriedSurface
    from contact_dynamics.questions.services import Answer, Question, Service
    from contact_dynamics.recording.bag_reader import LoggedMessage
    from contact_dynamics.recording.file_messages import Span
    from contact_dynamics.replay.again import Refused, ServerAgain
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.world import World

OK = "OK"  # the status of a successful response
UNREADABLE = "UNREADABLE"  # the status of a request or response that this version cannot read


@dataclass(frozen=True, slots=True, kw_only=True)
class StateCame:
    """A state was published."""

    body_name: str  # the body
    state: BodyState  # its state, of the centre of mass


@dataclass(frozen=True, slots=True, kw_only=True)
class WorldChanged:
    """The configuration of bodies or surfaces changed."""

    world: World  # the bodies and surfaces from now on
    carried: Sequence[CarriedSurface]  # the surfaces carried by bodies
    stamp_ns: int  # ns, the time of the change by the clock of the states' stamps


@dataclass(frozen=True, slots=True, kw_only=True)
class Answered:
    """A request was answered or rejected."""

    service_name: str  # the name of the service, such as "predict_impact"
    service: Service  # the service
    number: int  # number of the request among those to this service, from 1
    # When the request arrived, ns since the epoch by the machine's clock; None for a request made on replay.
    log_time_ns: int | None
    asked_ns: int  # when the request arrived, ns by the clock of the states' stamps
    # The request's fields that differ from their defaults, by name.
    question: Mapping[str, object]
    asked: Question[Answer] | None  # the parsed request, if it was answered
    # The answer, or None if the request was rejected or the response cannot be read.
    answer: Answer | None
    status: str  # "OK", or the name of the status code
    message: str  # the response's message
    computation_time: float  # s


@dataclass(frozen=True, slots=True, kw_only=True)
class Monitored:
    """A monitor reported an event of a body."""

    body_name: str
    surface_name: str  # empty if there is none
    stamp_ns: int  # the time of the event by the clock of the states' stamps
    log_time_ns: int  # when it was reported, by the machine's clock
    text: str  # the event in words
    is_unusual: bool  # whether it lies outside its 99 % region, or a change was detected


def _monitored(logged: LoggedMessage) -> Monitored:
    msg: Any = decode_without_ros(logged)
    return Monitored(
        body_name=msg.body_name,
        surface_name=msg.surface_name,
        stamp_ns=logged.publish_time_ns,
        log_time_ns=logged.log_time_ns,
        text=msg.text,
        is_unusual=msg.alarm or msg.region == msg.OUTSIDE_99,
    )


Event: TypeAlias = StateCame | WorldChanged | Answered | Monitored


class Events(ABC):
    """A source of events: a recording and a server without ROS.

    Attributes:
        world: The bodies and surfaces, as configured at the beginning.
        carried: The surfaces carried by bodies, as configured at the beginning.
    """

    def __init__(self, reader: BagReader, server: ServerAgain) -> None:
        """Set the recording, and the server that replaces the original one."""
        self._reader = reader
        self._server = server
        self.world = server.world
        self.carried = server.parameters.carried

    @abstractmethod
    def __iter__(self) -> Iterator[Event]:
        """Read the recording and yield its events."""

    @property
    @abstractmethod
    def why_empty(self) -> str:
        """The reason, as text, if there are no questions."""

    @property
    def refused(self) -> Mapping[str, Refused]:
        """Rejected messages, by topic."""
        return self._server.refused

    @property
    def damage(self) -> str | None:
        """A description of the unreadable parts of the recording, or None if there are none."""
        return self._reader.damage

    def warn_of_damage(self) -> None:
        """Warn of damage, if there is any, at the line that called the caller."""
        if self.damage is not None:
            warnings.warn(self.damage, kind_of(self._reader.losses), stacklevel=3)


class LoggedEvents(Events):
    """A log of the server as a source of events."""

    def __init__(self, path: Path, *, span: Span = EVERYTHING, states: bool = True) -> None:
        """Read the configuration of the run. Iteration reads a span, with states and events or without.

        Raise `NotALogError` if it is not a log of the server, and `ConfigurationError` if its record of the
        run lacks a parameter, or has an invalid one.
        """
        _, server = server_of_log(path)
        super().__init__(BagReader(path), server)
        self._monitored = {
            topic.name for topic in self._reader.topics() if states and topic.type_name == MONITOR_EVENT
        }
        topics = self._server.topics if states else self._server.topics_of_changes
        self._topics = topics | self._monitored
        self._span = span
        self._numbers: dict[str, int] = {}
        self._path = path

    @property
    def why_empty(self) -> str:
        """The reason, as text, if there are no questions."""
        return "the log contains no requests with a response; --ask makes predictions from its states"

    def __iter__(self) -> Iterator[Event]:
        """Read the log; each response follows the states that were known when its request arrived."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DamagedLogWarning)  # reported by `damage`
            again = BagReader(self._path)
            for each in in_order(self._reader, again, self._topics, span=self._span):
                if isinstance(each, ServiceCall):
                    answered = self._answered(each)
                    if answered is not None:
                        yield answered
                    continue
                if each.topic in self._monitored:
                    yield _monitored(each)
                    continue
                before = self._server.world
                for body_name, state in self._server.receive(each):
                    yield StateCame(body_name=body_name, state=state)
                if self._server.world is not before:
                    yield WorldChanged(
                        world=self._server.world,
                        carried=self._server.parameters.carried,
                        stamp_ns=each.publish_time_ns,
                    )

    def _answered(self, call: ServiceCall) -> Answered | None:
        if call.request_event is None or call.response_event is None:
            return None
        number = self._numbers[call.service] = self._numbers.get(call.service, 0) + 1
        service = service_of_type(call.service_type)
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
                asked = self._server.question_of(service, request)
                answer = service.answer_from_msg(response, world=self._server.world)
        except (ContactDynamicsError, AttributeError) as error:  # the latter if a log's fields differ
            status, message, seconds = UNREADABLE, f"this version cannot read it: {error}", 0.0
        return Answered(
            service_name=call.service.rpartition("/")[2],
            service=service,
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
    """Return the name of a response's status; status codes are larger than its other constants."""
    if response.status == response.OK:
        return OK
    constants = vars(type(response)).items()
    return next((name for name, value in constants if name.isupper() and value == response.status), "UNKNOWN")


QUESTIONS: Final[Mapping[str, Callable[..., Question[Answer]]]] = {
    "landing": partial(TumblingQuestion, sampling=UntilContact()),
    "impact": ImpactQuestion,
    "modes": ContactModeQuestion,
}
"""The requests about a body and a state."""


class AskedEvents(Events):
    """A recording as a source of events: its states, and responses to requests that are made on replay."""

    def __init__(
        self,
        path: Path,
        source: ParameterSource,
        *,
        names: Sequence[str],
        bodies: Sequence[str],
        every: float,
        fit_window: float,
        span: Span,
    ) -> None:
        """Configure the server.

        The requests ``names``, of `QUESTIONS`, are made about ``bodies``, or about all bodies if it is empty,
        with a period of ``every``, s, by the stamps; 0 means at each state. The motion is fitted to the
        states of the last ``fit_window``, s; 0 means to the latest one.

        Raise `NotALogError` if it is not a recording, `ConfigurationError` if a parameter is missing or not
        allowed, and `InvalidFieldError` if one of ``bodies`` is not configured.
        """
        reader = BagReader(path)
        stand_in(())
        from contact_dynamics.replay.again import ServerAgain  # imports what `stand_in` has made

        super().__init__(reader, ServerAgain(source))
        self._names, self._bodies = names, bodies
        self._every, self._fit_window = every, fit_window
        self._span = span
        known = [body.name for body in self.world.bodies]
        for name in bodies:
            if name not in known:
                raise InvalidFieldError("body", name, f"one of {known}")
        self._numbers = dict.fromkeys(QUESTIONS, 0)
        self._next_ns: dict[str, int] = {}

    @property
    def why_empty(self) -> str:
        """The reason, as text, if there are no questions."""
        if not self._names:
            return f"no prediction was requested; --ask must be one of {', '.join(QUESTIONS)}"
        bodies = ", ".join(self._bodies or [body.name for body in self.world.bodies]) or "no body"
        topics = ", ".join(sorted(self._server.topics - {CLOCK})) or "none"
        return f"the configured topics ({topics}) contain no state of {bodies}; --topics selects others"

    def __iter__(self) -> Iterator[Event]:
        """Read the recording, and make the requests that are due after each state."""
        topics = self._server.topics
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DamagedLogWarning)  # reported by `damage`
            for message in self._reader.messages(topics, **self._span._asdict()):
                for body_name, state in self._server.receive(message, is_live=False):
                    yield StateCame(body_name=body_name, state=state)
                    if self._is_due(body_name, state.stamp_ns):
                        for name in self._names:
                            yield self._asked(name, body_name, state.stamp_ns, message.log_time_ns)

    def _is_due(self, body_name: str, stamp_ns: int) -> bool:
        if self._bodies and body_name not in self._bodies:
            return False
        due_ns = self._next_ns.get(body_name)
        if due_ns is not None and stamp_ns < due_ns:
            return False
        self._next_ns[body_name] = ns_after(stamp_ns, self._every)
        return True

    def _asked(self, name: str, body_name: str, stamp_ns: int, log_time_ns: int) -> Answered:
        self._numbers[name] += 1
        answer, status, message = None, OK, ""
        question = QUESTIONS[name](body=body_name, state=PublishedState(fit_window=self._fit_window))
        self._server.asked_ns = stamp_ns
        try:
            answer = ask(question, self._server.context)
        except ContactDynamicsError as error:
            status, message = code_name(error), str(error)
        service = service_of(question)
        window = {"fit_window": self._fit_window} if self._fit_window > 0.0 else {}
        return Answered(
            service_name=service.name,
            service=service,
            number=self._numbers[name],
            log_time_ns=log_time_ns,
            asked_ns=stamp_ns,
            question={"body_name": body_name, "ask": name, **window},
            asked=question,
            answer=answer,
            status=status,
            message=message,
            computation_time=0.0,
        )
