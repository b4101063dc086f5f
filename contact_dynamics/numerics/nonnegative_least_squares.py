"""Non-negative least squares, after Lawson and Hanson (1974, ch. 23).

`least_force` chooses among the forces that balance a wrench. It returns those of least sum of squares if none
of them is negative, as under a block on a row of feet. Otherwise it returns a solution with few forces. It
does not use SciPy, because SciPy's first import takes tenths of a second, longer than all else in a planar
answer. Also, it leaves out directions that consist of rounding alone, and SciPy does not.

`nearest_combination` uses SciPy, for margins and refusals in space. These need SciPy for hulls anyway.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.tolerances import INDEPENDENT_FORCES, WRENCH_ROUNDING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.validation import FloatArray

_NEAREST_STEPS: Final = 10
"""Bound on the steps for each column in the search for the nearest sum, which takes one or two. SciPy's own
bound is three."""


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
    """Add the column that helps most and drop those that would pull, until the target is balanced."""
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

    ``columns`` is (d, k). It returns None if they are so nearly dependent that the search did not end.
    """
    from scipy.optimize import nnls

    try:
        x, left = nnls(columns, target, maxiter=_NEAREST_STEPS * max(1, columns.shape[1]))
    except RuntimeError:
        return None
    return x, float(left)
