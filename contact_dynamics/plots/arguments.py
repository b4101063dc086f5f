# SPDX-License-Identifier: Apache-2.0
"""These are the arguments of `contact-dynamics plot`."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Final

MAX_RESPONSES: Final = 100  # the number of responses that are drawn by default


def plot_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics plot`."""
    parser = argparse.ArgumentParser(
        prog="contact-dynamics plot",
        usage="%(prog)s [options] --output DIR LOG",
        description="Draw diagrams of the responses in a log: trajectories, Poinsot's construction, impacts "
        "in impulse space, contact modes with their forces, maps of modes and force duals, whole "
        "tosses, and many states. It requires only the log, and neither ROS nor a viewer.",
        epilog="Each file name consists of the number of the request in the log, its service, its body and "
        "the diagram. The exit code is 0 if a diagram was drawn, 1 if the log contains no response with a "
        "diagram, and 2 if it is not a log of the server or a file cannot be written.",
    )
    parser.add_argument(
        "log", nargs="?", metavar="LOG", help="folder of a log of the server, or its .mcap file"
    )
    parser.add_argument(
        "--output", type=Path, metavar="DIR", help="output folder, created if it does not exist"
    )
    parser.add_argument(
        "--format", choices=("svg", "png"), default="svg", help="format of the files (default: svg)"
    )
    parser.add_argument(
        "--max-responses",
        type=_count,
        default=MAX_RESPONSES,
        metavar="N",
        help=f"maximum number of responses to draw (default: {MAX_RESPONSES})",
    )
    return parser


def _count(text: str) -> int:
    try:
        value = int(text)
    except ValueError:
        value = 0
    if value < 1:
        raise argparse.ArgumentTypeError(f"must be a whole number >= 1, got {text}")
    return value
