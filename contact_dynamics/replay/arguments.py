"""The arguments of `contact-dynamics replay`."""

from __future__ import annotations

import argparse


def replay_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics replay`."""
    parser = argparse.ArgumentParser(
        prog="contact-dynamics replay",
        description="Ask every logged question again, with the states that were logged, and compare the "
        "answers. This needs the logs alone, no ROS.",
        epilog="The exit code is 0 if all answers are as logged, 1 if an answer differs or a call cannot be "
        "read, and 2 if a file is no log of the server.",
    )
    parser.add_argument(
        "logs", nargs="*", metavar="LOG", help="folder of a log of the server, or its .mcap file"
    )
    parser.add_argument(
        "--tolerance",
        type=_tolerance,
        default=0.0,
        metavar="T",
        help="how much a number may differ, relative to the larger of the two, or to 1 if both are smaller "
        "(default: 0, so that every bit counts)",
    )
    return parser


def _tolerance(text: str) -> float:
    value = float(text)
    if not 0.0 <= value < float("inf"):
        raise argparse.ArgumentTypeError(f"found {text}, allowed is a number >= 0")
    return value
