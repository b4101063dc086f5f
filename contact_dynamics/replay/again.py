"""Answers questions as the server of a log did, with its configuration and the states that it knew.

It shares the server's code: parameters, states and requests are read by the same functions, the same layer
answers, and responses are written by the same functions. It needs no ROS.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.nodes.parameters import read_server_parameters
from contact_dynamics.nodes.services import SERVICES
from contact_dynamics.nodes.state_sources import state_sources
from contact_dynamics.questions.extent import check_believable
from contact_dynamics.questions.knowledge import Knowledge
from contact_dynamics.questions.state_store import StateStore
from contact_dynamics.questions.uncertain_state import state_of
from contact_dynamics.recording.cdr import decode_without_ros
from contact_dynamics.recording.cdr_stamp import leading_stamp_ns
from contact_dynamics.replay.events import Answer, Question
from msg_adapters.contact_mode import contact_mode_answer_from_msg
from msg_adapters.impact import impact_answer_from_msg
from msg_adapters.questions import (
    contact_mode_question_from_msg,
    impact_question_from_msg,
    tumbling_question_from_msg,
)
from msg_adapters.status import report_error
from msg_adapters.tumbling import tumbling_answer_from_msg

if TYPE_CHECKING:
    from contact_dynamics.nodes.parameters import ParameterSource
    from contact_dynamics.recording.bag_reader import LoggedMessage
    from contact_dynamics.rigid_body.body import BodyState
    from msg_adapters.state_adapter import Reader

CLOCK: Final = "/clock"

_QUESTIONS: Final[Mapping[str, Callable[..., Question]]] = {
    "PredictContactMode": contact_mode_question_from_msg,
    "PredictImpact": impact_question_from_msg,
    "PredictTumbling": tumbling_question_from_msg,
}

_ANSWERS: Final[Mapping[str, Callable[..., Answer]]] = {
    "PredictContactMode": contact_mode_answer_from_msg,
    "PredictImpact": impact_answer_from_msg,
    "PredictTumbling": tumbling_answer_from_msg,
}


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
        parameters = read_server_parameters(source)
        self.world = parameters.world
        self.refused: dict[str, Refused] = {}
        self._asked_ns = 0
        self._clock_ns = 0
        self._is_simulated = source.value("use_sim_time", False, "Whether time is simulated.")  # noqa: FBT003
        self._states = StateStore(
            history=parameters.state_history,
            timeout=parameters.state_timeout,
            future_tolerance=parameters.future_tolerance,
        )
        self._world_frame = parameters.world_frame
        self._knowledge = Knowledge(
            world=parameters.world,
            states=self._states,
            defaults=parameters.defaults,
            now_ns=lambda: self._asked_ns or None,  # it is zero before a simulation tells the time
        )
        self._sources = {each.full_name: each.readers for each in state_sources(parameters)}

    @property
    def world_frame(self) -> str:
        """The name of the world's frame."""
        return self._world_frame

    @property
    def topics(self) -> frozenset[str]:
        """The topics that answers depend on."""
        return frozenset({*self._sources, CLOCK})

    def receive(self, message: LoggedMessage, *, is_live: bool = True) -> list[tuple[str, BodyState]]:
        """Take a message about bodies, or a tick of the simulated time; ignore what the server ignored.

        Args:
            message: a message of one of the `topics`.
            is_live: whether the clock at its reception is known. If not, a state is taken whatever its stamp.

        Returns:
            The bodies and their states, where the message completes any.
        """
        if message.topic == CLOCK:
            self._tick(leading_stamp_ns(message.data))
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
            state = state_from(decode_without_ros(message))
            if state is None:
                return None
            check_believable(state_of(state))
            self._states.add(body_name, state, now_ns=now_ns)
        except ContactDynamicsError as error:
            self.refused.setdefault(message.topic, Refused(reason=str(error))).count += 1
            return None
        return body_name, state_of(state)

    def knowledge_at(self, asked_ns: int) -> Knowledge:
        """Return what is known at a time, ns by the clock of the states."""
        self._asked_ns = asked_ns
        return self._knowledge

    def question_from(self, service_type: str, request: Any) -> Question | None:
        """Return the question that a request asks, or None for a batch of questions.

        Raises:
            ContactDynamicsError: the request is refused.
        """
        read = _QUESTIONS.get(service_type.rpartition("/")[2])
        return None if read is None else read(request, world=self.world, world_frame=self._world_frame)

    def answer_from(self, service_type: str, response: Any) -> Answer | None:
        """Return the answer that a response carries, whose status is OK, or None for a batch of answers.

        Raises:
            ContactDynamicsError: a number in it is not allowed.
        """
        read = _ANSWERS.get(service_type.rpartition("/")[2])
        return None if read is None else read(response, world=self.world)

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
        name = service_type.rpartition("/")[2]
        service = next(service for service in SERVICES if service.type_name == name)
        response = make_response()
        try:
            service.serve(request, response, self._knowledge, world_frame=self._world_frame)
        except Exception as error:  # noqa: BLE001  the server reports a fault of its own too, and goes on
            response = make_response()
            report_error(response, error)
        return response

    def _tick(self, clock_ns: int) -> None:
        if clock_ns < self._clock_ns:  # the server forgets all states when its clock is set back
            self._states.clear()
        self._clock_ns = clock_ns
