# SPDX-License-Identifier: Apache-2.0
"""What is in view of answers, beside the states that are measured, and what only hides the bodies and goes.

States may come before the answer that predicted them. So the newest states of a body are kept, and are
compared when the answer comes. Of several bodies, the one that the newest answer is about has labels. An
impact loses its labels some time after it, and is gone then if another body's is newer.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import rerun as rr

from contact_dynamics.constants import ns_after
from contact_dynamics.diagrams.contact_scene import LETTERS
from contact_dynamics.diagrams.impact_scene import LABELS
from contact_dynamics.viewing.entities import CONTACTS, IMPACTS, WHOSE, entity
from contact_dynamics.viewing.measured import (
    OF_ONE_BODY,
    curves_of,
    draw_curves_of_one,
    draw_prediction_at,
    draw_states,
    set_time,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.tumbling import Trajectory
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.viewing.scenery import BodiesInWorld


LABELS_S: Final = 0.5  # s. The labels of an impact go this long after it, since they would cover the body.


class ImpactsInView:
    """The bodies with an impact in the scene, and until when it has labels."""

    def __init__(self, recording: rr.RecordingStream) -> None:
        """Begin without any."""
        self._recording = recording
        self._until_ns: dict[str, int] = {}
        self._newest = ""
        self._labelled = ""

    def come(self, body_name: str, *, stamp_ns: int, strike_ns: int) -> None:
        """Note the impact that is drawn at a stamp, ns, and happens at another. It is the newest."""
        if self._newest != body_name:
            self._clear_labels(stamp_ns)
            if self._until_ns.get(self._newest, stamp_ns) < stamp_ns:
                self._clear(self._newest, stamp_ns)
        self._newest = self._labelled = body_name
        self._until_ns[body_name] = ns_after(strike_ns, LABELS_S)

    def pass_by(self, body_name: str, stamp_ns: int) -> None:
        """Clear what is in the way of a body that was measured at a stamp, ns."""
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

    Of several bodies it is the one that was asked about, until its predicted motion is over and another is
    asked about. Curves of many bodies could not be told apart, and would cost what all else costs.
    """

    def __init__(self, recording: rr.RecordingStream) -> None:
        """Begin without any."""
        self._recording = recording
        self._until_ns = 0
        self.body_name: str | None = None

    def come(self, body_name: str, *, stamp_ns: int, end_ns: int) -> bool:
        """Note a prediction that begins and ends at these stamps, ns, and return if a turn begins."""
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


class LettersInView:
    """The body whose contacts have letters."""

    def __init__(self, recording: rr.RecordingStream) -> None:
        """Begin without any."""
        self._recording = recording
        self._lettered = ""

    def come(self, body_name: str, stamp_ns: int) -> None:
        """Note the body that the newest answer is about, and clear the letters of another, at a stamp, ns."""
        if self._lettered not in {"", body_name}:
            _clear_each(self._recording, [f"{entity(CONTACTS, self._lettered)}/{LETTERS}"], stamp_ns)
        self._lettered = body_name


def _clear_each(recording: rr.RecordingStream, paths: Iterable[str], stamp_ns: int) -> None:
    set_time(recording, stamp_ns)
    for path in paths:
        recording.log(path, rr.Clear(recursive=False))


MAX_KEPT: Final = 500
"""States of a body, 2 s at 250 Hz. An answer that comes later than that is not drawn beside the earliest."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Prediction:
    """Where a body was predicted to be.

    Attributes:
        begin_ns: When it begins, ns.
        trajectory: The motion.
        curves: Its curves by quantity, over the trajectory.
        number: Its number among those of its body, from 0 on.
    """

    begin_ns: int
    trajectory: Trajectory
    curves: dict[str, FloatArray]
    number: int


class PredictionsInView:
    """The newest predictions, and what is measured beside them."""

    def __init__(self, recording: rr.RecordingStream, bodies: BodiesInWorld, *, up_W: FloatArray) -> None:
        """Begin without any, for bodies of a world in which this direction is up."""
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
        """Draw measured states after the one before; return whether a prediction is drawn beside one."""
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
        """Note a prediction, from which curves are drawn until the next.

        Returns:
            Whether there are curves of energy now, and whether the prediction is drawn beside a state.
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
        """Draw the newest prediction of a body beside states, as far as it reaches; return if it does."""
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
