# SPDX-License-Identifier: Apache-2.0
"""Answers questions as the server of a log did, with its configuration and the states that it knew.

It shares the server's code: parameters, states and requests are read by the same functions, the same layer
answers, and responses are written by the same functions. It needs no ROS.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.nodes.parameters import CONFIGURED_ANEW, bodies_read_otherwise, read_server_parameters
from contact_dynamics.nodes.run_record import CHANGES, LoggedParameters, changed_values
from contact_dynamics.nodes.state_sources import expected, no_message, state_sources
from contact_dynamics.questions.context import Context
from contact_dynamics.questions.extent import check_believable
from contact_dynamics.questions.services import service_of_type
from contact_dynamics.questions.state_store import StateStore
from contact_dynamics.questions.uncertain_state import state_of
from contact_dynamics.recording.cdr import decode_without_ros
from contact_dynamics.recording.cdr_stamp import leading_stamp_ns
from contact_dynamics.replay.timeline import CLOCK
from msg_adapters.rejected_fields import check_numbers, in_fields
from msg_adapters.status import report_error
from msg_adapters.transforms import TransformTree

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from contact_dynamics.nodes.parameter_reader import ParameterSource
    from contact_dynamics.questions.services import Answer, Question
    from contact_dynamics.recording.bag_reader import LoggedMessage
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.world import World
    from msg_adapters.state_adapter import Reader


@dataclass(slots=True, kw_only=True)
class Refused:
    """Messages of one topic that made no state.

    Attributes:
        reason: Why the first of them was refused.
        count: How many were.
    """

    reason: str
    count: int = 0


class ServerAgain:
    """Answers requests as the server of a log did, from its configuration and what it had received."""

    def __init__(self, source: ParameterSource) -> None:
        """Take the configuration, from a log's record of its run or from a file.

        Raises:
            ConfigurationError: a parameter is missing, or one is not allowed.
        """
        self._source = source
        self._parameters = parameters = read_server_parameters(source)
        self.refused: dict[str, Refused] = {}
        self._asked_ns = 0
        self._clock_ns = 0
        self._is_simulated = source.value("use_sim_time", False, "Whether time is simulated.")  # noqa: FBT003
        self._states = StateStore(
            history=parameters.state_history,
            timeout=parameters.state_timeout,
            future_tolerance=parameters.future_tolerance,
            max_states=parameters.max_states,
        )
        self._static = TransformTree()
        self._context = Context(
            world=parameters.world,
            states=self._states,
            defaults=parameters.defaults,
            now_ns=lambda: self._asked_ns or None,  # it is zero before a simulation tells the time
        )
        self._find_sources()

    @property
    def world(self) -> World:
        """The bodies and surfaces that are configured at present."""
        return self._parameters.world

    @property
    def world_frame(self) -> str:
        """The name of the world's frame."""
        return self._parameters.world_frame

    @property
    def topics(self) -> frozenset[str]:
        """The topics that answers depend on."""
        return frozenset({*self._sources, CLOCK, *self.topics_of_changes})

    @property
    def topics_of_changes(self) -> frozenset[str]:
        """The topics of changes of the configuration, which the log of a server has."""
        return frozenset({CHANGES} if isinstance(self._source, LoggedParameters) else ())

    def receive(self, message: LoggedMessage, *, is_live: bool = True) -> list[tuple[str, BodyState]]:
        """Take a message about bodies, a tick of the simulated time, or a change; ignore what the server did.

        Args:
            message: a message of one of the `topics`.
            is_live: whether the clock at its reception is known. If not, a state is taken whatever its stamp.

        Returns:
            The bodies and their states, where the message completes any.
        """
        if message.topic == CLOCK:
            self._tick(leading_stamp_ns(message.data))
            return []
        if message.topic in self.topics_of_changes:
            self._change(changed_values(decode_without_ros(message)))  # type: ignore[arg-type]
            return []
        now_ns = self._clock_ns or None if self._is_simulated else message.log_time_ns
        came = (
            self._take(message, body_name, state_from, now_ns=now_ns if is_live else None)
            for body_name, state_from in self._sources[message.topic]
        )
        return [each for each in came if each is not None]

    def _take(
        self, message: LoggedMessage, body_name: str, state_from: Reader, *, now_ns: int | None
    ) -> tuple[str, BodyState] | None:
        try:
            decoded = decode_without_ros(message)
        except ContactDynamicsError as error:
            told: Exception = no_message(message.data, message.type_name)
            self._refuse(message.topic, body_name, error, told, now_ns)
            return None
        try:
            check_numbers(decoded)
            state = state_from(decoded)
            if state is None:
                return None
            check_believable(state_of(state))
            self._states.add(body_name, state, now_ns=now_ns)
        except ContactDynamicsError as error:
            told = in_fields(error)
            self._refuse(message.topic, body_name, told, told, now_ns)
            return None
        return body_name, state_of(state)

    def _refuse(
        self, topic: str, body_name: str, error: Exception, said_by_server: Exception, now_ns: int | None
    ) -> None:
        self.refused.setdefault(topic, Refused(reason=str(error))).count += 1
        self._states.refuse(body_name, said_by_server, now_ns=now_ns)

    def context_at(self, asked_ns: int) -> Context:
        """Return what is known at a time, ns by the clock of the states."""
        self._asked_ns = asked_ns
        return self._context

    def question_from(self, service_type: str, request: Any) -> Question[Answer]:
        """Return the question that a request asks.

        Raises:
            ContactDynamicsError: the request is refused.
        """
        service = service_of_type(service_type)
        return service.question_of(request, world=self.world, world_frame=self._parameters.world_frame)

    def answer_from(self, service_type: str, response: Any) -> Answer:
        """Return the answer that a response carries, whose status is OK.

        Raises:
            ContactDynamicsError: a number in it is not allowed.
        """
        return service_of_type(service_type).answer_from_msg(response, world=self.world)

    def answer(
        self, service_type: str, request: object, make_response: Callable[[], Any], *, asked_ns: int
    ) -> Any:
        """Return the response to a request, also where the request is refused.

        Args:
            service_type: "package/srv/Name".
            request: the request as it was logged.
            make_response: a function that returns an empty response.
            asked_ns: when the request came, ns, on the clock of the states' stamps.
        """
        self._asked_ns = asked_ns
        service = service_of_type(service_type)
        response = make_response()
        try:
            question = self.question_from(service_type, request)
            answer = service.answer(question, self._context)
            service.answer_to_msg(answer, world_frame=self.world_frame, into=response)
        except Exception as error:  # noqa: BLE001  the server reports a fault of its own too, and goes on
            response = make_response()
            report_error(response, error)
        return response

    def _change(self, values: Mapping[str, Any]) -> None:
        """Answer with another configuration from now on, as `Serving.change` does."""
        if not isinstance(self._source, LoggedParameters):
            return
        self._source = self._source.changed(values)
        before, self._parameters = self._parameters, read_server_parameters(self._source)
        parameters = self._parameters
        self._states.change_limits(
            history=parameters.state_history,
            timeout=parameters.state_timeout,
            future_tolerance=parameters.future_tolerance,
            max_states=parameters.max_states,
        )
        changed = bodies_read_otherwise(before, parameters)
        for name in changed:
            self._states.forget(name, CONFIGURED_ANEW)
        if changed:
            self._find_sources()
        self._context = replace(self._context, world=parameters.world, defaults=parameters.defaults)

    def _find_sources(self) -> None:
        sources = state_sources(self._parameters, static=self._static)
        self._sources = {each.full_name: each.readers for each in sources}
        for body in self._parameters.sources:
            self._states.expect(body.body_name, expected(body))

    def _tick(self, clock_ns: int) -> None:
        if clock_ns < self._clock_ns:  # the server forgets all states when its clock is set back
            self._states.clear()
        self._clock_ns = clock_ns
