# SPDX-License-Identifier: Apache-2.0
"""Gaps between exactly moved bodies, in many digits, and their second derivatives by differences.

Slow, obvious, and sharing nothing with the package. Each gap is a function of a pose (p, R); a pose moves
with given velocity and acceleration, and gaps are differentiated numerically, so that no formula of
curvature, rolling or Coriolis enters. To be used within `mp.workdps(DIGITS)`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from mpmath import mp, mpf

DIGITS = 40
STEP = mpf(10) ** -12

Vector = Any  # an mpmath matrix, (3, 1)
Pose = tuple[Any, Any]
Gap = Callable[[Pose], Any]


def vec(values: Any) -> Vector:
    return mp.matrix([mpf(float(x)) if not isinstance(x, mpf) else x for x in values])


def dot(a: Vector, b: Vector) -> Any:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    return mp.matrix([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def length(a: Vector) -> Any:
    return mp.sqrt(dot(a, a))


def turn(theta: Vector) -> Any:
    """The rotation matrix of a rotation vector, by the exponential's series."""
    K = mp.matrix([[0, -theta[2], theta[1]], [theta[2], 0, -theta[0]], [-theta[1], theta[0], 0]])
    R, term = mp.eye(3), mp.eye(3)
    for i in range(1, 60):
        term = term * K / i
        R = R + term
    return R


def moved(v: Vector, a: Vector, w: Vector, alpha: Vector, t: Any) -> Pose:
    """The pose after t of a body that is at the origin and not turned at 0, to second order in t exactly."""
    return v * t + a * (t * t / 2), turn(w * t + alpha * (t * t / 2))


def second_derivative(gap: Gap, pose_at: Callable[[Any], Pose]) -> float:
    values = [gap(pose_at(t)) for t in (-STEP, mpf(0), STEP)]
    return float((values[0] - 2 * values[1] + values[2]) / (STEP * STEP))


def first_derivative(function: Callable[[Any], Vector]) -> np.ndarray:
    ahead, back = function(STEP), function(-STEP)
    return np.array([float((ahead[i] - back[i]) / (2 * STEP)) for i in range(3)])


# Gaps: a body's feature, in body coordinates from its reference point p, to a feature of the world.


def ball_to_plane(center: Vector, radius: Any, point: Vector, normal: Vector) -> Gap:
    return lambda pose: dot(normal, pose[0] + pose[1] * center - point) - radius


def ellipsoid_to_ball(semiaxes: Vector, center: Vector, radius: Any) -> Gap:
    return lambda pose: outside_ellipsoid(semiaxes, pose[1].T * (center - pose[0])) - radius


def flat_to_point(face_point: Vector, inward: Vector, point: Vector) -> Gap:
    return lambda pose: dot(pose[1] * inward, pose[0] + pose[1] * face_point - point)


def edge_to_edge(point_B: Vector, along_B: Vector, point: Vector, along: Vector, into_body: Vector) -> Gap:
    def gap(pose: Pose) -> Any:
        across = cross(pose[1] * along_B, along)
        across = across / length(across)
        if dot(across, into_body) < 0:
            across = -across
        return dot(across, pose[0] + pose[1] * point_B - point)

    return gap


def edge_to_ball(point_B: Vector, along_B: Vector, center: Vector, radius: Any) -> Gap:
    def gap(pose: Pose) -> Any:
        arm = center - pose[0] - pose[1] * point_B
        return length(cross(pose[1] * along_B, arm)) / length(along_B) - radius

    return gap


def rim_to_plane(center: Vector, axis: Vector, radius: Any, normal: Vector) -> Gap:
    def gap(pose: Pose) -> Any:
        along = dot(normal, pose[1] * axis)
        return dot(normal, pose[0] + pose[1] * center) - radius * mp.sqrt(1 - along * along)

    return gap


def outside_ellipsoid(semiaxes: Vector, point: Vector) -> Any:
    """The distance of a point outside: along the normal from the foot with x_i = a_i^2 y_i / (a_i^2 + s)."""

    def excess(s: Any) -> Any:
        return sum((semiaxes[i] * point[i] / (semiaxes[i] ** 2 + s)) ** 2 for i in range(3)) - 1

    s = mp.findroot(excess, length(point) * max(semiaxes) / 10, tol=mpf(10) ** -70, maxsteps=200)
    return mp.sqrt(sum((point[i] * s / (semiaxes[i] ** 2 + s)) ** 2 for i in range(3)))
