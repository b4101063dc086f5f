# SPDX-License-Identifier: Apache-2.0
"""The contact forces that the answer shows for a mode in space, and whether they oppose the sliding.

Many forces may bring about the same motion, as under four feet. The answer shows those of least sum of
squares. There is one such set of forces, so a symmetric problem has symmetric forces.

Forces f in a product K of round cones have to cause a wrench, A f = b. The least f is the projection of
transpose(A) y onto K, where y, with six components, minimises a convex function. Newton's method finds it (Qi
and Sun, A nonsmooth version of Newton's method, 1993).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.numerics.vectors import cross_of_two
from contact_dynamics.tolerances import LEAST_FORCE_FLAT, LEAST_FORCE_MET, LEAST_FORCE_SEEN, ON_PYRAMIDS_SIDE

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray

_MAX_STEPS: Final = 60
"""Newton's method takes about five steps, and some thirty where friction is at its limit at each contact."""

_MAX_HALVINGS: Final = 40


def least_forces(
    effects: FloatArray, forces: FloatArray, axes: FloatArray, frictions: FloatArray
) -> FloatArray:
    """Return the forces, (n, 3), of least sum of squares in the same cones and with the same effects.

    Args:
        effects: (k, 3 n), the effects of unit forces.
        forces: (n, 3), forces in their cones.
        axes: (n, 3), the axes of the cones, of unit length.
        frictions: (n,), how far a force may lean from its axis. A cone with 0 is a ray.
    """
    _, sizes, V = np.linalg.svd(effects, full_matrices=False)
    V = V[sizes > LEAST_FORCE_SEEN * sizes.max(initial=0.0)]
    aim = V @ forces.ravel()
    if not aim.any():
        return np.zeros_like(forces)
    least = _newton(V, aim, axes, frictions)
    return forces if least is None else least + 0.0  # there is no minus zero in an answer


def misdirection(forces: FloatArray, directions: FloatArray, normals: FloatArray) -> float:
    """Return the largest angle, rad, between friction and the way against sliding.

    Args:
        forces: (n, 3), N.
        directions: (n, 3), unit, the directions in which contacts slide; zero where they do not slide.
        normals: (n, 3), unit.
    """
    largest = 0.0
    slack = ON_PYRAMIDS_SIDE * float(np.abs(forces).max(initial=0.0))
    for force, way, normal in zip(forces, directions, normals, strict=True):
        friction = force - (force @ normal) * normal
        if np.any(way) and float(np.linalg.norm(friction)) > slack:
            across = float(np.linalg.norm(cross_of_two(friction, way)))
            largest = max(largest, math.atan2(across, -float(friction @ way)))
    return largest


def _newton(V: FloatArray, aim: FloatArray, axes: FloatArray, frictions: FloatArray) -> FloatArray | None:
    """Return the projection onto the cones of some y V that V maps to the aim, or None if none is found."""
    y, size = aim, float(np.linalg.norm(aim))

    def at(y: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, float]:
        projected, slopes = _projected((y @ V).reshape(-1, 3), axes, frictions)
        return (
            projected,
            slopes,
            aim - V @ projected.ravel(),
            0.5 * float(np.sum(projected**2)) - float(aim @ y),
        )

    projected, slopes, left, height = at(y)
    for _ in range(_MAX_STEPS):
        if float(np.linalg.norm(left)) <= LEAST_FORCE_MET * size:
            return projected + (left @ V).reshape(-1, 3)
        blocks = V.reshape(len(V), -1, 3)
        curvature = np.einsum("rni,nij,snj->rs", blocks, slopes, blocks)
        # Where the function is flat along some direction, the further term leads far out along it.
        further = LEAST_FORCE_FLAT * float(np.linalg.norm(left)) / size
        step = np.linalg.solve(curvature + further * np.eye(len(curvature)), left)
        for _ in range(_MAX_HALVINGS):
            trial = at(y + step)
            # Near the end rounding hides a gain of the function, but not what is left.
            if trial[3] <= height or float(np.linalg.norm(trial[2])) < 0.5 * float(np.linalg.norm(left)):
                break
            step = 0.5 * step
        else:
            return None
        y = y + step
        projected, slopes, left, height = trial
    return None


def _projected(points: FloatArray, axes: FloatArray, frictions: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the nearest points in the cones, (n, 3), and their derivatives by the points, (n, 3, 3)."""
    along = np.sum(points * axes, axis=1)
    across = points - along[:, None] * axes
    lean = np.linalg.norm(across, axis=1)
    inside = lean <= frictions * along
    outside = ~inside & (along + frictions * lean > 0.0)
    ways = across / np.where(lean > 0.0, lean, 1.0)[:, None]
    edges = axes + frictions[:, None] * ways
    shares = (along + frictions * lean) / (1.0 + frictions**2)
    nearest = np.where(inside[:, None], points, np.where(outside[:, None], shares[:, None] * edges, 0.0))
    turning = np.eye(3) - _outer(axes) - _outer(ways)
    rates = frictions * shares / np.where(lean > 0.0, lean, 1.0)
    on_edge = _outer(edges) / (1.0 + frictions**2)[:, None, None] + rates[:, None, None] * turning
    slopes = np.where(inside[:, None, None], np.eye(3), np.where(outside[:, None, None], on_edge, 0.0))
    return nearest, slopes


def _outer(vectors: FloatArray) -> FloatArray:
    return vectors[:, :, None] * vectors[:, None, :]
