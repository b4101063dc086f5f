# SPDX-License-Identifier: Apache-2.0
"""This file interpolates the state of a body between two published ones.

Velocities are taken to change linearly from one state to the next, and the orientation to turn at a constant
rate about a fixed axis. Of the angles that lead from one orientation to the other, it turns by the one that
agrees with the published angular velocities, which may be more than half a turn. The position is the cubic
through both positions with both velocities. For a body in flight that is the exact parabola, since its
acceleration is constant. In general the error of the position grows as the fourth power of the time between
the states: a body on a circle of radius r that turns by an angle a between them is at most r a^4 / 384 beside
it.

An impact between the two states is smeared over the time between them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.constants import seconds_between
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.motion.whole_turns import THIRD_OF_A_TURN, turns_near
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rotations.many import turned

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray


def share_between(earlier: BodyState, later: BodyState, stamp_ns: int) -> float:
    """Return how far a stamp, ns, is on the way from one state to the other, in [0, 1]."""
    return seconds_between(earlier.stamp_ns, stamp_ns) / seconds_between(earlier.stamp_ns, later.stamp_ns)


def state_between(earlier: BodyState, later: BodyState, stamp_ns: int) -> BodyState:
    """Return the state at a stamp, ns, from ``earlier.stamp_ns`` to ``later.stamp_ns``, which differ.

    Raises:
        InvalidFieldError: the orientations differ from what the angular velocities say by a third of a turn
            or more, so that it is not known how the body turned.
    """
    seconds = seconds_between(earlier.stamp_ns, later.stamp_ns)
    share = share_between(earlier, later, stamp_ns)
    expected = 0.5 * seconds * (earlier.w_WB_W + later.w_WB_W)
    turn, rest = turns_near(later.q_WB[None], earlier.q_WB[None], expected[None])
    missed = float(np.linalg.norm(rest))
    if missed > THIRD_OF_A_TURN:
        raise InvalidFieldError(
            "stamp",
            f"one between states {seconds:.3g} s apart, whose orientations differ by {missed:.3g} rad from "
            "what their angular velocities say",
            "one between states with the angular velocities of the body, or closer together",
        )
    return BodyState(
        p_WB_W=_cubic(earlier, later, share, seconds),
        q_WB=turned(turned(earlier.q_WB[None], share * turn), share * rest)[0],
        v_WB_W=(1.0 - share) * earlier.v_WB_W + share * later.v_WB_W,
        w_WB_W=(1.0 - share) * earlier.w_WB_W + share * later.w_WB_W,
        stamp_ns=stamp_ns,
    )


def _cubic(earlier: BodyState, later: BodyState, share: float, seconds: float) -> FloatArray:
    """Return Hermite's cubic through both positions, with both velocities."""
    rest = 1.0 - share
    bent = share * rest * (rest * earlier.v_WB_W - share * later.v_WB_W) * seconds
    smooth = share * share * (3.0 - 2.0 * share)
    along: FloatArray = earlier.p_WB_W + smooth * (later.p_WB_W - earlier.p_WB_W) + bent
    return along
