# SPDX-License-Identifier: Apache-2.0
"""A rigid body under forces by brute force: Euler's equations in body axes, by Runge and Kutta.

Slow, obvious, and sharing nothing with the package, in formulas or in variables.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]
Wrench = Callable[[float, FloatArray, FloatArray, FloatArray, FloatArray], tuple[FloatArray, FloatArray]]


def cross(a: FloatArray) -> FloatArray:
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def stepped(
    mass: float,
    I_B: ArrayLike,
    start: tuple[ArrayLike, ArrayLike, ArrayLike, ArrayLike],
    wrench: Wrench,
    *,
    duration: float,
    steps: int,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return p, R, v and w (world axes) after ``duration``, of a body that starts with p, R, v and w.

    ``wrench(t, p, R, v, w)`` is the force, gravity included, and the torque, both in world axes.
    """
    inertia = np.asarray(I_B)
    inverse = np.linalg.inv(inertia)

    def rate(t: float, y: FloatArray) -> FloatArray:
        p, v, w_B, R = y[:3], y[3:6], y[6:9], y[9:].reshape(3, 3)
        force, torque = wrench(t, p, R, v, R @ w_B)
        w_B_rate = inverse @ (R.T @ torque - np.cross(w_B, inertia @ w_B))
        return np.concatenate([v, force / mass, w_B_rate, (R @ cross(w_B)).ravel()])

    p, R, v, w = (np.asarray(x, dtype=float) for x in start)
    y = np.concatenate([p, v, R.T @ w, R.ravel()])
    h = duration / steps
    for i in range(steps):
        t = i * h
        a = rate(t, y)
        b = rate(t + h / 2, y + h / 2 * a)
        c = rate(t + h / 2, y + h / 2 * b)
        d = rate(t + h, y + h * c)
        y = y + h / 6 * (a + 2 * b + 2 * c + d)
    R = y[9:].reshape(3, 3)
    return y[:3], R, y[3:6], R @ y[6:9]
