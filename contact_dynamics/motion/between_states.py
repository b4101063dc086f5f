"""This file interpolates the state of a body between two published ones.

Velocities are taken to change linearly from one state to the next, and the orientation to turn at a constant
rate about a fixed axis, by the smaller of the two angles. The position is the cubic through both positions
with both velocities. For a body in flight that is the exact parabola, since its acceleration is constant. In
general the error of the position grows as the fourth power of the time between the states: a body on a circle
of radius r that turns by an angle a between them is at most r a^4 / 384 beside it.

An impact between the two states is smeared over the time between them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from contact_dynamics.constants import seconds_between
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rotations.many import rotation_vectors, turned

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray


def share_between(earlier: BodyState, later: BodyState, stamp_ns: int) -> float:
    """Return how far a stamp, ns, is on the way from one state to the other, in [0, 1]."""
    return seconds_between(earlier.stamp_ns, stamp_ns) / seconds_between(earlier.stamp_ns, later.stamp_ns)


def state_between(earlier: BodyState, later: BodyState, stamp_ns: int) -> BodyState:
    """Return the state at a stamp, ns, from ``earlier.stamp_ns`` to ``later.stamp_ns``, which differ."""
    seconds = seconds_between(earlier.stamp_ns, later.stamp_ns)
    share = share_between(earlier, later, stamp_ns)
    turn = rotation_vectors(later.q_WB[None], earlier.q_WB[None])
    return BodyState(
        p_WB_W=_cubic(earlier, later, share, seconds),
        q_WB=turned(earlier.q_WB[None], share * turn)[0],
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
