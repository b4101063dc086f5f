# SPDX-License-Identifier: Apache-2.0
"""A log of messages of ROS, and messages made by hand for tests without ROS."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

import pytest

from contact_dynamics.recording import BagWriter

if TYPE_CHECKING:
    from collections.abc import Callable

STATES, CALLS, PER_CHUNK = 150, 12, 40


@pytest.fixture(scope="session")
def pose_cdr() -> Callable[[int, float], bytes]:
    """Return a function that serialises a PoseStamped by hand, from its stamp in ns and its x."""

    def serialise(stamp_ns: int, x: float) -> bytes:
        head = struct.pack("<4B iI I8s", 0, 1, 0, 0, *divmod(stamp_ns, 10**9), 6, b"world")
        return head + struct.pack("<4x7d", x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)

    return serialise


@pytest.fixture(scope="session")
def real_log(tmp_path_factory: pytest.TempPathFactory) -> BagWriter:
    """Return the finished log of states and of a service's events, in several chunks."""
    serialization = pytest.importorskip("rclpy.serialization")
    from geometry_msgs.msg import PoseStamped
    from nav_msgs.msg import Odometry
    from nav_msgs.srv import GetPlan
    from service_msgs.msg import ServiceEventInfo

    messages = []
    for number in range(STATES):
        state = Odometry(child_frame_id="brick")
        state.header.frame_id, state.header.stamp.sec = "world", number
        state.pose.pose.position.x = 0.5 * number
        messages.append(("/odometry", state))
    for number in range(CALLS):
        for kind in (ServiceEventInfo.REQUEST_RECEIVED, ServiceEventInfo.RESPONSE_SENT):
            event = GetPlan.Event(info=ServiceEventInfo(event_type=kind, sequence_number=number))
            if kind == ServiceEventInfo.RESPONSE_SENT:
                event.response = [GetPlan.Response()]
                event.response[0].plan.poses = [PoseStamped() for _ in range(number)]
            messages.append(("/plan/_service_event", event))
    folder = tmp_path_factory.mktemp("logs") / "session"
    with BagWriter(folder, run={"purpose": "test", "mass_kg": "0.37"}) as writer:
        writer.add_topic("/odometry", "nav_msgs/msg/Odometry")
        writer.add_topic("/plan/_service_event", "nav_msgs/srv/GetPlan_Event")
        for number, (topic, message) in enumerate(messages):
            writer.write(topic, bytes(serialization.serialize_message(message)), log_time_ns=1000 * number)
            if number % PER_CHUNK == PER_CHUNK - 1:
                writer.flush()
    return writer
