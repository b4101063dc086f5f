# SPDX-License-Identifier: Apache-2.0
"""Recomputes the responses of a log's server from its configuration and the states that it had received.

It shares the server's core (`nodes.server_core`), and requires no ROS.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.nodes.parameters import read_server_parameters
from contact_dynamics.nodes.run_record import CHANGES, LoggedParameters, changed_values
from contact_dynamics.nodes.server_core import ServerCore
from contact_dynamics.nodes.state_sources import no_message
from contact_dynamics.questions.services import at_instant, service_of_type
from contact_dynamics.questions.uncertain_state import state_of
from contact_dynamics.recording.cdr import decode_without_ros, leading_stamp_ns
from contact_dynamics.replay.timeline import CLOCK
from msg_adapters.rejected_fields import check_numbers, in_fields
from msg_adapters.status import report_error

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from contact_dynamics.nodes.parameter_reader import ParameterSource
    from contact_dynamics.nodes.state_sources import BodyReader
    from contact_dynamics.recording.bag_reader import LoggedMessage
    from contact_dynamics.rigid_body.body import BodyState


@dataclass(slots=True, kw_only=True)
class Refused:
    """Rejected messages of one topic."""

    reason: str  # why the first of them was rejected
    count: int = 0  # number of rejected messages


class ServerAgain(ServerCore):
    """Answers requests as the server of a log did, from its configuration and the messages it received.

    Attributes:
        refused: The rejected messages, by topic.
    """

    def __init__(self, source: ParameterSource) -> None:
        """Read the configuration from a log's record of its run or from a file.

        Raise `ConfigurationError` if a parameter is missing or not allowed.
        """
        super().__init__(read_server_parameters(source))
        self.expect()
        self.refused: dict[str, Refused] = {}
        self._source = source
        self._clock_ns = 0
        self._is_simulated = source.value("use_sim_time", False, "Whether time is simulated.")  # noqa: FBT003

    @property
    def topics(self) -> frozenset[str]:
        """The topics that responses depend on."""
        return frozenset({*self.sources, CLOCK, *self.topics_of_changes})

    @property
    def topics_of_changes(self) -> frozenset[str]:
        """The topics of changes of the configuration, which only the log of a server has."""
        return frozenset({CHANGES} if isinstance(self._source, LoggedParameters) else ())

    def receive(self, message: LoggedMessage, *, is_live: bool = True) -> list[tuple[str, BodyState]]:
        """Process a message, and return the bodies whose state it completes, with these states.

        The message contains poses or velocities of bodies, a tick of the simulated time, or a change of the
        configuration. Without ``is_live``, the clock at its reception is unknown, and states are accepted
        whatever their stamp.
        """
        if message.topic == CLOCK:
            self._tick(leading_stamp_ns(message.data))
            return []
        if message.topic in self.topics_of_changes:
            self._change(changed_values(decode_without_ros(message)))  # type: ignore[arg-type]
            return []
        now_ns = (self._clock_ns or None if self._is_simulated else message.log_time_ns) if is_live else None
        readers = self.sources[message.topic].readers
        try:
            decoded = decode_without_ros(message)
        except ContactDynamicsError as error:
            no_state = no_message(message.data, message.type_name)
            for reader in readers:
                self._refuse(message.topic, reader.body_name, error, no_state, now_ns)
            return []
        came = (self._take(message.topic, decoded, reader, now_ns=now_ns) for reader in readers)
        return [each for each in came if each is not None]

    def _take(
        self, topic: str, decoded: object, reader: BodyReader, *, now_ns: int | None
    ) -> tuple[str, BodyState] | None:
        try:
            check_numbers(decoded)
            state = reader.believable(decoded)
            if state is None:
                return None
            self.states.add(reader.body_name, state, now_ns=now_ns)
        except ContactDynamicsError as error:
            told = in_fields(error)
            self._refuse(topic, reader.body_name, told, told, now_ns)
            return None
        return reader.body_name, state_of(state)

    def _refuse(
        self, topic: str, body_name: str, error: Exception, said_by_server: Exception, now_ns: int | None
    ) -> None:
        self.refused.setdefault(topic, Refused(reason=str(error))).count += 1
        self.states.refuse(body_name, said_by_server, now_ns=now_ns)

    def answer(
        self, service_type: str, request: object, make_response: Callable[[], Any], *, asked_ns: int
    ) -> Any:
        """Return the response to a logged request, also if the request is rejected.

        The request arrived at ``asked_ns``, ns, on the clock of the states' stamps.
        """
        self.asked_ns = asked_ns
        service = service_of_type(service_type)
        response = make_response()
        try:
            question = self.question_of(service, request)
            self.fill(service, service.answer(question, at_instant(question, self.context)), response)
        except Exception as error:  # noqa: BLE001  the server reports its internal errors too
            response = make_response()
            report_error(response, error)
        return response

    def _change(self, values: Mapping[str, Any]) -> None:
        """Change the configuration from now on, as the server did according to the log."""
        if isinstance(self._source, LoggedParameters):
            self._source = self._source.changed(values)
            self.change(read_server_parameters(self._source))
            self.expect()

    def _tick(self, clock_ns: int) -> None:
        if clock_ns < self._clock_ns:  # the server discards all states when its clock is set back
            self.states.clear()
        self._clock_ns = clock_ns
