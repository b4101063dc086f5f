"""How many of some vectors are independent, and orthonormal bases: Gram and Schmidt with one tolerance."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from contact_dynamics.tolerances import ROW_TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence


def orthonormal(vectors: Iterable[Sequence[float]]) -> list[tuple[float, ...]]:
    """Return an orthonormal basis of the span of unit ``vectors`` (of any one dimension)."""
    basis: list[tuple[float, ...]] = []
    for vector in vectors:
        rest = tuple(vector)
        for _ in range(2):  # twice is enough (Kahan): the second pass removes what rounding left
            for unit in basis:
                part = sum(a * b for a, b in zip(rest, unit, strict=True))
                rest = tuple(a - part * b for a, b in zip(rest, unit, strict=True))
        size = math.sqrt(sum(a * a for a in rest))
        if size > ROW_TOLERANCE:
            basis.append(tuple(a / size for a in rest))
            if len(basis) == len(rest):
                break
    return basis
