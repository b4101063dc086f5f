"""Answers questions as the server of a log did, with its configuration and the states that it knew.

It shares the server's code: parameters, states and requests are read by the same functions, the same layer
answers, and responses are written by the same functions. It needs no ROS.
"""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.nodes.parameters import read_server_parameters
from contact_dynamics.nodes.run_record import LoggedParameters
from contact_dynamics.nodes.services import SERVICES
from contact_dynamics.nodes.state_sources import state_sources
from contact_dynamics.questions.extent import check_believable
from contact_dynamics.questions.knowledge import Knowledge
from contact_dynamics.questions.state_store import StateStore
from contact_dynamics.questions.uncertain_state import state_of
from contact_dynamics.recording.cdr import decode_without_ros
from contact_dynamics.recording.cdr_stamp import leading_stamp_ns
from msg_adapters.status import report_error

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from contact_dynamics.recording.bag_reader import LoggedMessage

CLOCK: Final = "/clock"


class ServerAgain:
    """Answers requests as the server of a log did, from its configuration and what it had received."""

    def __init__(self, run: Mapping[str, str]) -> None:
        """Take the configuration from the log's record of its run.

        Raises:
            ConfigurationError: the record lacks a parameter, or has one that is not allowed.
        """
        parameters = read_server_parameters(LoggedParameters(run))
        self._asked_ns = 0
        self._clock_ns = 0
        self._is_simulated = run.get("use_sim_time") == str(True)
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
        self._sources = {source.full_name: source.readers for source in state_sources(parameters)}

    @property
    def topics(self) -> frozenset[str]:
        """The topics that answers depend on."""
        return frozenset({*self._sources, CLOCK})

    def receive(self, message: LoggedMessage) -> None:
        """Take a message about a body, or a tick of the simulated time. Ignore what the server ignored."""
        if message.topic == CLOCK:
            self._tick(leading_stamp_ns(message.data))
            return
        now_ns = self._clock_ns or None if self._is_simulated else message.log_time_ns
        for body_name, state_from in self._sources[message.topic]:
            with suppress(ContactDynamicsError):
                state = state_from(decode_without_ros(message))
                if state is not None:
                    check_believable(state_of(state))
                    self._states.add(body_name, state, now_ns=now_ns)

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
