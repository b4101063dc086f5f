# SPDX-License-Identifier: Apache-2.0
"""Shows the progress of long work in a line on an interactive terminal."""

from __future__ import annotations

import sys
import time
from typing import Final

_TELL_EVERY_S: Final = 0.5
_BAR: Final = 24  # characters


class Progress:
    """Progress of one task. The line is cleared at the end."""

    def __init__(self, name: str, *, begin: float = 0.0, end: float = 0.0) -> None:
        """Begin a task from ``begin`` to ``end``, in any unit, such as log times or numbers of logs.

        The end is unknown unless it is larger than the beginning.
        """
        self._name = name
        self._begin = begin
        self._length = end - begin
        self._watched = sys.stderr.isatty()
        self._begun_s = time.monotonic()
        self._next_s = self._begun_s + _TELL_EVERY_S
        self._told = False

    def tell(self, at: float, what: str) -> None:
        """Show the position, in the unit of the beginning, and a description of the work."""
        now_s = time.monotonic()
        if not self._watched or now_s < self._next_s:
            return
        self._next_s = now_s + _TELL_EVERY_S
        self._told = True
        bar = self._bar(at, now_s - self._begun_s)
        print(f"\r\033[K{self._name}: {bar}{what}", end="", file=sys.stderr, flush=True)

    def end(self) -> None:
        """Clear the line."""
        if self._told:
            print("\r\033[K", end="", file=sys.stderr, flush=True)

    def _bar(self, at: float, worked_s: float) -> str:
        if self._length <= 0:
            return ""
        share = min(1.0, max(0.0, (at - self._begin) / self._length))
        left = f", {worked_s * (1.0 - share) / share:.0f} s left" if share > 0.0 else ""
        return f"{'#' * round(share * _BAR):{_BAR}} {100 * share:3.0f} %{left}, "
