"""Runs the benchmarks: `python -m benchmarks`, or some of them by name: `python -m benchmarks services`."""

from __future__ import annotations

import argparse
import sys
from importlib import import_module
from pathlib import Path


def main() -> int:
    """Run the benchmarks that are asked for; return the exit code."""
    here = Path(__file__).parent
    names = sorted(path.stem for path in here.glob("*.py") if not path.stem.startswith("_"))
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks", description="Measure speed and accuracy, peers beside us."
    )
    parser.add_argument("names", nargs="*", metavar="name", help=f"which, default all: {', '.join(names)}")
    chosen = parser.parse_args().names or names
    unknown = sorted(set(chosen) - set(names))
    if unknown:
        parser.error(f"found {', '.join(unknown)}, allowed are {', '.join(names)}")
    for name in chosen:
        print(f"\n== {name} ==", flush=True)
        import_module(f"benchmarks.{name}").run()
    return 0


sys.exit(main())
