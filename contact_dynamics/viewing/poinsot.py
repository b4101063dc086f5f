# SPDX-License-Identifier: Apache-2.0
"""Draws Poinsot's picture: the inertia ellipsoid of a free body rolls on the invariable plane (lecture 25).

In the space of angular velocities the ellipsoid w^T I w = 2 T turns with the body about its fixed centre, and
touches the plane at w. Its trace on the ellipsoid is the polhode, its trace on the plane the herpolhode. The
angular momentum points down here, so that the plane lies below, and the largest semi-axis has length 1.

The picture is that of one flight. An impact or a contact changes the angular momentum, which leaves
ellipsoid, plane and curves without meaning: they are cleared at the first state that does not have the
flight's any more. Of several bodies, the one that was asked about last is in the picture.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.poinsot import ARROW_RADIUS, poinsot_axes, poinsot_marks
from contact_dynamics.rotations.one import rotation_matrix
from contact_dynamics.viewing.drawing import draw_marks
from contact_dynamics.viewing.entities import POINSOT_BODIES, POINSOT_WORDS, entity
from contact_dynamics.viewing.measured import set_time, time_column

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.tumbling.poinsot_construction import Poinsot, RollingCurves

SAME_MOMENTUM: Final = 0.2
"""Relative. If the angular momentum is off by more, the flight is over. In the demo's toss the noise of
motion capture makes up to 0.08 of it, and impacts make more than 1."""

_ABOVE: Final = (0.0, 0.0, 0.75)  # where words stand: the largest semi-axis has length 1


def count_of_flight(picture: Poinsot, states: Sequence[BodyState]) -> int:
    """Return how many states, from the first on, have the flight's angular momentum."""
    allowed = SAME_MOMENTUM * float(np.linalg.norm(picture.L_W))
    for i, state in enumerate(states):
        R_WB = rotation_matrix(state.q_WB)
        L_W = R_WB @ picture.I_B @ R_WB.T @ state.w_WB_W
        if float(np.linalg.norm(L_W - picture.L_W)) > allowed:
            return i
    return len(states)


def draw_poinsot(
    recording: rr.RecordingStream, body_name: str, picture: Poinsot, curves: RollingCurves
) -> None:
    """Draw ellipsoid, plane and curves at the recording's current time. `draw_rolling` turns the ellipsoid.

    The body must rotate, because there is no plane at rest.
    """
    path = entity(POINSOT_BODIES, body_name)
    _tell(recording, body_name or "the body")
    unit = float(picture.ellipsoid_semi_axes.max())
    recording.log(path, rr.Transform3D(mat3x3=poinsot_axes(picture) / unit))
    draw_marks(recording, poinsot_marks(picture, curves), path)
    style = rr.Arrows3D.from_fields(
        colors=palette.AFTER_IMPACT,
        radii=ARROW_RADIUS * unit,
        labels=["angular velocity"],
        show_labels=False,
    )
    recording.log(f"{path}/angular_velocity", style)


def _tell(recording: rr.RecordingStream, words: str) -> None:
    """Write words above the picture, or where it was."""
    told = rr.Points3D([_ABOVE], colors=palette.NORMAL, radii=0.0, labels=[words], show_labels=True)
    recording.log(POINSOT_WORDS, told)


def draw_rolling(recording: rr.RecordingStream, body_name: str, states: Sequence[BodyState]) -> None:
    """Turn the ellipsoid with the body, and draw its angular velocity, at the stamps of states."""
    if not states:
        return
    path = entity(POINSOT_BODIES, body_name)
    stamps = time_column([state.stamp_ns for state in states])
    turns = rr.Transform3D.columns(quaternion=np.array([state.q_WB for state in states]))
    recording.send_columns(f"{path}/body", indexes=[stamps], columns=turns)
    rates = np.array([state.w_WB_W for state in states])
    arrows = rr.Arrows3D.columns(vectors=rates, origins=np.zeros_like(rates))
    recording.send_columns(f"{path}/angular_velocity", indexes=[stamps], columns=arrows)


class PoinsotInView:
    """Keeps the picture of the body that was asked about last, for as long as its flight lasts."""

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
            self._recording.log(entity(POINSOT_BODIES, self._rolling[0]), rr.Clear(recursive=True))
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
            self._recording.log(entity(POINSOT_BODIES, body_name), rr.Clear(recursive=True))
            _tell(self._recording, f"the flight of {body_name or 'the body'} is over")
            self._rolling = None
