# SPDX-License-Identifier: Apache-2.0
"""This file finds principal moments and axes in extended precision (lecture 25, eq. 10 and 11).

A tumbling body turns by phases that grow with time. So an error of one last bit in a moment becomes an error
of radians after 1e16 revolutions, and much earlier near the middle axis. The doubles of the matrix are
therefore taken as exact numbers, and the matrix is diagonalised in decimal arithmetic by Jacobi's rotations.
These converge quadratically, and stay orthogonal where moments are nearly equal.

Not covered: an order or sign of axes for people to rely on. Only the tumbling formulas use this frame.
"""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal
from functools import lru_cache
from typing import TYPE_CHECKING, Final, Generic

import numpy as np

from contact_dynamics.numerics.arithmetic import DECIMALS, Scalar, within
from contact_dynamics.tolerances import EXACTLY_EQUAL_MOMENTS

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray

_MAX_SWEEPS: Final = 30
"""Bound on the sweeps. Convergence takes four to eight."""


@dataclass(frozen=True, slots=True)
class PrincipalFrame(Generic[Scalar]):
    """The principal moments in ascending order, and their axes.

    Attributes:
        moments: kg m^2.
        gaps: Differences middle - small, large - middle and large - small, kg m^2, >= 0.
        axes_B: Unit axes in body coordinates, as 3 rows, of either handedness.
    """

    moments: tuple[Scalar, Scalar, Scalar]
    gaps: tuple[Scalar, Scalar, Scalar]
    axes_B: tuple[tuple[Scalar, Scalar, Scalar], ...]


def principal_frame(I_B: FloatArray) -> PrincipalFrame[Decimal]:
    """Return the principal frame of a (3, 3) inertia matrix, kg m^2, body axes. Frames are kept by matrix."""
    return _of_bytes(I_B.tobytes())


@lru_cache(maxsize=256)
def in_doubles(frame: PrincipalFrame[Decimal]) -> PrincipalFrame[float]:
    """Return a frame in doubles. The gaps are rounded too, which keeps nearly equal moments apart."""
    small, middle, large = (float(moment) for moment in frame.moments)
    low, high, both = (float(gap) for gap in frame.gaps)
    axes = tuple((float(x), float(y), float(z)) for x, y, z in frame.axes_B)
    return PrincipalFrame(moments=(small, middle, large), gaps=(low, high, both), axes_B=axes)


@lru_cache(maxsize=256)
def _of_bytes(data: bytes) -> PrincipalFrame[Decimal]:
    rows = np.frombuffer(data, dtype=np.float64).reshape(3, 3).tolist()
    with within(DECIMALS.sums):
        exact = [[Decimal(x) for x in row] for row in rows]
        matrix = [[(exact[i][j] + exact[j][i]) / 2 for j in range(3)] for i in range(3)]
        axes = [[Decimal(int(i == j)) for j in range(3)] for i in range(3)]
        _diagonalise(matrix, axes)
        order = sorted(range(3), key=lambda i: matrix[i][i])
        small, middle, large = (matrix[i][i] for i in order)
        if middle - small <= EXACTLY_EQUAL_MOMENTS * large:
            small = middle
        if large - middle <= EXACTLY_EQUAL_MOMENTS * large:
            large = middle
        return PrincipalFrame(
            moments=(small, middle, large),
            gaps=(middle - small, large - middle, large - small),
            axes_B=tuple((axes[0][i], axes[1][i], axes[2][i]) for i in order),
        )


def _diagonalise(matrix: list[list[Decimal]], axes: list[list[Decimal]]) -> None:
    """Make ``matrix`` diagonal, and turn ``axes`` (columns) with it (Golub and Van Loan, 8.5)."""
    negligible = EXACTLY_EQUAL_MOMENTS / 10**5 * sum(abs(matrix[i][i]) for i in range(3))
    for _ in range(_MAX_SWEEPS):
        if all(abs(matrix[p][q]) <= negligible for p, q in ((0, 1), (0, 2), (1, 2))):
            return
        for p, q, other in ((0, 1, 2), (0, 2, 1), (1, 2, 0)):
            if abs(matrix[p][q]) > negligible:
                _rotate(matrix, axes, p, q, other)
    raise ArithmeticError("Jacobi's rotations did not converge")  # they do for all symmetric matrices


def _rotate(matrix: list[list[Decimal]], axes: list[list[Decimal]], p: int, q: int, other: int) -> None:
    """Annihilate ``matrix[p][q]``."""
    tau = (matrix[q][q] - matrix[p][p]) / (2 * matrix[p][q])
    tangent = 1 / (abs(tau) + (1 + tau * tau).sqrt())
    if tau < 0:
        tangent = -tangent
    cosine = 1 / (1 + tangent * tangent).sqrt()
    sine = tangent * cosine
    matrix[p][p] -= tangent * matrix[p][q]
    matrix[q][q] += tangent * matrix[p][q]
    matrix[p][q] = matrix[q][p] = Decimal(0)
    at_p, at_q = matrix[other][p], matrix[other][q]
    matrix[other][p] = matrix[p][other] = cosine * at_p - sine * at_q
    matrix[other][q] = matrix[q][other] = sine * at_p + cosine * at_q
    for row in axes:
        row[p], row[q] = cosine * row[p] - sine * row[q], sine * row[p] + cosine * row[q]
