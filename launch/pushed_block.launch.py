# SPDX-License-Identifier: Apache-2.0
"""Starts the server, a block that a finger pushes, and a client that asks what the block does and prints it.

The command is `ros2 launch contact_dynamics pushed_block.launch.py`. With `height:=0.15` the block tips.
"""

from __future__ import annotations

from ament_index_python.packages import get_package_share_path
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from launch import LaunchDescription

# `tray.launch.py` is much alike. Each stands alone, since people copy a launch file and change it.


def generate_launch_description() -> LaunchDescription:
    """Return the server's launch description, the publisher and the client."""
    share = get_package_share_path("contact_dynamics")
    parameters = LaunchConfiguration("params_file")
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "params_file",
                default_value=str(share / "config" / "pushed_block.yaml"),
                description="The block and the floor. A copy with other numbers is another experiment.",
            ),
            DeclareLaunchArgument(
                "height", default_value="0.03", description="Height at which the finger pushes, m."
            ),
            DeclareLaunchArgument("rate", default_value="1.0", description="How fast the push grows, N/s."),
            IncludeLaunchDescription(
                PythonLaunchDescriptionSource(str(share / "launch" / "server.launch.py")),
                launch_arguments={"params_file": parameters}.items(),
            ),
            Node(
                package="contact_dynamics",
                executable="block_publisher",
                arguments=[
                    *("pushed_block", "--height", LaunchConfiguration("height")),
                    *("--rate", LaunchConfiguration("rate")),
                ],
                output="screen",
                parameters=[parameters],
            ),
            Node(
                package="contact_dynamics",
                executable="commentator",
                namespace=LaunchConfiguration("namespace"),
                arguments=["pushed_block"],
                output="screen",
                parameters=[parameters],
            ),
        ]
    )
