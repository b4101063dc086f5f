# SPDX-License-Identifier: Apache-2.0
"""Lets the time of a log pass as it did: at a rate, with pauses, and with what has to be done meanwhile."""

from __future__ import annotations

import os
import select
import sys
import termios
import time
import tty
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final

from contact_dynamics.constants import NS_PER_S

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

PAUSE: Final = " "
STEP: Final = "."

_STEP_NS: Final = NS_PER_S // 10
_AT_ONCE_S: Final = 1.0 / 200.0  # how long the meanwhile may wait for something to do


class Pacing:
    """The time of a log, which runs beside the machine's own."""

    def __init__(
        self,
        *,
        rate: float,
        is_paused: bool,
        meanwhile: Callable[[int, float], object],
        is_over: Callable[[], bool],
    ) -> None:
        """Set the time to nothing; `begin` starts it.

        Args:
            rate: how many times as fast as the machine's time it runs, > 0.
            is_paused: whether it stands still until somebody presses the space bar.
            meanwhile: a function that is called again and again with the time of the log, ns, and with how
                long it may wait, s.
            is_over: whether to stop.
        """
        self._rate = rate
        self._is_paused = is_paused
        self._meanwhile = meanwhile
        self._is_over = is_over
        self.begin(0)

    @property
    def now_ns(self) -> int:
        """The time of the log now, ns."""
        if self._is_paused:
            return self._log_ns
        return self._log_ns + round((time.monotonic() - self._since_s) * self._rate * NS_PER_S)

    def begin(self, log_ns: int) -> None:
        """Set the time of the log."""
        self._log_ns, self._since_s, self._since_ns = log_ns, time.monotonic(), time.time_ns()

    def present_of(self, log_ns: int) -> int:
        """Return when a time of the log is now, ns since the epoch by the machine's clock.

        What is at one time in the log stays at one time, such as a pose and its twist.
        """
        return self._since_ns + round((log_ns - self._log_ns) / self._rate)

    def wait_until(self, log_ns: int) -> bool:
        """Let time pass until it is that time of the log; return False where it was told to stop before."""
        while not self._is_over():
            self._read_keys()
            now_ns = self.now_ns
            left_s = (log_ns - now_ns) / (self._rate * NS_PER_S)
            if left_s <= 0.0:
                self._meanwhile(now_ns, 0.0)
                return True
            self._meanwhile(now_ns, min(_AT_ONCE_S, left_s))
        return False

    def _read_keys(self) -> None:
        while sys.stdin.isatty() and select.select([sys.stdin], [], [], 0.0)[0]:
            key = os.read(sys.stdin.fileno(), 1).decode(errors="replace")  # select sees what is left
            now_ns = self.now_ns
            if key == PAUSE:
                self._is_paused = not self._is_paused
                self.begin(now_ns)
            elif key == STEP and self._is_paused:
                self.begin(now_ns + _STEP_NS)
            elif not key:
                return


@contextmanager
def single_keys() -> Iterator[None]:
    """Let each key come at once, without the return key, where a terminal is at the standard input."""
    if not sys.stdin.isatty():
        yield
        return
    before = termios.tcgetattr(sys.stdin)
    tty.setcbreak(sys.stdin, termios.TCSADRAIN)  # keys that were pressed before count too
    try:
        yield
    finally:
        termios.tcsetattr(sys.stdin, termios.TCSADRAIN, before)
