# SPDX-License-Identifier: Apache-2.0
"""Publishes the states of a block that is pushed, or whose tray tilts, and what a sensor measures there.

It takes the server's parameters: the block is the first body, its topic is that body's, and it moves among
the configured surfaces.
"""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, Final

from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.utilities import remove_ros_args

from contact_dynamics.constants import to_ns, to_seconds
from contact_dynamics.demo.arguments import PUSHED_BLOCK, block_publisher_parser
from contact_dynamics.demo.situations import PushedBlock, TiltingTray
from contact_dynamics.demo.sprung_block import SprungBlock
from contact_dynamics.demo.until_stopped import run_until_stopped
from contact_dynamics.errors import NotSupportedError
from contact_dynamics.nodes.node_parameters import NodeParameters
from contact_dynamics.nodes.parameters import read_server_parameters
from msg_adapters.odometry import odometry_from_body_state
from msg_adapters.stamps import stamp_to_msg

if TYPE_CHECKING:
    import argparse
    import threading

    from contact_dynamics.demo.situations import Situation

QOS: Final = QoSProfile(depth=1000)

PERIOD_S: Final = 0.005
"""s between two states."""

_DISCOVERY_S: Final = 30.0  # how long to wait for somebody who listens


class BlockPublisher(Node):
    """The node `block_publisher`."""

    def __init__(self, situation: Situation) -> None:
        """Read the configuration, and advertise the topics.

        Raises:
            ContactDynamicsError: the configuration is not allowed, or has no body with a topic of its own.
        """
        super().__init__("block_publisher")
        parameters = read_server_parameters(NodeParameters(self, read_only=True))
        topics = [source.topics[0] for each in parameters.sources[:1] for source in each.sources]
        if not topics or not parameters.world.surfaces:
            raise NotSupportedError("a body with an odometry_topic and a surface are required")
        self._body, self._frame = parameters.world.bodies[0], parameters.world_frame
        self._child_frame = parameters.sources[0].frame
        self._block = SprungBlock.resting(self._body, parameters.world)
        self._situation = situation
        self._states = self.create_publisher(Odometry, topics[0].full_name, QOS)
        self._sensor = self.create_publisher(situation.msg_type, situation.topic, QOS)

    def play(self, seconds: float, stop: threading.Event) -> None:
        """Publish for so many s, or until told to stop.

        It begins when somebody listens to the states and to the sensor, or after some time.
        """
        deadline = time.monotonic() + _DISCOVERY_S
        while self._lacks_listeners() and time.monotonic() < deadline:
            if stop.wait(0.02):
                return
        begin_ns = self.get_clock().now().nanoseconds
        for sample in range(round(seconds / PERIOD_S)):
            self._block.move(self._situation.load(sample * PERIOD_S, self._block), PERIOD_S)
            stamp_ns = begin_ns + to_ns((sample + 1) * PERIOD_S)
            if stop.wait(max(0.0, to_seconds(stamp_ns - self.get_clock().now().nanoseconds))):
                return
            self._publish(stamp_ns)

    def _lacks_listeners(self) -> bool:
        return any(each.get_subscription_count() == 0 for each in (self._states, self._sensor))

    def _publish(self, stamp_ns: int) -> None:
        self._states.publish(
            odometry_from_body_state(
                self._block.state(stamp_ns),
                world_frame=self._frame,
                child_frame=self._child_frame,
                p_FB_F=self._body.p_FB_F,
            )
        )
        # After the state, which the server then has when somebody asks about what the sensor measured.
        measured = self._situation.measured()
        measured.header.stamp, measured.header.frame_id = stamp_to_msg(stamp_ns), self._frame
        self._sensor.publish(measured)


def main(arguments: list[str]) -> int:
    """Publish one situation until it ends or the process is told to stop, and return the exit code."""
    given = block_publisher_parser().parse_args(remove_ros_args(arguments))

    def work(stop: threading.Event) -> None:
        BlockPublisher(_situation(given)).play(given.seconds, stop)

    return run_until_stopped(arguments, work)


def _situation(given: argparse.Namespace) -> Situation:
    if given.situation == PUSHED_BLOCK:
        return PushedBlock(height=given.height, rate=given.rate)
    return TiltingTray(max_tilt=math.radians(given.tilt), rate=math.radians(given.degrees_per_second))
