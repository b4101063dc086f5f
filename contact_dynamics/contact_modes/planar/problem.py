# SPDX-License-Identifier: Apache-2.0
"""A planar problem asks for contact modes in the plane. Its case is the same question in coordinates.

In a case, accelerations and wrenches are vectors of one space. The radius of gyration rho is the unit of
length for rotations. An acceleration is q = (a_x, a_y, rho alpha), and a wrench is w = (f_x, f_y, moment /
rho). Newton's law is then m q = w, where w includes the contact forces. The accelerations of a contact's
point along its normal and its tangent are

    a_n = N . q + b_n,  a_t = T . q + b_t,  N = (n, r x n / rho),  T = (t, r x t / rho),  b = -w^2 r . (n, t).

A contact of curved sides adds a term to b_n (`PlanarContact.gap_acceleration`). The rows N and T are also the
wrenches of a unit normal force and a unit tangential force (lecture 26).

Velocities of contacts within tolerance count as zero. So the body moves with that part of its velocity which
moves no contact along its normal, and no contact at rest along its tangent. If that part turns, the rows of
all touching contacts are orthogonal to it, because their normals meet at the centre of rotation. The affine
problem then has a line of symmetry, and what is left is again a cone in three dimensions: two for the
acceleration, and one for the centripetal terms.

Contacts that coincide are answered as one, such as those of a body's two sides in a plane of motion.

Contacts coincide if their places and normals agree within `SAME_ROWS`, and they have the same friction and
the same curvatures. They have the same letter in every mode. Mechanics determines only the sum of their
forces, and the answer gives each of them an equal share.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

from contact_dynamics.contact.uncertainty import EXACT_CONTACTS, ContactUncertainty
from contact_dynamics.contact_modes.result import PlanarMode, RefusedMode
from contact_dynamics.errors import TooLargeError
from contact_dynamics.numerics.vectors import Vector3, cross, dot, norm, normalised, tangents, without
from contact_dynamics.plane.types import PlanarVelocity
from contact_dynamics.records import Record
from contact_dynamics.tolerances import (
    ACCELERATION_TOLERANCE,
    GRIP_TOLERANCE,
    LARGEST_GRIP,
    ROW_TOLERANCE,
    SAME_ROWS,
    VELOCITY_TOLERANCE,
)
from contact_dynamics.validation import check_not_negative

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarWrench, Vector2


class Coincident(NamedTuple):
    """The groups of contacts that coincide."""

    firsts: list[int]  # the index of the first contact of each group
    group: list[int]  # the index of each contact's group
    counts: list[int]  # the number of contacts in each group

    def letters_of_all(self, mode: str) -> str:
        """Return the letters of all contacts for a mode with one letter for each group."""
        return "".join([mode[group] for group in self.group])

    def consistent(self, mode: PlanarMode, negligible: float) -> PlanarMode:
        """Return a mode of all contacts for one of the groups.

        Normal forces up to ``negligible``, N, count as none.
        """
        counts = self.counts
        shares: list[Vector2] = [
            (f_t / count, f_n / count) for (f_t, f_n), count in zip(mode.contact_forces, counts, strict=True)
        ]
        shared = any(
            count > 1 and f_n > negligible
            for (_, f_n), count in zip(mode.contact_forces, counts, strict=True)
        )
        return PlanarMode(
            mode=self.letters_of_all(mode.mode),
            acceleration=mode.acceleration,
            angular_acceleration=mode.angular_acceleration,
            contact_forces=tuple([shares[group] for group in self.group]),
            contact_accelerations=tuple([mode.contact_accelerations[group] for group in self.group]),
            forces_unique=mode.forces_unique and not shared,
            motion_unique=mode.motion_unique,
        )

    def refused(self, mode: RefusedMode) -> RefusedMode:
        """Return a refused mode of all contacts for a refused mode of the groups."""
        contact = mode.contact if mode.contact < 0 else self.firsts[mode.contact]
        letters = self.letters_of_all(mode.mode)
        return RefusedMode(mode=letters, refusal=mode.refusal, contact=contact, amount=mode.amount)


def coincident(
    contacts: Sequence[PlanarContact], velocities: Sequence[Vector2], rho: float
) -> Coincident | None:
    """Return the groups of contacts that coincide, or None if all contacts differ.

    Two contacts also belong together if a chain of contacts leads from one to the other in which neighbours
    coincide. So the order in which contacts are listed does not matter. Of the velocities (v_t, v_n), only
    the signs count.
    """
    pairs = _same_pairs(contacts, velocities, rho)
    if not pairs:
        return None
    leaders = list(range(len(contacts)))
    for one, other in pairs:
        low, high = sorted((_leader(leaders, one), _leader(leaders, other)))
        leaders[high] = low
    firsts: list[int] = []
    group: list[int] = []
    counts: list[int] = []
    for index in range(len(contacts)):
        leader = _leader(leaders, index)
        if leader == index:
            firsts.append(index)
            counts.append(0)
            group.append(len(firsts) - 1)
        else:
            group.append(group[leader])
        counts[group[-1]] += 1
    return Coincident(firsts, group, counts)


def _same_pairs(
    contacts: Sequence[PlanarContact], velocities: Sequence[Vector2], rho: float
) -> list[tuple[int, int]]:
    """Return pairs of contacts that coincide. They are enough to connect each group."""
    # Contacts that agree in every coordinate also agree in a weighted sum of them, and few others do.
    far = max(rho, *(abs(x) + abs(y) for x, y in (contact.r for contact in contacts)))
    sums = sorted(
        [
            (
                0.61 * contact.r[0]
                + 0.79 * contact.r[1]
                + far * (contact.normal[0] + 0.37 * contact.normal[1]),
                i,
            )
            for i, contact in enumerate(contacts)
        ]
    )
    window = 6.0 * SAME_ROWS * far
    pairs = []
    for k, (value, i) in enumerate(sums):
        for other, j in sums[k + 1 :]:
            if other - value > window:
                break
            if _same(contacts[i], contacts[j], rho) and _alike(velocities[i], velocities[j]):
                pairs.append((i, j))
                if contacts[i].r == contacts[j].r and contacts[i].normal == contacts[j].normal:
                    break  # whatever coincides with contact i coincides with contact j, and is found there
    return pairs


def _same(one: PlanarContact, other: PlanarContact, rho: float) -> bool:
    (x, y), (n_x, n_y) = one.r, one.normal
    (u, v), (m_x, m_y) = other.r, other.normal
    reach = SAME_ROWS * max(rho, abs(x), abs(y))
    return (
        abs(x - u) <= reach
        and abs(y - v) <= reach
        and abs(n_x - m_x) <= SAME_ROWS
        and abs(n_y - m_y) <= SAME_ROWS
        and one.friction == other.friction
        and one.holding_friction == other.holding_friction
        and one.body_curvature == other.body_curvature
        and one.surface_curvature == other.surface_curvature
    )


def _alike(one: Vector2, other: Vector2) -> bool:
    (v_t, v_n), (u_t, u_n) = one, other
    return (v_t > 0.0) == (u_t > 0.0) and (v_t < 0.0) == (u_t < 0.0) and (v_n > 0.0) == (u_n > 0.0)


def _leader(leaders: list[int], index: int) -> int:
    while leaders[index] != index:
        leaders[index] = index = leaders[leaders[index]]
    return index


MAX_PLANAR_CONTACTS: Final = 1000
"""Largest number of contacts that is accepted. The modes of n contacts have about 4 n^2 letters in all."""

AT_REST: Final = PlanarVelocity(v=(0.0, 0.0), w=0.0)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PlanarContactProblem(Record):
    """Contact problem of one planar body. The 3-D counterpart is `SpatialContactProblem`.

    Attributes:
        body: Mass and angular inertia.
        velocity: Velocity of the body.
        contacts: Contacts. They may coincide or oppose each other.
        wrench: Applied wrench on the body: all loads except contact forces, so it includes gravity.
        velocity_tolerance: m/s, >= 0. Components of a contact's velocity up to this size count as zero, and
            so does an angular velocity that moves no contact relative to the centre of mass by more.
        acceleration_tolerance: >= 0, relative to the applied wrench and the centripetal terms. Forces and
            accelerations count as zero if a change of the wrench by this share can change their sign. It is
            reduced if the friction coefficient times the lever arm in radii of gyration exceeds
            `GRIP_TOLERANCE` divided by it.
        uncertainty: Errors of the contacts. If they are not exact, the answer also lists the verdicts that
            occur within these errors.

    Raises:
        InvalidFieldError: a tolerance is negative, or the uncertainty has another number of contacts.
        TooLargeError: there are more than `MAX_PLANAR_CONTACTS` contacts.
    """

    body: PlanarBody
    velocity: PlanarVelocity = AT_REST
    contacts: Sequence[PlanarContact]
    wrench: PlanarWrench
    velocity_tolerance: float = VELOCITY_TOLERANCE
    acceleration_tolerance: float = ACCELERATION_TOLERANCE
    uncertainty: ContactUncertainty = EXACT_CONTACTS

    def __post_init__(self) -> None:
        """Check the tolerances and the number of contacts."""
        n = len(self.contacts)
        if n > MAX_PLANAR_CONTACTS:
            raise TooLargeError("contacts", f"{n} contacts", f"at most {MAX_PLANAR_CONTACTS}")
        object.__setattr__(self, "contacts", tuple(self.contacts))
        # The defaults need no check. One contact is answered in microseconds, of which checks take some.
        if self.uncertainty is not EXACT_CONTACTS:
            self.uncertainty.check_count(n)
        if self.velocity_tolerance is not VELOCITY_TOLERANCE:
            velocity = check_not_negative("velocity_tolerance", self.velocity_tolerance)
            object.__setattr__(self, "velocity_tolerance", velocity)
        if self.acceleration_tolerance is not ACCELERATION_TOLERANCE:
            acceleration = check_not_negative("acceleration_tolerance", self.acceleration_tolerance)
            object.__setattr__(self, "acceleration_tolerance", acceleration)

    def contact_velocities(self) -> tuple[Vector2, ...]:
        """Return (v_t, v_n), m/s, of each contact relative to its surface.

        Values within the tolerance are exactly 0.
        """
        tolerance = self.velocity_tolerance
        (v_x, v_y), w = self.velocity.v, self.velocity.w
        found = []
        for contact in self.contacts:
            n_x, n_y = contact.normal
            c_x = v_x - w * contact.r[1]
            c_y = v_y + w * contact.r[0]
            if contact.surfaces_move:
                c_x -= contact.surface_velocity[0]
                c_y -= contact.surface_velocity[1]
            v_t = c_x * n_y - c_y * n_x
            v_n = c_x * n_x + c_y * n_y
            found.append((0.0 if abs(v_t) <= tolerance else v_t, 0.0 if abs(v_n) <= tolerance else v_n))
        return tuple(found)


class ContactRow(NamedTuple):
    """One touching contact."""

    contact: int  # its index in the caller's order
    N: Vector3  # the row of its normal acceleration, not a unit vector
    T: Vector3  # the row of its tangential acceleration, not a unit vector
    unit_n: Vector3  # the unit vector along N
    unit_t: Vector3  # the unit vector along T
    size_n: float  # |N|
    size_t: float  # |T|
    b_n: float  # m/s^2, the part of the normal acceleration that is due to velocities
    b_t: float  # m/s^2, the part of the tangential acceleration that is due to velocities
    slides: float  # -1 if it moves left, +1 if it moves right, and 0 if it is at rest
    friction: float  # the coefficient of friction that acts, see `effective_friction`
    holding: float  # the same where the contact sticks, not less


class Lift(NamedTuple):
    """The line of symmetry of a body that turns about its contacts, and coordinates across it."""

    line: Vector3  # the direction of the velocity, as a unit vector
    across: tuple[Vector3, Vector3]  # two unit vectors that are orthogonal to the line and to each other
    scale: float  # m/s^2, the largest |b|, which is the unit of the third coordinate


class PlanarCase(NamedTuple):
    """A question in coordinates. The enumeration and the judgement of modes need no more than this."""

    contacts: Sequence[PlanarContact]  # all contacts, also those that do not touch
    mass: float  # kg
    rho: float  # m, the radius of gyration
    w: Vector3  # N, the applied wrench
    rows: list[ContactRow]  # the touching contacts
    omega: float  # rad/s, the angular velocity that the contacts allow
    lift: Lift | None  # the line of symmetry, or None: without centripetal terms, accelerations are a cone

    @property
    def load(self) -> float:
        """Return the size with which forces are compared, N: the applied wrench plus centripetal terms."""
        return norm(self.w) + (self.mass * self.lift.scale if self.lift else 0.0)


def touching_case(problem: PlanarContactProblem) -> PlanarCase | None:
    """Return the case of the contacts that touch, or None if none does or one approaches.

    Those that coincide get the same place and normal.
    """
    velocities = problem.contact_velocities()
    if any(v_n < 0.0 for _, v_n in velocities) or all(v_n > 0.0 for _, v_n in velocities):
        return None
    contacts = problem.contacts
    same = coincident(contacts, velocities, problem.body.radius_of_gyration)
    if same is not None:
        contacts = [contacts[same.firsts[group]] for group in same.group]
    return planar_case(problem, contacts, velocities)


def planar_case(
    problem: PlanarContactProblem, contacts: Sequence[PlanarContact], contact_velocities: Sequence[Vector2]
) -> PlanarCase:
    """Return the case of the contacts, one of each group if some coincide, that have no normal velocity."""
    body, velocity, wrench = problem.body, problem.velocity, problem.wrench
    velocity_tolerance = problem.velocity_tolerance
    rho = body.radius_of_gyration
    touching: list[tuple[int, float, Vector3, Vector3]] = []
    resting: list[Vector3] = []
    for index, (contact, (v_t, v_n)) in enumerate(zip(contacts, contact_velocities, strict=True)):
        if v_n != 0.0:
            continue
        N, T = contact_rows(contact, rho)
        touching.append((index, v_t, N, T))
        resting.append(N)
        if v_t == 0.0:
            resting.append(T)
    twist = (velocity.v[0], velocity.v[1], rho * velocity.w)
    if twist != (0.0, 0.0, 0.0):
        twist = _unhindered(twist, [normalised(row) for row in resting])
    omega = 0.0
    if abs(twist[2]) > ROW_TOLERANCE * norm(twist):
        reach = max(contact.reach(rho) for contact in contacts)
        if abs(twist[2]) * reach > velocity_tolerance * rho:
            omega = twist[2] / rho
    square = omega * omega
    moves = twist != (0.0, 0.0, 0.0)
    rows = []
    largest = 0.0
    for index, v_t, N, T in touching:
        contact = contacts[index]
        b_n = b_t = 0.0
        flat = contact.body_curvature == math.inf and contact.surface_curvature == 0.0
        if omega != 0.0 or (moves and not flat):
            b_n = square * T[2] * rho  # T's moment arm is -r.n, N's is r.t
            rolling = contact.gap_acceleration(dot(T, twist), omega)
            # For a disc that rolls on a flat the two terms are opposite, and only rounding is left.
            cancels = abs(b_n + rolling) <= ACCELERATION_TOLERANCE * abs(rolling)
            b_n = 0.0 if cancels else b_n + rolling
            b_t = -square * N[2] * rho
            largest = max(largest, abs(b_n), abs(b_t))
        size_n, size_t = norm(N), norm(T)
        unit_n, unit_t = _divided(N, size_n), _divided(T, size_t)
        slides = float((v_t > 0.0) - (v_t < 0.0))
        friction = holding = effective_friction(contact, rho, contact.friction)
        if contact.static_friction is not None:
            holding = effective_friction(contact, rho, contact.static_friction)
        row = ContactRow(index, N, T, unit_n, unit_t, size_n, size_t, b_n, b_t, slides, friction, holding)
        rows.append(row)
    return PlanarCase(
        contacts=contacts,
        mass=body.mass,
        rho=rho,
        w=(wrench.f[0], wrench.f[1], wrench.moment / rho),
        rows=rows,
        omega=omega,
        lift=_lift(twist, largest) if largest > 0.0 else None,
    )


def contact_accelerations(
    contacts: Sequence[PlanarContact], a: Vector2, alpha: float, omega: float
) -> list[Vector2]:
    """Return the accelerations (a_t, a_n) of the body's points at contacts, m/s^2, whose centre has ``a``."""
    found = []
    (a_x, a_y), square = a, omega * omega
    for contact in contacts:
        n_x, n_y = contact.normal
        r_x, r_y = contact.r
        c_x = a_x - alpha * r_y - square * r_x
        c_y = a_y + alpha * r_x - square * r_y
        found.append((c_x * n_y - c_y * n_x, c_x * n_x + c_y * n_y))
    return found


def contact_rows(contact: PlanarContact, length: float) -> tuple[Vector3, Vector3]:
    """Return N and T of a contact, with a ``length``, m, as the unit of length for rotations."""
    n_x, n_y = contact.normal
    r_x, r_y = contact.r
    return (
        (n_x, n_y, (r_x * n_y - r_y * n_x) / length),
        (n_y, -n_x, -(r_x * n_x + r_y * n_y) / length),
    )


def effective_friction(contact: PlanarContact, length: float, friction: float) -> float:
    """Return a coefficient of friction of a contact, but at most what `LARGEST_GRIP` allows."""
    if friction <= 1.0:
        return friction
    arms = max(1.0, abs(contact.r[0]) / length, abs(contact.r[1]) / length)
    return max(1.0, min(friction, LARGEST_GRIP / arms))


def accuracy_of(problem: PlanarContactProblem) -> float:
    """Return the relative size up to which forces and accelerations count as zero.

    It is the problem's ``acceleration_tolerance``, or less where friction is so large that a normal force of
    that size would hold or stop the body.
    """
    accuracy, rho = problem.acceleration_tolerance, problem.body.radius_of_gyration
    for contact in problem.contacts:
        friction = contact.holding_friction
        if friction > 1.0:
            arms = max(1.0, abs(contact.r[0]) / rho, abs(contact.r[1]) / rho)
            accuracy = min(accuracy, GRIP_TOLERANCE / (effective_friction(contact, rho, friction) * arms))
    return accuracy


def beyond_grip(contact: PlanarContact, length: float) -> bool:
    """Return whether the contact acts with less friction than it has, static friction included."""
    friction = contact.holding_friction
    return effective_friction(contact, length, friction) < friction


def never_slipping(case: PlanarCase) -> PlanarCase:
    """Return the case with infinite friction at contacts that act with less friction than they have."""
    contacts, rho = case.contacts, case.rho
    rows = []
    for row in case.rows:
        contact = contacts[row.contact]
        slips = row.friction == contact.friction
        friction = row.friction if slips else math.inf
        rows.append(row._replace(friction=friction, holding=math.inf) if beyond_grip(contact, rho) else row)
    return case._replace(rows=rows)


def _unhindered(twist: Vector3, resting: list[Vector3]) -> Vector3:
    """Return the part of ``twist`` orthogonal to all ``resting`` rows."""
    if not resting:
        return twist
    first = resting[0]
    apart = max((cross(first, row) for row in resting), key=lambda normal: dot(normal, normal))
    if dot(apart, apart) <= ROW_TOLERANCE * ROW_TOLERANCE:
        return without(twist, first)
    line = normalised(apart)
    if any(abs(dot(line, row)) > ROW_TOLERANCE for row in resting):
        return (0.0, 0.0, 0.0)
    along = dot(twist, line)
    return (along * line[0], along * line[1], along * line[2])


def _lift(twist: Vector3, scale: float) -> Lift:
    line = normalised(twist)
    return Lift(line, tangents(line), scale)


def _divided(a: Vector3, by: float) -> Vector3:
    return (a[0] / by, a[1] / by, a[2] / by)


def lifted(lift: Lift | None, row: Vector3, offset: float) -> Vector3:
    """Return ``row . q + offset`` as a row in the coordinates of the problem's cone."""
    if lift is None:
        return row
    one, two = lift.across
    return (dot(row, one), dot(row, two), offset / lift.scale)
