# SPDX-License-Identifier: Apache-2.0
"""Publishes the states of a block that is pushed or lies on a tilting tray, and the measurements of a sensor.

It receives the server's parameters: the block is the first body, its states are published on that body's
topic, and it touches the configured surfaces.
"""

from __future__ import annotations

import math
import sys
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, TypeAlias

from geometry_msgs.msg import Vector3Stamped, WrenchStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.utilities import remove_ros_args

from contact_dynamics.constants import STANDARD_GRAVITY_W, to_ns, to_seconds
from contact_dynamics.demo.arguments import PUSHED_BLOCK, block_publisher_parser
from contact_dynamics.demo.sprung_block import Load, SprungBlock
from contact_dynamics.errors import ContactDynamicsError, NotSupportedError
from contact_dynamics.nodes.node_parameters import NodeParameters
from contact_dynamics.nodes.parameters import read_server_parameters
from contact_dynamics.nodes.running import ros_until_stopped
from msg_adapters.geometry import vector_to_msg
from msg_adapters.odometry import odometry_from_body_state
from msg_adapters.stamps import stamp_to_msg

if TYPE_CHECKING:
    import argparse
    import threading


QOS: Final = QoSProfile(depth=1000)

PERIOD_S: Final = 0.005  # s between two states
_DISCOVERY_S: Final = 30.0  # longest time to wait for subscribers

_GRAVITY: Final = -STANDARD_GRAVITY_W[2]

BEGINS_S: Final = 1.0  # s at the beginning during which the block rests
MAX_PUSHED: Final = 0.1  # m, displacement at which the finger stops pushing
MAX_TIPPED: Final = 0.3  # rad, tilt at which the finger stops: the block then falls over by itself


@dataclass(slots=True, kw_only=True)
class PushedBlock:
    """A finger pushes a block along x with increasing force until the block slides or falls over.

    The finger is frictionless and stays at its height. Its sensor measures the wrench on the block in world
    axes, about the world's origin.
    """

    height: float  # m above the floor; above half the depth divided by the friction, the block tips
    rate: float  # N/s
    topic: str = "/finger/wrench"
    msg_type: type = WrenchStamped
    _force: float = 0.0
    _is_over: bool = False

    def load(self, seconds: float, block: SprungBlock) -> Load:
        """Return the weight and the push."""
        self._is_over = self._is_over or block.x > MAX_PUSHED or abs(block.angle) > MAX_TIPPED
        self._force = 0.0 if self._is_over else max(0.0, self.rate * (seconds - BEGINS_S))
        return Load(
            force_x=self._force, force_z=-block.mass * _GRAVITY, moment=(self.height - block.z) * self._force
        )

    def measured(self) -> WrenchStamped:
        """Return the wrench of the finger."""
        msg = WrenchStamped()
        msg.wrench.force = vector_to_msg([self._force, 0.0, 0.0])
        msg.wrench.torque = vector_to_msg([0.0, self.height * self._force, 0.0])
        return msg


@dataclass(slots=True, kw_only=True)
class TiltingTray:
    """A tray tilts slowly about its y axis.

    All quantities are in the axes of the tray, in which gravity rotates. Inertial forces are neglected: at
    0.05 rad/s, the Coriolis acceleration of a block that slides at 0.5 m/s is 0.05 m/s^2. The sensor is the
    tray's accelerometer.
    """

    max_tilt: float  # rad, at which the tray stops
    rate: float  # rad/s
    topic: str = "/tray/gravity"
    msg_type: type = Vector3Stamped
    _tilt: float = 0.0

    def load(self, seconds: float, block: SprungBlock) -> Load:
        """Return the weight in the tray's axes."""
        self._tilt = min(self.max_tilt, max(0.0, self.rate * (seconds - BEGINS_S)))
        weight = block.mass * _GRAVITY
        return Load(force_x=weight * math.sin(self._tilt), force_z=-weight * math.cos(self._tilt))

    def measured(self) -> Vector3Stamped:
        """Return the acceleration of gravity."""
        g = _GRAVITY
        turned = vector_to_msg([g * math.sin(self._tilt), 0.0, -g * math.cos(self._tilt)])
        return Vector3Stamped(vector=turned)


Situation: TypeAlias = PushedBlock | TiltingTray
"""A scenario: the load on the block, and the measurement of a sensor."""


class BlockPublisher(Node):
    """The node `block_publisher`."""

    def __init__(self, situation: Situation) -> None:
        """Read the configuration, and advertise the topics.

        Raise `ContactDynamicsError` if the configuration is invalid, or has no body with a topic of its own.
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
        """Publish for this duration, s, or until ``stop`` is set.

        It waits for subscribers of the states and of the sensor first, up to a maximum time.
        """
        deadline = time.monotonic() + _DISCOVERY_S
        publishers = (self._states, self._sensor)
        while any(each.get_subscription_count() == 0 for each in publishers) and time.monotonic() < deadline:
            if stop.wait(0.02):
                return
        begin_ns = self.get_clock().now().nanoseconds
        for sample in range(round(seconds / PERIOD_S)):
            self._block.move(self._situation.load(sample * PERIOD_S, self._block), PERIOD_S)
            stamp_ns = begin_ns + to_ns((sample + 1) * PERIOD_S)
            if stop.wait(max(0.0, to_seconds(stamp_ns - self.get_clock().now().nanoseconds))):
                return
            self._publish(stamp_ns)

    def _publish(self, stamp_ns: int) -> None:
        self._states.publish(
            odometry_from_body_state(
                self._block.state(stamp_ns),
                world_frame=self._frame,
                child_frame=self._child_frame,
                p_FB_F=self._body.p_FB_F,
            )
        )
        # Published after the state, so that the server has the state when a client uses the measurement.
        measured = self._situation.measured()
        measured.header.stamp, measured.header.frame_id = stamp_to_msg(stamp_ns), self._frame
        self._sensor.publish(measured)


def main(arguments: list[str]) -> int:
    """Publish one scenario until it ends or the process is interrupted, and return the exit code."""
    given = block_publisher_parser().parse_args(remove_ros_args(arguments))
    with ros_until_stopped(arguments) as stop:
        try:
            BlockPublisher(_situation(given)).play(given.seconds, stop)
        except ContactDynamicsError as error:
            print(f"configuration: {error}", file=sys.stderr)
            return 2
    return 0


def _situation(given: argparse.Namespace) -> Situation:
    if given.situation == PUSHED_BLOCK:
        return PushedBlock(height=given.height, rate=given.rate)
    return TiltingTray(max_tilt=math.radians(given.tilt), rate=math.radians(given.degrees_per_second))
