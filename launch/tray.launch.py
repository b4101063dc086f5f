# SPDX-License-Identifier: Apache-2.0
"""Starts the server, a tray that tilts, and a client that asks what the block on it does and prints it.

The command is `ros2 launch contact_dynamics tray.launch.py`.
"""

from __future__ import annotations

from ament_index_python.packages import get_package_share_path
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from launch import LaunchDescription

# `pushed_block.launch.py` is much alike. Each stands alone, since people copy a launch file and change it.


def generate_launch_description() -> LaunchDescription:
    """Return the server's launch description, the publisher and the client."""
    share = get_package_share_path("contact_dynamics")
    parameters = LaunchConfiguration("params_file")
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "params_file",
                default_value=str(share / "config" / "tray.yaml"),
                description="The block and the tray. A copy with other numbers is another experiment.",
            ),
            DeclareLaunchArgument(
                "tilt", default_value="25.0", description="How far the tray tilts, degrees."
            ),
            DeclareLaunchArgument(
                "degrees_per_second", default_value="3.0", description="How fast the tray tilts."
            ),
            IncludeLaunchDescription(
                PythonLaunchDescriptionSource(str(share / "launch" / "server.launch.py")),
                launch_arguments={"params_file": parameters}.items(),
            ),
            Node(
                package="contact_dynamics",
                executable="block_publisher",
                arguments=[
                    *("tray", "--tilt", LaunchConfiguration("tilt")),
                    *("--degrees-per-second", LaunchConfiguration("degrees_per_second")),
                ],
                output="screen",
                parameters=[parameters],
            ),
            Node(
                package="contact_dynamics",
                executable="commentator",
                namespace=LaunchConfiguration("namespace"),
                arguments=["tray"],
                output="screen",
                parameters=[parameters],
            ),
        ]
    )
