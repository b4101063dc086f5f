"""A convex body meets a convex obstacle with corners on faces, faces on corners, and edges across edges.

Two convex bodies are apart if and only if a face's normal of one of them, or a cross product of two edges,
separates them (Gottschalk, Lin and Manocha, OBBTree, SIGGRAPH 1996). The direction of the largest separation
is the normal. Among directions that are equally good, an obstacle's face comes first, then a body's, then
edges. The parts of both within the tolerance of the touching plane are polygons, edges or corners, and
contact is where the two overlap. The extreme points of the overlap carry every force that the overlap can.
They are corners of the body (point on flat), corners of the obstacle (flat on point) and crossings of edges
(edge on edge).

Where a ball rolls over a polyhedron (a sphere, a capsule, a rounded box), the directions between nearest
points of corners and hulls are added. A contact may then also be a corner's ball on an edge or on a corner.
Rims are covered where a face of the obstacle touches them, as on a flat, but within the face.

A sharp corner on an edge or on a corner has no normal of its own, and gets one of those above. Bodies that
penetrate get the direction of the least penetration.

Not covered: rims at an edge or a corner of the obstacle (`NotSupportedError`).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from contact_dynamics.contact.on_flats import flat_touches
from contact_dynamics.contact.overlap import Rounded, outline, overlap
from contact_dynamics.errors import NotSupportedError
from contact_dynamics.numerics.vectors import tangent_rows
from contact_dynamics.shapes.hull_features import features_of
from contact_dynamics.shapes.obstacle import closest_points
from contact_dynamics.tolerances import PARALLEL_EDGES, SAME_POINT

if TYPE_CHECKING:
    from contact_dynamics.contact.on_flats import Touch
    from contact_dynamics.shapes.convex import ConvexShape
    from contact_dynamics.shapes.hull_features import Features
    from contact_dynamics.shapes.obstacle import Obstacle
    from contact_dynamics.validation import FloatArray


class Site(NamedTuple):
    """Where a body is nearest to an obstacle, or deepest in it.

    Attributes:
        gap: Distance along the normal, m. It is negative where they penetrate.
        normal_W: (3,), unit, out of the obstacle, into the body.
        level: The obstacle's furthest extent along the normal, m: its points have n . p <= level.
    """

    gap: float
    normal_W: FloatArray
    level: float


def site_of(shape: ConvexShape, p_WB_W: FloatArray, R_WB: FloatArray, obstacle: Obstacle) -> Site:
    """Return where a body at a pose is nearest to an obstacle.

    For polyhedra that are apart, the gap is the largest one along the directions above. It is their distance
    where a corner faces a face or edges cross. It is less, never more, where only edges or corners are
    nearest.
    """
    theirs = obstacle.features
    axes = _axes(shape, p_WB_W, R_WB, theirs)
    best = Site(-math.inf, theirs.normals[0], 0.0)
    for group in axes:
        if len(group) == 0:
            continue
        levels = (group @ theirs.corners.T).max(axis=1)
        gaps = lowest_along(shape, p_WB_W, R_WB, group) - levels
        i = int(gaps.argmax())
        if gaps[i] > best.gap + SAME_POINT:
            best = Site(float(gaps[i]), group[i], float(levels[i]))
    return best


def _axes(
    shape: ConvexShape, p_WB_W: FloatArray, R_WB: FloatArray, theirs: Features
) -> tuple[FloatArray, ...]:
    """Return directions, (n, 3) each, one of which separates two polyhedra that are apart."""
    mine = features_of(shape)
    crosses = np.cross((mine.edges @ R_WB.T)[:, None], theirs.edges).reshape(-1, 3)
    sizes = np.linalg.norm(crosses, axis=1)
    crosses = crosses[sizes > PARALLEL_EDGES] / sizes[sizes > PARALLEL_EDGES, None]
    polyhedral = theirs.normals, -(mine.normals @ R_WB.T), np.concatenate([crosses, -crosses])
    if shape.rounding == 0.0:
        return polyhedral
    # Those between the nearest points of a corner and the other hull, which a ball that rolls over it needs.
    corners = p_WB_W + mine.corners @ R_WB.T
    inwards = (theirs.corners - p_WB_W) @ R_WB  # in body axes
    arms = (closest_points(mine, inwards) - inwards) @ R_WB.T
    away = np.concatenate([corners - closest_points(theirs, corners), arms])
    sizes = np.linalg.norm(away, axis=1)
    return (*polyhedral, away[sizes > SAME_POINT] / sizes[sizes > SAME_POINT, None])


def lowest_along(shape: ConvexShape, p_WB_W: FloatArray, R_WB: FloatArray, axes: FloatArray) -> FloatArray:
    """Return how far down, (n,), m, a body reaches along directions: minus its support function.

    Args:
        shape: A shape that is not empty.
        p_WB_W: (3,), m, place of the centre of mass, or (n, 3) for many poses and one direction.
        R_WB: (3, 3), rotation, body to world, or (n, 3, 3).
        axes: (n, 3), unit, the directions, or (3,) for many poses.
    """
    axes_B = axes @ R_WB
    parts = [axes_B @ shape.vertices.T]
    for rim in shape.rims:
        level = np.sqrt(np.maximum(1.0 - (axes_B @ rim.axis) ** 2, 0.0))
        parts.append((axes_B @ rim.center - rim.radius * level)[:, None])
    lowest: FloatArray = np.concatenate(parts, axis=1).min(axis=1) + p_WB_W @ axes.T - shape.rounding
    return lowest


def touches_of(
    shape: ConvexShape, p_WB_W: FloatArray, R_WB: FloatArray, obstacle: Obstacle, tolerance: float
) -> list[Touch]:
    """Return the contacts of a body at a pose with an obstacle, within a tolerance, m. There may be none.

    Raises:
        NotSupportedError: a rim is at an edge or a corner of the obstacle.
    """
    site = site_of(shape, p_WB_W, R_WB, obstacle)
    if site.gap > tolerance:
        return []
    theirs, n_W = obstacle.features, site.normal_W
    if shape.rims and float((theirs.normals @ n_W).max()) < 1.0 - SAME_POINT:
        message = (
            f"shape must touch with a rim at a face only, got a rim at an edge of obstacle {obstacle.name!r}"
        )
        raise NotSupportedError(message)
    frame = tangent_rows(n_W)
    touches = list(flat_touches(shape, p_WB_W, R_WB, n_W, level=site.level, tolerance=tolerance))
    upper = outline(np.array([touch.p_WC_W for touch in touches]).reshape(-1, 3), frame)
    lowest = float(lowest_along(shape, p_WB_W, R_WB, n_W[None])[0])
    lower = outline(theirs.corners[theirs.corners @ n_W >= lowest - tolerance], frame)
    rounded = Rounded(1.0 / shape.rounding, tolerance) if shape.rounding > 0.0 and not shape.rims else None
    return overlap([touches[i] for i in upper.order], upper, lower, frame, rounded)
