# SPDX-License-Identifier: Apache-2.0
"""Runs what a ROS process of a situation does, until it ends or the process is told to stop."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import rclpy
from rclpy.signals import SignalHandlerOptions

from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.nodes.own_process import ensure_ros_log_directory
from contact_dynamics.nodes.running import stop_signals

if TYPE_CHECKING:
    import threading
    from collections.abc import Callable


def run_until_stopped(arguments: list[str], work: Callable[[threading.Event], None]) -> int:
    """Do the work under ROS and return the exit code. The work ends soon after its event is set."""
    ensure_ros_log_directory()
    with stop_signals() as stop:
        rclpy.init(args=arguments, signal_handler_options=SignalHandlerOptions.NO)
        try:
            work(stop)
        except ContactDynamicsError as error:
            print(f"configuration: {error}", file=sys.stderr)
            return 2
        finally:
            rclpy.try_shutdown()
    return 0
