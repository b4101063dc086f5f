# SPDX-License-Identifier: Apache-2.0
"""The comparison of one prediction with its measured event, and the differences of states."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.evaluation.settings import Law, Method
from contact_dynamics.measured.events import EventKind
from contact_dynamics.records import Record
from contact_dynamics.rotations.many import rotation_vectors
from contact_dynamics.world import Surface

if TYPE_CHECKING:
    from contact_dynamics.questions.sample_times import Event
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import World


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Comparison(Record):
    """One prediction of one event, and its errors."""

    event: int  # number of the event in its recording, from 0
    kind: EventKind
    body: str  # name of the body
    surface: str  # name of the surface; empty for a flight
    time: float  # time of the event, s after the recording's first state; for a toss, the time in its file
    horizon: float  # look-ahead time of the prediction, s
    method: Method  # source of the prediction's initial state
    law: Law | None = None  # impact law, or None if the prediction contains no impact
    refused: str = ""  # reason why there is no prediction; empty if there is one
    time_error: float | None = None  # s, predicted minus measured
    position_error: float | None = None  # m, distance of the predicted from the measured centre of mass
    attitude_error: float | None = None  # rad, angle between the predicted and the measured attitude
    velocity_error: float | None = None  # m/s, norm of the difference of linear velocities
    spin_error: float | None = None  # rad/s, norm of the difference of angular velocities
    predicted_mode: str = ""  # all consistent modes, or the verdict if there is none
    measured_mode: str = ""  # letters of the measured contacts
    mode_is_right: bool | None = None  # True if a consistent mode is of the measured kind, rest or sliding
    # Mahalanobis distance of the prediction from the measurement, with the covariances of both; with the
    # model error of a law, the normal distance of the same probability
    distance: float | None = None
    degrees: int = 0  # number of components in ``distance``
    several: bool = False  # True if several corners may have struck (`FoundEvent.several`)
    predicted: FloatArray | None = None  # (13,), predicted position, quaternion, linear and angular velocity


def pose_difference(predicted: BodyState, measured: BodyState) -> FloatArray:
    """Return measured minus predicted pose, (6,): m, and the rotation vector in rad, world axes."""
    turn = rotation_vectors(measured.q_WB[None], predicted.q_WB)[0]
    return np.concatenate([measured.p_WB_W - predicted.p_WB_W, turn])


def velocity_difference(predicted: BodyState, measured: BodyState) -> FloatArray:
    """Return measured minus predicted velocities, (6,): m/s and rad/s, world axes."""
    return np.concatenate([measured.v_WB_W - predicted.v_WB_W, measured.w_WB_W - predicted.w_WB_W])


def in_deviations(difference: FloatArray, covariance: FloatArray, stds: FloatArray) -> float | None:
    """Return the Mahalanobis distance of a prediction from a measurement, or None if not finite.

    ``difference``, (k,), is predicted minus measured values, or the reverse; ``covariance``, (k, k), is that
    of the prediction; ``stds``, (k,), > 0, are the standard deviations of the measurement.
    """
    if not np.isfinite(covariance).all():
        return None
    scaled = covariance / np.outer(stds, stds) + np.eye(len(stds))  # regular: at least the identity
    ratios = difference / stds
    return math.sqrt(max(0.0, float(ratios @ np.linalg.solve(scaled, ratios))))


def as_normal(distance: float, degrees: int, freedom: float) -> float:
    """Return the distance that a normal difference exceeds as often as Student's t exceeds a given distance.

    The ``distance``, with a number of components (``degrees``), is by the covariance of the t distribution's
    scale, whose degrees of freedom are ``freedom``, or infinity.
    """
    if math.isinf(freedom):
        return distance
    from scipy.special import chdtri, fdtrc

    return math.sqrt(float(chdtri(degrees, fdtrc(degrees, freedom, distance**2 / degrees))))


def arrival_std(event: Event, state: BodyState, covariance: FloatArray, world: World) -> float | None:
    """Return the standard deviation, s, of the time of arrival at a plane, or None at an obstacle.

    The point's height has the variance J C J^T of the pose's covariance C, (6, 6), with J = (n, r x n). The
    standard deviation of the time is that of the height, divided by the speed of approach (first order).
    """
    for surface in world.surfaces:
        if surface.name == event.surface and isinstance(surface, Surface):
            normal = surface.normal_W
            gradient = np.concatenate([normal, np.cross(event.point_W - state.p_WB_W, normal)])
            speed = abs(float(event.velocity_W @ normal))
            variance = float(gradient @ covariance @ gradient)
            return math.sqrt(max(variance, 0.0)) / speed if speed > 0.0 else None
    return None
