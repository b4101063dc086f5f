# SPDX-License-Identifier: Apache-2.0
"""These types describe a planar body, its motion and its contacts (Mason, lectures 26 and 27).

Coordinates are those of the plane of motion, x and y, with the centre of mass as the origin of all positions.
A contact's tangent is its normal turned by -90 degrees: for normal (0, 1) it is +x. *Right* is positive
tangential, *left* negative. The cross product of r and f is r_x f_y - r_y f_x, so that a positive moment
turns x towards y.

Numbers are plain floats, because one planar answer is cheaper without arrays.

The force dual is lecture 26's picture of planar wrenches and accelerations. Take the centre of mass as origin
and the radius of gyration as unit of length. Then a wrench and the acceleration that it causes are the same
vector. Its projection is one point, which is the force dual of the wrench and the acceleration centre (Mason,
5.8 and lecture 26). The point carries the sign of the moment. The wrenches of a contact with Coulomb's
friction are the positive combinations of the two edges of its cone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, Final, NamedTuple, TypeAlias

from contact_dynamics.contact.contact import known_restitution
from contact_dynamics.contact.curvature import planar_gap_acceleration
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.records import NamedInt, Record
from contact_dynamics.tolerances import LARGEST_NUMBER, LENGTH_ROUNDING, UNIT_LENGTH_TOLERANCE
from contact_dynamics.validation import (
    check_finite,
    check_not_negative,
    check_positive,
    check_static,
    check_within,
)

Vector2: TypeAlias = tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PlanarBody(Record):
    """Mass and scalar angular inertia of a planar body.

    Attributes:
        mass: kg.
        inertia: kg m^2, about the centre of mass: m rho^2 with rho the radius of gyration.

    Raises:
        InvalidFieldError: a field is not > 0, not finite, above `LARGEST_NUMBER` or below its inverse.
    """

    mass: float
    inertia: float

    def __post_init__(self) -> None:
        """Check both fields."""
        object.__setattr__(self, "mass", _check_size("mass", check_positive("mass", self.mass)))
        object.__setattr__(self, "inertia", _check_size("inertia", check_positive("inertia", self.inertia)))

    @property
    def radius_of_gyration(self) -> float:
        """Return rho in I = m rho^2, m (lecture 25, eq. 13)."""
        return math.sqrt(self.inertia / self.mass)


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PlanarVelocity(Record):
    """Velocity of a planar body.

    Attributes:
        v: Velocity of the centre of mass, m/s.
        w: Angular velocity, rad/s, positive from x to y.

    Raises:
        InvalidFieldError: a number is not finite, or beyond `LARGEST_NUMBER`.
    """

    v: Vector2
    w: float

    def __post_init__(self) -> None:
        """Check both fields."""
        object.__setattr__(self, "v", check_vector2("v", self.v))
        object.__setattr__(self, "w", _check_number("w", self.w))


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PlanarWrench(Record):
    """Force and moment applied to a planar body, without those of its contacts.

    Attributes:
        f: Force, N.
        moment: Moment about the centre of mass, N m.

    Raises:
        InvalidFieldError: a number is not finite, or exceeds `LARGEST_NUMBER`.
    """

    f: Vector2
    moment: float = 0.0

    def __post_init__(self) -> None:
        """Check both fields."""
        object.__setattr__(self, "f", check_vector2("f", self.f))
        object.__setattr__(self, "moment", _check_number("moment", self.moment))


_FLAT: Final = 0.0
"""1/m, the curvature of a flat surface."""

_UNTURNED: Final = 0.0
"""rad/s, the angular velocity of a surface that is not given one."""

_NONE: Final = (0.0, 0.0)
"""The velocity and acceleration of a surface at rest."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PlanarContact(Record):
    """Contact of a planar body: a point of the body on a plane of the world, or two curved surfaces.

    If a plane of the body touches a corner of the world, use ``body_curvature=0`` and
    ``surface_curvature=math.inf``. For a disc of radius R on a floor, use ``body_curvature=1 / R``.
    `contact.curvature` describes the effect of curvatures.

    Attributes:
        r: Position of the contact relative to the centre of mass, m.
        normal: Unit normal into the body.
        friction: Coefficient of Coulomb friction, >= 0.
        restitution: Coefficient of restitution, in [0, 1], or None. Impacts require it; contact modes do not
            use it.
        body_curvature: Curvature of the body at the contact, 1/m, positive where convex, infinite at a
            corner.
        surface_curvature: Curvature of the surface at the contact, 1/m, positive where convex, infinite at a
            corner.
        surface_velocity: Velocity of the surface's material point at the contact, m/s.
        surface_angular_velocity: Angular velocity of the surface, rad/s, positive from x to y.
        surface_acceleration: Acceleration of the surface's material point at the contact, m/s^2, centripetal
            terms included.
        static_friction: Coefficient of static friction, >= ``friction``, which bounds the force of a contact
            that sticks. A contact that slides or begins to slide has ``friction``. None means the same.
            Impacts do not use it.
        surfaces_move: Whether velocity, angular velocity or acceleration of the surface is not zero.

    Raises:
        InvalidFieldError: a number is not finite, the normal is not a unit vector, the friction is negative,
            the static friction is below it, the restitution is outside [0, 1], or body and surface do not
            touch at a single point with one normal: the sum of curvatures is <= 0, or both are corners. Or a
            velocity or acceleration of the surface is beyond `LARGEST_NUMBER`.
    """

    r: Vector2
    normal: Vector2
    friction: float
    restitution: float | None = None
    body_curvature: float = math.inf
    surface_curvature: float = _FLAT
    surface_velocity: Vector2 = _NONE
    surface_angular_velocity: float = _UNTURNED
    surface_acceleration: Vector2 = _NONE
    static_friction: float | None = None
    surfaces_move: bool = field(init=False, repr=False, default=False)

    def __post_init__(self) -> None:
        """Check all fields and normalise the normal to rounding."""
        object.__setattr__(self, "r", check_vector2("r", self.r))
        n_x, n_y = check_vector2("normal", self.normal)
        # Not `hypot`, whose last bit NumPy's may not share: batches repeat this.
        length = math.sqrt(n_x * n_x + n_y * n_y)
        off = abs(length - 1.0)
        if off > UNIT_LENGTH_TOLERANCE:
            raise InvalidFieldError("normal", self.normal, "a unit vector")
        unit = (n_x / length, n_y / length) if off > LENGTH_ROUNDING else (n_x, n_y)
        object.__setattr__(self, "normal", unit)
        object.__setattr__(self, "friction", check_not_negative("friction", self.friction))
        if self.static_friction is not None:
            object.__setattr__(self, "static_friction", check_static(self.static_friction, self.friction))
        if self.restitution is not None:
            object.__setattr__(self, "restitution", check_within("restitution", self.restitution, 0.0, 1.0))
        if self.body_curvature is not math.inf or self.surface_curvature is not _FLAT:
            self._check_curvatures()
        if (
            self.surface_velocity is not _NONE
            or self.surface_acceleration is not _NONE
            or self.surface_angular_velocity is not _UNTURNED
        ):
            self._check_motion()

    @property
    def holding_friction(self) -> float:
        """Coefficient of friction that bounds the force of a contact that sticks."""
        return self.friction if self.static_friction is None else self.static_friction

    @property
    def impact_restitution(self) -> float:
        """Return the coefficient of restitution, or raise `InvalidFieldError` if there is none."""
        return known_restitution(self.restitution)

    def _check_curvatures(self) -> None:
        for name in ("body_curvature", "surface_curvature"):
            value = getattr(self, name)
            corner = isinstance(value, float) and value == math.inf
            object.__setattr__(self, name, math.inf if corner else check_finite(name, value))
        one, other = self.body_curvature, self.surface_curvature
        if (one == math.inf and other == math.inf) or not one + other > 0.0:
            raise InvalidFieldError(
                "body_curvature, surface_curvature",
                f"{one} of the body, {other} of the surface, 1/m",
                "a sum > 0, and at most one corner",
            )

    def _check_motion(self) -> None:
        v = check_vector2("surface_velocity", self.surface_velocity)
        w = _check_number("surface_angular_velocity", self.surface_angular_velocity)
        a = check_vector2("surface_acceleration", self.surface_acceleration)
        object.__setattr__(self, "surface_velocity", v)
        object.__setattr__(self, "surface_angular_velocity", w)
        object.__setattr__(self, "surface_acceleration", a)
        object.__setattr__(self, "surfaces_move", (*v, w, *a) != (0.0,) * 5)

    def gap_acceleration(self, v_t: float, w: float) -> float:
        """Return the gap's second derivative less the contact point's a_n, m/s^2.

        It depends on the tangential velocity, m/s, of the body's point at the contact, and on the angular
        velocity, rad/s.
        """
        if self.body_curvature == math.inf and self.surface_curvature == 0.0:
            return 0.0
        return planar_gap_acceleration(self.body_curvature, self.surface_curvature, v_t=v_t, w=w)

    def reach(self, rho: float) -> float:
        """Return the length, m, by which an angular velocity counts at the contact.

        ``rho`` is the radius of gyration, m. Where sides are curved the body does not turn about the contact
        point itself, and a corner slides along it.
        """
        if self.body_curvature == math.inf and self.surface_curvature == 0.0:
            return math.hypot(*self.r)
        return math.hypot(*self.r) + rho + 1.0 / (self.body_curvature + self.surface_curvature)

    @property
    def tangent(self) -> Vector2:
        """Return the unit tangent: the normal rotated by -90 degrees."""
        n_x, n_y = self.normal
        return (n_y, -n_x)


def check_vector2(field: str, value: Vector2) -> Vector2:
    """Return ``value`` as a pair of floats up to `LARGEST_NUMBER`, or raise `InvalidFieldError`."""
    try:
        x, y = value
    except (TypeError, ValueError, OverflowError):
        raise InvalidFieldError(field, value, "two finite numbers") from None
    # The common case comes first. NaN compares as false.
    if type(x) is float and type(y) is float and abs(x) + abs(y) <= LARGEST_NUMBER:
        return (x, y)
    return (_check_number(field, x), _check_number(field, y))


def _check_number(field: str, value: Any) -> float:
    number = check_finite(field, value)
    if abs(number) > LARGEST_NUMBER:
        raise InvalidFieldError(field, value, f"at most {LARGEST_NUMBER:g} in magnitude")
    return number


def _check_size(field: str, value: float) -> float:
    if not 1.0 / LARGEST_NUMBER <= value <= LARGEST_NUMBER:
        raise InvalidFieldError(field, value, f"in [{1.0 / LARGEST_NUMBER:g}, {LARGEST_NUMBER:g}]")
    return value


class Turn(NamedInt):
    """The sign that a point of the oriented plane carries."""

    CLOCKWISE = -1
    NEITHER = 0
    """The point is at infinity in the given direction. This is a pure force, or a translation."""
    ANTICLOCKWISE = 1


class OrientedPoint(NamedTuple):
    """A wrench or an acceleration up to a positive factor, as a point of the plane with a sign."""

    point: Vector2  # Position from the centre of mass, m, or a unit direction where the point is at infinity
    turn: Turn


def friction_cone(contact: PlanarContact, *, sticks: bool = False) -> tuple[PlanarWrench, PlanarWrench]:
    """Return the wrenches of unit normal force along the two edges of a contact's cone.

    The first pushes right, as on a contact that slides left, and the second pushes left. The cone is that of
    static friction if the contact ``sticks``.
    """
    friction = contact.holding_friction if sticks else contact.friction
    return _edge(contact, friction), _edge(contact, -friction)


def _edge(contact: PlanarContact, slope: float) -> PlanarWrench:
    (n_x, n_y), (x, y) = contact.normal, contact.r
    f_x, f_y = n_x + slope * n_y, n_y - slope * n_x
    return PlanarWrench(f=(f_x, f_y), moment=x * f_y - y * f_x)


def force_dual(body: PlanarBody, wrench: PlanarWrench) -> OrientedPoint | None:
    """Return the force dual of a wrench, in m, or None for a zero wrench (Mason, 5.8)."""
    return acceleration_centre(
        (wrench.f[0] / body.mass, wrench.f[1] / body.mass), wrench.moment / body.inertia
    )


def acceleration_centre(acceleration: Vector2, angular_acceleration: float) -> OrientedPoint | None:
    """Return the point of a body at rest that does not accelerate, or None if no point does (lecture 26).

    The centre of mass has the acceleration, m/s^2, and the body the angular one, rad/s^2.
    """
    a_x, a_y = acceleration
    size = math.hypot(a_x, a_y)
    if angular_acceleration == 0.0:
        return OrientedPoint((-a_y / size, a_x / size), Turn.NEITHER) if size > 0.0 else None
    point = (-a_y / angular_acceleration, a_x / angular_acceleration)
    return OrientedPoint(point, Turn.ANTICLOCKWISE if angular_acceleration > 0.0 else Turn.CLOCKWISE)
