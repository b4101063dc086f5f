# SPDX-License-Identifier: Apache-2.0
"""Queues states until they are drawn: at a pace, or before an answer that needs them."""

from __future__ import annotations

import time
from contextlib import contextmanager
from functools import partial
from typing import TYPE_CHECKING, Final

from contact_dynamics.constants import to_ns
from contact_dynamics.viewing.measured import SET_BACK_S

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from contact_dynamics.questions.services import Answer
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.viewing.picture import Picture

SHORTEST_S: Final = 0.05  # s, minimum time between two drawings of states
LONGEST_S: Final = 0.5  # s, maximum time between two drawings of states

SHARE: Final = 0.2
"""The share of one processor that the drawing of states takes, unless the longest time is too short."""


class Pace:
    """Pace of drawing queued states: the slower drawing is, the less often it happens.

    A batch of states takes about as long as a single state, so fewer and larger batches draw the same states
    in less time, only later.

    Attributes:
        wait_s: Time from the last drawing until the next one is due, s.
    """

    def __init__(self) -> None:
        """Begin with a drawing due."""
        self.wait_s = SHORTEST_S
        self._drawn = float("-inf")

    @property
    def is_due(self) -> bool:
        """Whether states are to be drawn now. To be called once per minimum time."""
        return time.monotonic() >= self._drawn + self.wait_s - 0.5 * SHORTEST_S

    @contextmanager
    def drawing(self) -> Iterator[None]:
        """Return a context for drawing, whose processor time determines when the next drawing is due."""
        self._drawn = time.monotonic()
        began = time.thread_time()
        try:
            yield
        finally:
            self.wait_s = wait_after(time.thread_time() - began)


def wait_after(seconds: float) -> float:
    """Return the time from one drawing to the next, s, given the processor time of each, s."""
    return min(max(seconds / SHARE, SHORTEST_S), LONGEST_S)


class StatesInTurn:
    """The received states that are not drawn yet.

    Attributes:
        count: Their number.
        pace: The pace at which all of them are drawn.
    """

    def __init__(self, picture: Picture, *, guarded: Callable[[str, Callable[[], None]], None]) -> None:
        """Begin without any. ``guarded`` is called with a description and the drawing function."""
        self.count = 0
        self.pace = Pace()
        self._picture = picture
        self._guarded = guarded
        self._waiting: dict[str, list[tuple[int, BodyState]]] = {}  # with their arrival times, ns
        self._newest_ns: dict[str, int] = {}

    def add(self, body_name: str, state: BodyState, *, came_ns: int = 0) -> None:
        """Queue a state of a body with its arrival time, ns, on the same clock as those of answers."""
        self.count += 1
        self._waiting.setdefault(body_name, []).append((came_ns, state))
        self._newest_ns[body_name] = max(state.stamp_ns, self._newest_ns.get(body_name, state.stamp_ns))

    def draw(self) -> None:
        """Draw all states."""
        with self.pace.drawing():
            for body_name in list(self._waiting):
                self._draw_of(body_name)

    def draw_before(self, answer: Answer, *, came_ns: int | None = None) -> None:
        """Draw the states of bodies before an answer about them, and those of bodies whose curves it may end.

        Drawing all bodies' states before each answer would defeat the pace when there are many requests. If
        the answer was queued itself, only states that arrived before it, at ``came_ns``, are drawn.
        """
        others = set() if answer.predicted_motion is None else self._picture.bodies_with_curves
        about = {body.name for body in getattr(answer, "bodies", ())} or {answer.body_name}
        for each in about | others:
            self._draw_of(each, came_ns=came_ns)

    def newest_stamp_ns(self) -> int | None:
        """Return the stamp of the newest state, or else of the last drawn answer, if there is either."""
        return self._picture.newest_stamp_ns(self._newest_ns)

    def _draw_of(self, body_name: str, *, came_ns: int | None = None) -> None:
        """Draw the states of one body; if a time is given, those that arrived up to then."""
        waiting = self._waiting.pop(body_name, [])
        states = [state for each_ns, state in waiting if came_ns is None or each_ns <= came_ns]
        if came_ns is not None and len(states) < len(waiting):
            self._waiting[body_name] = [each for each in waiting if each[0] > came_ns]
        else:
            self._newest_ns.pop(body_name, None)
        self.count -= len(states)
        if states:
            for each in _by_stamps(states):
                self._guarded("states", partial(self._picture.add_states, body_name, each))


def _by_stamps(states: list[BodyState]) -> Iterator[list[BodyState]]:
    """Yield states by their stamps, but those since the clock was last set back after the others."""
    stamps_ns, back_ns = [state.stamp_ns for state in states], to_ns(SET_BACK_S)
    falls = (i for i in range(len(states) - 1, 0, -1) if stamps_ns[i - 1] - stamps_ns[i] > back_ns)
    begin = next(falls, 0)
    for part in (states[:begin], states[begin:]):
        if part:
            yield sorted(part, key=lambda state: state.stamp_ns)
