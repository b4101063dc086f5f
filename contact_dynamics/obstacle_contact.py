"""Contacts of a convex body with a convex obstacle: corners on faces, faces on corners, edges across edges.

Two convex bodies are apart if and only if a face's normal of one of them, or a cross product of two edges,
separates them (Gottschalk, Lin and Manocha, OBBTree, SIGGRAPH 1996). The direction of the largest
separation is the normal; of directions that are as good, an obstacle's face comes first, then a body's, then
edges. What lies within the tolerance of the touching plane is a polygon, an edge or a corner of each, and
contact is where the two overlap: its extreme points, which carry every force that the overlap can, are
corners of the body (point on flat), corners of the obstacle (flat on point) and crossings of edges (edge on
edge).

A ball touches in the point of the obstacle that is nearest to its centre: in a face, an edge or a corner.
Other round bodies are covered where a face of the obstacle touches them: as on a flat, but within the face.

A corner on an edge, or on a corner, has no normal of its own: it gets one of those above. Bodies that
penetrate get the direction of the least penetration.

Not covered: rims and rounded corners at an edge or a corner of the obstacle (`NotSupportedError`).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.errors import NotSupportedError
from contact_dynamics.flat_contact import Touch, any_tangent, flat_touches
from contact_dynamics.hull_features import features_of
from contact_dynamics.obstacle import closest_point

if TYPE_CHECKING:
    from contact_dynamics.convex_shape import ConvexShape
    from contact_dynamics.flat_contact import Side
    from contact_dynamics.hull_features import Features
    from contact_dynamics.obstacle import Obstacle
    from contact_dynamics.validation import FloatArray

_AS_GOOD: Final = 1e-9
"""m. Directions whose separation is less by no more are as good, and points this close are one: rounding."""

_PARALLEL: Final = 1e-6
"""Sine of the angle within which edges do not cross; their ends are what touches."""


class Site(NamedTuple):
    """Where a body is nearest to an obstacle, or deepest in it."""

    gap: float  # m, along the normal; negative: penetration
    normal_W: FloatArray  # (3,), unit, out of the obstacle, into the body
    level: float  # m, the obstacle's furthest extent along the normal: its points have n . p <= level


def site_of(shape: ConvexShape, p_WB_W: FloatArray, R_WB: FloatArray, obstacle: Obstacle) -> Site:
    """Return where a body, of a pose, is nearest to an obstacle.

    For polyhedra that are apart the gap is the largest one along the directions above: their distance where
    a corner faces a face or edges cross, less (never more) where only edges or corners are nearest.
    """
    theirs = obstacle.features
    axes = _axes(shape, p_WB_W, R_WB, theirs)
    best = Site(-math.inf, theirs.normals[0], 0.0)
    for group in axes:
        if len(group) == 0:
            continue
        levels = (group @ theirs.corners.T).max(axis=1)
        gaps = _lowest(shape, p_WB_W, R_WB, group) - levels
        i = int(gaps.argmax())
        if gaps[i] > best.gap + _AS_GOOD:
            best = Site(float(gaps[i]), group[i], float(levels[i]))
    return best


def _axes(
    shape: ConvexShape, p_WB_W: FloatArray, R_WB: FloatArray, theirs: Features
) -> tuple[FloatArray, ...]:
    """Return directions, (n, 3) each, of which one separates what is apart; round sides have many more."""
    mine = features_of(shape)
    crosses = np.cross((mine.edges @ R_WB.T)[:, None], theirs.edges).reshape(-1, 3)
    sizes = np.linalg.norm(crosses, axis=1)
    crosses = crosses[sizes > _PARALLEL] / sizes[sizes > _PARALLEL, None]
    polyhedral = theirs.normals, -(mine.normals @ R_WB.T), np.concatenate([crosses, -crosses])
    if shape.rounding == 0.0:
        return polyhedral
    away = []
    for center in p_WB_W + shape.vertices @ R_WB.T:
        arm = center - closest_point(theirs, center)
        distance = math.sqrt(arm @ arm)
        if distance > _AS_GOOD and _is_outside(theirs.normals, theirs.corners, center):
            away.append(arm / distance)
    return (*polyhedral, np.array(away).reshape(-1, 3))


def _lowest(shape: ConvexShape, p_WB_W: FloatArray, R_WB: FloatArray, axes: FloatArray) -> FloatArray:
    """Return how far down, (n,), m, a body reaches along directions, (n, 3): minus its support function."""
    parts = [(p_WB_W + shape.vertices @ R_WB.T) @ axes.T]
    for rim in shape.rims:
        along = axes @ (R_WB @ rim.axis)
        level = np.sqrt(np.maximum(1.0 - along * along, 0.0))
        parts.append((axes @ (p_WB_W + R_WB @ rim.center) - rim.radius * level)[None])
    lowest: FloatArray = np.concatenate(parts).min(axis=0) - shape.rounding
    return lowest


def touches_of(
    shape: ConvexShape, p_WB_W: FloatArray, R_WB: FloatArray, obstacle: Obstacle, tolerance: float
) -> list[Touch]:
    """Return the contacts of a body of a pose with an obstacle within a tolerance, m; none where it is apart.

    Raises:
        NotSupportedError: a rim or a rounded corner is at an edge or a corner of the obstacle.
    """
    site = site_of(shape, p_WB_W, R_WB, obstacle)
    if site.gap > tolerance:
        return []
    theirs, n_W = obstacle.features, site.normal_W
    if shape.rounding > 0.0 and len(shape.vertices) == 1 and not shape.rims:
        return [_of_ball(p_WB_W + R_WB @ shape.vertices[0], shape.rounding, site, theirs.corners)]
    frame = _tangents(n_W)
    lowest = float(_lowest(shape, p_WB_W, R_WB, n_W[None])[0])
    lower = _outline(theirs.corners[theirs.corners @ n_W >= lowest - tolerance], frame)
    if not shape.is_polyhedron and float((theirs.normals @ n_W).max()) < 1.0 - _AS_GOOD:
        message = (
            f"shape: found a round side at an edge of obstacle {obstacle.name!r}, allowed is one at a face"
        )
        raise NotSupportedError(message)
    touches = list(flat_touches(shape, p_WB_W, R_WB, n_W, level=site.level, tolerance=tolerance))
    return _overlap(touches, lower, frame)


def _of_ball(center: FloatArray, radius: float, site: Site, corners: FloatArray) -> Touch:
    n_W = site.normal_W
    tangent = any_tangent(n_W)
    near = corners[corners @ n_W >= site.level - _AS_GOOD]
    if len(near) >= 3:
        surface: Side = (0.0, 0.0, tangent)
    elif len(near) == 2:
        along = near[1] - near[0]
        surface = (0.0, math.inf, along / math.sqrt(along @ along))
    else:
        surface = (math.inf, math.inf, tangent)
    return Touch(center - radius * n_W, n_W, (1.0 / radius, 1.0 / radius, tangent), surface)


class _Outline(NamedTuple):
    """A convex polygon, a line or a point in the touching plane."""

    points: FloatArray  # (k, 3), m, world, in order
    flat: FloatArray  # (k, 2), m, in the plane, counterclockwise
    order: list[int]  # (k,), which of the points that were given

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
        return _Outline(points, flat, list(range(len(flat))))
    spread = flat - flat.mean(axis=0)
    _, sizes, axes = np.linalg.svd(spread, full_matrices=False)
    if sizes[1] <= _AS_GOOD:
        along = spread @ axes[0]
        ends = [int(along.argmin()), int(along.argmax())]
        return _Outline(points[ends], flat[ends], ends)
    from scipy.spatial import ConvexHull

    order = ConvexHull(flat).vertices.tolist()
    return _Outline(points[order], flat[order], order)


def _overlap(touches: list[Touch], lower: _Outline, frame: FloatArray) -> list[Touch]:
    """Return the extreme points of where a body, as it touches a plane, and an obstacle's outline overlap."""
    if not touches:
        return []
    n_W = touches[0].normal_W
    upper = _outline(np.array([touch.p_WC_W for touch in touches]), frame)
    flat, point = (0.0, 0.0, frame[0]), (math.inf, math.inf, frame[0])
    found = [touches[upper.order[i]] for i in np.flatnonzero(lower.holds(upper.flat))]
    taken = [frame @ touch.p_WC_W for touch in found]
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
                round_by = min(_curvature_across(touches[upper.order[i]], mine) for i in (a, b))
                p_WC_W = upper.points[a] + share * (upper.points[b] - upper.points[a])
                found.append(Touch(p_WC_W, n_W, (0.0, round_by, mine), (0.0, math.inf, theirs)))
    return found


def _curvature_across(touch: Touch, side_W: FloatArray) -> float:
    """Return the body's curvature, 1/m, at right angles to a side that ends there."""
    along, across, direction = touch.body
    return across if abs(float(direction @ side_W)) > math.sqrt(0.5) else along


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
