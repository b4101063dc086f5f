# SPDX-License-Identifier: Apache-2.0
"""A planar body strikes the fixed world, or a second moving body, at one contact (Mason, lecture 27).

The model is Routh's analysis in impulse space (`routh`), with Poisson's, Newton's or the energetic law of
restitution. Bodies are rigid, the impact takes no time, friction is Coulomb's with one coefficient, and only
the contact acts. A contact that rests (its normal velocity is zero) gets an impulse only if its own sliding
drives it into compression. In this way an inconsistent contact mode (lecture 26) is settled.

The impulses on two bodies are opposite. So the contact's relative velocity responds with the sum of the two
inverse inertias, and the laws for one body and the fixed world apply unchanged (Routh 1860; Stronge 2000, ch.
3 and 4). The linear and the angular momentum of both together are conserved to rounding.

Other files treat several contacts at once (`impact.several`) and space (`impact.spatial`).
"""

from __future__ import annotations

from dataclasses import replace
from typing import NoReturn

from contact_dynamics.errors import NORMAL_HINT, SeparatingContactError
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.planar.result import PlanarImpact
from contact_dynamics.impact.planar.routh import PlanarStrike, impulse_path, pair_inverse_inertia
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity, Vector2, check_vector2
from contact_dynamics.records import made
from contact_dynamics.tolerances import LARGEST_NUMBER, VELOCITY_TOLERANCE
from contact_dynamics.validation import check_at_rest, check_not_negative


def planar_impact(
    body: PlanarBody,
    velocity: PlanarVelocity,
    contact: PlanarContact,
    *,
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
) -> PlanarImpact:
    """Return the outcome of a planar impact of ``body`` on the fixed world, or on a moving surface.

    A surface of the world that moves keeps its velocity. The velocity afterwards is absolute, and the
    contact's velocities and the change of energy are relative to the surface.

    Args:
        body: Mass and angular inertia.
        velocity: Velocity of the body just before the impact.
        contact: Contact with its normal, friction and restitution.
        restitution_law: Law of restitution, which defines the coefficient of restitution.
        velocity_tolerance: m/s, >= 0. Normal and tangential components of the contact's velocity up to it
            count as zero.

    Raises:
        SeparatingContactError: the contact's normal velocity is above the tolerance.
        InvalidFieldError: the law is not a member of RestitutionLaw, the tolerance is negative, or the
            numbers are so large that the velocity overflows.

    Source: lecture 27, eqs. 2 to 10; Routh 1860; Stronge 1990 for the energetic law.
    """
    restitution = contact.impact_restitution
    tolerance = check_not_negative("velocity_tolerance", velocity_tolerance)
    (v_x, v_y), (s_x, s_y) = velocity.v, contact.surface_velocity
    strike = PlanarStrike(restitution_law)
    if not strike.strike(
        body.mass,
        body.inertia,
        contact.friction,
        restitution,
        v_x - s_x,
        v_y - s_y,
        velocity.w,
        *contact.r,
        *contact.normal,
        tolerance,
    ):
        refuse_separating(strike.v_n_before, tolerance)
    after = strike.v_x, strike.v_y
    if s_x != 0.0 or s_y != 0.0:
        after = v_x + (strike.v_x - (v_x - s_x)), v_y + (strike.v_y - (v_y - s_y))
    if not max(abs(after[0]), abs(after[1]), abs(strike.w)) <= LARGEST_NUMBER:
        PlanarVelocity(v=after, w=strike.w)  # which raises the error
    return made(
        PlanarImpact,
        restitution_law,
        made(PlanarVelocity, after, strike.w),
        (strike.v_t_before, strike.v_n_before),
        strike.response,
        strike.path,
        (strike.i_x, strike.i_y),
        None,
    )


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

    Velocities and impulses of the contact are those of the first body, relative to the second.

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
        velocity=_pushed(body, velocity, (r_x, r_y), (i_x, i_y)),
        velocity_before_C=(v_t, v_n),
        inverse_inertia=response,
        contact_path=path,
        impulse=(i_x, i_y),
        other_velocity=_pushed(other, other_velocity, (s_x, s_y), (-i_x, -i_y)),
    )


def _pushed(body: PlanarBody, velocity: PlanarVelocity, r: Vector2, impulse: Vector2) -> PlanarVelocity:
    (v_x, v_y), (r_x, r_y), (i_x, i_y) = velocity.v, r, impulse
    moment = r_x * i_y - r_y * i_x
    return replace(
        velocity, v=(v_x + i_x / body.mass, v_y + i_y / body.mass), w=velocity.w + moment / body.inertia
    )


def refuse_separating(v_n: float, tolerance: float, case: str = "") -> NoReturn:
    """Raise the error of a contact, m/s, that separates.

    Raises:
        SeparatingContactError: always.
    """
    raise SeparatingContactError(
        f"contact normal velocity{case}",
        f"v_n = {v_n:.9g} m/s",
        f"at most {tolerance:g} m/s, since a contact that separates faster has no impact ({NORMAL_HINT})",
    )
