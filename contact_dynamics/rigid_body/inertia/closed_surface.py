# SPDX-License-Identifier: Apache-2.0
"""Is a list of triangles a closed surface, wound one way? If not, at which edge does it fail?

Each edge must belong to exactly two triangles, which pass it in opposite directions. Triangles that name a
vertex twice have no area and are left out. Flat triangles with three different vertices are kept: they join
their neighbours and enclose nothing. If the indices alone leave edges open, vertices at exactly the same
place are taken as one, because STL files and meshes with texture seams repeat vertices. Places that differ in
the last bit stay separate.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NoReturn

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.records import Record

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from contact_dynamics.validation import FloatArray

_CLOSED: Final = "a closed surface: each edge in exactly two triangles"
_WOUND: Final = "triangles wound alike: both pass their common edge in opposite directions"


@dataclass(frozen=True, slots=True, repr=False)
class ClosedSurface(Record):
    """Triangles that close and are wound alike.

    Attributes:
        triangles: (m, 3), indices of vertices.
        numbers: (m,), each triangle's number in the caller's list.
        neighbors: (3 m / 2, 2), the two triangles at each edge, indices into ``triangles``.
    """

    triangles: NDArray[np.int64]
    numbers: NDArray[np.int64]
    neighbors: NDArray[np.int64]


def closed_surface(p_FV_F: FloatArray, triangles: ArrayLike) -> ClosedSurface:
    """Return the surface of (m, 3) vertex indices, or raise `InvalidFieldError` with the offending edge."""
    indices = _check_indices(triangles, len(p_FV_F))
    surface = _Edges.of(indices)
    if (surface.counts == 1).any():
        surface = _Edges.of(_same_places(p_FV_F)[indices])
    return surface.closed()


@dataclass(frozen=True, slots=True)
class _Edges:
    """The directed edges of triangles, sorted so that those between the same two vertices stand together."""

    triangles: NDArray[np.int64]  # (m, 3)
    numbers: NDArray[np.int64]  # (m,)
    tails: NDArray[np.int64]  # (3 m,), first vertex of each directed edge
    heads: NDArray[np.int64]  # (3 m,), second vertex
    owners: NDArray[np.int64]  # (3 m,), index of its triangle
    starts: NDArray[np.int64]  # (e,), where each undirected edge begins
    counts: NDArray[np.int64]  # (e,), how many triangles it has

    @classmethod
    def of(cls, indices: NDArray[np.int64]) -> _Edges:
        a, b, c = indices.T
        numbers = np.flatnonzero((a != b) & (b != c) & (c != a))
        if len(numbers) == 0:
            raise InvalidFieldError("triangles", "none with three different vertices", "at least four")
        triangles = indices[numbers]
        tails, heads = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
        low, high = np.minimum(tails, heads), np.maximum(tails, heads)
        key = low * (int(indices.max()) + 1) + high
        order = np.argsort(key, kind="stable")
        starts = np.flatnonzero(np.diff(key[order], prepend=-1))
        return cls(
            triangles=triangles,
            numbers=numbers,
            tails=tails[order],
            heads=heads[order],
            owners=order // 3,
            starts=starts,
            counts=np.diff(starts, append=len(key)),
        )

    def closed(self) -> ClosedSurface:
        """Return the surface, or raise with its first edge that is open, crowded, or passed one way."""
        opened = np.flatnonzero(self.counts == 1)
        if len(opened):
            self._refuse(opened, "has no second triangle: the mesh is open", _CLOSED)
        crowded = np.flatnonzero(self.counts > 2)
        if len(crowded):
            self._refuse(crowded, "has more than two triangles", _CLOSED)
        one_way = np.flatnonzero(self.tails[self.starts] == self.tails[self.starts + 1])
        if len(one_way):
            self._refuse(one_way, "is passed in one direction by both", _WOUND)
        neighbors = np.column_stack([self.owners[self.starts], self.owners[self.starts + 1]])
        return ClosedSurface(triangles=self.triangles, numbers=self.numbers, neighbors=neighbors)

    def _refuse(self, edges: NDArray[np.int64], reason: str, allowed: str) -> NoReturn:
        start, count = int(self.starts[edges[0]]), int(self.counts[edges[0]])
        owners = ", ".join(str(number) for number in self.numbers[self.owners[start : start + min(count, 4)]])
        edge = (
            f"edge {int(self.tails[start])}-{int(self.heads[start])} of triangle{'s' * (count > 1)} {owners}"
        )
        also = f" (and {len(edges) - 1} more)" if len(edges) > 1 else ""
        raise InvalidFieldError("triangles", f"{edge} {reason}{also}", allowed)


def _check_indices(triangles: ArrayLike, vertices: int) -> NDArray[np.int64]:
    try:
        given = np.asarray(triangles)
    except (TypeError, ValueError, OverflowError):
        raise InvalidFieldError("triangles", triangles, "whole numbers of shape (n, 3)") from None
    if given.ndim != 2 or given.shape[1] != 3:
        raise InvalidFieldError("triangles", f"shape {given.shape}", "of shape (n, 3)")
    if given.dtype.kind not in "iu":
        raise InvalidFieldError(
            "triangles", f"numbers of type {given.dtype}", "whole numbers of an integer type"
        )
    indices = given.astype(np.int64)
    wrong = np.flatnonzero(((indices < 0) | (indices >= vertices)).any(axis=1))
    if len(wrong):
        found = f"{indices[wrong[0]].tolist()} in triangle {wrong[0]}"
        raise InvalidFieldError("triangles", found, f"indices in [0, {vertices - 1}], of {vertices} vertices")
    return indices


def _same_places(points: FloatArray) -> NDArray[np.int64]:
    """Return for each vertex, (n,), the lowest index of a vertex at exactly its place."""
    order = np.lexsort(points.T)  # stable: the lowest index comes first
    new = np.ones(len(points), dtype=bool)
    new[1:] = (points[order][1:] != points[order][:-1]).any(axis=1)
    lowest = np.empty(len(points), dtype=np.int64)
    lowest[order] = order[new][np.cumsum(new) - 1]
    return lowest
