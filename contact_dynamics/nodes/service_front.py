# SPDX-License-Identifier: Apache-2.0
"""Receives the requests of one service, answers them or has them answered, and sends the responses.

Quick requests are answered at once. Others go to workers, and the server continues until their answers
arrive. No response is sent to a client that has left, since that blocks all others for 0.1 s.

This process receives the events of a service after the response is sent. Their own stamps are from the
node's clock, which does not advance between two ticks of a simulation. The log therefore has times that are
noted here, on the clock of this machine.
"""

from __future__ import annotations

import time
import traceback
import warnings
from collections import deque
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from rclpy.exceptions import InvalidHandle
from rclpy.qos import QoSProfile
from rclpy.serialization import serialize_message
from rclpy.service_introspection import ServiceIntrospectionState

from contact_dynamics.errors import BusyError, ContactDynamicsError, InvalidFieldError
from contact_dynamics.questions.services import ImportedOnUse, at_instant
from contact_dynamics.recording.cdr import EventType, cut_to_its_end, event_info
from contact_dynamics.recording.definitions import find_definition
from contact_dynamics.recording.message_types import message_class
from msg_adapters.stamps import stamp_to_msg
from msg_adapters.status import report_error

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from contact_dynamics.nodes.inbox import InboxNode, Taken
    from contact_dynamics.nodes.log import Log
    from contact_dynamics.nodes.server_core import ServerCore
    from contact_dynamics.questions.context import Context
    from contact_dynamics.questions.services import Answer, Service
    from contact_dynamics.questions.workers import Workers
    from msg_adapters.status import Response

SERVICE_QOS = QoSProfile(depth=1000)
"""Queue of a service. With the usual depth of 10, responses are lost if several clients send at once."""

EVENT_QOS = QoSProfile(depth=10 * SERVICE_QOS.depth)
"""Queue of the service events, none of which the log may lose. All waiting requests are answered, with two
events each, before the first of these events is taken."""

_EVENT_PATIENCE_S: Final = 0.1
"""s. Longest wait for the event of a request if its response is logged before it is sent. Fast DDS delivers
it with the request, and other middleware may be later."""

_EXCERPT: Final[ImportedOnUse[Context]] = ImportedOnUse("contact_dynamics.questions.effort:excerpt")

_WARN_EVERY_S: Final = 5.0  # shortest time between two warnings of one kind

_EVENT_POLL_S: Final = 0.001


_MAX_OPEN: Final = 10_000  # calls whose events may still arrive, since a call whose event is lost stays open


class EventTimes(NamedTuple):
    """The time of what an event reports, ns since the epoch."""

    log_time_ns: int  # the time on the clock of this machine
    # The time on the node's clock. That of a request is the present time of the question. If None, the
    # event's own stamp counts.
    publish_time_ns: int | None = None
    is_logged: bool = False  # whether the log already has the event


@dataclass(slots=True, kw_only=True, eq=False)
class Call:
    """A call of a service."""

    response: Response  # the response, which is valid once the call is done
    header: Any  # the header with which DDS sends the response, once it is known
    node_clock_ns: int  # time of arrival on the clock that stamps the events, ns
    received_ns: int  # time of arrival on the clock of this machine, ns since the epoch
    begun: float  # time of arrival on a clock that measures durations, s
    is_done: bool = False  # whether the response can be sent
    sent_ns: int = 0  # time at which the response was sent, on the clock of this machine
    client: bytes = b""  # the identity of the client, or empty until the event of the request arrives
    sequence_number: int = 0  # the number of the request among those of its client, from the same event
    is_logged: bool = False  # whether the log has the response already, before its event

    def finish(self) -> None:
        """Set that the response can be sent, and the duration of its computation."""
        self.is_done = True
        self.response.computation_time = time.perf_counter() - self.begun


class CallTimes:
    """The times of the calls of one service. All methods are called from one thread."""

    def __init__(self, node_clock_ns: Callable[[], int]) -> None:
        """Set the clock that stamps the events."""
        self._node_clock_ns = node_clock_ns
        self._unclaimed: deque[Call] = deque(maxlen=_MAX_OPEN)  # without the event of the request yet
        self._answered: dict[tuple[bytes, int], Call] = {}  # without the event of the response yet

    def begin(self, response: Response, header: Any = None) -> Call:
        """Return the call of a request that has just arrived."""
        call = Call(
            response=response,
            header=header,
            node_clock_ns=self._node_clock_ns(),
            received_ns=time.time_ns(),
            begun=time.perf_counter(),
        )
        self._unclaimed.append(call)
        return call

    @staticmethod
    def end(call: Call) -> None:
        """Set the time of sending of a response to the present."""
        call.sent_ns = time.time_ns()

    def of_event(self, event: bytes, *, received_ns: int) -> EventTimes:
        """Return the times of a serialized event.

        The time of reception, ``received_ns``, is that of an event of a client, whose own time is unknown,
        and of bytes that are no event.
        """
        try:
            info = event_info(event)
        except InvalidFieldError:
            return EventTimes(received_ns)
        key = (info.client_gid, info.sequence_number)
        if info.event_type is EventType.REQUEST_RECEIVED:
            while self._unclaimed:
                call = self._unclaimed.popleft()
                if call.node_clock_ns >= info.stamp_ns:  # otherwise the event of this call was lost
                    call.client, call.sequence_number = key
                    self._answered[key] = call
                    while len(self._answered) > _MAX_OPEN:
                        del self._answered[next(iter(self._answered))]
                    return EventTimes(call.received_ns, max(0, call.node_clock_ns))  # MCAP has no time before
        elif info.event_type is EventType.RESPONSE_SENT and key in self._answered:
            answered = self._answered.pop(key)
            return EventTimes(answered.sent_ns, max(0, info.stamp_ns), answered.is_logged)
        return EventTimes(received_ns, max(0, info.stamp_ns))


class _Gone(NamedTuple):
    since_ns: int  # since the epoch on the clock of this machine, which stamps requests
    noted: float  # s, on a monotonic clock


class GoneClients:
    """Clients that seemed to have left when a response was sent to them.

    Attributes:
        gone_for: Time for which earlier requests of such a client are dropped, s.
    """

    def __init__(self, gone_for: float) -> None:
        """Begin without any."""
        self.gone_for = gone_for
        self._gone: dict[bytes, _Gone] = {}

    @property
    def are_none(self) -> bool:
        """Whether no client has seemed to have left recently."""
        if self._gone:
            self._forget_old(time.monotonic())
        return not self._gone

    def note(self, client: bytes) -> None:
        """Add a client that seems to have left."""
        now = time.monotonic()
        self._forget_old(now)
        self._gone[client] = _Gone(time.time_ns(), now)

    def has(self, client: bytes, *, asked_ns: int) -> bool:
        """Return whether a client sent a request before it recently seemed to have left.

        A client that sends a later request is still there.
        """
        gone = self._gone.get(client)
        if gone is None or time.monotonic() >= gone.noted + self.gone_for:
            return False
        return asked_ns <= gone.since_ns

    def _forget_old(self, now: float) -> None:
        self._gone = {each: gone for each, gone in self._gone.items() if now < gone.noted + self.gone_for}


class ServiceFront:
    """Serves one of the services.

    Attributes:
        is_active: Whether requests are answered. Otherwise they are rejected.
        gone: The clients that seem to have left. Their later requests are answered.
        topic: The full name of the topic of the service events.
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
        """Create the service.

        Expensive requests are answered by the ``workers``, or in this process without them. The ``log``
        receives the service events. ``answered`` is called with each response after it is sent.
        """
        self._node = node
        self._served = served
        self._core = core
        self._workers = workers
        self._log = log
        self._answered = answered
        self._event_bytes = EventBytes(f"contact_dynamics_interfaces/srv/{served.type_name}_Event")
        self._under_way: set[Call] = set()  # calls whose answers are computed by workers
        self._times = CallTimes(lambda: node.get_clock().now().nanoseconds)
        self.is_active = False
        self.gone = GoneClients(core.parameters.client_gone_for)
        self._service = service = node.create_service(
            served.service_type, f"~/{served.name}", self._take, qos_profile=SERVICE_QOS
        )
        service.configure_introspection(node.get_clock(), EVENT_QOS, ServiceIntrospectionState.CONTENTS)
        self._send_response = service.send_response
        # Executors of rclpy call this with what the callback returns.
        service.send_response = self._send_or_wait
        self.topic = f"{service.service_name}/_service_event"
        self._events = node.subscribe(
            served.service_type.Event, self.topic, self._record_event, EVENT_QOS, in_rounds=False
        )

    def remove(self) -> None:
        """Remove the service from the node."""
        self._node.destroy_service(self._service)

    def refuse_all(self) -> int:
        """Reject the requests that workers process, and those that wait; return their number."""
        error = BusyError("the server ended, or was cleaned up, before the response was computed")
        rejected, self._under_way = [*self._under_way, *self._waiting()], set()
        for call in rejected:
            self._finish(call, error)
            self._send(call)
        return len(rejected)

    def _waiting(self) -> Iterator[Call]:
        """Take the requests that have arrived and were not taken yet."""
        while self._is_open():
            with self._service.handle:
                _, header = self._service.handle.service_take_request(self._served.service_type.Request)
            if header is None:
                return
            yield self._times.begin(self._served.service_type.Response(), header)

    def take_events(self) -> None:
        """Take the waiting events of requests and responses, and log them."""
        self._node.empty(self._events)

    def _take(self, request: object, response: Response) -> Call:
        self._node.take_messages()  # the answer uses all states that arrived before the request
        call = self._times.begin(response)
        self._core.asked_ns = call.node_clock_ns
        self._node.note_question(call.received_ns)
        if self._is_open():
            outcome = self._outcome(request, call)
            if outcome is not None:
                self._finish(call, outcome)
        return call

    def _outcome(self, request: object, call: Call) -> Answer | Exception | None:
        """Return the answer to a request or the exception that it causes, or None if a worker answers it."""
        served, core = self._served, self._core
        try:
            if not self.is_active:
                message = "the server is not active, which its lifecycle manager decides"
                return BusyError(message)
            question = core.question_of(served, request)
            context = at_instant(question, core.context)
            if self._workers is None or served.is_answered_at_once(question, context):
                return served.answer(question, context)
            excerpt = _EXCERPT(question, context)
            self._workers.ask(served.answer.function, question, excerpt, partial(self._done, call))
        except Exception as error:  # noqa: BLE001  a fault in one answer must not end the service
            return error
        self._under_way.add(call)
        return None

    def _done(self, call: Call, outcome: Answer | Exception) -> None:
        """Continue with the answer of a worker, from a thread of its own."""
        executor = self._node.executor
        if executor is not None:  # otherwise the node has stopped serving
            executor.create_task(self._finish_late, call, outcome)

    def _finish_late(self, call: Call, outcome: Answer | Exception) -> None:
        if call in self._under_way:  # otherwise it was rejected when the node ended or was cleaned up
            self._under_way.remove(call)
            self._finish(call, outcome)
            self._send(call)

    def _finish(self, call: Call, outcome: Answer | Exception) -> None:
        """Write the answer or the error into the response."""
        if not isinstance(outcome, Exception):
            try:
                self._core.fill(self._served, outcome, call.response)
            except Exception as error:  # noqa: BLE001  as above
                outcome = error
        if isinstance(outcome, Exception):
            if not isinstance(outcome, ContactDynamicsError):
                trace = "".join(traceback.format_exception(outcome))
                self._node.get_logger().error(f"{self._served.name} failed:\n{trace}")
            call.response = self._served.service_type.Response()
            report_error(call.response, outcome)
        call.finish()

    def _send_or_wait(self, call: Call, header: Any) -> None:
        call.header = header
        if call.is_done:
            self._send(call)
        else:
            self.take_events()

    def _send(self, call: Call) -> None:
        """Send a response, unless its client has left. Other work follows the sending."""
        if not self._is_open():
            return
        if not self._is_gone(call):
            self._deliver(call)
        self.take_events()
        self._answered(call.response)

    def _is_gone(self, call: Call) -> bool:
        if self.gone.are_none:
            return False
        self.take_events()  # the event of the request identifies the client
        return self.gone.has(call.client, asked_ns=call.header.received_timestamp)

    def _deliver(self, call: Call) -> None:
        self._times.end(call)
        if self._core.parameters.log_before_answer:
            self._log_answer(call)
            self._log.settle()
        # rclpy warns if DDS did not reach the client. On a busy machine, the duration does not show it.
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always")
            self._send_response(call.response, call.header)
        if not warned:
            return
        self.take_events()
        if call.client:
            self.gone.note(call.client)
            self._node.get_logger().warning(
                f"{self._served.name}: a response did not reach its client, which left or is undiscovered",
                throttle_duration_sec=_WARN_EVERY_S,
            )

    def _log_answer(self, call: Call) -> None:
        """Log a response before it is sent. The event of it that arrives later is not logged again."""
        self.take_events()
        deadline = time.monotonic() + _EVENT_PATIENCE_S
        while not call.client and time.monotonic() < deadline:  # the event identifies the client
            time.sleep(_EVENT_POLL_S)
            self.take_events()
        if not call.client:
            return
        stamp_ns = self._node.get_clock().now().nanoseconds
        self._log.record(self.topic, self._event_bytes.of_response(call, stamp_ns), log_time_ns=call.sent_ns)
        call.is_logged = True

    def _is_open(self) -> bool:
        """Return whether the node still has the service. Earlier requests may still be taken without it."""
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
    """Serializes the events of one service's responses, for a log that has them before they are sent.

    ROS publishes such an event only after the response is sent.
    """

    def __init__(self, type_name: str) -> None:
        """Set the type of the events, "package/srv/Name_Event"."""
        self._definition = find_definition(type_name)
        self._class = message_class(type_name)

    def of_response(self, call: Call, stamp_ns: int) -> bytes:
        """Return the event of a call's response, which is sent at ``stamp_ns`` by the node's clock."""
        event = self._class(response=[call.response])
        event.info.event_type = int(EventType.RESPONSE_SENT)
        event.info.client_gid = list(call.client)
        event.info.sequence_number = call.sequence_number
        stamp_to_msg(stamp_ns, into=event.info.stamp)
        return cut_to_its_end(serialize_message(event), self._definition)
