"""A line that tells how far a long evaluation is, where somebody watches."""

from __future__ import annotations

import sys
import time
from typing import Final

TELL_EVERY_S: Final = 0.5
"""s between two lines."""

_WIDTH: Final = 30  # letters of the bar


class Progress:
    """A bar on the terminal's last line, cleared at the end."""

    def __init__(self, total: int) -> None:
        """Begin with nothing done of ``total`` recordings."""
        self._total = total
        self._done = 0
        self._begun = time.monotonic()
        self._watched = sys.stderr.isatty()
        self._next = self._begun
        self._told = False

    def tell(self, name: str) -> None:
        """Count one more as done, and show its name."""
        self._done += 1
        now = time.monotonic()
        if not self._watched or now < self._next:
            return
        self._next = now + TELL_EVERY_S
        self._told = True
        share = self._done / self._total
        bar = "#" * round(share * _WIDTH)
        left = (now - self._begun) * (1.0 - share) / share
        line = f"\r\033[K[{bar:<{_WIDTH}}] {self._done} of {self._total}, {left:.0f} s left: {name[-60:]}"
        print(line, end="", file=sys.stderr, flush=True)

    def end(self) -> None:
        """Clear the line."""
        if self._told:
            print("\r\033[K", end="", file=sys.stderr, flush=True)
