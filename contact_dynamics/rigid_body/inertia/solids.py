# SPDX-License-Identifier: Apache-2.0
"""Solids, sheets and wires of uniform density have mass properties in closed form.

Each has axes of its own. An axis of symmetry is z. The origin is the centre. If the two ends of the axis
differ (cone, hemisphere), the origin is the centre of the base, and the solid is on the side of +z.
`MassDistribution.placed` moves it anywhere. Lengths are in m. Give either ``mass``, kg, or ``density``,
kg/m^3 for a solid, kg/m^2 for a sheet and kg/m for a wire.

Sheets and wires have no thickness. A `rod` has no inertia about its own axis, so it can be a part of a body
but not a body.

All raise `InvalidFieldError` if a length is not > 0, or if not exactly one of mass and density is given.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.rigid_body.inertia.distribution import MassDistribution
from contact_dynamics.tolerances import LARGEST_NUMBER
from contact_dynamics.validation import check_array, check_sides, check_within

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


def box(
    size: ArrayLike,
    y: float | None = None,
    z: float | None = None,
    *,
    mass: float | None = None,
    density: float | None = None,
) -> MassDistribution:
    """Return a box of full side lengths along x, y, z, about its centre: one (3,) or three numbers."""
    a, b, c = _lengths("size", check_sides(size, y, z))
    total = mass_of(a * b * c, mass=mass, density=density)
    return centered(total, (a * a / 12.0, b * b / 12.0, c * c / 12.0))


def sphere(radius: float, *, mass: float | None = None, density: float | None = None) -> MassDistribution:
    """Return a ball about its centre."""
    r = check_length("radius", radius)
    return ellipsoid(semi_axes=(r, r, r), mass=mass, density=density)


def hollow_sphere(
    *, outer_radius: float, inner_radius: float, mass: float | None = None, density: float | None = None
) -> MassDistribution:
    """Return a ball with a concentric hollow. `spherical_shell` is a thin one."""
    R, r = _wall(outer_radius, inner_radius)
    squares = R * R + R * r + r * r
    total = mass_of(4.0 / 3.0 * math.pi * (R - r) * squares, mass=mass, density=density)
    # (R^5 - r^5) / (R^3 - r^3), without the cancellation of thin walls
    second = (R**4 + R**3 * r + R * R * r * r + R * r**3 + r**4) / (5.0 * squares)
    return centered(total, (second, second, second))


def ellipsoid(
    semi_axes: ArrayLike, *, mass: float | None = None, density: float | None = None
) -> MassDistribution:
    """Return an ellipsoid of semi-axes (3,) along x, y, z, about its centre."""
    a, b, c = _lengths("semi_axes", semi_axes)
    total = mass_of(4.0 / 3.0 * math.pi * a * b * c, mass=mass, density=density)
    return centered(total, (a * a / 5.0, b * b / 5.0, c * c / 5.0))


def hemisphere(radius: float, *, mass: float | None = None, density: float | None = None) -> MassDistribution:
    """Return half a ball. Its flat face is in z = 0, centred, and its dome is towards +z."""
    r = check_length("radius", radius)
    total = mass_of(2.0 / 3.0 * math.pi * r**3, mass=mass, density=density)
    return centered(total, (r * r / 5.0, r * r / 5.0, 19.0 / 320.0 * r * r), height=0.375 * r)


def cylinder(
    radius: float, length: float, *, mass: float | None = None, density: float | None = None
) -> MassDistribution:
    """Return a circular cylinder along z, about its centre."""
    return _tube(check_length("radius", radius), 0.0, length, mass, density)


def tube(
    *,
    outer_radius: float,
    inner_radius: float,
    length: float,
    mass: float | None = None,
    density: float | None = None,
) -> MassDistribution:
    """Return a cylinder with a concentric bore, along z, about its centre. `cylindrical_shell` is thin."""
    return _tube(*_wall(outer_radius, inner_radius), length, mass, density)


def capsule(
    radius: float, length: float, *, mass: float | None = None, density: float | None = None
) -> MassDistribution:
    """Return a cylinder of ``length`` >= 0 along z with a half ball on each end, about its centre."""
    r, h = check_length("radius", radius), check_length_or_none("length", length)
    middle, ends = h, 4.0 / 3.0 * r  # volumes over pi r^2
    total = mass_of(math.pi * r * r * (middle + ends), mass=mass, density=density)
    middle, ends = middle / (middle + ends), ends / (middle + ends)
    across = middle * r * r / 4.0 + ends * r * r / 5.0
    along = middle * h * h / 12.0 + ends * (r * r / 5.0 + 0.375 * r * h + h * h / 4.0)
    return centered(total, (across, across, along))


def cone(
    radius: float,
    height: float,
    top_radius: float = 0.0,
    *,
    mass: float | None = None,
    density: float | None = None,
) -> MassDistribution:
    """Return a circular cone, or a frustum. Its base is in z = 0, centred, and its top is at z = height.

    A pointed cone's centre of mass is at a quarter of its height.
    """
    r, t = check_length("radius", radius), check_length_or_none("top_radius", top_radius)
    h = check_length("height", height)
    squares = r * r + r * t + t * t
    total = mass_of(math.pi / 3.0 * h * squares, mass=mass, density=density)
    across = 0.15 * (r**4 + r**3 * t + r * r * t * t + r * t**3 + t**4) / squares
    along = (
        0.0375 * h * h * (r**4 + 4.0 * r**3 * t + 10.0 * r * r * t * t + 4.0 * r * t**3 + t**4) / squares**2
    )
    return centered(
        total, (across, across, along), height=0.25 * h * (r * r + 2.0 * r * t + 3.0 * t * t) / squares
    )


def torus(
    *, ring_radius: float, tube_radius: float, mass: float | None = None, density: float | None = None
) -> MassDistribution:
    """Return a torus around z: ``ring_radius`` to the middle of its tube, at least ``tube_radius``."""
    R, a = check_length("ring_radius", ring_radius), check_length("tube_radius", tube_radius)
    if a > R:
        raise InvalidFieldError("tube_radius", a, f"at most the ring_radius, {R:g}")
    total = mass_of(2.0 * math.pi**2 * R * a * a, mass=mass, density=density)
    across = R * R / 2.0 + 0.375 * a * a
    return centered(total, (across, across, a * a / 4.0))


def centered(mass: float, spread: tuple[float, float, float], *, height: float = 0.0) -> MassDistribution:
    """Return a mass with principal axes x, y, z and its centre at that height on z.

    ``spread``: the mean of x^2, y^2, z^2 over the mass, m^2, about its centre.
    """
    xx, yy, zz = spread
    return MassDistribution(
        mass=mass,
        p_FB_F=np.array([0.0, 0.0, height]),
        I_B=mass * np.diag([yy + zz, xx + zz, xx + yy]),
    )


def _tube(R: float, r: float, length: float, mass: float | None, density: float | None) -> MassDistribution:
    h = check_length("length", length)
    total = mass_of(math.pi * (R - r) * (R + r) * h, mass=mass, density=density)
    across = (R * R + r * r) / 4.0
    return centered(total, (across, across, h * h / 12.0))


def _wall(outer_radius: float, inner_radius: float) -> tuple[float, float]:
    R, r = check_length("outer_radius", outer_radius), check_length_or_none("inner_radius", inner_radius)
    if r >= R:
        raise InvalidFieldError("inner_radius", r, f"less than the outer_radius, {R:g}")
    return R, r


def _lengths(field: str, value: ArrayLike) -> tuple[float, float, float]:
    x, y, z = check_array(field, value, (3,)).tolist()
    if min(x, y, z) <= 0.0:
        raise InvalidFieldError(field, [x, y, z], "three numbers > 0")
    return check_length(field, x), check_length(field, y), check_length(field, z)


def check_length(field: str, value: object) -> float:
    """Return a length of a shape, m, between the inverse of `LARGEST_NUMBER` and that number."""
    return check_within(field, value, 1.0 / LARGEST_NUMBER, LARGEST_NUMBER)


def check_length_or_none(field: str, value: object) -> float:
    """Return a length of a shape, m, which may be zero."""
    return check_within(field, value, 0.0, LARGEST_NUMBER)


def mass_of(measure: float, *, mass: float | None, density: float | None) -> float:
    """Return the mass, kg, of a shape of that volume, area or length, from a mass or from a density."""
    if (mass is None) == (density is None):
        found = "neither" if mass is None else "both"
        raise InvalidFieldError("mass or density", found, "given, and not both")
    if density is None:
        return check_within("mass", mass, 1.0 / LARGEST_NUMBER, LARGEST_NUMBER)
    return check_within("density", density, 1.0 / LARGEST_NUMBER, LARGEST_NUMBER) * measure


def rod(length: float, *, mass: float | None = None, density: float | None = None) -> MassDistribution:
    """Return a straight wire along z; density in kg/m."""
    h = check_length("length", length)
    return centered(mass_of(h, mass=mass, density=density), (0.0, 0.0, h * h / 12.0))


def ring(radius: float, *, mass: float | None = None, density: float | None = None) -> MassDistribution:
    """Return a circle of wire about z; density in kg/m."""
    r = check_length("radius", radius)
    total = mass_of(2.0 * math.pi * r, mass=mass, density=density)
    return centered(total, (r * r / 2.0, r * r / 2.0, 0.0))


def plate(size: ArrayLike, *, mass: float | None = None, density: float | None = None) -> MassDistribution:
    """Return a rectangular sheet of full side lengths (2,) along x, y, normal to z; density in kg/m^2."""
    x, y = check_array("size", size, (2,)).tolist()
    if min(x, y) <= 0.0:
        raise InvalidFieldError("size", [x, y], "two numbers > 0")
    x, y = check_length("size", x), check_length("size", y)
    total = mass_of(x * y, mass=mass, density=density)
    return centered(total, (x * x / 12.0, y * y / 12.0, 0.0))


def disc(radius: float, *, mass: float | None = None, density: float | None = None) -> MassDistribution:
    """Return a circular sheet, normal to z; density in kg/m^2."""
    r = check_length("radius", radius)
    total = mass_of(math.pi * r * r, mass=mass, density=density)
    return centered(total, (r * r / 4.0, r * r / 4.0, 0.0))


def spherical_shell(
    radius: float, *, mass: float | None = None, density: float | None = None
) -> MassDistribution:
    """Return a sphere's surface; density in kg/m^2."""
    r = check_length("radius", radius)
    total = mass_of(4.0 * math.pi * r * r, mass=mass, density=density)
    return centered(total, (r * r / 3.0, r * r / 3.0, r * r / 3.0))


def cylindrical_shell(
    radius: float, length: float, *, mass: float | None = None, density: float | None = None
) -> MassDistribution:
    """Return a cylinder's curved surface, open at both ends, along z; density in kg/m^2."""
    r, h = check_length("radius", radius), check_length("length", length)
    total = mass_of(2.0 * math.pi * r * h, mass=mass, density=density)
    return centered(total, (r * r / 2.0, r * r / 2.0, h * h / 12.0))
