"""The pace at which states are drawn: often while that is cheap, less often where many bodies make it dear.

A batch of states costs about what a single state does. So fewer and larger batches show the same states for
less, only later.
"""

from __future__ import annotations

import time
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator

SHORTEST_S: Final = 0.05
"""s. The time between two drawings of states while they are cheap."""

LONGEST_S: Final = 0.5
"""s. The time between two drawings of states however dear they are."""

SHARE: Final = 0.2
"""The share of one processor that the drawing of states takes, unless the longest time is too short."""


class Pace:
    """When the states that have come are to be drawn.

    Attributes:
        wait_s: How long after the last drawing the next one is due, s.
    """

    def __init__(self) -> None:
        """Begin with a drawing that is due."""
        self.wait_s = SHORTEST_S
        self._drawn = float("-inf")

    @property
    def is_due(self) -> bool:
        """Whether states are to be drawn now, by who asks this once in each shortest time."""
        return time.monotonic() >= self._drawn + self.wait_s - 0.5 * SHORTEST_S

    @contextmanager
    def drawing(self) -> Iterator[None]:
        """Draw in the block, whose processor time says when the next drawing is due."""
        self._drawn = time.monotonic()
        began = time.thread_time()
        try:
            yield
        finally:
            self.wait_s = wait_after(time.thread_time() - began)


def wait_after(seconds: float) -> float:
    """Return the time from one drawing to the next, s, if each takes so much processor time, s."""
    return min(max(seconds / SHARE, SHORTEST_S), LONGEST_S)
