# SPDX-License-Identifier: Apache-2.0
"""A whole toss sees corners of a body that are very near to each other as one corner.

Meshes have such corners. A body that rolls over an edge of a micrometre moves less than the height of
rebounds that are not followed, so contacts at its two ends settle again and again. The first of the corners
stands for all, and the body is off by the distance at most.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.errors import NotSupportedError
from contact_dynamics.tolerances import SAME_CORNER, SAME_CORNER_SHARE

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body

_FEW: Final = 100
"""Corners of which all pairs are looked at."""


def with_distinct_corners(body: Body) -> tuple[Body, tuple[int, ...]]:
    """Return a body without the corners that others stand for, and the indices of those it keeps.

    Raises:
        NotSupportedError: the parts of the shape have different roundings.
    """
    if len(body.shape.hulls) > 1:
        found = [hull.rounding for hull in body.shape.hulls]
        message = f"body {body.name!r} must have parts of one rounding for a whole toss, got {found} m"
        raise NotSupportedError(message)
    vertices = body.shape.vertices
    dropped: set[int] = set()
    for first, second in _near_pairs(vertices):
        if first not in dropped:
            dropped.add(second)
    kept = tuple(i for i in range(len(vertices)) if i not in dropped)
    if not dropped:
        return body, kept
    shape = replace(body.shape, vertices=vertices[list(kept)], parts=())
    return replace(body, vertices_B=np.zeros((0, 3)), shape=shape), kept


def _near_pairs(points: FloatArray) -> list[tuple[int, int]]:
    """Return the pairs of points, (k, 3), that are near to each other, each with the lower index first."""
    reach = float(np.linalg.norm(points, axis=1).max(initial=0.0))
    near = min(SAME_CORNER, SAME_CORNER_SHARE * reach)
    if len(points) <= _FEW:
        apart = np.linalg.norm(points[:, None] - points, axis=2)
        return [(i, j) for i, j in np.argwhere(apart <= near).tolist() if i < j]
    from scipy.spatial import KDTree  # here, since it takes long to load

    return sorted(KDTree(points).query_pairs(near))
