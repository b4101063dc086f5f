# SPDX-License-Identifier: Apache-2.0
"""The parameters of each body, with the sources of its states, of shapes, and of each surface."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, TypeAlias

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.nodes.links import LINK, PARTS, URDF
from contact_dynamics.nodes.parameter_reader import ConfigurationError
from contact_dynamics.questions.carried_surface import ACCELERATION_WINDOW, CarriedSurface
from contact_dynamics.questions.extent import (
    MAX_IN_CONTACT,
    check_friction,
    check_mass,
    check_place,
    check_vector,
)
from contact_dynamics.rigid_body import inertia
from contact_dynamics.rigid_body.body import MassProperties
from contact_dynamics.shapes import convex as convex_shape
from contact_dynamics.shapes.concavity import warn_if_concave
from contact_dynamics.shapes.convex import NO_SHAPE, ConvexShape
from contact_dynamics.shapes.obstacle import Obstacle
from contact_dynamics.validation import (
    check_array,
    check_not_negative,
    check_positive,
    check_static,
    check_unit,
)
from contact_dynamics.world import Body, Surface

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from contact_dynamics.nodes.parameter_reader import ConfiguredTopic, ParameterSource
    from contact_dynamics.rigid_body.inertia import MassDistribution
    from contact_dynamics.validation import FloatArray

    Check: TypeAlias = Callable[[str, float], float]
    ShapeMaker: TypeAlias = Callable[[FloatArray], ConvexShape]
    MassMaker: TypeAlias = Callable[[FloatArray, float], MassDistribution]


MAX_DEVIATION: Final = 1e6
"""m, rad, m/s and rad/s. Largest standard deviation of a state that can be configured."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ConfiguredSource:
    """A source of a body's states."""

    adapter: str  # name of the adapter
    topics: tuple[ConfiguredTopic, ...]  # in the adapter's order


@dataclass(frozen=True, slots=True, kw_only=True)
class BodySources:
    """The sources of a body's states."""

    body_name: str
    frame: str  # the body's frame, whose pose is published
    velocity_window: float  # s, duration of the poses from which a velocity is estimated
    # Standard deviations of states without a covariance (`with_deviations`), or none
    state_deviations: tuple[float, ...]
    sources: tuple[ConfiguredSource, ...]  # several, one or none


_NOT_TURNED: Final = [0.0, 0.0, 0.0, 1.0]
_UP: Final = [0.0, 0.0, 1.0]


def _check_unread(condition: str, **fields: tuple[object, object]) -> None:
    """Raise `InvalidFieldError` for a field, given with its default, that would be ignored."""
    for name, (value, default) in fields.items():
        if value != default:
            raise InvalidFieldError(name, value, f"left out {condition}")


def read_body(source: ParameterSource, name: str) -> tuple[Body, BodySources]:
    """Return a body and the sources of its states.

    Raise `ConfigurationError` if a parameter is missing or not allowed.
    """
    key = f"body.{name}"
    _read_link(source, key)
    mass = source.value(f"{key}.mass", float, "Mass, kg.")
    inertia = source.value(
        f"{key}.inertia",
        [0.0],
        "Angular inertia about the centre of mass, kg m^2, in the axes of the body's frame: "
        "ixx, iyy, izz, ixy, ixz, iyz. [0.0] means that the mass fills the shape evenly.",
    )
    offset = source.value(
        f"{key}.center_of_mass", [0.0, 0.0, 0.0], "Centre of mass in the body's frame, m: x, y, z."
    )
    shape = _read_shape(source, key)
    parts = _read_parts(source, key)
    body = source.build(key, lambda: _body(name, mass, inertia, offset, shape, parts=parts))
    return body, BodySources(
        body_name=name,
        frame=source.name(f"{key}.frame", name, "Frame of the body, whose pose is published."),
        velocity_window=source.value(
            f"{key}.velocity_window",
            0.05,
            "Length of the window for velocities where only poses are published, s.",
            (1e-3, 10.0),
        ),
        state_deviations=_read_deviations(source, key),
        sources=_read_sources(source, key),
    )


def _read_link(source: ParameterSource, key: str) -> None:
    """Read the parameters that `links` replaces by the numbers of a link at the start."""
    of_body = "Mass, inertia, centre of mass and shape are then those of the link, and cannot be given too."
    texts = {
        URDF: f"URDF or SDF file with the body as a link, or its text (`robot_description`). {of_body}",
        LINK: "Link of this file. It is optional if only one link has a mass.",
    }
    for leaf, text in texts.items():
        if given := source.value(f"{key}.{leaf}", "", text):
            raise ConfigurationError(f"{key}.{leaf} must be given when the server starts, got {given!r}")


def _read_deviations(source: ParameterSource, key: str) -> tuple[float, ...]:
    name = f"{key}.state_deviations"
    found = source.value(
        name,
        [0.0],
        "Standard deviations of states that are published without a covariance: position, m, orientation, "
        "rad, linear velocity, m/s, angular velocity, rad/s. [0.0] means that such states are exact.",
    )
    if found == [0.0]:
        return ()
    if len(found) != 4 or not all(0.0 <= deviation <= MAX_DEVIATION for deviation in found):
        allowed = f"four numbers from 0 to {MAX_DEVIATION:g} (or [0.0]: exact)"
        raise ConfigurationError(f"{name} must be {allowed}, got {found}")
    return tuple(found)


def _read_sources(source: ParameterSource, key: str) -> tuple[ConfiguredSource, ...]:
    """Return the sources of a body's states: the usual ones by their topics, and one by its name."""
    odometry = source.topic(
        f"{key}.odometry_topic", "Topic of the body's states as nav_msgs/Odometry. Not used if empty."
    )
    pose = source.topic(
        f"{key}.pose_topic", "Topic of the body's geometry_msgs/PoseStamped. Not used if empty."
    )
    twist = source.topic(
        f"{key}.twist_topic",
        "Topic of the body's geometry_msgs/TwistStamped. If empty, velocities are estimated from poses.",
    )
    if twist is not None and pose is None:
        raise ConfigurationError(f"{key}.twist_topic must be none without a pose_topic, got {twist.name!r}")
    name = source.value(f"{key}.source", "", "Name of another source of states. Not used if empty.")
    topics = source.topics_of(f"{key}.source_topics", "Topics of this source.")
    if bool(name) != bool(topics):
        found = f"{name!r} and {[topic.name for topic in topics]}"
        raise ConfigurationError(f"{key}.source and {key}.source_topics must be both or none, got {found}")
    sources = []
    if odometry is not None:
        sources.append(ConfiguredSource(adapter="odometry", topics=(odometry,)))
    if pose is not None and twist is None:
        sources.append(ConfiguredSource(adapter="pose", topics=(pose,)))
    if pose is not None and twist is not None:
        sources.append(ConfiguredSource(adapter="pose_twist", topics=(pose, twist)))
    if name:
        sources.append(ConfiguredSource(adapter=name, topics=topics))
    return tuple(sources)


def _body(
    name: str,
    mass: float,
    inertia: list[float],
    offset: list[float],
    shape: ShapeParameters,
    *,
    parts: Sequence[ConvexShape],
) -> Body:
    center_of_mass = check_array("center_of_mass", offset, (3,))
    shape_F = convex_shape.union([shape.shape_F(), *parts])
    if shape_F.is_empty:
        _check_unread(
            "unless there is a shape",
            rounding=(shape.rounding, 0.0),
            shape_position=(shape.position, [0.0, 0.0, 0.0]),
            shape_orientation=(shape.orientation, _NOT_TURNED),
        )
    if parts and inertia == [0.0]:
        raise InvalidFieldError("inertia", "[0.0] of a body with parts", "six numbers")
    if inertia == [0.0]:
        uniform = shape.uniform(check_positive("mass", mass))
        if center_of_mass.any():
            raise InvalidFieldError(
                "center_of_mass",
                offset,
                "the origin, unless the inertia is given too (the default is the uniform shape's)",
            )
        center_of_mass, mass_properties = uniform.p_FB_F, uniform.mass_properties
    elif len(inertia) == 6:
        ixx, iyy, izz, ixy, ixz, iyz = inertia
        mass_properties = MassProperties(mass=mass, I_B=[[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])
    else:
        allowed = "6 (ixx, iyy, izz, ixy, ixz, iyz), or [0.0]: of the shape"
        raise InvalidFieldError("inertia", f"{len(inertia)} numbers", allowed)
    check_mass(mass_properties)
    check_place("center_of_mass", center_of_mass)
    shape_B = shape_F.moved(-center_of_mass)
    told = mass_properties if inertia != [0.0] and shape_B.is_polyhedron and not parts else None
    for part in shape_B.convex_parts:
        warn_if_concave(f"body.{name}.vertices", part.vertices, told, divided_faces=bool(parts))
    return Body(name=name, mass_properties=mass_properties, p_FB_F=center_of_mass, shape=shape_B)


def _read_parts(source: ParameterSource, key: str) -> list[ConvexShape]:
    """Return the further convex parts of a body, in its frame."""
    found = []
    for name in source.names(
        f"{key}.{PARTS}",
        "Names of further convex parts of the body, each with parameters of its own, such as "
        "body.<body>.<part>.box, for a body that is not convex.",
    ):
        part = f"{key}.{name}"
        shape_F = source.build(part, _read_shape(source, part).shape_F)
        if shape_F.is_empty:
            message = f"{part} must have a shape ({', '.join(_PRIMITIVES)}), got none"
            raise ConfigurationError(message)
        found.append(shape_F)
    return found


def _read_shape(source: ParameterSource, key: str) -> ShapeParameters:
    return ShapeParameters(
        numbers={name: source.value(f"{key}.{name}", [0.0], text) for name, text in DESCRIPTIONS.items()},
        rounding=source.value(
            f"{key}.rounding", 0.0, "Radius of a ball that rolls over the shape, m.", (0.0, 1e3)
        ),
        position=source.value(
            f"{key}.shape_position", [0.0, 0.0, 0.0], "Position of the shape in the body's frame, m: x, y, z."
        ),
        orientation=source.value(
            f"{key}.shape_orientation",
            _NOT_TURNED,
            "Orientation of the shape in the body's frame: unit quaternion x, y, z, w.",
        ),
    )


def read_surface(
    source: ParameterSource, name: str, *, among: Sequence[str]
) -> Surface | Obstacle | CarriedSurface:
    """Return a plane, an obstacle, or a plane that one of the configured bodies carries.

    Raise `ConfigurationError` if a parameter is missing or not allowed.
    """
    key, surface = f"surface.{name}", _read_surface(source, name)
    carrier = source.value(
        f"{key}.body",
        "",
        "Body that carries the plane. Point and normal are then in that body's frame. Empty means none.",
    )
    window = source.value(
        f"{key}.acceleration_window",
        ACCELERATION_WINDOW,
        "Time over which the acceleration of the body that carries the plane is estimated, s.",
        (0.0, 10.0),
    )

    def build() -> Surface | Obstacle | CarriedSurface:
        if not carrier:
            _check_unread(
                "unless a body carries the plane", acceleration_window=(window, ACCELERATION_WINDOW)
            )
            return surface
        if carrier not in among:
            raise InvalidFieldError("body", carrier, f"one of the bodies {list(among)}, or empty")
        if not isinstance(surface, Surface) or surface.moves:
            raise InvalidFieldError("body", carrier, "empty for an obstacle, a belt or a turntable")
        return CarriedSurface(body_name=carrier, surface=surface, acceleration_window=window)

    return source.build(key, build)


def _read_surface(source: ParameterSource, name: str) -> Surface | Obstacle:
    key = f"surface.{name}"
    point = source.value(
        f"{key}.point", [0.0, 0.0, 0.0], "A point of the plane, or the centre of the box, m, world: x, y, z."
    )
    normal = source.value(
        f"{key}.normal",
        _UP,
        "Unit normal of the plane, towards its free side, world axes: x, y, z.",
    )
    shape = ShapeParameters(
        numbers={
            "box": source.value(f"{key}.box", [0.0], "Full side lengths of a box, m: x, y, z."),
            "vertices": source.value(
                f"{key}.vertices",
                [0.0],
                "Corners of a convex solid or plate, relative to the point, m: x, y, z.",
            ),
        },
        rounding=0.0,
        position=point,
        orientation=source.value(
            f"{key}.orientation",
            _NOT_TURNED,
            "Orientation of the box or the corners: unit quaternion x, y, z, w.",
        ),
        pose_names=("point", "orientation"),
    )
    friction = source.value(f"{key}.friction", float, "Coefficient of Coulomb friction with any body, >= 0.")
    static_friction = source.value(
        f"{key}.static_friction",
        0.0,
        "Coefficient of static friction, >= friction, of bodies that stick. Zero: the same as friction.",
    )
    restitution = source.value(
        f"{key}.restitution", float, "Coefficient of restitution with any body, 0 to 1."
    )
    velocity = source.value(
        f"{key}.velocity",
        [0.0, 0.0, 0.0],
        "Velocity of a plane that moves in itself, such as a conveyor belt, m/s, world axes: x, y, z.",
    )
    rate = source.value(
        f"{key}.angular_velocity",
        0.0,
        "Angular velocity of a turntable about the normal through the point, rad/s, counterclockwise "
        "seen from the free side.",
    )
    lasting_factor = source.value(
        f"{key}.lasting_factor",
        1.0,
        "Factor of the friction coefficient for sustained contact in tosses, >= 0.",
    )
    lasting_speed = source.value(
        f"{key}.lasting_speed",
        0.0,
        "Approach speed, m/s, below which the friction coefficient of impacts in tosses changes linearly "
        "with the speed, from that of sustained contact at zero. Zero: no change.",
    )

    def build() -> Surface | Obstacle:
        check_friction("friction", friction)
        check_friction("static_friction", static_friction)
        static = check_static(static_friction or None, friction)
        check_friction("lasting_factor", lasting_factor * max(friction, 1.0))
        solid = shape.shape_F()
        if not solid.is_empty:
            for field, motion in (("velocity", any(velocity)), ("angular_velocity", rate)):
                if motion:
                    raise InvalidFieldError(field, "numbers", "zero for an obstacle, which is at rest")
            _check_unread(
                "for an obstacle",
                normal=(normal, _UP),
                lasting_factor=(lasting_factor, 1.0),
                lasting_speed=(lasting_speed, 0.0),
            )
            return Obstacle(
                name=name,
                vertices_W=solid.vertices,
                friction=friction,
                restitution=restitution,
                static_friction=static,
            )
        _check_unread("unless there is a box or vertices", orientation=(shape.orientation, _NOT_TURNED))
        check_place("point", check_array("point", point, (3,)))
        check_vector("velocity", check_array("velocity", velocity, (3,)))
        check_vector("angular_velocity", check_array("angular_velocity", [rate], (1,)))
        surface = Surface(
            name=name,
            p_WS_W=point,
            normal_W=normal,
            friction=friction,
            restitution=restitution,
            lasting_factor=lasting_factor,
            lasting_speed=lasting_speed,
            v_WS_W=velocity,
            static_friction=static,
        )
        if rate and any(velocity):
            raise InvalidFieldError("velocity", velocity, "zero for a turntable, which turns about its point")
        if not surface.is_steady:
            raise InvalidFieldError(
                "velocity", velocity, "along the plane, since a configured plane stays in place"
            )
        return replace(surface, w_WS_W=rate * surface.normal_W) if rate else surface

    return source.build(key, build)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Primitive:
    """A shape that is configured by numbers."""

    description: str  # description of the numbers
    # The check of each number, or None if there are three numbers for each corner
    checks: tuple[Check, ...] | None
    shape: ShapeMaker
    mass: MassMaker  # makes a mass, kg, that fills the shape evenly


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
        mass=lambda sizes, mass: (
            inertia.cylinder(radius=sizes[0], length=sizes[1], mass=mass)
            if sizes[1]
            else inertia.disc(radius=sizes[0], mass=mass)
        ),
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
"""The shapes, with descriptions of their numbers. The single number 0.0 means no shape."""

SHAPE_PARAMETERS: Final = (*DESCRIPTIONS, "rounding", "shape_position", "shape_orientation")
"""The parameters of a body, or of one of its parts, that describe its shape."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ShapeParameters:
    """The configured shape of a body or an obstacle. Lengths are in m."""

    numbers: dict[str, list[float]]  # the numbers of each shape in `DESCRIPTIONS`
    rounding: float  # radius of the ball that rolls over it
    position: list[float]  # position of the shape in the body's frame, or in the world
    orientation: list[float]  # unit quaternion x, y, z, w of the shape there
    # Names of the parameters for position and orientation
    pose_names: tuple[str, str] = ("shape_position", "shape_orientation")

    def shape_F(self) -> ConvexShape:
        """Return the shape in its frame, which is empty if none is configured.

        Raise `InvalidFieldError` if there are several shapes, or the numbers are not valid.
        """
        name = self._name()
        if not name:
            return NO_SHAPE
        shape = convex_shape.rounded(_PRIMITIVES[name].shape(self._values(name)), radius=self.rounding)
        return shape.moved(*self._pose())

    def uniform(self, mass: float) -> MassDistribution:
        """Return a mass, kg, that fills the shape evenly, in the body's frame.

        Raise `InvalidFieldError` if there is no shape, or a rounded one or one without volume.
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
            raise InvalidFieldError(name, f"{len(values)} numbers", f"{len(checks)} (or [0.0]: none)")
        numbers = [checks[i](f"{name}[{i}]", x) for i, x in enumerate(values)]
        for i, x in enumerate(numbers):
            if x > 0.0 and not 1.0 / MAX_IN_CONTACT <= x <= MAX_IN_CONTACT:
                allowed = f"a length from {1.0 / MAX_IN_CONTACT:g} m to {MAX_IN_CONTACT:g} m"
                raise InvalidFieldError(f"{name}[{i}]", f"{x:g} m", allowed)
        return check_array(name, numbers, (None,))
