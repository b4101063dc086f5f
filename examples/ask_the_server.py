# SPDX-License-Identifier: Apache-2.0
"""Ask a running server over ROS 2, with a deadline and a retry: start `contact-dynamics server` first.

The client's queue is deep and each call has a deadline, because replies can get lost when many ask at once.
"""

import time

import rclpy
from rclpy.node import Node
from rclpy.qos import QoSProfile

from contact_dynamics_interfaces.srv import PredictTumbling

DEADLINE_S = 1.0
TRIES = 3


def main() -> None:
    """Ask where a spinning body will be in half a second."""
    rclpy.init()
    node = Node("asks_the_server")
    client = node.create_client(
        PredictTumbling, "/contact_dynamics/predict_tumbling", qos_profile=QoSProfile(depth=1000)
    )
    if not client.wait_for_service(timeout_sec=10.0):
        raise SystemExit("no server: start it with `contact-dynamics server`")

    request = PredictTumbling.Request(state_source=PredictTumbling.Request.STATE_EXPLICIT, times=[0.5])
    request.inertia.m, request.inertia.ixx, request.inertia.iyy, request.inertia.izz = 1.0, 0.1, 0.2, 0.25
    request.state.angular_velocity.y, request.state.angular_velocity.z = 6.0, 0.1

    for _ in range(TRIES):
        future = client.call_async(request)
        deadline = time.monotonic() + DEADLINE_S  # not the node's clock: a simulation's may stand still
        while not future.done() and time.monotonic() < deadline:
            rclpy.spin_once(node, timeout_sec=0.05)
        if future.done():
            break
        client.remove_pending_request(future)
    else:
        raise SystemExit(f"no answer in {TRIES} tries of {DEADLINE_S} s")

    answer = future.result()
    if answer.status != answer.OK:
        raise SystemExit(f"refused with status {answer.status}: {answer.message}")
    print(
        "position",
        list(answer.trajectory.positions),
        "orientation x y z w",
        list(answer.trajectory.orientations),
    )
    rclpy.shutdown()


if __name__ == "__main__":
    main()
