# SPDX-License-Identifier: Apache-2.0
"""Random free rotations that reach every singular end, each in its own logarithmic distance."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Draw:
    """A rotation, and how it was drawn."""

    body: str  # generic, pair (two moments nearly equal), sphere (nearly), needle
    spin: str  # generic, axis (near one), separatrix (near it), middle (there, and near the middle axis)
    moments: FloatArray  # (3,), in no order
    I_B: FloatArray  # (3, 3)
    q_WB: FloatArray  # (4,)
    w_WB_W: FloatArray  # (3,), rad/s


BODIES = ("generic", "pair", "sphere", "needle")
SPINS = ("generic", "axis", "separatrix", "middle")


def draw(rng: np.random.Generator) -> Draw:
    """Draw kind of body, kind of spin, scales, and whether axes are aligned, independently."""
    body, spin = rng.choice(BODIES), rng.choice(SPINS)
    moments = _moments(rng, body)
    w_P = _spin(rng, spin, moments)
    w_P *= _small(rng, 12.0) * 1e6 / np.linalg.norm(w_P)
    moments *= _small(rng, 12.0) * 1e6
    aligned, upright = rng.integers(3) > 0, rng.integers(2) > 0
    R_BP = np.eye(3) if aligned else Rotation.random(random_state=int(rng.integers(2**31))).as_matrix()
    R_WB = Rotation.identity() if upright else Rotation.random(random_state=int(rng.integers(2**31)))
    I_B = R_BP @ np.diag(moments) @ R_BP.T
    return Draw(body, spin, moments, 0.5 * (I_B + I_B.T), R_WB.as_quat(), R_WB.as_matrix() @ R_BP @ w_P)


def _small(rng: np.random.Generator, decades: float = 17.0) -> float:
    """Return a number in (0, 1] whose logarithm is uniform."""
    return float(10.0 ** -rng.uniform(0.0, decades))


def _moments(rng: np.random.Generator, kind: str) -> FloatArray:
    """Return three moments that some body has, in any order."""
    while True:
        if kind == "generic":
            moments = rng.uniform(0.2, 1.0, 3)
        elif kind == "pair":
            moments = np.array([1.0, 1.0 + 0.5 * _small(rng), rng.uniform(0.05, 1.9)])
        elif kind == "sphere":
            moments = 1.0 + 0.5 * _small(rng) * rng.uniform(-1.0, 1.0, 3)
        else:
            radius = _small(rng, 5.0)
            moments = np.array([radius, 1.0, 1.0 + radius * rng.uniform(-0.9, 0.9)])
        small, middle, large = sorted(moments)
        if small + middle >= large:
            return rng.permutation(moments)


def _spin(rng: np.random.Generator, kind: str, moments: FloatArray) -> FloatArray:
    """Return an angular velocity of some length, in principal axes."""
    small, middle, large = np.argsort(moments)
    w = rng.normal(size=3)
    if kind == "axis":
        for other in rng.permutation(3)[:2]:
            w[other] *= _small(rng)
    elif kind != "generic":
        below = moments[small] * (moments[middle] - moments[small])
        above = moments[large] * (moments[large] - moments[middle])
        # On the separatrix below w_small^2 = above w_large^2.
        w[small] = math.copysign(math.sqrt(above), w[small])
        w[large] = math.copysign(math.sqrt(below), w[large]) * (1.0 + rng.choice([-1.0, 1.0]) * _small(rng))
        if kind == "middle":
            w[[small, large]] *= _small(rng, 10.0)
    return w if np.any(w) else rng.normal(size=3)
