"""A line on the terminal that says how far a reading is, where somebody watches."""

from __future__ import annotations

import sys
import time
from typing import Final

_TELL_EVERY_S: Final = 0.5
_BAR: Final = 24  # characters


class Progress:
    """How far one log is. The line is cleared at the end."""

    def __init__(self, name: str, *, start_ns: int, end_ns: int) -> None:
        """Begin.

        Args:
            name: what is read.
            start_ns: the log time at which it begins, ns.
            end_ns: the log time at which it ends, ns. Not later than the beginning: it is not known.
        """
        self._name = name
        self._start_ns = start_ns
        self._length_ns = end_ns - start_ns
        self._watched = sys.stderr.isatty()
        self._next = time.monotonic() + _TELL_EVERY_S
        self._told = False

    def tell(self, log_time_ns: int, what: str) -> None:
        """Show that the reading has come to a log time, and what was read, in words."""
        if not self._watched or time.monotonic() < self._next:
            return
        self._next = time.monotonic() + _TELL_EVERY_S
        self._told = True
        print(f"\r\033[K{self._name}: {self._bar(log_time_ns)}{what}", end="", file=sys.stderr, flush=True)

    def end(self) -> None:
        """Clear the line."""
        if self._told:
            print("\r\033[K", end="", file=sys.stderr, flush=True)

    def _bar(self, log_time_ns: int) -> str:
        if self._length_ns <= 0:
            return ""
        share = min(1.0, max(0.0, (log_time_ns - self._start_ns) / self._length_ns))
        return f"{'#' * round(share * _BAR):{_BAR}} {100 * share:3.0f} %, "
