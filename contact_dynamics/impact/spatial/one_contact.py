# SPDX-License-Identifier: Apache-2.0
"""A body in space strikes the fixed world, or a second moving body, at one contact.

The model is that of the plane (`impact.planar`): bodies are rigid, the impact has no duration, friction is
Coulomb's, and only the contact's force acts. In space the sliding direction swerves while the impulse grows.
The path obeys an ordinary differential equation in the normal impulse (lecture 27 carried to space; Routh
1860; Keller 1986). It is solved to rounding (`path`), and in closed form where the
direction stays constant. The impulses on two bodies are opposite, so only their relative velocity matters,
and the contact's inverse inertia is the sum of both (`response`).

Of anything else, such as a robot arm, the contact's inverse inertia and velocity are all that matters
(`response_impact`).

The contact transmits a force and no moment, so torsional friction and rolling resistance are left out.
`impact.several` treats several contacts.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from contact_dynamics.contact.pairs import check_one_time, check_with_world
from contact_dynamics.contact.velocities import warn_if_far
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.spatial.path import OUTCOMES
from contact_dynamics.impact.spatial.response import BodyAtContact, Strike, refuse
from contact_dynamics.impact.spatial.result import ResponseImpact, SpatialImpact
from contact_dynamics.tolerances import LARGEST_ARM, LARGEST_NUMBER, VELOCITY_TOLERANCE
from contact_dynamics.validation import (
    check_array,
    check_at_rest,
    check_magnitude,
    check_not_negative,
    check_vector3,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from contact_dynamics.contact.contact import Contact
    from contact_dynamics.impact.law import PathEvent
    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.rigid_body.body import BodyState, HasMassProperties, MassProperties
    from contact_dynamics.validation import FloatArray


def spatial_impact(
    body: HasMassProperties,
    state: BodyState,
    contact: Contact,
    *,
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
) -> SpatialImpact:
    """Return the outcome of a spatial (3-D) impact of ``body`` on the fixed world, or on a moving surface.

    The impact does not change the motion of a surface. The state after the impact is absolute; the velocities
    of the contact and the change of energy are relative to the surface.

    If several contacts touch at the same instant, as when a box lands on an edge or face, pass all of them to
    `several_impact`. `spatial_impacts` computes a batch of impacts in one call. A `FarContactWarning` is
    issued if the contact is outside the shape of the body.

    Args:
        body: A `Body`, or its `MassProperties`.
        state: Pose and velocities just before the impact.
        contact: Contact with its normal into the body, friction and restitution. Its curvatures have no
            effect on the impact.
        restitution_law: Law of restitution, which defines the coefficient of restitution.
        velocity_tolerance: m/s, >= 0. Normal and tangential components of the contact's velocity up to it
            count as zero.

    Raises:
        SeparatingContactError: the contact's normal velocity is above the tolerance.
        InvalidFieldError: the tolerance is negative; or a velocity, a mass, a moment of inertia or the
            distance of the contact from a centre of mass exceeds `LARGEST_NUMBER`, or a mass or moment of
            inertia is below its inverse.

    Examples:
        >>> import contact_dynamics as cd
        >>> ball = cd.Body.sphere(0.03, mass=0.057)
        >>> falling = cd.BodyState(p_WB_W=[0, 0, 0.03], q_WB=[0, 0, 0, 1], v_WB_W=[2, 0, -5])
        >>> floor = cd.Contact(p_WC_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.7)
        >>> impact = cd.spatial_impact(ball, falling, floor)
        >>> print(impact.outcome.name, impact.state.v_WB_W.round(2))
        STICKS_IN_COMPRESSION [1.43 0.   3.5 ]
    """
    check_with_world("contact", [contact.surface])
    warn_if_far(body, state, contact.p_WC_W)
    body = body.mass_properties
    return _impact(
        body, state, None, None, contact, law=restitution_law, velocity_tolerance=velocity_tolerance
    )


def spatial_pair_impact(
    body: HasMassProperties,
    state: BodyState,
    other: HasMassProperties,
    other_state: BodyState,
    contact: Contact,
    *,
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
) -> SpatialImpact:
    """Return the outcome of a spatial (3-D) impact of two bodies at one contact.

    The contact transmits no moment. If edges or faces meet, pass all contacts to `bodies_impact`.

    Args:
        body: First body, into which the normal points.
        state: State of the first body just before the impact.
        other: Second body.
        other_state: State of the second body just before the impact.
        contact: Contact with its normal into the first body, friction and restitution.
        restitution_law: Law of restitution, which defines the coefficient of restitution.
        velocity_tolerance: m/s, >= 0. Normal and tangential components of the relative velocity up to it
            count as zero.

    Raises:
        SeparatingContactError: the contact's relative normal velocity is above the tolerance.
        InvalidFieldError: the tolerance is negative; or a velocity, a mass, a moment of inertia or the
            distance of the contact from a centre of mass exceeds `LARGEST_NUMBER`, or a mass or moment of
            inertia is below its inverse; or the stamps of the states differ.
    """
    check_one_time((state, other_state), "other_state")
    warn_if_far(body, state, contact.p_WC_W)
    warn_if_far(other, other_state, contact.p_WC_W)
    body = body.mass_properties
    other = other.mass_properties
    return _impact(
        body, state, other, other_state, contact, law=restitution_law, velocity_tolerance=velocity_tolerance
    )


def response_impact(
    inverse_inertia_W: ArrayLike,
    velocity_W: ArrayLike,
    contact: Contact,
    *,
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
) -> ResponseImpact:
    """Return the outcome of an impact of a mechanism, such as a robot arm or several joined bodies.

    The mechanism is described by the response of its contact point to impulses, W = J M^-1 J^T, where M is
    the mass matrix and J the Jacobian of the contact point. An impulse I changes the generalized velocities
    by M^-1 J^T I. If two mechanisms collide, W is the sum of both, and the velocity is that of the first
    relative to the second. Actuators and springs contribute no impulse, since the impact is instantaneous.

    W may be singular: a planar arm, for example, cannot move across its plane. Along a tangent in which the
    contact cannot move, the motion does not determine friction, which is zero there while the contact sticks.
    Responses below `SINGULAR_RESPONSE` of the largest count as zero, and so does sliding along such a tangent
    below this share of the velocity.

    Args:
        inverse_inertia_W: (3, 3), 1/kg, W, world axes, symmetric and positive semidefinite.
        velocity_W: (3,), m/s, velocity of the contact point just before the impact, world axes. If the
            contact has a moving surface, the velocities of the result are relative to the surface.
        contact: Contact with its normal into the mechanism, friction and restitution. Its position and
            curvatures have no effect.
        restitution_law: Law of restitution, which defines the coefficient of restitution.
        velocity_tolerance: m/s, >= 0. Normal and tangential components of the contact's velocity up to it
            count as zero.

    Raises:
        SeparatingContactError: the contact's normal velocity is above the tolerance.
        InvalidFieldError: the tolerance is negative; a velocity or W exceeds `LARGEST_NUMBER`; W is below its
            inverse, is not symmetric or has a negative eigenvalue; the mechanism cannot move along the
            normal; or it wedges: friction holds the contact, which then cannot move along the normal either,
            although by ``restitution_law`` it would have to separate, or it still approaches.
    """
    if np.shape(inverse_inertia_W) == (2, 2):
        raise InvalidFieldError(
            "inverse_inertia_W",
            "shape (2, 2)",
            "of shape (3, 3)",
            hint="for a planar mechanism, add a row and a column of zeros across its plane",
        )
    response = check_array("inverse_inertia_W", inverse_inertia_W, (3, 3))
    check_magnitude("inverse_inertia_W", response)
    velocity = check_vector3("velocity_W", velocity_W)
    if contact.surface_velocity_W is not None:
        velocity = velocity - contact.surface_velocity_W
    restitution = contact.impact_restitution
    tolerance = check_not_negative("velocity_tolerance", velocity_tolerance)
    vertices: list[tuple[PathEvent, Vector3]] = []
    strike = Strike(restitution_law, vertices)
    outcome = strike.strike_mechanism(
        tuple(response.ravel().tolist()),
        tuple(velocity.tolist()),
        tuple(contact.normal_W.tolist()),
        contact.friction,
        restitution,
        tolerance,
    )
    if outcome < 0:
        refuse(strike, outcome, tolerance, field="inverse_inertia_W")
    return ResponseImpact(
        inverse_inertia_W=0.5 * (response + response.T),
        **_at_contact(strike, restitution_law, outcome, vertices),
    )


def _at_contact(
    strike: Strike, law: RestitutionLaw, outcome: int, vertices: list[tuple[PathEvent, Vector3]]
) -> dict[str, Any]:
    """Return what happened at the contact, by the fields of `ResponseImpact`."""
    impulse, compression, before, after = np.array(
        (strike.impulse, strike.compression, strike.before, strike.after)
    )
    return {
        "restitution_law": law,
        "outcome": OUTCOMES[outcome],
        "jams": strike.tracer.jams,
        "impulse_W": impulse,
        "compression_W": compression,
        "path_W": np.array([vertex for _, vertex in vertices]) @ np.array((strike.t1, strike.t2, strike.n)),
        "path_events": tuple(event for event, _ in vertices),
        "velocity_before_W": before,
        "velocity_after_W": after,
    }


def _impact(
    body: MassProperties,
    state: BodyState,
    other: MassProperties | None,
    other_state: BodyState | None,
    contact: Contact,
    *,
    law: RestitutionLaw,
    velocity_tolerance: float,
) -> SpatialImpact:
    """Return the impact of a body on ``other``, or on the fixed world if ``other`` is None."""
    if other is not None:
        check_at_rest("contact", contact, "spatial_pair_impact")
    restitution = contact.impact_restitution
    tolerance = check_not_negative("velocity_tolerance", velocity_tolerance)

    vertices: list[tuple[PathEvent, Vector3]] = []
    strike = Strike(law, vertices)
    relative = state
    if contact.surface_velocity_W is not None:
        relative = state.with_velocities(state.v_WB_W - contact.surface_velocity_W, state.w_WB_W)
    _take(strike.body, body, relative, contact.p_WC_W)
    has_other = other is not None and other_state is not None
    if other is not None and other_state is not None:
        _take(strike.other, other, other_state, contact.p_WC_W)
    n_x, n_y, n_z = contact.normal_W.tolist()
    outcome = strike.strike((n_x, n_y, n_z), contact.friction, restitution, has_other, tolerance)
    if outcome < 0:
        refuse(strike, outcome, tolerance)
    l1, l2, k1, k2, kn = strike.l1, strike.l2, strike.k1, strike.k2, strike.kn
    axes = np.array((strike.t1, strike.t2, strike.n))
    matrix = np.array(((l1, 0.0, k1), (0.0, l2, k2), (k1, k2, kn)))
    v: ArrayLike = strike.body.v
    if relative is not state:
        v = state.v_WB_W + (np.array(v) - relative.v_WB_W)
    return SpatialImpact(
        **_at_contact(strike, law, outcome, vertices),
        state=state.with_velocities(v, strike.body.w),
        inverse_inertia_W=axes.T @ matrix @ axes,
        other_state=None
        if other_state is None
        else other_state.with_velocities(strike.other.v, strike.other.w),
    )


def contact_inverse_inertia(body: MassProperties, state: BodyState, arm: FloatArray) -> FloatArray:
    """Return the change of a point's velocity per impulse there, (3, 3), 1/kg, world (lecture 27, eq. 7).

    Of the state, the attitude alone matters. The arm, (3,), m, is from the centre of mass to the point.
    """
    axes = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    at_contact = BodyAtContact()
    _take(at_contact, body, state, state.p_WB_W + arm)
    aa, ab, an, bb, bn, nn = at_contact.response(*axes)
    return np.array([[aa, ab, an], [ab, bb, bn], [an, bn, nn]])


def check_striking(body: MassProperties, state: BodyState, points_W: FloatArray) -> None:
    """Refuse a body, a motion or contact points, (n, 3) or (3,), whose products doubles do not hold.

    Raises:
        InvalidFieldError: a velocity, or the distance of a contact from the centre of mass, is beyond
            `LARGEST_NUMBER`; the mass or a moment of inertia is, or is below its inverse; or a contact is
            farther than `LARGEST_ARM` radii of gyration from the centre of mass.
    """
    arms = (points_W - state.p_WB_W).ravel().tolist()
    for field, numbers in (
        ("p_WC_W", arms),
        ("v_WB_W", state.v_WB_W.tolist()),
        ("w_WB_W", state.w_WB_W.tolist()),
    ):
        if numbers and (max(numbers) > LARGEST_NUMBER or min(numbers) < -LARGEST_NUMBER):
            raise InvalidFieldError(field, numbers, f"at most {LARGEST_NUMBER:g} in magnitude")
    components = iter(arms)
    squares = [x * x + y * y + z * z for x, y, z in zip(components, components, components, strict=True)]
    farthest = math.sqrt(max(squares, default=0.0))
    gyration = math.sqrt(max(body.I_B.diagonal().tolist()) / body.mass)
    if farthest > LARGEST_ARM * gyration:
        found = f"{farthest:g} m from the centre of mass"
        raise InvalidFieldError("p_WC_W", found, f"{LARGEST_ARM:g} radii of gyration at most")


def _take(at_contact: BodyAtContact, body: MassProperties, state: BodyState, point: FloatArray) -> None:
    if not at_contact.take(
        body.mass,
        tuple(body.I_B.ravel().tolist()),
        tuple(state.q_WB.tolist()),
        tuple((point - state.p_WB_W).tolist()),
        tuple(state.v_WB_W.tolist()),
        tuple(state.w_WB_W.tolist()),
    ):
        check_striking(body, state, point)
