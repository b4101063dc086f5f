# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import struct

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.recording.cdr import EventType, event_info, event_type_of, leading_stamp_ns

SECONDS = st.integers(-(2**31), 2**31 - 1)
NANOSECONDS = st.integers(0, 10**9 - 1)


@given(seconds=SECONDS, nanoseconds=NANOSECONDS, little=st.booleans())
def test_leading_stamp_in_both_byte_orders(seconds: int, nanoseconds: int, *, little: bool) -> None:
    order = "<" if little else ">"
    data = bytes([0, little, 0, 0]) + struct.pack(f"{order}iI", seconds, nanoseconds) + b"rest"
    assert leading_stamp_ns(data) == seconds * 10**9 + nanoseconds


@settings(deadline=None)  # the first example imports rclpy
@given(
    kind=st.integers(0, 3),
    seconds=SECONDS,
    nanoseconds=NANOSECONDS,
    gid=st.binary(min_size=16, max_size=16),
    number=st.integers(-(2**63), 2**63 - 1),
)
def test_event_head_as_rclpy_serialises_it(
    kind: int, seconds: int, nanoseconds: int, gid: bytes, number: int
) -> None:
    serialization = pytest.importorskip("rclpy.serialization")
    srv = pytest.importorskip("nav_msgs.srv")
    event = srv.GetPlan.Event()
    event.info.event_type = kind
    event.info.stamp.sec = seconds
    event.info.stamp.nanosec = nanoseconds
    event.info.client_gid = list(gid)
    event.info.sequence_number = number
    data = bytes(serialization.serialize_message(event))
    assert event_type_of(data) == kind
    info = event_info(data)
    assert info.event_type is EventType(kind)
    assert info.stamp_ns == seconds * 10**9 + nanoseconds
    assert info.client_gid == gid
    assert info.sequence_number == number


@pytest.mark.parametrize(
    "module_and_type", [("nav_msgs.msg", "Odometry"), ("geometry_msgs.msg", "TwistStamped")]
)
def test_stamp_as_rclpy_serialises_it(module_and_type: tuple[str, str]) -> None:
    serialization = pytest.importorskip("rclpy.serialization")
    message = getattr(pytest.importorskip(module_and_type[0]), module_and_type[1])()
    message.header.stamp.sec = 1_700_000_000
    message.header.stamp.nanosec = 123_456_789
    message.header.frame_id = "world"
    assert leading_stamp_ns(bytes(serialization.serialize_message(message))) == 1_700_000_000_123_456_789


@pytest.mark.parametrize("data", [b"", b"\0", b"\0\1\0\0", b"\0\1\0\0" + bytes(7)])
def test_too_short_is_refused_by_name(data: bytes) -> None:
    with pytest.raises(InvalidFieldError, match="data"):
        leading_stamp_ns(data)
    with pytest.raises(InvalidFieldError, match="data"):
        event_info(data)


def test_bytes_that_are_no_event_have_no_kind() -> None:
    assert event_type_of(b"") is None
    assert event_type_of(b"\0\1\0\0") is None


def test_unknown_event_type_is_refused() -> None:
    with pytest.raises(InvalidFieldError, match="event_type"):
        event_info(b"\0\1\0\0\4" + bytes(60))
