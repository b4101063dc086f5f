# SPDX-License-Identifier: Apache-2.0
"""One impact at a contact in space: how the contact responds to impulses, and what they do to the bodies.

Contact axes are two tangents and the normal. The tangents are the principal ones of the tangential block of
the inverse inertia, as the sliding equations need them (`path`). The inverse inertia of a pair of bodies is
the sum of both, because their impulses are opposite, and so are their shares of the relative velocity.

`response.pxd` gives the C types with which this file compiles, as `path.pxd` does for the path.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final, NoReturn

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.impact.law import ImpactOutcome, PathEvent, RestitutionLaw
from contact_dynamics.impact.planar.one_contact import refuse_separating
from contact_dynamics.impact.spatial.path import RULES, Progress, SlidingLaw, Tracer
from contact_dynamics.tolerances import (
    LARGEST_ARM,
    LARGEST_NUMBER,
    LEAST_PIVOT,
    SINGULAR_RESPONSE,
    SMALLEST,
    SYMMETRY_TOLERANCE,
)

if TYPE_CHECKING:
    from contact_dynamics.numerics.vectors import Vector3

Inertia = tuple[float, ...]  # nine, row by row
Quaternion = tuple[float, float, float, float]
Response = tuple[float, float, float, float, float, float]

LEAST_NUMBER: Final = 1.0 / LARGEST_NUMBER

# Stand for outcomes where there is none. The first is that of `path`.
_NOT_ENDED: Final = -1
_SEPARATES: Final = -2
_NO_RESPONSE: Final = -3
_NOT_POSITIVE: Final = -4
_NOT_SYMMETRIC: Final = -5
_NO_IMPULSE: Final = ImpactOutcome.NO_IMPULSE


def refuse(strike: Strike, outcome: int, tolerance: float, case: str = "", field: str = "") -> NoReturn:
    """Raise the error of a strike without an outcome.

    Args:
        strike: The strike.
        outcome: What it returned, below 0.
        tolerance: m/s.
        case: The words of an error for which strike of several it is.
        field: The name of a mechanism's inverse inertia in an error.

    Raises:
        SeparatingContactError: the contact's normal velocity is above the tolerance, m/s.
        InvalidFieldError: a mechanism's inverse inertia is not positive semidefinite, does not let the
            contact move along the normal, or wedges it.
    """
    if outcome == _SEPARATES:
        refuse_separating(strike.v_n, tolerance, case)
    if not field:
        raise AssertionError  # each stretch of a body's path turns or slows the sliding by a fixed part
    found, allowed = {
        _NOT_ENDED: (
            "a mechanism that wedges: no impulse separates this contact once it sticks",
            "one whose contact can separate (or restitution 0 or POISSON, if it only has to stop)",
        ),
        _NO_RESPONSE: (
            f"{strike.kn:g} 1/kg along the normal",
            f"at least {LEAST_NUMBER:g} 1/kg along the normal, where the mechanism must be able to move",
        ),
        _NOT_SYMMETRIC: ("an asymmetric matrix", "symmetric, as J M^-1 J^T is"),
        _NOT_POSITIVE: ("a matrix with a negative eigenvalue", "positive semidefinite, as J M^-1 J^T is"),
    }[outcome]
    raise InvalidFieldError(field, found, allowed)


class BodyAtContact:
    """A body at a contact, with everything that its change of velocity follows from, world axes.

    Its inertia, kg m^2, body axes, is factored as I = L D L^T.
    """

    def __init__(self) -> None:
        self.per_mass = 0.0  # 1/kg
        self.d1 = self.d2 = self.d3 = 0.0  # the pivots D
        self.l21 = self.l31 = self.l32 = 0.0  # of L, without unit
        # The body's axes in the world; from the centre of mass to the contact; velocities.
        self.e_x = self.e_y = self.e_z = self.r = self.v = self.w = (0.0, 0.0, 0.0)

    def take(  # noqa: PLR0917
        self, mass: float, inertia: Inertia, q: Quaternion, r: Vector3, v: Vector3, w: Vector3
    ) -> bool:
        """Take the numbers of a body, and return whether their products stay in the range of doubles.

        Args:
            mass: kg.
            inertia: The nine numbers of a (3, 3), kg m^2, body axes.
            q: Unit quaternion x, y, z, w, body coordinates into world coordinates.
            r: m, from the centre of mass to the contact, world axes.
            v: m/s, of the centre of mass, world axes.
            w: rad/s, world axes.
        """
        i_xx, i_yy, i_zz = inertia[0], inertia[4], inertia[8]
        i_xy, i_xz = 0.5 * (inertia[1] + inertia[3]), 0.5 * (inertia[2] + inertia[6])
        i_yz = 0.5 * (inertia[5] + inertia[7])
        self.per_mass = 1.0 / mass
        self.d1, self.l21, self.l31 = i_xx, i_xy / i_xx, i_xz / i_xx
        self.d2 = max(i_yy - self.l21 * i_xy, LEAST_PIVOT * i_yy)
        rest = i_yz - self.l31 * i_xy
        self.l32 = rest / self.d2
        self.d3 = max(i_zz - self.l31 * i_xz - self.l32 * rest, LEAST_PIVOT * i_zz)
        a, b, c, d = q[0], q[1], q[2], q[3]
        self.e_x = (1.0 - 2.0 * (b * b + c * c), 2.0 * (a * b + d * c), 2.0 * (a * c - d * b))
        self.e_y = (2.0 * (a * b - d * c), 1.0 - 2.0 * (a * a + c * c), 2.0 * (b * c + d * a))
        self.e_z = (2.0 * (a * c + d * b), 2.0 * (b * c - d * a), 1.0 - 2.0 * (a * a + b * b))
        self.r, self.v, self.w = r, v, w
        largest = max(i_xx, i_yy, i_zz)
        return (
            LEAST_NUMBER <= mass <= LARGEST_NUMBER
            and LEAST_NUMBER <= largest <= LARGEST_NUMBER
            and is_small(r)
            and is_small(v)
            and is_small(w)
            and dot(r, r) <= LARGEST_ARM * LARGEST_ARM * (largest / mass)
        )

    def velocity(self) -> Vector3:
        """Return the velocity of the contact point, v + w x r, m/s, world axes."""
        turning = cross(self.w, self.r)
        return (self.v[0] + turning[0], self.v[1] + turning[1], self.v[2] + turning[2])

    def half_turned(self, axis: Vector3) -> Vector3:
        """Return L^-1 of the moment, body axes, of a unit impulse along ``axis``."""
        moment = cross(self.r, axis)
        x, y, z = dot(self.e_x, moment), dot(self.e_y, moment), dot(self.e_z, moment)
        y = y - self.l21 * x
        return (x, y, z - self.l31 * x - self.l32 * y)

    def coupled(self, a: Vector3, b: Vector3) -> float:
        """Return the turning that two impulses share, 1/kg, from their moments by `half_turned`."""
        return a[0] * b[0] / self.d1 + a[1] * b[1] / self.d2 + a[2] * b[2] / self.d3

    def response(self, a: Vector3, b: Vector3, n: Vector3) -> Response:
        """Return the inverse inertia in axes a, b, n, 1/kg: aa, ab, an, bb, bn, nn (lecture 27, eq. 7)."""
        a, b, n = self.half_turned(a), self.half_turned(b), self.half_turned(n)
        return (
            self.per_mass + self.coupled(a, a),
            self.coupled(a, b),
            self.coupled(a, n),
            self.per_mass + self.coupled(b, b),
            self.coupled(b, n),
            self.per_mass + self.coupled(n, n),
        )

    def push(self, impulse: Vector3) -> None:
        """Change the velocities as an impulse at the contact does, N s, world axes."""
        half = self.half_turned(impulse)
        z = half[2] / self.d3
        y = half[1] / self.d2 - self.l32 * z
        x = half[0] / self.d1 - self.l21 * y - self.l31 * z
        self.v = (
            self.v[0] + self.per_mass * impulse[0],
            self.v[1] + self.per_mass * impulse[1],
            self.v[2] + self.per_mass * impulse[2],
        )
        self.w = (
            self.w[0] + (self.e_x[0] * x + self.e_y[0] * y + self.e_z[0] * z),
            self.w[1] + (self.e_x[1] * x + self.e_y[1] * y + self.e_z[1] * z),
            self.w[2] + (self.e_x[2] * x + self.e_y[2] * y + self.e_z[2] * z),
        )


class Strike:
    """One impact after the other, at one contact each.

    What strikes is a body, two bodies, or a mechanism that is known by its inverse inertia alone.

    Attributes:
        body: The body that the normal points into. After a strike it has its new velocities.
        other: The body that it strikes, if there is one. After a strike it has its new velocities too.
        t1: The first principal tangent, unit, world axes.
        t2: The second one.
        n: The normal, unit, world axes.
        l1: 1/kg, response along the first tangent to an impulse along it.
        l2: 1/kg, response along the second tangent to an impulse along it.
        k1: 1/kg, coupling between the first tangent and the normal.
        k2: 1/kg, coupling between the second tangent and the normal.
        kn: 1/kg, response along the normal to an impulse along it.
        v_n: m/s, the normal velocity before.
        impulse: N s, the whole one on the body, world axes.
        compression: N s, the one of compression.
        before: m/s, the contact's velocity before, relative to what it touches, world axes. A component
            within the tolerance is 0.
        after: m/s, the same afterwards.
        law: How the contact slides, contact axes.
        progress: What has come of the impulse path so far, contact axes.
        tracer: The one that follows the path.
    """

    def __init__(self, law: RestitutionLaw, vertices: list[tuple[PathEvent, Vector3]] | None = None) -> None:
        self.body, self.other = BodyAtContact(), BodyAtContact()
        self.t1 = self.t2 = self.n = (0.0, 0.0, 0.0)
        self.l1 = self.l2 = self.k1 = self.k2 = self.kn = self.v_n = 0.0
        self.impulse = self.compression = self.before = self.after = (0.0, 0.0, 0.0)
        self.law, self.progress = SlidingLaw(1.0, 1.0, 0.0, 0.0, 1.0, 0.0), Progress(RULES[law], vertices)
        self.tracer = Tracer(self.law, self.progress)

    def strike(  # noqa: PLR0917
        self,
        normal: Vector3,
        friction: float,
        restitution: float,
        has_other: bool,  # noqa: FBT001  C has no keywords
        tolerance: float,
        skips: bool = False,  # noqa: FBT001, FBT002  C has no keywords
    ) -> int:
        """Strike at a contact of `body`, and return the outcome, below 0 if there is none (`refuse`).

        Args:
            normal: Unit, into the body, world axes.
            friction: Coulomb's coefficient.
            restitution: The coefficient.
            has_other: Whether `other` is struck, and not the fixed world.
            tolerance: m/s. A normal or tangential velocity within it counts as zero.
            skips: Whether nothing happens to a contact that separates.
        """
        a, b = first_tangent(normal), second_tangent(normal)
        aa, ab, an, bb, bn, nn = self.body.response(a, b, normal)
        self.before = self.body.velocity()
        if has_other:
            more = self.other.response(a, b, normal)
            aa, ab, an = aa + more[0], ab + more[1], an + more[2]
            bb, bn, nn = bb + more[3], bn + more[4], nn + more[5]
            second = self.other.velocity()
            self.before = (
                self.before[0] - second[0],
                self.before[1] - second[1],
                self.before[2] - second[2],
            )
        self.find_axes(a, b, normal, (aa, ab, an, bb, bn, nn))
        self.law.take(self.l1, self.l2, self.k1, self.k2, self.kn, friction)
        outcome = self.follow(restitution, tolerance, skips)
        if outcome > _NO_IMPULSE:
            self.body.push(self.impulse)
            if has_other:
                self.other.push((-self.impulse[0], -self.impulse[1], -self.impulse[2]))
        return outcome

    def strike_mechanism(  # noqa: PLR0917
        self,
        inverse_inertia: Inertia,
        velocity: Vector3,
        normal: Vector3,
        friction: float,
        restitution: float,
        tolerance: float,
        skips: bool = False,  # noqa: FBT001, FBT002  C has no keywords
    ) -> int:
        """Strike at a contact whose inverse inertia is given, and return the outcome as `strike` does.

        Args:
            inverse_inertia: The nine numbers of a (3, 3), 1/kg, world axes. It may be singular.
            velocity: m/s, of the contact, world axes.
            normal: As of `strike`.
            friction: As of `strike`.
            restitution: As of `strike`.
            tolerance: As of `strike`.
            skips: As of `strike`.
        """
        w = inverse_inertia
        asymmetry = max(abs(w[1] - w[3]), abs(w[2] - w[6]), abs(w[5] - w[7]))
        if asymmetry > SYMMETRY_TOLERANCE * max(
            abs(w[1]), abs(w[2]), abs(w[5]), abs(w[0]), abs(w[4]), abs(w[8])
        ):
            return _NOT_SYMMETRIC
        a, b = first_tangent(normal), second_tangent(normal)
        of_a, of_b, of_n = turned(w, a), turned(w, b), turned(w, normal)
        along = (dot(a, of_a), dot(b, of_a), dot(a, of_n), dot(b, of_b), dot(b, of_n), dot(normal, of_n))
        self.before = velocity
        self.find_axes(a, b, normal, along)
        # What is below the rounding of the inverse inertia is none, or else it would be divided by.
        least = SINGULAR_RESPONSE * max(self.l1, self.l2, abs(self.kn))
        if not self.kn > max(least, LEAST_NUMBER):
            return _NO_RESPONSE
        self.l1, self.k1 = self.possible(self.l1, self.k1, least)
        self.l2, self.k2 = self.possible(self.l2, self.k2, least)
        size = abs(velocity[0]) + abs(velocity[1]) + abs(velocity[2])
        if self.l1 == 0.0:
            self.drop_sliding(self.t1, size)
        if self.l2 == 0.0:
            self.drop_sliding(self.t2, size)
        self.law.take(self.l1, self.l2, self.k1, self.k2, self.kn, friction)
        if min(self.l1, self.l2) < 0.0 or not self.law.round_rise(least):
            return _NOT_POSITIVE
        outcome = self.follow(restitution, tolerance, skips)
        if outcome > _NO_IMPULSE and not self.progress.p * least <= size:
            return _NOT_ENDED
        return outcome

    def possible(self, response: float, coupling: float, least: float) -> tuple[float, float]:
        """Return the response along a tangent and its coupling with the normal, without rounding below 0."""
        if abs(response) <= least:
            if abs(coupling) <= least:
                return 0.0, 0.0
            response = max(response, coupling * coupling / self.kn)
        return response, coupling

    def drop_sliding(self, tangent: Vector3, size: float) -> None:
        """Set the velocity along a tangent in which the contact cannot move to 0 if it is rounding, m/s."""
        along = dot(self.before, tangent)
        if abs(along) <= SINGULAR_RESPONSE * size:
            v = self.before
            self.before = (v[0] - along * tangent[0], v[1] - along * tangent[1], v[2] - along * tangent[2])

    def follow(self, restitution: float, tolerance: float, skips: bool) -> int:  # noqa: FBT001
        """Follow the impulse path from a response and a velocity that are known, and return the outcome."""
        u1, u2, v_n = dot(self.t1, self.before), dot(self.t2, self.before), dot(self.n, self.before)
        self.v_n = v_n
        if not v_n <= tolerance:
            if skips and v_n > tolerance:
                self.impulse = self.compression = (0.0, 0.0, 0.0)
                self.after = self.in_world(u1, u2, v_n)
                return _NO_IMPULSE
            return _SEPARATES
        still, rests = math.sqrt(u1 * u1 + u2 * u2) <= tolerance, v_n >= -tolerance
        if still:
            u1 = u2 = 0.0
        if rests:
            v_n = 0.0
        if still or rests:
            self.before = self.in_world(u1, u2, v_n)
        outcome = self.tracer.trace(u1, u2, v_n, restitution)
        self.impulse = self.in_world(self.progress.i1, self.progress.i2, self.progress.p)
        self.compression = self.in_world(self.progress.c1, self.progress.c2, self.progress.c)
        self.after = self.in_world(self.tracer.u1, self.tracer.u2, self.progress.v_n)
        return outcome

    def strike_rows(  # noqa: PLR0917
        self,
        bodies: Any,
        others: Any,
        contacts: Any,
        tolerance: float,
        skips: bool,  # noqa: FBT001  C has no keywords
        outcomes: Any,
        results: Any,
    ) -> int:
        """Strike at the contact of each row, and return how many there were before one without an outcome.

        Args:
            bodies: (n, 23), a row for each: what `BodyAtContact.take` takes.
            others: The same, or (0, 23) where the fixed world is struck.
            contacts: (n, 5), normals, frictions and restitutions.
            tolerance: As of `strike`.
            skips: As of `strike`.
            outcomes: (n,), which are filled in.
            results: (n, 24), which are filled in: v and w afterwards, impulse, compression, the contact's
                velocity before and after, then v and w of the other body.
        """
        has_other = len(others) > 0
        for i in range(len(outcomes)):
            take_row(self.body, bodies, i)
            if has_other:
                take_row(self.other, others, i)
            normal = vector_of(contacts, i, 0)
            outcome = self.strike(normal, contacts[i, 3], contacts[i, 4], has_other, tolerance, skips)
            outcomes[i] = outcome
            if outcome < 0:
                return i
            put(results, i, 0, self.body.v)
            put(results, i, 3, self.body.w)
            self.put_contact(results, i, 6)
            if has_other:
                put(results, i, 18, self.other.v)
                put(results, i, 21, self.other.w)
        return len(outcomes)

    def strike_mechanism_rows(  # noqa: PLR0917
        self,
        mechanisms: Any,
        contacts: Any,
        tolerance: float,
        skips: bool,  # noqa: FBT001  C has no keywords
        outcomes: Any,
        results: Any,
    ) -> int:
        """Strike at the contact of each row as `strike_rows` does.

        Rows of ``mechanisms``, (n, 12), are inverse inertias and then velocities. Rows of ``results``,
        (n, 12), are impulse, compression, and the contact's velocity before and after.
        """
        for i in range(len(outcomes)):
            x, y, z = vector_of(mechanisms, i, 0), vector_of(mechanisms, i, 3), vector_of(mechanisms, i, 6)
            outcome = self.strike_mechanism(
                (x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]),
                vector_of(mechanisms, i, 9),
                vector_of(contacts, i, 0),
                contacts[i, 3],
                contacts[i, 4],
                tolerance,
                skips,
            )
            outcomes[i] = outcome
            if outcome < 0:
                return i
            self.put_contact(results, i, 0)
        return len(outcomes)

    def put_contact(self, results: Any, i: int, first: int) -> None:
        """Write impulse, compression, and the velocities before and after into row ``i``."""
        put(results, i, first, self.impulse)
        put(results, i, first + 3, self.compression)
        put(results, i, first + 6, self.before)
        put(results, i, first + 9, self.after)

    def find_axes(self, a: Vector3, b: Vector3, normal: Vector3, response: Response) -> None:
        """Find the principal tangents, and the response along them, from that in axes a, b and the normal."""
        aa, ab, an, bb, bn, nn = response
        # Jacobi's rotation by the smaller angle.
        difference = bb - aa
        root = math.sqrt(difference * difference + 4.0 * ab * ab)
        tangent = math.copysign(1.0, difference) * (2.0 * ab) / (abs(difference) + root + SMALLEST)
        c = 1.0 / math.sqrt(1.0 + tangent * tangent)
        s = tangent * c
        self.t1, self.t2, self.n = combined(c, a, -s, b), combined(s, a, c, b), normal
        self.l1, self.l2, self.kn = aa - tangent * ab, bb + tangent * ab, nn
        self.k1, self.k2 = c * an - s * bn, s * an + c * bn

    def in_world(self, u1: float, u2: float, along: float) -> Vector3:
        """Return the vector in world axes that has these contact components."""
        flat, n = combined(u1, self.t1, u2, self.t2), self.n
        return (flat[0] + along * n[0], flat[1] + along * n[1], flat[2] + along * n[2])


def take_row(body: BodyAtContact, rows: Any, i: int) -> None:
    """Take row ``i`` of bodies."""
    x, y, z = vector_of(rows, i, 1), vector_of(rows, i, 4), vector_of(rows, i, 7)
    q, q_w = vector_of(rows, i, 10), rows[i, 13]
    body.take(
        rows[i, 0],
        (x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]),
        (q[0], q[1], q[2], q_w),
        vector_of(rows, i, 14),
        vector_of(rows, i, 17),
        vector_of(rows, i, 20),
    )


def vector_of(rows: Any, i: int, first: int) -> Vector3:
    """Return a vector of row ``i``, from column ``first`` on."""
    x, y, z = rows[i, first], rows[i, first + 1], rows[i, first + 2]
    return (x, y, z)


def turned(matrix: Inertia, vector: Vector3) -> Vector3:
    """Return the product of the symmetric part of a matrix, row by row, and a vector."""
    m = matrix
    xy, xz, yz = 0.5 * (m[1] + m[3]), 0.5 * (m[2] + m[6]), 0.5 * (m[5] + m[7])
    return (
        m[0] * vector[0] + xy * vector[1] + xz * vector[2],
        xy * vector[0] + m[4] * vector[1] + yz * vector[2],
        xz * vector[0] + yz * vector[1] + m[8] * vector[2],
    )


def is_small(vector: Vector3) -> bool:
    """Return whether no component is too large to multiply."""
    return max(abs(vector[0]), abs(vector[1]), abs(vector[2])) <= LARGEST_NUMBER


def put(rows: Any, i: int, first: int, vector: Vector3) -> None:
    """Write a vector into row ``i``, from column ``first`` on."""
    rows[i, first], rows[i, first + 1], rows[i, first + 2] = vector[0], vector[1], vector[2]


# As in `numerics.vectors`, with C types. Tangents are found by a formula without a choice of axes (Duff et
# al. 2017, "Building an orthonormal basis, revisited").


def first_tangent(n: Vector3) -> Vector3:
    """Return one of two unit tangents."""
    s = math.copysign(1.0, n[2])
    a = -1.0 / (s + n[2])
    return (1.0 + s * n[0] * n[0] * a, s * (n[0] * n[1] * a), -s * n[0])


def second_tangent(n: Vector3) -> Vector3:
    """Return the other one."""
    s = math.copysign(1.0, n[2])
    a = -1.0 / (s + n[2])
    return (n[0] * n[1] * a, s + n[1] * n[1] * a, -n[1])


def dot(a: Vector3, b: Vector3) -> float:
    """Return the inner product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector3, b: Vector3) -> Vector3:
    """Return the cross product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def combined(x: float, a: Vector3, y: float, b: Vector3) -> Vector3:
    """Return x a + y b."""
    return (x * a[0] + y * b[0], x * a[1] + y * b[1], x * a[2] + y * b[2])
