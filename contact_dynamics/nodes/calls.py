# SPDX-License-Identifier: Apache-2.0
"""The calls of a service: their times, and the clients that seem to have left.

This process receives the events of a service after the response is sent. Their own stamps are from the
node's clock, which does not advance between two ticks of a simulation. The log therefore has the times that
are noted here, on the clock of this machine.
"""

from __future__ import annotations

import time
from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.recording.cdr import EventType, event_info

if TYPE_CHECKING:
    from collections.abc import Callable

    from msg_adapters.status import Response

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
