"""How far a predicted state is from a measured one, in SI units and in standard deviations."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.rotations.many import rotation_vectors
from contact_dynamics.world import Surface

if TYPE_CHECKING:
    from contact_dynamics.questions.sample_times import Event
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import World


def pose_difference(predicted: BodyState, measured: BodyState) -> FloatArray:
    """Return how a measured pose differs, (6,): m, and rad of the rotation vector, world axes."""
    turn = rotation_vectors(measured.q_WB[None], predicted.q_WB)[0]
    return np.concatenate([measured.p_WB_W - predicted.p_WB_W, turn])


def velocity_difference(predicted: BodyState, measured: BodyState) -> FloatArray:
    """Return how measured velocities differ, (6,): m/s and rad/s, world axes."""
    return np.concatenate([measured.v_WB_W - predicted.v_WB_W, measured.w_WB_W - predicted.w_WB_W])


def in_deviations(difference: FloatArray, covariance: FloatArray, stds: FloatArray) -> float | None:
    """Return the Mahalanobis distance of a difference, (k,).

    Args:
        difference: What is predicted less what is measured, or the reverse.
        covariance: (k, k), of the prediction.
        stds: (k,), > 0, standard deviations of the measurement.

    Returns:
        The distance, or None if the covariance is not finite.
    """
    if not np.isfinite(covariance).all():
        return None
    scaled = covariance / np.outer(stds, stds) + np.eye(len(stds))  # regular: at least the measurement's
    ratios = difference / stds
    return math.sqrt(max(0.0, float(ratios @ np.linalg.solve(scaled, ratios))))


def arrival_std(event: Event, state: BodyState, covariance: FloatArray, world: World) -> float | None:
    """Return the standard deviation, s, of the time of arrival at a flat, or None at an obstacle.

    The point's height has the variance J C J^T of the pose's covariance C, (6, 6), with J = (n, r x n). It is
    divided by the speed of approach. This is first order in the deviations.
    """
    for surface in world.surfaces:
        if surface.name == event.surface and isinstance(surface, Surface):
            normal = surface.normal_W
            gradient = np.concatenate([normal, np.cross(event.point_W - state.p_WB_W, normal)])
            speed = abs(float(event.velocity_W @ normal))
            variance = float(gradient @ covariance @ gradient)
            return math.sqrt(max(variance, 0.0)) / speed if speed > 0.0 else None
    return None
