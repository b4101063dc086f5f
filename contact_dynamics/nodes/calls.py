# SPDX-License-Identifier: Apache-2.0
"""The calls of a service: when each came and was answered, and which clients seem gone.

A service publishes its events while it works, and this process receives them after the answer has left. Their
own stamps are from the node's clock, which stands still between two ticks of a simulation. So the log takes
the times that are noted here, from this machine's clock.
"""

from __future__ import annotations

import time
from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.recording.cdr import EventType, event_info

if TYPE_CHECKING:
    from collections.abc import Callable

_MAX_OPEN: Final = 10_000  # calls whose events may still come, since a lost event leaves its call open


class EventTimes(NamedTuple):
    """The time of what an event reports, ns since the epoch.

    Attributes:
        log_time_ns: The time on this machine's clock.
        publish_time_ns: The time on the node's clock. That of a request is the present time of the question.
            None takes the event's own.
        is_logged: Whether the log has it already.
    """

    log_time_ns: int
    publish_time_ns: int | None = None
    is_logged: bool = False


@dataclass(slots=True, kw_only=True)
class Call:
    """A call of a service.

    Attributes:
        node_clock_ns: When it came, on the clock that stamps the events, ns.
        received_ns: When it came, on this machine's clock, ns since the epoch.
        sent_ns: When its answer left, on the same clock.
        client: The identity of who called, or nothing while no event told of the request.
        sequence_number: The number of the request among those of that client, told by the same event.
        is_logged: Whether the log has the answer already, before an event tells of it.
    """

    node_clock_ns: int
    received_ns: int
    sent_ns: int = 0
    client: bytes = b""
    sequence_number: int = 0
    is_logged: bool = False


class CallTimes:
    """The times of the calls of one service. All of its callbacks run in one thread."""

    def __init__(self, node_clock_ns: Callable[[], int]) -> None:
        """Take the clock that stamps the events, whose times are noted beside this machine's."""
        self._node_clock_ns = node_clock_ns
        self._unclaimed: deque[Call] = deque(maxlen=_MAX_OPEN)  # no event told of the request yet
        self._answered: dict[tuple[bytes, int], Call] = {}  # no event told of the answer yet

    def begin(self) -> Call:
        """Note that a request has come."""
        call = Call(node_clock_ns=self._node_clock_ns(), received_ns=time.time_ns())
        self._unclaimed.append(call)
        return call

    @staticmethod
    def end(call: Call) -> None:
        """Note that the answer to a call leaves."""
        call.sent_ns = time.time_ns()

    def of_event(self, event: bytes, *, received_ns: int) -> EventTimes:
        """Return the time of what an event reports.

        Args:
            event: the event as it came.
            received_ns: when it came, ns since the epoch by this machine's clock. It is the time of an event
                of a client, which happened elsewhere, and of bytes that are no event.
        """
        try:
            info = event_info(event)
        except InvalidFieldError:
            return EventTimes(received_ns)
        key = (info.client_gid, info.sequence_number)
        if info.event_type is EventType.REQUEST_RECEIVED:
            while self._unclaimed:
                call = self._unclaimed.popleft()
                if call.node_clock_ns >= info.stamp_ns:  # otherwise the event of this call got lost
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
    since_ns: int  # since the epoch by this machine's clock, by which requests are stamped
    noted: float  # s, by a clock that only goes forward


class GoneClients:
    """Clients that seemed gone when an answer was sent to them.

    Attributes:
        gone_for: s for which such a client gets no answers to what it asked before.
    """

    def __init__(self, gone_for: float) -> None:
        """Begin with none."""
        self.gone_for = gone_for
        self._gone: dict[bytes, _Gone] = {}

    @property
    def are_none(self) -> bool:
        """Whether no client seemed gone a short time ago."""
        if self._gone:
            self._forget_old(time.monotonic())
        return not self._gone

    def note(self, client: bytes) -> None:
        """Note that a client seems gone, and forget those of whom that was noted long ago."""
        now = time.monotonic()
        self._forget_old(now)
        self._gone[client] = _Gone(time.time_ns(), now)

    def has(self, client: bytes, *, asked_ns: int) -> bool:
        """Tell whether a client asked before it seemed gone, a short time ago. Who asks later is there."""
        gone = self._gone.get(client)
        if gone is None or time.monotonic() >= gone.noted + self.gone_for:
            return False
        return asked_ns <= gone.since_ns

    def _forget_old(self, now: float) -> None:
        self._gone = {each: gone for each, gone in self._gone.items() if now < gone.noted + self.gone_for}
