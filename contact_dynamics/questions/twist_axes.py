# SPDX-License-Identifier: Apache-2.0
"""Detects whether published velocities are in the wrong axes, by comparison with the poses."""

from __future__ import annotations

import statistics
from collections import deque
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.constants import seconds_between
from contact_dynamics.questions.uncertain_state import state_of

if TYPE_CHECKING:
    from contact_dynamics.questions.state_store import StateStore
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray

_PAIRS: Final = 20
_PAIRS_A_LOOK: Final = 20  # enough to detect it in the first throw
_APART_S: Final = 0.02  # over it, 1 mm of noise in a position causes 0.1 m/s
_LONGEST_S: Final = 0.5
_SLOW: Final = 0.1  # m/s
_SHARE: Final = 0.2


class TwistAxes:
    """Checks the states of one body, which are published with velocities in the body's axes.

    The most frequent mistake is to publish them in the world's axes. After an impact, or with noise or a
    wrong clock, velocities and poses disagree too, but do not agree in other axes.
    """

    def __init__(self, body_name: str, p_FB_F: FloatArray) -> None:
        """Begin to check a body whose centre of mass is at ``p_FB_F``, (3,), m, in its frame."""
        self._body_name = body_name
        self._p_FB_F = p_FB_F
        self._newest_ns = 0
        self._found: deque[float] = deque(maxlen=_PAIRS)

    def look(self, states: StateStore) -> float | None:
        """Check some of the states since the last call, once a second.

        If the velocities of most of the last pairs of states agree with the poses in the world's axes only,
        return their median difference, m/s. Otherwise, and without new states, return None.
        """
        pairs, newest_ns = states.pairs(
            self._body_name, after_ns=self._newest_ns, apart=_APART_S, count=_PAIRS_A_LOOK
        )
        if newest_ns == self._newest_ns:
            self._found.clear()
        self._newest_ns = newest_ns
        self._found.extend(disagreement(state_of(one), state_of(other), self._p_FB_F) for one, other in pairs)
        wrong = [each for each in self._found if each > 0.0]
        return statistics.median(wrong) if 2 * len(wrong) > _PAIRS else None


def disagreement(one: BodyState, other: BodyState, p_FB_F: FloatArray) -> float:
    """Return the difference between two states' mean velocity and the mean rate of their positions, m/s.

    It is 0 if they agree, to 0.1 m/s or a fifth, or if they would not agree in the world's axes either. The
    acceleration is assumed constant between the states.
    """
    elapsed = seconds_between(one.stamp_ns, other.stamp_ns)
    if not 0.0 < elapsed <= _LONGEST_S:
        return 0.0
    travelled = (other.p_WB_W - one.p_WB_W) / elapsed
    published = 0.5 * (one.v_WB_W + other.v_WB_W)
    off, allowed = _off(travelled, published)
    if off <= allowed:
        return 0.0
    off_in_world, allowed = _off(travelled, 0.5 * (_in_world(one, p_FB_F) + _in_world(other, p_FB_F)))
    return off if off_in_world <= allowed else 0.0


def _off(travelled: FloatArray, velocity: FloatArray) -> tuple[float, float]:
    """Return the difference of two velocities, and its limit, m/s."""
    return float(np.linalg.norm(travelled - velocity)), max(_SLOW, _SHARE * float(np.linalg.norm(travelled)))


def _in_world(state: BodyState, p_FB_F: FloatArray) -> FloatArray:
    """Return the velocity of the centre of mass, (3,), m/s, if the twist was published in world axes."""
    R_WB = state.R_WB
    p_FB_W = R_WB @ p_FB_F
    linear = R_WB.T @ (state.v_WB_W - np.cross(state.w_WB_W, p_FB_W))
    found: FloatArray = linear + np.cross(R_WB.T @ state.w_WB_W, p_FB_W)
    return found
