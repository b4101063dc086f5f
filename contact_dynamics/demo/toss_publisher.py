# SPDX-License-Identifier: Apache-2.0
"""Publishes a recorded toss as `nav_msgs/Odometry`, in real time."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING, Final

from nav_msgs.msg import Odometry
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.utilities import remove_ros_args

from contact_dynamics.constants import to_ns, to_seconds
from contact_dynamics.demo.arguments import toss_publisher_parser
from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.measured.read_toss import read_toss
from contact_dynamics.measured.recorded_toss import Toss
from contact_dynamics.nodes.running import ros_until_stopped
from msg_adapters.odometry import odometry_from_body_state

if TYPE_CHECKING:
    import threading

WORLD_FRAME: Final = "world"
QOS: Final = QoSProfile(depth=1000)

_DISCOVERY_S: Final = 30.0  # longest time to wait for subscribers
_LEAD_S: Final = 1.0  # s between the last subscription and the toss


def topic_of(toss: Toss) -> str:
    """Return the topic of a toss."""
    return f"/{toss.body.name}/odometry"


class TossPublisher(Node):
    """The node `toss_publisher`."""

    def __init__(self, toss: Toss) -> None:
        """Advertise the topic."""
        super().__init__("toss_publisher")
        self._toss = toss
        self._publisher = self.create_publisher(Odometry, topic_of(toss), QOS)

    def wait_for_listeners(self, count: int, stop: threading.Event) -> bool:
        """Wait for this number of subscriptions, and return whether they matched in time."""
        deadline = time.monotonic() + _DISCOVERY_S
        while self._publisher.get_subscription_count() < count:
            if stop.wait(0.02) or time.monotonic() > deadline:
                return False
        return True

    def play(self, stop: threading.Event) -> None:
        """Publish each sample at its time, which is its stamp.

        The toss begins later, because a subscriber may need some tenths of a second longer to discover this
        publisher than the reverse.
        """
        toss = self._toss
        lead_ns = to_ns(_LEAD_S - float(toss.times[0]))
        epoch_ns = self.get_clock().now().nanoseconds + lead_ns
        for sample in range(len(toss)):
            state = toss.state(sample, epoch_ns=epoch_ns)
            msg = odometry_from_body_state(
                state, world_frame=WORLD_FRAME, child_frame=toss.body.name, p_FB_F=toss.body.p_FB_F
            )
            if stop.wait(max(0.0, to_seconds(state.stamp_ns - self.get_clock().now().nanoseconds))):
                return
            self._publisher.publish(msg)

    def drain(self) -> None:
        """Wait until all subscribers have acknowledged all samples."""
        self._publisher.wait_for_all_acked(Duration(seconds=5))


def main(arguments: list[str]) -> int:
    """Publish one toss, and return the exit code."""
    given = toss_publisher_parser().parse_args(remove_ros_args(arguments))
    try:
        toss = read_toss(given.toss)
    except (ContactDynamicsError, OSError) as error:
        print(error, file=sys.stderr)
        return 2
    with ros_until_stopped(arguments) as stop:
        publisher = TossPublisher(toss)
        if not publisher.wait_for_listeners(given.listeners, stop):
            print(f"fewer than {given.listeners} listeners on {topic_of(toss)}", file=sys.stderr)
            return 1
        publisher.play(stop)
        if stop.is_set():
            return 130
        print(f"published {len(toss)} states on {topic_of(toss)}", flush=True)
        publisher.drain()
    return 0
