"""The arguments of `contact-dynamics replay`."""

from __future__ import annotations

import argparse


def replay_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics replay`."""
    parser = argparse.ArgumentParser(
        prog="contact-dynamics replay",
        description="Ask every logged question again, with the states that were logged, and compare the "
        "answers. This needs the logs alone, no ROS.",
        epilog="exit code: 0 all answers are as logged; 1 an answer differs, or a call cannot be read; "
        "2 a log is none of the server",
    )
    parser.add_argument(
        "logs", nargs="*", metavar="LOG", help="folder of a log of the server, or its .mcap file"
    )
    parser.add_argument(
        "--tolerance",
        type=_tolerance,
        default=0.0,
        metavar="T",
        help="what a number may differ by, in parts of the larger of the two or of 1, whichever is more "
        "(default: nothing, to the last bit)",
    )
    return parser


def _tolerance(text: str) -> float:
    value = float(text)
    if not 0.0 <= value < float("inf"):
        raise argparse.ArgumentTypeError(f"found {text}, allowed is a number >= 0")
    return value
