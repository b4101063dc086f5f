# SPDX-License-Identifier: Apache-2.0
"""Messages decoded from the definitions in a log, beside what ROS's own classes make of the same bytes."""

from __future__ import annotations

import struct
from dataclasses import replace
from typing import Any

import pytest
from geometry_msgs.msg import PoseStamped
from hypothesis import given, settings
from hypothesis import strategies as st
from nav_msgs.msg import Odometry
from rclpy.serialization import serialize_message

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.recording import LoggedMessage, decode_without_ros
from contact_dynamics.recording.cdr import decode_columns
from contact_dynamics.recording.definitions import find_definition
from contact_dynamics.recording.message_types import Message, message_types
from contact_dynamics.replay.verify import differences
from contact_dynamics_interfaces.srv import PredictContactMode, PredictImpact, PredictTumbling
from message_values.contact_modes import contact_mode_answers
from message_values.impact import impact_answers
from message_values.tumbling import tumbling_answers
from msg_adapters.contact_mode import contact_mode_answer_to_msg
from msg_adapters.impact import impact_answer_to_msg
from msg_adapters.tumbling import tumbling_answer_to_msg

SRV = "contact_dynamics_interfaces/srv/"
SERVICES = (PredictContactMode, PredictImpact, PredictTumbling)
RESPONSES = st.one_of(
    contact_mode_answers().map(lambda answer: contact_mode_answer_to_msg(answer, world_frame="world")),
    impact_answers().map(lambda answer: impact_answer_to_msg(answer, world_frame="world")),
    tumbling_answers().map(lambda answer: tumbling_answer_to_msg(answer, world_frame="world")),
)


def logged(data: bytes, type_name: str) -> LoggedMessage:
    """A message as a reader gives it."""
    return LoggedMessage(
        topic="/topic",
        type_name=type_name,
        data=data,
        log_time_ns=0,
        publish_time_ns=0,
        definition=find_definition(type_name).text,
    )


def pose() -> PoseStamped:
    """A pose with a number of its own in each field."""
    msg = PoseStamped()
    msg.header.frame_id = "wörld"
    msg.header.stamp.sec, msg.header.stamp.nanosec = -3, 7
    for number, (part, name) in enumerate(
        [("position", name) for name in "xyz"] + [("orientation", name) for name in "xyzw"]
    ):
        setattr(getattr(msg.pose, part), name, 0.1 + number)
    return msg


@settings(deadline=None, max_examples=60)
@given(RESPONSES)
def test_responses_have_the_fields_that_ros_gives_them(response: Any) -> None:
    service = next(service for service in SERVICES if isinstance(response, service.Response))
    event = service.Event(response=[response])
    event.info.sequence_number = -5
    decoded: Any = decode_without_ros(
        logged(bytes(serialize_message(event)), f"{SRV}{service.__name__}_Event")
    )
    assert decoded.info.sequence_number == -5
    assert decoded.request == []
    assert list(differences(decoded.response[0], response)) == []
    assert {type(decoded.response[0]).__name__} == {f"{service.__name__}_Response"}


@pytest.mark.parametrize("service", SERVICES)
@pytest.mark.parametrize("part", ["Request", "Response"])
def test_defaults_and_constants_are_those_of_ros(service: Any, part: str) -> None:
    name = f"{SRV}{service.__name__}_Event"
    types = message_types(name, find_definition(name).text)
    made = types[f"contact_dynamics_interfaces/{service.__name__}_{part}"]
    assert list(differences(made(), getattr(service, part)())) == []
    constants = {key: value for key, value in vars(made).items() if key.isupper()}
    constants = {key: value for key, value in constants.items() if key not in vars(Message)}
    assert constants
    assert {key: getattr(getattr(service, part), key) for key in constants} == constants


def test_fixed_arrays_and_text_beyond_ascii() -> None:
    msg = Odometry(child_frame_id="brick")
    msg.header.frame_id = "wörld"
    msg.pose.covariance = [0.5 * number for number in range(36)]
    decoded: Any = decode_without_ros(logged(bytes(serialize_message(msg)), "nav_msgs/msg/Odometry"))
    assert list(differences(decoded, msg)) == []
    assert decoded.header.frame_id == "wörld"
    assert decoded.pose.covariance.shape == (36,)


def test_big_endian_bytes() -> None:
    msg = pose()
    name = msg.header.frame_id.encode() + b"\0"
    numbers = [0.1 + number for number in range(7)]
    head = b"\0\0\0\0" + struct.pack(">iII", -3, 7, len(name)) + name
    data = head + bytes((4 - len(head)) % 8) + struct.pack(">7d", *numbers)
    assert list(differences(decode_without_ros(logged(data, "geometry_msgs/msg/PoseStamped")), msg)) == []


def test_bytes_that_end_early_are_refused_wherever_they_end() -> None:
    whole = bytes(serialize_message(pose()))
    for length in range(len(whole)):
        with pytest.raises(InvalidFieldError):
            decode_without_ros(logged(whole[:length], "geometry_msgs/msg/PoseStamped"))


@pytest.mark.parametrize("count", [100, 2**31, 2**32 - 1])
def test_absurd_counts_are_refused(count: int) -> None:
    event = PredictImpact.Event(response=[PredictImpact.Response()])
    data = bytearray(serialize_message(event))
    at = 4 + 40  # behind the event's info: the count of requests
    assert data[at : at + 4] == bytes(4)
    data[at : at + 4] = struct.pack("<I", count)
    with pytest.raises(InvalidFieldError):
        decode_without_ros(logged(bytes(data), "contact_dynamics_interfaces/srv/PredictImpact_Event"))


def test_a_type_that_the_log_does_not_describe_is_named() -> None:
    with pytest.raises(InvalidFieldError, match="a/Missing"):
        message_types("a/msg/Whole", "Missing part\n")
    with pytest.raises(InvalidFieldError, match="line 2"):
        message_types("a/msg/Whole", "int32 x\n?!\n")
    with pytest.raises(InvalidFieldError, match="no text of a/msg/Whole"):
        decode_without_ros(
            LoggedMessage(topic="/t", type_name="a/msg/Whole", data=b"", log_time_ns=0, publish_time_ns=0)
        )


def test_messages_that_differ_in_numbers_alone_are_decoded_as_one() -> None:
    """Those of another frame, another length or another byte order, and cut ones, are left to others."""
    messages = []
    for i, frame in enumerate(["world", "world", "earth", "world", "the world"]):
        msg = Odometry(child_frame_id="body")
        msg.header.frame_id, msg.header.stamp.sec = frame, i - 1
        msg.pose.pose.position.y, msg.twist.covariance[7] = 0.1 * i, 0.3 * i
        messages.append(logged(bytes(serialize_message(msg)), "nav_msgs/msg/Odometry"))
    messages.append(replace(messages[1], data=b"\0\0" + messages[1].data[2:]))
    messages.append(replace(messages[1], data=messages[1].data[:-30]))
    as_one, places = decode_columns(messages)
    one: Any = as_one
    assert places.tolist() == [0, 1, 3]
    assert (one.header.frame_id, one.child_frame_id) == ("world", "body")
    assert one.header.stamp.sec.tolist() == [-1, 0, 2]
    assert one.pose.pose.position.y.tolist() == [0.0, 0.1, 0.1 * 3]
    assert one.twist.covariance.shape == (3, 36)
    assert one.twist.covariance[:, 7].tolist() == [0.0, 0.3, 0.3 * 3]


def test_messages_with_sequences_are_not_decoded_as_one() -> None:
    event = logged(bytes(serialize_message(PredictImpact.Event())), f"{SRV}PredictImpact_Event")
    assert len(decode_columns([event, event])[1]) == 0
