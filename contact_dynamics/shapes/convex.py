# SPDX-License-Identifier: Apache-2.0
"""A convex shape of a body is the hull of corners and circles, rolled over by a ball.

A sphere is one point and a ball, a capsule is two points and a ball, a box is the hull of its corners, and a
cylinder that of its two rims. Rounding makes every shape larger: the faces of `rounded(box(...), radius=r)`
are r outside the box's. All shapes are centred on the body frame's origin, and round ones are about z. Their
method `moved` puts them elsewhere.

`contact_dynamics.rigid_body.inertia` has their mass properties, with the same names and places.

A shape that is not convex is a `union` of convex parts. A plane touches only the hull of the parts.

Not covered: ellipsoids, meshes (give their corners to `polyhedron`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.numerics.convex_hull import extreme_points
from contact_dynamics.records import Record
from contact_dynamics.rotations.one import rotation_matrix
from contact_dynamics.tolerances import LARGEST_NUMBER
from contact_dynamics.validation import (
    FloatArray,
    check_array,
    check_magnitude,
    check_positive,
    check_sides,
    check_unit,
    check_vector3,
    check_within,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

MAX_VERTICES: Final = 10_000
"""Longest list of vertices accepted. A convex shape with more should be simplified first."""

MAX_RIMS: Final = 1_000
"""Longest list of rims accepted. The convex shapes of this file have at most two."""

MAX_PARTS: Final = 100
"""Largest number of convex parts of a shape. Convex decompositions of meshes usually have at most 64."""


class Rim(NamedTuple):
    """A circle.

    Attributes:
        center: Position of the centre, m.
        axis: Unit normal of its plane, in either direction.
        radius: m, > 0.
    """

    center: tuple[float, float, float]
    axis: tuple[float, float, float]
    radius: float


def _distinct(vertices: FloatArray) -> FloatArray:
    """Return the vertices without repetitions: two at one place would strike together, always."""
    rows = dict.fromkeys(map(tuple, vertices.tolist()))
    return vertices if len(rows) == len(vertices) else check_array("vertices", [*rows], (None, 3))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ConvexShape(Record):
    """Convex hull of points and circles, rounded by a ball that rolls over it, or a `union` of such parts.

    Without points and circles it is empty.

    Attributes:
        vertices: (k, 3), m, corners in body axes. Repeated corners, as in the triangles of a mesh, are stored
            once, at their first position.
        rims: Circles in body axes.
        rounding: Radius of the ball, m, >= 0.
        parts: Convex parts whose union the shape is. The other attributes are then those of their hull, or
            empty if the parts have different roundings, which no common hull has (`hulls`). A convex shape
            has no parts.

    Raises:
        InvalidFieldError: a number is not finite or beyond `LARGEST_NUMBER`, a radius is negative, an axis is
            not a unit vector, or vertices, rims or a rounding are given beside parts.
        TooLargeError: there are more than `MAX_VERTICES` vertices, `MAX_RIMS` rims or `MAX_PARTS` parts.
    """

    vertices: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))
    rims: tuple[Rim, ...] = ()
    rounding: float = 0.0
    parts: tuple[ConvexShape, ...] = ()

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            vertices: ArrayLike = ...,
            rims: tuple[Rim, ...] = ...,
            rounding: float = ...,
            parts: tuple[ConvexShape, ...] = ...,
        ) -> None:
            """Take whatever NumPy makes arrays of."""

    def __post_init__(self) -> None:
        """Check all fields, and find the hull of parts."""
        if self.parts:
            self._take_hull()
        vertices = check_magnitude("vertices", check_array("vertices", self.vertices, (None, 3)))
        if len(vertices) > MAX_VERTICES:
            raise TooLargeError("vertices", f"{len(vertices)} vertices", f"at most {MAX_VERTICES}")
        if len(self.rims) > MAX_RIMS:
            raise TooLargeError("rims", f"{len(self.rims)} rims", f"at most {MAX_RIMS}")
        object.__setattr__(self, "vertices", _distinct(vertices))
        object.__setattr__(self, "rims", tuple(_checked(*rim) for rim in self.rims))
        object.__setattr__(self, "rounding", check_within("rounding", self.rounding, 0.0, LARGEST_NUMBER))

    def _take_hull(self) -> None:
        if np.size(self.vertices) or self.rims or self.rounding:
            raise InvalidFieldError("parts", "parts beside vertices, rims or a rounding", "parts alone")
        if len(self.parts) > MAX_PARTS:
            raise TooLargeError("parts", f"{len(self.parts)} parts", f"at most {MAX_PARTS}")
        roundings = {part.rounding for part in self.parts}
        if len(roundings) > 1:
            return
        rims = tuple(rim for part in self.parts for rim in part.rims)
        vertices = _distinct(np.concatenate([part.vertices for part in self.parts]))
        object.__setattr__(self, "vertices", vertices if rims else extreme_points(vertices))
        object.__setattr__(self, "rims", rims)
        object.__setattr__(self, "rounding", roundings.pop())

    @property
    def convex_parts(self) -> tuple[ConvexShape, ...]:
        """The parts of the shape, or the shape itself if it is convex."""
        return self.parts or (self,)

    @property
    def hulls(self) -> tuple[ConvexShape, ...]:
        """The convex hulls that a plane can touch: that of the shape, or one for each rounding of parts."""
        return (self,) if not self.parts or len(self.vertices) or self.rims else _hulls_of(self)

    @property
    def reach(self) -> float:
        """The largest distance of a point of the shape from the origin, m."""
        lengths = [0.0]
        for hull in self.hulls:
            lengths += [math.hypot(*corner) + hull.rounding for corner in hull.vertices.tolist()]
            lengths += [math.hypot(*rim.center) + rim.radius + hull.rounding for rim in hull.rims]
        return max(lengths)

    @property
    def is_empty(self) -> bool:
        """Return whether the shape has no points and circles."""
        return len(self.vertices) == 0 and not self.rims and not self.parts

    @property
    def is_polyhedron(self) -> bool:
        """Return whether only corners can touch."""
        return not self.rims and self.rounding == 0.0 and len(self.hulls) == 1

    def moved(self, offset: ArrayLike, q: ArrayLike = (0.0, 0.0, 0.0, 1.0)) -> ConvexShape:
        """Return the same shape rotated by a unit quaternion x, y, z, w, then shifted by ``offset``, (3,), m.

        Raises:
            InvalidFieldError: the offset is not three numbers of at most `LARGEST_NUMBER`, or the quaternion
                is not unit.
        """
        shift = check_vector3("offset", offset)
        turn = check_unit("q", q, 4)
        if self.parts:
            return ConvexShape(parts=tuple(part.moved(shift, turn) for part in self.parts))
        R = np.eye(3) if turn[3] == 1.0 else rotation_matrix(turn)
        return ConvexShape(
            vertices=self.vertices @ R.T + shift,
            rims=tuple(
                Rim(_triple(R @ rim.center + shift), _triple(R @ rim.axis), rim.radius) for rim in self.rims
            ),
            rounding=self.rounding,
        )


@lru_cache(maxsize=64)
def _hulls_of(shape: ConvexShape) -> tuple[ConvexShape, ...]:
    roundings = dict.fromkeys(part.rounding for part in shape.parts)
    return tuple(union([part for part in shape.parts if part.rounding == each]) for each in roundings)


NO_SHAPE: Final = ConvexShape()


def polyhedron(vertices: ArrayLike) -> ConvexShape:
    """Return the hull of corners, (k, 3), m. They may lie in a plane (a plate) or on a line (a rod).

    Points inside the hull are allowed, so this function returns the hull of a concave body.
    """
    return ConvexShape(vertices=np.asarray(vertices))


def polygon(outline: ArrayLike) -> ConvexShape:
    """Return a flat body in the x, y plane, the hull of corners, (k, 2), m."""
    corners = check_magnitude("outline", check_array("outline", outline, (None, 2)))
    return ConvexShape(vertices=np.column_stack([corners, np.zeros(len(corners))]))


def box(size: ArrayLike, y: float | None = None, z: float | None = None) -> ConvexShape:
    """Return a box of full side lengths, m, > 0: one (3,), or three numbers, as in `box(0.1, 0.2, 0.3)`."""
    sides = [_positive(f"size[{i}]", x) for i, x in enumerate(check_sides(size, y, z).tolist())]
    return ConvexShape(vertices=box_vertices(sides))


def box_vertices(size: ArrayLike) -> FloatArray:
    """Return the 8 corners, (8, 3), m, of a box with those full side lengths, centred on the origin."""
    signs = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
    return signs * (0.5 * check_array("size", size, (3,)))


def sphere(radius: float) -> ConvexShape:
    """Return a ball of a radius, m, > 0."""
    return ConvexShape(vertices=np.zeros((1, 3)), rounding=_positive("radius", radius))


def capsule(radius: float, length: float) -> ConvexShape:
    """Return a rod with round ends, about z. ``length``, m, >= 0, is the distance of the two centres."""
    half = 0.5 * check_within("length", length, 0.0, LARGEST_NUMBER)
    return ConvexShape(
        vertices=np.array([[0.0, 0.0, -half], [0.0, 0.0, half]]), rounding=_positive("radius", radius)
    )


def cylinder(radius: float, length: float) -> ConvexShape:
    """Return a cylinder about z, lengths in m. If the length is 0, it is a disc without thickness."""
    radius, half = _positive("radius", radius), 0.5 * check_within("length", length, 0.0, LARGEST_NUMBER)
    rims = (Rim((0.0, 0.0, -half), _Z, radius), Rim((0.0, 0.0, half), _Z, radius))
    return ConvexShape(rims=rims if half > 0.0 else rims[:1])


def cone(radius: float, height: float) -> ConvexShape:
    """Return a cone about z, lengths in m. Its base is at z = 0, its tip at z = ``height`` > 0."""
    rim = Rim((0.0, 0.0, 0.0), _Z, _positive("radius", radius))
    return ConvexShape(vertices=np.array([[0.0, 0.0, _positive("height", height)]]), rims=(rim,))


def rounded(shape: ConvexShape, radius: float) -> ConvexShape:
    """Return the shape rounded by a ball of ``radius``, m, >= 0, which enlarges it by this on all sides."""
    if shape.parts:
        return union([rounded(part, radius) for part in shape.parts])
    return replace(shape, rounding=shape.rounding + check_within("radius", radius, 0.0, LARGEST_NUMBER))


def union(shapes: Sequence[ConvexShape]) -> ConvexShape:
    """Return the union of shapes in one frame, such as the head and the handle of a hammer.

    `ConvexShape.moved` places each shape. They may touch or overlap, or be apart. Contacts with obstacles and
    other bodies are those of the parts. A plane touches only the hull of the parts, so contacts with planes,
    and tosses, depend on the hull alone. Tosses require parts of the same rounding, which is the radius of a
    sphere or a capsule, and zero of a box.

    Raises:
        TooLargeError: there are more than `MAX_PARTS` convex parts.
    """
    parts = tuple(part for shape in shapes for part in shape.convex_parts if not part.is_empty)
    return ConvexShape(parts=parts) if len(parts) > 1 else next(iter(parts), NO_SHAPE)


_Z: Final = (0.0, 0.0, 1.0)


def _checked(center: ArrayLike, axis: ArrayLike, radius: float) -> Rim:
    return Rim(
        _triple(check_magnitude("rim center", check_array("rim center", center, (3,)))),
        _triple(check_unit("rim axis", axis, 3)),
        _positive("rim radius", radius),
    )


def _positive(field: str, length: float) -> float:
    return check_within(field, check_positive(field, length), 0.0, LARGEST_NUMBER)


def _triple(vector: FloatArray) -> tuple[float, float, float]:
    x, y, z = vector.tolist()
    return (x, y, z)
