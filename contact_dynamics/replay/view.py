# SPDX-License-Identifier: Apache-2.0
"""Draws a recording in rerun: states of bodies, and the answers that it holds or that are asked now."""

from __future__ import annotations

import time
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Final

from contact_dynamics.replay.events import StateCame, WorldChanged
from contact_dynamics.viewing.picture import Picture
from contact_dynamics.viewing.sinks import OpenRecording, Sinks, ViewerMode, raise_errors
from contact_dynamics.viewing.states_in_turn import StatesInTurn

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.replay.events import Answered, Event, Events

_LOOK_S: Final = 0.2  # how long what is served waits between two looks at its sinks

_AT_ONCE: Final = 1000
"""States that are drawn together, because a batch costs what a single state does."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawn:
    """What came of a drawing.

    Attributes:
        states: Number of states.
        answers: Number of answers, with the refused ones.
        took_all: Whether the sinks took all of it.
        viewer_failed: Whether a viewer was asked for that could not be reached, or failed later.
    """

    states: int
    answers: int
    took_all: bool
    viewer_failed: bool


def draw(
    events: Events,
    sinks: Sinks,
    *,
    surface_side: float,
    on_open: Callable[[str], object],
    on_problem: Callable[[str], object],
    on_progress: Callable[[int], object],
) -> Drawn:
    """Draw a recording, and return what came of it. What is served stays so until `KeyboardInterrupt`.

    Args:
        events: the recording.
        sinks: where to draw to.
        surface_side: m, the side of the squares that stand for surfaces.
        on_open: a function that is called with the address of the picture, and again when it is complete.
        on_problem: a function that is told, in words, what cannot be drawn, each kind once.
        on_progress: a function that is told the stamp of what is drawn, ns.

    Raises:
        NowhereToDrawError: a viewer was asked for alone, and there is none.
        OSError: the file cannot be written.
    """
    raise_errors()
    recording = OpenRecording(sinks, on_problem=on_problem)
    on_open(recording.description)
    drawing = _Drawing(
        Picture(recording.stream, events.world, surface_side=surface_side), on_problem=on_problem
    )
    try:
        for event in events:
            drawing.show(event)
            recording.tend()
            if isinstance(event, StateCame):
                on_progress(event.state.stamp_ns)
        drawing.finish(look_at_all=sinks.viewer is ViewerMode.NONE)
        if sinks.viewer is ViewerMode.SERVE and not recording.viewer_failed:
            on_open(f"all {drawing.states} states and {drawing.answers} answers are drawn")
            _serve(recording)
    finally:  # also if the user stops it: what is drawn so far can be opened
        took_all = recording.close()
    return Drawn(
        states=drawing.states,
        answers=drawing.answers,
        took_all=took_all,
        viewer_failed=recording.viewer_failed,
    )


def _serve(recording: OpenRecording) -> None:
    """Serve the picture until the user stops it. rerun serves it as long as the recording is open."""
    with suppress(KeyboardInterrupt):
        while True:
            recording.tend()
            time.sleep(_LOOK_S)


class _Drawing:
    """A picture, and the states that wait to be drawn together."""

    def __init__(self, picture: Picture, *, on_problem: Callable[[str], object]) -> None:
        self.states = 0
        self.answers = 0
        self._picture = picture
        self._on_problem = on_problem
        self._told: set[str] = set()
        self._waiting = StatesInTurn(picture, guarded=self._guarded)

    def show(self, event: Event) -> None:
        """Draw an event, or keep a state to be drawn with others."""
        if isinstance(event, StateCame):
            self.states += 1
            self._waiting.add(event.body_name, event.state)
            if self._waiting.count >= _AT_ONCE:
                self._waiting.draw()
            return
        if isinstance(event, WorldChanged):
            self._waiting.draw()
            change = partial(self._picture.change_world, event.world, stamp_ns=event.stamp_ns)
            self._guarded("a change of the world", change)
            return
        self.answers += 1
        self._guarded(event.service_name, lambda: self._show_answer(event))

    def finish(self, *, look_at_all: bool) -> None:
        """Draw what is left, and look at all of it where no viewer was open from the beginning."""
        self._waiting.draw()
        if look_at_all:
            self._guarded("the last look", self._picture.frame_all)

    def _show_answer(self, answered: Answered) -> None:
        answer, now_ns = answered.answer, self._waiting.newest_stamp_ns() or answered.asked_ns
        remark, seconds = answered.message, answered.computation_time
        if answer is None:
            refused = f"refused ({answered.status}): {remark}"
            self._picture.tell(answered.service.kind, refused, stamp_ns=now_ns, is_error=True)
        else:
            self._waiting.draw_before(answer)
            self._picture.show(answer, now_ns=now_ns, remark=remark, computation_time=seconds)

    def _guarded(self, kind: str, show: Callable[[], object]) -> None:
        try:
            show()
        except Exception as error:  # noqa: BLE001  what one answer has must not cost the picture of the rest
            if kind not in self._told:
                self._told.add(kind)
                self._on_problem(f"cannot draw {kind}; not told again: {type(error).__name__}: {error}")
