"""Starts the server and publishes a recorded toss of its brick, about which it can then be asked.

The command is `ros2 launch contact_dynamics thrown_box.launch.py`. While the brick flies:

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
    """Return the server's launch description, and what throws the box."""
    server = get_package_share_path("contact_dynamics") / "launch" / "server.launch.py"
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "wait", default_value="5.0", description="Time until the box is thrown, s: time to ask."
            ),
            IncludeLaunchDescription(PythonLaunchDescriptionSource(str(server))),
            TimerAction(
                period=LaunchConfiguration("wait"),
                actions=[Node(package="contact_dynamics", executable="toss_publisher", output="screen")],
            ),
        ]
    )
