# SPDX-License-Identifier: Apache-2.0
"""Contacts that approach equally fast strike as one, so that no order of the list decides between them.

The law for one contact (`impact.spatial`) needs an order, and a tie has none. So tied contacts with the same
friction and restitution share one impact. Each takes the same impulse in its own axes, which are the normal,
the direction in which the contact slides, and the one across. Their mean velocity in these axes responds
linearly to that impulse, with a positive definite matrix, so it obeys the equations of one contact, and the
path is found as for one. A face that lands flat without sliding thus bounces level, by e under each law of
restitution. What follows for any tie:

* Each impulse is in its contact's friction cone, because all of them have the same components.
* The energy changes by the whole impulse times the mean of the mean velocities before and after. So the law
  gives energy only where it does so at one contact.
* Momenta of pairs of bodies balance, because each impulse acts on both.
* Another order of the list, or a mirror image, gives the same answer in that order, or its mirror image.

Friction opposes the mean sliding. Afterwards contacts of the tie may approach again, at velocities that
differ, and strike by themselves.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from contact_dynamics.contact.pairs import pair_jacobians
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.spatial.path import SlidingLaw, SpatialPath, trace
from contact_dynamics.impact.spatial.result import SpatialImpact
from contact_dynamics.numerics.vectors import cross_of_two, tangents_by_sign
from contact_dynamics.rigid_body.body import inverse_mass_matrix
from contact_dynamics.tolerances import NO_SHARED_RESPONSE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray


class Response(NamedTuple):
    """How bodies respond to impulses at contacts.

    If surfaces move, a last column of the Jacobian has their velocities, negative, and the twist has a 1 for
    it, which no impulse changes.
    """

    jacobian: FloatArray  # (n, 3, 6 k), from the bodies' velocities (v then w of each) to those of contacts
    inverse_mass: FloatArray  # (6 k, 6 k), 1/kg and 1/(kg m^2), from impulses and moments to velocities
    twist: FloatArray  # (6 k,), m/s and rad/s, the bodies' velocities


def response_of(
    bodies: Sequence[MassProperties],
    states: Sequence[BodyState],
    points_W: FloatArray,
    pairs: Sequence[tuple[int, int | None]],
    surface_velocities_W: FloatArray | None = None,
) -> Response:
    """Return how bodies respond to impulses at points, (n, 3), m, where pairs of them meet.

    Surfaces of the world have velocities there, (n, 3), m/s, or None if all are at rest.
    """
    jacobian = pair_jacobians(states, points_W, pairs)
    if surface_velocities_W is not None:
        jacobian = np.concatenate([jacobian, -surface_velocities_W[:, :, None]], axis=2)
    size = jacobian.shape[2]
    inverse_mass = np.zeros((size, size))
    for index, (body, state) in enumerate(zip(bodies, states, strict=True)):
        own = slice(6 * index, 6 * index + 6)
        inverse_mass[own, own] = inverse_mass_matrix(body.mass, body.inertia_in_world(state.R_WB))
    parts = [part for state in states for part in (state.v_WB_W, state.w_WB_W)]
    twist = np.concatenate(parts if surface_velocities_W is None else [*parts, [1.0]])
    return Response(jacobian, inverse_mass, twist)


def pushed(response: Response, states: Sequence[BodyState], impulses_W: FloatArray) -> list[BodyState]:
    """Return the states after impulses, (n, 3), N s, world axes, at the contacts of a response."""
    twist = twist_after(response, impulses_W)
    return [
        state.with_velocities(twist[6 * i : 6 * i + 3], twist[6 * i + 3 : 6 * i + 6])
        for i, state in enumerate(states)
    ]


def twist_after(response: Response, impulses_W: FloatArray) -> FloatArray:
    """Return the velocities of all bodies, (6 k,), after impulses, (n, 3), N s, world axes."""
    pushed_by: FloatArray = np.einsum("ijk,ij->k", response.jacobian, impulses_W)
    return response.twist + response.inverse_mass @ pushed_by


def materials_of(contacts: ContactSet) -> list[tuple[float, float]]:
    """Return the restitution and the friction of each contact."""
    return list(zip(contacts.impact_restitutions.tolist(), contacts.frictions.tolist(), strict=True))


def next_to_strike(
    approach: Sequence[float], materials: Sequence[tuple[float, float]], *, tolerance: float, tie: float
) -> list[int]:
    """Return the contact that approaches fastest with those that strike as one with it, or none.

    Normal velocities, m/s, are negative where contacts approach, and tie if they differ by at most ``tie``.
    Of tied contacts that differ, those with the least restitution, then the least friction, come first.
    """
    fast = min(min(approach) + tie, -tolerance)
    tied = [i for i, rate in enumerate(approach) if rate <= fast]
    if len(tied) < 2:
        return tied
    first = min(materials[i] for i in tied)
    return [i for i in tied if materials[i] == first]


def strike_as_one(
    bodies: Sequence[MassProperties],
    states: Sequence[BodyState],
    contacts: ContactSet,
    pairs: Sequence[tuple[int, int | None]],
    *,
    law: RestitutionLaw,
    tolerance: float,
) -> tuple[list[SpatialImpact], list[BodyState]]:
    """Return the share that each of the tied ``contacts`` has in their impact, and all states after it.

    They approach equally fast and have the same friction and restitution. A contact does not slide if it is
    slower than ``tolerance``, m/s.
    """
    response = response_of(bodies, states, contacts.p_WC_W, pairs, contacts.surface_velocities_W)
    (restitution, friction), *_ = materials_of(contacts)
    path, axes = shared_path(
        response, contacts.normals_W, restitution, friction, law=law, tolerance=tolerance
    )
    impulses = impulses_of(path, axes)
    after = pushed(response, states, impulses)
    velocities = response.jacobian @ response.twist
    velocities_after = velocities + response.jacobian @ response.inverse_mass @ np.einsum(
        "ijk,ij->k", response.jacobian, impulses
    )
    vertices = np.array([vertex for _, vertex in path.vertices])
    own = np.einsum("kil,lm,kjm->kij", response.jacobian, response.inverse_mass, response.jacobian)
    k = len(contacts)
    shares = [
        SpatialImpact(
            restitution_law=law,
            outcome=path.outcome,
            jams=path.jams,
            state=after[first],
            impulse_W=impulses[i],
            compression_W=np.array(path.compression) @ axes[i] / k,
            path_W=vertices @ axes[i] / k,
            path_events=tuple(event for event, _ in path.vertices),
            velocity_before_W=velocities[i],
            velocity_after_W=velocities_after[i],
            inverse_inertia_W=own[i],
            other_state=None if second is None else after[second],
        )
        for i, (first, second) in enumerate(pairs)
    ]
    return shares, after


def impulses_of(path: SpatialPath, axes: FloatArray) -> FloatArray:
    """Return the share of each contact in the impulse of a path, (n, 3), N s, world axes."""
    impulses: FloatArray = np.einsum("a,kaj->kj", np.array(path.impulse), axes) / len(axes)
    return impulses


def shared_path(
    response: Response,
    normals_W: FloatArray,
    restitution: float,
    friction: float,
    *,
    law: RestitutionLaw,
    tolerance: float,
) -> tuple[SpatialPath, FloatArray]:
    """Return the path of the impulse of contacts that strike as one, and the axes of each, (n, 3, 3)."""
    k = len(normals_W)
    axes = _axes(response, response.jacobian @ response.twist, normals_W, tolerance)
    shared = np.einsum("kaj,kjl->al", axes, response.jacobian) / k  # the mean velocity, in these axes
    whole = shared @ response.inverse_mass @ shared.T
    # The path needs tangents along which the response is diagonal.
    _, turn = np.linalg.eigh(whole[:2, :2])
    axes[:, :2] = np.einsum("ba,kbj->kaj", turn, axes[:, :2])
    shared[:2] = turn.T @ shared[:2]
    whole = shared @ response.inverse_mass @ shared.T
    (l1, _, k1), (_, l2, k2), (_, _, kn) = whole.tolist()
    u1, u2, v_n = (shared @ response.twist).tolist()
    path = mean_path(
        (l1, l2, k1, k2, kn),
        (u1, u2, v_n),
        restitution=restitution,
        friction=friction,
        law=law,
        tolerance=tolerance,
    )
    return path, axes


def mean_path(
    response: tuple[float, float, float, float, float],
    velocity: tuple[float, float, float],
    *,
    restitution: float,
    friction: float,
    law: RestitutionLaw,
    tolerance: float,
) -> SpatialPath:
    """Return the path of the impulse of contacts that strike as one.

    The response, 1/kg, of their mean velocity is l_1, l_2, k_1, k_2 and k_n of `SlidingLaw`. This velocity,
    m/s, is by the two tangents and the normal. What slides less fast than ``tolerance`` does not slide.
    """
    l1, l2, k1, k2, kn = response
    u1, u2, v_n = velocity
    if l1 <= NO_SHARED_RESPONSE * kn:
        l1, k1, u1 = kn, 0.0, 0.0  # equal impulses along this tangent move nothing
    if l2 <= NO_SHARED_RESPONSE * kn:
        l2, k2, u2 = kn, 0.0, 0.0
    if float(np.hypot(u1, u2)) <= tolerance:
        u1 = u2 = 0.0
    ends_by = law
    sticking = kn - k1 * k1 / l1 - k2 * k2 / l2
    if sticking <= NO_SHARED_RESPONSE * kn:  # in a groove, equal impulses at contacts that stick move nothing
        kn += NO_SHARED_RESPONSE * kn - sticking
        if float(np.hypot(k1 / l1, k2 / l2)) <= friction * (1.0 + NO_SHARED_RESPONSE):
            ends_by = RestitutionLaw.POISSON  # no impulse ends restitution by a velocity or by work
    sliding = SlidingLaw(l1, l2, k1, k2, kn, friction)
    return trace(sliding, (u1, u2), v_n, restitution=restitution, law=ends_by)


def _axes(response: Response, velocities: FloatArray, normals: FloatArray, tolerance: float) -> FloatArray:
    """Return for each contact, as rows, (k, 3, 3), two tangents and the normal, which go with the contact.

    The first tangent is the direction in which the contact slides, or would begin to slide if all normals had
    the same impulse. Where there is none beside contacts that have one, tangents are zero: no friction acts.
    Where no contact has one, no friction acts anywhere, and tangents do not matter.
    """
    pushed_by_normals = (
        response.jacobian @ response.inverse_mass @ np.einsum("ijk,ij->k", response.jacobian, normals)
    )
    axes = np.zeros((len(normals), 3, 3))
    for own, normal, velocity, tendency in zip(axes, normals, velocities, pushed_by_normals, strict=True):
        own[2] = normal
        for motion, least in (
            (velocity, tolerance),
            (tendency, NO_SHARED_RESPONSE * float(np.linalg.norm(tendency))),
        ):
            across = motion - (motion @ normal) * normal
            size = float(np.linalg.norm(across))
            if size > least:
                own[0] = across / size
                own[1] = cross_of_two(normal, own[0])
                break
    if not axes[:, 0].any():
        for own, normal in zip(axes, normals, strict=True):
            own[:2] = tangents_by_sign(tuple(normal.tolist()))
    return axes
