# SPDX-License-Identifier: Apache-2.0
"""Computes convex hulls with Qhull. If Qhull fails because of rounding, the points are rotated first.

Qhull merges nearly coplanar facets. For symmetric points, or points nearly in a plane, rounding can lead to
merges that it rejects, in one rotation of a thousand or in four of five. Other rotations succeed.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from contact_dynamics.errors import UndecidedError
from contact_dynamics.tolerances import FLAT_HULL
from contact_dynamics.validation import FloatArray

_TRIALS: Final = 40


class Hull(NamedTuple):
    """The convex hull of points in a space of d dimensions. Indices are those of the points.

    Attributes:
        vertices: (k,), the extreme points, in the plane counterclockwise.
        simplices: (s, d), the simplices of the surface, in any orientation.
        neighbors: (s, d), the neighbour of each simplex across from each of its points.
        equations: (s, d + 1), outward unit normals, then offsets: normal . x + offset <= 0 within.
    """

    vertices: NDArray[np.int64]
    simplices: NDArray[np.int64]
    neighbors: NDArray[np.int64]
    equations: FloatArray


def hull_of(field: str, points: FloatArray) -> Hull:
    """Return the convex hull of points, (n, d), d >= 2, that do not lie in a plane.

    Args:
        field: The caller's name of the points, for errors.
        points: Any unit.

    Raises:
        UndecidedError: the points lie in a plane to rounding, or Qhull gives up in all rotations.
    """
    from scipy.spatial import ConvexHull, QhullError

    middle = np.zeros(points.shape[1])  # most hulls succeed without a rotation
    rotation = np.eye(points.shape[1])
    chance = np.random.default_rng(0)
    for _ in range(_TRIALS):
        try:
            hull = ConvexHull((points - middle) @ rotation)
        except (QhullError, ValueError):  # the latter: numbers so large that their differences are infinite
            middle = points.mean(axis=0)
            rotation = np.linalg.qr(chance.normal(size=rotation.shape))[0]
            if np.linalg.det(rotation) < 0.0:
                rotation[:, 0] *= -1.0  # keeps the order counterclockwise
            continue
        outward = hull.equations[:, :-1] @ rotation.T
        return Hull(
            vertices=hull.vertices.astype(np.int64),
            simplices=hull.simplices.astype(np.int64),
            neighbors=hull.neighbors.astype(np.int64),
            equations=np.column_stack([outward, hull.equations[:, -1] - outward @ middle]),
        )
    raise UndecidedError(
        f"{field} must be points and directions that are either the same or clearly apart, got a convex hull "
        f"that hangs on rounding (Qhull gave up in {_TRIALS} rotations)"
    )


def extreme_points(points: FloatArray) -> FloatArray:
    """Return the corners, (c, 3), of the hull of points, (k, 3), which may be flat, in their order.

    Points inside the hull, its faces and its edges are left out, also where rounding lifts them a little.
    """
    offsets = points - points.mean(axis=0)
    _, spread, axes = np.linalg.svd(offsets, full_matrices=False)
    axes = axes[spread > FLAT_HULL * np.linalg.norm(np.ptp(points, axis=0))]
    if len(axes) == 0:
        return points[:1]
    local = offsets @ axes.T
    if len(axes) == 1:
        return points[sorted({int(local.argmin()), int(local.argmax())})]
    hull = hull_of("vertices", local)
    corners = hull.simplices.ravel()
    order = np.argsort(corners)
    normals = hull.equations[order // len(axes), :-1]
    used, starts, counts = np.unique(corners[order], return_index=True, return_counts=True)
    sharp = np.zeros(len(used), dtype=bool)
    for count in np.unique(counts):
        rows = np.flatnonzero(counts == count)
        around = normals[starts[rows, None] + np.arange(count)]  # (corners, facets at each, axes)
        sharp[rows] = np.linalg.svd(around, compute_uv=False)[:, -1] > FLAT_HULL
    return points[used[sharp]]
