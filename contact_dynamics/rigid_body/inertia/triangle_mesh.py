# SPDX-License-Identifier: Apache-2.0
"""Triangles bound solids: closed meshes, and the convex hull of points.

Density is uniform. Coordinates are in m, so scale a mesh in mm first.

A mesh is closed if each edge belongs to exactly two triangles, which pass it in opposite directions.
Triangles that name a vertex twice have no area and are left out. Flat triangles with three different vertices
are kept: they join their neighbours and enclose nothing. If the indices alone leave edges open, vertices at
exactly the same place are taken as one, because STL files and meshes with texture seams repeat vertices.
Places that differ in the last bit stay separate.

A surface may have several parts that share no edge. A part with a positive volume is a solid. It must not lie
within another, because its mass would count twice. A part with a negative volume is a cavity. It must lie
within a solid. Otherwise it is inside out. This is tested at one point just inside each part: the winding
number of the others about it, a sum of solid angles, is 0 or 1 (Van Oosterom and Strackee 1983).

Volume, centre and second moments are exact integrals (lecture 25, eq. 4 to 9). Each triangle and the origin
span a tetrahedron. The sign of its volume says on which side the origin is. Integrals of polynomials over it
have closed forms in its corners (Tonon 2004; Eberly 2002, "Polyhedral mass properties"). The origin is first
put at the mean of the vertices, then at the centre of mass, so that a mesh far away loses no digits. Rounding
leaves errors of about 1e-15. The exception is a needle that is askew to the axes: if its length is a times
its thickness, errors are up to 1e-16 a^2 (measured for a = 1e3 and 1e6: 4e-13 and 4e-7 of the volume).

Not covered: surfaces that cut through themselves or each other. Their volumes count by winding number.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NoReturn, TypeAlias

import numpy as np

from contact_dynamics.errors import InvalidFieldError, UndecidedError
from contact_dynamics.numerics.convex_hull import hull_of
from contact_dynamics.rigid_body.inertia.distribution import MassDistribution, inertia_of_second_moments
from contact_dynamics.rigid_body.inertia.solids import mass_of
from contact_dynamics.tolerances import EPSILON, SURFACES_TOUCH, VOLUME_ROUNDING
from contact_dynamics.validation import FloatArray, check_array, check_magnitude

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


def mesh(
    p_FV_F: ArrayLike, triangles: ArrayLike, *, mass: float | None = None, density: float | None = None
) -> MassDistribution:
    """Return the solid inside a closed triangle mesh.

    Several parts, cavities, degenerate triangles and repeated vertices are allowed.

    Args:
        p_FV_F: (n, 3), m, vertices in F.
        triangles: (m, 3), whole numbers: three vertices each, counterclockwise seen from outside.
        mass: kg, or None if a density is given.
        density: kg/m^3, or None if a mass is given.

    Raises:
        InvalidFieldError: the mesh is open, has edges of more than two triangles, has inconsistent windings,
            is inside out or flat, or has a part within a solid (the message names the edge, triangle or
            volume); a number is not finite, an index refers to no vertex, or not exactly one of mass and
            density is given.
    """
    return mesh_and_parts(p_FV_F, triangles, mass=mass, density=density)[0]


def mesh_and_parts(
    p_FV_F: ArrayLike, triangles: ArrayLike, *, mass: float | None = None, density: float | None = None
) -> tuple[MassDistribution, list[MeshPart]]:
    """Return the solid inside a closed mesh, as `mesh` does, and the parts that no edge connects."""
    vertices = check_magnitude("p_FV_F", check_array("p_FV_F", p_FV_F, (None, 3)))
    surface = closed_surface(vertices, triangles)
    labels = check_facing(vertices, surface)
    solid = _solid(vertices, surface.triangles, mass, density)
    return solid, _split(vertices, surface.triangles, labels)


def convex_hull(
    p_FV_F: ArrayLike, *, mass: float | None = None, density: float | None = None
) -> MassDistribution:
    """Return the solid convex hull of points (n, 3), m, such as a body's vertices.

    Give either ``mass``, kg, or ``density``, kg/m^3.

    Raises:
        InvalidFieldError: the points lie in a plane, a number is not finite, or not exactly one of mass and
            density is given.
    """
    vertices = check_magnitude("p_FV_F", check_array("p_FV_F", p_FV_F, (None, 3)))
    flat = InvalidFieldError("p_FV_F", f"{len(vertices)} points", "four or more, not in one plane")
    if len(vertices) < 4:
        raise flat
    points = vertices - vertices.mean(axis=0)
    thickness = float(np.linalg.svd(points, compute_uv=False)[2])
    if thickness <= EPSILON * len(vertices) * float(np.abs(vertices).max()):
        raise flat
    try:
        triangles = hull_of("p_FV_F", points).simplices
    except UndecidedError:
        raise flat from None
    inward = signed_volumes(points, triangles) < 0.0  # their mean is inside
    triangles[inward] = triangles[inward][:, ::-1]
    return _solid(vertices, triangles, mass, density)


def _solid(
    vertices: FloatArray, triangles: NDArray[np.int64], mass: float | None, density: float | None
) -> MassDistribution:
    inside = polyhedron(vertices, triangles)
    total = mass_of(inside.volume, mass=mass, density=density)
    I_B = inertia_of_second_moments(total / inside.volume * inside.second)
    return MassDistribution(mass=total, p_FB_F=inside.center_F, I_B=I_B)


_OUTWARDS: Final = "counter-clockwise seen from outside"


def check_facing(p_FV_F: FloatArray, surface: ClosedSurface) -> NDArray[np.int64]:
    """Return the number, (m,), of the part to which each triangle belongs.

    Raises:
        InvalidFieldError: a part is inside out or within another, or no volume is enclosed.
    """
    parts = _Parts.of(p_FV_F, surface)
    total, rounding = float(parts.volumes.sum()), float(parts.rounding.sum())
    if abs(total) <= rounding:
        raise InvalidFieldError(
            "triangles", f"an enclosed volume of {total:.3g} m^3: flat", "a surface around a volume"
        )
    if total < 0.0:
        raise InvalidFieldError("triangles", f"an enclosed volume of {total:.6g} m^3: inside out", _OUTWARDS)
    if len(parts.volumes) == 1:
        return parts.labels
    for part in np.flatnonzero(np.abs(parts.volumes) > parts.rounding).tolist():
        volume = float(parts.volumes[part])
        winding = parts.winding_of_others(part)
        first = int(surface.numbers[np.argmax(parts.labels == part)])
        named = f"a part (that of triangle {first}) of volume {volume:.6g} m^3"
        if volume < 0.0 and winding < 1:
            raise InvalidFieldError("triangles", f"{named} in no solid: inside out", _OUTWARDS)
        if volume > 0.0 and winding > 0:
            raise InvalidFieldError(
                "triangles", f"{named} within another", "solids side by side, or in a cavity"
            )
    return parts.labels


@dataclass(frozen=True, slots=True)
class _Parts:
    """A surface's k connected parts."""

    corners: FloatArray  # (m, 3, 3), m, of all triangles
    labels: NDArray[np.int64]  # (m,), the part of each triangle, 0 to k - 1
    volumes: FloatArray  # (k,), m^3, signed
    rounding: FloatArray  # (k,), m^3, how far off each volume may be
    lowest: FloatArray  # (k, 3), m, corner of each part's bounding box
    highest: FloatArray  # (k, 3), m

    @classmethod
    def of(cls, p_FV_F: FloatArray, surface: ClosedSurface) -> _Parts:
        one, other = surface.neighbors.T
        labels = _labels(one, other, len(surface.triangles))
        corners = p_FV_F[surface.triangles]
        sizes = np.bincount(labels)
        # Each part is measured from its own middle, so that a small one far away keeps its digits.
        middle = np.column_stack([np.bincount(labels, corners[:, 0, i]) / sizes for i in range(3)])
        points = (corners - middle[labels][:, None, :]).reshape(-1, 3)
        each = signed_volumes(points, np.arange(len(points)).reshape(-1, 3))
        volumes: FloatArray = np.bincount(labels, each).astype(np.float64)
        edges = np.diff(points.reshape(-1, 3, 3), axis=1)
        areas: FloatArray = 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
        reach = VOLUME_ROUNDING * np.abs(points).reshape(-1, 9).max(axis=1)
        reach += EPSILON * float(np.abs(corners).max())
        lowest, highest = np.full((len(sizes), 3), math.inf), np.full((len(sizes), 3), -math.inf)
        np.minimum.at(lowest, labels, corners.min(axis=1))
        np.maximum.at(highest, labels, corners.max(axis=1))
        return cls(
            corners=corners,
            labels=labels,
            volumes=volumes,
            rounding=np.bincount(labels, areas * reach).astype(np.float64),
            lowest=lowest,
            highest=highest,
        )

    def winding_of_others(self, part: int) -> int:
        """Return how often the other parts go round a point just inside this one."""
        meets = (self.lowest <= self.highest[part]) & (self.highest >= self.lowest[part])
        near = meets.all(axis=1)[self.labels]
        is_own = self.labels == part
        others = self.corners[near & ~is_own]
        if len(others) == 0:
            return 0
        inwards = -math.copysign(1.0, self.volumes[part])
        return _winding_number(others, _point_inside(self.corners[is_own], self.corners[near], inwards))


MeshPart: TypeAlias = "tuple[FloatArray, NDArray[np.int64]]"
"""The vertices, (k, 3), m, and the triangles, (t, 3), of a part of a mesh."""


def connected_parts(p_FV_F: FloatArray, triangles: ArrayLike) -> list[MeshPart]:
    """Return the parts of a closed mesh that no edge connects.

    An open mesh has one part, since its triangles may belong together without sharing corners.

    Raises:
        InvalidFieldError: the triangles are not (m, 3) indices of vertices, or all of them are degenerate.
    """
    indices = _check_indices(triangles, len(p_FV_F))
    edges = _Edges.of(indices)
    if (edges.counts == 1).any():
        edges = _Edges.of(_same_places(p_FV_F)[indices])
    if (edges.counts == 1).any():
        return [(p_FV_F, indices)]
    first = edges.owners[np.repeat(edges.starts, edges.counts)]
    return _split(p_FV_F, edges.triangles, _labels(first, edges.owners, len(edges.triangles)))


def _split(vertices: FloatArray, triangles: NDArray[np.int64], labels: NDArray[np.int64]) -> list[MeshPart]:
    if not labels.any():
        return [(vertices, triangles)]
    found = [np.unique(triangles[labels == part], return_inverse=True) for part in range(labels.max() + 1)]
    return [(vertices[used], corners.reshape(-1, 3).astype(np.int64)) for used, corners in found]


def _labels(one: NDArray[np.int64], other: NDArray[np.int64], size: int) -> NDArray[np.int64]:
    """Return the number, (m,), of the part to which each triangle belongs, from neighbours among them."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    graph = coo_matrix((np.ones(len(one), dtype=np.int8), (one, other)), shape=(size, size))
    labels: NDArray[np.int64] = connected_components(graph, directed=False)[1].astype(np.int64)
    return labels


def _point_inside(own: FloatArray, near: FloatArray, inwards: float) -> FloatArray:
    """Return a point behind a part's largest triangle, half way to the next triangle of any part.

    The ray is intersected with triangles as by Möller and Trumbore (1997), in barycentric coordinates u, v.
    """
    normals = np.cross(own[:, 1] - own[:, 0], own[:, 2] - own[:, 0])
    sizes = np.linalg.norm(normals, axis=1)
    largest = int(sizes.argmax())
    start: FloatArray = own[largest].mean(axis=0)
    ray = inwards / sizes[largest] * normals[largest]
    one, other, from_corner = near[:, 1] - near[:, 0], near[:, 2] - near[:, 0], start - near[:, 0]
    across, back = np.cross(ray, other), np.cross(from_corner, one)
    touching = SURFACES_TOUCH * float(np.ptp(own.reshape(-1, 3), axis=0).max())
    with np.errstate(divide="ignore", invalid="ignore"):  # planes along the ray are met nowhere
        slope = _dots(one, across)
        u, v, distance = _dots(from_corner, across) / slope, back @ ray / slope, _dots(other, back) / slope
        met = (
            (u > -SURFACES_TOUCH)
            & (v > -SURFACES_TOUCH)
            & (u + v < 1.0 + SURFACES_TOUCH)
            & (distance > touching)
        )
        met &= np.isfinite(distance)
    gap = float(distance[met].min()) if met.any() else touching  # a thinner part has none
    point: FloatArray = start + 0.5 * gap * ray
    return point


def _winding_number(corners: FloatArray, point: FloatArray) -> int:
    """Return how often closed triangles, (m, 3, 3), go round a point that is on none of them."""
    a, b, c = (corners[:, i] - point for i in range(3))
    la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
    real = la * lb * lc + _dots(a, b) * lc + _dots(b, c) * la + _dots(c, a) * lb
    half_angles = np.arctan2(_dots(a, np.cross(b, c)), real)
    return round(float(half_angles.sum()) / (2.0 * math.pi))


def _dots(x: FloatArray, y: FloatArray) -> FloatArray:
    dots: FloatArray = np.einsum("ij,ij->i", x, y)
    return dots


@dataclass(frozen=True, slots=True, repr=False)
class Polyhedron:
    """What triangles enclose."""

    volume: float  # m^3
    center_F: FloatArray  # (3,), m
    second: FloatArray  # (3, 3), m^5, integral of x x^T dV about the centre, F's axes


def polyhedron(p_FV_F: FloatArray, triangles: NDArray[np.int64]) -> Polyhedron:
    """Return the integrals inside a surface, (m, 3) indices of vertices (n, 3), m, that encloses a volume."""
    origin = p_FV_F[triangles[:, 0]].mean(axis=0)
    points = p_FV_F - origin
    volume, first, _ = _integrals(points, triangles)
    center = first / volume
    volume, _, second = _integrals(points - center, triangles)
    return Polyhedron(volume=volume, center_F=origin + center, second=second)


def signed_volumes(points: FloatArray, triangles: NDArray[np.int64]) -> FloatArray:
    """Return the signed volumes, (m,), m^3, of the triangles' tetrahedra with the origin.

    They are computed from a corner and two edges, so that small triangles far from the origin keep their
    digits. The edges are the two shorter ones, so that needles keep theirs.
    """
    corners = points[triangles.T]  # (3, m, 3)
    edges = np.roll(corners, -1, axis=0) - corners  # each from its corner to the next
    longest = np.einsum("eij,eij->ei", edges, edges).argmax(axis=0)
    each = np.arange(len(triangles))
    normals = np.cross(edges[(longest + 1) % 3, each], edges[(longest + 2) % 3, each])
    volumes: FloatArray = np.einsum("ij,ij->i", corners[0], normals) / 6.0
    return volumes


def _integrals(points: FloatArray, triangles: NDArray[np.int64]) -> tuple[float, FloatArray, FloatArray]:
    """Return the integrals of 1, x and x x^T.

    Over one tetrahedron: V, V s / 4 and V (a a^T + b b^T + c c^T + s s^T) / 20, with s = a + b + c.
    """
    volumes = signed_volumes(points, triangles)
    corners = [points[triangles[:, i]] for i in range(3)]
    total = corners[0] + corners[1] + corners[2]
    second = np.zeros((3, 3))
    for x in (*corners, total):
        second += (x * volumes[:, None]).T @ x / 20.0
    return float(volumes.sum()), volumes @ total / 4.0, 0.5 * (second + second.T)


_CLOSED: Final = "a closed surface: each edge in exactly two triangles"
_WOUND: Final = "triangles wound alike: both pass their common edge in opposite directions"


@dataclass(frozen=True, slots=True, repr=False)
class ClosedSurface:
    """Triangles that close and are wound alike."""

    triangles: NDArray[np.int64]  # (m, 3), indices of vertices
    numbers: NDArray[np.int64]  # (m,), each triangle's number in the caller's list
    neighbors: NDArray[np.int64]  # (3 m / 2, 2), the two triangles at each edge, indices into ``triangles``


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
