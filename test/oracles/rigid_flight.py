# SPDX-License-Identifier: Apache-2.0
"""The flight of a rigid body by brute force: Euler's equations and the quaternion's rate by Runge and Kutta.

Slow, obvious, and sharing nothing with the package. Quaternions are w, x, y, z inside and x, y, z, w outside.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike


class Motion(NamedTuple):
    p: np.ndarray  # (n, 3), m
    q: np.ndarray  # (n, 4), x, y, z, w
    v: np.ndarray  # (n, 3), m/s
    w: np.ndarray  # (n, 3), rad/s, world axes


def multiply(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Hamilton's product, w first."""
    return np.array(
        [
            a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
            a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
            a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
        ]
    )


def matrix(q_xyzw: np.ndarray) -> np.ndarray:
    """The rotation matrix, column by column: each body axis turned by q (.) q*."""
    q = np.array([q_xyzw[3], q_xyzw[0], q_xyzw[1], q_xyzw[2]])
    conjugate = q * [1.0, -1.0, -1.0, -1.0]
    axes = [multiply(multiply(q, np.array([0.0, *axis])), conjugate)[1:] for axis in np.eye(3)]
    return np.array(axes).T


def about(axis: ArrayLike, angle: float) -> np.ndarray:
    """The quaternion, x, y, z, w, of a turn by ``angle`` about a unit ``axis``."""
    return np.array([*(math.sin(angle / 2.0) * np.asarray(axis)), math.cos(angle / 2.0)])


def rate(y: np.ndarray, moments: np.ndarray) -> np.ndarray:
    """The rates of the quaternion, w first, and of the angular velocity in body axes: Euler's equations."""
    q, w = y[:4], y[4:]
    return np.concatenate([0.5 * multiply(q, np.array([0.0, *w])), -np.cross(w, moments * w) / moments])


def fly(
    times: ArrayLike,
    p: ArrayLike,
    q_xyzw: np.ndarray,
    v: ArrayLike,
    w_W: ArrayLike,
    *,
    moments: ArrayLike = (1.0, 1.0, 1.0),
    gravity: float = 9.81,
    step: float = 1e-3,
) -> Motion:
    """The motion at ``times``, of either sign; the state given is the one at time 0.

    ``moments``: principal moments about the body's axes. With steps of 1 ms the orientation of a body at
    20 rad/s is off by less than 1e-7 rad after half a second.
    """
    moments, p, v = np.asarray(moments, float), np.asarray(p), np.asarray(v)
    down = np.array([0.0, 0.0, -gravity])
    y = np.concatenate([[q_xyzw[3], *q_xyzw[:3]], matrix(q_xyzw).T @ np.asarray(w_W)])
    clock = 0.0
    rows = []
    for time in np.asarray(times).tolist():
        count = max(1, math.ceil(abs(time - clock) / step))
        h = (time - clock) / count
        clock = time
        for _ in range(count):
            k1 = rate(y, moments)
            k2 = rate(y + 0.5 * h * k1, moments)
            k3 = rate(y + 0.5 * h * k2, moments)
            k4 = rate(y + h * k3, moments)
            y = y + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        q = y[:4] / np.linalg.norm(y[:4])
        q_out = np.array([*q[1:], q[0]])
        w_out = matrix(q_out) @ y[4:]
        rows.append([*(p + v * time + 0.5 * down * time * time), *q_out, *(v + down * time), *w_out])
    table = np.array(rows).reshape(-1, 13)
    return Motion(table[:, :3], table[:, 3:7], table[:, 7:10], table[:, 10:])
