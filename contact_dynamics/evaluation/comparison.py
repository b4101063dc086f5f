# SPDX-License-Identifier: Apache-2.0
"""One prediction beside what was measured, the row of every table, and how far states are apart."""

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
    """One question about one event, and how far its answer was from what came.

    Attributes:
        event: Number of the event in its recording, from 0.
        kind: What happened.
        body: The body's name.
        surface: The surface's name; empty for a flight.
        time: When the event was, s after the recording's first state; for a toss, as its file has it.
        horizon: How long before it was asked, s.
        method: What the prediction was made from.
        law: The law of the impact. It is None where no impact was asked about.
        refused: Why there was no answer. It is empty if there was one.
        time_error: s, predicted less measured.
        position_error: m, distance of the centre of mass from where it was.
        attitude_error: rad, angle to the attitude that it had.
        velocity_error: m/s, size of the difference of linear velocities.
        spin_error: rad/s, size of the difference of angular velocities.
        predicted_mode: All consistent modes, or the verdict where there is none.
        measured_mode: The letters of the measured contacts.
        mode_is_right: Whether a consistent mode does what was measured: rest or slide.
        distance: How far the answer is off in standard deviations (Mahalanobis), by its own covariance and
            that of the measurement.
        degrees: Number of components that ``distance`` is over.
        several: Whether an impact may be that of several corners, as `FoundEvent` has it.
        predicted: (13,), position, quaternion, linear and angular velocity as predicted.
    """

    event: int
    kind: EventKind
    body: str
    surface: str
    time: float
    horizon: float
    method: Method
    law: Law | None = None
    refused: str = ""
    time_error: float | None = None
    position_error: float | None = None
    attitude_error: float | None = None
    velocity_error: float | None = None
    spin_error: float | None = None
    predicted_mode: str = ""
    measured_mode: str = ""
    mode_is_right: bool | None = None
    distance: float | None = None
    degrees: int = 0
    several: bool = False
    predicted: FloatArray | None = None


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
