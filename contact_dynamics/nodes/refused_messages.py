"""Counts refused messages about states, and warns of each topic and kind of fault from time to time."""

from __future__ import annotations

import time
from collections import Counter
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Callable

TELL_EVERY_S: Final = 5.0
"""s. Time between two warnings of one kind about one topic. Another topic or another fault has a warning at
once."""


class RefusedMessages:
    """Counts refused messages by topic and kind of fault, and warns of them.

    The throttle of ROS has one clock for each line of code, so one topic's fault would hide all others.
    """

    def __init__(self, tell: Callable[[str], object], *, clock: Callable[[], float] = time.monotonic) -> None:
        """Count from zero. ``tell`` takes a warning, ``clock`` returns seconds."""
        self._tell = tell
        self._clock = clock
        self._counts: Counter[tuple[str, str]] = Counter()
        self._told: dict[tuple[str, str], float] = {}

    def add(self, topic: str, error: Exception) -> None:
        """Count a message that was refused, and warn with the reason, unless it has just warned of it."""
        kind = (topic, f"{type(error).__name__} {getattr(error, 'field', '')}")
        self._counts[kind] += 1
        now = self._clock()
        told = self._told.get(kind)
        if told is not None and now - told < TELL_EVERY_S:
            return
        self._told[kind] = now
        self._tell(f"{topic}: message ignored: {error} ({self._counts[kind]} such so far)")
