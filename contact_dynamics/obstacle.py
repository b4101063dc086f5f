"""A convex piece of the world with edges and corners: a table's top, a box, a step, the sides of a slot."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from contact_dynamics.convex_shape import MOST_VERTICES
from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.hull_features import Features, hull_features
from contact_dynamics.validation import FloatArray, check_array, check_not_negative, check_within


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Obstacle:
    """The hull of corners that stand still: a solid, or a plate (a convex polygon) with two sides.

    Raises:
        InvalidFieldError: a number is not finite, corners on a line, mu < 0, or e outside [0, 1].
        TooLargeError: more than `MOST_VERTICES` corners.
    """

    name: str
    vertices_W: FloatArray  # (k, 3), m, world
    friction: float  # Coulomb's mu, >= 0, between this obstacle and any body
    restitution: float  # e, in [0, 1], likewise
    features: Features = field(init=False)

    def __post_init__(self) -> None:
        """Check all fields and find faces and edges."""
        vertices = check_array("vertices", self.vertices_W, (None, 3))
        if len(vertices) > MOST_VERTICES:
            raise TooLargeError("vertices", f"{len(vertices)} vertices", f"at most {MOST_VERTICES}")
        object.__setattr__(self, "vertices_W", vertices)
        object.__setattr__(self, "friction", check_not_negative("friction", self.friction))
        object.__setattr__(self, "restitution", check_within("restitution", self.restitution, 0.0, 1.0))
        features = hull_features(vertices) if len(vertices) > 0 else None
        if features is None or len(features.normals) == 0:
            raise InvalidFieldError("vertices", f"{len(vertices)} corners", "three or more, not on a line")
        object.__setattr__(self, "features", features)


def closest_point(features: Features, p_W: FloatArray) -> FloatArray:
    """Return the point of a hull's faces, or of a rod, that is nearest to a point, (3,), m.

    As Ericson, Real-Time Collision Detection, 2005, 5.1.
    """
    if len(features.triangles) == 0:
        return _on_side(features.corners[0], features.corners[-1], p_W)
    best: FloatArray = features.corners[0]
    least = math.inf
    for a, b, c in features.triangles:
        point = _in_triangle(a, b, c, p_W)
        distance = float((point - p_W) @ (point - p_W))
        if distance < least:
            best, least = point, distance
    return best


def _in_triangle(a: FloatArray, b: FloatArray, c: FloatArray, p: FloatArray) -> FloatArray:
    ab, ac = b - a, c - a
    normal = np.cross(ab, ac)
    size = float(normal @ normal)
    if size > 0.0:
        u = float(np.cross(b - p, c - p) @ normal) / size  # of a
        v = float(np.cross(c - p, a - p) @ normal) / size  # of b
        if u >= 0.0 and v >= 0.0 and u + v <= 1.0:
            inside: FloatArray = u * a + v * b + (1.0 - u - v) * c
            return inside
    sides = [_on_side(a, b, p), _on_side(b, c, p), _on_side(c, a, p)]
    nearest: FloatArray = min(sides, key=lambda q: float((q - p) @ (q - p)))
    return nearest


def _on_side(a: FloatArray, b: FloatArray, p: FloatArray) -> FloatArray:
    along = b - a
    length = float(along @ along)
    share = min(max(float((p - a) @ along) / length, 0.0), 1.0) if length > 0.0 else 0.0
    point: FloatArray = a + share * along
    return point
