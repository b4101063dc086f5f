# SPDX-License-Identifier: Apache-2.0
"""Solves non-negative least squares by the method of Lawson and Hanson (1974, ch. 23).

`least_force` chooses among the forces that balance a wrench. It returns those of least sum of squares if none
of them is negative, as under a block on a row of feet. Otherwise it returns a solution with few forces. SciPy
is not used, because its import takes tenths of a second, longer than the rest of a planar answer, and because
it does not exclude directions that consist of rounding errors.

`exact_combination` calculates with as many digits as it takes, for columns that nearly coincide.

`nearest_combination` is SciPy's, for margins and refusals in space, which need SciPy for hulls anyway.
"""

from __future__ import annotations

import contextlib
import math
from decimal import Decimal
from operator import mul
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np

from contact_dynamics.numerics.arithmetic import DECIMALS, within
from contact_dynamics.numerics.vectors import array_of
from contact_dynamics.tolerances import (
    DECIMALS_MET,
    DECIMALS_ZERO,
    INDEPENDENT_FORCES,
    NEAREST_SUM_ROUNDING,
    TARGET_ROUNDING,
    WRENCH_ROUNDING,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.validation import FloatArray

_LARGEST_SHARE: Final = 1e13
"""Largest share of the target that one column may have for the target to count as reached."""

_GUESSES: Final = 30
"""Bound on the rounds of the search for the least forces, which takes a few."""

_Decimals: TypeAlias = "list[Decimal]"

_NEAREST_STEPS: Final = 10
"""Bound on the steps for each column in the search for the nearest sum, which takes one or two. SciPy's own
bound is three."""


def least_force(columns: Sequence[Vector3], target: Vector3, absent: Sequence[Vector3]) -> list[float]:
    """Return an x >= 0 with sum x_i columns_i = target.

    Args:
        columns: Unit vectors whose positive combinations hold ``target``.
        target: The sum.
        absent: Orthonormal directions orthogonal to all columns. The part of ``target`` along them is left
            out.
    """
    if not columns:
        return []
    matrix = array_of(columns).T
    right = np.array(target)
    for direction in absent:
        right -= np.dot(direction, right) * np.array(direction)
    least = np.linalg.lstsq(matrix, right, rcond=INDEPENDENT_FORCES)[0]
    if least.min() >= 0.0:
        return [float(value) for value in least]
    return [float(value) for value in _few_forces(matrix, right)]


def _few_forces(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """Add the most effective column and drop negative ones, until the target is balanced."""
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


def exact_combination(columns: Sequence[Vector3], target: Vector3) -> tuple[list[Decimal], float]:
    """Return an x >= 0 whose sum x_i columns_i is nearest to a target, and its distance, in decimals.

    If there are many such x, it is the one of least sum of squares if Newton's method finds it, or else one
    with at most three numbers that are not zero. The columns are unit vectors, and may nearly coincide or
    oppose each other, so that floats do not have enough digits.
    """
    with within(DECIMALS.sums):
        rows = [[Decimal(part) for part in column] for column in columns]
        right = [Decimal(part) for part in target]
        few = _few_exact_forces(rows, right)
        met = [Decimal(0)] * 3
        for i, share in few.items():
            met = [a + share * b for a, b in zip(met, rows[i], strict=True)]
        left = [a - b for a, b in zip(right, met, strict=True)]
        least = _least_exact_forces(rows, met)
        acting = few if least is None else least
        return [acting.get(i, Decimal(0)) for i in range(len(rows))], float(_inner(left, left).sqrt())


def distance_of(combination: tuple[list[Decimal], float], target: Vector3) -> float:
    """Return the distance of a target from its `exact_combination`, infinite if not known.

    It is not known if the target takes shares above `_LARGEST_SHARE` of it, because rounding then decides.
    """
    x, distance = combination
    size = math.sqrt(sum(part * part for part in target))
    return distance if float(sum(x)) <= _LARGEST_SHARE * size else math.inf


def _least_exact_forces(rows: list[_Decimals], right: _Decimals) -> dict[int, Decimal] | None:
    """Return the forces of least sum of squares that add up to ``right``, or None if they are not found.

    They are the positive parts of rows @ y for some y. Each round guesses which parts are positive, from the
    y of the round before.
    """
    acting = list(range(len(rows)))
    for _ in range(_GUESSES):
        used = [rows[i] for i in acting]
        columns = list(zip(*used, strict=True)) if used else [()] * 3
        (xx, xy, xz), (yy, yz), (zz,) = (
            [sum(map(mul, columns[i], columns[j]), Decimal(0)) for j in range(i, 3)] for i in range(3)
        )
        y = _solution([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], right)
        sizes = [_inner(row, y) for row in rows]
        pushing = [i for i, size in enumerate(sizes) if size > 0]
        if pushing == acting:
            met = [sum((sizes[i] * rows[i][j] for i in acting), Decimal(0)) for j in range(3)]
            wrong = max(abs(a - b) for a, b in zip(met, right, strict=True))
            return (
                {i: sizes[i] for i in acting} if wrong <= DECIMALS_MET * _inner(right, right).sqrt() else None
            )
        acting = pushing
    return None


def _few_exact_forces(rows: list[_Decimals], right: _Decimals) -> dict[int, Decimal]:
    """Return the forces that act, as `_few_forces` does, but with every direction, near others or not."""
    acting: dict[int, Decimal] = {}
    left = list(right)
    size = _inner(right, right).sqrt()
    nothing = DECIMALS_ZERO * size
    for _ in range(10 * len(rows)):
        if _inner(left, left).sqrt() <= TARGET_ROUNDING * size:
            break
        help_of = [(_inner(row, left), -i) for i, row in enumerate(rows) if i not in acting]
        most, best = max(help_of, default=(Decimal(0), 0))
        if most <= nothing:
            break
        acting[-best] = Decimal(0)
        while True:
            used = [rows[i] for i in acting]
            solved = _solution(
                [[_inner(a, b) for b in used] for a in used], [_inner(row, right) for row in used]
            )
            trial = dict(zip(acting, solved, strict=True))
            pulling = [i for i, value in trial.items() if value <= 0]
            if not pulling:
                break
            part = min(acting[i] / (acting[i] - trial[i]) if acting[i] > 0 else Decimal(0) for i in pulling)
            stepped = {i: x + part * (trial[i] - x) for i, x in acting.items()}
            acting = {i: x for i, x in stepped.items() if x > nothing or i not in pulling}
        acting = trial
        left = list(right)
        for i, x in acting.items():
            left = [a - x * b for a, b in zip(left, rows[i], strict=True)]
    return acting


def _solution(matrix: list[_Decimals], right: _Decimals) -> _Decimals:
    """Return an x with matrix @ x = right for a symmetric matrix, singular ones included."""
    count = len(right)
    table = [[*row, value] for row, value in zip(matrix, right, strict=True)]
    smallest = DECIMALS_ZERO * max((abs(value) for row in matrix for value in row), default=Decimal(0))
    x = [Decimal(0)] * count
    pivots: list[tuple[int, int]] = []
    for column in range(count):
        free = [i for i in range(count) if i not in {row for row, _ in pivots}]
        pivot = max(free, key=lambda i: abs(table[i][column]))
        if abs(table[pivot][column]) <= smallest:
            continue
        pivots.append((pivot, column))
        for i in range(count):
            if i != pivot:
                factor = table[i][column] / table[pivot][column]
                table[i] = [a - factor * b for a, b in zip(table[i], table[pivot], strict=True)]
    for row, column in pivots:
        x[column] = table[row][-1] / table[row][column]
    return x


def _inner(a: _Decimals, b: _Decimals) -> Decimal:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def nearest_combination(columns: FloatArray, target: FloatArray) -> tuple[FloatArray, float] | None:
    """Return x >= 0, (k,), for which columns @ x is nearest to a target, (d,), and its distance.

    ``columns`` is (d, k). It returns None if they are so nearly dependent that the search did not end.
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
    nearest = (gains <= NEAREST_SUM_ROUNDING * terms * sizes).all() and abs(
        gains @ x
    ) <= NEAREST_SUM_ROUNDING * terms**2
    return bool(nearest) and abs(float(np.linalg.norm(rest)) - left) <= NEAREST_SUM_ROUNDING * terms
