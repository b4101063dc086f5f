# SPDX-License-Identifier: Apache-2.0
"""A limit of the time that is spent waiting, in which a process that stood still has not waited.

After a stall the clock has gone on, and what is waited for lies unread in a queue. So each look counts for a
moment at most.
"""

from __future__ import annotations

import time
from typing import Final

MAX_OF_A_LOOK_S: Final = 0.2
"""s. One look counts no longer; between two looks there is at most the time of a wait for messages, 0.1 s."""


class Patience:
    """Time that is left to wait, which each look lessens."""

    def __init__(self, seconds: float) -> None:
        """Begin to wait for at most this time, s."""
        self._left = seconds
        self._looked = time.monotonic()

    @property
    def is_over(self) -> bool:
        """Whether the whole time was spent waiting."""
        return self._left <= 0.0

    def look(self) -> None:
        """Note that nothing has come yet."""
        now = time.monotonic()
        self._left -= min(now - self._looked, MAX_OF_A_LOOK_S)
        self._looked = now
