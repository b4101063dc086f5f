# SPDX-License-Identifier: Apache-2.0
"""The arguments of `contact-dynamics calibrate`. This file imports only what `--help` needs."""

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
        description="Estimate friction, restitution, centre of mass, inertia and more from recorded "
        "tosses of one body. ROS is not required. docs/calibrate.md explains the results.",
        epilog="The exit code is 0 on success, 1 if a parameter remains undetermined or the report names "
        "a problem, and 2 if nothing could be estimated or an argument is invalid.",
    )
    add_recordings(parser)
    add_config(parser)
    parser.add_argument(
        "--body", default="", metavar="NAME", help="body to calibrate, if recordings contain several"
    )
    parser.add_argument(
        "--free",
        type=_groups,
        metavar="NAME,NAME",
        help=f"parameters to estimate: {', '.join(each.value for each in Free)}, or all (default: "
        f"{standard})",
    )
    parser.add_argument(
        "--no-trajectories",
        action="store_true",
        help="skip the second estimate, from whole trajectories, which takes most of the time",
    )
    parser.add_argument("--yaml", type=Path, metavar="FILE", help="calibrated parameters for the server")
    parser.add_argument("--json", type=Path, metavar="FILE", help="the complete result")
    parser.add_argument(
        "--plots", type=Path, metavar="DIR", help="plots of residuals and estimates (requires Matplotlib)"
    )
    parser.add_argument(
        "--rerun",
        type=Path,
        metavar="FILE.rrd",
        help="impacts with the measured and predicted velocities after them (requires rerun)",
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
