# SPDX-License-Identifier: Apache-2.0
"""What happened, in the order in which it came: states of bodies, and answers to questions about them.

`logged.LoggedEvents` reads them from a log of the server. `asking.AskedEvents` reads states from any
recording and asks questions of them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from contact_dynamics.questions.services import Answer, Question, Service
    from contact_dynamics.recording.bag_reader import BagReader
    from contact_dynamics.replay.again import Refused, ServerAgain
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.world import World

OK = "OK"
"""The status of a question that was answered."""

UNREADABLE = "UNREADABLE"
"""The status of a question or an answer that this version cannot read."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StateCame:
    """A state was published.

    Attributes:
        body_name: The body.
        state: Its state, of the centre of mass.
    """

    body_name: str
    state: BodyState


@dataclass(frozen=True, slots=True, kw_only=True)
class WorldChanged:
    """The bodies or surfaces were configured anew.

    Attributes:
        world: The bodies and surfaces from now on.
        stamp_ns: ns, the time of the change by the clock of the states' stamps.
    """

    world: World
    stamp_ns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Answered:
    """A question was answered or refused.

    Attributes:
        service_name: The name of the service that was asked, as "predict_impact".
        service: The service that was asked.
        number: Number of the question among those to this service, from 1.
        log_time_ns: When it came, ns since the epoch by the machine's clock. It is None if nobody asked it
            then.
        asked_ns: When it came, ns by the clock of the states' stamps.
        question: What was asked, by the names of the request's fields, as far as it is not the default.
        asked: The question, if it was answered.
        answer: The answer. It is None if the question was refused, or if the answer cannot be read.
        status: "OK", or the name of the code with which it was refused.
        message: What was said of it.
        computation_time: s, how long the answer took.
    """

    service_name: str
    service: Service
    number: int
    log_time_ns: int | None
    asked_ns: int
    question: Mapping[str, object]
    asked: Question[Answer] | None
    answer: Answer | None
    status: str
    message: str
    computation_time: float


Event: TypeAlias = StateCame | WorldChanged | Answered


class Events(ABC):
    """A recording that events are read from.

    Attributes:
        world: The bodies and surfaces that they are about, as they were at the beginning.
    """

    def __init__(self, reader: BagReader, server: ServerAgain) -> None:
        """Take the recording, and what stands in for the server."""
        self._reader = reader
        self._server = server
        self.world = server.world

    @abstractmethod
    def __iter__(self) -> Iterator[Event]:
        """Read the recording and yield what happened."""

    @property
    @abstractmethod
    def why_empty(self) -> str:
        """Why there is no question, in words, where there is none."""

    @property
    def refused(self) -> Mapping[str, Refused]:
        """Messages that made no state, by topic."""
        return self._server.refused

    @property
    def damage(self) -> str | None:
        """What of the recording could not be read, in words, or None if all was whole."""
        return self._reader.damage
