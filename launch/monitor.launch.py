# SPDX-License-Identifier: Apache-2.0
"""Starts the monitor, which compares each event of the bodies with its prediction, and reports changes.

The command is `ros2 launch contact_dynamics monitor.launch.py params_file:=server.yaml`.
"""

from __future__ import annotations

from ament_index_python.packages import get_package_share_path
from launch.actions import DeclareLaunchArgument
from launch.substitutions import EnvironmentVariable, LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

from launch import LaunchDescription

DISCOVERY = "ROS_AUTOMATIC_DISCOVERY_RANGE"


def generate_launch_description() -> LaunchDescription:
    """Return the node and the arguments that configure it."""
    share = get_package_share_path("contact_dynamics")
    calibration = ParameterValue(LaunchConfiguration("calibration"), value_type=str)
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "params_file",
                default_value=str(share / "config" / "server.yaml"),
                description="Bodies, surfaces, topics, log: the server's configuration.",
            ),
            DeclareLaunchArgument(
                "calibration",
                default_value="",
                description="Output file of calibrate --json, whose model errors widen the regions.",
            ),
            DeclareLaunchArgument(
                "namespace", default_value="", description="Namespace of the node, such as left_arm."
            ),
            DeclareLaunchArgument(
                "discovery_range",
                default_value=EnvironmentVariable(DISCOVERY, default_value="LOCALHOST"),
                choices=["LOCALHOST", "SUBNET", "OFF", "SYSTEM_DEFAULT"],
                description=f"Who can find it: this machine alone, or the network. Sets {DISCOVERY}.",
            ),
            Node(
                package="contact_dynamics",
                executable="live_monitor",
                namespace=LaunchConfiguration("namespace"),
                output="screen",
                additional_env={DISCOVERY: LaunchConfiguration("discovery_range")},
                parameters=[LaunchConfiguration("params_file"), {"calibration": calibration}],
            ),
        ]
    )
