# SPDX-License-Identifier: Apache-2.0
"""A service's front takes requests, answers them or has them answered, and sends the responses.

A quick question is answered at once. Another goes to a worker, and the server goes on until its answer comes.
A client that left is not answered: to send to it takes 0.1 s, in which nobody else is served.
"""

from __future__ import annotations

import time
import traceback
import warnings
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Final

from rclpy.exceptions import InvalidHandle
from rclpy.qos import QoSProfile
from rclpy.serialization import serialize_message
from rclpy.service_introspection import ServiceIntrospectionState

from contact_dynamics.errors import BusyError, ContactDynamicsError
from contact_dynamics.nodes.calls import CallTimes, GoneClients
from contact_dynamics.questions.services import ImportedOnUse, at_instant
from contact_dynamics.recording.cdr import EventType, cut_to_its_end
from contact_dynamics.recording.definitions import find_definition
from contact_dynamics.recording.message_types import message_class
from msg_adapters.stamps import stamp_to_msg
from msg_adapters.status import report_error

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from contact_dynamics.nodes.calls import Call
    from contact_dynamics.nodes.inbox import InboxNode, Taken
    from contact_dynamics.nodes.log import Log
    from contact_dynamics.nodes.server_core import ServerCore
    from contact_dynamics.questions.context import Context
    from contact_dynamics.questions.services import Answer, Service
    from contact_dynamics.questions.workers import Workers
    from msg_adapters.status import Response

SERVICE_QOS = QoSProfile(depth=1000)
"""Queue depth of the services. With the usual 10, replies get lost when several clients ask at once."""

EVENT_QOS = QoSProfile(depth=10 * SERVICE_QOS.depth)
"""The queue of the service events is this deep. The log must lose none of them, and all requests that wait
are answered, each with two events, before the first of these events is taken."""

_EVENT_PATIENCE_S: Final = 0.1
"""s for which the event of a request is waited for, where the answer is logged before it leaves. DDS hands it
over with the request, and another DDS may be later."""

_EXCERPT: Final[ImportedOnUse[Context]] = ImportedOnUse("contact_dynamics.questions.effort:excerpt")

_TELL_EVERY_S: Final = 5.0  # an answer that did not reach its client

_EVENT_POLL_S: Final = 0.001


@dataclass(slots=True, kw_only=True, eq=False)
class _Answering:
    """A call that is being answered.

    Attributes:
        call: When it came, and from whom.
        response: What is sent. It counts once the call is done.
        begun: s, by a clock that measures durations.
        is_done: Whether the response can be sent.
        header: What DDS needs to send it, once it is known.
    """

    call: Call
    response: Response
    begun: float
    is_done: bool = False
    header: Any = None


class ServiceFront:
    """Serves one of the services.

    Attributes:
        is_active: Whether questions are answered. Otherwise they are refused.
        gone: The clients that seemed gone. One that is only found late is answered what it asks from then on.
    """

    def __init__(
        self,
        node: InboxNode,
        served: Service,
        *,
        core: ServerCore,
        workers: Workers | None,
        log: Log,
        answered: Callable[[Response], object],
    ) -> None:
        """Begin to serve.

        Args:
            node: the node.
            served: the service.
            core: the configuration, the published states, and the time at which each request arrives.
            workers: they answer what takes long. Without them, this process does.
            log: takes the service events.
            answered: sees each response after it was sent, so that nobody waits for it.
        """
        self._node = node
        self._served = served
        self._core = core
        self._workers = workers
        self._log = log
        self._answered = answered
        self._event_bytes = EventBytes(f"contact_dynamics_interfaces/srv/{served.type_name}_Event")
        self._under_way: set[_Answering] = set()  # that workers answer
        self._times = CallTimes(lambda: node.get_clock().now().nanoseconds)
        self.is_active = False
        self.gone = GoneClients(core.parameters.client_gone_for)
        self._service = service = node.create_service(
            served.service_type, f"~/{served.name}", self._take, qos_profile=SERVICE_QOS
        )
        service.configure_introspection(node.get_clock(), EVENT_QOS, ServiceIntrospectionState.CONTENTS)
        self._send_response = service.send_response
        # An executor of rclpy sends what the callback returns at once. This is its way to send.
        service.send_response = self._send_or_wait
        self.topic = f"{service.service_name}/_service_event"
        self._events = node.subscribe(
            served.service_type.Event, self.topic, self._record_event, EVENT_QOS, in_rounds=False
        )

    def remove(self) -> None:
        """Take the service from the node."""
        self._node.destroy_service(self._service)

    def refuse_all(self) -> int:
        """Refuse the questions that workers answer at present, and those that wait; return how many."""
        message = "the server ended, or was cleaned up, before the answer was there"

        def refuse() -> None:
            raise BusyError(message)

        refused, self._under_way = [*self._under_way, *self._waiting()], set()
        for answering in refused:
            self._finish(answering, refuse)
            self._send(answering)
        return len(refused)

    def _waiting(self) -> Iterator[_Answering]:
        """Take the requests that have arrived and were not taken yet."""
        while self._is_open():
            with self._service.handle:
                _, header = self._service.handle.service_take_request(self._served.service_type.Request)
            if header is None:
                return
            call = self._times.begin()
            response = self._served.service_type.Response()
            yield _Answering(call=call, response=response, begun=time.perf_counter(), header=header)

    def take_events(self) -> None:
        """Take the events of requests and responses that wait, for the log."""
        self._node.empty(self._events)

    def _take(self, request: object, response: Response) -> _Answering:
        self._node.take_messages()  # the question sees all states that came before it
        call = self._times.begin()
        self._core.asked_ns = call.node_clock_ns
        self._node.note_question(call.received_ns)
        answering = _Answering(call=call, response=response, begun=time.perf_counter())
        if self._is_open():
            self._serve(request, answering)
        return answering

    def _serve(self, request: object, answering: _Answering) -> None:
        served, core = self._served, self._core

        def fill(outcome: Answer | Exception) -> None:
            if isinstance(outcome, Exception):
                raise outcome
            core.fill(served, outcome, answering.response)

        def done(outcome: Answer | Exception) -> None:
            executor = self._node.executor
            if executor is not None:  # otherwise the node has stopped serving, and ends
                executor.create_task(finish, outcome)

        def finish(outcome: Answer | Exception) -> None:
            if answering not in self._under_way:  # the node has ended, or was cleaned up, and has refused it
                return
            self._under_way.remove(answering)
            self._finish(answering, partial(fill, outcome))
            self._send(answering)

        def serve() -> None:
            if not self.is_active:
                message = "the server is not active, which its lifecycle manager decides"
                raise BusyError(message)
            question = core.question_of(served, request)
            context = at_instant(question, core.context)
            if self._workers is None or served.is_answered_at_once(question, context):
                fill(served.answer(question, context))
                return
            self._workers.ask(served.answer.function, question, _EXCERPT(question, context), done)
            self._under_way.add(answering)
            answering.is_done = False

        self._finish(answering, serve)

    def _finish(self, answering: _Answering, fill: Callable[[], object]) -> None:
        """Fill the response, or report why it cannot be; a fault in one answer must not end the service."""
        answering.is_done = True
        try:
            fill()
        except ContactDynamicsError as error:
            answering.response = self._served.service_type.Response()
            report_error(answering.response, error)
        except Exception as error:  # noqa: BLE001
            self._node.get_logger().error(f"{self._served.name} failed:\n{traceback.format_exc()}")
            answering.response = self._served.service_type.Response()
            report_error(answering.response, error)
        if answering.is_done:
            answering.response.computation_time = time.perf_counter() - answering.begun

    def _send_or_wait(self, answering: _Answering, header: Any) -> None:
        answering.header = header
        if answering.is_done:
            self._send(answering)
        else:
            self.take_events()

    def _send(self, answering: _Answering) -> None:
        """Send a response, unless its client left, and do only then what nobody has to wait for."""
        if not self._is_open():
            return
        if not self._is_gone(answering):
            self._deliver(answering)
        self.take_events()
        self._answered(answering.response)

    def _is_gone(self, answering: _Answering) -> bool:
        if self.gone.are_none:
            return False
        self.take_events()  # one of them tells whose request it is
        return self.gone.has(answering.call.client, asked_ns=answering.header.received_timestamp)

    def _deliver(self, answering: _Answering) -> None:
        call = answering.call
        self._times.end(call)
        if self._core.parameters.log_before_answer:
            self._log_answer(answering)
            self._log.settle()
        # rclpy warns if DDS waited in vain for the client. How long it took tells nothing on a busy machine.
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always")
            self._send_response(answering.response, answering.header)
        if not warned:
            return
        self.take_events()
        if call.client:
            self.gone.note(call.client)
            self._node.get_logger().warning(
                f"{self._served.name}: an answer did not reach its client, which left or is not found yet",
                throttle_duration_sec=_TELL_EVERY_S,
            )

    def _log_answer(self, answering: _Answering) -> None:
        """Log an answer before it leaves. The event that tells of it later is not logged again."""
        call = answering.call
        self.take_events()
        deadline = time.monotonic() + _EVENT_PATIENCE_S
        while not call.client and time.monotonic() < deadline:  # it tells whose request this is
            time.sleep(_EVENT_POLL_S)
            self.take_events()
        if not call.client:
            return
        stamp_ns = self._node.get_clock().now().nanoseconds
        data = self._event_bytes.of_response(
            answering.response,
            client_gid=call.client,
            sequence_number=call.sequence_number,
            stamp_ns=stamp_ns,
        )
        self._log.record(self.topic, data, log_time_ns=call.sent_ns)
        call.is_logged = True

    def _is_open(self) -> bool:
        """Return whether the node still has the service. Requests that came before may still be taken."""
        try:
            with self._service.handle:
                return True
        except InvalidHandle:
            return False

    def _record_event(self, event: Taken) -> None:
        happened = self._times.of_event(event.data, received_ns=event.received_ns)
        if not happened.is_logged:
            at_ns, node_clock_ns = happened.log_time_ns, happened.publish_time_ns
            self._log.record(self.topic, event.data, log_time_ns=at_ns, publish_time_ns=node_clock_ns)


class EventBytes:
    """Makes the events of one service's responses, for a log that has them before they leave.

    ROS publishes such an event only after its response has left.
    """

    def __init__(self, type_name: str) -> None:
        """Take the type of the events, "package/srv/Name_Event"."""
        self._definition = find_definition(type_name)
        self._class = message_class(type_name)

    def of_response(
        self, response: Response, *, client_gid: bytes, sequence_number: int, stamp_ns: int
    ) -> bytes:
        """Return the event that tells of a response.

        Args:
            response: the response.
            client_gid: the 16 bytes that identify the client.
            sequence_number: the number of the request among those of that client.
            stamp_ns: when it leaves, ns by the node's clock.
        """
        event = self._class(response=[response])
        event.info.event_type = int(EventType.RESPONSE_SENT)
        event.info.client_gid = list(client_gid)
        event.info.sequence_number = sequence_number
        stamp_to_msg(stamp_ns, into=event.info.stamp)
        data = serialize_message(event)
        return cut_to_its_end(data, type_name=self._definition.type_name, definition=self._definition.text)
