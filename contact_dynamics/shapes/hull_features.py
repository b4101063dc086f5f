# SPDX-License-Identifier: Apache-2.0
"""A convex hull touches with its corners, faces, edges and rims. This file finds their places and directions.

Two orthogonal radii describe a rim. Its points and their heights follow from them.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.numerics.convex_hull import hull_of
from contact_dynamics.numerics.vectors import near_x
from contact_dynamics.tolerances import FLAT_HULL, SAME_DIRECTION

if TYPE_CHECKING:
    from contact_dynamics.rotations.one import Vector
    from contact_dynamics.shapes.convex import ConvexShape, Rim
    from contact_dynamics.validation import FloatArray


RIM_CORNERS: Final = 32

_KEPT: Final = 256
"""Number of convex shapes whose features are remembered, enough for two bodies of `MAX_PARTS` parts."""


class Features(NamedTuple):
    """The features of a hull, which is solid, a plate (two faces), a rod (one edge) or a point."""

    corners: FloatArray  # (k, 3), m
    normals: FloatArray  # (f, 3), unit, outward
    edges: FloatArray  # (e, 3), unit directions of edges; parallel edges have one
    triangles: FloatArray  # (t, 3, 3), m, the corners of the triangles that the faces consist of


@lru_cache(maxsize=_KEPT)
def features_of(shape: ConvexShape) -> Features:
    """Return the features of the hull of a shape's corners and of points of its rims, in its axes.

    Rims are replaced by `RIM_CORNERS` corners, so the features have some of the directions of a round side.
    """
    rims = [radii_of(rim) for rim in shape.rims]
    turns = np.linspace(0.0, 2.0 * np.pi, RIM_CORNERS, endpoint=False)
    circle = np.column_stack([np.ones(RIM_CORNERS), np.cos(turns), np.sin(turns)])
    return hull_features(
        np.concatenate([shape.vertices, *(circle @ [rim.center, rim.first, rim.second] for rim in rims)])
    )


def hull_features(points: FloatArray) -> Features:
    """Return the features of the hull of points, (k, 3), m, k > 0."""
    center = points.mean(axis=0)
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    nothing = np.zeros((0, 3))
    if size == 0.0:
        return Features(points[:1], nothing, nothing, np.zeros((0, 3, 3)))
    _, spread, axes = np.linalg.svd(points - center, full_matrices=False)
    rank = int(np.sum(spread > FLAT_HULL * size))
    if rank == 1:
        along = (points - center) @ axes[0]
        ends = points[[int(along.argmin()), int(along.argmax())]]
        return Features(ends, nothing, axes[:1], np.zeros((0, 3, 3)))
    if rank == 2:
        outline = points[hull_of("vertices", (points - center) @ axes[:2].T).vertices]
        sides = np.roll(outline, -1, axis=0) - outline
        fan = np.array([outline[[0, i, i + 1]] for i in range(1, len(outline) - 1)])
        normal = np.cross(axes[0], axes[1])
        return Features(outline, np.array([normal, -normal]), _distinct(_unit(sides), signed=False), fan)
    hull = hull_of("vertices", points)
    normals = hull.equations[:, :3]
    ridges = [
        points[a] - points[b]
        for i, simplex in enumerate(hull.simplices)
        for corner, j in enumerate(hull.neighbors[i])
        if i < j and 1.0 - normals[i] @ normals[j] > SAME_DIRECTION
        for a, b in [np.delete(simplex, corner)]
    ]
    return Features(
        points[hull.vertices],
        _distinct(normals, signed=True),
        _distinct(_unit(np.array(ridges)), signed=False),
        points[hull.simplices],
    )


def _unit(vectors: FloatArray) -> FloatArray:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    units: FloatArray = vectors / lengths
    return units


def _distinct(directions: FloatArray, *, signed: bool) -> FloatArray:
    kept: list[FloatArray] = []
    for direction in directions:
        cosines = np.array(kept).reshape(-1, 3) @ direction
        if not (1.0 - (cosines if signed else np.abs(cosines)) <= SAME_DIRECTION).any():
            kept.append(direction)
    return np.array(kept)


class Radii(NamedTuple):
    """A rim as two orthogonal radii."""

    center: Vector  # position of the centre, m
    first: Vector  # the first radius, as a vector, m
    second: Vector  # the second radius, m
    reach: float  # a distance from the origin that no point of the rim exceeds, m


def radii_of(rim: Rim) -> Radii:
    """Return two orthogonal radii of a rim. The first is towards x, or towards y for a rim about x."""
    axis = np.array(rim.axis)
    first = near_x(axis)
    first *= rim.radius / math.sqrt(first @ first)
    second = np.cross(axis, first)
    reach = math.hypot(*rim.center) + rim.radius
    return Radii(rim.center, _triple(first), _triple(second), reach)


def _triple(vector: np.ndarray) -> Vector:
    x, y, z = vector.tolist()
    return (x, y, z)
