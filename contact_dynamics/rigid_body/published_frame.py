# SPDX-License-Identifier: Apache-2.0
"""This file converts between the published frame of a body and the one that the physics uses.

F is the body's published frame. B is the frame of the physics, with the same axes and its origin at the
centre of mass. W is the world. A published velocity belongs to F's origin, so it must be carried over to the
centre of mass: v_B = v_F + w x p_FB.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rotations.many import rotated
from contact_dynamics.rotations.one import cross_matrix, rotation_matrix
from contact_dynamics.validation import check_unit

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray

_ORIGIN: Final = [0.0, 0.0, 0.0]


def turned(q_WB: FloatArray, vector_B: FloatArray) -> FloatArray:
    """Turn a vector, (3,), from body axes into world axes. A zero vector, the usual one, costs nothing."""
    if vector_B.tolist() == _ORIGIN:
        return vector_B
    vector_W: FloatArray = rotation_matrix(q_WB) @ vector_B
    return vector_W


def state_of_center_of_mass(
    *,
    p_WF_W: FloatArray,
    q_WF: FloatArray,
    v_WF_W: FloatArray,
    w_WF_W: FloatArray,
    p_FB_F: FloatArray,
    stamp_ns: int,
) -> BodyState:
    """Return the state of B from pose and velocity of F's origin, all in world axes.

    Raises:
        InvalidFieldError: a number is not finite, or the quaternion is not unit.
    """
    p_WB_W, v_WB_W = p_WF_W, v_WF_W
    if p_FB_F.any():
        p_FB_W = rotation_matrix(check_unit("q_WF", q_WF, 4)) @ p_FB_F
        p_WB_W, v_WB_W = p_WF_W + p_FB_W, v_WF_W + cross_matrix(w_WF_W) @ p_FB_W
    return BodyState(p_WB_W=p_WB_W, q_WB=q_WF, v_WB_W=v_WB_W, w_WB_W=w_WF_W, stamp_ns=stamp_ns)


def origin_of_published_frame(state: BodyState, p_FB_F: FloatArray) -> FloatArray:
    """Return the position of F's origin, (3,), m, world."""
    return state.p_WB_W - turned(state.q_WB, p_FB_F)


def origins_of_published_frame(p_WB_W: FloatArray, q_WB: FloatArray, p_FB_F: FloatArray) -> FloatArray:
    """Return the positions of F's origin, (n, 3), m, world, from those of B and quaternions, (n, 4)."""
    if not p_FB_F.any():
        return p_WB_W
    return p_WB_W - rotated(q_WB, p_FB_F)


def centers_of_mass(p_WF_W: FloatArray, q_WB: FloatArray, p_FB_F: FloatArray) -> FloatArray:
    """Return the positions of B, (n, 3), m, world, from those of F's origin and quaternions, (n, 4)."""
    if not p_FB_F.any():
        return p_WF_W
    return p_WF_W + rotated(q_WB, p_FB_F)


def velocity_of_published_frame(state: BodyState, p_FB_F: FloatArray) -> FloatArray:
    """Return the velocity of F's origin, (3,), m/s, world axes."""
    return state.velocity_of_point(origin_of_published_frame(state, p_FB_F))


def covariance_of_other_point(covariance: FloatArray, state: BodyState, lever_B: FloatArray) -> FloatArray:
    """Return the covariance of a body's state with another of its points for the position and its velocity.

    Covariances are (12, 12), in the order position (m), rotation vector (rad, world axes, a small rotation
    applied after the orientation), linear velocity (m/s), angular velocity (rad/s).
    ``lever_B``, (3,), m, is from the point of the given covariance to the other one.
    """
    lever = cross_matrix(turned(state.q_WB, lever_B))
    J = np.eye(12)
    J[:3, 3:6] = J[6:9, 9:] = -lever
    J[6:9, 3:6] = -cross_matrix(state.w_WB_W) @ lever
    moved: FloatArray = J @ covariance @ J.T
    return moved
