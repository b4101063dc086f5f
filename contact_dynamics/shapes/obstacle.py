# SPDX-License-Identifier: Apache-2.0
"""An obstacle is a convex piece of the world with edges and corners, such as a table, a box or a step."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.records import Record
from contact_dynamics.shapes.concavity import warn_if_concave
from contact_dynamics.shapes.convex import MAX_VERTICES
from contact_dynamics.shapes.hull_features import Features, hull_features
from contact_dynamics.validation import (
    FloatArray,
    check_array,
    check_magnitude,
    check_not_negative,
    check_static,
    check_within,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Obstacle(Record):
    """Convex hull of corners at rest: a solid, or a plate (a convex polygon) with two sides.

    Attributes:
        name: Name by which contacts refer to the obstacle.
        vertices_W: (k, 3), m, corners in the world.
        friction: Coefficient of Coulomb friction between this obstacle and any body, >= 0.
        restitution: Coefficient of restitution between this obstacle and any body, in [0, 1].
        static_friction: Coefficient of static friction, as in `Surface`, or None.
        features: Faces, edges and corners, which follow from the vertices.

    Raises:
        InvalidFieldError: a number is not finite, a corner is beyond `LARGEST_NUMBER`, all corners are on a
            line, the friction is negative, the static friction is below it, or the restitution is outside
            [0, 1].
        TooLargeError: there are more than `MAX_VERTICES` corners.
    """

    name: str
    vertices_W: FloatArray
    friction: float
    restitution: float
    static_friction: float | None = None
    features: Features = field(init=False)

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            name: str,
            vertices_W: ArrayLike,
            friction: float,
            restitution: float,
            static_friction: float | None = None,
        ) -> None:
            """Take whatever NumPy makes arrays of."""

    def __post_init__(self) -> None:
        """Check all fields and find faces and edges."""
        vertices = check_magnitude("vertices_W", check_array("vertices_W", self.vertices_W, (None, 3)))
        if len(vertices) > MAX_VERTICES:
            raise TooLargeError("vertices_W", f"{len(vertices)} vertices", f"at most {MAX_VERTICES}")
        object.__setattr__(self, "vertices_W", vertices)
        object.__setattr__(self, "friction", check_not_negative("friction", self.friction))
        object.__setattr__(self, "static_friction", check_static(self.static_friction, self.friction))
        object.__setattr__(self, "restitution", check_within("restitution", self.restitution, 0.0, 1.0))
        features = hull_features(vertices) if len(vertices) > 0 else None
        if features is None or len(features.normals) == 0:
            places = len({*map(tuple, vertices.tolist())})
            found = f"{places} different corner{'' if places == 1 else 's'}"
            raise InvalidFieldError("vertices_W", found, "three or more, not on a line")
        object.__setattr__(self, "features", features)
        warn_if_concave(f"obstacle {self.name!r}", vertices, divided_faces=False)


def closest_points(features: Features, points: FloatArray) -> FloatArray:
    """Return the points, (n, 3), of a hull's faces, or of a rod, that are nearest to points, (n, 3), m.

    The nearest point of each triangle is inside it or on a side (Ericson, Real-Time Collision Detection,
    2005, 5.1).
    """
    if len(features.triangles) == 0:
        return _on_sides(features.corners[:1], features.corners[-1:], points)[:, 0]
    a, b, c = features.triangles.transpose(1, 0, 2)  # (t, 3) each
    normals = np.cross(b - a, c - a)
    sizes = np.einsum("ij,ij->i", normals, normals)
    p = points[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):  # a sliver counts with its sides only
        u = np.einsum("nti,ti->nt", np.cross(b - p, c - p), normals) / sizes
        v = np.einsum("nti,ti->nt", np.cross(c - p, a - p), normals) / sizes
        inside = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0)
        above = u[..., None] * a + v[..., None] * b + (1.0 - u - v)[..., None] * c
    above[~inside] = np.inf
    candidates = [above, _on_sides(a, b, points), _on_sides(b, c, points), _on_sides(c, a, points)]
    found = np.concatenate(candidates, axis=1)
    distances = np.einsum("nci,nci->nc", found - p, found - p)
    nearest: FloatArray = found[np.arange(len(points)), distances.argmin(axis=1)]
    return nearest


def _on_sides(a: FloatArray, b: FloatArray, points: FloatArray) -> FloatArray:
    """Return the points, (n, s, 3), of sides from (s, 3) to (s, 3) that are nearest to points, (n, 3)."""
    along = b - a
    lengths = np.einsum("ij,ij->i", along, along)
    arms = np.einsum("nsi,si->ns", points[:, None] - a, along)
    shares = np.clip(np.divide(arms, lengths, out=np.zeros_like(arms), where=lengths > 0.0), 0.0, 1.0)
    nearest: FloatArray = a + shares[..., None] * along
    return nearest
