"""Messages of states that are refused: counted, and told for each topic and kind of fault, not too often."""

from __future__ import annotations

import time
from collections import Counter
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Callable

TELL_EVERY_S: Final = 5.0
"""s between two warnings of one kind about one topic. Another topic, or another fault, is told at once."""


class RefusedMessages:
    """Counts refused messages by topic and kind of fault, and tells of them.

    The throttle of ROS is one for each line of code: there, one topic's fault would hide all others.
    """

    def __init__(self, tell: Callable[[str], object], *, clock: Callable[[], float] = time.monotonic) -> None:
        """Count from zero; ``tell`` takes a warning, ``clock`` returns seconds."""
        self._tell = tell
        self._clock = clock
        self._counts: Counter[tuple[str, str]] = Counter()
        self._told: dict[tuple[str, str], float] = {}

    def add(self, topic: str, error: Exception) -> None:
        """Count a message that was refused, and tell why, unless the same was told a moment ago."""
        kind = (topic, f"{type(error).__name__} {getattr(error, 'field', '')}")
        self._counts[kind] += 1
        now = self._clock()
        told = self._told.get(kind)
        if told is not None and now - told < TELL_EVERY_S:
            return
        self._told[kind] = now
        self._tell(f"{topic}: message ignored: {error} ({self._counts[kind]} such so far)")
