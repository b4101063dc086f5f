"""The arguments of the demo's verbs. They are in a file of their own, so that `--help` needs no ROS."""

from __future__ import annotations

import argparse
from typing import Final

from contact_dynamics.measured.read_toss import DEFAULT_RECORDING

THROWN_BOX: Final = "thrown_box"
PUSHED_BLOCK: Final = "pushed_block"
TRAY: Final = "tray"
"""The situations that the examples show. Each has a launch file of its name."""

_RECORDING = "recording: a .csv like the package's own (the default), or measured cube tosses, .npz#INDEX"


def demo_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics demo`."""
    parser = argparse.ArgumentParser(
        prog="contact-dynamics demo",
        description="Play a recorded toss, ask the server about it, and compare with measurements.",
        epilog="The nodes of the examples have --help too: toss_publisher, block_publisher, commentator.",
    )
    parser.add_argument("--toss", default=str(DEFAULT_RECORDING), metavar="PATH", help=_RECORDING)
    parser.add_argument("--view", action="store_true", help="open rerun's viewer and watch live")
    parser.add_argument(
        "--output",
        default="demo_output",
        metavar="DIR",
        help="folder for the folder of this run (default: %(default)s)",
    )
    parser.add_argument("--quiet", action="store_true", help="print no table")
    return parser


def toss_publisher_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics toss_publisher`."""
    parser = argparse.ArgumentParser(
        prog="contact-dynamics toss_publisher", description="Publish a recorded toss as a body's states."
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
        description="Publish the states of a block that a finger pushes, or whose tray tilts.",
        epilog="The server's parameters describe the block and what it stands on. They follow --ros-args.",
    )
    parser.add_argument(
        "situation",
        nargs="?",
        choices=(PUSHED_BLOCK, TRAY),
        default=PUSHED_BLOCK,
        help="what happens to the block (default: %(default)s)",
    )
    numbers = {
        "--height": (0.03, "M", "height at which the finger pushes"),
        "--rate": (1.0, "N/S", "how fast the push grows"),
        "--tilt": (25.0, "DEGREES", "how far the tray tilts"),
        "--degrees-per-second": (3.0, "DEGREES", "how fast the tray tilts"),
        "--seconds": (15.0, "S", "how long to publish"),
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
        description="Ask a running server about a body again and again, and print the answers in words.",
        epilog="The server's parameters name the body and the topic of its states. They follow --ros-args.",
    )
    parser.add_argument(
        "situation",
        nargs="?",
        choices=(THROWN_BOX, PUSHED_BLOCK, TRAY),
        default=THROWN_BOX,
        help="what to ask about, as it is launched (default: %(default)s)",
    )
    parser.add_argument(
        "--server",
        default="contact_dynamics",
        metavar="NAME",
        help="name of the server, in this node's namespace (default: %(default)s)",
    )
    return parser
