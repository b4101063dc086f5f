# SPDX-License-Identifier: Apache-2.0
"""Publishes the brick's states at 500 Hz until it is stopped, and, if asked, a simulated clock at 40 Hz.

A process of its own, as a driver or a simulator is: ``state_stream.py wall``, ``state_stream.py simulated``.
Simulated time runs at half the speed of the wall clock, from 1000 s on.
"""

from __future__ import annotations

import signal
import sys
import threading
import time

import rclpy
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.signals import SignalHandlerOptions
from rosgraph_msgs.msg import Clock

from msg_adapters.stamps import stamp_to_msg

PERIOD_S = 0.002
TICK_NS = 12_500_000  # of simulated time
SIMULATED_START_NS = 1_000_000_000_000


def main(kind: str) -> None:
    """Publish until SIGINT or SIGTERM comes."""
    stop = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stop.set())
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = Node("state_stream")
    states = node.create_publisher(Odometry, "/brick/odometry", QoSProfile(depth=1000))
    clock = node.create_publisher(Clock, "/clock", QoSProfile(depth=10)) if kind == "simulated" else None
    began_ns, ticks = time.time_ns(), 0
    while not stop.wait(PERIOD_S):
        now_ns = time.time_ns()
        if clock is not None:
            now_ns = SIMULATED_START_NS + (now_ns - began_ns) // 2
            if (now_ns - SIMULATED_START_NS) // TICK_NS >= ticks:
                ticks = (now_ns - SIMULATED_START_NS) // TICK_NS + 1
                clock.publish(Clock(clock=stamp_to_msg(now_ns)))
        msg = Odometry(child_frame_id="brick")
        msg.header.frame_id, msg.header.stamp = "world", stamp_to_msg(now_ns)
        msg.pose.pose.position.z = 1.0
        msg.twist.twist.angular.x = 3.0
        states.publish(msg)
    rclpy.shutdown()


main(sys.argv[1])
