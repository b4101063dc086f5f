# SPDX-License-Identifier: Apache-2.0
"""Limits the work of searches for contacts, by steps and not by time, so that a question ends alike."""

from __future__ import annotations

from typing import Final

from contact_dynamics.errors import TooLargeError

MAX_SEARCH_STEPS: Final = 50_000
"""Largest number of steps of all searches of one question, which take some 2 s. A toss takes ten to a
hundred, and a turn close to a surface takes some thirty."""

SEARCH_BEGUN: Final = 5
"""The setting up of a search counts as this many steps."""

OBSTACLE_STEP: Final = 25
"""A step beside an obstacle counts as this many, because it finds the plane that separates best anew."""


class SearchWork:
    """Counts the steps of one or several searches, and ends them if there are too many."""

    def __init__(self, field: str = "horizon") -> None:
        """Begin to count. ``field`` is the caller's name of the time to search."""
        self._field = field
        self._spent = 0

    def spend(self, steps: int, seconds: float) -> None:
        """Count steps that search at a time, s.

        Raises:
            TooLargeError: there are more steps than allowed.
        """
        self._spent += steps
        if self._spent > MAX_SEARCH_STEPS:
            raise TooLargeError(
                self._field,
                f"more than {MAX_SEARCH_STEPS} steps of the search, the last of them at {seconds:.9g} s",
                "a shorter time, a slower spin, a smaller body, longer steps or fewer contacts",
            )
