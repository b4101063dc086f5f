"""Impacts, in space and in a plane of motion, at one contact and at several, to messages."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.impact import SeveralVerdict
from contact_dynamics.rigid_body import kinetic_energy
from contact_dynamics.tolerances import ENERGY_TOLERANCE
from contact_dynamics_interfaces.msg import Impact as ImpactMsg
from msg_adapters.contacts import flat

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.impact import (
        ImpactDistribution,
        OrderedOutcomes,
        PlanarImpact,
        SeveralImpact,
        SpatialImpact,
    )
    from contact_dynamics.planar import Vector2
    from contact_dynamics.plane_of_motion import PlanarProblem
    from contact_dynamics.rigid_body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray
    from contact_dynamics_interfaces.msg import BodyState as BodyStateMsg


@dataclass(frozen=True, slots=True, kw_only=True)
class Before:
    """A body just before an impact."""

    body: MassProperties
    state: BodyState
    state_to_msg: Callable[[BodyState], BodyStateMsg]  # any state of this body as a message


def spatial_impact_to_msg(impact: SpatialImpact, before: Before, other: Before | None = None) -> ImpactMsg:
    """Return an impact at one contact in space, of a body with the world or with another body."""
    msg = ImpactMsg(
        restitution_law=int(impact.law),
        outcome=int(impact.outcome),
        jams=impact.jams,
        converged=True,
        state_after=before.state_to_msg(impact.state),
        impulses=flat(impact.impulse_W),
        compression_impulses=flat(impact.compression_W),
        contact_velocities_before=flat(impact.velocity_before_W),
        contact_velocities_after=flat(impact.velocity_after_W),
        path=flat(impact.path_W),
        path_events=[int(event) for event in impact.path_events],
        path_contacts=[0] * len(impact.path_events),
        kinetic_energy_before=kinetic_energy(before.body, before.state),
        kinetic_energy_after=kinetic_energy(before.body, impact.state),
        creates_energy=impact.creates_energy,
    )
    if other is not None and impact.other_state is not None:
        msg.other_state_after = [other.state_to_msg(impact.other_state)]
        msg.kinetic_energy_before += kinetic_energy(other.body, other.state)
        msg.kinetic_energy_after += kinetic_energy(other.body, impact.other_state)
    return msg


def several_impact_to_msg(impact: SeveralImpact, before: Before) -> ImpactMsg:
    """Return an impact at several contacts in space."""
    energy_before = kinetic_energy(before.body, before.state)
    energy_after = kinetic_energy(before.body, impact.state)
    msg = ImpactMsg(
        restitution_law=int(impact.restitution_law),
        several_contacts_law=int(impact.law),
        outcome=ImpactMsg.NOT_TOLD,
        converged=impact.verdict == SeveralVerdict.RESOLVED,
        state_after=before.state_to_msg(impact.state),
        impulses=flat(impact.impulses_W),
        contact_velocities_before=flat(impact.velocities_before_W),
        contact_velocities_after=flat(impact.velocities_after_W),
        kinetic_energy_before=energy_before,
        kinetic_energy_after=energy_after,
        creates_energy=energy_after - energy_before > ENERGY_TOLERANCE * energy_before,
    )
    if impact.strikes:
        _add_strikes(msg, impact)
    return msg


def write_orders(msg: ImpactMsg, outcomes: OrderedOutcomes) -> None:
    """Write the outcomes over the admissible orders into an impact."""
    msg.orders = [",".join(map(str, order)) for order in outcomes.orders]
    msg.order_velocities = flat(outcomes.velocities_W)


def write_distribution(msg: ImpactMsg, distribution: ImpactDistribution) -> None:
    """Write the covariance of the state after an impact, and the probability of each outcome, into it."""
    msg.state_after.covariance = flat(distribution.covariance)
    msg.outcome_probabilities = flat(distribution.probabilities)
    msg.miss_probability = distribution.missed


def _add_strikes(msg: ImpactMsg, impact: SeveralImpact) -> None:
    """Write what only a sequence tells: the outcome, the split of each contact's impulse, and the paths."""
    hardest = max(impact.strikes, key=lambda strike: float(strike[1].impulse_W @ strike[1].impulse_W))[1]
    msg.outcome = int(hardest.outcome)
    msg.jams = hardest.jams
    so_far = np.zeros_like(impact.impulses_W)
    compression = np.zeros_like(impact.impulses_W)
    path, events, contacts = [], [], []
    for contact, strike in impact.strikes:
        path.append(so_far[contact] + strike.path_W)
        events += [int(event) for event in strike.path_events]
        contacts += [contact] * len(strike.path_events)
        so_far[contact] += strike.impulse_W
        compression[contact] += strike.compression_W
    msg.compression_impulses = flat(compression)
    msg.path = flat(np.concatenate(path))
    msg.path_events = events
    msg.path_contacts = contacts


def planar_impact_to_msg(impact: PlanarImpact, problem: PlanarProblem, before: Before) -> ImpactMsg:
    """Return an impact at the one contact of a plane of motion, in world axes.

    What is out of the plane stays as it was.
    """
    plane = problem.plane
    tangent, normal = problem.contacts[0].tangent, problem.contacts[0].normal

    def lift(vector_C: Vector2) -> FloatArray:
        t, n = vector_C
        return plane.lift((t * tangent[0] + n * normal[0], t * tangent[1] + n * normal[1]))

    (v_x, v_y), (before_x, before_y) = impact.velocity.v, problem.velocity.v
    after = replace(
        before.state,
        v_WB_W=before.state.v_WB_W + plane.lift((v_x - before_x, v_y - before_y)),
        w_WB_W=before.state.w_WB_W + (impact.velocity.w - problem.velocity.w) * plane.normal_W,
    )
    return ImpactMsg(
        restitution_law=int(impact.law),
        outcome=int(impact.outcome),
        jams=impact.jams,
        converged=True,
        state_after=before.state_to_msg(after),
        impulses=flat(lift(impact.impulse_C)),
        compression_impulses=flat(lift(impact.compression_C)),
        contact_velocities_before=flat(lift(impact.velocity_before_C)),
        contact_velocities_after=flat(lift(impact.velocity_after_C)),
        path=flat(np.array([lift(vertex) for _, vertex in impact.path])),
        path_events=[int(event) for event, _ in impact.path],
        path_contacts=[0] * len(impact.path),
        kinetic_energy_before=kinetic_energy(before.body, before.state),
        kinetic_energy_after=kinetic_energy(before.body, after),
        creates_energy=impact.creates_energy,
    )
