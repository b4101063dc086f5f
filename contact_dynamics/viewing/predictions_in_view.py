# SPDX-License-Identifier: Apache-2.0
"""The newest prediction of each body, with its curves and errors beside the states that are measured.

States may come before the answer that predicted them. So the newest states of a body are kept, and are
compared when the answer comes.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from contact_dynamics.constants import ns_after
from contact_dynamics.viewing.in_view import ConservedInView
from contact_dynamics.viewing.measured import (
    OF_ONE_BODY,
    curves_of,
    draw_curves_of_one,
    draw_prediction_at,
    draw_states,
    set_time,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    import rerun as rr

    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.tumbling import Trajectory
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.viewing.world_in_view import BodiesInWorld

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
