"""How much work a search for a contact may take: counted in steps, so that the same question ends alike."""

from __future__ import annotations

from typing import Final

from contact_dynamics.errors import TooLargeError

MOST_SEARCH_STEPS: Final = 50_000
"""Steps of all searches of one question, some 2 s of computing. A toss takes ten to a hundred, a turn close
to a surface some thirty."""

SEARCH_BEGUN: Final = 5
"""Steps that a search counts for before its first one: what it takes to set it up."""

OBSTACLE_STEP: Final = 25
"""Steps that one beside an obstacle counts for, where the plane that separates best is found anew."""


class SearchWork:
    """Counts the steps of one or several searches, and ends them where they are too many."""

    def __init__(self, field: str = "horizon", *, most: int = MOST_SEARCH_STEPS) -> None:
        """Begin to count; ``field`` is what the caller calls the time to search."""
        self._field = field
        self._most = most
        self._spent = 0

    def spend(self, steps: int, seconds: float) -> None:
        """Count steps that are taken at a time, s.

        Raises:
            TooLargeError: they are more than allowed.
        """
        self._spent += steps
        if self._spent > self._most:
            raise TooLargeError(
                self._field,
                f"more than {self._most} steps of the search, the last of them at {seconds:.9g} s",
                "a shorter time, a slower spin, a smaller body, longer steps or fewer contacts",
            )
