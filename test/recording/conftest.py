# SPDX-License-Identifier: Apache-2.0
"""A log made the real way, once a session, and messages made by hand for tests without ROS.

The real way: states and calls from another process over DDS, raw subscriptions into a `Recorder`.
"""

from __future__ import annotations

import json
import os
import struct
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from contact_dynamics.demo.processes import claim_domain
from contact_dynamics.recording import BagWriter, Recorder, RecorderStatus

if TYPE_CHECKING:
    from collections.abc import Callable

STATES = 150
CALLS = 12
TOPICS = {
    "/probe/odometry": "nav_msgs/msg/Odometry",
    "/probe/pose": "geometry_msgs/msg/PoseStamped",
    "/probe/plan/_service_event": "nav_msgs/srv/GetPlan_Event",
    "/probe/change/_service_event": "lifecycle_msgs/srv/ChangeState_Event",
}
EXPECTED_COUNTS = {
    "/probe/odometry": STATES,
    "/probe/pose": STATES,
    "/probe/plan/_service_event": 2 * CALLS,
    "/probe/change/_service_event": 2 * CALLS,
}


@dataclass(frozen=True, kw_only=True)
class RealLog:
    """A finished log and what was seen while it was made."""

    folder: Path
    path: Path
    received: list[tuple[str, bytes, int]]  # topic, data, log time in ns, in the order of reception
    counts: dict[str, int]  # messages sent, by topic
    types: dict[str, str]  # type, by topic
    stamps_ns: list[int]  # of the states, in the order of publishing
    answers: list[int]  # number of poses in each plan that the client got
    status: RecorderStatus
    began_ns: int
    ended_ns: int


@pytest.fixture(scope="session")
def pose_cdr() -> Callable[[int, float], bytes]:
    """Return a function that serialises a PoseStamped by hand, from its stamp in ns and its x."""

    def serialise(stamp_ns: int, x: float) -> bytes:
        head = struct.pack("<4B iI I8s", 0, 1, 0, 0, *divmod(stamp_ns, 10**9), 6, b"world")
        return head + struct.pack("<4x7d", x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)

    return serialise


@pytest.fixture(scope="session")
def real_log(tmp_path_factory: pytest.TempPathFactory) -> RealLog:
    """Return the log of a session between two processes."""
    pytest.importorskip("rclpy")
    folder = tmp_path_factory.mktemp("logs") / "session"
    domain = claim_domain()
    range_before = os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE")
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    try:
        return _record(folder, domain)
    finally:
        if range_before is None:
            del os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"]
        else:
            os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = range_before


def _record(folder: Path, domain: int) -> RealLog:
    import rclpy
    from rclpy.executors import SingleThreadedExecutor
    from rclpy.node import Node
    from rclpy.qos import QoSProfile

    from contact_dynamics.recording.decoding import message_class

    began_ns = time.time_ns()
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=domain)
    node = Node("probe_server", context=context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    qos = QoSProfile(depth=1000)
    received: list[tuple[str, bytes, int]] = []
    writer = BagWriter(folder, run={"purpose": "test", "mass_kg": "0.37"})
    for topic, type_name in TOPICS.items():
        writer.add_topic(topic, type_name, qos)
    recorder = Recorder(writer)

    def keep(topic: str, data: bytes) -> None:
        now_ns = time.time_ns()
        received.append((topic, data, now_ns))
        recorder.record(topic, data, log_time_ns=now_ns)

    _serve(node, qos)
    for topic, type_name in TOPICS.items():
        node.create_subscription(
            message_class(type_name), topic, lambda data, topic=topic: keep(topic, data), qos, raw=True
        )
    client = subprocess.Popen(
        [sys.executable, str(Path(__file__).with_name("probe_client.py")), str(STATES), str(CALLS)],
        env={**os.environ, "ROS_DOMAIN_ID": str(domain)},
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        deadline = time.monotonic() + 60.0
        while len(received) < sum(EXPECTED_COUNTS.values()) and time.monotonic() < deadline:
            executor.spin_once(timeout_sec=0.1)
            if client.poll() not in (None, 0):
                break
        output, _ = client.communicate(timeout=300)
    finally:
        client.kill()
        client.wait()
        status = recorder.close()
        executor.shutdown()
        node.destroy_node()
        rclpy.shutdown(context=context)
    assert client.returncode == 0
    told = json.loads(output)
    return RealLog(
        folder=folder,
        path=writer.path,
        received=received,
        counts=EXPECTED_COUNTS,
        types=TOPICS,
        stamps_ns=told["stamps_ns"],
        answers=told["answers"],
        status=status,
        began_ns=began_ns,
        ended_ns=time.time_ns(),
    )


def _serve(node: Any, qos: Any) -> None:
    """Answer the n-th plan with n poses, and each change of state with success."""
    from geometry_msgs.msg import PoseStamped
    from lifecycle_msgs.srv import ChangeState
    from nav_msgs.srv import GetPlan
    from rclpy.service_introspection import ServiceIntrospectionState

    def plan(request: Any, response: Any) -> Any:
        response.plan.poses = [PoseStamped() for _ in range(int(request.tolerance))]
        return response

    def change(_: Any, response: Any) -> Any:
        response.success = True
        return response

    for service in (
        node.create_service(GetPlan, "/probe/plan", plan, qos_profile=qos),
        node.create_service(ChangeState, "/probe/change", change, qos_profile=qos),
    ):
        service.configure_introspection(node.get_clock(), qos, ServiceIntrospectionState.CONTENTS)
