"""These are the arguments that every node of this package takes on the command line, besides ROS's own.

This file imports no ROS, so that `--help` works without it.
"""

from __future__ import annotations

import argparse
from typing import Final

VISUALIZER_PARAMETERS: Final = {
    "server": "full name of the server node whose answers are drawn",
    "rrd_path": "file to draw into, which is replaced",
    "rrd_file_size": "MB, after which the next file begins; 0: one file",
    "rrd_max_files": "newest files that stay, where there are several; 0: all",
    "spawn": "true: start rerun's viewer",
    "serve": "true: serve the picture at the port, for viewers that connect",
    "connect": "URL of a viewer that is open already",
    "port": "port of this machine for spawn and serve",
    "web_port": "port of this machine at which a browser finds what is served; 0: none",
    "viewer_memory": "most memory of the viewer that is started, or of what is served, as 500MB",
    "predictions": "newest predictions of a body whose paths are in view",
    "surface_side": "side of the square that a surface is drawn as, m",
}
"""The parameters that the visualizer has besides the server's, with what `--help` says about each."""

SERVER_PARAMETERS: Final = {
    "bodies": "names of the bodies; each is described by body.NAME.mass, .inertia, .odometry_topic, ...",
    "surfaces": "names of the surfaces; each is described by surface.NAME.point, .normal, .friction, ...",
    "gravity": "acceleration of gravity: x, y, z, m/s^2",
    "world_frame": "frame of states and answers",
    "tf_static_topic": "topic of the transforms between frames that stand still",
    "state_timeout": "age, s, from which on the newest state is too old",
    "state_history": "how long states are kept, s",
    "future_tolerance": "how far a state's stamp may be ahead of the clock, s",
    "max_states": "states of a body that are kept, however fast they come",
    "warn_every": "time between two warnings of one kind about a topic, s",
    "silent_after": "time without a message after which a topic counts as silent, s",
    "client_gone_for": "how long a client that seemed gone gets no answers to what it asked before, s",
    "velocity_tolerance": "speed below which a contact counts as at rest, m/s",
    "distance_tolerance": "gap below which a body counts as touching, m",
    "out_of_plane_tolerance": "speed out of the plane that still counts as planar, m/s",
    "horizon": "how far ahead a first contact is looked for, s",
    "rate": "samples a second of trajectories, Hz",
    "autostart": "false: wait for a lifecycle manager",
    "workers": "processes that answer what takes long",
    "answer_deadline": "how long an answer of a worker may take, s",
    "worker_memory": "memory that a worker may take for an answer, MB",
    "max_waiting": "questions that may wait while all workers are busy",
    "self_check_period": "time after which the server checks again whether messages reach it, s; 0: never",
    "log": "false: write no log",
    "log_directory": "folder to put the log's folder into",
    "log_before_answer": "true: an answer leaves only once it is on the disk",
    "log_compression": "how the log is packed: none, lz4 or zstd",
    "log_file_size": "size at which a file of the log is finished, MB; 0: no limit",
    "log_file_duration": "time after which a file of the log is finished, s; 0: no limit",
    "log_size_limit": "size of the log above which its oldest files are deleted, MB; 0: none is",
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
        "It needs somewhere to draw to: rrd_path, spawn, serve or connect.",
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
