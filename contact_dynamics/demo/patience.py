# SPDX-License-Identifier: Apache-2.0
"""A time limit for waiting that does not expire while the process itself is suspended.

After a suspension, the awaited message may be in a queue, not yet read. Therefore the time between two calls
of `look` counts only up to a maximum.
"""

from __future__ import annotations

import time
from typing import Final

MAX_OF_A_LOOK_S: Final = 0.2
"""Longest time counted between two calls, s. While running, they are at most 0.1 s apart."""


class Patience:
    """The remaining time to wait."""

    def __init__(self, seconds: float) -> None:
        """Start waiting for at most this time, s."""
        self._left = seconds
        self._looked = time.monotonic()

    @property
    def is_over(self) -> bool:
        """Whether the time is over."""
        return self._left <= 0.0

    def look(self) -> None:
        """Count the time since the last call, because the awaited event has not happened."""
        now = time.monotonic()
        self._left -= min(now - self._looked, MAX_OF_A_LOOK_S)
        self._looked = now
