# SPDX-License-Identifier: Apache-2.0
"""The arguments of `contact-dynamics monitor`. This file imports only what `--help` needs."""

from __future__ import annotations

import argparse
from pathlib import Path

from contact_dynamics.evaluation.arguments import add_calibration, add_config, add_recordings


def monitor_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics monitor`."""
    parser = argparse.ArgumentParser(
        prog="contact-dynamics monitor",
        usage="%(prog)s [options] RECORDING [RECORDING ...]",
        description="Predict each event of recordings from the states before it, and report events outside "
        "of their prediction regions and changes of friction and restitution. ROS is not required. "
        "docs/monitor.md explains the results.",
        epilog="The exit code is 0 if no change is detected, 1 if one is or a recording could not be read, "
        "and 2 if nothing was monitored or an argument is invalid.",
    )
    add_recordings(parser)
    add_config(parser)
    add_calibration(parser)
    parser.add_argument("--json", type=Path, metavar="FILE", help="one JSON object per line for each event")
    return parser
