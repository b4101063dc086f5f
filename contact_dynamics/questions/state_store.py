# SPDX-License-Identifier: Apache-2.0
"""Stores the published states of each body for questions about the present and the recent past.

A state can be stored undecoded, as its stamp and a function that decodes it when a question requires it. Most
states are never required, so a thousand states per second cost little more than their memory.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections import defaultdict
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, TypeAlias

from contact_dynamics.constants import to_ns, to_seconds
from contact_dynamics.errors import InvalidFieldError, NoStateError, StaleStateError
from contact_dynamics.questions.uncertain_state import UncertainState
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.validation import check_not_negative, check_whole
from contact_dynamics.validation_types import checks_types

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from contact_dynamics.questions.uncertain_state import KnownState

    ReadState: TypeAlias = Callable[[], KnownState | None]
    """Decodes a state, or reports that it is invalid and returns None."""


@dataclass(slots=True, kw_only=True)
class Arrivals:
    """The numbers of received and rejected states of one body, and the reasons."""

    came: int = 0  # number of received states
    rejected: int = 0  # number of rejected ones, some of which were stored before they were decoded
    old: int = 0  # number of those that were older than the timeout on arrival
    age: float = 0.0  # s, age of the last of these on arrival
    reason: str = ""  # the reason of the last rejection
    # The arrival time of the last rejected state, ns on the clock of the stamps, or None if it is unknown
    rejected_ns: int | None = None
    # The arrival time of the last stored state, ns on the clock of the stamps, or None if it is unknown
    kept_ns: int | None = None
    newest_is_rejected: bool = False  # whether no state was stored since the last rejection
    # Whether the last stored state was older than the timeout on arrival
    last_is_old: bool = False
    # Why the stored states were discarded, in words. It is empty if the last state was rejected.
    discarded: str = ""
    expected: str = "none has been received yet"  # the error text before the first state

    def why_none(self, now_ns: int | None) -> str:
        """Return the reason why there is no state at the present time, ns, as text."""
        if not self.came:
            return self.expected
        count = f"{self.came} message{'s' * (self.came != 1)} received"
        if self.discarded:
            return f"{count}; the stored states were discarded when {self.discarded}"
        if self.reason:
            return f"{count}; the last was rejected{self._ago(now_ns)} because {self.reason}"
        return f"{count}; none could be read"

    def why_old(self, now_ns: int) -> str:
        """Return what happened to states after the latest stored one, as text, or an empty text."""
        if self.newest_is_rejected:
            return f"; later messages were rejected, the last{self._ago(now_ns)} because {self.reason}"
        if self.last_is_old:
            return f"; the last message was {self.age:.1f} s old when it was received: do the clocks agree?"
        return ""

    def _ago(self, now_ns: int | None) -> str:
        """Return the time since the last rejection as text, since its publisher may no longer run."""
        if now_ns is None or self.rejected_ns is None:
            return ""
        return f" {to_seconds(now_ns - self.rejected_ns):.1f} s ago"

    def keep(self, now_ns: int | None, *, old_s: float | None) -> None:
        """Count a stored state. If it was too old on arrival, its age was ``old_s``."""
        self.came += 1
        self.kept_ns = now_ns
        self.newest_is_rejected = False
        self.last_is_old = old_s is not None
        if old_s is not None:
            self.old += 1
            self.age = old_s

    def refuse(self, reason: object, *, was_kept: bool, now_ns: int | None) -> None:
        """Count a rejected state, or one that was stored before and cannot be decoded.

        The latter are decoded long after their arrival, the latest first.
        """
        self.came += not was_kept
        self.rejected += 1
        if was_kept and _is_before(now_ns, self.rejected_ns):
            return
        self.reason = str(reason)
        self.rejected_ns = now_ns
        self.newest_is_rejected = not (was_kept and _is_before(now_ns, self.kept_ns))
        self.discarded = ""

    def throw_away(self, reason: str) -> None:
        """Set the reason why the stored states were discarded."""
        self.discarded = reason


def _is_before(one_ns: int | None, other_ns: int | None) -> bool:
    return one_ns is not None and other_ns is not None and one_ns < other_ns


FUTURE_TOLERANCE: Final = 0.5
"""s. Default of the largest lead of a stamp over the clock. Clocks synchronized by NTP differ by far less."""

MAX_STATES: Final = 20_000
"""Default of the largest number of stored states of a body: 20 s at 1 kHz, some 20 MB of Odometry."""


class StateStore:
    """Published states by body, sorted by their stamps. Those older than the history are discarded."""

    def __init__(
        self,
        *,
        history: float,
        timeout: float,
        future_tolerance: float = FUTURE_TOLERANCE,
        max_states: int = MAX_STATES,
    ) -> None:
        """Begin without states.

        Args:
            history: s, duration for which states are stored.
            timeout: s. A state that is older when a question requires it is rejected.
            future_tolerance: s. A state whose stamp is further ahead of the clock is rejected.
            max_states: Largest number of states of a body. The oldest are discarded first.

        Raises:
            InvalidFieldError: a duration is negative, infinite or no number, or ``max_states`` is no whole
                number >= 1.
        """
        self.change_limits(
            history=history, timeout=timeout, future_tolerance=future_tolerance, max_states=max_states
        )
        self._tracks: dict[str, _Track] = {}
        self._arrivals: defaultdict[str, Arrivals] = defaultdict(Arrivals)

    @checks_types
    def add(self, body_name: str, state: KnownState, *, now_ns: int | None = None) -> None:
        """Store a state. ``now_ns`` is the present time, ns. Without it, any stamp is accepted.

        Raises:
            InvalidFieldError: the stamp is ahead of the present time by more than the tolerance, so that the
                state would be the latest until that time; or the stamp is zero, as of publishers that leave
                it out, unless the clock has just started.
        """
        self._keep(body_name, state.stamp_ns, state, now_ns)

    def add_unread(
        self, body_name: str, stamp_ns: int, read: ReadState, *, now_ns: int | None = None
    ) -> None:
        """Store a state with a stamp, ns, which ``read`` decodes when a question requires it.

        The errors are those of `add`.
        """
        self._keep(body_name, stamp_ns, read, now_ns)

    def change_limits(
        self, *, history: float, timeout: float, future_tolerance: float, max_states: int = MAX_STATES
    ) -> None:
        """Set other limits for later states; see `StateStore`."""
        self._history = check_not_negative("history", history)
        self._history_ns = to_ns(self._history)
        self._timeout_ns = to_ns(check_not_negative("timeout", timeout))
        self._future_tolerance_ns = to_ns(check_not_negative("future_tolerance", future_tolerance))
        self._max_states = check_whole("max_states", max_states, 1)

    def refuse(
        self, body_name: str, reason: object, *, was_kept: bool = False, now_ns: int | None = None
    ) -> None:
        """Count a rejected state, or a stored one that cannot be decoded, with the reason for later errors.

        ``now_ns`` is its time of arrival, ns, if that is known.
        """
        self._arrivals[body_name].refuse(reason, was_kept=was_kept, now_ns=now_ns)

    def expect(self, body_name: str, expected: str) -> None:
        """Set the text about the expected states of a body, for errors before the first one."""
        self._arrivals[body_name].expected = expected

    def arrivals(self, body_name: str) -> Arrivals:
        """Return the numbers of received and rejected states of a body."""
        return self._arrivals.get(body_name, Arrivals())

    def forget(self, body_name: str, reason: str) -> None:
        """Discard the states of a body; the reason is a text that follows "when"."""
        track = self._tracks.pop(body_name, None)
        if track is not None and track.stamps:
            self._arrivals[body_name].throw_away(reason)

    def clear(self) -> None:
        """Discard all states because the clock was set back, so that their stamps are in the future."""
        for body_name in list(self._tracks):
            self.forget(body_name, "the clock was set back")

    @checks_types
    def newest(self, body_name: str, *, now_ns: int | None = None) -> KnownState:
        """Return the latest state. Without the present time, ns, it may be of any age.

        Raises:
            NoStateError: none has been received yet, or none of those received is stored; the message
                contains the reason.
            StaleStateError: it is older than the timeout.
        """
        if now_ns is not None:
            self._forget_future(body_name, now_ns)
        track = self._tracks.get(body_name, _Track())
        state = track.last(len(track.stamps))
        if state is None:
            raise NoStateError(f"no state of {body_name!r}: {self.arrivals(body_name).why_none(now_ns)}")
        return state if now_ns is None else self._fresh(body_name, state, now_ns)

    @checks_types
    def window(self, body_name: str, newest: KnownState, seconds: float) -> list[KnownState]:
        """Return the states of the last ``seconds`` up to ``newest``, by time, one for each stamp."""
        track = self._tracks.get(body_name, _Track())
        first_ns = self._first_of_window(newest.stamp_ns, seconds)
        return list({state.stamp_ns: state for state in track.between(first_ns, newest.stamp_ns)}.values())

    def around(
        self, body_name: str, stamp_ns: int, *, now_ns: int | None = None
    ) -> tuple[KnownState, KnownState | None]:
        """Return the latest state with at most a given stamp, and the next one.

        The next one is None if the state has the given stamp, or is the latest.

        Raises:
            NoStateError: every stored state has a later stamp, or none is stored.
            StaleStateError: the states before and after the stamp are further apart than the timeout; or the
                stamp is after the latest state, which is older than the timeout at ``now_ns``.
        """
        if now_ns is not None:
            self._forget_future(body_name, now_ns)
        track = self._tracks.get(body_name, _Track())
        earlier = track.last(bisect_right(track.stamps, stamp_ns))
        if earlier is None:
            oldest = track.first(0)
            none = self.arrivals(body_name).why_none(now_ns)
            kept = none if oldest is None else f"the oldest stored state is at {oldest.stamp_ns} ns"
            raise NoStateError(f"no state of {body_name!r} at {stamp_ns} ns: {kept}")
        if earlier.stamp_ns == stamp_ns:
            return earlier, None
        later = track.first(bisect_right(track.stamps, stamp_ns))
        if later is None:
            return earlier if now_ns is None else self._fresh(body_name, earlier, now_ns), None
        gap_ns = later.stamp_ns - earlier.stamp_ns
        if gap_ns > self._timeout_ns:
            raise StaleStateError(
                f"state of {body_name!r} at {stamp_ns} ns: the states before and after it must be at most "
                f"{to_seconds(self._timeout_ns):g} s apart (state_timeout), got {to_seconds(gap_ns):.3f} s"
            )
        return earlier, later

    def pairs(
        self, body_name: str, *, after_ns: int, apart: float, count: int
    ) -> tuple[list[tuple[KnownState, KnownState]], int]:
        """Return at most ``count`` pairs of states, spread over those after a stamp, and the latest stamp.

        The first state of a pair may have the stamp ``after_ns``; the second one is the first that is later
        by ``apart``, s. No other states are decoded.
        """
        track = self._tracks.get(body_name, _Track())
        stamps = track.stamps
        begin = max(0, bisect_right(stamps, after_ns) - 1)
        firsts = range(begin, len(stamps) - 1, max(1, (len(stamps) - 1 - begin) // count))[:count]
        seconds = [bisect_left(stamps, stamps[first] + to_ns(apart)) for first in firsts]
        found = [
            (track.at(first), track.at(second))
            for first, second in zip(firsts, seconds, strict=True)
            if second < len(stamps)
        ]
        pairs = [(one, other) for one, other in found if one is not None and other is not None]
        return pairs, stamps[-1] if stamps else 0

    def count(self, body_name: str, stamp_ns: int | None, seconds: float) -> int:
        """Return the number of states in a window up to a stamp, or to the latest state, without decoding."""
        stamps = self._tracks.get(body_name, _Track()).stamps
        end = len(stamps) if stamp_ns is None else bisect_right(stamps, stamp_ns)
        return end - bisect_left(stamps, self._first_of_window(stamps[end - 1], seconds)) if end else 0

    def excerpt(
        self, wanted: Iterable[tuple[str, int | None, float]], *, now_ns: int | None = None
    ) -> StateStore:
        """Return a store that gives the same results about bodies at a stamp and in the window before it.

        All of its states are decoded, so that it can be sent to another process. ``wanted`` contains for each
        body its name, the stamp, ns, or None for the latest, and the length of the `window` up to it, s.
        ``now_ns`` is the present time, ns, if it is known.
        """
        part = StateStore(
            history=self._history,
            timeout=to_seconds(self._timeout_ns),
            future_tolerance=to_seconds(self._future_tolerance_ns),
            max_states=self._max_states,
        )
        for body_name, stamp_ns, seconds in wanted:
            if now_ns is not None:
                self._forget_future(body_name, now_ns)
            track = self._tracks.get(body_name, _Track())
            end = len(track.stamps) if stamp_ns is None else bisect_right(track.stamps, stamp_ns)
            newest = track.last(end)
            if newest is not None:
                first_ns = self._first_of_window(newest.stamp_ns, seconds)
                for state in track.between(first_ns, newest.stamp_ns):
                    part.add(body_name, state)
            later = None if stamp_ns is None else track.first(bisect_right(track.stamps, stamp_ns))
            if later is not None:
                part.add(body_name, later)
            part._arrivals[body_name] = replace(self.arrivals(body_name))
        return part

    def _first_of_window(self, newest_ns: int, seconds: float) -> int:
        """Return the earliest stamp, ns, in the window of the last ``seconds`` up to the state ``newest_ns``.

        A window is at most as long as the history.
        """
        return newest_ns - to_ns(min(seconds, self._history))

    def _keep(self, body_name: str, stamp_ns: int, state: KnownState | ReadState, now_ns: int | None) -> None:
        if now_ns is not None:
            if stamp_ns == 0 and now_ns > self._timeout_ns:
                raise InvalidFieldError("stamp", 0, "the time of the state")
            ahead_ns = stamp_ns - now_ns
            if ahead_ns > self._future_tolerance_ns:
                raise InvalidFieldError(
                    "stamp",
                    f"{to_seconds(ahead_ns):.3f} s ahead of the clock",
                    f"at most {to_seconds(self._future_tolerance_ns):g} s (future_tolerance)",
                )
            self._forget_future(body_name, now_ns)
        age_ns = 0 if now_ns is None else now_ns - stamp_ns
        old_s = to_seconds(age_ns) if age_ns > self._timeout_ns else None
        self._arrivals[body_name].keep(now_ns, old_s=old_s)
        track = self._tracks.get(body_name)
        if track is None:
            track = self._tracks[body_name] = _Track()
        track.add(stamp_ns, state)
        track.forget_before(track.stamps[-1] - self._history_ns, most=self._max_states)

    def _forget_future(self, body_name: str, now_ns: int) -> None:
        """Discard states too far ahead of the clock, from before it started or was set back."""
        track = self._tracks.get(body_name)
        latest = now_ns + self._future_tolerance_ns
        if track and track.stamps and track.stamps[-1] > latest:
            track.forget_after(latest)
            self._arrivals[body_name].throw_away("the clock turned out to be behind their stamps")

    def _fresh(self, body_name: str, state: KnownState, asked_ns: int) -> KnownState:
        age_ns = asked_ns - state.stamp_ns
        if age_ns > self._timeout_ns:
            message = (
                f"the latest state of {body_name!r} must be at most {to_seconds(self._timeout_ns):g} s old "
                f"(state_timeout), got {to_seconds(age_ns):.3f} s"
            )
            raise StaleStateError(message + self.arrivals(body_name).why_old(asked_ns))
        return state


class _Track:
    """The states of one body in the order of their stamps, decoded or not."""

    __slots__ = ("_states", "stamps")

    def __init__(self) -> None:
        self.stamps: list[int] = []
        self._states: list[KnownState | ReadState] = []

    def add(self, stamp_ns: int, state: KnownState | ReadState) -> None:
        if not self.stamps or stamp_ns >= self.stamps[-1]:  # nearly always
            self.stamps.append(stamp_ns)
            self._states.append(state)
            return
        index = bisect_right(self.stamps, stamp_ns)
        self.stamps.insert(index, stamp_ns)
        self._states.insert(index, state)

    def last(self, end: int) -> KnownState | None:
        """Return the last valid state before an index, and discard invalid ones."""
        while end > 0:
            end -= 1
            state = self.at(end)
            if state is not None:
                return state
            del self.stamps[end], self._states[end]
        return None

    def first(self, begin: int) -> KnownState | None:
        """Return the first valid state from an index on, and discard invalid ones."""
        while begin < len(self.stamps):
            state = self.at(begin)
            if state is not None:
                return state
            del self.stamps[begin], self._states[begin]
        return None

    def between(self, first_ns: int, last_ns: int) -> list[KnownState]:
        """Return the states from one stamp to another, both included, and discard invalid ones."""
        begin, end = bisect_left(self.stamps, first_ns), bisect_right(self.stamps, last_ns)
        found = [self.at(index) for index in range(begin, end)]
        readable = [state for state in found if state is not None]
        if len(readable) < len(found):
            self._states[begin:end] = readable
            self.stamps[begin:end] = [state.stamp_ns for state in readable]
        return readable

    def forget_before(self, oldest_ns: int, *, most: int) -> None:
        surplus = max(bisect_left(self.stamps, oldest_ns), len(self.stamps) - most)
        if surplus > 0:
            del self.stamps[:surplus], self._states[:surplus]

    def forget_after(self, latest_ns: int) -> None:
        kept = bisect_right(self.stamps, latest_ns)
        del self.stamps[kept:], self._states[kept:]

    def at(self, index: int) -> KnownState | None:
        """Return the state at an index, or None if it is invalid."""
        state = self._states[index]
        if isinstance(state, (BodyState, UncertainState)):
            return state
        read = state()
        if read is not None:
            self._states[index] = read
        return read
