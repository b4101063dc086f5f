"""Joins two topics whose messages of one stamp make a state together."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Generic, Protocol, TypeVar

from msg_adapters.stamps import stamp_ns_from_msg

if TYPE_CHECKING:
    from collections.abc import Callable

    from std_msgs.msg import Header

    from contact_dynamics.questions.uncertain_state import KnownState


class Stamped(Protocol):
    """A message with a header."""

    header: Header


First = TypeVar("First", bound=Stamped)
Second = TypeVar("Second", bound=Stamped)

MAX_UNPAIRED: Final = 100
"""Messages that wait for the other one of their stamp. Then the other topic is silent, and the oldest go."""


class Pairs(Generic[First, Second]):
    """Joins the two messages of one stamp, whichever comes first."""

    def __init__(self, join: Callable[[First, Second], KnownState]) -> None:
        """Begin without messages; ``join`` makes a state of a message of each topic."""
        self._join = join
        self._first: dict[int, First] = {}
        self._second: dict[int, Second] = {}

    def first(self, msg: First) -> KnownState | None:
        """Take a message of the first topic."""
        other = _partner(msg, self._first, self._second)
        return None if other is None else self._join(msg, other)

    def second(self, msg: Second) -> KnownState | None:
        """Take a message of the second topic."""
        other = _partner(msg, self._second, self._first)
        return None if other is None else self._join(other, msg)


def _partner(msg: First, mine: dict[int, First], others: dict[int, Second]) -> Second | None:
    """Return the message of the same stamp that waits, or let this one wait."""
    stamp_ns = stamp_ns_from_msg(msg.header.stamp)
    partner = others.pop(stamp_ns, None)
    if partner is None:
        mine[stamp_ns] = msg
        if len(mine) > MAX_UNPAIRED:
            del mine[next(iter(mine))]
    return partner
