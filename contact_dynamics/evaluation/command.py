# SPDX-License-Identifier: Apache-2.0
"""What `contact-dynamics evaluate` and `contact-dynamics calibrate` do alike with their arguments."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Final

from contact_dynamics.errors import ContactDynamicsError

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable
    from pathlib import Path

NOTHING: Final = 2
"""This exit code says that no recording was of use, or that an argument is wrong."""


def run_on_recordings(
    parser: argparse.ArgumentParser, arguments: list[str], work: Callable[[argparse.Namespace], int]
) -> int:
    """Parse arguments that name recordings, do the work, and return the exit code. Errors are printed."""
    given = parser.parse_args(arguments)
    if not given.recordings:  # here, so that a mistyped option is named first
        parser.error("at least one RECORDING is required")
    try:
        return work(given)
    except (ContactDynamicsError, OSError) as error:
        print(f"{parser.prog}: {error}", file=sys.stderr)
        return NOTHING


def check_writable(*files: Path | None) -> None:
    """Find out before the long work whether the files that are asked for can be written.

    Raises:
        OSError: a file cannot be written.
    """
    for path in files:
        if path is not None:
            with path.open("ab"):
                pass
