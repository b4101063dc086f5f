# SPDX-License-Identifier: Apache-2.0
"""Starts the server, a client that asks about its brick and prints the answers, and what throws the brick.

The throw is a recorded one. The command is `ros2 launch contact_dynamics thrown_box.launch.py`. You can
ask, too, while the brick flies:

    ros2 service call /contact_dynamics/predict_impact contact_dynamics_interfaces/srv/PredictImpact \
        "{body_name: brick, fit_window: 0.1}"
"""

from __future__ import annotations

from ament_index_python.packages import get_package_share_path
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription, TimerAction
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from launch import LaunchDescription


def generate_launch_description() -> LaunchDescription:
    """Return the server's launch description, the client, and what throws the box."""
    share = get_package_share_path("contact_dynamics")
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "wait", default_value="5.0", description="Time until the box is thrown, s: time to ask."
            ),
            IncludeLaunchDescription(
                PythonLaunchDescriptionSource(str(share / "launch" / "server.launch.py"))
            ),
            Node(
                package="contact_dynamics",
                executable="commentator",
                namespace=LaunchConfiguration("namespace"),
                arguments=["thrown_box"],
                output="screen",
                parameters=[LaunchConfiguration("params_file")],
            ),
            TimerAction(
                period=LaunchConfiguration("wait"),
                actions=[
                    Node(
                        package="contact_dynamics",
                        executable="toss_publisher",
                        arguments=["--listeners", "2"],  # the server and the client
                        output="screen",
                    )
                ],
            ),
        ]
    )
