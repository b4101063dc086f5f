"""This file outlines the parts that lie in a touching plane, and finds the extreme points where two overlap.

An outline is a convex polygon, a line or a point. Where a body's and an obstacle's overlap, the extreme
points are corners of either within the other, and crossings of their sides.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from contact_dynamics.contact.on_flats import Touch
from contact_dynamics.numerics.convex_hull import hull_of
from contact_dynamics.tolerances import PARALLEL_EDGES, SAME_POINT

if TYPE_CHECKING:
    from contact_dynamics.contact.on_flats import Side
    from contact_dynamics.validation import FloatArray


class Outline(NamedTuple):
    """A convex polygon, a line or a point in the touching plane.

    Attributes:
        points: (k, 3), m, world, in order.
        flat: (k, 2), m, in the plane, counterclockwise.
        order: (k,), the indices of the points in the list that was given.
    """

    points: FloatArray
    flat: FloatArray
    order: list[int]

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
    """The rounding of a body's outline, if it is that of a hull over which a ball rolls.

    Attributes:
        curvature: Curvature of the ball, 1/m.
        slack: Distance within which its corners and lines are on edges and corners, m.
    """

    curvature: float
    slack: float


def overlap(
    touches: list[Touch], upper: Outline, lower: Outline, frame: FloatArray, rounded: Rounded | None
) -> list[Touch]:
    """Return the extreme points of where a body's outline and an obstacle's overlap.

    Args:
        touches: the body's contacts with the plane, in the order of its outline's points.
        upper: the body's outline.
        lower: the obstacle's outline.
        frame: (2, 3), unit, the plane's tangents.
        rounded: the rounding, or None where corners and lines of the body are sharp or belong to rims.
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
