# SPDX-License-Identifier: Apache-2.0
"""The process of a self-check: joins the domain as a new client does, and sends a token for a while.

It ends with 0 when it has sent the token, whether or not somebody received it.
"""

from __future__ import annotations

import os
import sys
import time
from typing import Final

import rclpy
from diagnostic_msgs.msg import KeyValue
from rclpy.node import Node

from contact_dynamics.nodes.self_check import KEY, QOS

FIND_S: Final = 10.0
"""s for which the node is looked for. A node that is not found is not reached either."""

SEND_S: Final = 3.0
_EVERY_S: Final = 0.1
_NICE: Final = 10


def main(topic: str, token: str, domain_id: int) -> None:
    """Send the token to a topic."""
    os.nice(_NICE)  # answers go first
    # Without a file of its own in ROS's log folder, which would have one more every minute.
    rclpy.init(args=["--ros-args", "--disable-external-lib-logs"], domain_id=domain_id)
    node = Node("_contact_dynamics_self_check", enable_rosout=False, start_parameter_services=False)
    publisher = node.create_publisher(KeyValue, topic, QOS)
    deadline = time.monotonic() + FIND_S
    while not publisher.get_subscription_count() and time.monotonic() < deadline:
        time.sleep(_EVERY_S)
    deadline = time.monotonic() + SEND_S
    while time.monotonic() < deadline:
        publisher.publish(KeyValue(key=KEY, value=token))
        time.sleep(_EVERY_S)
    rclpy.shutdown()


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]))
