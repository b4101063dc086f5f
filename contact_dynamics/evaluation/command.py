# SPDX-License-Identifier: Apache-2.0
"""Shared parts of the commands `contact-dynamics evaluate` and `contact-dynamics calibrate`."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Final

from contact_dynamics.errors import ContactDynamicsError

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable
    from pathlib import Path

NOTHING: Final = 2  # exit code if no recording could be used, or an argument is invalid


def run_on_recordings(
    parser: argparse.ArgumentParser, arguments: list[str], work: Callable[[argparse.Namespace], int]
) -> int:
    """Parse the arguments, call ``work``, and return the exit code. Errors are printed."""
    given = parser.parse_args(arguments)
    if not given.recordings:  # not by argparse, so that a mistyped option is reported first
        parser.error("at least one RECORDING is required")
    try:
        return work(given)
    except (ContactDynamicsError, OSError) as error:
        print(f"{parser.prog}: {error}", file=sys.stderr)
        return NOTHING


def check_writable(*files: Path | None) -> None:
    """Check that the output files can be written, before the evaluation starts.

    Raises:
        OSError: a file cannot be written.
    """
    for path in files:
        if path is not None:
            with path.open("ab"):
                pass
