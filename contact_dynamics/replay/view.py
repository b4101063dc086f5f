# SPDX-License-Identifier: Apache-2.0
"""Draws a recording in rerun: states of bodies, and responses that are logged or requested on replay."""

from __future__ import annotations

import sys
import time
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Final, NamedTuple

from contact_dynamics.replay.events import Monitored, StateCame, WorldChanged
from contact_dynamics.viewing.picture import Picture
from contact_dynamics.viewing.sinks import OpenRecording, Sinks, ViewerMode, raise_errors
from contact_dynamics.viewing.states_in_turn import StatesInTurn

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.replay.events import Answered, Event, Events
    from contact_dynamics.replay.progress import Progress

_LOOK_S: Final = 0.2  # time between two checks of the sinks of a served picture
_AT_ONCE: Final = 1000  # number of states in a batch, which takes as long as a single state


class Drawn(NamedTuple):
    """The result of a drawing."""

    states: int
    answers: int  # including rejected requests
    took_all: bool  # whether the sinks received all of it
    viewer_failed: bool  # whether a viewer could not be reached, or failed later


def draw(name: str, events: Events, sinks: Sinks, *, surface_side: float, progress: Progress) -> Drawn:
    """Draw the recording of that name. A served picture remains available until `KeyboardInterrupt`.

    Errors in drawing are reported on the terminal, each kind once. Surfaces are squares of ``surface_side``,
    m. Raise `NowhereToDrawError` if only a viewer was requested, and there is none, and `OSError` if the file
    cannot be written.
    """
    raise_errors()
    recording = OpenRecording(sinks, on_problem=_tell_problem)
    picture = Picture(recording.stream, events.world, surface_side=surface_side, carried=events.carried)
    drawing = _Drawing(picture)
    is_served = sinks.viewer is ViewerMode.SERVE
    if is_served:
        _tell_server(name, recording.description)
    try:
        for event in events:
            drawing.show(event)
            recording.tend()
            if isinstance(event, StateCame):
                progress.tell(event.state.stamp_ns, "drawing")
        drawing.finish(look_at_all=sinks.viewer is ViewerMode.NONE)
        if is_served and not recording.viewer_failed:
            _tell_server(name, f"all {drawing.states} states and {drawing.answers} responses are drawn")
            _serve(recording)
    finally:  # also if the user stops it, so that the picture so far can be opened
        took_all = recording.close()
    return Drawn(drawing.states, drawing.answers, took_all, recording.viewer_failed)


def _tell_problem(problem: str) -> None:
    print(f"contact-dynamics replay: {problem}", file=sys.stderr)


def _tell_server(name: str, where: str) -> None:
    print(f"{name}: {where}; press Ctrl-C to stop", file=sys.stderr, flush=True)


def _serve(recording: OpenRecording) -> None:
    """Serve the picture until the user stops it. rerun serves it as long as the recording is open."""
    with suppress(KeyboardInterrupt):
        while True:
            recording.tend()
            time.sleep(_LOOK_S)


class _Drawing:
    """A picture, and the states that wait to be drawn together."""

    def __init__(self, picture: Picture) -> None:
        self.states = 0
        self.answers = 0
        self._picture = picture
        self._told: set[str] = set()
        self._waiting = StatesInTurn(picture, guarded=self._guarded)

    def show(self, event: Event) -> None:
        """Draw an event, or queue a state to be drawn with others."""
        if isinstance(event, StateCame):
            self.states += 1
            self._waiting.add(event.body_name, event.state)
            if self._waiting.count >= _AT_ONCE:
                self._waiting.draw()
            return
        if isinstance(event, WorldChanged):
            self._waiting.draw()
            change = partial(
                self._picture.change_world, event.world, stamp_ns=event.stamp_ns, carried=event.carried
            )
            self._guarded("a change of the world", change)
            return
        if isinstance(event, Monitored):
            tell = partial(self._picture.tell, "monitor", event.text, stamp_ns=event.stamp_ns)
            self._guarded("the monitor's events", partial(tell, is_error=event.is_unusual))
            return
        self.answers += 1
        self._guarded(event.service_name, lambda: self._show_answer(event))

    def finish(self, *, look_at_all: bool) -> None:
        """Draw the queued states, and frame the whole picture if no viewer was open from the beginning."""
        self._waiting.draw()
        if look_at_all:
            self._guarded("the last look", self._picture.frame_all)

    def _show_answer(self, answered: Answered) -> None:
        answer, now_ns = answered.answer, self._waiting.newest_stamp_ns() or answered.asked_ns
        remark, seconds = answered.message, answered.computation_time
        if answer is None:
            rejected = f"rejected ({answered.status}): {remark}"
            self._picture.tell(answered.service.kind, rejected, stamp_ns=now_ns, is_error=True)
        else:
            self._waiting.draw_before(answer)
            self._picture.show(answer, now_ns=now_ns, remark=remark, computation_time=seconds)

    def _guarded(self, kind: str, show: Callable[[], object]) -> None:
        try:
            show()
        except Exception as error:  # noqa: BLE001  the rest of the picture must not depend on one answer
            if kind not in self._told:
                self._told.add(kind)
                _tell_problem(f"cannot draw {kind}; not reported again: {type(error).__name__}: {error}")
