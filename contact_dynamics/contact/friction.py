"""Coulomb's friction as cones of wrenches, and lecture 26's picture of wrenches and accelerations.

Model: a contact force f_n >= 0, |f_t| <= mu f_n. In the plane its wrenches are the positive combinations of
two edges; in space the round cone is replaced by a stated number of edges inside it.

Force dual (Mason, 5.8 and lecture 26): with the centre of mass as origin and the radius of gyration as unit
of length, a wrench and the acceleration that it causes are the same vector, so that its projection is one
point: the force dual of the wrench and the acceleration centre. The point carries the sign of the moment.
"""

from __future__ import annotations

import math
from enum import IntEnum
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.plane.types import PlanarWrench
from contact_dynamics.tolerances import ROW_TOLERANCE

if TYPE_CHECKING:
    from contact_dynamics.plane.types import PlanarBody, PlanarContact, Vector2
    from contact_dynamics.validation import FloatArray


MOST_FACETS: Final = 1000
"""Edges of a friction pyramid, which then leaves out 5e-6 of friction; far more would only take memory."""


class Turn(IntEnum):
    """The sign that a point of the oriented plane carries."""

    CLOCKWISE = -1
    NEITHER = 0
    """The point is at infinity, in the given direction: a pure force, or a translation."""
    ANTICLOCKWISE = 1


class OrientedPoint(NamedTuple):
    """A wrench or an acceleration up to a positive factor, as a point of the plane with a sign."""

    point: Vector2  # m, from the centre of mass; a unit direction where the point is at infinity
    turn: Turn


def friction_cone(contact: PlanarContact) -> tuple[PlanarWrench, PlanarWrench]:
    """Return the wrenches of unit normal force along the two edges of a contact's cone.

    First the one that pushes right (of a contact that slides left), then the one that pushes left.
    """
    return _edge(contact, contact.friction), _edge(contact, -contact.friction)


def _edge(contact: PlanarContact, slope: float) -> PlanarWrench:
    (n_x, n_y), (x, y) = contact.normal, contact.r
    f_x, f_y = n_x + slope * n_y, n_y - slope * n_x
    return PlanarWrench(f=(f_x, f_y), moment=x * f_y - y * f_x)


def force_dual(body: PlanarBody, wrench: PlanarWrench) -> OrientedPoint | None:
    """Return the force dual of a wrench, in m; None: no wrench (Mason, 5.8)."""
    return acceleration_centre(
        (wrench.f[0] / body.mass, wrench.f[1] / body.mass), wrench.moment / body.inertia
    )


def acceleration_centre(acceleration: Vector2, angular_acceleration: float) -> OrientedPoint | None:
    """Return the point of a body, at rest, that does not accelerate; None: all do not (lecture 26).

    Args:
        acceleration: m/s^2, of the centre of mass.
        angular_acceleration: rad/s^2.
    """
    a_x, a_y = acceleration
    size = math.hypot(a_x, a_y)
    if angular_acceleration == 0.0:
        return OrientedPoint((-a_y / size, a_x / size), Turn.NEITHER) if size > 0.0 else None
    point = (-a_y / angular_acceleration, a_x / angular_acceleration)
    return OrientedPoint(point, Turn.ANTICLOCKWISE if angular_acceleration > 0.0 else Turn.CLOCKWISE)


def linearised_cone(
    normal: FloatArray, friction: float, facets: int, *, towards: FloatArray | None = None
) -> FloatArray:
    """Return the edges, (facets, 3), of a pyramid inside the round friction cone about a unit normal, (3,).

    Each edge is the normal plus friction times a unit tangent; the tangents are evenly spread, so that the
    pyramid allows at least cos(pi / facets) of the cone's tangential force in every direction. The first edge
    leans towards ``towards``, (3,), if given.

    Raises:
        InvalidFieldError: fewer than 3 facets, more than `MOST_FACETS`, or no whole number of them.
    """
    if not isinstance(facets, (int, np.integer)) or not 3 <= facets <= MOST_FACETS:
        raise InvalidFieldError("friction_facets", facets, f"a whole number >= 3 and <= {MOST_FACETS}")
    one, two = tangents(normal, towards)
    angles = 2.0 * math.pi * np.arange(facets) / facets
    edges: FloatArray = normal + friction * (np.outer(np.cos(angles), one) + np.outer(np.sin(angles), two))
    return edges


def tangents(normal: FloatArray, towards: FloatArray | None = None) -> tuple[FloatArray, FloatArray]:
    """Return two unit tangents, (3,) each, that make a right-handed frame (one, two, normal).

    The first leans towards the direction ``towards``, (3,), unless that is along the normal or not given.
    """
    if towards is not None:
        one: FloatArray = towards - np.dot(towards, normal) * normal
        size = float(np.linalg.norm(one))
        if size > ROW_TOLERANCE * float(np.linalg.norm(towards)):
            one = one / size
            return one, np.cross(normal, one)
    least = np.zeros(3)
    least[int(np.abs(normal).argmin())] = 1.0
    one = np.cross(least, normal)
    one = one / np.linalg.norm(one)
    return one, np.cross(normal, one)
