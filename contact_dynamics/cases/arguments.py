# SPDX-License-Identifier: Apache-2.0
"""The arguments of `contact-dynamics cases`."""

from __future__ import annotations

import argparse

from contact_dynamics.cases.engine import PEERS


def cases_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics cases`."""
    parser = argparse.ArgumentParser(
        prog="contact-dynamics cases",
        description="Solve problems with known exact answers. The table lists the exact answer, the "
        "answer of this package and, if MuJoCo is installed, the result of its simulation.",
        epilog="The exit code is 0 if all answers of this package are exact within their tolerances, and 1 "
        "otherwise.",
    )
    published = "compare with published numbers instead, and print their sources"
    without = "skip the simulations, which take most of the time"
    parser.add_argument("names", nargs="*", metavar="NAME", help="cases to solve (default: all)")
    parser.add_argument("--list", action="store_true", help="list the names and titles of the cases")
    parser.add_argument("--published", action="store_true", help=published)
    for peer in PEERS:
        parser.add_argument(f"--without-{peer.package}", action="store_true", help=without)
    return parser
