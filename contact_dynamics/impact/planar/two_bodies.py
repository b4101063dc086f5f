# SPDX-License-Identifier: Apache-2.0
"""Two planar bodies strike each other. Their relative velocity makes this one problem.

The impulses on the two bodies are opposite. So the contact's relative velocity responds with the sum of the
two inverse inertias, and the laws for one body and the fixed world apply unchanged (Routh 1860; Stronge 2000,
ch. 3 and 4). The *first* body is the one that the normal points into. Velocities and impulses in the answer
are those of the first body. Velocities of the contact are those of the first body relative to the second. The
linear and the angular momentum of both together are conserved to rounding.
"""

from __future__ import annotations

from dataclasses import replace

from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.planar.one_contact import refuse_separating
from contact_dynamics.impact.planar.result import PlanarImpact
from contact_dynamics.impact.planar.routh import impulse_path, pair_inverse_inertia
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity, Vector2, check_vector2
from contact_dynamics.tolerances import VELOCITY_TOLERANCE
from contact_dynamics.validation import check_at_rest, check_not_negative


def planar_pair_impact(
    body: PlanarBody,
    velocity: PlanarVelocity,
    other: PlanarBody,
    other_velocity: PlanarVelocity,
    contact: PlanarContact,
    *,
    other_r: Vector2,
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
) -> PlanarImpact:
    """Return the outcome of an impact of two planar bodies.

    Args:
        body: First body, into which the contact's normal points.
        velocity: Velocity of the first body just before the impact.
        other: Second body.
        other_velocity: Velocity of the second body just before the impact.
        contact: Contact relative to the first body's centre of mass, with its normal, friction and
            restitution.
        other_r: m, position of the contact relative to the second body's centre of mass.
        restitution_law: Law of restitution, which defines the coefficient of restitution.
        velocity_tolerance: m/s, >= 0. Components of the relative velocity up to it count as zero.

    Raises:
        SeparatingContactError: the contact's relative normal velocity is above the tolerance.
        InvalidFieldError: a number is not finite, or the tolerance is negative.
    """
    check_at_rest("contact", contact, "planar_pair_impact")
    restitution = contact.impact_restitution
    tolerance = check_not_negative("velocity_tolerance", velocity_tolerance)
    n_x, n_y = contact.normal
    r_x, r_y = contact.r
    s_x, s_y = check_vector2("other_r", other_r)
    (v_x, v_y), w = velocity.v, velocity.w
    (u_x, u_y), z = other_velocity.v, other_velocity.w
    c_x = (v_x - u_x) - (w * r_y - z * s_y)
    c_y = (v_y - u_y) + (w * r_x - z * s_x)
    v_t, v_n = c_x * n_y - c_y * n_x, c_x * n_x + c_y * n_y
    if v_n > tolerance:
        refuse_separating(v_n, tolerance)
    v_t, v_n = 0.0 if -tolerance <= v_t <= tolerance else v_t, 0.0 if v_n >= -tolerance else v_n
    response = pair_inverse_inertia(
        (body.mass, body.inertia, r_x * n_y - r_y * n_x, r_x * n_x + r_y * n_y),
        (other.mass, other.inertia, s_x * n_y - s_y * n_x, s_x * n_x + s_y * n_y),
    )
    path = impulse_path(v_t, v_n, response, contact.friction, restitution, restitution_law)
    i_x = path.t_end * n_y + path.p_end * n_x
    i_y = path.p_end * n_y - path.t_end * n_x
    return PlanarImpact(
        restitution_law=restitution_law,
        velocity=_planar_pushed(body, velocity, (r_x, r_y), (i_x, i_y)),
        velocity_before_C=(v_t, v_n),
        inverse_inertia=response,
        contact_path=path,
        impulse=(i_x, i_y),
        other_velocity=_planar_pushed(other, other_velocity, (s_x, s_y), (-i_x, -i_y)),
    )


def _planar_pushed(
    body: PlanarBody, velocity: PlanarVelocity, r: Vector2, impulse: Vector2
) -> PlanarVelocity:
    (v_x, v_y), (r_x, r_y), (i_x, i_y) = velocity.v, r, impulse
    moment = r_x * i_y - r_y * i_x
    return replace(
        velocity, v=(v_x + i_x / body.mass, v_y + i_y / body.mass), w=velocity.w + moment / body.inertia
    )
