# SPDX-License-Identifier: Apache-2.0
"""Vectors in R^3 whose components are floats or decimals. The same formulas work for both."""

from __future__ import annotations

import math
from decimal import Decimal
from typing import TYPE_CHECKING, cast

from contact_dynamics.numerics.vectors import Vector3, cross, tangents

if TYPE_CHECKING:
    from collections.abc import Sequence


def combination(parts: Sequence[float], vectors: Sequence[Vector3]) -> Vector3:
    """Return the sum of vectors, each times its part."""
    x = y = z = 0 * parts[0]
    for part, vector in zip(parts, vectors, strict=True):
        x += part * vector[0]
        y += part * vector[1]
        z += part * vector[2]
    return (x, y, z)


def complement(basis: list[Vector3], along: Vector3) -> list[Vector3]:
    """Return an orthonormal basis of what is orthogonal to a unit vector in the span of a basis."""
    if len(basis) == 1:
        return []
    if len(basis) == 2:
        normal = cross(basis[0], basis[1])
        return [unit(cross(normal, along))]
    x, y, z = along
    one, _ = tangents((float(x), float(y), float(z)))
    if isinstance(x, float):
        return [one, cross(along, one)]
    one = unit(cross(decimal_vector(one), along))
    return [one, cross(along, one)]


def decimal_vector(vector: Vector3) -> Vector3:
    """Return the vector in decimals. The type says floats, because the formulas here work for both."""
    x, y, z = vector
    return cast("Vector3", (Decimal(x), Decimal(y), Decimal(z)))


def rounded(vector: Vector3) -> Vector3:
    """Return the vector in floats."""
    return (float(vector[0]), float(vector[1]), float(vector[2]))


def root(square: float) -> float:
    """Return the square root of a number >= 0."""
    return square.sqrt() if isinstance(square, Decimal) else math.sqrt(square)


def unit(vector: Vector3) -> Vector3:
    """Return the vector at unit length."""
    x, y, z = vector
    square = x * x + y * y + z * z
    size = math.sqrt(square) if type(square) is float else root(square)
    return (x / size, y / size, z / size)
