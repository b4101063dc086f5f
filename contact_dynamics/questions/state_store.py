"""Keeps the published states of each body for as long as questions about the past are answered."""

from __future__ import annotations

from bisect import bisect_left, bisect_right, insort
from typing import TYPE_CHECKING, Final

from contact_dynamics.constants import to_ns, to_seconds
from contact_dynamics.errors import InvalidFieldError, NoStateError, StaleStateError

if TYPE_CHECKING:
    from contact_dynamics.rigid_body.body import BodyState

FUTURE_TOLERANCE: Final = 0.5
"""s. By default a stamp may be ahead of the clock by this much. The clocks of two machines that NTP keeps
differ by far less."""


class StateStore:
    """Published states by body, sorted by their stamps. When new ones come, those beyond the history go."""

    def __init__(self, *, history: float, timeout: float, future_tolerance: float = FUTURE_TOLERANCE) -> None:
        """Begin without states.

        Args:
            history: s, for how long states are kept.
            timeout: s. A state that is older when it is asked about is refused.
            future_tolerance: s. A state whose stamp is farther ahead of the clock is refused.
        """
        self._history = history
        self._history_ns = to_ns(history)
        self._timeout_ns = to_ns(timeout)
        self._future_tolerance_ns = to_ns(future_tolerance)
        self._states: dict[str, list[BodyState]] = {}

    def add(self, body_name: str, state: BodyState, *, now_ns: int | None = None) -> None:
        """Keep a state. ``now_ns`` is the present time, ns. Without it, any stamp is accepted.

        Raises:
            InvalidFieldError: its stamp is ahead of the present time by more than the tolerance. Such a state
                would stay the newest until the clock came to it.
        """
        if now_ns is not None:
            ahead_ns = state.stamp_ns - now_ns
            if ahead_ns > self._future_tolerance_ns:
                raise InvalidFieldError(
                    "stamp",
                    f"{to_seconds(ahead_ns):.3f} s ahead of the clock",
                    f"at most {to_seconds(self._future_tolerance_ns):g} s (future_tolerance)",
                )
            self._forget_future(body_name, now_ns)
        states = self._states.setdefault(body_name, [])
        insort(states, state, key=_stamp)
        oldest = states[-1].stamp_ns - self._history_ns
        if states[0].stamp_ns < oldest:
            del states[: bisect_right(states, oldest - 1, key=_stamp)]

    def clear(self) -> None:
        """Forget all states, as when the clock is set back and their stamps become times to come."""
        self._states.clear()

    def newest(self, body_name: str, *, now_ns: int | None = None) -> BodyState:
        """Return the newest state. Without the present time, ns, it may be of any age.

        Raises:
            NoStateError: none was published yet.
            StaleStateError: it is older than the timeout.
        """
        if now_ns is not None:
            self._forget_future(body_name, now_ns)
        states = self._states.get(body_name)
        if not states:
            message = f"state of {body_name!r}: none was published yet"
            raise NoStateError(message)
        return states[-1] if now_ns is None else self._fresh(body_name, states[-1], now_ns)

    def window(self, body_name: str, newest: BodyState, seconds: float) -> list[BodyState]:
        """Return the states of the last ``seconds`` up to ``newest``, by time, and one for each stamp."""
        states = self._states.get(body_name, [])
        # No more than the history is kept, so a longer window is as long as the history.
        first = bisect_left(states, newest.stamp_ns - to_ns(min(seconds, self._history)), key=_stamp)
        last = bisect_right(states, newest.stamp_ns, key=_stamp)
        return list({state.stamp_ns: state for state in states[first:last]}.values())

    def around(
        self, body_name: str, stamp_ns: int, *, now_ns: int | None = None
    ) -> tuple[BodyState, BodyState | None]:
        """Return the newest state with at most that stamp, and the one after it.

        The one after it is None if the state has that stamp itself, or is the newest.

        Raises:
            NoStateError: every state that is kept has a later stamp.
            StaleStateError: the stamp is between two states that are further apart than the timeout, or after
                the newest, and that is older than the timeout at the present time, ``now_ns``.
        """
        if now_ns is not None:
            self._forget_future(body_name, now_ns)
        states = self._states.get(body_name, [])
        index = bisect_right(states, stamp_ns, key=_stamp)
        if index == 0:
            kept = f"the oldest kept has {states[0].stamp_ns} ns" if states else "none was published yet"
            message = f"state of {body_name!r} at {stamp_ns} ns: {kept}"
            raise NoStateError(message)
        earlier = states[index - 1]
        if earlier.stamp_ns == stamp_ns:
            return earlier, None
        if index == len(states):
            return earlier if now_ns is None else self._fresh(body_name, earlier, now_ns), None
        gap_ns = states[index].stamp_ns - earlier.stamp_ns
        if gap_ns > self._timeout_ns:
            message = (
                f"state of {body_name!r} at {stamp_ns} ns: the states around it are "
                f"{to_seconds(gap_ns):.3f} s apart, allowed is at most "
                f"{to_seconds(self._timeout_ns):g} s (state_timeout)"
            )
            raise StaleStateError(message)
        return earlier, states[index]

    def _forget_future(self, body_name: str, now_ns: int) -> None:
        """Forget states too far ahead of the clock, which came before the clock began or was set back."""
        states = self._states.get(body_name, [])
        latest = now_ns + self._future_tolerance_ns
        if states and states[-1].stamp_ns > latest:
            del states[bisect_right(states, latest, key=_stamp) :]

    def _fresh(self, body_name: str, state: BodyState, asked_ns: int) -> BodyState:
        age_ns = asked_ns - state.stamp_ns
        if age_ns > self._timeout_ns:
            message = (
                f"state of {body_name!r}: the newest is {to_seconds(age_ns):.3f} s old, "
                f"allowed is at most {to_seconds(self._timeout_ns):g} s (state_timeout)"
            )
            raise StaleStateError(message)
        return state


def _stamp(state: BodyState) -> int:
    return state.stamp_ns
