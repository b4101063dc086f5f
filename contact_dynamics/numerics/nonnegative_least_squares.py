"""Non-negative least squares, after Lawson and Hanson (1974, ch. 23): a choice of forces, or the nearest.

`least_force` chooses where many forces balance a wrench: the one of least sum of squares where that has no
negative force, as under a block on a row of feet, and otherwise one that few forces carry. It is written out,
because a planar answer must not wait for SciPy, whose first import takes tenths of a second, longer than all
else in the answer. And it leaves out directions that are no more than rounding, which SciPy's does not.

`nearest_combination` is SciPy's, for margins and refusals in space, which need SciPy for hulls anyway.
"""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.tolerances import INDEPENDENT_FORCES, WRENCH_ROUNDING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.validation import FloatArray

_NEAREST_ROUNDING: Final = 1e-9
"""Rounding in the nearest sum, relative to its terms. SciPy's is some 1e-13, or above 1e-3 if wrong."""

_NEAREST_STEPS: Final = 10
"""Steps for each span in the search for the nearest sum. It takes one or two; SciPy alone stops at three."""


def least_force(columns: Sequence[Vector3], target: Vector3, absent: Sequence[Vector3]) -> list[float]:
    """Return an x >= 0 with sum x_i columns_i = target.

    Args:
        columns: Unit vectors whose positive combinations hold ``target``.
        target: What to balance.
        absent: Orthonormal directions orthogonal to all columns; the part of ``target`` there is left out.
    """
    if not columns:
        return []
    matrix = np.array(columns).T
    right = np.array(target)
    for direction in absent:
        right -= np.dot(direction, right) * np.array(direction)
    least = np.linalg.lstsq(matrix, right, rcond=INDEPENDENT_FORCES)[0]
    if least.min() >= 0.0:
        return [float(value) for value in least]
    return [float(value) for value in _few_forces(matrix, right)]


def _few_forces(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """Let the column that helps most act, drop those that would pull, until nothing is left over."""
    count = matrix.shape[1]
    x = np.zeros(count)
    acting = np.zeros(count, dtype=bool)
    smallest = WRENCH_ROUNDING * float(np.linalg.norm(right))
    for _ in range(10 * count):
        help_of = matrix.T @ (right - matrix @ x)
        help_of[acting] = -np.inf
        best = int(help_of.argmax())
        if help_of[best] <= smallest:
            break
        acting[best] = True
        while True:
            trial = np.zeros(count)
            trial[acting] = np.linalg.lstsq(matrix[:, acting], right, rcond=INDEPENDENT_FORCES)[0]
            pulling = acting & (trial <= 0.0)
            if not pulling.any():
                break
            part = np.min(x[pulling] / (x[pulling] - trial[pulling]))
            x += part * (trial - x)
            acting &= ~pulling | (x > smallest)
            x[~acting] = 0.0
        x = trial
    return x


def nearest_combination(columns: FloatArray, target: FloatArray) -> tuple[FloatArray, float] | None:
    """Return x >= 0, (k,), for which columns @ x is nearest to a target, (d,), and its distance.

    ``columns`` is (d, k). None: they are so nearly dependent that the search did not end.
    """
    from scipy.optimize import lsq_linear, nnls

    steps = _NEAREST_STEPS * max(1, columns.shape[1])
    # SciPy 1.15, the last for Python 3.10, at times ends elsewhere, with a distance that is not this x's,
    # or does not end (https://github.com/scipy/scipy/issues/25389).
    with contextlib.suppress(RuntimeError):
        x, left = nnls(columns, target, maxiter=steps)
        if _is_nearest(columns, target, x, left):
            return x, float(left)
    x = lsq_linear(columns, target, (0.0, np.inf), method="bvls", tol=0.0, max_iter=steps).x.clip(0.0)
    distance = float(np.linalg.norm(columns @ x - target))
    return (x, distance) if _is_nearest(columns, target, x, distance) else None


def _is_nearest(columns: FloatArray, target: FloatArray, x: FloatArray, left: float) -> bool:
    """Return whether no column leads nearer, the rest is normal to the sum, and ``left`` is the distance."""
    rest = target - columns @ x
    sizes = np.linalg.norm(columns, axis=0)
    terms = float(np.linalg.norm(target) + sizes @ x)
    gains = columns.T @ rest
    nearest = (gains <= _NEAREST_ROUNDING * terms * sizes).all() and abs(
        gains @ x
    ) <= _NEAREST_ROUNDING * terms**2
    return bool(nearest) and abs(float(np.linalg.norm(rest)) - left) <= _NEAREST_ROUNDING * terms
