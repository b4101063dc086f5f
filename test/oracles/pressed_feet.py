# SPDX-License-Identifier: Apache-2.0
"""A body on a floor whose feet carry known loads: the one motion that it then begins.

Friction does the most it can, so that what it leaves of the applied wrench, in the metric of kinetic energy,
is least: one non-negative least-squares problem.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import lsq_linear

HEAVY = 1e4  # how much a load's sum counts beside the motion; its error is then about 1e-8


def drawn_loads(corners: np.ndarray, total: float, centre: np.ndarray, seed: int) -> np.ndarray:
    """Return loads, (n,), that add up to a total whose centre is given: a mixture of triangles' loads."""
    chance = np.random.default_rng(seed)
    loads = np.zeros(len(corners))
    while np.count_nonzero(loads) < 3 or chance.random() < 0.5:
        chosen = chance.choice(len(corners), size=3, replace=False)
        system = np.vstack([corners[chosen].T, np.ones(3)])
        if abs(np.linalg.det(system)) < 1e-6:
            continue
        shares = np.linalg.solve(system, np.append(centre, 1.0))
        if shares.min() >= 0.0:
            part = chance.random() if loads.any() else 1.0
            loads *= 1.0 - part
            loads[chosen] += part * total * shares
    return loads


def motion_under(
    mass: float,
    inertia: float,
    *,
    corners: np.ndarray,
    edges: np.ndarray,
    loads: np.ndarray,
    wrench: np.ndarray,
) -> np.ndarray:
    """Return the accelerations (x, y, about z) of a body at rest.

    Args:
        mass: kg.
        inertia: kg m^2, about the vertical axis through the centre of mass.
        corners: (n, 2), m, from the centre of mass.
        edges: (n, K, 2), friction per load at the corners of each foot's friction polygon.
        loads: (n,), N.
        wrench: (3,), applied force along x and y, torque about z.
    """
    roots = np.sqrt([mass, mass, inertia])
    columns, sums = [], []
    for i, (x, y) in enumerate(corners):
        for f_x, f_y in edges[i]:
            columns.append(np.array([f_x, f_y, x * f_y - y * f_x]) / roots)
            sums.append(np.eye(len(corners))[i])
    system = np.vstack([np.array(columns).T, HEAVY * np.array(sums).T])
    right = np.concatenate([-wrench / roots, HEAVY * loads])
    # SciPy 1.15's `nnls` at times ends elsewhere (its issue 25389).
    shares = lsq_linear(system, right, bounds=(0.0, np.inf), method="bvls", tol=1e-14, max_iter=10_000).x
    return (wrench / roots + np.array(columns).T @ shares) / roots
