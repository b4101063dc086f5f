# SPDX-License-Identifier: Apache-2.0
"""Starts the server, and with `view:=true` the visualizer too.

The command is `ros2 launch contact_dynamics server.launch.py`.
"""

from __future__ import annotations

from ament_index_python.packages import get_package_share_path
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition
from launch.substitutions import EnvironmentVariable, LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node

from launch import LaunchDescription

DISCOVERY = "ROS_AUTOMATIC_DISCOVERY_RANGE"


def generate_launch_description() -> LaunchDescription:
    """Return the nodes and the arguments that configure them."""
    share = get_package_share_path("contact_dynamics")
    namespace = LaunchConfiguration("namespace")
    parameters = LaunchConfiguration("params_file")
    environment = {DISCOVERY: LaunchConfiguration("discovery_range")}  # for these nodes alone
    server = PathJoinSubstitution(["/", namespace, "contact_dynamics"])
    monitor = PathJoinSubstitution(["/", namespace, "contact_dynamics_monitor"])
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "params_file",
                default_value=str(share / "config" / "server.yaml"),
                description="Bodies, surfaces, topics, tolerances: copy config/server.yaml and edit it.",
            ),
            DeclareLaunchArgument(
                "namespace",
                default_value="",
                description="Namespace of the nodes, for several servers side by side, such as left_arm.",
            ),
            DeclareLaunchArgument(
                "view", default_value="false", description="Start the visualizer and rerun's viewer."
            ),
            DeclareLaunchArgument(
                "discovery_range",
                default_value=EnvironmentVariable(DISCOVERY, default_value="LOCALHOST"),
                choices=["LOCALHOST", "SUBNET", "OFF", "SYSTEM_DEFAULT"],
                description=f"Who can find the server: this machine alone, or the network. Sets {DISCOVERY}.",
            ),
            Node(
                package="contact_dynamics",
                executable="server",
                namespace=namespace,
                output="screen",
                additional_env=environment,
                parameters=[parameters],
            ),
            Node(
                package="contact_dynamics",
                executable="visualizer",
                namespace=namespace,
                output="screen",
                additional_env=environment,
                parameters=[parameters, {"spawn": True, "server": server, "monitor": monitor}],
                condition=IfCondition(LaunchConfiguration("view")),
            ),
        ]
    )
