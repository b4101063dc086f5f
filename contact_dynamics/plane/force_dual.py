# SPDX-License-Identifier: Apache-2.0
"""The force dual is lecture 26's picture of planar wrenches and accelerations.

Take the centre of mass as origin and the radius of gyration as unit of length. Then a wrench and the
acceleration that it causes are the same vector. Its projection is one point, which is the force dual of the
wrench and the acceleration centre (Mason, 5.8 and lecture 26). The point carries the sign of the moment. The
wrenches of a contact with Coulomb's friction are the positive combinations of the two edges of its cone.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarWrench, Vector2
from contact_dynamics.records import NamedInt


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


def friction_cone(contact: PlanarContact) -> tuple[PlanarWrench, PlanarWrench]:
    """Return the wrenches of unit normal force along the two edges of a contact's cone.

    The first pushes right, as on a contact that slides left, and the second pushes left.
    """
    return _edge(contact, contact.friction), _edge(contact, -contact.friction)


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
