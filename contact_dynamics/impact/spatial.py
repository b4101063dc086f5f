"""Impact of one body in space at one contact with the fixed world (lecture 27 carried to space; Keller 1986).

Model: as in the plane (`planar`): rigid, without duration, Coulomb friction, the contact's force alone. In
space the sliding direction swerves while the impulse grows, and the path is an ordinary differential equation
in the normal impulse (`sliding`, `series`, `swerve`), solved to rounding; where the direction stays, in
closed form.

Not covered: torsional friction and rolling resistance (the contact transmits a force, no moment), several
contacts (`several`), two moving bodies (`pair`).
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.errors import SeparatingContactError
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.sliding import SlidingLaw
from contact_dynamics.impact.spatial_result import SpatialImpact
from contact_dynamics.impact.swerve import SpatialPath, trace
from contact_dynamics.tolerances import VELOCITY_TOLERANCE
from contact_dynamics.validation import check_array, check_not_negative, check_unit, check_within

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from contact_dynamics.rigid_body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray


def spatial_impact(
    body: MassProperties,
    state: BodyState,
    *,
    p_WC_W: ArrayLike,
    n_W: ArrayLike,
    friction: float,
    restitution: float,
    law: RestitutionLaw = RestitutionLaw.POISSON,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
) -> SpatialImpact:
    """Return what the impact of ``body`` does.

    Args:
        body: Mass and angular inertia.
        state: Pose and velocities just before.
        p_WC_W: (3,), m, the contact, world.
        n_W: (3,), unit normal into the body, world axes.
        friction: Coulomb's mu, >= 0.
        restitution: e, in [0, 1].
        law: What the coefficient of restitution means.
        velocity_tolerance: m/s, >= 0. A normal or tangential velocity of the contact within it counts as
            zero.

    Raises:
        SeparatingContactError: the contact's normal velocity is above the tolerance.
        InvalidFieldError: a number is not finite, the normal is not unit, mu < 0, or e outside [0, 1].
    """
    normal = check_unit("contact normal", n_W, 3)
    arm = check_array("contact position", p_WC_W, (3,)) - state.p_WB_W
    mu = check_not_negative("friction", friction)
    e = check_within("restitution", restitution, 0.0, 1.0)
    tolerance = check_not_negative("velocity_tolerance", velocity_tolerance)

    inverse = contact_inverse_inertia(body, state, arm)
    before = state.v_WB_W + _cross(state.w_WB_W, arm)
    axes, path = contact_path(
        inverse, normal, before, friction=mu, restitution=e, law=law, tolerance=tolerance
    )
    impulse = axes @ path.impulse
    return SpatialImpact(
        law=law,
        outcome=path.outcome,
        jams=path.jams,
        state=pushed(body, state, arm, impulse),
        impulse_W=impulse,
        compression_W=axes @ path.compression,
        path_W=np.array([vertex for _, vertex in path.vertices]) @ axes.T,
        path_events=tuple(event for event, _ in path.vertices),
        velocity_before_W=before,
        velocity_after_W=axes @ (path.u[0], path.u[1], path.v_n),
        inverse_inertia_W=inverse,
    )


def contact_path(
    inverse_inertia_W: FloatArray,
    normal: FloatArray,
    velocity: FloatArray,
    *,
    friction: float,
    restitution: float,
    law: RestitutionLaw,
    tolerance: float,
) -> tuple[FloatArray, SpatialPath]:
    """Return contact axes as columns, (3, 3), and the impulse path in them, for a contact velocity.

    Raises:
        SeparatingContactError: the normal velocity is above the tolerance.
    """
    axes, sliding = principal_contact_axes(inverse_inertia_W, normal, friction)
    u1, u2, v_n = (axes.T @ velocity).tolist()
    if v_n > tolerance:
        raise SeparatingContactError(
            "contact normal velocity",
            f"v_n = {v_n:.9g} m/s",
            f"at most {tolerance:g} m/s, since above it nothing strikes",
        )
    if math.hypot(u1, u2) <= tolerance:
        u1 = u2 = 0.0
    if v_n >= -tolerance:
        v_n = 0.0
    return axes, trace(sliding, (u1, u2), v_n, restitution=restitution, law=law)


def pushed(body: MassProperties, state: BodyState, arm: FloatArray, impulse: FloatArray) -> BodyState:
    """Return the state after ``impulse``, (3,), N s, at ``arm``, (3,), m from the centre, world axes."""
    turn = np.linalg.solve(body.inertia_in_world(state.R_WB), _cross(arm, impulse))
    return replace(state, v_WB_W=state.v_WB_W + impulse / body.mass, w_WB_W=state.w_WB_W + turn)


def contact_inverse_inertia(body: MassProperties, state: BodyState, arm: FloatArray) -> FloatArray:
    """Return the change of a point's velocity per impulse there, (3, 3), 1/kg, world (lecture 27, eq. 7).

    Args:
        body: Mass and angular inertia.
        state: Gives the attitude.
        arm: (3,), m, from the centre of mass to the point, world axes.
    """
    x, y, z = arm.tolist()
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    inverse: FloatArray = cross.T @ np.linalg.solve(body.inertia_in_world(state.R_WB), cross)
    inverse = 0.5 * (inverse + inverse.T)
    inverse[np.diag_indices(3)] += 1.0 / body.mass
    return inverse


def principal_contact_axes(
    inverse_inertia_W: FloatArray, normal: FloatArray, friction: float
) -> tuple[FloatArray, SlidingLaw]:
    """Return contact axes as columns, (3, 3), world (principal tangents, normal), and the law in them."""
    n_x, n_y, n_z = normal.tolist()
    # Any tangent to begin with: across the axis that is farthest from the normal.
    if abs(n_x) <= abs(n_y) and abs(n_x) <= abs(n_z):
        first = (0.0, n_z, -n_y)
    elif abs(n_y) <= abs(n_z):
        first = (-n_z, 0.0, n_x)
    else:
        first = (n_y, -n_x, 0.0)
    length = math.hypot(*first)
    a = np.array(first) / length
    b = _cross(normal, a)
    a_a, a_b, b_b = (
        float(a @ inverse_inertia_W @ a),
        float(a @ inverse_inertia_W @ b),
        float(b @ inverse_inertia_W @ b),
    )
    angle = 0.5 * math.atan2(2.0 * a_b, a_a - b_b)
    c, s = math.cos(angle), math.sin(angle)
    axes = np.column_stack((c * a + s * b, c * b - s * a, normal))
    response = (axes.T @ inverse_inertia_W @ axes).tolist()
    return axes, SlidingLaw(
        l1=response[0][0],
        l2=response[1][1],
        k1=response[0][2],
        k2=response[1][2],
        kn=response[2][2],
        mu=friction,
    )


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    a_x, a_y, a_z = a.tolist()
    b_x, b_y, b_z = b.tolist()
    return np.array([a_y * b_z - a_z * b_y, a_z * b_x - a_x * b_z, a_x * b_y - a_y * b_x])
