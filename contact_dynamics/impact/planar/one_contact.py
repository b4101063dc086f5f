# SPDX-License-Identifier: Apache-2.0
"""A planar body strikes the world at one contact (Mason, lecture 27).

The model is Routh's analysis in impulse space (`routh`), with Poisson's, Newton's or the energetic law of
restitution. Bodies are rigid, the impact takes no time, friction is Coulomb's with one coefficient, and only
the contact acts. A contact that rests (its normal velocity is zero) gets an impulse only if its own sliding
drives it into compression. In this way an inconsistent contact mode (lecture 26) is settled.

Other files treat several contacts at once (`impact.several`), and space and two bodies (`impact.spatial`).
"""

from __future__ import annotations

from typing import NoReturn

from contact_dynamics.errors import NORMAL_HINT, SeparatingContactError
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.planar.result import PlanarImpact
from contact_dynamics.impact.planar.routh import PlanarStrike
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity
from contact_dynamics.records import made
from contact_dynamics.tolerances import LARGEST_NUMBER, VELOCITY_TOLERANCE
from contact_dynamics.validation import check_not_negative


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
