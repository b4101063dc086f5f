"""The arguments of the demo's verbs. They are in a file of their own, so that `--help` needs no ROS."""

from __future__ import annotations

import argparse

from contact_dynamics.measured.read_toss import DEFAULT_RECORDING

_RECORDING = "recording: a .csv like the package's own (the default), or measured cube tosses, .npz#INDEX"


def demo_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics demo`."""
    parser = argparse.ArgumentParser(
        prog="contact-dynamics demo",
        description="Play a recorded toss, ask the server about it, compare with what was measured.",
    )
    parser.add_argument("--toss", default=str(DEFAULT_RECORDING), metavar="PATH", help=_RECORDING)
    parser.add_argument("--view", action="store_true", help="open rerun's viewer and watch live")
    parser.add_argument(
        "--output",
        default="demo_output",
        metavar="FOLDER",
        help="where the run's folder goes (default: %(default)s)",
    )
    parser.add_argument("--quiet", action="store_true", help="no table")
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
        help="wait for so many subscriptions (default: %(default)s)",
    )
    return parser
