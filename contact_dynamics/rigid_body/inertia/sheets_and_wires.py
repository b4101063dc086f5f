# SPDX-License-Identifier: Apache-2.0
"""Sheets and wires of no thickness have mass properties in closed form.

Axes are those of the solids: an axis of symmetry is z, and the origin is the centre. Lengths are in m. Give
either ``mass``, kg, or ``density``, kg/m^2 for a sheet and kg/m for a wire.

A `rod` has no inertia about its own axis, so it can be a part of a body but not a body.

All raise `InvalidFieldError` if a length is not > 0, or if not exactly one of mass and density is given.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.rigid_body.inertia.mass_or_density import check_length, mass_of
from contact_dynamics.rigid_body.inertia.solids import centered
from contact_dynamics.validation import check_array

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from contact_dynamics.rigid_body.inertia.distribution import MassDistribution


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
