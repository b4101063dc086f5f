# SPDX-License-Identifier: Apache-2.0
"""Interpolates the state of a body between two published states.

Velocities are interpolated linearly, and the orientation turns at a constant rate about a fixed axis. Of the
angles that connect both orientations, the one that agrees with the published angular velocities is used,
which may exceed half a turn. The position is the cubic through both positions with both velocities, which is
exact for the parabola of a flight. In general, the error of the position grows as the fourth power of the
time between the states: for a body on a circle of radius r that turns by an angle a between them, it is at
most r a^4 / 384.

An impact between the two states is spread over the time between them.
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
    """Return the position of a stamp, ns, between those of two states, in [0, 1]."""
    return seconds_between(earlier.stamp_ns, stamp_ns) / seconds_between(earlier.stamp_ns, later.stamp_ns)


def state_between(earlier: BodyState, later: BodyState, stamp_ns: int) -> BodyState:
    """Return the state at a stamp, ns, from ``earlier.stamp_ns`` to ``later.stamp_ns``, which differ.

    Raises:
        InvalidFieldError: the orientations differ from those expected from the angular velocities by at least
            a third of a turn, so that the rotation is ambiguous.
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
