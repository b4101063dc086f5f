# SPDX-License-Identifier: Apache-2.0
"""Asks questions of a recording that perhaps no server of ours was part of: what would it have said?

The clock is that of the states' stamps. Each question is asked at a state, of what was published by then.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Final

from contact_dynamics.constants import ns_after
from contact_dynamics.errors import ContactDynamicsError, InvalidFieldError
from contact_dynamics.questions.contact_modes import ContactModeQuestion
from contact_dynamics.questions.impact_question import ImpactQuestion
from contact_dynamics.questions.sample_times import UntilContact
from contact_dynamics.questions.services import ask, service_of
from contact_dynamics.questions.subject import PublishedState
from contact_dynamics.questions.tumbling import TumblingQuestion
from contact_dynamics.recording.bag_reader import BagReader
from contact_dynamics.recording.errors import DamagedLogWarning
from contact_dynamics.replay.events import OK, Answered, Events, StateCame
from contact_dynamics.replay.stand_ins import stand_in
from contact_dynamics.replay.timeline import CLOCK
from contact_dynamics.validation import check_not_negative
from msg_adapters.status import code_name

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from pathlib import Path

    from contact_dynamics.nodes.parameter_reader import ParameterSource
    from contact_dynamics.questions.services import Answer, Question
    from contact_dynamics.recording.file_messages import Span
    from contact_dynamics.replay.events import Event

LANDING: Final = "landing"
IMPACT: Final = "impact"
MODES: Final = "modes"
QUESTIONS: Final[Mapping[str, Callable[..., Question[Answer]]]] = {
    LANDING: partial(TumblingQuestion, sampling=UntilContact()),
    IMPACT: ImpactQuestion,
    MODES: ContactModeQuestion,
}
"""What can be asked about a body and a state."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Asking:
    """What is asked of a recording, and when.

    Attributes:
        names: Which questions, of `QUESTIONS`. Without any, the states alone are read.
        bodies: The bodies that are asked about. Without any, all that are configured are.
        every: s, by the stamps, from one question about a body to the next. With zero each state has one.
        fit_window: s. The motion is fitted to the states of this last time, with zero to none but the newest.

    Raises:
        InvalidFieldError: a question is not known, or a time is negative or not finite.
    """

    names: tuple[str, ...] = ()
    bodies: tuple[str, ...] = ()
    every: float = 0.1
    fit_window: float = 0.0

    def __post_init__(self) -> None:
        """Check all of it."""
        for name in self.names:
            if name not in QUESTIONS:
                raise InvalidFieldError("ask", name, f"one of {', '.join(QUESTIONS)}")
        check_not_negative("every", self.every)
        check_not_negative("fit_window", self.fit_window)


class AskedEvents(Events):
    """A recording as a source of events: its states, and answers to questions that are asked now."""

    def __init__(self, path: Path, source: ParameterSource, *, asking: Asking, span: Span) -> None:
        """Configure what would have been a server.

        Args:
            path: the recording: its folder, or one of its files.
            source: how the server would have been configured.
            asking: what is asked.
            span: which part of it is read.

        Raises:
            NotALogError: it is no recording.
            ConfigurationError: a parameter is missing or not allowed.
            InvalidFieldError: a body that is asked about is not configured.
        """
        reader = BagReader(path)
        stand_in(())
        from contact_dynamics.replay.again import ServerAgain  # here, for it imports what stands in for ROS

        super().__init__(reader, ServerAgain(source))
        self._asking = asking
        self._span = span
        known = [body.name for body in self.world.bodies]
        for name in asking.bodies:
            if name not in known:
                raise InvalidFieldError("body", name, f"one of {known}")
        self._numbers = dict.fromkeys(QUESTIONS, 0)
        self._next_ns: dict[str, int] = {}

    @property
    def why_empty(self) -> str:
        """Why there is no question, in words, where there is none."""
        if not self._asking.names:
            return f"no prediction was requested; --ask must be one of {', '.join(QUESTIONS)}"
        bodies = ", ".join(self._asking.bodies or [body.name for body in self.world.bodies]) or "no body"
        topics = ", ".join(sorted(self._server.topics - {CLOCK})) or "none"
        return f"the configured topics ({topics}) contain no state of {bodies}; --topics selects others"

    def __iter__(self) -> Iterator[Event]:
        """Read the recording, and ask after each state that it is time for."""
        topics = self._server.topics
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DamagedLogWarning)  # told by `damage`
            for message in self._reader.messages(
                topics, start_ns=self._span.start_ns, end_ns=self._span.end_ns
            ):
                for body_name, state in self._server.receive(message, is_live=False):
                    yield StateCame(body_name=body_name, state=state)
                    if self._is_due(body_name, state.stamp_ns):
                        for name in self._asking.names:
                            yield self._asked(name, body_name, state.stamp_ns, message.log_time_ns)

    def _is_due(self, body_name: str, stamp_ns: int) -> bool:
        if self._asking.bodies and body_name not in self._asking.bodies:
            return False
        due_ns = self._next_ns.get(body_name)
        if due_ns is not None and stamp_ns < due_ns:
            return False
        self._next_ns[body_name] = ns_after(stamp_ns, self._asking.every)
        return True

    def _asked(self, name: str, body_name: str, stamp_ns: int, log_time_ns: int) -> Answered:
        self._numbers[name] += 1
        answer, status, message = None, OK, ""
        question = QUESTIONS[name](body=body_name, state=PublishedState(fit_window=self._asking.fit_window))
        try:
            answer = ask(question, self._server.context_at(stamp_ns))
        except ContactDynamicsError as error:
            status, message = code_name(error), str(error)
        service = service_of(question)
        window = {"fit_window": self._asking.fit_window} if self._asking.fit_window > 0.0 else {}
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
