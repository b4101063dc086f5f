# SPDX-License-Identifier: Apache-2.0
"""Converts ROS's covariances of poses and twists, (6, 6) each, to the covariance of a body's state.

ROS's order is x y z, then the rotations about the fixed axes x y z of the header's frame; for a twist, the
linear and the angular velocity in the twist's axes. By convention, a covariance of zeros, or with a negative
first number, is unknown.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.questions.uncertain_state import KnownState, UncertainState
from contact_dynamics.rigid_body.published_frame import covariance_of_other_point, velocity_of_published_frame
from contact_dynamics.rotations.one import cross_matrix, rotation_matrix

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray


def covariance_from_msg(numbers: Sequence[float]) -> FloatArray | None:
    """Return a covariance, (6, 6), or None if it is unknown."""
    covariance = np.array(numbers, dtype=np.float64).reshape(6, 6)
    return covariance if covariance[0, 0] >= 0.0 and covariance.any() else None


def of_pose_and_twist(pose: FloatArray | None, twist: FloatArray | None) -> FloatArray | None:
    """Return the joint covariance of independent errors, (12, 12), or None if one is unknown."""
    if pose is None or twist is None:
        return None
    both = np.zeros((12, 12))
    both[:6, :6], both[6:, 6:] = pose, twist
    return both


def with_covariance(
    state: BodyState, covariance_F: FloatArray | None, p_FB_F: FloatArray, *, twist_in_body_axes: bool
) -> KnownState:
    """Return a state with its covariance, or without it if that is unknown or invalid.

    Many sensors publish invalid covariances, and their states are used nevertheless. ``covariance_F``, (12,
    12), is that of the published pose and twist; ``p_FB_F``, (3,), m, is the centre of mass in the published
    frame F. If the published twist is in the axes of the body instead of the world, an error of the
    orientation turns the velocities too.
    """
    if covariance_F is None:
        return state
    if twist_in_body_axes:
        J = np.eye(12)
        J[6:9, 6:9] = J[9:, 9:] = rotation_matrix(state.q_WB)
        J[6:9, 3:6] = -cross_matrix(velocity_of_published_frame(state, p_FB_F))
        J[9:, 3:6] = -cross_matrix(state.w_WB_W)
        covariance_F = J @ covariance_F @ J.T
    try:
        covariance = covariance_of_other_point(covariance_F, state, p_FB_F)
        return UncertainState(state=state, covariance=covariance)
    except InvalidFieldError:
        return state
