"""The command `contact-dynamics replay` asks logs again, one after the other, and prints a table for each."""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Final

from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.replay.arguments import replay_parser
from contact_dynamics.replay.report import report
from contact_dynamics.replay.verify import verify_log

DIFFERENT: Final = 1
"""This exit code says that an answer differs, or that a call cannot be read."""

NO_LOG: Final = 2
"""This exit code says that a file cannot be replayed at all."""

_TELL_EVERY_S: Final = 1.0


def main(arguments: list[str]) -> int:
    """Replay each log and return the exit code."""
    parser = replay_parser()
    given = parser.parse_args(arguments)
    if not given.logs:  # argparse would complain of this before it complains of a mistyped option
        parser.error("found no LOG, needed is one at least")
    worst = 0
    for name in given.logs:
        progress = _Progress(name)
        try:
            found = verify_log(Path(name), tolerance=given.tolerance, on_progress=progress.tell)
        except (ContactDynamicsError, OSError) as error:
            progress.end()
            print(f"contact-dynamics replay: {error}", file=sys.stderr)
            worst = NO_LOG
            continue
        progress.end()
        print(report(found), flush=True)
        worst = max(worst, 0 if found.agrees else DIFFERENT)
    return worst


class _Progress:
    """A line on the terminal that says once a second how much of the log has been read."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._watched = sys.stderr.isatty()
        self._next = time.monotonic() + _TELL_EVERY_S
        self._told = False

    def tell(self, states: int, questions: int) -> None:
        """Show how many states were taken and how many questions asked."""
        if not self._watched or time.monotonic() < self._next:
            return
        self._next = time.monotonic() + _TELL_EVERY_S
        self._told = True
        line = f"\r{self._name}: {states} states, {questions} questions"
        print(line, end="", file=sys.stderr, flush=True)

    def end(self) -> None:
        """Clear the line."""
        if self._told:
            print("\r\033[K", end="", file=sys.stderr, flush=True)
