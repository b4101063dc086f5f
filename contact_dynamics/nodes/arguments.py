"""These are the arguments that every node of this package takes on the command line, besides ROS's own.

This file imports no ROS, so that `--help` works without it.
"""

from __future__ import annotations

import argparse
from typing import Final

VISUALIZER_PARAMETERS: Final = {
    "server": "full name of the server node whose answers are drawn",
    "rrd_path": "recording of the picture, which is replaced",
    "rrd_file_size": "size of a file, MB, after which the next one begins; 0: one file",
    "rrd_max_files": "number of newest files to keep; 0: all",
    "spawn": "true: start rerun's viewer",
    "serve": "true: serve the picture at the port, for viewers that connect",
    "connect": "URL of an open viewer",
    "port": "local port for spawn and serve",
    "web_port": "local port of the web viewer for serve; 0: none",
    "viewer_memory": "memory limit of the viewer or of the served picture, such as 500MB",
    "predictions": "number of newest predictions of a body to show",
    "surface_side": "side of the square drawn for a surface, m",
}
"""The parameters that the visualizer has besides the server's, with what `--help` says about each."""

SERVER_PARAMETERS: Final = {
    "bodies": "names of the bodies; each is described by body.NAME.mass, .inertia, .odometry_topic, ...",
    "surfaces": "names of the surfaces; each is described by surface.NAME.point, .normal, .friction, ...",
    "gravity": "acceleration of gravity: x, y, z, m/s^2",
    "world_frame": "frame of states and answers",
    "tf_static_topic": "topic of static transforms",
    "state_timeout": "largest age of the newest state, s",
    "state_history": "length of the history of states, s",
    "future_tolerance": "largest lead of a state's stamp over the clock, s",
    "max_states": "largest number of states kept for a body",
    "warn_every": "shortest time between two warnings of one kind about a topic, s",
    "silent_after": "time without a message after which a topic counts as silent, s",
    "client_gone_for": "how long to drop old requests of a lost client, s",
    "velocity_tolerance": "speed below which a contact counts as at rest, m/s",
    "distance_tolerance": "gap below which a body counts as touching, m",
    "out_of_plane_tolerance": "speed out of the plane that still counts as planar, m/s",
    "horizon": "look-ahead time for a first contact, s",
    "rate": "sample rate of trajectories, Hz",
    "autostart": "false: wait for a lifecycle manager",
    "workers": "number of processes for long questions",
    "answer_deadline": "time limit for an answer of a worker, s",
    "worker_memory": "memory limit of a worker, MB",
    "max_waiting": "largest number of queued questions",
    "self_check_period": "period of the check that messages reach the server, s; 0: never",
    "log": "false: write no log",
    "log_directory": "parent folder of the log's folder",
    "log_before_answer": "true: send an answer only after it is on the disk",
    "log_compression": "compression of the log: none, lz4 or zstd",
    "log_file_size": "size limit of a file of the log, MB; 0: no limit",
    "log_file_duration": "duration of a file of the log, s; 0: no limit",
    "log_size_limit": "size limit of the log, above which its oldest files are deleted, MB; 0: no limit",
}
"""The parameters that the server has, with what `--help` says about each."""


def server_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics server`."""
    return _parser(
        "server",
        "Serve contact modes, impacts, tumbling and whole tosses over ROS 2.",
        f"parameters, which config/server.yaml explains:\n{_listed(SERVER_PARAMETERS)}",
    )


def visualizer_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics visualizer`."""
    return _parser(
        "visualizer",
        "Show bodies, contacts and predictions in rerun, live or to a file.",
        "parameters, which config/visualizer.yaml explains, besides those of the server (`server --help`):\n"
        f"{_listed(VISUALIZER_PARAMETERS)}\n\n"
        "One of rrd_path, spawn, serve and connect is required.",
    )


def ros_arguments(parser: argparse.ArgumentParser, arguments: list[str]) -> list[str]:
    """Return the arguments for `rclpy.init`. `--help` and mistakes end the process here.

    Args:
        parser: the parser of the verb, from this file.
        arguments: all that follows the verb. What comes after `--ros-args` belongs to ROS.
    """
    split = _end_of_ours(arguments)
    mine = _parsed(parser, arguments[:split])
    of_ros = arguments[split:]
    if mine.params_file:
        of_ros = ["--ros-args", "--params-file", mine.params_file, *of_ros[1:]]
    return of_ros


def check_arguments(parser: argparse.ArgumentParser, arguments: list[str]) -> None:
    """Let `--help` and mistakes end the process. ROS checks what follows `--ros-args`."""
    _parsed(parser, arguments[: _end_of_ours(arguments)])


def _parsed(parser: argparse.ArgumentParser, arguments: list[str]) -> argparse.Namespace:
    """Return the arguments. An error ends the process, with a hint where an option should be a parameter."""
    given, unknown = parser.parse_known_args(arguments)
    if unknown:
        name, _, value = unknown[0].partition("=")
        name = name.lstrip("-").replace("-", "_")
        if unknown[0] in {"-p", "-r", "--param", "--remap"}:
            parser.error(f"{unknown[0]} must follow --ros-args: --ros-args {' '.join(unknown)}")
        is_known = name in {*SERVER_PARAMETERS, *VISUALIZER_PARAMETERS} or name.startswith(
            ("body.", "surface.")
        )
        if is_known and parser.prog.endswith(("server", "visualizer")):
            value = value or next(iter(unknown[1:]), "VALUE")
            parser.error(f"{name} is a parameter of ROS, which is set by --ros-args -p {name}:={value}")
        parser.error(f"unrecognized arguments: {' '.join(unknown)}")
    return given


def _end_of_ours(arguments: list[str]) -> int:
    return arguments.index("--ros-args") if "--ros-args" in arguments else len(arguments)


def _listed(parameters: dict[str, str]) -> str:
    return "\n".join(f"  {name:22} {text}" for name, text in parameters.items())


def _parser(verb: str, description: str, parameters: str) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog=f"contact-dynamics {verb}",
        description=description,
        epilog=f"{parameters}\n\n"
        "ROS's own arguments follow --ros-args: -p name:=value sets a parameter, -r from:=to remaps.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--params-file", metavar="FILE", help="YAML file of parameters, such as config/server.yaml"
    )
    return parser
