"""These parameters describe a shape: one of several primitives, its pose, and the mass that fills it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, TypeAlias

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.questions.extent import MAX_IN_CONTACT, check_place
from contact_dynamics.rigid_body import inertia
from contact_dynamics.shapes import convex as convex_shape
from contact_dynamics.shapes.convex import NO_SHAPE, ConvexShape
from contact_dynamics.validation import check_array, check_not_negative, check_positive, check_unit

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.rigid_body.inertia import MassDistribution
    from contact_dynamics.validation import FloatArray

    Check: TypeAlias = Callable[[str, float], float]
    ShapeMaker: TypeAlias = Callable[[FloatArray], ConvexShape]
    MassMaker: TypeAlias = Callable[[FloatArray, float], MassDistribution]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Primitive:
    """A shape that can be configured by numbers.

    Attributes:
        description: What the numbers are.
        checks: The check of each number, or None if there are three numbers for each corner.
        shape: Makes the shape.
        mass: Makes the mass, kg, that fills the shape evenly.
    """

    description: str
    checks: tuple[Check, ...] | None
    shape: ShapeMaker
    mass: MassMaker


def _of_cylinder(radius: float, length: float, mass: float) -> MassDistribution:
    if length == 0.0:
        return inertia.disc(radius=radius, mass=mass)
    return inertia.cylinder(radius=radius, length=length, mass=mass)


_PRIMITIVES: Final = {
    "box": _Primitive(
        description="Full side lengths of a box, m: x, y, z.",
        checks=(check_positive, check_positive, check_positive),
        shape=lambda sides: convex_shape.box(size=sides),
        mass=lambda sides, mass: inertia.box(size=sides, mass=mass),
    ),
    "sphere": _Primitive(
        description="Radius of a ball, m.",
        checks=(check_positive,),
        shape=lambda sizes: convex_shape.sphere(radius=sizes[0]),
        mass=lambda sizes, mass: inertia.sphere(radius=sizes[0], mass=mass),
    ),
    "capsule": _Primitive(
        description="Radius and length between the centres of the round ends of a capsule about z, m.",
        checks=(check_positive, check_not_negative),
        shape=lambda sizes: convex_shape.capsule(radius=sizes[0], length=sizes[1]),
        mass=lambda sizes, mass: inertia.capsule(radius=sizes[0], length=sizes[1], mass=mass),
    ),
    "cylinder": _Primitive(
        description="Radius and length of a cylinder about z, m; of length 0 a disc.",
        checks=(check_positive, check_not_negative),
        shape=lambda sizes: convex_shape.cylinder(radius=sizes[0], length=sizes[1]),
        mass=lambda sizes, mass: _of_cylinder(sizes[0], sizes[1], mass),
    ),
    "cone": _Primitive(
        description="Radius of the base, at z = 0, and height of a cone about z, m.",
        checks=(check_positive, check_positive),
        shape=lambda sizes: convex_shape.cone(radius=sizes[0], height=sizes[1]),
        mass=lambda sizes, mass: inertia.cone(radius=sizes[0], height=sizes[1], mass=mass),
    ),
    "vertices": _Primitive(
        description="Corners of a convex shape, m: x, y, z of one after the other.",
        checks=None,
        shape=convex_shape.polyhedron,
        mass=lambda corners, mass: inertia.convex_hull(corners, mass=mass),
    ),
}

DESCRIPTIONS: Final = {name: primitive.description for name, primitive in _PRIMITIVES.items()}
"""The shapes, with what their numbers are. The single number 0.0 stands for no shape."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ShapeParameters:
    """A shape as it is configured, of a body or of an obstacle. Lengths are in m.

    Attributes:
        numbers: The numbers of each shape in `DESCRIPTIONS`.
        rounding: Radius of the ball that rolls over it.
        position: Position of the shape in the body's frame, or in the world.
        orientation: Unit quaternion x, y, z, w of the shape there.
        pose_names: Names of the parameters for position and orientation.
    """

    numbers: dict[str, list[float]]
    rounding: float
    position: list[float]
    orientation: list[float]
    pose_names: tuple[str, str] = ("shape_position", "shape_orientation")

    def shape_F(self) -> ConvexShape:
        """Return the shape in its frame, which is empty if none is configured.

        Raises:
            InvalidFieldError: there is more than one shape, or the numbers do not make it.
        """
        name = self._name()
        if not name:
            return NO_SHAPE
        shape = convex_shape.rounded(_PRIMITIVES[name].shape(self._values(name)), radius=self.rounding)
        return shape.moved(*self._pose())

    def uniform(self, mass: float) -> MassDistribution:
        """Return a mass, kg, that fills the shape evenly, in the body's frame.

        Raises:
            InvalidFieldError: there is no shape, or it is without volume or rounded.
        """
        name = self._name()
        if not name or self.rounding > 0.0:
            if name:
                raise InvalidFieldError(
                    "inertia", "[0.0] of a rounded shape", "six numbers, unless the shape is not rounded"
                )
            shapes = ", ".join(_PRIMITIVES)
            raise InvalidFieldError("inertia", "neither", f"six numbers, or the body have a shape ({shapes})")
        position, orientation = self._pose()
        return _PRIMITIVES[name].mass(self._values(name), mass).placed(p_GF_G=position, q_GF=orientation)

    def _pose(self) -> tuple[FloatArray, FloatArray]:
        position, orientation = self.pose_names
        p = check_array(position, self.position, (3,))
        check_place(position, p)
        return p, check_unit(orientation, self.orientation, 4)

    def _name(self) -> str:
        given = [name for name, values in self.numbers.items() if values != [0.0]]
        if len(given) > 1:
            raise InvalidFieldError(given[1], f"a second shape beside {given[0]}", "one (or [0.0]: none)")
        return given[0] if given else ""

    def _values(self, name: str) -> FloatArray:
        values, checks = self.numbers[name], _PRIMITIVES[name].checks
        if checks is None:
            if len(values) % 3 > 0:
                raise InvalidFieldError(name, f"{len(values)} numbers", "3 for each (or [0.0]: none)")
            corners = check_array(name, values, (None,)).reshape(-1, 3)
            check_place(name, corners)
            return corners
        if len(values) != len(checks):
            allowed = f"{len(checks)} (or [0.0]: none)"
            raise InvalidFieldError(name, f"{len(values)} numbers", allowed)
        numbers = [checks[i](f"{name}[{i}]", x) for i, x in enumerate(values)]
        for i, x in enumerate(numbers):
            if x > 0.0 and not 1.0 / MAX_IN_CONTACT <= x <= MAX_IN_CONTACT:
                allowed = f"a length from {1.0 / MAX_IN_CONTACT:g} m to {MAX_IN_CONTACT:g} m"
                raise InvalidFieldError(f"{name}[{i}]", f"{x:g} m", allowed)
        return check_array(name, numbers, (None,))
