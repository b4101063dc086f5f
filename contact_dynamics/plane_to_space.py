"""From a planar answer back to space: whether it holds there, and what it says of the body in space.

A planar problem is one of space too where every contact lies in the plane of motion, or has a like one on the
other side: then contact forces can balance about the axes in the plane, and like contacts carry equal shares.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.errors import OutOfPlaneError
from contact_dynamics.planar import PlanarVelocity
from contact_dynamics.tolerances import OUT_OF_PLANE_RATIO

if TYPE_CHECKING:
    from contact_dynamics.contact import ContactSet
    from contact_dynamics.plane_of_motion import PlanarProblem, PlaneOfMotion
    from contact_dynamics.rigid_body import BodyState
    from contact_dynamics.validation import FloatArray


def mirror_partners(
    plane: PlaneOfMotion, state: BodyState, contacts: ContactSet, *, distance_tolerance: float
) -> tuple[int, ...]:
    """Return, for each contact, the one that is its mirror image in the plane; itself where it lies in it.

    -1: there is none. Positions may be off by `OUT_OF_PLANE_RATIO` of the farthest contact's distance, or by
    ``distance_tolerance``, m, where that is more; normals by that ratio; frictions are equal.
    """
    arms = contacts.p_WC_W - state.p_WB_W
    reach = float(np.linalg.norm(arms, axis=1).max(initial=0.0))
    near = max(distance_tolerance, OUT_OF_PLANE_RATIO * reach)
    depths = arms @ plane.normal_W
    partners = np.where(np.abs(depths) <= near, np.arange(len(contacts)), -1)
    mirrored = arms - 2.0 * depths[:, None] * plane.normal_W
    for i in range(len(contacts)):
        if partners[i] >= 0:
            continue
        off = np.linalg.norm(arms - mirrored[i], axis=1)
        alike = (partners < 0) & (contacts.frictions == contacts.frictions[i])
        alike &= (
            np.linalg.norm(contacts.normals_W - contacts.normals_W[i], axis=1) <= 2.0 * OUT_OF_PLANE_RATIO
        )
        off[~alike] = np.inf
        nearest = int(off.argmin())
        if off[nearest] <= 2.0 * near:
            partners[i], partners[nearest] = nearest, i
    return tuple(partners.tolist())


def check_mirrored(
    plane: PlaneOfMotion, state: BodyState, contacts: ContactSet, *, distance_tolerance: float
) -> None:
    """Refuse contacts that lie beside the plane of motion without a like one on its other side.

    Raises:
        OutOfPlaneError: with the first such contact and how far from the plane it is.
    """
    partners = mirror_partners(plane, state, contacts, distance_tolerance=distance_tolerance)
    if -1 in partners:
        alone = partners.index(-1)
        depth = abs(float((contacts.p_WC_W[alone] - state.p_WB_W) @ plane.normal_W))
        raise OutOfPlaneError(
            f"contacts.positions[{alone}]",
            f"{depth:.6g} m beside the plane with normal {plane.normal_W.tolist()}",
            "a contact in the plane through the centre of mass, or a like one on its other side",
        )


def equal_shares(forces_W: FloatArray, partners: tuple[int, ...]) -> FloatArray:
    """Return planar contact forces, (n, 3), shared equally between each contact and its mirror image."""
    shared: FloatArray = 0.5 * (forces_W + forces_W[[i if j < 0 else j for i, j in enumerate(partners)]])
    return shared


def with_planar_velocity(problem: PlanarProblem, state: BodyState, velocity: PlanarVelocity) -> BodyState:
    """Return the state of a planar problem with another velocity in the plane; what is out of it stays."""
    (v_x, v_y), (before_x, before_y) = velocity.v, problem.velocity.v
    plane = problem.plane
    return replace(
        state,
        v_WB_W=state.v_WB_W + plane.lift((v_x - before_x, v_y - before_y)),
        w_WB_W=state.w_WB_W + (velocity.w - problem.velocity.w) * plane.normal_W,
    )


def planar_velocity(plane: PlaneOfMotion, state: BodyState) -> PlanarVelocity:
    """Return the velocity that the plane of motion sees."""
    x, y = plane.axes_W @ state.v_WB_W
    return PlanarVelocity(v=(float(x), float(y)), w=float(state.w_WB_W @ plane.normal_W))
