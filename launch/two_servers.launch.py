# SPDX-License-Identifier: Apache-2.0
"""Starts two servers side by side, each with a namespace and a configuration: copy this file for yours.

The command is `ros2 launch contact_dynamics two_servers.launch.py`. Their services are then, for example,
/left_arm/contact_dynamics/predict_impact and /right_arm/contact_dynamics/predict_impact.
"""

from __future__ import annotations

from ament_index_python.packages import get_package_share_path
from launch.actions import GroupAction, IncludeLaunchDescription, OpaqueFunction
from launch.launch_description_sources import PythonLaunchDescriptionSource

from launch import LaunchContext, LaunchDescription

CONFIGURATIONS = {"left_arm": "tray.yaml", "right_arm": "pushed_block.yaml"}


def reject_arguments(context: LaunchContext) -> None:
    """Raise an error if a launch argument was given of which each server has its own value."""
    for name in ("namespace", "params_file"):
        if name in context.launch_configurations:
            given = context.launch_configurations[name]
            raise ValueError(f"{name} must not be given, since each server has its own, got {given!r}")


def generate_launch_description() -> LaunchDescription:
    """Return the launch description of each server, in a group that keeps its arguments from the others."""
    share = get_package_share_path("contact_dynamics")
    server = str(share / "launch" / "server.launch.py")
    return LaunchDescription(
        [
            OpaqueFunction(function=reject_arguments),
            *(
                GroupAction(
                    [
                        IncludeLaunchDescription(
                            PythonLaunchDescriptionSource(server),
                            launch_arguments={
                                "namespace": namespace,
                                "params_file": str(share / "config" / configuration),
                            }.items(),
                        )
                    ]
                )
                for namespace, configuration in CONFIGURATIONS.items()
            ),
        ]
    )
