"""Impacts, in space and in a plane of motion, at one contact and at several, to messages.

To new messages, or, for ``into``, to the empty ones that a response has already: they cost more to build than
to fill.
"""

from __future__ import annotations

from array import array
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Protocol

import numpy as np

from contact_dynamics.impact import SequenceEnd, SeveralVerdict
from contact_dynamics.impact.energy import created
from contact_dynamics.rigid_body.body import kinetic_energy
from contact_dynamics_interfaces.msg import Impact as ImpactMsg
from contact_dynamics_interfaces.srv import PredictImpact
from msg_adapters.contacts import flat

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from geometry_msgs.msg import Point, Quaternion

    from contact_dynamics.impact import (
        BodiesImpact,
        ImpactDistribution,
        ImpactSequence,
        OrderedOutcomes,
        PlanarImpact,
        SeveralImpact,
        SpatialImpact,
    )
    from contact_dynamics.plane.projection import PlanarProblem
    from contact_dynamics.plane.types import Vector2
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray
    from contact_dynamics_interfaces.msg import BodyState as BodyStateMsg


class StateToMsg(Protocol):
    """Makes a message of a state of a body whose names and frames it knows."""

    def __call__(self, state: BodyState, *, into: BodyStateMsg | None = None) -> BodyStateMsg:
        """Return the state as a message: a new one, or the one to fill."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Before:
    """A body just before an impact."""

    body: MassProperties
    state: BodyState
    state_to_msg: StateToMsg  # any state of this body as a message


def spatial_impact_to_msg(
    impact: SpatialImpact, before: Before, other: Before | None = None, *, into: ImpactMsg | None = None
) -> ImpactMsg:
    """Return an impact at one contact in space, of a body with the world or with another body."""
    msg = ImpactMsg() if into is None else into
    msg.restitution_law = int(impact.restitution_law)
    msg.outcome = int(impact.outcome)
    msg.jams = impact.jams
    msg.converged = True
    before.state_to_msg(impact.state, into=msg.state_after)
    msg.impulses = flat(impact.impulse_W)
    msg.compression_impulses = flat(impact.compression_W)
    msg.contact_velocities_before = flat(impact.velocity_before_W)
    msg.contact_velocities_after = flat(impact.velocity_after_W)
    msg.path = flat(impact.path_W)
    msg.path_events = [int(event) for event in impact.path_events]
    msg.path_contacts = [0] * len(impact.path_events)
    msg.kinetic_energy_before = kinetic_energy(before.body, before.state)
    msg.kinetic_energy_after = kinetic_energy(before.body, impact.state)
    msg.creates_energy = impact.creates_energy
    if other is not None and impact.other_state is not None:
        msg.other_state_after = [other.state_to_msg(impact.other_state)]
        msg.kinetic_energy_before += kinetic_energy(other.body, other.state)
        msg.kinetic_energy_after += kinetic_energy(other.body, impact.other_state)
    return msg


def several_impact_to_msg(
    impact: SeveralImpact, before: Before, *, into: ImpactMsg | None = None
) -> ImpactMsg:
    """Return an impact at several contacts in space, of a body with the world."""
    return _several_to_msg(impact, [before], [impact.state], into)


def pair_impact_to_msg(
    impact: BodiesImpact, before: Before, other: Before, *, into: ImpactMsg | None = None
) -> ImpactMsg:
    """Return an impact of two bodies at several contacts in space."""
    state, other_state = impact.states
    msg = _several_to_msg(impact, [before, other], [state, other_state], into)
    msg.other_state_after = [other.state_to_msg(other_state)]
    return msg


def _several_to_msg(
    impact: SeveralImpact | BodiesImpact,
    before: Sequence[Before],
    after: Sequence[BodyState],
    into: ImpactMsg | None,
) -> ImpactMsg:
    energy_before = sum(kinetic_energy(one.body, one.state) for one in before)
    energy_after = sum(kinetic_energy(one.body, state) for one, state in zip(before, after, strict=True))
    msg = ImpactMsg() if into is None else into
    msg.restitution_law = int(impact.restitution_law)
    msg.several_contacts_law = int(impact.several_contacts_law)
    msg.outcome = ImpactMsg.NOT_TOLD
    msg.converged = impact.verdict == SeveralVerdict.RESOLVED
    before[0].state_to_msg(after[0], into=msg.state_after)
    msg.impulses = flat(impact.impulses_W)
    msg.contact_velocities_before = flat(impact.velocities_before_W)
    msg.contact_velocities_after = flat(impact.velocities_after_W)
    msg.kinetic_energy_before = energy_before
    msg.kinetic_energy_after = energy_after
    msg.creates_energy = created(energy_after - energy_before, energy_before)
    if impact.strikes:
        _add_strikes(msg, impact.strikes, len(impact.impulses_W))
    return msg


def sequence_to_msg(impact: ImpactSequence, before: Before, *, into: ImpactMsg | None = None) -> ImpactMsg:
    """Return strikes in time; there is at least one, and ``before`` is the body just before the first."""
    first = impact.strikes[0].seconds
    impulses = np.zeros((len(impact.contacts), 3))
    velocities_before, velocities_after = np.zeros_like(impulses), np.zeros_like(impulses)
    for strike in reversed(impact.strikes):
        velocities_before[strike.contact] = strike.impact.velocity_before_W
    for strike in impact.strikes:
        impulses[strike.contact] += strike.impact.impulse_W
        velocities_after[strike.contact] = strike.impact.velocity_after_W
    poses = [before.state_to_msg(strike.state_before).pose for strike in impact.strikes]
    msg = ImpactMsg() if into is None else into
    msg.restitution_law = int(impact.restitution_law)
    msg.several_contacts_law = PredictImpact.Request.SEQUENTIAL_IN_TIME
    msg.converged = impact.end != SequenceEnd.MOST_STRIKES
    before.state_to_msg(impact.state, into=msg.state_after)
    msg.impulses = flat(impulses)
    msg.contact_velocities_before = flat(velocities_before)
    msg.contact_velocities_after = flat(velocities_after)
    msg.kinetic_energy_before = kinetic_energy(before.body, before.state)
    msg.kinetic_energy_after = kinetic_energy(before.body, impact.state)
    msg.creates_energy = impact.creates_energy
    msg.strike_times = [strike.seconds - first for strike in impact.strikes]
    msg.strike_contacts = list(impact.order)
    msg.strike_outcomes = [int(strike.impact.outcome) for strike in impact.strikes]
    msg.strike_positions = flat(np.array([strike.p_WC_W for strike in impact.strikes]))
    msg.strike_impulses = flat(np.array([strike.impact.impulse_W for strike in impact.strikes]))
    msg.strike_body_positions = [x for pose in poses for x in _xyz(pose.position)]
    msg.strike_body_orientations = [
        x for pose in poses for x in (*_xyz(pose.orientation), pose.orientation.w)
    ]
    msg.strike_velocities_before = flat(_twists([strike.state_before for strike in impact.strikes]))
    msg.strike_velocities_after = flat(_twists([strike.impact.state for strike in impact.strikes]))
    msg.sequence_end = int(impact.end)
    msg.staying_contacts = list(impact.staying)
    msg.limit_time = 0.0 if impact.limit_seconds is None else impact.limit_seconds - first
    strikes = tuple((strike.contact, strike.impact) for strike in impact.strikes)
    _add_strikes(msg, strikes, len(impact.contacts))
    return msg


def _xyz(point: Point | Quaternion) -> tuple[float, float, float]:
    return point.x, point.y, point.z


def _twists(states: Sequence[BodyState]) -> FloatArray:
    return np.array([np.concatenate([state.v_WB_W, state.w_WB_W]) for state in states])


def write_orders(msg: ImpactMsg, outcomes: OrderedOutcomes) -> None:
    """Write the outcomes over the admissible orders into an impact."""
    msg.orders = [",".join(map(str, order)) for order in outcomes.orders]
    msg.order_velocities = flat(outcomes.velocities_W)


def write_distribution(msg: ImpactMsg, distribution: ImpactDistribution) -> None:
    """Write the covariance of the state after an impact, and the probability of each outcome, into it."""
    msg.state_after.covariance = flat(distribution.covariance)
    msg.outcome_probabilities = flat(distribution.probabilities)
    msg.miss_probability = distribution.missed


def _add_strikes(msg: ImpactMsg, strikes: Sequence[tuple[int, SpatialImpact]], contact_count: int) -> None:
    """Write what only a sequence tells: the outcome, the split of each contact's impulse, and the paths."""
    hardest = max(strikes, key=lambda strike: float(strike[1].impulse_W @ strike[1].impulse_W))[1]
    msg.outcome = int(hardest.outcome)
    msg.jams = hardest.jams
    so_far = np.zeros((contact_count, 3))
    compression = np.zeros((contact_count, 3))
    path, events, contacts = [], [], []
    for contact, strike in strikes:
        path.append(so_far[contact] + strike.path_W)
        events += [int(event) for event in strike.path_events]
        contacts += [contact] * len(strike.path_events)
        so_far[contact] += strike.impulse_W
        compression[contact] += strike.compression_W
    msg.compression_impulses = flat(compression)
    msg.path = flat(np.concatenate(path))
    msg.path_events = events
    msg.path_contacts = contacts


def planar_impact_to_msg(
    impact: PlanarImpact, problem: PlanarProblem, before: Before, *, into: ImpactMsg | None = None
) -> ImpactMsg:
    """Return an impact at the one contact of a plane of motion, in world axes.

    What is out of the plane stays as it was.
    """
    plane = problem.plane
    (t_x, t_y), (n_x, n_y) = problem.contacts[0].tangent, problem.contacts[0].normal
    (x_1, x_2, x_3), (y_1, y_2, y_3) = plane.axes_W.tolist()

    def lift(vectors_C: Iterable[Vector2]) -> array[float]:
        """Return vectors in contact axes as the world's."""
        lifted = array("d")
        for t, n in vectors_C:
            x, y = t * t_x + n * n_x, t * t_y + n * n_y
            lifted.extend((x * x_1 + y * y_1, x * x_2 + y * y_2, x * x_3 + y * y_3))
        return lifted

    (v_x, v_y), (before_x, before_y) = impact.velocity.v, problem.velocity.v
    after = replace(
        before.state,
        v_WB_W=before.state.v_WB_W + plane.lift((v_x - before_x, v_y - before_y)),
        w_WB_W=before.state.w_WB_W + (impact.velocity.w - problem.velocity.w) * plane.normal_W,
    )
    msg = ImpactMsg() if into is None else into
    msg.restitution_law = int(impact.restitution_law)
    msg.outcome = int(impact.outcome)
    msg.jams = impact.jams
    msg.converged = True
    before.state_to_msg(after, into=msg.state_after)
    msg.impulses = lift([impact.impulse_C])
    msg.compression_impulses = lift([impact.compression_C])
    msg.contact_velocities_before = lift([impact.velocity_before_C])
    msg.contact_velocities_after = lift([impact.velocity_after_C])
    path = impact.path
    msg.path = lift(vertex for _, vertex in path)
    msg.path_events = [int(event) for event, _ in path]
    msg.path_contacts = [0] * len(path)
    msg.kinetic_energy_before = kinetic_energy(before.body, before.state)
    msg.kinetic_energy_after = kinetic_energy(before.body, after)
    msg.creates_energy = impact.creates_energy
    return msg
