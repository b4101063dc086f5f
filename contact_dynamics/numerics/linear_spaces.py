# SPDX-License-Identifier: Apache-2.0
"""Orthonormal bases of the span of vectors and of its complement, with their dimensions.

Few vectors are orthogonalised by the Gram-Schmidt method, and rows of matrices by singular values.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.numerics.vectors import norm, normalised, without
from contact_dynamics.tolerances import ROW_TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.validation import FloatArray


def orthonormal(vectors: Iterable[Sequence[float]]) -> list[tuple[float, ...]]:
    """Return an orthonormal basis of the span of unit ``vectors`` (of any one dimension)."""
    basis: list[tuple[float, ...]] = []
    for vector in vectors:
        rest, size = _without_all(vector, basis)
        # Two passes are enough (Kahan): the second one removes the rounding errors of the first.
        if basis and size > ROW_TOLERANCE:
            rest, size = _without_all(rest, basis)
        if size > ROW_TOLERANCE:
            basis.append(tuple([a / size for a in rest]))
            if len(basis) == len(rest):
                break
    return basis


def _without_all(vector: Sequence[float], basis: list[tuple[float, ...]]) -> tuple[Sequence[float], float]:
    """Return the part of a vector that is orthogonal to a basis, and its length."""
    rest = vector
    for unit in basis:
        part = 0.0
        for a, b in zip(rest, unit, strict=True):
            part += a * b
        rest = [a - part * b for a, b in zip(rest, unit, strict=True)]
    square = 0.0
    for a in rest:
        square += a * a
    return rest, math.sqrt(square)


def rough_span(vectors: Iterable[Vector3], *, tolerance: float) -> list[Vector3]:
    """Return an orthonormal basis of the span of unit ``vectors``. Zero vectors are allowed and add nothing.

    A vector whose angle to the span has a sine of at most ``tolerance`` counts as in the span. The tolerance
    far exceeds rounding, so one pass is enough, unlike in `orthonormal`.
    """
    basis: list[Vector3] = []
    for vector in vectors:
        rest = vector
        for unit in basis:
            rest = without(rest, unit)
        if norm(rest) > tolerance:
            basis.append(normalised(rest))
    return basis


def row_space(rows: FloatArray) -> FloatArray:
    """Return an orthonormal basis, (k, d), of the span of rows, (m, d)."""
    if len(rows) == 0:
        return np.zeros(rows.shape)
    sizes, basis = np.linalg.svd(rows)[1:]
    return basis[: int((sizes > ROW_TOLERANCE * sizes[0]).sum())]


def null_space(rows: FloatArray) -> FloatArray:
    """Return an orthonormal basis, (d, k), of the vectors orthogonal to all rows, (m, d)."""
    if len(rows) == 0:
        return np.eye(rows.shape[1])
    sizes, basis = np.linalg.svd(rows)[1:]
    return np.ascontiguousarray(basis[int((sizes > ROW_TOLERANCE * sizes[0]).sum()) :].T)


def seen_and_unseen(rows: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return orthonormal bases, (k, d) and (d - k, d), of the span of rows of unit length, and of the rest.

    Unlike in `row_space` and `null_space`, the length of the rows matters: rows that consist of rounding
    errors span nothing. Because there are many rows, they are first reduced to as many as there are columns,
    which changes last bits.
    """
    if len(rows) > rows.shape[1]:
        rows = np.asarray(np.linalg.qr(rows, mode="r"))
    sizes, basis = np.linalg.svd(rows)[1:]
    seen = int((sizes > ROW_TOLERANCE * max(1.0, sizes.max(initial=0.0))).sum())
    return basis[:seen], basis[seen:]


def triangle_of(matrices: FloatArray) -> FloatArray:
    """Return R of A = Q R, (..., min(m, n), n), for A, (..., m, n): the same inner products in fewer rows."""
    triangle: FloatArray = np.asarray(np.linalg.qr(matrices, mode="r"))  # an array in this mode
    return triangle
