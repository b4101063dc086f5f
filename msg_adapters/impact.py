"""Impacts, in space and in a plane of motion, to messages."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.rigid_body import BodyState, kinetic_energy
from contact_dynamics_interfaces.msg import Impact as ImpactMsg
from msg_adapters.contacts import flat

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.impact.result import PlanarImpact
    from contact_dynamics.impact.spatial_result import SpatialImpact
    from contact_dynamics.planar import Vector2
    from contact_dynamics.plane_of_motion import PlanarProblem
    from contact_dynamics.rigid_body import MassProperties
    from contact_dynamics.validation import FloatArray
    from contact_dynamics_interfaces.msg import BodyState as BodyStateMsg


def spatial_impact_to_msg(
    impact: SpatialImpact,
    *,
    body: MassProperties,
    before: BodyState,
    state_to_msg: Callable[[BodyState], BodyStateMsg],
) -> ImpactMsg:
    """Return an impact at one contact in space."""
    return ImpactMsg(
        restitution_law=int(impact.law),
        outcome=int(impact.outcome),
        jams=impact.jams,
        state_after=state_to_msg(impact.state),
        impulses=flat(impact.impulse_W),
        compression_impulses=flat(impact.compression_W),
        contact_velocities_before=flat(impact.velocity_before_W),
        contact_velocities_after=flat(impact.velocity_after_W),
        path=flat(impact.path_W),
        path_events=[int(event) for event in impact.path_events],
        path_contacts=[0] * len(impact.path_events),
        kinetic_energy_before=kinetic_energy(body, before),
        kinetic_energy_after=kinetic_energy(body, impact.state),
        creates_energy=impact.creates_energy,
    )


def planar_impact_to_msg(
    impact: PlanarImpact,
    problem: PlanarProblem,
    *,
    contact: int,
    body: MassProperties,
    before: BodyState,
    state_to_msg: Callable[[BodyState], BodyStateMsg],
) -> ImpactMsg:
    """Return an impact at one contact of a plane of motion, in world axes; what is out of the plane stays as it was."""
    plane = problem.plane
    tangent, normal = problem.contacts[contact].tangent, problem.contacts[contact].normal

    def lift(vector_C: Vector2) -> FloatArray:
        t, n = vector_C
        return plane.lift((t * tangent[0] + n * normal[0], t * tangent[1] + n * normal[1]))

    (v_x, v_y), (before_x, before_y) = impact.velocity.v, problem.velocity.v
    after = BodyState(
        p_WB_W=before.p_WB_W,
        q_WB=before.q_WB,
        v_WB_W=before.v_WB_W + plane.lift((v_x - before_x, v_y - before_y)),
        w_WB_W=before.w_WB_W + (impact.velocity.w - problem.velocity.w) * plane.normal_W,
        stamp_ns=before.stamp_ns,
    )
    return ImpactMsg(
        restitution_law=int(impact.law),
        outcome=int(impact.outcome),
        jams=impact.jams,
        state_after=state_to_msg(after),
        impulses=flat(lift(impact.impulse_C)),
        compression_impulses=flat(lift(impact.compression_C)),
        contact_velocities_before=flat(lift(impact.velocity_before_C)),
        contact_velocities_after=flat(lift(impact.velocity_after_C)),
        path=flat(np.array([lift(vertex) for _, vertex in impact.path])),
        path_events=[int(event) for event, _ in impact.path],
        path_contacts=[contact] * len(impact.path),
        kinetic_energy_before=kinetic_energy(body, before),
        kinetic_energy_after=kinetic_energy(body, after),
        creates_energy=impact.creates_energy,
    )
