# SPDX-License-Identifier: Apache-2.0
"""The command-line arguments of the nodes besides ROS's own.

This file imports no ROS, so that `--help` works without it.
"""

from __future__ import annotations

import argparse
import json
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contact_dynamics.nodes.other_parameters import (
    MONITOR_PARAMETERS,
    PARAMETERS_OF_OTHERS,
    VISUALIZER_PARAMETERS,
)
from contact_dynamics.nodes.parameter_file import files_given
from contact_dynamics.nodes.parameters import described_server_parameters

if TYPE_CHECKING:
    from collections.abc import Iterable

    from contact_dynamics.nodes.parameter_reader import DeclaredParameter


def server_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics server`."""
    return _parser(
        "server",
        "Provide the services for contact modes, impacts, tumbling and tosses over ROS 2.",
        f"parameters, explained in config/server.yaml:\n{_listed(described_server_parameters())}",
    )


def visualizer_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics visualizer`."""
    return _parser(
        "visualizer",
        "Draw bodies, contacts and predictions in rerun, live or to a file.",
        "parameters, explained in config/visualizer.yaml, in addition to those of the server "
        f"(`server --help`):\n{_listed(VISUALIZER_PARAMETERS.values())}\n\n"
        "One of rrd_path, spawn, serve and connect is required.",
    )


def live_monitor_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics live_monitor`."""
    return _parser(
        "live_monitor",
        "Predict each event of published states before it happens, publish how it compares, and detect "
        "changes of friction and restitution.",
        "parameters, explained in config/monitor.yaml, in addition to those of the server "
        f"(`server --help`):\n{_listed(MONITOR_PARAMETERS.values())}",
    )


def ros_arguments(parser: argparse.ArgumentParser, arguments: list[str]) -> list[str]:
    """Return the arguments for `rclpy.init`. `--help` and mistakes end the process here.

    The ``arguments`` are all after the verb; ROS reads those after `--ros-args`.
    """
    split = _end_of_ours(arguments)
    mine = _parsed(parser, arguments[:split])
    of_ros = arguments[split:]
    if mine.params_file:
        of_ros = ["--ros-args", "--params-file", mine.params_file, *of_ros[1:]]
    for path in files_given(of_ros):  # otherwise the error is one of rcl, with a line of its source
        if not Path(path).is_file():
            parser.error(f"--params-file {path}: no such file")
    return of_ros


def check_arguments(parser: argparse.ArgumentParser, arguments: list[str]) -> None:
    """Parse the arguments before `--ros-args`. `--help` and mistakes end the process."""
    _parsed(parser, arguments[: _end_of_ours(arguments)])


def _parsed(parser: argparse.ArgumentParser, arguments: list[str]) -> argparse.Namespace:
    """Return the arguments. A mistake ends the process, with a hint if the option is a parameter."""
    given, unknown = parser.parse_known_args(arguments)
    if unknown:
        name, _, value = unknown[0].partition("=")
        name = name.lstrip("-").replace("-", "_")
        if unknown[0] in {"-p", "-r", "--param", "--remap"}:
            parser.error(f"{unknown[0]} must follow --ros-args: --ros-args {' '.join(unknown)}")
        known = {*PARAMETERS_OF_OTHERS, *(each.name for each in described_server_parameters())}
        is_known = name in known or name.startswith(("body.", "surface."))
        if is_known and parser.prog.endswith(("server", "visualizer", "live_monitor")):
            value = value or next(iter(unknown[1:]), "VALUE")
            parser.error(f"{name} is a parameter of ROS, which is set by --ros-args -p {name}:={value}")
        parser.error(f"unrecognized arguments: {' '.join(unknown)}")
    return given


def _end_of_ours(arguments: list[str]) -> int:
    return arguments.index("--ros-args") if "--ros-args" in arguments else len(arguments)


def _listed(parameters: Iterable[DeclaredParameter]) -> str:
    wrapped = textwrap.TextWrapper(width=110, subsequent_indent=" " * 31, break_on_hyphens=False)
    return "\n".join(
        wrapped.fill(f"  {each.name:28} {each.description}{_default(each.value)}") for each in parameters
    )


def _default(value: Any) -> str:
    """Return a text with the default of a parameter, unless its description explains the default."""
    if value in (None, "", 0, [""], [0.0]):
        return ""
    return f" Default: {json.dumps(value)}."


def _parser(verb: str, description: str, parameters: str) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog=f"contact-dynamics {verb}",
        description=description,
        epilog=f"{parameters}\n\n"
        "ROS arguments follow --ros-args: -p name:=value sets a parameter, and -r from:=to remaps a name.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--params-file", metavar="FILE", help="YAML file of parameters, such as config/server.yaml"
    )
    return parser
