"""The drawable shape of a convex body: flat faces and the edges between them, from its corners alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray

FLAT: Final = 1e-6
"""Relative to a body's size: thinner than this it is drawn as a polygon, a line or a point. Also 1 - cos of
the angle below which two triangles are one face: 0.08 degrees."""

NO_SIZE: Final = 0.05
"""m. Size that a body without shape is drawn with."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shape:
    """Faces and edges of a body, in body axes."""

    triangles_B: FloatArray  # (m, 3, 3), m, corners of each triangle, counterclockwise seen from outside
    normals_B: FloatArray  # (m, 3), unit, outward normal of each triangle
    edges_B: FloatArray  # (k, 2, 3), m, ends of each edge
    size: float  # m, > 0, distance between the two ends of the body's bounding box


def convex_shape(vertices_B: FloatArray) -> Shape:
    """Return the shape of the hull of corners, (k, 3), m, which may lie in a plane, on a line, or be none."""
    if len(vertices_B) == 0:
        return _skeleton(np.zeros((0, 2, 3)), NO_SIZE)
    center = vertices_B.mean(axis=0)
    size = float(np.linalg.norm(np.ptp(vertices_B, axis=0)))
    if size == 0.0:
        return _skeleton(np.zeros((0, 2, 3)), NO_SIZE)
    _, spread, axes = np.linalg.svd(vertices_B - center, full_matrices=False)
    rank = int(np.sum(spread > FLAT * size))
    if rank == 1:
        along = (vertices_B - center) @ axes[0]
        return _skeleton(vertices_B[[[int(along.argmin()), int(along.argmax())]]], size)
    if rank == 2:
        return _polygon(vertices_B, (vertices_B - center) @ axes[:2].T, size)
    return _polyhedron(vertices_B, center, size)


def _skeleton(edges_B: FloatArray, size: float) -> Shape:
    return Shape(triangles_B=np.zeros((0, 3, 3)), normals_B=np.zeros((0, 3)), edges_B=edges_B, size=size)


def _polygon(vertices_B: FloatArray, in_plane: FloatArray, size: float) -> Shape:
    from scipy.spatial import ConvexHull

    outline = vertices_B[ConvexHull(in_plane).vertices]
    fan = [np.array([outline[0], outline[i], outline[i + 1]]) for i in range(1, len(outline) - 1)]
    front = np.array(fan)
    triangles = np.concatenate([front, front[:, ::-1]])  # seen from either side
    edges = np.stack([outline, np.roll(outline, -1, axis=0)], axis=1)
    return Shape(triangles_B=triangles, normals_B=_normals(triangles), edges_B=edges, size=size)


def _polyhedron(vertices_B: FloatArray, center: FloatArray, size: float) -> Shape:
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
        if i < j and 1.0 - normals[i] @ normals[j] > FLAT
    ]
    return Shape(triangles_B=triangles, normals_B=normals, edges_B=vertices_B[np.array(edges)], size=size)


def _normals(triangles: FloatArray) -> FloatArray:
    crosses = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals: FloatArray = crosses / np.linalg.norm(crosses, axis=1, keepdims=True)
    return normals
