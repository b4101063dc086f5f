# SPDX-License-Identifier: Apache-2.0
"""Vectors of three numbers and matrices, as in `numerics.vectors`, in the compiled core of tosses.

`vectors.pxd` gives the C types with which this file compiles. Here all numbers are floats, while
`numerics.vectors` serves exact ones too.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeAlias

from contact_dynamics.tolerances import SQUARES_UNDERFLOW

if TYPE_CHECKING:
    from contact_dynamics.numerics.vectors import Vector3

Matrix3: TypeAlias = tuple[float, float, float, float, float, float, float, float, float]
"""A matrix (3, 3), row by row."""


def dot(a: Vector3, b: Vector3) -> float:
    """Return the inner product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector3, b: Vector3) -> Vector3:
    """Return the cross product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def norm(a: Vector3) -> float:
    """Return the Euclidean norm."""
    return math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


def normalised(a: Vector3) -> Vector3:
    """Return the unit vector along ``a``, or zero if that is zero."""
    size = math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    if size < SQUARES_UNDERFLOW:
        size = max(abs(a[0]), abs(a[1]), abs(a[2]))
        return a if size == 0.0 else normalised((a[0] / size, a[1] / size, a[2] / size))
    return (a[0] / size, a[1] / size, a[2] / size)


def opposite(a: Vector3) -> Vector3:
    """Return the vector the other way."""
    return (-a[0], -a[1], -a[2])


def without(a: Vector3, unit: Vector3) -> Vector3:
    """Return the part of ``a`` orthogonal to a unit vector."""
    along = a[0] * unit[0] + a[1] * unit[1] + a[2] * unit[2]
    return (a[0] - along * unit[0], a[1] - along * unit[1], a[2] - along * unit[2])


def plus(a: Vector3, factor: float, b: Vector3) -> Vector3:
    """Return a plus a multiple of b."""
    return (a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2])


def combined(p: float, a: Vector3, q: float, b: Vector3) -> Vector3:
    """Return p a + q b."""
    return (p * a[0] + q * b[0], p * a[1] + q * b[1], p * a[2] + q * b[2])


def times(matrix: Matrix3, vector: Vector3) -> Vector3:
    """Return the product of a matrix and a vector."""
    a, b, c, d, e, f, g, h, i = matrix
    x, y, z = vector
    return (a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z)


def transposed_times(matrix: Matrix3, vector: Vector3) -> Vector3:
    """Return the product of a matrix's transpose and a vector."""
    a, b, c, d, e, f, g, h, i = matrix
    x, y, z = vector
    return (a * x + d * y + g * z, b * x + e * y + h * z, c * x + f * y + i * z)
