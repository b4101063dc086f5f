# SPDX-License-Identifier: Apache-2.0
"""Makes the drawable shape of a body: faces with edges between them, flat facets on round sides."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.diagrams.marks import Faces
from contact_dynamics.rotations.one import rotation_matrix
from contact_dynamics.shapes.hull_features import radii_of

if TYPE_CHECKING:
    from contact_dynamics.diagrams.palette import Paint
    from contact_dynamics.shapes.convex import ConvexShape
    from contact_dynamics.shapes.hull_features import Radii
    from contact_dynamics.validation import FloatArray

FLAT: Final = 1e-6
"""Relative to a body's size. If it is thinner than this, it is drawn as a polygon, a line or a point. It is
also 1 - cos of the angle, 0.08 degrees, below which two triangles are one face."""

ROUND_FACETS: Final = 48
"""Number of facets around a rim or a ball. A chord is then 0.2 % of the radius from its arc."""

MAX_BALLS: Final = 100
"""Up to this number of corners are rounded with all facets. If there are more corners, each has fewer facets.
"""

SHARP: Final = 0.06
"""1 - cos of the angle, 20 degrees. Facets of a round body that meet at less are one side of it."""

NO_SIZE: Final = 0.05  # m. A body without shape is drawn with this size.


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shape:
    """Faces and edges of a body, in body axes."""

    triangles_B: FloatArray  # (m, 3, 3), m, corners of each triangle, counterclockwise seen from outside
    normals_B: FloatArray  # (m, 3), unit, outward normal of each triangle
    edges_B: FloatArray  # (k, 2, 3), m, ends of each edge
    size: float  # m, > 0, distance between the two ends of the body's bounding box


def drawn_shape(shape: ConvexShape) -> Shape:
    """Return a body's shape. A round one has circles and radii among its edges, which show how it turns."""
    if shape.parts:
        drawn = [drawn_shape(part) for part in shape.parts]
        triangles = np.concatenate([part.triangles_B for part in drawn])
        edges = np.concatenate([part.edges_B for part in drawn])
        points = np.concatenate([triangles.reshape(-1, 3), edges.reshape(-1, 3)])
        return Shape(
            triangles_B=triangles,
            normals_B=np.concatenate([part.normals_B for part in drawn]),
            edges_B=edges,
            size=float(np.linalg.norm(np.ptp(points, axis=0))) if len(points) else NO_SIZE,
        )
    if shape.is_polyhedron:
        return convex_shape(shape.vertices)
    hull = convex_shape(_surface_points(shape), smooth=SHARP)
    lines = [_circle(vertex, axes, shape.rounding) for vertex in shape.vertices for axes in _PLANES]
    lines += [np.array([radii.center, np.add(radii.center, radii.first)]) for radii in _radii(shape)]
    marks = [np.stack([line[:-1], line[1:]], axis=1) for line in lines if np.ptp(line, axis=0).any()]
    return replace(hull, edges_B=np.concatenate([hull.edges_B, *marks]))


def convex_shape(vertices_B: FloatArray, *, smooth: float = FLAT) -> Shape:
    """Return the shape of the hull of corners, (k, 3), m, which may lie in a plane or on a line.

    There is an edge where 1 - cos of the angle between two facets exceeds ``smooth``.
    """
    if len(vertices_B) == 0:
        return NO_FACES
    center = vertices_B.mean(axis=0)
    size = float(np.linalg.norm(np.ptp(vertices_B, axis=0)))
    if size == 0.0:
        return NO_FACES
    _, spread, axes = np.linalg.svd(vertices_B - center, full_matrices=False)
    rank = int(np.sum(spread > FLAT * size))
    if rank == 1:
        along = (vertices_B - center) @ axes[0]
        return _skeleton(vertices_B[[[int(along.argmin()), int(along.argmax())]]], size)
    if rank == 2:
        return _polygon(vertices_B, (vertices_B - center) @ axes[:2].T, size)
    return _polyhedron(vertices_B, center, size, smooth)


def _skeleton(edges_B: FloatArray, size: float) -> Shape:
    return Shape(triangles_B=np.zeros((0, 3, 3)), normals_B=np.zeros((0, 3)), edges_B=edges_B, size=size)


def _polygon(vertices_B: FloatArray, in_plane: FloatArray, size: float) -> Shape:
    from scipy.spatial import ConvexHull

    outline = vertices_B[ConvexHull(in_plane).vertices]
    fan = [np.array([outline[0], outline[i], outline[i + 1]]) for i in range(1, len(outline) - 1)]
    front = np.array(fan)
    triangles = np.concatenate([front, front[:, ::-1]])  # twice, so that they are seen from either side
    edges = np.stack([outline, np.roll(outline, -1, axis=0)], axis=1)
    return Shape(triangles_B=triangles, normals_B=_normals(triangles), edges_B=edges, size=size)


def _polyhedron(vertices_B: FloatArray, center: FloatArray, size: float, smooth: float) -> Shape:
    from scipy.spatial import ConvexHull

    hull = ConvexHull(vertices_B)
    triangles = vertices_B[hull.simplices]
    outward = np.einsum("ij,ij->i", _normals(triangles), triangles.mean(axis=1) - center) > 0.0
    triangles = np.where(outward[:, None, None], triangles, triangles[:, ::-1])
    normals = hull.equations[:, :3]
    edges = [
        np.delete(simplex, corner)
        for i, simplex in enumerate(hull.simplices)
        for corner, j in enumerate(hull.neighbors[i])
        if i < j and 1.0 - normals[i] @ normals[j] > smooth
    ]
    ends = vertices_B[np.array(edges, dtype=int).reshape(-1, 2)]
    return Shape(triangles_B=triangles, normals_B=normals, edges_B=ends, size=size)


NO_FACES: Final = _skeleton(np.zeros((0, 2, 3)), NO_SIZE)  # the shape of a point
_TURNS: Final = np.linspace(0.0, 2.0 * np.pi, ROUND_FACETS + 1)
_PLANES: Final = np.eye(3)[[[0, 1], [1, 2], [2, 0]]]  # two axes of each of three planes


def _radii(shape: ConvexShape) -> list[Radii]:
    return [radii_of(rim) for rim in shape.rims]


def _surface_points(shape: ConvexShape) -> FloatArray:
    """Return points all over the corners and rims, each a ball of the rounding's radius."""
    on_rims = [_circle(np.array(r.center), np.array([r.first, r.second]), 1.0)[:-1] for r in _radii(shape)]
    points = np.concatenate([shape.vertices, *on_rims])
    if shape.rounding == 0.0:
        return points
    around = _circle(np.zeros(3), _PLANES[0], 1.0)[:-1]
    # A rim's balls are seen in outline only. Single ones are round on all sides.
    tilts = np.linspace(0.0, np.pi, ROUND_FACETS // (4 if shape.rims else 2) + 1)
    ball = np.concatenate([around * np.sin(tilt) + [0.0, 0.0, np.cos(tilt)] for tilt in tilts])
    if len(points) > MAX_BALLS:
        ball = ball[:: len(points) // MAX_BALLS + 1]
    return (points[:, None] + shape.rounding * ball).reshape(-1, 3)


def _circle(center: FloatArray, axes: FloatArray, radius: float) -> FloatArray:
    """Return a closed circle, (ROUND_FACETS + 1, 3), m, in the plane of two axes, (2, 3)."""
    circle: FloatArray = center + radius * (np.column_stack([np.cos(_TURNS), np.sin(_TURNS)]) @ axes)
    return circle


def _normals(triangles: FloatArray) -> FloatArray:
    crosses = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals: FloatArray = crosses / np.linalg.norm(crosses, axis=1, keepdims=True)
    return normals


def part_above(corners: FloatArray, gaps: FloatArray) -> FloatArray:
    """Return the corners, (k, d), of the part of a convex polygon or line whose gaps, (n,), are not negative.

    The gaps are linear in the place.
    """
    kept = []
    for i, gap in enumerate(gaps.tolist()):
        before = float(gaps[i - 1])
        if (gap < 0.0) != (before < 0.0):
            kept.append(corners[i] + gap / (gap - before) * (corners[i - 1] - corners[i]))
        if gap >= 0.0:
            kept.append(corners[i])
    return np.reshape(kept, (-1, corners.shape[1]))


def outline(shape: Shape, p_WB_W: FloatArray, q_WB: FloatArray) -> FloatArray:
    """Return the edges, (k, 2, 3), m, world, of a body at a pose."""
    edges: FloatArray = p_WB_W + shape.edges_B @ rotation_matrix(q_WB).T
    return edges


def solid(
    shape: Shape, name: str, paint: Paint, p_WB_W: FloatArray, q_WB: FloatArray, **options: Any
) -> Faces:
    """Return the faces of a body at a pose as a mark, which ``options`` are further fields of."""
    R_WB = rotation_matrix(q_WB)
    corners_W = p_WB_W + shape.triangles_B.reshape(-1, 3) @ R_WB.T
    return Faces(
        name,
        paint,
        corners_W,
        triangles=np.arange(len(corners_W)).reshape(-1, 3),
        normals=np.repeat(shape.normals_B, 3, axis=0) @ R_WB.T,
        **options,
    )
