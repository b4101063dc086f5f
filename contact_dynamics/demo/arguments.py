# SPDX-License-Identifier: Apache-2.0
"""The arguments of the demo's verbs, in a separate file because `--help` must not require ROS."""

from __future__ import annotations

import argparse
from typing import Final

from contact_dynamics.measured.read_toss import DEFAULT_RECORDING

# The scenarios of the examples. Each has a launch file of the same name.
THROWN_BOX: Final = "thrown_box"
PUSHED_BLOCK: Final = "pushed_block"
TRAY: Final = "tray"

_RECORDING = "recording: a .csv file, or a measured cube toss as .npz#INDEX (default: the package's own toss)"


def demo_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics demo`."""
    parser = argparse.ArgumentParser(
        prog="contact-dynamics demo",
        description="Play a recorded toss, and compare the server's predictions with the measurements.",
        epilog="The example nodes toss_publisher, block_publisher and commentator also have --help.",
    )
    parser.add_argument("--toss", default=str(DEFAULT_RECORDING), metavar="PATH", help=_RECORDING)
    parser.add_argument("--view", action="store_true", help="draw the toss live in rerun's viewer")
    parser.add_argument(
        "--output",
        default="demo_output",
        metavar="DIR",
        help="parent folder of the folder of this run (default: %(default)s)",
    )
    parser.add_argument("--quiet", action="store_true", help="print no table")
    return parser


def toss_publisher_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics toss_publisher`."""
    parser = argparse.ArgumentParser(
        prog="contact-dynamics toss_publisher", description="Publish the states of a recorded toss."
    )
    parser.add_argument("--toss", default=str(DEFAULT_RECORDING), metavar="PATH", help=_RECORDING)
    parser.add_argument(
        "--listeners",
        type=int,
        default=1,
        metavar="N",
        help="number of subscriptions to wait for (default: %(default)s)",
    )
    return parser


def block_publisher_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics block_publisher`."""
    parser = argparse.ArgumentParser(
        prog="contact-dynamics block_publisher",
        description="Publish the states of a block that is pushed by a finger, or lies on a tilting tray.",
        epilog="The server's parameters, after --ros-args, describe the block and its surfaces.",
    )
    parser.add_argument(
        "situation",
        nargs="?",
        choices=(PUSHED_BLOCK, TRAY),
        default=PUSHED_BLOCK,
        help="scenario (default: %(default)s)",
    )
    numbers = {
        "--height": (0.03, "M", "height of the push, m"),
        "--rate": (1.0, "N/S", "growth rate of the push, N/s"),
        "--tilt": (25.0, "DEGREES", "final tilt of the tray, degrees"),
        "--degrees-per-second": (3.0, "DEGREES", "tilt rate of the tray, degrees/s"),
        "--seconds": (15.0, "S", "duration, s"),
    }
    for name, (default, unit, text) in numbers.items():
        parser.add_argument(
            name, type=float, default=default, metavar=unit, help=f"{text} (default: %(default)s)"
        )
    return parser


def commentator_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics commentator`."""
    parser = argparse.ArgumentParser(
        prog="contact-dynamics commentator",
        description="Send requests to a running server repeatedly, and print a text summary of each "
        "response.",
        epilog="The server's parameters, after --ros-args, name the body and the topic of its states.",
    )
    parser.add_argument(
        "situation",
        nargs="?",
        choices=(THROWN_BOX, PUSHED_BLOCK, TRAY),
        default=THROWN_BOX,
        help="scenario, as in the launch file of its name (default: %(default)s)",
    )
    parser.add_argument(
        "--server",
        default="contact_dynamics",
        metavar="NAME",
        help="name of the server, in this node's namespace (default: %(default)s)",
    )
    return parser
