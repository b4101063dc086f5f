# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import struct

import pytest

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.recording import LoggedMessage, service_calls
from contact_dynamics.recording.cdr import EventType
from contact_dynamics.recording.message_types import message_class

GID_A, GID_B = b"a" * 16, b"b" * 16


def event(kind: EventType, gid: bytes, number: int, *, service: str = "/ask") -> LoggedMessage:
    data = bytes([0, 1, 0, 0]) + struct.pack("<B3xiI16s4xq", kind, 1, 2, gid, number) + bytes(8)
    return LoggedMessage(
        topic=f"{service}/_service_event",
        type_name="nav_msgs/srv/GetPlan_Event",
        data=data,
        log_time_ns=0,
        publish_time_ns=0,
    )


def test_pairs_by_service_client_and_number() -> None:
    request, response = EventType.REQUEST_RECEIVED, EventType.RESPONSE_SENT
    events = [
        event(request, GID_A, 1),
        event(request, GID_B, 1),
        event(request, GID_A, 1, service="/other"),
        event(request, GID_A, 2),
        event(response, GID_B, 1),
        event(response, GID_A, 1),
        event(response, GID_A, 1, service="/other"),
    ]
    calls = list(service_calls(events))
    assert [(call.service, call.client_gid, call.sequence_number) for call in calls] == [
        ("/ask", GID_A, 1),
        ("/ask", GID_B, 1),
        ("/other", GID_A, 1),
        ("/ask", GID_A, 2),
    ]
    assert [(call.request_event, call.response_event) for call in calls] == [
        (events[0], events[5]),
        (events[1], events[4]),
        (events[2], events[6]),
        (events[3], None),
    ]
    assert {call.service_type for call in calls} == {"nav_msgs/srv/GetPlan"}


def test_a_call_comes_at_the_place_of_its_request_although_later_ones_were_answered_first() -> None:
    request, response = EventType.REQUEST_RECEIVED, EventType.RESPONSE_SENT
    events = [event(request, GID_A, number) for number in (1, 2, 3)]
    events += [event(response, GID_A, number) for number in (3, 2, 1)]
    assert [call.sequence_number for call in service_calls(events)] == [1, 2, 3]


def test_a_lost_response_does_not_hold_up_the_rest_of_a_log() -> None:
    request, response = EventType.REQUEST_RECEIVED, EventType.RESPONSE_SENT
    events = [event(request, GID_A, 0)]  # it is never answered
    events += [event(kind, GID_A, number) for number in range(1, 20) for kind in (request, response)]
    calls = list(service_calls(events, max_held=5))
    assert [call.sequence_number for call in calls] == list(range(20))
    assert [call.response_event is None for call in calls] == [True] + 19 * [False]
    first = next(service_calls(iter(events[: 2 * 6 + 1]), max_held=5))
    assert first.sequence_number == 0  # five are held, and with the sixth it goes


def test_the_clients_own_events_and_other_topics_make_no_calls_of_their_own() -> None:
    state = LoggedMessage(topic="/pose", type_name="", data=b"", log_time_ns=0, publish_time_ns=0)
    events = [
        event(EventType.REQUEST_SENT, GID_A, 1),
        state,
        event(EventType.REQUEST_RECEIVED, GID_A, 1),
        event(EventType.RESPONSE_SENT, GID_A, 1),
        event(EventType.RESPONSE_RECEIVED, GID_A, 1),
    ]
    (call,) = service_calls(events)
    assert (call.request_event, call.response_event) == (events[2], events[3])


def test_log_that_begins_or_ends_within_a_call() -> None:
    (call,) = service_calls([event(EventType.RESPONSE_SENT, GID_A, 4)])
    assert call.request_event is None
    assert call.request() is None
    (call,) = service_calls([event(EventType.REQUEST_RECEIVED, GID_A, 4)])
    assert call.response_event is None
    assert call.response() is None


def test_class_of_a_type_that_is_not_installed_is_refused_by_name() -> None:
    for type_name in ("not_there/msg/Thing", "std_msgs/msg/NotThere", "std_msgs", "nav_msgs/srv/No_Event"):
        with pytest.raises(InvalidFieldError, match="type_name"):
            message_class(type_name)
