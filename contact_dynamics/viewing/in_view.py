# SPDX-License-Identifier: Apache-2.0
"""Manages which predictions are in view beside the measured states, and removes those that hide the bodies.

States may arrive before the answer that predicted them, so the newest states of a body are kept and compared
when the answer arrives. Of several bodies, the one with the newest answer has labels. An impact loses its
labels some time after it, and is then removed if another body's impact is newer.

Poinsot's picture is that of one flight (lecture 25): the inertia ellipsoid w^T I w = 2 T turns with the body
in the space of angular velocities, and rolls on the invariable plane, which it touches at w. Its traces are
the polhode and the herpolhode. The angular momentum points down here, so that the plane is below, and the
largest semi-axis has length 1. An impact or a contact changes the angular momentum and invalidates the
picture, which is cleared at the first state without the flight's angular momentum. Of several bodies, the
picture shows the one of the last request.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.constants import ns_after
from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.impact_scene import LABELS
from contact_dynamics.diagrams.poinsot import ARROW_RADIUS, poinsot_axes, poinsot_marks
from contact_dynamics.rotations.one import rotation_matrix
from contact_dynamics.viewing.drawing import draw_marks
from contact_dynamics.viewing.entities import IMPACTS, POINSOT_BODIES, POINSOT_WORDS, WHOSE, entity
from contact_dynamics.viewing.measured import (
    OF_ONE_BODY,
    curves_of,
    draw_curves_of_one,
    draw_prediction_at,
    draw_states,
    set_time,
    time_column,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.tumbling import Trajectory
    from contact_dynamics.tumbling.poinsot_construction import Poinsot, RollingCurves
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.viewing.scenery import BodiesInWorld


LABELS_S: Final = 0.5  # s. The labels of an impact, which cover the body, are removed this long after it.


class ImpactsInView:
    """The bodies with an impact in the scene, and the times until which these have labels."""

    def __init__(self, recording: rr.RecordingStream) -> None:
        """Begin without any."""
        self._recording = recording
        self._until_ns: dict[str, int] = {}
        self._newest = ""
        self._labelled = ""

    def come(self, body_name: str, *, stamp_ns: int, strike_ns: int) -> None:
        """Register the newest impact, which is drawn at one stamp, ns, and happens at another."""
        if self._newest != body_name:
            self._clear_labels(stamp_ns)
            if self._until_ns.get(self._newest, stamp_ns) < stamp_ns:
                self._clear(self._newest, stamp_ns)
        self._newest = self._labelled = body_name
        self._until_ns[body_name] = ns_after(strike_ns, LABELS_S)

    def pass_by(self, body_name: str, stamp_ns: int) -> None:
        """Clear expired labels and impacts of a body that was measured at a stamp, ns."""
        if stamp_ns <= self._until_ns.get(body_name, stamp_ns):
            return
        if body_name != self._newest:
            self._clear(body_name, stamp_ns)
        elif body_name == self._labelled:
            self._clear_labels(stamp_ns)

    def _clear(self, body_name: str, stamp_ns: int) -> None:
        set_time(self._recording, stamp_ns)
        self._recording.log(entity(IMPACTS, body_name), rr.Clear(recursive=True))
        self._until_ns.pop(body_name, None)

    def _clear_labels(self, stamp_ns: int) -> None:
        if self._labelled:
            _clear_each(
                self._recording, (f"{entity(IMPACTS, self._labelled)}/{label}" for label in LABELS), stamp_ns
            )
            self._labelled = ""


class ConservedInView:
    """The body whose energy and momenta are drawn as curves.

    Of several bodies it is the one of a request, until its predicted motion is over and a request about
    another arrives. Curves of many bodies could not be distinguished, and would double the cost of drawing.
    """

    def __init__(self, recording: rr.RecordingStream) -> None:
        """Begin without any."""
        self._recording = recording
        self._until_ns = 0
        self.body_name: str | None = None

    def come(self, body_name: str, *, stamp_ns: int, end_ns: int) -> bool:
        """Register a prediction from one stamp to another, ns, and return whether the body changes."""
        begins = self.body_name != body_name
        if self.body_name not in {None, body_name}:
            if stamp_ns < self._until_ns:
                return False
            _clear_each(
                self._recording,
                [
                    entity(quantity, self.body_name, kind)
                    for quantity in OF_ONE_BODY
                    for kind in ("measured", "predicted")
                ],
                stamp_ns,
            )
        self.body_name, self._until_ns = body_name, end_ns
        if begins:
            set_time(self._recording, stamp_ns)
            whose = rr.TextDocument(f"The curves are those of **{body_name}**.", media_type="text/markdown")
            self._recording.log(WHOSE, whose)
        return begins


def _clear_each(recording: rr.RecordingStream, paths: Iterable[str], stamp_ns: int) -> None:
    set_time(recording, stamp_ns)
    for path in paths:
        recording.log(path, rr.Clear(recursive=False))


MAX_KEPT: Final = 500
"""Number of stored states of a body, 2 s at 250 Hz. Later answers are not drawn beside earlier states."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Prediction:
    """The predicted motion of a body."""

    begin_ns: int  # time of its beginning, ns
    trajectory: Trajectory
    curves: dict[str, FloatArray]  # its curves by quantity, over the trajectory
    number: int  # its number among those of its body, from 0


class PredictionsInView:
    """The latest predictions, and the measured states beside them."""

    def __init__(self, recording: rr.RecordingStream, bodies: BodiesInWorld, *, up_W: FloatArray) -> None:
        """Begin without any, for bodies of a world in which ``up_W`` is upwards."""
        self._recording = recording
        self._bodies = bodies
        self._up_W = up_W
        self._predictions: dict[str, Prediction] = {}
        self._kept: dict[str, deque[BodyState]] = {}
        self._conserved = ConservedInView(recording)
        self._conserved_ns: dict[str, int] = {}  # stamp of the last state whose energy is drawn
        self._compared_ns: dict[str, int] = {}  # stamp of the last state with a prediction beside it

    @property
    def conserved(self) -> str | None:
        """The body whose energy and momenta are drawn, if there is one."""
        return self._conserved.body_name

    def newest(self, body_name: str) -> Prediction | None:
        """Return the newest prediction of a body, if there is one."""
        return self._predictions.get(body_name)

    def add_states(
        self, body_name: str, states: Sequence[BodyState], *, before: BodyState | None, gravity_W: FloatArray
    ) -> bool:
        """Draw measured states that follow ``before``; return whether a prediction is drawn beside any."""
        has_energy = body_name == self._conserved.body_name
        draw_states(
            self._recording,
            body_name,
            states,
            before=before,
            up_W=self._up_W,
            body=self._bodies.mass_properties(body_name) if has_energy else None,
            gravity_W=gravity_W,
        )
        if has_energy:
            self._conserved_ns[body_name] = states[-1].stamp_ns
        is_compared = self._compare(body_name, states)
        self._kept.setdefault(body_name, deque(maxlen=MAX_KEPT)).extend(states)
        return is_compared

    def come(
        self, body_name: str, trajectory: Trajectory, *, begin_ns: int, gravity_W: FloatArray
    ) -> tuple[bool, bool]:
        """Register a prediction, from which curves are drawn until the next one.

        Return whether there are curves of energy, and whether the prediction is drawn beside any state.
        """
        earlier = self._predictions.get(body_name)
        body = self._bodies.mass_properties(body_name)
        self._predictions[body_name] = Prediction(
            begin_ns=begin_ns,
            trajectory=trajectory,
            curves=curves_of(trajectory, up_W=self._up_W, body=body, gravity_W=gravity_W),
            number=0 if earlier is None else earlier.number + 1,
        )
        has_energy = body is not None and len(trajectory) > 0
        if body is not None and has_energy:
            end_ns = ns_after(begin_ns, float(trajectory.seconds[-1]))
            if self._conserved.come(body_name, stamp_ns=begin_ns, end_ns=end_ns):
                kept = self._kept_after(body_name, self._conserved_ns.get(body_name, 0))
                draw_curves_of_one(self._recording, body_name, kept, body=body, gravity_W=gravity_W)
        first_ns = max(begin_ns, self._compared_ns.get(body_name, 0))
        is_compared = self._compare(body_name, self._kept_after(body_name, first_ns))
        set_time(self._recording, begin_ns)
        return has_energy, is_compared

    def _kept_after(self, body_name: str, stamp_ns: int) -> list[BodyState]:
        return [state for state in self._kept.get(body_name, ()) if state.stamp_ns > stamp_ns]

    def _compare(self, body_name: str, states: Sequence[BodyState]) -> bool:
        """Draw the latest prediction of a body beside the states that it covers; return if there are any."""
        prediction = self._predictions.get(body_name)
        if prediction is None or not states:
            return False
        last_ns = draw_prediction_at(
            self._recording,
            body_name,
            states,
            trajectory=prediction.trajectory,
            curves={
                quantity: curve
                for quantity, curve in prediction.curves.items()
                if quantity not in OF_ONE_BODY or body_name == self._conserved.body_name
            },
            begin_ns=prediction.begin_ns,
        )
        if last_ns is not None:
            self._compared_ns[body_name] = last_ns
        return last_ns is not None


SAME_MOMENTUM: Final = 0.2
"""Largest relative difference of the angular momentum within a flight. In the demo's toss, the noise of
motion capture causes up to 0.08, and impacts more than 1."""

_ABOVE: Final = (0.0, 0.0, 0.75)  # places of texts; the largest semi-axis has length 1


def count_of_flight(picture: Poinsot, states: Sequence[BodyState]) -> int:
    """Return the number of leading states with the flight's angular momentum."""
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

    The body must rotate, because there is no invariable plane at rest.
    """
    path = entity(POINSOT_BODIES, body_name)
    _tell(recording, body_name or "the body")
    unit = float(picture.ellipsoid_semi_axes.max())
    recording.log(path, rr.Transform3D(mat3x3=poinsot_axes(picture) / unit))
    draw_marks(recording, poinsot_marks(picture, curves), path)
    style = rr.Arrows3D.from_fields(
        colors=palette.AFTER_IMPACT, radii=ARROW_RADIUS * unit, labels=["angular velocity"], show_labels=False
    )
    recording.log(f"{path}/angular_velocity", style)


def _tell(recording: rr.RecordingStream, words: str) -> None:
    """Write text above the picture, or at its former place."""
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
    """The picture of the body of the last request, for the duration of its flight."""

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
        """Draw the picture of a body in a state at a stamp, ns, and remove another body's."""
        if self._rolling is not None and self._rolling[0] != body_name:
            self._recording.log(entity(POINSOT_BODIES, self._rolling[0]), rr.Clear(recursive=True))
        draw_poinsot(self._recording, body_name, picture, curves)
        draw_rolling(self._recording, body_name, [replace(state, stamp_ns=stamp_ns)])
        self._rolling = (body_name, picture)

    def add_states(self, body_name: str, states: Sequence[BodyState]) -> None:
        """Roll the ellipsoid with the measured states of a body; clear the picture after its flight."""
        if self._rolling is None or self._rolling[0] != body_name:
            return
        count = count_of_flight(self._rolling[1], states)
        draw_rolling(self._recording, body_name, states[:count])
        if count < len(states):
            set_time(self._recording, states[count].stamp_ns)
            self._recording.log(entity(POINSOT_BODIES, body_name), rr.Clear(recursive=True))
            _tell(self._recording, f"the flight of {body_name or 'the body'} is over")
            self._rolling = None
