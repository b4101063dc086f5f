# SPDX-License-Identifier: Apache-2.0
"""A free body stepped by an integrator: L is constant in the world, w = I^-1 L, R' = [w] R (lecture 25)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

FloatArray = NDArray[np.float64]


def stepped(
    I_B: ArrayLike, q_WB: ArrayLike, w_WB_W: ArrayLike, seconds: list[float]
) -> tuple[list[Rotation], FloatArray]:
    """Return attitudes, and angular velocities (n, 3) in world axes, at times that go one way from 0."""
    inertia = np.asarray(I_B)
    inverse = np.linalg.inv(inertia)
    R0 = Rotation.from_quat(q_WB).as_matrix()
    L = R0 @ inertia @ R0.T @ np.asarray(w_WB_W)

    def slope(_: float, y: FloatArray) -> FloatArray:
        R = y.reshape(3, 3)
        w = R @ inverse @ R.T @ L
        return np.cross(w, R, axisb=0, axisc=0).ravel()

    solution = solve_ivp(
        slope, (0.0, seconds[-1]), R0.ravel(), t_eval=seconds, method="DOP853", rtol=1e-12, atol=1e-13
    )
    matrices = solution.y.T.reshape(-1, 3, 3)
    return [Rotation.from_matrix(R) for R in matrices], np.array([R @ inverse @ R.T @ L for R in matrices])
