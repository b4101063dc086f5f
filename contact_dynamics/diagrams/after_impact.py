# SPDX-License-Identifier: Apache-2.0
"""Compares the velocity that a body has after an impact with the one that was predicted.

The measured velocity is found from the poses after the impact alone, as `motion.velocity_estimate` finds
velocities: a published velocity would often be that of a window which spans the impact. If the body strikes
again within `SPAN_S`, the measured velocity is an average over both strikes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.constants import ns_after, seconds_since, to_ns
from contact_dynamics.motion.velocity_estimate import FEWEST_FRAMES, WINDOW, velocity_at

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.questions.impact_question import ImpactAnswer
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray

SPAN_S: Final = WINDOW  # s. Velocities are found from the poses of this time after the impact.
LATE_S: Final = 0.003  # s. Largest delay of a strike after its prediction. Earlier poses are left out.

KEPT_S: Final = 0.5
"""s. Duration of the stored states, for answers that arrive after them. If states are drawn seldom, or an
answer takes long, the delay is a few tenths of a second."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AfterImpact:
    """The motion of a body after an impact, beside the prediction."""

    answer: ImpactAnswer  # the prediction
    # The stamps of the poses that the velocities are found from, and of the curves.
    stamps_ns: tuple[int, ...]
    # (3,), m/s, the measured velocity of the centre of mass when the impact was predicted to end.
    v_WB_W: FloatArray
    w_WB_W: FloatArray  # (3,), rad/s, the measured angular velocity then
    predicted_speeds: FloatArray  # (n,), m/s, at the stamps, if the body flies on as predicted
    measured_speeds: FloatArray  # (n,), m/s, at the stamps

    @property
    def linear_error(self) -> float:
        """Return how far the measured velocity is from the predicted one, m/s."""
        return float(np.linalg.norm(self.v_WB_W - self.answer.impact.state.v_WB_W))

    @property
    def angular_error(self) -> float:
        """Return how far the measured angular velocity is from the predicted one, rad/s."""
        return float(np.linalg.norm(self.w_WB_W - self.answer.impact.state.w_WB_W))


class AwaitedImpacts:
    """The predicted impacts of bodies that are not over, or not measured enough yet.

    An answer may arrive after the states that show its outcome, so the latest states are stored.
    """

    def __init__(self, *, gravity_W: FloatArray) -> None:
        """Begin without any. ``gravity_W`` is (3,), m/s^2, world axes."""
        self._gravity_W = gravity_W
        self._awaited: dict[str, list[tuple[int, ImpactAnswer]]] = {}
        self._seen: dict[str, list[BodyState]] = {}  # since the first awaited impact, and the newest

    def expect(self, answer: ImpactAnswer, *, now_ns: int) -> None:
        """Wait for an impact. If it has been measured already, `see` returns it the next time.

        It replaces those that have not begun by ``now_ns``, ns, either. Without a stamp, its time is unknown.
        """
        strike_ns = answer.impact.state.stamp_ns or answer.state.stamp_ns
        if not strike_ns:
            return
        oldest_ns = now_ns - to_ns(KEPT_S)  # earlier ones are of a body without states
        awaited = self._awaited.get(answer.body_name, [])
        begun = [each for each in awaited if oldest_ns <= each[0] < now_ns]
        self._awaited[answer.body_name] = [*begun, (strike_ns, answer)]

    def see(self, body_name: str, states: Sequence[BodyState]) -> list[AfterImpact]:
        """Take measured states in the order of their stamps, and return the impacts that are now compared.

        Where stamps fall by more than `KEPT_S`, the clock was set back, and what was before is forgotten.
        """
        seen = self._seen.setdefault(body_name, [])
        if seen and states and states[0].stamp_ns < seen[-1].stamp_ns - to_ns(KEPT_S):
            seen.clear()
            self._awaited.pop(body_name, None)
        seen.extend(states)
        return self._compared(body_name)

    def _compared(self, body_name: str) -> list[AfterImpact]:
        """Return the impacts of which enough has been seen, and forget them, with states that are too old."""
        seen, awaited = self._seen.get(body_name), self._awaited.get(body_name, [])
        if not seen:
            return []
        newest_ns = seen[-1].stamp_ns
        over = [each for each in awaited if newest_ns > each[0] + to_ns(SPAN_S)]
        self._awaited[body_name] = awaited = [each for each in awaited if each not in over]
        compared = [self._compare(answer, strike_ns, seen) for strike_ns, answer in over]
        first_ns = min([newest_ns - to_ns(KEPT_S), *(strike_ns for strike_ns, _ in awaited)])
        if seen[0].stamp_ns < first_ns:
            self._seen[body_name] = [state for state in seen if state.stamp_ns >= first_ns]
        return [each for each in compared if each is not None]

    def _compare(self, answer: ImpactAnswer, strike_ns: int, seen: list[BodyState]) -> AfterImpact | None:
        """Return the comparison, or None if there are too few poses."""
        begin_ns, end_ns = ns_after(strike_ns, LATE_S), ns_after(strike_ns, SPAN_S)
        states = [state for state in seen if begin_ns <= state.stamp_ns <= end_ns]
        if len(states) < FEWEST_FRAMES:
            return None
        stamps_ns = tuple(state.stamp_ns for state in states)
        seconds = seconds_since(strike_ns, stamps_ns)
        p_W = np.array([state.p_WB_W for state in states])
        q = np.array([state.q_WB for state in states])
        v_W, w_W = velocity_at(0.0, seconds, p_W, q)
        measured_W = [velocity_at(t, seconds, p_W, q)[0] for t in seconds.tolist()]
        predicted_W = answer.impact.state.v_WB_W + np.outer(seconds, self._gravity_W)
        return AfterImpact(
            answer=answer,
            stamps_ns=stamps_ns,
            v_WB_W=v_W,
            w_WB_W=w_W,
            predicted_speeds=np.linalg.norm(predicted_W, axis=1),
            measured_speeds=np.linalg.norm(measured_W, axis=1),
        )
