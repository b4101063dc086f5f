"""Contacts of a convex body with a convex obstacle: corners on faces, faces on corners, edges across edges.

Two convex bodies are apart if and only if a face's normal of one of them, or a cross product of two edges,
separates them (Gottschalk, Lin and Manocha, OBBTree, SIGGRAPH 1996). The direction of the largest
separation is the normal; of directions that are as good, an obstacle's face comes first, then a body's, then
edges. What lies within the tolerance of the touching plane is a polygon, an edge or a corner of each, and
contact is where the two overlap: its extreme points, which carry every force that the overlap can, are
corners of the body (point on flat), corners of the obstacle (flat on point) and crossings of edges (edge on
edge).

A ball touches in the point of the obstacle that is nearest to its centre: in a face, an edge or a corner.

A corner on an edge, or on a corner, has no normal of its own: it gets one of those above. Bodies that
penetrate get the direction of the least penetration.

Not covered: rims, and rounded bodies other than a ball (`NotSupportedError`).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

import numpy as np

from contact_dynamics.errors import NotSupportedError
from contact_dynamics.hull_features import features_of
from contact_dynamics.obstacle import closest_point

if TYPE_CHECKING:
    from contact_dynamics.convex_shape import ConvexShape
    from contact_dynamics.obstacle import Obstacle
    from contact_dynamics.validation import FloatArray

    Side: TypeAlias = tuple[float, float, FloatArray]

_AS_GOOD: Final = 1e-9
"""m. Directions whose separation is less by no more are as good, and points this close are one: rounding."""

_PARALLEL: Final = 1e-6
"""Sine of the angle within which edges do not cross; their ends are what touches."""


class Site(NamedTuple):
    """Where a body is nearest to an obstacle, or deepest in it."""

    gap: float  # m, along the normal; negative: penetration
    normal_W: FloatArray  # (3,), unit, out of the obstacle, into the body
    level: float  # m, the obstacle's furthest extent along the normal: its points have n . p <= level


class Touch(NamedTuple):
    """One extreme point of where a body touches, with curvatures of both sides (`contact_curvature`)."""

    p_WC_W: FloatArray  # (3,), m
    normal_W: FloatArray  # (3,), unit, into the body
    body: Side  # 1/m along a tangent and across it, and the tangent, (3,), unit
    surface: Side


def check_covered(shape: ConvexShape) -> None:
    """Raise `NotSupportedError` for a shape whose contacts with obstacles are not covered."""
    if shape.rims or (shape.rounding > 0.0 and len(shape.vertices) > 1):
        what = "a rim" if shape.rims else "rounded corners"
        message = f"shape: found {what} beside an obstacle, allowed there are polyhedra and balls"
        raise NotSupportedError(message)


def site_of(shape: ConvexShape, p_WB_W: FloatArray, R_WB: FloatArray, obstacle: Obstacle) -> Site:
    """Return where a body, of a pose, is nearest to an obstacle.

    For polyhedra that are apart the gap is the largest one along the directions above: their distance where
    a corner faces a face or edges cross, less (never more) where only edges or corners are nearest.
    """
    check_covered(shape)
    mine, theirs = features_of(shape), obstacle.features
    corners = p_WB_W + mine.corners @ R_WB.T
    if shape.rounding > 0.0:
        nearest = closest_point(theirs, corners[0])
        away = corners[0] - nearest
        distance = math.sqrt(away @ away)
        if distance > _AS_GOOD and _is_outside(theirs.normals, theirs.corners, corners[0]):
            normal = away / distance
            return Site(distance - shape.rounding, normal, float(normal @ nearest))
    crosses = np.cross((mine.edges @ R_WB.T)[:, None], theirs.edges).reshape(-1, 3)
    sizes = np.linalg.norm(crosses, axis=1)
    crosses = crosses[sizes > _PARALLEL] / sizes[sizes > _PARALLEL, None]
    groups = (theirs.normals, -(mine.normals @ R_WB.T), np.concatenate([crosses, -crosses]))
    best = Site(-math.inf, theirs.normals[0], 0.0)
    for axes in groups:
        if len(axes) == 0:
            continue
        levels = (axes @ theirs.corners.T).max(axis=1)
        gaps = (axes @ corners.T).min(axis=1) - levels
        i = int(gaps.argmax())
        if gaps[i] > best.gap + _AS_GOOD:
            best = Site(float(gaps[i]), axes[i], float(levels[i]))
    return best._replace(gap=best.gap - shape.rounding)


def touches_of(
    shape: ConvexShape, p_WB_W: FloatArray, R_WB: FloatArray, obstacle: Obstacle, tolerance: float
) -> list[Touch]:
    """Return the contacts of a body of a pose with an obstacle within a tolerance, m; none where it is apart.

    Raises:
        NotSupportedError: the body has rims or rounded corners.
    """
    site = site_of(shape, p_WB_W, R_WB, obstacle)
    if site.gap > tolerance:
        return []
    mine, theirs, n_W = features_of(shape), obstacle.features, site.normal_W
    corners = p_WB_W + mine.corners @ R_WB.T
    frame = _tangents(n_W)
    if shape.rounding > 0.0:
        return [_of_ball(corners[0], shape.rounding, site, frame, theirs.corners)]
    lowest = float((corners @ n_W).min())
    upper = _outline(corners[corners @ n_W <= site.level + tolerance], frame)
    lower = _outline(theirs.corners[theirs.corners @ n_W >= lowest - tolerance], frame)
    return _overlap(upper, lower, n_W, frame)


def _of_ball(center: FloatArray, radius: float, site: Site, frame: FloatArray, corners: FloatArray) -> Touch:
    n_W = site.normal_W
    near = corners[corners @ n_W >= site.level - _AS_GOOD]
    if len(near) >= 3:
        surface: Side = (0.0, 0.0, frame[0])
    elif len(near) == 2:
        along = near[1] - near[0]
        surface = (0.0, math.inf, along / math.sqrt(along @ along))
    else:
        surface = (math.inf, math.inf, frame[0])
    return Touch(center - radius * n_W, n_W, (1.0 / radius, 1.0 / radius, frame[0]), surface)


class _Outline(NamedTuple):
    """A convex polygon, a line or a point in the touching plane."""

    points: FloatArray  # (k, 3), m, world, in order
    flat: FloatArray  # (k, 2), m, in the plane, counterclockwise

    def holds(self, points: FloatArray) -> np.ndarray:
        """Return which points (n, 2) are in the polygon, edges included; none where it is a line."""
        if len(self.flat) < 3:
            return np.zeros(len(points), dtype=bool)
        sides = np.roll(self.flat, -1, axis=0) - self.flat
        lengths = np.linalg.norm(sides, axis=1)
        arms = points[:, None] - self.flat
        heights = (sides[:, 0] * arms[:, :, 1] - sides[:, 1] * arms[:, :, 0]) / lengths
        inside: np.ndarray = (heights >= -_AS_GOOD).all(axis=1)
        return inside

    def sides(self) -> list[tuple[int, int]]:
        count = len(self.flat)
        if count < 3:
            return [(0, 1)] if count == 2 else []
        return [(i, (i + 1) % count) for i in range(count)]


def _outline(points: FloatArray, frame: FloatArray) -> _Outline:
    flat = points @ frame.T
    if len(flat) < 3:
        return _Outline(points, flat)
    spread = flat - flat.mean(axis=0)
    _, sizes, axes = np.linalg.svd(spread, full_matrices=False)
    if sizes[1] <= _AS_GOOD:
        along = spread @ axes[0]
        ends = [int(along.argmin()), int(along.argmax())]
        return _Outline(points[ends], flat[ends])
    from scipy.spatial import ConvexHull

    order = ConvexHull(flat).vertices
    return _Outline(points[order], flat[order])


def _overlap(upper: _Outline, lower: _Outline, n_W: FloatArray, frame: FloatArray) -> list[Touch]:
    """Return the extreme points of where a body's outline and an obstacle's overlap."""
    flat, point = (0.0, 0.0, frame[0]), (math.inf, math.inf, frame[0])
    found: list[Touch] = []
    taken: list[FloatArray] = []
    for i in np.flatnonzero(lower.holds(upper.flat)):
        found.append(Touch(upper.points[i], n_W, point, flat))
        taken.append(upper.flat[i])
    for i in np.flatnonzero(upper.holds(lower.flat)):
        if _is_new(lower.flat[i], taken):
            found.append(Touch(lower.points[i], n_W, flat, point))
            taken.append(lower.flat[i])
    for a, b in upper.sides():
        for c, d in lower.sides():
            share = _crossing(upper.flat[a], upper.flat[b], lower.flat[c], lower.flat[d])
            if share is None:
                continue
            place = upper.flat[a] + share * (upper.flat[b] - upper.flat[a])
            if _is_new(place, taken):
                taken.append(place)
                mine = _along(upper.flat[b] - upper.flat[a], frame)
                theirs = _along(lower.flat[d] - lower.flat[c], frame)
                p_WC_W = upper.points[a] + share * (upper.points[b] - upper.points[a])
                found.append(Touch(p_WC_W, n_W, (0.0, math.inf, mine), (0.0, math.inf, theirs)))
    return found


def _crossing(a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> float | None:
    """Return where on a side a to b, 0 to 1, it crosses c to d, ends included; None where it does not."""
    x, y = _two(b - a)
    u, v = _two(d - c)
    p, q = _two(c - a)
    apart = x * v - y * u
    one, two = math.hypot(x, y), math.hypot(u, v)
    if abs(apart) <= _PARALLEL * one * two:
        return None
    share, other = (p * v - q * u) / apart, (p * y - q * x) / apart
    if not (-_AS_GOOD <= share * one <= one + _AS_GOOD and -_AS_GOOD <= other * two <= two + _AS_GOOD):
        return None
    return min(max(share, 0.0), 1.0)


def _two(vector: FloatArray) -> tuple[float, float]:
    return float(vector[0]), float(vector[1])


def _is_new(place: FloatArray, taken: list[FloatArray]) -> bool:
    return all(math.dist(place, other) > _AS_GOOD for other in taken)


def _along(side: FloatArray, frame: FloatArray) -> FloatArray:
    direction: FloatArray = side @ frame
    return direction / math.sqrt(direction @ direction)


def _is_outside(normals: FloatArray, corners: FloatArray, p_W: FloatArray) -> bool:
    return bool((normals @ p_W > (normals @ corners.T).max(axis=1)).any())


def _tangents(n_W: FloatArray) -> FloatArray:
    first = np.cross(n_W, np.eye(3)[int(np.abs(n_W).argmin())])
    first = first / math.sqrt(first @ first)
    return np.array([first, np.cross(n_W, first)])
