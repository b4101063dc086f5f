# SPDX-License-Identifier: Apache-2.0
"""The times of calls where events get lost or are not the server's, and clients that seemed gone."""

from __future__ import annotations

import struct
import time

import pytest

from contact_dynamics.nodes.service_front import CallTimes, GoneClients
from contact_dynamics.recording.cdr import EventType
from contact_dynamics_interfaces.srv import PredictTumbling

GID_A, GID_B = b"a" * 16, b"b" * 16
SECOND = 1_000_000_000
LATER_NS = 5 * SECOND  # when events come


def event(kind: EventType, seconds: int, gid: bytes, number: int) -> bytes:
    return bytes([0, 1, 0, 0]) + struct.pack("<B3xiI16s4xq", kind, seconds, 0, gid, number)


class Calls:
    """Calls that come one a second by the node's clock, and when they came by this machine's."""

    def __init__(self) -> None:
        self._seconds = 0
        self.times = CallTimes(lambda: self._seconds * SECOND)
        self.began: list[tuple[int, int]] = []  # just before and just after
        self.ended: list[tuple[int, int]] = []

    def answer(self) -> None:
        """Take a call and answer it."""
        self._seconds += 1
        before_ns = time.time_ns()
        call = self.times.begin(PredictTumbling.Response())
        self.began.append((before_ns, time.time_ns()))
        before_ns = time.time_ns()
        self.times.end(call)
        self.ended.append((before_ns, time.time_ns()))

    def log_time_ns(self, event: bytes) -> int:
        """The time that the log has of an event."""
        return self.times.of_event(event, received_ns=LATER_NS).log_time_ns


def test_each_event_has_the_time_of_its_call_whoever_asks() -> None:
    calls = Calls()
    asked = [(GID_A, 1), (GID_B, 1), (GID_A, 2)]
    for _ in asked:
        calls.answer()
    for number, (gid, sequence) in enumerate(asked):
        came = calls.log_time_ns(event(EventType.REQUEST_RECEIVED, number + 1, gid, sequence))
        assert calls.began[number][0] <= came <= calls.began[number][1]
    for number, (gid, sequence) in reversed(list(enumerate(asked))):
        left = calls.log_time_ns(event(EventType.RESPONSE_SENT, number + 1, gid, sequence))
        assert calls.ended[number][0] <= left <= calls.ended[number][1]


def test_events_that_got_lost_shift_no_other() -> None:
    calls = Calls()
    for _ in range(4):
        calls.answer()
    came = calls.log_time_ns(event(EventType.REQUEST_RECEIVED, 3, GID_A, 3))
    assert calls.began[2][0] <= came <= calls.began[2][1]
    came = calls.log_time_ns(event(EventType.REQUEST_RECEIVED, 4, GID_A, 4))
    assert calls.began[3][0] <= came <= calls.began[3][1]


@pytest.mark.parametrize(
    "other",
    [
        event(EventType.REQUEST_SENT, 1, GID_A, 1),
        event(EventType.RESPONSE_RECEIVED, 1, GID_A, 1),
        event(EventType.RESPONSE_SENT, 1, GID_B, 7),
        b"\0\1\0\0\xff" + bytes(60),
        b"",
    ],
    ids=["of a client", "of a client's answer", "of a call before", "of no kind", "no event"],
)
def test_other_events_are_of_when_they_came_and_take_no_calls_time(other: bytes) -> None:
    calls = Calls()
    calls.answer()
    assert calls.log_time_ns(other) == LATER_NS
    came = calls.log_time_ns(event(EventType.REQUEST_RECEIVED, 1, GID_A, 1))
    assert calls.began[0][0] <= came <= calls.began[0][1]


HOUR_NS = 3_600_000_000_000
CLIENT = b"one"


def test_what_was_asked_before_gets_no_answer_and_what_is_asked_later_does() -> None:
    gone = GoneClients(60.0)
    asked_ns = time.time_ns()
    gone.note(CLIENT)
    assert gone.has(CLIENT, asked_ns=asked_ns)
    assert not gone.has(CLIENT, asked_ns=asked_ns + HOUR_NS)
    assert not gone.has(b"another", asked_ns=asked_ns)


def test_a_clock_that_is_set_back_by_an_hour_silences_nobody_for_an_hour(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    gone = GoneClients(0.01)
    with monkeypatch.context() as patch:
        ahead_ns = time.time_ns() + HOUR_NS
        patch.setattr(time, "time_ns", lambda: ahead_ns)
        gone.note(CLIENT)
    time.sleep(0.02)
    assert not gone.has(CLIENT, asked_ns=time.time_ns())
