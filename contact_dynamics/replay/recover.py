# SPDX-License-Identifier: Apache-2.0
"""The command `contact-dynamics recover`, which rewrites a damaged log so that every reader accepts it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Final

from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.recording.recovery import recover
from contact_dynamics.replay.arguments import recover_parser
from contact_dynamics.replay.progress import Progress

REFUSED: Final = 2  # exit code if nothing was written


def main(arguments: list[str]) -> int:
    """Rewrite a log and return the exit code."""
    parser = recover_parser()
    given = parser.parse_args(arguments)
    if given.log is None:  # argparse would report this before a mistyped option
        parser.error("a LOG is required")
    path = Path(given.log)
    named = path.resolve() if path.name in {"", ".."} else path  # . and .. are no names
    folder = (
        Path(given.output) if given.output else named.with_name(f"{named.name.partition('.')[0]}_recovered")
    )
    progress = Progress(str(path))
    try:
        messages, losses = recover(
            path, folder, on_progress=lambda count: progress.tell(count, f"{count} messages")
        )
    except (ContactDynamicsError, OSError) as error:
        print(f"contact-dynamics recover: {error}", file=sys.stderr)
        return REFUSED
    finally:
        progress.end()
    print(f"{folder}: {messages} messages")
    for loss in losses:
        print(f"  lost of {loss.path}: {loss}")
    return 0
