# SPDX-License-Identifier: Apache-2.0
"""Runs the benchmarks: `python -m benchmarks`, or some of them by name: `python -m benchmarks services`."""

from __future__ import annotations

import argparse
import sys
from importlib import import_module
from pathlib import Path

from benchmarks._quotes import print_beside, write, write_documents
from benchmarks._reliability import redraw


def main() -> int:
    """Run the benchmarks that are asked for, and return the exit code."""
    here = Path(__file__).parent
    names = sorted(path.stem for path in here.glob("*.py") if not path.stem.startswith("_"))
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks", description="Measure speed and accuracy, peers beside us."
    )
    parser.add_argument("names", nargs="*", metavar="name", help=f"which, default all: {', '.join(names)}")
    parser.add_argument(
        "--write",
        action="store_true",
        help="write what was measured into benchmarks/measured.json, and from there into the documents",
    )
    parser.add_argument(
        "--documents",
        action="store_true",
        help="measure nothing; write benchmarks/measured.json into the documents",
    )
    asked = parser.parse_args()
    chosen = asked.names or names
    unknown = sorted(set(chosen) - set(names))
    if unknown:
        parser.error(f"must be one of {', '.join(names)}, got {', '.join(unknown)}")
    if asked.documents:
        write_documents()
        redraw()
        return 0
    lacking = set()
    for name in chosen:
        print(f"\n== {name} ==", flush=True)
        import_module(f"benchmarks.{name}").run()
        print_beside(name)
        if asked.write:
            lacking |= write(name)
    if asked.write:
        write_documents()
        redraw()
    if lacking:
        print(
            f"not written, because documents quote what was not measured: {', '.join(sorted(lacking))}\n"
            "Is every peer of requirements/bench.txt installed, and does CUBE_TOSSES name the recordings?",
            file=sys.stderr,
        )
    return 1 if lacking else 0


sys.exit(main())
