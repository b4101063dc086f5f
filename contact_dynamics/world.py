# SPDX-License-Identifier: Apache-2.0
"""A world: bodies with shapes, the surfaces that they can touch, and gravity.

Surfaces are infinite planes (`Surface`), which may move, and convex solids and plates (`Obstacle`), which do
not move.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Final

import numpy as np

from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.errors import InvalidFieldError, NotSupportedError, UnknownBodyError
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState, HasMassProperties, MassProperties
from contact_dynamics.rigid_body.inertia import solids
from contact_dynamics.rigid_body.inertia.distribution import MassDistribution, combined
from contact_dynamics.rigid_body.inertia.triangle_mesh import mesh, mesh_and_parts, signed_volumes
from contact_dynamics.shapes import convex
from contact_dynamics.shapes.concavity import few_parts, warn_if_concave
from contact_dynamics.shapes.convex import (
    MAX_VERTICES,
    NO_SHAPE,
    ConvexShape,
    box_vertices,
    polyhedron,
    union,
)
from contact_dynamics.shapes.obstacle import Obstacle
from contact_dynamics.tolerances import SURFACES_AS_ONE
from contact_dynamics.validation import (
    FloatArray,
    check_array,
    check_magnitude,
    check_motion,
    check_not_negative,
    check_positive,
    check_static,
    check_unit,
    check_within,
)
from contact_dynamics.validation_types import checks_types

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

__all__ = ["LONGEST_NAME", "MAX_VERTICES", "Body", "Surface", "World", "box_vertices"]

LONGEST_NAME: Final = 256
"""Letters that a name may have which a request or a configuration gives."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Body(HasMassProperties):
    """Rigid body with a name and a shape.

    `Body.box`, `Body.sphere`, `Body.cylinder`, `Body.capsule` and `Body.from_mesh` make uniform bodies, whose
    mass properties match the shape. `Body.union` makes one body of several. `Body.from_urdf` and
    `Body.from_sdf` read a link of a file. `Body.of` takes any distribution of mass, such as measured values
    or several parts of `inertia`.

    Attributes:
        name: Name by which questions refer to the body.
        mass_properties: Mass and angular inertia about the centre of mass.
        p_FB_F: (3,), m, centre of mass in the published frame F. The default is its origin.
        vertices_B: (k, 3), m, corners of a polyhedron, body axes, as an alternative to ``shape``. Corners of
            a concave body cause a `ConcaveShapeWarning`.
        shape: Shape for contacts, body axes.

    Raises:
        InvalidFieldError: a number is not finite, the centre of mass is beyond `LARGEST_NUMBER`, an array has
            a wrong shape, or both vertices and a shape are given.
        TooLargeError: there are more vertices than `MAX_VERTICES`.
    """

    name: str
    mass_properties: MassProperties
    p_FB_F: FloatArray = field(default_factory=lambda: np.zeros(3))
    vertices_B: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))
    shape: ConvexShape = NO_SHAPE

    HINT_IF_UNKNOWN: ClassVar[str] = (
        "Body.box, Body.sphere, Body.cylinder, Body.capsule and Body.from_mesh take sizes and a mass"
    )

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            name: str,
            mass_properties: MassProperties,
            p_FB_F: ArrayLike = ...,
            vertices_B: ArrayLike = ...,
            shape: ConvexShape = ...,
        ) -> None:
            """Take whatever NumPy makes arrays of."""

    def __post_init__(self) -> None:
        """Check the arrays, and make corners and shape agree."""
        center = check_magnitude("p_FB_F", check_array("p_FB_F", self.p_FB_F, (3,)))
        object.__setattr__(self, "p_FB_F", center)
        if self.shape is NO_SHAPE:
            vertices = check_magnitude("vertices_B", check_array("vertices_B", self.vertices_B, (None, 3)))
            object.__setattr__(self, "shape", ConvexShape(vertices=vertices))
            warn_if_concave(f"body {self.name!r}", self.shape.vertices, self.mass_properties)
        elif self.vertices_B is not self.shape.vertices and np.size(self.vertices_B) > 0:
            raise InvalidFieldError("vertices_B", "vertices and a shape", "one of them")
        object.__setattr__(self, "vertices_B", self.shape.vertices)

    @classmethod
    @checks_types
    def box(
        cls, size: ArrayLike, mass: float | None = None, *, density: float | None = None, name: str = "box"
    ) -> Body:
        """Return a uniform box of full side lengths (3,), m, with its frame at the centre.

        As for the other uniform bodies, either ``mass``, kg, or ``density``, kg/m^3, is required. The centre
        of mass is at the centre. For another centre of mass or a measured inertia, use
        ``Body.of(name, MassDistribution(mass=..., p_FB_F=..., I_B=...), shape_F=shapes.box(size))``, and the
        same with other shapes.
        """
        return cls.of(name, solids.box(size, mass=mass, density=density), shape_F=convex.box(size))

    @classmethod
    @checks_types
    def sphere(
        cls, radius: float, mass: float | None = None, *, density: float | None = None, name: str = "sphere"
    ) -> Body:
        """Return a uniform ball of the given radius, m, with its frame at the centre. See also `Body.box`."""
        return cls.of(name, solids.sphere(radius, mass=mass, density=density), shape_F=convex.sphere(radius))

    @classmethod
    @checks_types
    def cylinder(
        cls,
        radius: float,
        length: float,
        mass: float | None = None,
        *,
        density: float | None = None,
        name: str = "cylinder",
    ) -> Body:
        """Return a uniform cylinder about z, lengths in m, with its frame at the centre.

        See also `Body.box`.
        """
        solid = solids.cylinder(radius, length, mass=mass, density=density)
        return cls.of(name, solid, shape_F=convex.cylinder(radius, length))

    @classmethod
    @checks_types
    def capsule(
        cls,
        radius: float,
        length: float,
        mass: float | None = None,
        *,
        density: float | None = None,
        name: str = "capsule",
    ) -> Body:
        """Return a uniform rod with round ends about z, with its frame at the centre.

        ``length``, m, is the distance between the centres of the two ends. See also `Body.box`.
        """
        solid = solids.capsule(radius, length, mass=mass, density=density)
        return cls.of(name, solid, shape_F=convex.capsule(radius, length))

    @classmethod
    @checks_types
    def from_mesh(
        cls,
        vertices_F: ArrayLike | str | Path,
        triangles: ArrayLike | None = None,
        mass: float | None = None,
        *,
        density: float | None = None,
        scale: float = 1.0,
        name: str = "mesh",
    ) -> Body:
        """Return the uniform solid inside a closed mesh, with the mesh's frame as its published frame F.

        The mass properties are those of the mesh. The shape is the union of the convex hulls of the mesh's
        connected parts, with a `ConcaveShapeWarning` for each part that differs from its hull, or the hull of
        the mesh if there are more than `MAX_PARTS`.

        Args:
            vertices_F: (n, 3), m, or a file: STL, OBJ, PLY or glTF, which requires trimesh
                (`pip install trimesh`).
            triangles: (m, 3), three indices of vertices each, counterclockwise seen from outside. None for a
                file.
            mass: kg, or None if a density is given.
            density: kg/m^3, or None if a mass is given.
            scale: Factor of the vertices, such as 0.001 if they are in millimetres.
            name: Name by which questions refer to the body.

        Raises:
            InvalidFieldError: `inertia.mesh` rejects an argument, the file cannot be read, or trimesh is not
                installed.
            TooLargeError: there are more vertices than `MAX_VERTICES`.

        Warns:
            ImplausibleBodyWarning: no body of that size has the mass of a file's mesh, so the file is
                probably in millimetres.
        """
        file = None
        if isinstance(vertices_F, (str, Path)):
            if triangles is not None:
                raise InvalidFieldError("triangles", "triangles beside a file", "None")
            from contact_dynamics.shapes.files import read_mesh, warn_if_implausible

            file = vertices_F
            vertices_F, triangles = read_mesh(file)
        elif triangles is None:
            raise InvalidFieldError("triangles", None, "(m, 3) indices of vertices")
        vertices = check_positive("scale", scale) * check_array("vertices_F", vertices_F, (None, 3))
        solid, parts = mesh_and_parts(vertices, triangles, mass=mass, density=density)
        parts = few_parts(f"mesh {name!r}", parts)
        if len(parts) > 1:
            shapes = [_part_of_mesh(f"{name} {i}", *part) for i, part in enumerate(parts)]
            body = cls.of(name, solid, shape_F=union(shapes))
        else:
            body = cls.of(name, solid, vertices_F=vertices)
        if file is not None:
            warn_if_implausible(f"mesh {file}", solid, body.shape.moved(body.p_FB_F))
        return body

    @classmethod
    @checks_types
    def from_urdf(cls, source: str | Path, link: str | None = None, *, name: str | None = None) -> Body:
        """Return a link of a URDF with its inertia and its collision shape. Its frame F is that of the link.

        The shape is a box, a cylinder, a sphere, a capsule, or the convex hulls of the connected parts of a
        mesh, which requires trimesh, or the union of several of these (`shapes.union`). Friction and
        restitution are properties of surfaces in this package, and are not read.

        Args:
            source: A file, or its text, as from ``robot_description``. Mesh files are searched for beside it,
                in the parent folders, and in a sourced workspace (``package://``).
            link: Name of the link. It is optional if only one link has a mass.
            name: Name by which questions refer to the body. The default is that of the link.

        Raises:
            InvalidFieldError: the file cannot be read, it has no such link with a mass or several, an element
                is missing or not supported, a number is invalid, or no distribution of mass has the inertia.
            TooLargeError: the shape has too many vertices.

        Warns:
            ImplausibleBodyWarning: the mass cannot lie inside the shape, so units or placeholders are
                probably wrong.
        """
        from contact_dynamics.shapes.files import read_link

        found = read_link(source, link)
        return cls.of(found.name if name is None else name, found.mass, shape_F=found.shape)

    @classmethod
    @checks_types
    def from_sdf(cls, source: str | Path, link: str | None = None, *, name: str | None = None) -> Body:
        """Return a link of an SDF file, with its inertia and its collision shape. See `Body.from_urdf`."""
        return cls.from_urdf(source, link, name=name)

    @classmethod
    @checks_types
    def union(cls, parts: Sequence[Body], *, name: str = "union") -> Body:
        """Return several bodies as one rigid body, which need not be convex, such as a hammer.

        The parts' published frames coincide, and are that of the whole; `placed` moves a part. If parts
        overlap, the mass of the overlap counts twice. A part without a shape contributes its mass only.

        Raises:
            InvalidFieldError: there is no part.
            TooLargeError: there are more than `MAX_PARTS` convex parts.

        Examples:
            >>> import contact_dynamics as cd
            >>> head, handle = cd.Body.box((0.1, 0.03, 0.03), 0.5), cd.Body.box((0.02, 0.02, 0.3), 0.1)
            >>> hammer = cd.Body.union([head.placed([0, 0, 0.165]), handle], name="hammer")
            >>> print(f"{hammer.p_FB_F[2]:.4f} m, {len(hammer.shape.parts)} parts")
            0.1375 m, 2 parts
        """
        mass = combined(MassDistribution.of(part.mass_properties, part.p_FB_F) for part in parts)
        return cls.of(name, mass, shape_F=union([part.shape.moved(part.p_FB_F) for part in parts]))

    def placed(self, p_GF_G: ArrayLike = (0.0, 0.0, 0.0), q_GF: ArrayLike = (0.0, 0.0, 0.0, 1.0)) -> Body:
        """Return the same body with another published frame G, in which F has the given pose.

        Args:
            p_GF_G: (3,), m, F's origin in G.
            q_GF: (4,), unit quaternion x, y, z, w: F's coordinates into G's.

        Raises:
            InvalidFieldError: a number is not finite, or the quaternion is not unit.
        """
        mass = MassDistribution.of(self.mass_properties, self.p_FB_F).placed(p_GF_G=p_GF_G, q_GF=q_GF)
        return Body.of(self.name, mass, shape_F=self.shape.moved(self.p_FB_F).moved(p_GF_G, q_GF))

    @classmethod
    @checks_types
    def of(
        cls,
        name: str,
        mass: MassDistribution,
        *,
        vertices_F: ArrayLike | None = None,
        shape_F: ConvexShape = NO_SHAPE,
    ) -> Body:
        """Return the body with a given distribution of mass in the published frame F.

        Args:
            name: Name by which questions refer to the body.
            mass: Mass, centre of mass and inertia, in F.
            vertices_F: (k, 3), m, corners of the shape in F, as an alternative to ``shape_F``. Their convex
                hull is used. Corners of a concave body cause a `ConcaveShapeWarning`; to use the hull
                intentionally, pass ``shape_F=polyhedron(vertices)``.
            shape_F: Shape in F. That of a concave body is a `shapes.union` of convex parts.

        Raises:
            InvalidFieldError: the mass is a point or a line, vertices are not finite or not of shape (k, 3),
                or both vertices and a shape are given.
            TooLargeError: there are more vertices than `MAX_VERTICES`.
        """
        mass_properties = mass.mass_properties
        if vertices_F is not None:
            if shape_F is not NO_SHAPE:
                raise InvalidFieldError("vertices_F, shape_F", "both", "one of them")
            shape_F = polyhedron(
                check_magnitude("vertices_F", check_array("vertices_F", vertices_F, (None, 3)))
            )
            warn_if_concave(f"body {name!r}", shape_F.vertices - mass.p_FB_F, mass_properties)
        return cls(
            name=name,
            mass_properties=mass_properties,
            p_FB_F=mass.p_FB_F,
            shape=shape_F.moved(-mass.p_FB_F),
        )


def _part_of_mesh(name: str, vertices_F: FloatArray, triangles: NDArray[np.int64]) -> ConvexShape:
    """Return the hull of a part of a mesh, or of a cavity, which is inside out. Warn if it is concave."""
    inside_out = signed_volumes(vertices_F, triangles).sum() < 0.0
    try:
        solid = mesh(vertices_F, triangles[:, ::-1] if inside_out else triangles, density=1.0)
        part = Body.of(name, solid, vertices_F=vertices_F)
    except InvalidFieldError:  # it is flat, and has no mass
        return polyhedron(vertices_F)
    return part.shape.moved(part.p_FB_F)


_AT_REST: Final = np.zeros(3)
_AT_REST.flags.writeable = False


def _at_rest() -> FloatArray:
    return _AT_REST


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Surface(Record):
    """Infinite plane of the world. Its normal points to the free side.

    A belt, a cart, a turntable or a tray moves as a rigid body. Contact modes and impacts accept such
    surfaces. Landings accept them unless they tilt, and tosses and sequences of impacts if all surfaces have
    the same motion without rotation. Other functions raise an error.

    Attributes:
        name: Name by which contacts refer to the surface.
        p_WS_W: (3,), m, a point of the surface, world.
        normal_W: (3,), unit normal towards the free side, world axes.
        friction: Coefficient of Coulomb friction between this surface and any body, >= 0.
        restitution: Coefficient of restitution between this surface and any body, in [0, 1].
        lasting_factor: Factor of the friction coefficient for sustained contact in tosses (`toss`), >= 0: the
            friction coefficient of a sliding face can differ from that of corners in impacts.
        lasting_speed: m/s, >= 0. In tosses, the friction coefficient of impacts at a lower approach speed
            changes linearly with the speed, from that of sustained contact at zero to ``friction``. If zero,
            all impacts have ``friction``.
        v_WS_W: (3,), m/s, velocity of the surface's material point at ``p_WS_W``, world axes.
        w_WS_W: (3,), rad/s, angular velocity of the surface, world axes. If ``v_WS_W`` is zero, the axis goes
            through ``p_WS_W``.
        a_WS_W: (3,), m/s^2, acceleration of the surface's material point at ``p_WS_W``, world axes.
        alpha_WS_W: (3,), rad/s^2, angular acceleration of the surface, world axes.
        static_friction: Coefficient of static friction, >= ``friction``, of bodies that stick, or None if it
            is the same. Impacts use ``friction``. In tosses, ``lasting_factor`` applies to it, too, and a
            body that has stopped stays at rest if it can.
        moves: Whether any of these four is not zero.

    Raises:
        InvalidFieldError: a number is not finite, the point or a velocity or acceleration is beyond
            `LARGEST_NUMBER`, the normal is not a unit vector, the friction, the factor or the speed is
            negative, the static friction is below the friction, or the restitution is outside [0, 1].
    """

    name: str
    p_WS_W: FloatArray
    normal_W: FloatArray
    friction: float
    restitution: float
    lasting_factor: float = 1.0
    lasting_speed: float = 0.0
    v_WS_W: FloatArray = field(default_factory=_at_rest)
    w_WS_W: FloatArray = field(default_factory=_at_rest)
    a_WS_W: FloatArray = field(default_factory=_at_rest)
    alpha_WS_W: FloatArray = field(default_factory=_at_rest)
    static_friction: float | None = None
    moves: bool = field(init=False, repr=False, default=False)

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            name: str,
            p_WS_W: ArrayLike,
            normal_W: ArrayLike,
            friction: float,
            restitution: float,
            lasting_factor: float = ...,
            lasting_speed: float = ...,
            v_WS_W: ArrayLike = ...,
            w_WS_W: ArrayLike = ...,
            a_WS_W: ArrayLike = ...,
            alpha_WS_W: ArrayLike = ...,
            static_friction: float | None = ...,
        ) -> None:
            """Take whatever NumPy makes arrays of."""

    def __post_init__(self) -> None:
        """Check all fields."""
        object.__setattr__(
            self, "p_WS_W", check_magnitude("p_WS_W", check_array("p_WS_W", self.p_WS_W, (3,)))
        )
        object.__setattr__(self, "normal_W", check_unit("normal_W", self.normal_W, 3))
        object.__setattr__(self, "friction", check_not_negative("friction", self.friction))
        object.__setattr__(self, "static_friction", check_static(self.static_friction, self.friction))
        object.__setattr__(self, "restitution", check_within("restitution", self.restitution, 0.0, 1.0))
        object.__setattr__(self, "lasting_factor", check_not_negative("lasting_factor", self.lasting_factor))
        object.__setattr__(self, "lasting_speed", check_not_negative("lasting_speed", self.lasting_speed))
        for name in ("v_WS_W", "w_WS_W", "a_WS_W", "alpha_WS_W"):
            if (given := getattr(self, name)) is not _AT_REST:
                moved = check_motion(name, given)
                object.__setattr__(self, name, _AT_REST if moved is None else moved)
                object.__setattr__(self, "moves", self.moves or moved is not None)

    def gaps(self, p_WP_W: FloatArray) -> FloatArray:
        """Return the heights, (...), m, of points, (..., 3), above the surface, negative below it."""
        heights: FloatArray = (p_WP_W - self.p_WS_W) @ self.normal_W
        return heights

    @property
    def is_steady(self) -> bool:
        """Return whether place and velocities are the same at all times, as of a belt or a turntable."""
        if not self.moves:
            return True
        n, v, w = self.normal_W, self.v_WS_W, self.w_WS_W
        return (
            not self.alpha_WS_W.any()
            and _vanishes(_along(n, v), v)
            and _vanishes(w - _along(n, w), w)
            and _vanishes(self.a_WS_W - np.cross(w, v), self.a_WS_W, np.cross(w, v))
        )

    def after(self, seconds: float) -> Surface:
        """Return the surface after a time, s. Its accelerations are constant.

        It may rotate about its normal, as a turntable does, if the axis is fixed. Then `p_WS_W` of the result
        is on the axis.

        Raises:
            NotSupportedError: the surface tilts, or it rotates about its normal and its axis moves sideways.
        """
        if not self.moves:
            return self
        v_W, a_W, p_WS_W = self.v_WS_W, self.a_WS_W, self.p_WS_W
        if self.w_WS_W.any() or self.alpha_WS_W.any():
            p_WS_W = self._point_of_axis()
            v_W, a_W = _along(self.normal_W, v_W), _along(self.normal_W, a_W)
        return replace(
            self,
            p_WS_W=p_WS_W + seconds * v_W + 0.5 * seconds**2 * a_W,
            v_WS_W=v_W + seconds * a_W,
            a_WS_W=a_W,
            w_WS_W=self.w_WS_W + seconds * self.alpha_WS_W,
        )

    def _point_of_axis(self) -> FloatArray:
        """Return the point of the axis, (3,), m, about which the surface turns in its own plane."""
        n, w, alpha = self.normal_W, self.w_WS_W, self.alpha_WS_W
        v, a = self.v_WS_W - _along(n, self.v_WS_W), self.a_WS_W - _along(n, self.a_WS_W)
        for turning in (w, alpha):
            if not _vanishes(turning - _along(n, turning), turning):
                message = f"surface {self.name!r} must turn about its normal only, got {turning.tolist()}"
                raise NotSupportedError(message)
        # p_WS_W = c + r with v = w x r and a = alpha x r + w x v.
        r = np.cross(v, w) / (w @ w) if w.any() else np.cross(a, alpha) / (alpha @ alpha)
        centripetal = np.cross(w, v)
        if not (
            _vanishes(np.cross(w, r) - v, v)
            and _vanishes(np.cross(alpha, r) + centripetal - a, a, centripetal)
        ):
            message = f"surface {self.name!r} must turn about a fixed axis, got an axis that moves sideways"
            raise NotSupportedError(message)
        return self.p_WS_W - r

    def motion_at(self, p_WP_W: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return velocity, m/s, and acceleration, m/s^2, (..., 3), of its material points at (..., 3), m."""
        r_W, w_W = p_WP_W - self.p_WS_W, self.w_WS_W
        turning = np.cross(w_W, r_W)
        return self.v_WS_W + turning, self.a_WS_W + np.cross(self.alpha_WS_W, r_W) + np.cross(w_W, turning)


def _along(n: FloatArray, vector: FloatArray) -> FloatArray:
    """Return the part of a vector along a unit vector."""
    part: FloatArray = (n @ vector) * n
    return part


def _alike(one: Surface, other: Surface) -> bool:
    """Return whether two surfaces have the same velocity and acceleration, and the second does not turn."""
    turns = other.w_WS_W.any() or other.alpha_WS_W.any()
    alike = np.array_equal(one.v_WS_W, other.v_WS_W) and np.array_equal(one.a_WS_W, other.a_WS_W)
    return bool(alike and not turns)


def _motion_in_words(surface: Surface | Obstacle) -> str:
    if not isinstance(surface, Surface):
        return f"the obstacle {surface.name!r}, which is at rest"
    if surface.w_WS_W.any() or surface.alpha_WS_W.any():
        return f"{surface.name!r}, which turns"
    if not surface.moves:
        return f"{surface.name!r}, which is at rest"
    v, a = surface.v_WS_W.tolist(), surface.a_WS_W.tolist()
    return f"{surface.name!r}, which moves at {v} m/s" + (f" and {a} m/s^2" if any(a) else "")


def _vanishes(difference: FloatArray, *terms: FloatArray) -> bool:
    """Return whether a difference of some terms is nothing but rounding."""
    largest = max(float(np.abs(term).max()) for term in terms)
    return float(np.abs(difference).max()) <= SURFACES_AS_ONE * largest


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SurfaceFrame(Record):
    """A frame in which all surfaces are at rest. It coincides with the world's at time 0, and does not turn.

    Attributes:
        velocity_W: (3,), m/s, its velocity at time 0, world axes.
        acceleration_W: (3,), m/s^2, its acceleration, which is constant, world axes.
    """

    velocity_W: FloatArray
    acceleration_W: FloatArray

    def displacement(self, seconds: FloatArray | float) -> FloatArray:
        """Return by how much it has moved at times (...), s, as (..., 3), m."""
        t = np.asarray(seconds)[..., None]
        moved: FloatArray = t * self.velocity_W + 0.5 * t * t * self.acceleration_W
        return moved

    def velocity(self, seconds: FloatArray | float) -> FloatArray:
        """Return its velocity at times (...), s, as (..., 3), m/s."""
        gained: FloatArray = self.velocity_W + np.asarray(seconds)[..., None] * self.acceleration_W
        return gained

    def seen(self, state: BodyState) -> BodyState:
        """Return a state of the world at time 0 as it is in the frame."""
        return state.with_velocities(state.v_WB_W - self.velocity_W, state.w_WB_W)

    def in_world(self, state: BodyState, seconds: float) -> BodyState:
        """Return a state of the frame at a time, s, as it is in the world."""
        return replace(
            state,
            p_WB_W=state.p_WB_W + self.displacement(seconds),
            v_WB_W=state.v_WB_W + self.velocity(seconds),
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class World(Record):
    """Bodies, surfaces and gravity.

    Attributes:
        bodies: Bodies, with different names.
        surfaces: Infinite planes, and obstacles, with different names.
        gravity_W: (3,), m/s^2, world axes. The default is (0, 0, -9.80665).
        surfaces_move: Whether any surface moves.

    Raises:
        InvalidFieldError: two bodies or two surfaces have the same name, or gravity is not three finite
            numbers.

    Examples:
        >>> import contact_dynamics as cd
        >>> brick = cd.Body.box((0.15, 0.09, 0.05), mass=0.4, name="brick")
        >>> floor = cd.Surface(
        ...     name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.4, restitution=0.2
        ... )
        >>> world = cd.World(bodies=(brick,), surfaces=(floor,))
    """

    bodies: tuple[Body, ...] = ()
    surfaces: tuple[Surface | Obstacle, ...] = ()
    gravity_W: FloatArray = field(default_factory=lambda: np.array(STANDARD_GRAVITY_W))
    surfaces_move: bool = field(init=False, repr=False, default=False)

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            bodies: tuple[Body, ...] = ...,
            surfaces: tuple[Surface | Obstacle, ...] = ...,
            gravity_W: ArrayLike = ...,
        ) -> None:
            """Take whatever NumPy makes arrays of."""

    def __post_init__(self) -> None:
        """Check gravity and that names are unique."""
        object.__setattr__(self, "gravity_W", check_array("gravity_W", self.gravity_W, (3,)))
        moves = any(isinstance(each, Surface) and each.moves for each in self.surfaces)
        object.__setattr__(self, "surfaces_move", moves)
        for field_name, named in (("bodies", self.bodies), ("surfaces", self.surfaces)):
            names = [each.name for each in named]
            if len(set(names)) < len(names):
                raise InvalidFieldError(field_name, names, "different names")

    def after(self, seconds: float) -> World:
        """Return the world after a time, s, with the surfaces where they have moved to (`Surface.after`)."""
        if not self.surfaces_move:
            return self
        moved = [each.after(seconds) if isinstance(each, Surface) else each for each in self.surfaces]
        return replace(self, surfaces=tuple(moved))

    def seen_from_surfaces(self, call: str) -> tuple[World, SurfaceFrame | None]:
        """Return the world in the frame in which its surfaces are at rest, and the frame if they move.

        There, gravity is less by the acceleration of the frame.

        Raises:
            NotSupportedError: the surfaces do not all move with the same velocity and acceleration, or they
                turn. The message names ``call``, which needs that.
        """
        if not self.surfaces_move:
            return self, None
        planes = [each for each in self.surfaces if isinstance(each, Surface)]
        first = planes[0]
        for each in self.surfaces:
            if not (isinstance(each, Surface) and _alike(first, each)):
                found = [_motion_in_words(one) for one in dict.fromkeys((first, each))]
                raise NotSupportedError(
                    f"world must have surfaces at rest in {call}, or surfaces that all move with the same "
                    f"v_WS_W and a_WS_W and do not turn, got {' and '.join(found)}; next_landing and "
                    "contact_modes accept other motions"
                )
        at_rest = [replace(each, v_WS_W=_AT_REST, a_WS_W=_AT_REST) for each in planes]
        frame = SurfaceFrame(velocity_W=first.v_WS_W, acceleration_W=first.a_WS_W)
        return replace(self, surfaces=tuple(at_rest), gravity_W=self.gravity_W - first.a_WS_W), frame

    @checks_types
    def body(self, name: str) -> Body:
        """Return the body with this name, or raise `UnknownBodyError`, which lists the known names."""
        for body in self.bodies:
            if body.name == name:
                return body
        known = ", ".join(repr(body.name) for body in self.bodies) or "none"
        raise UnknownBodyError(f"body_name must be one of the known bodies ({known}), got {name!r}")
