# SPDX-License-Identifier: Apache-2.0
"""This file calculates with vectors of three numbers, and finds the tangents of a plane.

`Vector3` is three plain floats. For one answer they are much faster than an array.

**Which tangents?**  No choice changes continuously with all normals. Physics does not depend on the choice,
but the order of a pyramid's edges and the last bits of answers do. So each choice has its own function here.
*Least* is the coordinate axis that is furthest from the normal.

| function | first tangent | chosen where |
| --- | --- | --- |
| `tangents`, `tangent_rows` | normal x least | only the plane matters |
| `tangents_towards` | towards a direction, or least x normal | edges of friction pyramids start there |
| `along_least` | least, made orthogonal | the one tangent of a side that is alike all around |
| `near_x`, `tangents_near_x` | x, made orthogonal; y for normals along x | people look, or a rim begins |
| `tangents_by_sign` | a formula without a choice of axes | impacts, whose compiled form does not branch |
"""

from __future__ import annotations

import math
from itertools import chain
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np

from contact_dynamics.tolerances import ROW_TOLERANCE, SQUARES_UNDERFLOW

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.validation import FloatArray

Vector3: TypeAlias = tuple[float, float, float]

AXES: Final[tuple[Vector3, ...]] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))

ALONG_X: Final = 0.9
"""Cosine above which a direction counts as along x."""


def dot(a: Vector3, b: Vector3) -> float:
    """Return the inner product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector3, b: Vector3) -> Vector3:
    """Return the cross product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def combined(x: float, a: Vector3, y: float, b: Vector3) -> Vector3:
    """Return x a + y b."""
    return (x * a[0] + y * b[0], x * a[1] + y * b[1], x * a[2] + y * b[2])


def norm(a: Vector3) -> float:
    """Return the Euclidean norm."""
    return math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


def opposite(a: Vector3) -> Vector3:
    """Return the vector the other way."""
    return (-a[0], -a[1], -a[2])


def scaled(a: Vector3, factor: float) -> Vector3:
    """Return a multiple of the vector."""
    return (factor * a[0], factor * a[1], factor * a[2])


def array_of(vectors: Sequence[Vector3]) -> FloatArray:
    """Return the vectors as an array, (n, 3). `np.array` takes three times as long for dozens of them."""
    flat = np.fromiter(chain.from_iterable(vectors), dtype=np.float64, count=3 * len(vectors))
    return flat.reshape(-1, 3)


def normalised(a: Vector3) -> Vector3:
    """Return the unit vector along ``a``, which is not zero."""
    size = math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    if size < SQUARES_UNDERFLOW:
        size = math.hypot(*a)
    return (a[0] / size, a[1] / size, a[2] / size)


def without(a: Vector3, unit: Vector3) -> Vector3:
    """Return the part of ``a`` orthogonal to a unit vector."""
    along = a[0] * unit[0] + a[1] * unit[1] + a[2] * unit[2]
    return (a[0] - along * unit[0], a[1] - along * unit[1], a[2] - along * unit[2])


def across(vector: FloatArray, unit: FloatArray) -> FloatArray:
    """Return the part of a vector, (3,), orthogonal to a unit vector, (3,): `without` for arrays."""
    part: FloatArray = vector - (vector @ unit) * unit
    return part


def tangents(normal: Vector3) -> tuple[Vector3, Vector3]:
    """Return two unit tangents that make a right-handed frame with a unit normal."""
    first = normalised(cross(normal, _least(normal)))
    return first, cross(normal, first)


def tangent_rows(normal: FloatArray) -> FloatArray:
    """Return `tangents` of a unit normal, (3,), as the rows of a (2, 3) matrix."""
    x, y, z = normal.tolist()
    return np.array(tangents((x, y, z)))


def tangents_towards(normal: FloatArray, towards: FloatArray | None = None) -> tuple[FloatArray, FloatArray]:
    """Return two unit tangents, (3,) each, that make a right-handed frame with a unit normal, (3,).

    The first leans towards the direction ``towards``, (3,), unless that is along the normal or not given.
    """
    if towards is not None:
        first = across(towards, normal)
        size = math.sqrt(first @ first)
        if size > ROW_TOLERANCE * math.sqrt(towards @ towards):
            first = first / size
            return first, cross_of_two(normal, first)
    x, y, z = normal.tolist()
    one = normalised(cross(_least((x, y, z)), (x, y, z)))
    return np.array(one), np.array(cross((x, y, z), one))


def along_least(normal: FloatArray) -> FloatArray:
    """Return one unit tangent, (3,), of a unit normal, (3,)."""
    tangent = across(np.eye(3)[int(np.abs(normal).argmin())], normal)
    return tangent / math.sqrt(tangent @ tangent)


def near_x(normal: FloatArray) -> FloatArray:
    """Return a tangent, (3,), not unit, of a unit normal, (3,): x made orthogonal, or y for one near x."""
    return across(np.array(AXES[0] if abs(normal[0]) < ALONG_X else AXES[1]), normal)


def tangents_near_x(normal: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return two unit vectors, (3,), that with a unit normal make a right-handed frame: x and y for z."""
    first = near_x(normal)
    first = first / math.sqrt(first @ first)
    return first, cross_of_two(normal, first)


def tangents_by_sign(normal: Vector3) -> tuple[Vector3, Vector3]:
    """Return two unit tangents (Duff et al. 2017, "Building an orthonormal basis, revisited")."""
    x, y, z = normal
    s = math.copysign(1.0, z)
    a = -1.0 / (s + z)
    b = x * y * a
    return (1.0 + s * x * x * a, s * b, -s * x), (b, s + y * y * a, -y)


def cross_of_two(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the cross product of two vectors, (3,). `np.cross` is ten times slower, for the same bits."""
    a, b, c = one.tolist()
    x, y, z = other.tolist()
    return np.array(cross((a, b, c), (x, y, z)))


def _least(unit: Vector3) -> Vector3:
    return min(AXES, key=lambda axis: abs(dot(axis, unit)))


def point_jacobians(arms: FloatArray) -> FloatArray:
    """Return the (n, 3, 6) matrices that take a body's (v, w) to the velocities of its points at ``arms``.

    ``arms`` is (n, 3), from the point whose velocity is v. The transpose takes forces at the points to a
    wrench about that point.
    """
    rows = np.zeros((len(arms), 3, 6))
    rows[:, :, :3] = np.eye(3)
    for i, (x, y, z) in enumerate(arms.tolist()):
        rows[i, :, 3:] = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]
    return rows
