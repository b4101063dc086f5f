# SPDX-License-Identifier: Apache-2.0
"""From the plane to space: whether a planar answer holds there, and a problem in space with a planar motion.

A planar answer holds in space if every contact lies in the plane of motion, or has an equal contact at its
mirror image on the other side. Then contact forces can balance about the axes in the plane, and mirrored
contacts carry equal shares.

A planar problem becomes a problem in space with the same motion. The body in space has equal moments of
inertia about all axes. Then nothing couples its motion in the plane to motion out of it, and it moves in the
plane as the planar body does.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.contact.contact import ContactSet, all_or_none, static_or_none
from contact_dynamics.errors import InvalidFieldError, OutOfPlaneError
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.tolerances import OUT_OF_PLANE_RATIO, UNIT_LENGTH_TOLERANCE
from contact_dynamics.validation import FloatArray, check_array

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from contact_dynamics.plane.projection import PlanarProblem, PlaneOfMotion


def mirror_partners(
    plane: PlaneOfMotion, state: BodyState, contacts: ContactSet, *, distance_tolerance: float
) -> tuple[int, ...]:
    """Return, for each contact, the index of its mirror image in the plane, or -1 if there is none.

    A contact in the plane is its own mirror image. Positions may be off by `OUT_OF_PLANE_RATIO` of the
    farthest contact's distance, or by ``distance_tolerance``, m, if that is more. Normals may be off by that
    ratio. Frictions must be equal.
    """
    n_x, n_y, n_z = plane.normal_W.tolist()
    points, normals = (contacts.p_WC_W - state.p_WB_W).tolist(), contacts.normals_W.tolist()
    frictions = list(zip(contacts.frictions.tolist(), contacts.holding_frictions.tolist(), strict=True))
    near = max(distance_tolerance, OUT_OF_PLANE_RATIO * max((math.hypot(*p) for p in points), default=0.0))
    depths = [x * n_x + y * n_y + z * n_z for x, y, z in points]
    partners = [i if abs(depth) <= near else -1 for i, depth in enumerate(depths)]
    alone = [i for i, partner in enumerate(partners) if partner < 0]
    while alone:
        i = alone.pop()
        (x, y, z), twice = points[i], 2.0 * depths[i]
        image = (x - twice * n_x, y - twice * n_y, z - twice * n_z)
        best, nearest = 2.0 * near, -1
        for j in alone:
            if abs(depths[i] + depths[j]) <= best and frictions[i] == frictions[j]:
                off = math.dist(image, points[j])
                if off <= best and math.dist(normals[i], normals[j]) <= 2.0 * OUT_OF_PLANE_RATIO:
                    best, nearest = off, j
        if nearest >= 0:
            alone.remove(nearest)
            partners[i], partners[nearest] = nearest, i
    return tuple(partners)


def check_mirrored(
    plane: PlaneOfMotion, state: BodyState, contacts: ContactSet, partners: tuple[int, ...]
) -> None:
    """Refuse contacts that lie beside the plane of motion without a mirror image on its other side.

    ``partners`` are the `mirror_partners` of the contacts.

    Raises:
        OutOfPlaneError: names the first such contact and its distance from the plane.
    """
    if -1 in partners:
        alone = partners.index(-1)
        depth = abs(float((contacts.p_WC_W[alone] - state.p_WB_W) @ plane.normal_W))
        raise OutOfPlaneError(
            f"contacts.p_WC_W[{alone}]",
            f"{depth:.6g} m beside the plane with normal {plane.normal_W.tolist()}",
            "a contact in the plane through the centre of mass, or a like one on its other side",
        )


def equal_shares(forces_W: FloatArray, partners: tuple[int, ...]) -> FloatArray:
    """Return planar contact forces, (n, 3), shared equally between each contact and its mirror image."""
    shared: FloatArray = 0.5 * (forces_W + forces_W[[i if j < 0 else j for i, j in enumerate(partners)]])
    return shared


def with_planar_velocity(problem: PlanarProblem, state: BodyState, velocity: PlanarVelocity) -> BodyState:
    """Return the state with another velocity in the plane. The velocity out of the plane stays."""
    (v_x, v_y), (before_x, before_y) = velocity.v, problem.velocity.v
    plane = problem.plane
    return state.with_velocities(
        state.v_WB_W + plane.lift((v_x - before_x, v_y - before_y)),
        state.w_WB_W + (velocity.w - problem.velocity.w) * plane.normal_W,
    )


def planar_velocity(plane: PlaneOfMotion, state: BodyState) -> PlanarVelocity:
    """Return the part of a velocity in the plane of motion."""
    x, y = plane.axes_W @ state.v_WB_W
    return PlanarVelocity(v=(float(x), float(y)), w=float(state.w_WB_W @ plane.normal_W))


def planar_in_space(
    body: PlanarBody, velocity: PlanarVelocity, contacts: Sequence[PlanarContact], *, axes_W: ArrayLike
) -> tuple[MassProperties, BodyState, ContactSet]:
    """Return a spatial problem equivalent to a planar one; ``axes_W`` are the plane's x and y axes, (2, 3).

    Raises:
        InvalidFieldError: the axes are not two unit vectors at right angles.
    """
    axes = check_array("axes_W", axes_W, (2, 3))
    unit = np.abs(axes).max() <= 1.0 + UNIT_LENGTH_TOLERANCE
    if not unit or np.abs(axes @ axes.T - np.eye(2)).max() > UNIT_LENGTH_TOLERANCE:
        raise InvalidFieldError("axes_W", axes.tolist(), "two unit vectors at right angles")
    normal = np.cross(axes[0], axes[1])
    state = BodyState(
        p_WB_W=np.zeros(3),
        q_WB=np.array([0.0, 0.0, 0.0, 1.0]),
        v_WB_W=np.array(velocity.v) @ axes,
        w_WB_W=velocity.w * normal,
    )
    touching = ContactSet(
        p_WC_W=np.array([contact.r for contact in contacts]).reshape(-1, 2) @ axes,
        normals_W=np.array([contact.normal for contact in contacts]).reshape(-1, 2) @ axes,
        frictions=np.array([contact.friction for contact in contacts]),
        restitutions=all_or_none([contact.restitution for contact in contacts]),
        surface_velocities_W=np.array([one.surface_velocity for one in contacts]).reshape(-1, 2) @ axes,
        surface_angular_velocities_W=np.outer([one.surface_angular_velocity for one in contacts], normal),
        surface_accelerations_W=np.array([one.surface_acceleration for one in contacts]).reshape(-1, 2)
        @ axes,
        static_frictions=static_or_none(
            [contact.static_friction for contact in contacts], [contact.friction for contact in contacts]
        ),
    )
    return MassProperties(mass=body.mass, I_B=body.inertia * np.eye(3)), state, touching
