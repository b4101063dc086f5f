# SPDX-License-Identifier: Apache-2.0
"""A process that publishes states and calls two services as a robot's would, then says what it did, as JSON.

Run by `conftest.py`, which compares the log with it.
"""

from __future__ import annotations

import json
import sys
import time
from typing import Any

import rclpy
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped
from lifecycle_msgs.srv import ChangeState
from nav_msgs.msg import Odometry
from nav_msgs.srv import GetPlan
from rclpy.node import Node
from rclpy.qos import QoSProfile

FIRST_STAMP_NS = 1_700_000_000_123_456_789
STAMP_STEP_NS = 4_166_667


def stamp_of(index: int) -> Time:
    seconds, nanoseconds = divmod(FIRST_STAMP_NS + index * STAMP_STEP_NS, 10**9)
    return Time(sec=seconds, nanosec=nanoseconds)


def publish_states(node: Node, publishers: dict[str, Any], count: int) -> None:
    deadline = time.monotonic() + 20.0
    while any(publisher.get_subscription_count() == 0 for publisher in publishers.values()):
        if time.monotonic() > deadline:
            raise TimeoutError("nobody listens to the states")
        rclpy.spin_once(node, timeout_sec=0.02)
    for index in range(count):
        odometry = Odometry(child_frame_id="body")
        odometry.header.stamp = stamp_of(index)
        odometry.header.frame_id = "world"
        odometry.pose.pose.position.x = 0.5 * index
        publishers["odometry"].publish(odometry)
        pose = PoseStamped()
        pose.header.stamp = stamp_of(index)
        pose.header.frame_id = "world"
        pose.pose.position.z = 0.25 * index
        publishers["pose"].publish(pose)
        time.sleep(0.001)


def call(node: Node, client: Any, request: Any) -> Any:
    future = client.call_async(request)
    deadline = time.monotonic() + 20.0
    while not future.done():
        if time.monotonic() > deadline:
            raise TimeoutError(f"no answer from {client.srv_name}")
        rclpy.spin_once(node, timeout_sec=0.1)
    return future.result()


def main() -> None:
    states, calls = int(sys.argv[1]), int(sys.argv[2])
    rclpy.init()
    node = Node("probe_client")
    qos = QoSProfile(depth=1000)
    publishers = {
        "odometry": node.create_publisher(Odometry, "/probe/odometry", qos),
        "pose": node.create_publisher(PoseStamped, "/probe/pose", qos),
    }
    plan = node.create_client(GetPlan, "/probe/plan", qos_profile=qos)
    change = node.create_client(ChangeState, "/probe/change", qos_profile=qos)
    if not (plan.wait_for_service(20.0) and change.wait_for_service(20.0)):
        raise TimeoutError("no services")
    answers = []
    for index in range(calls):
        request = GetPlan.Request(tolerance=float(index))
        answers.append(len(call(node, plan, request).plan.poses))
        change_request = ChangeState.Request()
        change_request.transition.label = f"step {index}"
        call(node, change, change_request)
    publish_states(node, publishers, states)  # who has answered has found the publishers
    stamps_ns = [FIRST_STAMP_NS + index * STAMP_STEP_NS for index in range(states)]
    sys.stdout.write(json.dumps({"answers": answers, "stamps_ns": stamps_ns}))
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
