"""What became of the states of a body that came, where a question finds none of them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(slots=True, kw_only=True)
class Arrivals:
    """The states of one body since the beginning, kept or not.

    Attributes:
        came: How many came.
        rejected: How many of them were rejected, some of which were kept unread before.
        old: How many were too old for a question about now when they came.
        age: s. How old the last of these was.
        reason: Why the last one that was rejected was, in words.
        newest_is_rejected: Whether none was kept since.
        fate: What happened to those that are not kept, or to the last of them, in words.
    """

    came: int = 0
    rejected: int = 0
    old: int = 0
    age: float = 0.0
    reason: str = ""
    newest_is_rejected: bool = False
    fate: str = "they could not be read"

    def __str__(self) -> str:
        """Return in words why there is no state."""
        if not self.came:
            return "none was published yet"
        return f"none of {self.came} messages was kept: {self.fate}"

    def keep(self) -> None:
        """Note a state that came and is kept."""
        self.came += 1
        self.newest_is_rejected = False

    def refuse(self, reason: object, *, was_kept: bool) -> None:
        """Note a state that came and was not kept, or that was counted and kept, and cannot be read."""
        self.came += not was_kept
        self.rejected += 1
        self.reason = str(reason)
        self.newest_is_rejected = True
        self.fate = f"the last was rejected because {reason}"

    def throw_away(self, reason: str) -> None:
        """Note that states that were kept are not any more."""
        self.fate = f"they were discarded when {reason}"
