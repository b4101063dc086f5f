# SPDX-License-Identifier: Apache-2.0
"""Polyhedral cones in a space of any dimension: their inner points, lines and extreme rays.

A cone is given by its rows, {x : rows x >= 0}. Its rays are the facets of the convex hull of the rows, seen
from an inner point (Huang, Cheng and Mason, Efficient Contact Mode Enumeration in 3D, 2020).
"""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from contact_dynamics.errors import UndecidedError
from contact_dynamics.numerics.convex_hull import hull_of
from contact_dynamics.numerics.linear_spaces import null_space
from contact_dynamics.numerics.nonnegative_least_squares import nearest_combination
from contact_dynamics.tolerances import ROW_TOLERANCE

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from contact_dynamics.validation import FloatArray

_WELL_INSIDE: Final = 0.02
"""A unit point serves as inner point if its product with each unit row is larger than this. Otherwise a
linear program looks for one."""

_MAX_CHOICES: Final = 300
"""As many choices of d - 1 rows are tried one by one, which takes a millisecond. With more of them a convex
hull is faster, but that needs SciPy, whose first import takes tenths of a second."""

_TRIALS: Final = 60
"""The search for an inner point takes this many steps of a few microseconds, before a linear program, which
takes milliseconds, has to find it."""


class Cone(NamedTuple):
    """The parts of {x : rows x >= 0}: positive sums of rays, plus sums of lines."""

    strict: NDArray[np.bool_]  # (m,), which rows can be positive; the others vanish all over the cone
    rows: FloatArray  # (k, d), those rows, unit, projected on the space where the others vanish
    rays: FloatArray  # (r, d), unit, orthogonal to the lines; a ray may appear several times
    lines: FloatArray  # (l, d), orthonormal


def cone_of(rows: FloatArray) -> Cone:
    """Return the parts of a cone that is given by unit rows, (m, d).

    Raises:
        UndecidedError: rounding decides what the cone is.
    """
    inner, strict = inner_point(rows)
    # Within the space where the implied equations hold, and across the lines that the cone contains.
    space = null_space(rows[~strict])
    if not strict.any() or space.shape[1] == 0:
        return Cone(np.zeros_like(strict), rows[:0], np.zeros((0, rows.shape[1])), space.T)
    reduced = rows[strict] @ space
    reduced /= np.linalg.norm(reduced, axis=1)[:, None]
    spread, basis = np.linalg.svd(reduced)[1:]
    rank = int((spread > ROW_TOLERANCE * spread[0]).sum())
    across = basis[:rank]
    rays = extreme_rays(reduced @ across.T, across @ (space.T @ inner))
    return Cone(strict, reduced @ space.T, rays @ across @ space.T, basis[rank:] @ space.T)


def inner_point(rows: FloatArray) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return a point over which as many rows as can be are strictly positive, and which those are."""
    point = rows.mean(axis=0)
    for step in range(_TRIALS):  # towards the rows' average of least norm (von Neumann's algorithm)
        heights = rows @ point
        worst = int(heights.argmin())
        size = float(np.linalg.norm(point))
        if heights[worst] > _WELL_INSIDE * size:
            return point / size, np.ones(len(rows), dtype=bool)
        point += (rows[worst] - point) * (2.0 / (step + 4.0))
    from scipy.optimize import linprog

    m, d = rows.shape
    # Any row that can be positive can be 1, because the cone scales: the sum counts the rows that can.
    found = linprog(
        np.concatenate([np.zeros(d), -np.ones(m)]),
        A_ub=np.hstack([-rows, np.eye(m)]),
        b_ub=np.zeros(m),
        bounds=[(None, None)] * d + [(0.0, 1.0)] * m,
        method="highs",
    )
    solution = _solution_of(found)
    strict = solution[d:] > 0.5
    if not strict.any():
        return solution[:d], strict
    # The point deepest inside lies in the space where the rows that cannot be positive vanish.
    space = null_space(rows[~strict])
    if space.shape[1] == 0:
        return solution[:d], np.zeros_like(strict)
    inside = rows[strict] @ space
    inside /= np.linalg.norm(inside, axis=1)[:, None]
    k = space.shape[1]
    deepest = linprog(
        np.concatenate([np.zeros(k), [-1.0]]),
        A_ub=np.hstack([-inside, np.ones((len(inside), 1))]),
        b_ub=np.zeros(len(inside)),
        bounds=[(-1.0, 1.0)] * k + [(None, 1.0)],
        method="highs",
    )
    return space @ _solution_of(deepest)[:k], strict


def _solution_of(program: Any) -> FloatArray:
    """Return the solution of a linear program of SciPy's, which each has unless rounding hides it."""
    if program.x is None:
        raise _undecided("a linear program has no end")
    solution: FloatArray = program.x
    return solution


def extreme_rays(rows: FloatArray, inner: FloatArray) -> FloatArray:
    """Return the unit extreme rays, (k, d), of a pointed cone whose rows are all positive at ``inner``."""
    d = rows.shape[1]
    if d == 1:
        return np.sign(inner)[None, :]
    if math.comb(len(rows), d - 1) <= _MAX_CHOICES:
        return _rays_by_choice(rows)
    inner = inner / np.linalg.norm(inner)
    across = np.linalg.svd(inner[None, :])[2][1:]
    heights = rows @ inner
    if not heights.min() > 0.0:
        raise _undecided("their cone has no inner point")
    points = (rows @ across.T) / heights[:, None]
    if d == 2:
        sides = np.array([[1.0, -points.max()], [-1.0, points.min()]])
    else:
        sides = hull_of("contacts", points).equations
    # A side says that outward . x + offset <= 0; the ray is where that height is 0 for the points on it.
    rays: FloatArray = -sides[:, -1:] * inner - sides[:, :-1] @ across
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    return rays


def _rays_by_choice(rows: FloatArray) -> FloatArray:
    """Return the extreme rays: the lines on which d - 1 independent rows vanish, and no row is negative."""
    d = rows.shape[1]
    spread, basis = np.linalg.svd(rows[list(itertools.combinations(range(len(rows)), d - 1))])[1:]
    rays = basis[:, -1][spread[:, -1] > ROW_TOLERANCE * spread[:, 0]]
    total = (rays @ rows.T).sum(axis=1)  # a ray of the cone is above some row, as the cone holds no line
    rays = rays[total != 0.0] * np.sign(total[total != 0.0])[:, None]
    kept: FloatArray = rays[(rays @ rows.T).min(axis=1, initial=0.0) >= -ROW_TOLERANCE]
    return kept


def nearest_sum(spans: FloatArray, target: FloatArray) -> tuple[FloatArray, float]:
    """Return shares >= 0, (k,), of spans, (k, d), whose sum is nearest to a target, and its distance."""
    found = nearest_combination(spans.T, target)
    if found is None:
        raise _undecided("non-negative least squares did not end")
    return found


def _undecided(reason: str) -> UndecidedError:
    return UndecidedError(
        "contacts must be either the same or clearly apart, with friction that is not far from 1, got "
        f"wrenches whose balance hangs on rounding ({reason})"
    )
