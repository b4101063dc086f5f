"""The arguments of `contact-dynamics calibrate`. This file imports what help needs, and no more."""

from __future__ import annotations

import argparse
from pathlib import Path

from contact_dynamics.calibration.free import STANDARD, Free
from contact_dynamics.evaluation.arguments import add_config, add_recordings


def calibrate_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics calibrate`."""
    standard = ", ".join(each.value for each in STANDARD)
    parser = argparse.ArgumentParser(
        prog="contact-dynamics calibrate",
        usage="%(prog)s [options] RECORDING [RECORDING ...]",
        description="Find out friction, restitution, mass centre, inertia and more from recorded tosses "
        "of one body: flights, strikes of single corners and rests. This needs no ROS. "
        "docs/calibrate.md explains every number.",
        epilog="exit code: 0 all went well; 1 the data leave something open, which is said; 2 nothing "
        "could be calibrated, or an argument is wrong",
    )
    add_recordings(parser)
    add_config(parser)
    parser.add_argument("--body", default="", metavar="NAME", help="the body, where recordings show several")
    parser.add_argument(
        "--free",
        type=_groups,
        default=STANDARD,
        metavar="NAME,NAME",
        help=f"what may change: {', '.join(each.value for each in Free)}, or all (default: {standard})",
    )
    parser.add_argument(
        "--no-trajectories",
        action="store_true",
        help="leave out the second way, by whole trajectories, which takes most of the time",
    )
    parser.add_argument("--yaml", type=Path, metavar="FILE", help="parameters for the server, as calibrated")
    parser.add_argument("--json", type=Path, metavar="FILE", help="everything, for programs")
    parser.add_argument(
        "--plots", type=Path, metavar="DIR", help="pictures of residuals and estimates (needs matplotlib)"
    )
    parser.add_argument(
        "--rerun",
        type=Path,
        metavar="FILE.rrd",
        help="strikes side by side, with measured and predicted velocities after them (needs rerun)",
    )
    return parser


def _groups(text: str) -> tuple[Free, ...]:
    if text == "all":
        return tuple(Free)
    known = {each.value: each for each in Free}
    groups = []
    for name in (part.strip() for part in text.split(",")):
        if name not in known:
            raise argparse.ArgumentTypeError(f"must be one of {', '.join(known)}, or all, got {name!r}")
        groups.append(known[name])
    return tuple(groups)
