# SPDX-License-Identifier: Apache-2.0
"""The motion of a body whose contacts are held, integrated in high precision and without the package.

The unknowns of each instant are the six accelerations and three force components for each contact. Newton's
and Euler's equations, and three equations for each contact, are solved together as one dense system. The
rotation matrix itself is integrated, by DOP853 of SciPy.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp


class HeldBody(NamedTuple):
    """A body with corners on the plane z = 0, under gravity along -z."""

    mass: float
    inertia_B: np.ndarray
    corners_B: np.ndarray
    friction: float
    gravity: float


def cross_matrix(a: np.ndarray) -> np.ndarray:
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def accelerations(body: HeldBody, x: np.ndarray, corners: tuple[int, ...], letters: str) -> np.ndarray:
    """Return a, alpha, and the force at each contact, for x = p, R (9 numbers, by rows), v, w."""
    R, v, w = x[3:12].reshape(3, 3), x[12:15], x[15:]
    inertia = R @ body.inertia_B @ R.T
    count = len(corners)
    matrix = np.zeros((6 + 3 * count, 6 + 3 * count))
    right = np.zeros(6 + 3 * count)
    matrix[:3, :3] = body.mass * np.eye(3)
    matrix[3:6, 3:6] = inertia
    right[:3] = [0.0, 0.0, -body.mass * body.gravity]
    right[3:6] = -np.cross(w, inertia @ w)
    for k, (corner, letter) in enumerate(zip(corners, letters, strict=True)):
        arm = R @ body.corners_B[corner]
        mine = slice(6 + 3 * k, 9 + 3 * k)
        matrix[:3, mine] = -np.eye(3)
        matrix[3:6, mine] = -cross_matrix(arm)
        inwards = np.cross(w, np.cross(w, arm))
        if letter == "f":
            matrix[mine, :3] = np.eye(3)
            matrix[mine, 3:6] = -cross_matrix(arm)
            right[mine] = -inwards
        else:
            first = 6 + 3 * k
            matrix[first, 2] = 1.0
            matrix[first, 3:6] = -cross_matrix(arm)[2]
            right[first] = -inwards[2]
            velocity = (v + np.cross(w, arm))[:2]
            direction = velocity / np.linalg.norm(velocity)
            for axis in (0, 1):
                matrix[first + 1 + axis, first + axis] = 1.0
                matrix[first + 1 + axis, first + 2] = body.friction * direction[axis]
    unknowns: np.ndarray = np.linalg.lstsq(matrix, right, rcond=1e-12)[0]
    return unknowns


def held_motion(
    body: HeldBody, x: np.ndarray, corners: tuple[int, ...], letters: str, seconds: np.ndarray
) -> np.ndarray:
    """Return x, (n, 18), at times from 0, s, as long as the contacts are held as the letters say."""

    def rates(_: float, x: np.ndarray) -> np.ndarray:
        a = accelerations(body, x, corners, letters)
        turned = cross_matrix(x[15:]) @ x[3:12].reshape(3, 3)
        return np.concatenate([x[12:15], turned.ravel(), a[:6]])

    found = solve_ivp(
        rates, (0.0, float(seconds[-1])), x, method="DOP853", rtol=1e-11, atol=1e-13, t_eval=seconds
    )
    assert found.success, found.message
    rows: np.ndarray = found.y.T
    return rows
