# SPDX-License-Identifier: Apache-2.0
"""Principal moments and axes have an order, signs and an inertia ellipsoid (lecture 25, eq. 10 to 17).

An inertia matrix determines its principal axes up to order and sign, and, where moments are equal, up to a
turn. This module chooses:

- Moments ascend, and the axes are right-handed.
- The largest component of the first axis and that of the second are positive. If two components are equally
  large (within `AXIS_TIE`), the first of them counts. The third axis is the cross product.
- If two moments are equal, the axis of the other moment has its largest component positive. The least
  rotation that takes the nearest body axis onto it also gives the other two axes. So all three axes point the
  way of the body axes nearest to them.
- If all three moments are equal, the axes are the body's.

Equal means within `EQUAL_MOMENTS_TOLERANCE` of the largest. Equal moments are returned as their mean. Every
such rule jumps somewhere: this one jumps where moments meet, and where two components of an axis are equally
large.

Tumbling alone uses `principal_frame`, which has the same in extended precision, in no order for people to
rely on. A tumbling body turns by phases that grow with time. So an error of one last bit in a moment becomes
an error of radians after 1e16 revolutions, and much earlier near the middle axis. The doubles of the matrix
are therefore taken as exact numbers, and the matrix is diagonalised in decimal arithmetic by Jacobi's
rotations. These converge quadratically, and stay orthogonal where moments are nearly equal.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import Decimal
from functools import lru_cache
from typing import TYPE_CHECKING, Final, Generic

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.numerics.arithmetic import DECIMALS, Scalar, within
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import check_symmetric
from contact_dynamics.tolerances import AXIS_TIE, EQUAL_MOMENTS_TOLERANCE, EXACTLY_EQUAL_MOMENTS
from contact_dynamics.validation import FloatArray, check_array, check_positive, check_unit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


REMEMBERED: Final = 128
"""Number of bodies whose axes are kept."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PrincipalAxes(Record):
    """Principal moments and axes, in the order and with the signs of this module.

    Attributes:
        moments: (3,), kg m^2, ascending.
        R_BP: (3, 3), a rotation. Its columns are the axes of the moments, in body axes.
    """

    moments: FloatArray
    R_BP: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class InertiaEllipsoid(Record):
    """The surface r^T I r = a about the centre of mass (lecture 25, eq. 14).

    Attributes:
        I_B: (3, 3), kg m^2.
        level: The number a, kg m^4 where r is in m.
        semi_axes: (3,), m, descending: sqrt(a / I), which is inf where a moment is 0.
        R_BP: (3, 3), whose columns are the directions of the semi-axes, in body axes.
    """

    I_B: FloatArray
    level: float
    semi_axes: FloatArray
    R_BP: FloatArray

    def distance(self, axis_B: ArrayLike) -> float:
        """Return the distance sqrt(a / I_n), m, to the surface along a unit axis, (3,) (lecture 25, eq. 16).

        This is sqrt(a / m) divided by the radius of gyration about that axis (eq. 17).
        """
        axis = check_unit("axis_B", axis_B, 3)
        angular_inertia = float(axis @ self.I_B @ axis)
        return math.sqrt(self.level / angular_inertia) if angular_inertia > 0.0 else math.inf


def principal_axes(I_B: ArrayLike) -> PrincipalAxes:
    """Return the principal moments and axes of a (3, 3) symmetric matrix, kg m^2, such as a body's I_B.

    Both are accurate to the rounding of the given numbers, including the small moments of slender bodies.

    Raises:
        InvalidFieldError: the matrix is not symmetric, or not finite.
    """
    return axes_of_bytes(check_symmetric("I_B", I_B).tobytes())


@lru_cache(maxsize=REMEMBERED)
def axes_of_bytes(data: bytes) -> PrincipalAxes:
    """Return `principal_axes` for the bytes of a symmetric matrix of doubles, unchecked. Results are kept."""
    frame = principal_frame(np.frombuffer(data, dtype=np.float64))
    low, middle, high = frame.moments
    first, second, third = (np.array([float(x) for x in axis]) for axis in frame.axes_B)
    equal = EQUAL_MOMENTS_TOLERANCE * max(abs(low), abs(high))
    low_pair, high_pair = middle - low <= equal, high - middle <= equal
    if low_pair and high_pair:
        low = middle = high = (low + middle + high) / 3
        R_BP = np.eye(3)
    elif low_pair:
        low = middle = (low + middle) / 2
        R_BP = np.roll(_nearest_frame(third), 2, axis=1)
    elif high_pair:
        middle = high = (middle + high) / 2
        R_BP = _nearest_frame(first)
    else:
        first, second = _signed(first), _signed(second)
        R_BP = np.column_stack([first, second, np.cross(first, second)])
    moments = np.array([float(low), float(middle), float(high)])
    moments.flags.writeable = R_BP.flags.writeable = False  # they are shared
    return PrincipalAxes(moments=moments, R_BP=R_BP)


def inertia_ellipsoid(I_B: ArrayLike, *, level: float = 1.0) -> InertiaEllipsoid:
    """Return the inertia ellipsoid r^T I r = a of a (3, 3) matrix, kg m^2 (lecture 25, eq. 14 and 15).

    With ``level`` = a = 2 T it is the energy ellipsoid in the space of angular velocities, rad/s (eq. 23).
    With a = m times 1 m^4 its distance is one over the radius of gyration.

    Raises:
        InvalidFieldError: the level is not > 0, the matrix is not symmetric, or a moment is negative.
    """
    level = check_positive("level", level)
    axes = principal_axes(I_B)
    low, _, high = axes.moments.tolist()
    if low < -float(EQUAL_MOMENTS_TOLERANCE) * abs(high):
        raise InvalidFieldError("I_B", f"principal moments {axes.moments.tolist()}", "moments >= 0")
    semi_axes = [math.sqrt(level / moment) if moment > 0.0 else math.inf for moment in axes.moments.tolist()]
    return InertiaEllipsoid(
        I_B=check_array("I_B", I_B, (3, 3)), level=level, semi_axes=np.array(semi_axes), R_BP=axes.R_BP
    )


def _nearest_frame(axis: FloatArray) -> FloatArray:
    """Return the body axes, (3, 3), in cyclic order, turned least to bring the first onto signed ``axis``."""
    k = _largest(axis)
    axis = _signed(axis)
    columns = [axis]
    for step in (1, 2):
        i = (k + step) % 3
        # The least rotation that takes e_k to n, applied to e_i: e_i - n_i (e_k + n) / (1 + n_k)
        turned = -axis[i] / (1.0 + axis[k]) * axis
        turned[k] -= axis[i] / (1.0 + axis[k])
        turned[i] += 1.0
        columns.append(turned)
    return np.column_stack(columns)


def _signed(axis: FloatArray) -> FloatArray:
    return axis if axis[_largest(axis)] > 0.0 else -axis


def _largest(axis: FloatArray) -> int:
    """Return the index of the largest component, the first among equals."""
    size = np.abs(axis)
    return int(np.argmax(size >= size.max() * (1.0 - AXIS_TIE)))


_MAX_SWEEPS: Final = 30
"""Bound on the sweeps. Convergence takes four to eight."""


@dataclass(frozen=True, slots=True)
class PrincipalFrame(Generic[Scalar]):
    """The principal moments in ascending order, and their axes."""

    moments: tuple[Scalar, Scalar, Scalar]  # kg m^2
    gaps: tuple[Scalar, Scalar, Scalar]  # kg m^2, middle - small, large - middle and large - small
    axes_B: tuple[tuple[Scalar, Scalar, Scalar], ...]  # 3 unit rows, body axes, of either handedness


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
