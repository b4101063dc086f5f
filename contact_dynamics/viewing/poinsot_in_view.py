"""Keeps Poinsot's picture of the body that was asked about last, for as long as its flight lasts."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from contact_dynamics.viewing.measured import set_time
from contact_dynamics.viewing.poinsot import (
    clear_poinsot,
    count_of_flight,
    draw_poinsot,
    draw_rolling,
    hide_poinsot,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    import rerun as rr

    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.tumbling.poinsot_construction import Poinsot, RollingCurves


class PoinsotInView:
    """The body whose ellipsoid rolls."""

    def __init__(self, recording: rr.RecordingStream) -> None:
        """Begin without any."""
        self._recording = recording
        self._rolling: tuple[str, Poinsot] | None = None

    @property
    def rolling(self) -> str | None:
        """The body whose ellipsoid rolls, if there is one."""
        return None if self._rolling is None else self._rolling[0]

    def come(
        self, body_name: str, picture: Poinsot, curves: RollingCurves, state: BodyState, *, stamp_ns: int
    ) -> None:
        """Draw the picture of a body in a state, at a stamp, ns, in place of another body's."""
        if self._rolling is not None and self._rolling[0] != body_name:
            hide_poinsot(self._recording, self._rolling[0])
        draw_poinsot(self._recording, body_name, picture, curves)
        draw_rolling(self._recording, body_name, [replace(state, stamp_ns=stamp_ns)])
        self._rolling = (body_name, picture)

    def add_states(self, body_name: str, states: Sequence[BodyState]) -> None:
        """Let the ellipsoid roll as a body was measured, and clear the picture when its flight is over."""
        if self._rolling is None or self._rolling[0] != body_name:
            return
        count = count_of_flight(self._rolling[1], states)
        draw_rolling(self._recording, body_name, states[:count])
        if count < len(states):
            set_time(self._recording, states[count].stamp_ns)
            clear_poinsot(self._recording, body_name)
            self._rolling = None
