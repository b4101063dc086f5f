# SPDX-License-Identifier: Apache-2.0
"""Distances and overlaps of convex hulls by optimisation over all their points, without any features.

Slow, obvious, and sharing nothing with the package.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import linprog, lsq_linear

WEIGHT = 1e3  # of "shares sum to one" against metres


def distance(one: np.ndarray, other: np.ndarray) -> float:
    """The distance of the hulls of (k, 3) and (m, 3): the least |A s - B t| over shares s and t."""
    k, m = len(one), len(other)
    rows = np.zeros((5, k + m))
    rows[:3, :k], rows[:3, k:] = one.T, -other.T
    rows[3, :k], rows[4, k:] = WEIGHT, WEIGHT
    wanted = np.array([0.0, 0.0, 0.0, WEIGHT, WEIGHT])
    shares = lsq_linear(
        rows, wanted, (0.0, np.inf), method="bvls", tol=1e-14
    ).x  # SciPy 1.15's nnls is wrong at times
    s, t = shares[:k] / shares[:k].sum(), shares[k:] / shares[k:].sum()
    return float(np.linalg.norm(s @ one - t @ other))


def overlap_support(one: np.ndarray, other: np.ndarray, direction: np.ndarray) -> float:
    """How far the overlap of two hulls of points (k, 2) and (m, 2) reaches in a direction."""
    k, m = len(one), len(other)
    equal = np.zeros((4, k + m))
    equal[:2, :k], equal[:2, k:] = one.T, -other.T
    equal[2, :k], equal[3, k:] = 1.0, 1.0
    cost = np.concatenate([-(one @ direction), np.zeros(m)])
    found = linprog(cost, A_eq=equal, b_eq=[0.0, 0.0, 1.0, 1.0], bounds=(0.0, None), method="highs")
    assert found.status == 0
    return float(-found.fun)
