"""How a contact in space responds to an impulse, and what an impulse does to a body.

Contact axes are two tangents and the normal. The tangents are the principal ones of the tangential block of
the inverse inertia, as the sliding equations need them (`path`). Everything is written by component,
so that the same lines serve one case and many (`elementwise`).

The inverse inertia of a pair of bodies is the sum of both, because their impulses are opposite, and so are
their shares of the relative velocity.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from contact_dynamics.numerics.elementwise import Number, larger, sign, sqrt
from contact_dynamics.numerics.vectors import combined, cross, dot, tangents_by_sign
from contact_dynamics.rotations.one import rows_of
from contact_dynamics.tolerances import LEAST_PIVOT, SMALLEST

if TYPE_CHECKING:
    from collections.abc import Sequence

Vector3: TypeAlias = "tuple[Number, Number, Number]"


class Responding(NamedTuple):
    """A body at a contact, with everything that its change of velocity follows from, world axes.

    Attributes:
        per_mass: 1/kg, one over the mass.
        inertia: kg m^2, body axes, factored as I = L D L^T. It holds the pivots d1, d2, d3 of D, then l21,
            l31, l32 of L, which have no unit.
        rotation: The body's axes in the world, which are the columns of R_WB.
        r: m, from the centre of mass to the contact.
        v: m/s, of the centre of mass.
        w: rad/s, angular velocity.
    """

    per_mass: Number
    inertia: tuple[Number, ...]
    rotation: tuple[Vector3, Vector3, Vector3]
    r: Vector3
    v: Vector3
    w: Vector3


class Response(NamedTuple):
    """Inverse inertia in axes a, b, n, 1/kg: changes of velocity along one axis per impulse along another."""

    aa: Number
    ab: Number
    an: Number
    bb: Number
    bn: Number
    nn: Number


class ContactAxes(NamedTuple):
    """The principal tangents and the normal, world axes, with the response in them.

    Attributes:
        t1: The first tangent, unit.
        t2: The second tangent, unit.
        n: The normal, unit.
        l1: 1/kg, response along the first tangent to an impulse along it.
        l2: 1/kg, response along the second tangent to an impulse along it.
        k1: 1/kg, coupling between the first tangent and the normal.
        k2: 1/kg, coupling between the second tangent and the normal.
        kn: 1/kg, response along the normal to an impulse along it.
    """

    t1: Vector3
    t2: Vector3
    n: Vector3
    l1: Number
    l2: Number
    k1: Number
    k2: Number
    kn: Number

    def components(self, vector: Vector3) -> Vector3:
        """Return the contact components of a vector in world axes."""
        return (dot(self.t1, vector), dot(self.t2, vector), dot(self.n, vector))

    def in_world(self, components: Vector3) -> Vector3:
        """Return the vector in world axes that has these contact components."""
        x, y, z = combined(components[0], self.t1, components[1], self.t2)
        n, p = self.n, components[2]
        return (x + p * n[0], y + p * n[1], z + p * n[2])


def responding(  # noqa: PLR0917 - the columns of one table
    mass: Number, inertia: Sequence[Sequence[Number]], q: Sequence[Number], r: Vector3, v: Vector3, w: Vector3
) -> Responding:
    """Return a body for the contact at ``r``.

    Args:
        mass: kg.
        inertia: (3, 3), kg m^2, body axes.
        q: Unit quaternion x, y, z, w, body coordinates into world coordinates.
        r: m, from the centre of mass to the contact, world axes.
        v: m/s, of the centre of mass, world axes.
        w: rad/s, world axes.
    """
    (i_xx, i_xy, i_xz), (i_yx, i_yy, i_yz), (i_zx, i_zy, i_zz) = inertia
    i_xy, i_xz, i_yz = 0.5 * (i_xy + i_yx), 0.5 * (i_xz + i_zx), 0.5 * (i_yz + i_zy)
    l21, l31 = i_xy / i_xx, i_xz / i_xx
    d2 = larger(i_yy - l21 * i_xy, LEAST_PIVOT * i_yy)
    rest = i_yz - l31 * i_xy
    l32 = rest / d2
    d3 = larger(i_zz - l31 * i_xz - l32 * rest, LEAST_PIVOT * i_zz)
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rows_of(*q)
    columns = ((xx, yx, zx), (xy, yy, zy), (xz, yz, zz))
    return Responding(1.0 / mass, (i_xx, d2, d3, l21, l31, l32), columns, r, v, w)


def velocity_at_contact(body: Responding, other: Responding | None) -> Vector3:
    """Return v + w x r of ``body``, relative to ``other`` if there is one, m/s, world axes."""
    turning = cross(body.w, body.r)
    velocity = (body.v[0] + turning[0], body.v[1] + turning[1], body.v[2] + turning[2])
    if other is None:
        return velocity
    x, y, z = velocity_at_contact(other, None)
    return (velocity[0] - x, velocity[1] - y, velocity[2] - z)


def response(body: Responding, a: Vector3, b: Vector3, n: Vector3) -> Response:
    """Return the inverse inertia in axes ``a``, ``b``, ``n`` (lecture 27, eq. 7, by components)."""
    d1, d2, d3, l21, l31, l32 = body.inertia
    halves = []
    for axis in (a, b, n):
        x, y, z = _in_body(body, cross(body.r, axis))
        y = y - l21 * x
        halves.append((x, y, z - l31 * x - l32 * y))
    (a1, a2, a3), (b1, b2, b3), (n1, n2, n3) = halves
    return Response(
        body.per_mass + (a1 * a1 / d1 + a2 * a2 / d2 + a3 * a3 / d3),
        a1 * b1 / d1 + a2 * b2 / d2 + a3 * b3 / d3,
        a1 * n1 / d1 + a2 * n2 / d2 + a3 * n3 / d3,
        body.per_mass + (b1 * b1 / d1 + b2 * b2 / d2 + b3 * b3 / d3),
        b1 * n1 / d1 + b2 * n2 / d2 + b3 * n3 / d3,
        body.per_mass + (n1 * n1 / d1 + n2 * n2 / d2 + n3 * n3 / d3),
    )


def contact_axes(body: Responding, other: Responding | None, normal: Vector3) -> ContactAxes:
    """Return the contact's axes and response, of ``body`` against the fixed world or against ``other``."""
    a, b = tangents_by_sign(normal)
    whole = response(body, a, b, normal)
    if other is not None:
        second = response(other, a, b, normal)
        whole = Response(*(x + y for x, y in zip(whole, second, strict=True)))
    aa, ab, an, bb, bn, nn = whole
    # Jacobi's rotation by the smaller angle.
    difference = bb - aa
    root = sqrt(difference * difference + 4.0 * ab * ab)
    tangent = sign(difference) * (2.0 * ab) / (abs(difference) + root + SMALLEST)
    c = 1.0 / sqrt(1.0 + tangent * tangent)
    s = tangent * c
    return ContactAxes(
        t1=combined(c, a, -s, b),
        t2=combined(s, a, c, b),
        n=normal,
        l1=aa - tangent * ab,
        l2=bb + tangent * ab,
        k1=c * an - s * bn,
        k2=s * an + c * bn,
        kn=nn,
    )


def pushed(body: Responding, impulse: Vector3) -> tuple[Vector3, Vector3]:
    """Return the body's linear and angular velocity, world axes, after an ``impulse`` at the contact, N s."""
    v, w, per_mass = body.v, body.w, body.per_mass
    d1, d2, d3, l21, l31, l32 = body.inertia
    x, y, z = _in_body(body, cross(body.r, impulse))
    y = y - l21 * x
    z = (z - l31 * x - l32 * y) / d3
    y = y / d2 - l32 * z
    x = x / d1 - l21 * y - l31 * z
    e_x, e_y, e_z = body.rotation
    return (
        (v[0] + per_mass * impulse[0], v[1] + per_mass * impulse[1], v[2] + per_mass * impulse[2]),
        (
            w[0] + (e_x[0] * x + e_y[0] * y + e_z[0] * z),
            w[1] + (e_x[1] * x + e_y[1] * y + e_z[1] * z),
            w[2] + (e_x[2] * x + e_y[2] * y + e_z[2] * z),
        ),
    )


def _in_body(body: Responding, vector: Vector3) -> Vector3:
    e_x, e_y, e_z = body.rotation
    return (dot(e_x, vector), dot(e_y, vector), dot(e_z, vector))
