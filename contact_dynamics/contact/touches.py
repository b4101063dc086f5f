# SPDX-License-Identifier: Apache-2.0
"""Where a convex body touches a plane or an obstacle: the extreme points, with the curvatures there.

`found` says which points a face, a line and a rim have on a plane.

A convex body meets a convex obstacle with corners on faces, faces on corners, and edges across edges.

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

A body that is a union of convex parts touches with each of them. At a seam, where parts touch each other,
each part has sides that the union does not have. Parts within the tolerance of the obstacle therefore share a
direction if one separates them all, and only the extreme points of their contacts on one plane count.

Not covered: rims at an edge or a corner of the obstacle (`NotSupportedError`). Where a union penetrates an
obstacle at a seam by more than the tolerance, the direction may be that of the seam.

An outline of the parts in a touching plane is a convex polygon, a line or a point. Where a body's and an
obstacle's overlap, the extreme points are corners of either within the other, and crossings of their sides.
"""

from __future__ import annotations

import math
from itertools import zip_longest
from typing import TYPE_CHECKING, Final, NamedTuple, Protocol, TypeAlias

import numpy as np

from contact_dynamics.errors import NotSupportedError
from contact_dynamics.numerics.convex_hull import hull_of
from contact_dynamics.numerics.vectors import along_least, tangent_rows
from contact_dynamics.shapes.hull_features import Features, Radii, features_of, radii_of
from contact_dynamics.shapes.obstacle import closest_points
from contact_dynamics.tolerances import PARALLEL_EDGES, SAME_POINT

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from contact_dynamics.shapes.convex import ConvexShape
    from contact_dynamics.validation import FloatArray

Side: TypeAlias = "tuple[float, float, FloatArray]"
"""Curvatures, 1/m, along a tangent and across it, and the tangent, (3,), unit."""

RIM_POINTS: Final = 8
"""Number of contacts of a rim that lies flush."""


class Touch(NamedTuple):
    """One extreme point of where a body touches, with curvatures of both sides (`contact.curvature`)."""

    p_WC_W: FloatArray  # (3,), m, the point in the world
    normal_W: FloatArray  # (3,), unit, into the body
    body: Side  # Curvatures, 1/m, along a tangent and across it, and the tangent, (3,), unit
    surface: Side


def flat_touches(
    shape: ConvexShape,
    p_WB_W: FloatArray,
    R_WB: FloatArray,
    n_W: FloatArray,
    *,
    level: float,
    tolerance: float,
) -> Iterator[Touch]:
    """Yield where a body at a pose touches the plane n . p = ``level``, m, of a unit normal, (3,).

    Corners come first, then rims. A point touches if it is at most ``tolerance``, m, above the plane.
    """
    points = p_WB_W + shape.vertices @ R_WB.T
    tangent = along_least(n_W)
    corner = 1.0 / shape.rounding if shape.rounding > 0.0 else math.inf
    for i in np.flatnonzero(points @ n_W - level - shape.rounding <= tolerance):
        p_WC_W = points[i] - shape.rounding * n_W
        yield Touch(p_WC_W, n_W, (corner, corner, tangent), (0.0, 0.0, tangent))
    for rim in shape.rims:
        turned = _turned(radii_of(rim), p_WB_W, R_WB)
        yield from _of_rim(turned, n_W, level, rounding=shape.rounding, tolerance=tolerance)


class _RimW(NamedTuple):
    """A rim in the world."""

    center: FloatArray  # (3,), m
    first: FloatArray  # (3,), m, a radius
    second: FloatArray  # (3,), m, one across
    radius: float  # m


def _turned(radii: Radii, p_WB_W: FloatArray, R_WB: FloatArray) -> _RimW:
    first, second = R_WB @ radii.first, R_WB @ radii.second
    return _RimW(p_WB_W + R_WB @ radii.center, first, second, math.sqrt(first @ first))


def _of_rim(
    rim: _RimW, n_W: FloatArray, level: float, *, rounding: float, tolerance: float
) -> Iterator[Touch]:
    height = float(rim.center @ n_W) - level - rounding
    a_1, a_2 = float(n_W @ rim.first), float(n_W @ rim.second)
    size = math.hypot(a_1, a_2)  # m, R sin(theta)
    if height - size > tolerance:
        return
    flush = height + size <= tolerance
    corner = 1.0 / rounding if rounding > 0.0 else math.inf
    tangent = along_least(n_W)
    flat = (0.0, 0.0, tangent)
    if flush:
        turns = [2.0 * math.pi * i / RIM_POINTS for i in range(RIM_POINTS)]
        directions = [(math.cos(turn), math.sin(turn)) for turn in turns]
    else:
        directions = [(-a_1 / size, -a_2 / size)]
    for cosine, sine in directions:
        p_WC_W = rim.center + cosine * rim.first + sine * rim.second - rounding * n_W
        if flush:
            yield Touch(p_WC_W, n_W, (corner, corner, tangent), flat)
        else:
            around = (cosine * rim.second - sine * rim.first) / rim.radius  # level: along the rim
            radius = rim.radius * rim.radius / size + rounding
            yield Touch(p_WC_W, n_W, (1.0 / radius, corner, around), flat)


_ANY: Final = np.array([0.0, 0.0, 1.0])
_NONE: Final = np.zeros((0, 3))


class Hull(Protocol):
    """What a body may touch: an obstacle, or another body."""

    @property
    def name(self) -> str:
        """The name in messages."""

    @property
    def features(self) -> Features:
        """Its corners, edges and faces, in the axes in which the pose is given."""


Pair: TypeAlias = "tuple[ConvexShape, Hull, float]"
"""A convex part of a body, a hull that it may touch, and how far the surface is from this hull, m."""


class Site(NamedTuple):
    """Where a body is nearest to an obstacle, or deepest in it."""

    gap: float  # m, along the normal; it is negative where they penetrate
    normal_W: FloatArray  # (3,), unit, out of the obstacle, into the body
    level: float  # m, the obstacle's furthest extent along the normal: its points have n . p <= level


def gap_between(shape: ConvexShape, p_WB_W: FloatArray, R_WB: FloatArray, hull: Hull) -> float:
    """Return the gap between a body at a pose and a hull, m, that of its nearest or deepest part."""
    return min(site_of(part, p_WB_W, R_WB, hull).gap for part in shape.convex_parts)


def site_of(shape: ConvexShape, p_WB_W: FloatArray, R_WB: FloatArray, hull: Hull) -> Site:
    """Return where a convex body at a pose is nearest to a hull.

    For polyhedra that are apart, the gap is the largest one along the directions above. It is their distance
    where a corner faces a face or edges cross. It is less, never more, where only edges or corners are
    nearest.
    """
    theirs = hull.features
    axes = _axes(shape, p_WB_W, R_WB, theirs)
    best = Site(-math.inf, _ANY, 0.0)
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
    """Return how far down, (n,), m, a shape that is not empty reaches: minus its support function.

    It is at one pose along unit directions, (n, 3), or at n poses along one direction, (3,).
    """
    if len(shape.hulls) > 1:
        found: FloatArray = np.min([lowest_along(hull, p_WB_W, R_WB, axes) for hull in shape.hulls], axis=0)
        return found
    axes_B = axes @ R_WB
    parts = [axes_B @ shape.vertices.T]
    for rim in shape.rims:
        level = np.sqrt(np.maximum(1.0 - (axes_B @ rim.axis) ** 2, 0.0))
        parts.append((axes_B @ rim.center - rim.radius * level)[:, None])
    lowest: FloatArray = np.concatenate(parts, axis=1).min(axis=1) + p_WB_W @ axes.T - shape.rounding
    return lowest


def touches_of(
    shape: ConvexShape, p_WB_W: FloatArray, R_WB: FloatArray, hull: Hull, tolerance: float
) -> list[Touch]:
    """Return the contacts of a body at a pose with a hull, within a tolerance, m. There may be none.

    Raises:
        NotSupportedError: a rim is at an edge or a corner of the hull.
    """
    return touches_between([(part, hull, 0.0) for part in shape.convex_parts], p_WB_W, R_WB, tolerance)


def touches_between(
    pairs: Sequence[Pair], p_WB_W: FloatArray, R_WB: FloatArray, tolerance: float
) -> list[Touch]:
    """Return the contacts of the convex parts of a body with hulls, as `touches_of` does, for all pairs."""
    sites = [(pair, site_of(pair[0], p_WB_W, R_WB, pair[1])) for pair in pairs]
    near = [(pair, site) for pair, site in sites if site.gap <= tolerance]
    groups = [near] if len(near) < 2 else _with_shared_normals(near, p_WB_W, R_WB, tolerance)
    return [
        touch
        for group in groups
        for touch in _extreme(
            [touch for pair, site in group for touch in _touches_at(pair, site, p_WB_W, R_WB, tolerance)],
            parts=len(group),
        )
    ]


def _extreme(touches: list[Touch], *, parts: int) -> list[Touch]:
    """Return the extreme ones of contacts on one plane, which are all of those of a single part."""
    if parts < 2 or not touches:
        return touches
    points = np.array([touch.p_WC_W for touch in touches])
    new = [i for i, point in enumerate(points) if _is_new(point, [*points[:i]], 0.0)]
    return [touches[new[i]] for i in outline(points[new], tangent_rows(touches[0].normal_W)).order]


def _with_shared_normals(
    near: list[tuple[Pair, Site]], p_WB_W: FloatArray, R_WB: FloatArray, tolerance: float
) -> Iterator[list[tuple[Pair, Site]]]:
    """Yield pairs that touch, grouped by a plane that separates them, with their sites along its normal.

    The normal that separates the most pairs comes first.
    """
    groups = [_axes(shape, p_WB_W, R_WB, hull.features) for (shape, hull, _), _ in near]
    axes = np.concatenate([group for same in zip_longest(*groups, fillvalue=_NONE) for group in same])
    levels = [(axes @ hull.features.corners.T).max(axis=1) for (_, hull, _), _ in near]
    gaps = np.array([lowest_along(shape, p_WB_W, R_WB, axes) for (shape, _, _), _ in near]) - levels
    slack = max(tolerance, SAME_POINT)  # each pair is separated along its own normal, also with rounding
    separated = gaps >= [[min(site.gap, 0.0) - slack] for _, site in near]
    waiting = np.ones(len(near), dtype=bool)
    while waiting.any():
        counts = separated[waiting].sum(axis=0)
        least = np.where(separated[waiting], gaps[waiting], math.inf).min(axis=0)
        least[counts < counts.max()] = -math.inf
        best = int(np.argmax(least >= least.max() - SAME_POINT))
        chosen = np.flatnonzero(waiting & separated[:, best])
        waiting[chosen] = False
        heights = np.array([levels[i][best] for i in chosen])
        order = np.argsort(heights, kind="stable")
        for rows in np.split(order, np.flatnonzero(np.diff(heights[order]) > slack) + 1):
            yield [
                (near[i][0], Site(float(gaps[i, best]), axes[best], float(levels[i][best])))
                for i in chosen[rows].tolist()
            ]


def _touches_at(
    pair: Pair, site: Site, p_WB_W: FloatArray, R_WB: FloatArray, tolerance: float
) -> list[Touch]:
    """Return the contacts of a convex body with a hull where they are nearest."""
    (shape, hull, rounding), n_W = pair, site.normal_W
    theirs = hull.features
    if shape.rims and float((theirs.normals @ n_W).max()) < 1.0 - SAME_POINT:
        message = f"shape must touch with a rim at a face only, got a rim at an edge of {hull.name!r}"
        raise NotSupportedError(message)
    frame = tangent_rows(n_W)
    touches = list(flat_touches(shape, p_WB_W, R_WB, n_W, level=site.level, tolerance=tolerance))
    upper = outline(np.array([touch.p_WC_W for touch in touches]).reshape(-1, 3), frame)
    lowest = float(lowest_along(shape, p_WB_W, R_WB, n_W[None])[0])
    lower = outline(theirs.corners[theirs.corners @ n_W >= lowest - tolerance], frame)
    rounded = Rounded(1.0 / shape.rounding, tolerance) if shape.rounding > 0.0 and not shape.rims else None
    found = overlap([touches[i] for i in upper.order], upper, lower, frame, rounded)
    return [each._replace(p_WC_W=each.p_WC_W + rounding * n_W) for each in found] if rounding else found


class Outline(NamedTuple):
    """A convex polygon, a line or a point in the touching plane."""

    points: FloatArray  # (k, 3), m, world, in order
    flat: FloatArray  # (k, 2), m, in the plane, counterclockwise
    order: list[int]  # (k,), the indices of the points in the list that was given

    def side_at(self, place: FloatArray, frame: FloatArray, *, sharp: float, slack: float) -> Side | None:
        """Return the curvatures at a place, (2,), m, of a face, an edge or a corner, or None outside.

        ``sharp``, 1/m, is the curvature across an edge and of a corner in all directions.
        """
        if len(self.flat) == 1:
            return (sharp, sharp, frame[0]) if math.dist(place, self.flat[0]) <= slack else None
        if len(self.flat) == 2:
            along = self.flat[1] - self.flat[0]
            share = min(max(float((place - self.flat[0]) @ along) / float(along @ along), 0.0), 1.0)
            near = math.dist(place, self.flat[0] + share * along) <= slack
            return (0.0, sharp, _along(along, frame)) if near else None
        sides = np.roll(self.flat, -1, axis=0) - self.flat
        lengths = np.linalg.norm(sides, axis=1)
        arms = place - self.flat
        heights = (sides[:, 0] * arms[:, 1] - sides[:, 1] * arms[:, 0]) / lengths
        return (0.0, 0.0, frame[0]) if (heights >= -SAME_POINT).all() else None

    def sides(self) -> list[tuple[int, int]]:
        """Return the two points of each side."""
        count = len(self.flat)
        if count < 3:
            return [(0, 1)] if count == 2 else []
        return [(i, (i + 1) % count) for i in range(count)]


def outline(points: FloatArray, frame: FloatArray) -> Outline:
    """Return the outline of points, (k, 3), m, on a plane's tangents, (2, 3)."""
    flat = points @ frame.T
    if len(flat) < 3:
        return Outline(points, flat, list(range(len(flat))))
    spread = flat - flat.mean(axis=0)
    _, sizes, axes = np.linalg.svd(spread, full_matrices=False)
    if sizes[1] <= SAME_POINT:
        along = spread @ axes[0]
        ends = [int(along.argmin()), int(along.argmax())]
        return Outline(points[ends], flat[ends], ends)
    order = hull_of("vertices", flat).vertices.tolist()
    return Outline(points[order], flat[order], order)


class Rounded(NamedTuple):
    """The rounding of a body's outline, if it is that of a hull over which a ball rolls."""

    curvature: float  # Curvature of the ball, 1/m
    slack: float  # Distance within which its corners and lines are on edges and corners, m


def overlap(
    touches: list[Touch], upper: Outline, lower: Outline, frame: FloatArray, rounded: Rounded | None
) -> list[Touch]:
    """Return the extreme points of where a body's outline, ``upper``, and an obstacle's overlap.

    ``touches`` are the body's contacts with the plane of tangents ``frame``, in the order of its outline.
    ``rounded`` is the rounding, or None where corners and lines of the body are sharp or belong to rims.
    """
    if not touches:
        return []
    n_W = touches[0].normal_W
    slack = 0.0 if rounded is None else rounded.slack
    found: list[Touch] = []
    for place, touch in zip(upper.flat, touches, strict=True):
        surface = lower.side_at(place, frame, sharp=math.inf, slack=slack)
        if surface is not None and (rounded is not None or len(lower.flat) > 2):
            found.append(touch._replace(surface=surface))
    taken = [frame @ touch.p_WC_W for touch in found]
    point = (math.inf, math.inf, frame[0])
    for place, p_WC_W in zip(lower.flat, lower.points, strict=True):
        body = upper.side_at(place, frame, sharp=rounded.curvature if rounded else math.inf, slack=slack)
        enough = 2 if rounded is None else 1
        if body is not None and len(upper.flat) > enough and _is_new(place, taken, slack):
            found.append(Touch(p_WC_W, n_W, body, point))
            taken.append(place)
    for a, b in upper.sides():
        for c, d in lower.sides():
            share = _crossing(upper.flat[a], upper.flat[b], lower.flat[c], lower.flat[d])
            if share is None:
                continue
            place = upper.flat[a] + share * (upper.flat[b] - upper.flat[a])
            if _is_new(place, taken, slack):
                taken.append(place)
                mine = _along(upper.flat[b] - upper.flat[a], frame)
                theirs = _along(lower.flat[d] - lower.flat[c], frame)
                round_by = min(_curvature_across(touches[i], mine) for i in (a, b))
                p_WC_W = upper.points[a] + share * (upper.points[b] - upper.points[a])
                found.append(Touch(p_WC_W, n_W, (0.0, round_by, mine), (0.0, math.inf, theirs)))
    return found


def _curvature_across(touch: Touch, side_W: FloatArray) -> float:
    """Return the body's curvature, 1/m, at right angles to a side that ends there."""
    along, across, direction = touch.body
    return across if abs(float(direction @ side_W)) > math.sqrt(0.5) else along


def _crossing(a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> float | None:
    """Return where the side a to b, 0 to 1, crosses c to d, ends included, or None if it does not."""
    x, y = _two(b - a)
    u, v = _two(d - c)
    p, q = _two(c - a)
    apart = x * v - y * u
    one, two = math.hypot(x, y), math.hypot(u, v)
    if abs(apart) <= PARALLEL_EDGES * one * two:
        return None
    share, other = (p * v - q * u) / apart, (p * y - q * x) / apart
    if not (
        -SAME_POINT <= share * one <= one + SAME_POINT and -SAME_POINT <= other * two <= two + SAME_POINT
    ):
        return None
    return min(max(share, 0.0), 1.0)


def _two(vector: FloatArray) -> tuple[float, float]:
    return float(vector[0]), float(vector[1])


def _is_new(place: FloatArray, taken: list[FloatArray], slack: float) -> bool:
    return all(math.dist(place, other) > max(SAME_POINT, slack) for other in taken)


def _along(side: FloatArray, frame: FloatArray) -> FloatArray:
    direction: FloatArray = side @ frame
    return direction / math.sqrt(direction @ direction)
