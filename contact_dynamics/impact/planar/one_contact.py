"""A planar body strikes the fixed world at one contact (Mason, lecture 27).

The model is Routh's analysis in impulse space (`routh`), with Poisson's, Newton's or the energetic law of
restitution. Bodies are rigid, the impact takes no time, friction is Coulomb's with one coefficient, and only
the contact acts. A contact that rests (its normal velocity is zero) gets an impulse only if its own sliding
drives it into compression. In this way an inconsistent contact mode (lecture 26) is settled.

Other files treat several contacts at once (`impact.several`), two moving bodies (`two_bodies`) and space
(`impact.spatial`).
"""

from __future__ import annotations

from contact_dynamics.errors import NORMAL_HINT, SeparatingContactError
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.planar.result import PlanarImpact
from contact_dynamics.impact.planar.routh import impulse_path, inverse_inertia
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity, Vector2
from contact_dynamics.tolerances import VELOCITY_TOLERANCE
from contact_dynamics.validation import check_not_negative


def planar_impact(
    body: PlanarBody,
    velocity: PlanarVelocity,
    contact: PlanarContact,
    *,
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
) -> PlanarImpact:
    """Return what the impact of ``body`` at ``contact`` does.

    Args:
        body: Mass and angular inertia.
        velocity: The velocity of the body just before.
        contact: The contact, with its normal, friction and restitution.
        restitution_law: What the coefficient of restitution means.
        velocity_tolerance: m/s, >= 0. A component of the contact's velocity within it counts as zero.

    Raises:
        SeparatingContactError: the contact's normal velocity is above the tolerance.
        InvalidFieldError: the law is no member of RestitutionLaw, the tolerance is negative, or the numbers
            are so large that the velocity overflows.

    Source: lecture 27, eqs. 2 to 10; Routh 1860; Stronge 1990 for the energetic law.
    """
    restitution = contact.impact_restitution
    tolerance = check_not_negative("velocity_tolerance", velocity_tolerance)
    n_x, n_y = contact.normal
    r_x, r_y = contact.r
    v_x, v_y = velocity.v
    w = velocity.w
    c_x = v_x - w * r_y
    c_y = v_y + w * r_x
    v_t, v_n = approach(c_x * n_y - c_y * n_x, c_x * n_x + c_y * n_y, tolerance)
    r_t = r_x * n_y - r_y * n_x
    r_n = r_x * n_x + r_y * n_y
    response = inverse_inertia(body.mass, body.inertia, r_t, r_n)
    path = impulse_path(v_t, v_n, response, contact.friction, restitution, restitution_law)
    i_t = path.t_end
    i_n = path.p_end
    i_x = i_t * n_y + i_n * n_x
    i_y = i_n * n_y - i_t * n_x
    return PlanarImpact(
        restitution_law=restitution_law,
        velocity=PlanarVelocity(
            v=(v_x + i_x / body.mass, v_y + i_y / body.mass), w=w + (r_t * i_n - r_n * i_t) / body.inertia
        ),
        velocity_before_C=(v_t, v_n),
        inverse_inertia=response,
        contact_path=path,
        impulse=(i_x, i_y),
    )


def approach(v_t: float, v_n: float, tolerance: float) -> Vector2:
    """Return the contact's velocity, in which components within ``tolerance`` count as 0.

    Raises:
        SeparatingContactError: ``v_n`` is above the tolerance.
    """
    if v_n > tolerance:
        raise SeparatingContactError(
            "contact normal velocity",
            f"v_n = {v_n:.9g} m/s",
            f"at most {tolerance:g} m/s, since above it nothing strikes ({NORMAL_HINT})",
        )
    return (0.0 if -tolerance <= v_t <= tolerance else v_t, 0.0 if v_n >= -tolerance else v_n)
