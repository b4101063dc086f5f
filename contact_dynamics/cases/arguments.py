"""The arguments of `contact-dynamics cases`."""

from __future__ import annotations

import argparse

from contact_dynamics.cases.engine import PEERS


def cases_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics cases`."""
    parser = argparse.ArgumentParser(
        prog="contact-dynamics cases",
        description="Ask questions whose exact answers are known. The table has the exact answer, the "
        "package's and that of MuJoCo, which is simulated in the same run if it is installed.",
        epilog="The exit code is 0 if all of the package's answers are exact within their tolerances, and 1 "
        "if one is not.",
    )
    published = "compare with numbers that others published, each with its source, instead"
    without = "leave out the simulations; the rest takes a second"
    parser.add_argument("names", nargs="*", metavar="NAME", help="cases to ask (default: all)")
    parser.add_argument("--list", action="store_true", help="print names and questions, and ask nothing")
    parser.add_argument("--published", action="store_true", help=published)
    for peer in PEERS:
        parser.add_argument(f"--without-{peer.package}", action="store_true", help=without)
    return parser
