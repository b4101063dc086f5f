"""The arguments that every node of ours takes on the command line, besides ROS's own."""

from __future__ import annotations

import argparse


def ros_arguments(verb: str, description: str, arguments: list[str]) -> list[str]:
    """Return what `rclpy.init` takes; `--help` and mistakes end the process here.

    Args:
        verb: the verb of the command line that the node is.
        description: what it does.
        arguments: all that follows the verb; what comes after `--ros-args` is ROS's.
    """
    parser = argparse.ArgumentParser(
        prog=f"contact-dynamics {verb}",
        description=description,
        epilog="ROS's own arguments follow --ros-args: -p name:=value sets a parameter, -r from:=to remaps.",
    )
    parser.add_argument(
        "--params-file", metavar="FILE", help="YAML file of parameters, such as config/server.yaml"
    )
    split = arguments.index("--ros-args") if "--ros-args" in arguments else len(arguments)
    mine = parser.parse_args(arguments[:split])
    of_ros = arguments[split:]
    if mine.params_file:
        of_ros = ["--ros-args", "--params-file", mine.params_file, *of_ros[1:]]
    return of_ros
