# SPDX-License-Identifier: Apache-2.0
"""Contacts can jam: none approaches, and yet no mode is consistent (lecture 26's last remark).

The applied wrench then cannot act for any time, however short, without an impulse. So it acts for a short
time h, after which contact impulses p_i keep the body out of the world, and h goes to zero,

    v' = v + h a + impulses,  0 <= p_i,  v_n' + h b_n >= 0,  one of the two zero,

with Coulomb's law for impulses against the sliding at the end. This limit exists, and it settles Painleve's
paradox (Stewart, Rigid-body dynamics with friction and impact, SIAM Review 42, 2000). The centripetal terms
b_n come from arms that have turned for the time h, and from the shapes that meet there (`contact.curvature`).
A second problem of the same kind gives back Poisson's restitution (Anitescu and Potra, Nonlinear Dynamics 14,
1997).

The way to the end of the impact is not followed. Friction acts against the sliding at the end of compression,
and against that at the end of restitution. So a contact that stops before and slides back is not seen. At one
contact, Routh's path (`impact.spatial`) sees it.

After one such impact, contacts may slide on in another direction and jam again. Each impact takes energy, so
this ends. In hundreds of drawn sets it ended after at most three impacts.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact.friction import check_facets
from contact_dynamics.contact.velocities import spatial_contact_velocities, velocity_accelerations
from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.impact.energy import created
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.several.result import (
    ResolvedImpact,
    SeveralContactsLaw,
    in_terms_of_strikes,
)
from contact_dynamics.impact.spatial.one_contact import check_striking
from contact_dynamics.numerics.lemke import solve_complementarity
from contact_dynamics.numerics.vectors import point_jacobians, tangents_towards
from contact_dynamics.rigid_body.body import BodyState, HasMassProperties, MassProperties, inverse_mass_matrix
from contact_dynamics.tolerances import HELD_INDEPENDENT, LARGEST_NUMBER, SHORT_TIMES, VELOCITY_TOLERANCE
from contact_dynamics.validation import check_array, check_at_rest, check_magnitude, check_unit, check_within

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.validation import FloatArray

MAX_JAMMED_CONTACTS: Final = 64
"""Longest list of contacts accepted. Its complementarity problem takes a second or so."""

MAX_JAMS: Final = 10
"""Jamming impacts after which the case counts as not settled."""

MAX_DIRECTIONS: Final = 2048
"""Bound on the directions of friction over all contacts. Their complementarity problem takes 40 MB."""

_ZERO: Final = 100.0
"""A speed counts as zero up to this multiple of the change of velocity in the short time. An impulse counts
as zero up to the mass times such a speed."""


class _Contacts(NamedTuple):
    """The contacts, with what links their velocities to the body's twist (v, w) and to impulses."""

    rows: FloatArray  # (n, 3, 6), take the twist into the velocity of each contact
    normals: FloatArray  # (n, 3), unit
    directions: FloatArray  # (n, d, 3), unit, the directions in which friction can push
    frictions: FloatArray  # (n,), coefficients of friction
    mass: float  # kg
    inverse: FloatArray  # (6, 6), inverse of the mass matrix
    speed: float  # m/s, the largest speed
    zero: float  # m/s, a speed up to it counts as zero


class _Impulses(NamedTuple):
    normal: FloatArray  # (n,), N s, normal impulses
    friction: FloatArray  # (n, d), N s, impulses of friction in each direction
    sliding: FloatArray  # (n,), m/s, sliding speeds, 0 where a pressed contact does not slide


def jamming_impact(
    body: HasMassProperties,
    state: BodyState,
    contacts: ContactSet,
    *,
    force_W: ArrayLike,
    torque_W: ArrayLike = (0.0, 0.0, 0.0),
    is_settled: Callable[[BodyState], bool] | None = None,
    plane_normal_W: FloatArray | None = None,
    friction_facets: int = 8,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
) -> ResolvedImpact:
    """Return the impact of contacts that do not approach and for which no contact mode is consistent.

    ``converged`` is false if no impulses were found that prevent penetration, or if the contacts are
    not settled after `MAX_JAMS` impacts.

    Args:
        body: A `Body`, or its `MassProperties`.
        state: Pose and velocities just before the impact.
        contacts: All touching contacts; at least one.
        force_W: (3,), N, applied force, including gravity but not contact forces, world axes.
        torque_W: (3,), N m, applied torque about the centre of mass, world axes.
        is_settled: Function of a state that returns whether a contact mode is consistent, or a contact
            approaches. Impacts are then repeated until it is true, and the result combines them. If it is
            None, there is one impact.
        plane_normal_W: (3,), unit normal of a plane of motion, or None. In a plane, friction has two
            directions, which are exact. Without one, friction acts in space, in ``friction_facets``
            directions.
        friction_facets: Number of directions of friction in space, >= 3. The first one opposes the sliding.
        velocity_tolerance: m/s, >= 0. Normal and tangential components of a contact's velocity up to it count
            as zero.

    Raises:
        InvalidFieldError: there are no contacts, a number is not finite or exceeds `LARGEST_NUMBER`, the
            tolerance is negative, the normal of the plane is not a unit vector, or the number of facets is
            not a whole number >= 3.
        TooLargeError: there are more than `MAX_JAMMED_CONTACTS` contacts, or more than `MAX_DIRECTIONS`
            directions of friction in total.
    """
    body = body.mass_properties
    tolerance = check_within("velocity_tolerance", velocity_tolerance, 0.0, LARGEST_NUMBER)
    force = check_magnitude("force_W", check_array("force_W", force_W, (3,)))
    torque = check_magnitude("torque_W", check_array("torque_W", torque_W, (3,)))
    check_striking(body, state, contacts.p_WC_W)
    if plane_normal_W is not None:
        plane_normal_W = check_unit("plane_normal_W", plane_normal_W, 3)
    if len(contacts) == 0:
        raise InvalidFieldError("contacts", "none", "at least one contact")
    if len(contacts) > MAX_JAMMED_CONTACTS:
        raise TooLargeError(
            "contacts", f"{len(contacts)} contacts", f"at most {MAX_JAMMED_CONTACTS} for dynamic jamming"
        )
    facets = check_facets(friction_facets)
    if len(contacts) * facets > MAX_DIRECTIONS:
        raise TooLargeError(
            "friction_facets",
            f"{facets}, with {len(contacts)} contacts",
            f"at most {MAX_DIRECTIONS} over all contacts",
        )
    check_at_rest("contacts", contacts, "jamming_impact")

    impulses, converged, now = np.zeros((len(contacts), 3)), False, state
    velocities: list[FloatArray] = []
    for _ in range(MAX_JAMS):
        jam = _jam(
            body,
            now,
            contacts,
            force=force,
            torque=torque,
            plane_normal_W=plane_normal_W,
            facets=facets,
            tolerance=tolerance,
        )
        if velocities and np.abs(jam.velocities[1] - jam.velocities[0]).max() <= tolerance:
            break  # every further impact would leave the same state
        impulses, now = impulses + jam.impulses_W, now.with_velocities(jam.twist[:3], jam.twist[3:])
        velocities += jam.velocities
        converged = jam.converged and (is_settled is None or is_settled(now))
        if converged or not jam.converged:
            break
    found = in_terms_of_strikes((), [body], [state], [now], count=len(contacts)) | {"impulses_W": impulses}
    first, last = found["kinetic_energy_before"], found["kinetic_energy_after"]
    return ResolvedImpact(
        several_contacts_law=SeveralContactsLaw.SIMULTANEOUS,
        restitution_law=RestitutionLaw.POISSON,
        converged=converged,
        velocities_before_W=velocities[0],
        velocities_after_W=velocities[-1],
        creates_energy=created(last - first, first),
        **found,
    )


class _Jam(NamedTuple):
    """One jamming impact."""

    impulses_W: FloatArray  # (n, 3), N s
    twist: FloatArray  # (6,), m/s and rad/s, linear and angular velocity afterwards
    velocities: tuple[FloatArray, FloatArray]  # (n, 3), m/s, of the contacts before and after
    converged: bool


def _jam(
    body: MassProperties,
    state: BodyState,
    contacts: ContactSet,
    *,
    force: FloatArray,
    torque: FloatArray,
    plane_normal_W: FloatArray | None,
    facets: int,
    tolerance: float,
) -> _Jam:
    """Return one impact of `jamming_impact`, with ``facets`` directions of friction in space."""
    restitutions = contacts.impact_restitutions
    w, inertia = state.w_WB_W, body.inertia_in_world(state.R_WB)
    arms = contacts.p_WC_W - state.p_WB_W
    inverse = inverse_mass_matrix(body.mass, inertia)
    free = inverse @ np.concatenate([force, torque - np.cross(w, inertia @ w)])
    twist = np.concatenate([state.v_WB_W, w])
    before = point_jacobians(arms) @ twist
    rolling = velocity_accelerations(contacts, before, w)
    hurry = _fastest(point_jacobians(arms) @ free + np.cross(w, np.cross(w, arms)) + rolling, free[:3])
    speed = max(_fastest(before, twist[:3]), tolerance, VELOCITY_TOLERANCE)
    cleaned = spatial_contact_velocities(state, contacts, velocity_tolerance=tolerance)
    directions = _directions(contacts, before, plane_normal_W, facets)
    total, after, resolved = np.zeros_like(before), twist, False
    for share in SHORT_TIMES:
        short = share * speed / hurry if hurry > 0.0 else 0.0
        seen = _Contacts(
            rows=point_jacobians(arms + short * np.cross(w, arms)),
            normals=contacts.normals_W,
            directions=directions,
            frictions=contacts.frictions,
            mass=body.mass,
            inverse=inverse,
            speed=speed,
            zero=_ZERO * share * speed,
        )
        start = cleaned + seen.rows @ (twist + short * free) + short * rolling - before
        found = _two_phases(seen, start, restitutions)
        if found is None:
            continue
        impulses, held = found
        jump = inverse @ np.einsum("ijk,ij->k", point_jacobians(arms), impulses)
        total, after = _made_exact(point_jacobians(arms), inverse, impulses, twist + jump, held)
        approach = np.einsum("ij,ij->i", point_jacobians(arms) @ after, contacts.normals_W)
        resolved = float(approach.min()) >= -max(tolerance, seen.zero)
        if resolved:
            break
    return _Jam(total, after, (before, point_jacobians(arms) @ after), resolved)


def _two_phases(
    seen: _Contacts, start: FloatArray, restitutions: FloatArray
) -> tuple[FloatArray, FloatArray] | None:
    """Return the impulses, (n, 3), and the directions, (k, 3 n), in which contacts are held afterwards.

    The answer is None if no impulses keep the body out of the world.
    """
    none = np.zeros(len(start))
    phase = _compress(seen, start, none)
    if phase is None:
        return None
    total = _vectors(seen, phase)
    least = restitutions * np.where(phase.normal > seen.mass * seen.zero, phase.normal, 0.0)
    if least.any():
        change = seen.inverse @ np.einsum("ijk,ij->k", seen.rows, total)
        phase = _compress(seen, start + seen.rows @ change, least)
        if phase is None:
            return None
        total = total + _vectors(seen, phase)
    total[np.linalg.norm(total, axis=1) <= seen.mass * seen.zero] = 0.0
    held = []
    for i, normal in enumerate(seen.normals):
        if phase.normal[i] - least[i] > 0.0:
            held.append(_at(i, normal, len(total)))
        if phase.normal[i] > seen.mass * seen.zero and phase.sliding[i] <= seen.zero:
            held += [_at(i, direction, len(total)) for direction in seen.directions[i]]
    return total, np.array(held).reshape(-1, total.size)


def _compress(seen: _Contacts, start: FloatArray, least: FloatArray) -> _Impulses | None:
    """Return impulses that leave no contact approaching. Along the normals they are at least ``least``."""
    n, d = seen.directions.shape[:2]
    normal_rows = np.einsum("ij,ijk->ik", seen.normals, seen.rows)
    friction_rows = np.einsum("imj,ijk->imk", seen.directions, seen.rows).reshape(n * d, 6)
    rows = np.vstack([normal_rows, friction_rows])
    response = seen.mass * rows @ seen.inverse @ rows.T
    group = np.kron(np.eye(n), np.ones((d, 1)))  # says which contact a direction belongs to
    M = np.zeros((n * (d + 2), n * (d + 2)))
    M[: n * (d + 1), : n * (d + 1)] = response
    M[n : n * (d + 1), n * (d + 1) :] = group
    M[n * (d + 1) :, :n] = np.diag(seen.frictions)
    M[n * (d + 1) :, n : n * (d + 1)] = -group.T
    scale = seen.mass * seen.speed  # the scale of impulses, by which all unknowns are of the order of one
    given = least / scale
    q = np.concatenate(
        [
            np.einsum("ij,ij->i", seen.normals, start) / seen.speed,
            np.einsum("imj,ij->im", seen.directions, start).ravel() / seen.speed,
            seen.frictions * given,
        ]
    )
    q[: n * (d + 1)] += response[:, :n] @ given
    z = solve_complementarity(M, q)
    if z is None:
        return None
    return _Impulses(
        normal=least + scale * z[:n],
        friction=scale * z[n : n * (d + 1)].reshape(n, d),
        sliding=seen.speed * z[n * (d + 1) :],
    )


def _made_exact(
    rows: FloatArray,
    inverse: FloatArray,
    impulses: FloatArray,
    after: FloatArray,
    held: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return impulses and twist without the velocities that the short time has left at held contacts."""
    if len(held) == 0:
        return impulses, after
    held_rows = held @ rows.reshape(-1, 6)
    response = held_rows @ inverse @ held_rows.T
    missing = np.linalg.lstsq(response, -held_rows @ after, rcond=HELD_INDEPENDENT)[0]
    return impulses + (missing @ held).reshape(-1, 3), after + inverse @ held_rows.T @ missing


def _directions(
    contacts: ContactSet, velocities: FloatArray, plane_normal_W: FloatArray | None, facets: int
) -> FloatArray:
    if plane_normal_W is not None:
        tangent = np.cross(contacts.normals_W, plane_normal_W)
        return np.stack([tangent, -tangent], axis=1)
    angles = 2.0 * math.pi * np.arange(facets) / facets
    found = []
    for normal, velocity in zip(contacts.normals_W, velocities, strict=True):
        one, two = tangents_towards(normal, -velocity if velocity.any() else None)
        found.append(np.outer(np.cos(angles), one) + np.outer(np.sin(angles), two))
    return np.array(found)


def _vectors(seen: _Contacts, phase: _Impulses) -> FloatArray:
    vectors: FloatArray = phase.normal[:, None] * seen.normals + np.einsum(
        "im,imj->ij", phase.friction, seen.directions
    )
    return vectors


def _fastest(of_contacts: FloatArray, of_body: FloatArray) -> float:
    return float(np.linalg.norm(np.vstack([of_contacts, of_body]), axis=1).max())


def _at(contact: int, direction: FloatArray, count: int) -> FloatArray:
    row = np.zeros((count, 3))
    row[contact] = direction
    return row.ravel()
