# SPDX-License-Identifier: Apache-2.0
"""Finds out whether published velocities are in other axes than they should be, by the poses between them."""

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
_PAIRS_A_LOOK: Final = 20  # so that the first throw is enough
_APART_S: Final = 0.02  # noise of 1 mm in a position is 0.1 m/s of a velocity
_LONGEST_S: Final = 0.5
_SLOW: Final = 0.1  # m/s
_SHARE: Final = 0.2


class TwistAxes:
    """Watches the states of one body, which are published with their velocities in the body's axes.

    The commonest mistake is to publish them in the world's axes. An impact, noise or a clock that is wrong
    also makes velocities and poses disagree, but not so that they agree in other axes.
    """

    def __init__(self, body_name: str, p_FB_F: FloatArray) -> None:
        """Begin to watch a body, whose centre of mass is at ``p_FB_F``, (3,), m, in its frame."""
        self._body_name = body_name
        self._p_FB_F = p_FB_F
        self._newest_ns = 0
        self._found: deque[float] = deque(maxlen=_PAIRS)

    def look(self, states: StateStore) -> float | None:
        """Look at some of the states that came since the last look, once a second.

        Returns:
            m/s, by how much velocities and poses disagree, if the velocities of most of the last pairs of
            states agree with the poses in the world's axes only. Otherwise, and if no state came, None.
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
    """Return by how much two states' velocities disagree with the way between them, m/s.

    It is 0 if they agree, to 0.1 m/s or a fifth, or if they would not agree in the world's axes either. The
    acceleration counts as constant from one to the other.
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
    """Return the difference of two velocities, and how large it may be, m/s."""
    return float(np.linalg.norm(travelled - velocity)), max(_SLOW, _SHARE * float(np.linalg.norm(travelled)))


def _in_world(state: BodyState, p_FB_F: FloatArray) -> FloatArray:
    """Return the velocity of the centre of mass, (3,), m/s, if the twist was published in world axes."""
    R_WB = state.R_WB
    p_FB_W = R_WB @ p_FB_F
    linear = R_WB.T @ (state.v_WB_W - np.cross(state.w_WB_W, p_FB_W))
    found: FloatArray = linear + np.cross(R_WB.T @ state.w_WB_W, p_FB_W)
    return found
