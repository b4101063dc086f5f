# SPDX-License-Identifier: Apache-2.0
"""Gives each result of the impact chapter the one form that it has in an answer.

The chapter has separate results for one contact and for several, in the plane and in space, for one body and
for two.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from contact_dynamics.impact import BodiesImpact, SequenceEnd, SeveralVerdict
from contact_dynamics.impact.energy import created
from contact_dynamics.plane.lifting import with_planar_velocity
from contact_dynamics.questions.impact_question import ResolvedImpact, SequenceStrike
from contact_dynamics.rigid_body.body import kinetic_energy

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.impact import (
        ImpactSequence,
        OrderedOutcomes,
        PathEvent,
        PlanarImpact,
        SeveralImpact,
        SpatialImpact,
    )
    from contact_dynamics.plane.projection import PlanarProblem
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray

    Before: TypeAlias = tuple[MassProperties, BodyState]
    """A body just before an impact."""


def spatial_resolved(impact: SpatialImpact, *before: Before) -> ResolvedImpact:
    """Return an impact at one contact in space, of a body with the world or with another body."""
    return ResolvedImpact(
        restitution_law=impact.restitution_law,
        state=impact.state,
        other_state=impact.other_state,
        impulses_W=impact.impulse_W[None],
        velocities_before_W=impact.velocity_before_W[None],
        velocities_after_W=impact.velocity_after_W[None],
        creates_energy=impact.creates_energy,
        **_along_path([(0, impact)], 1),
        **_energies(before, (impact.state, impact.other_state)),
    )


def planar_resolved(impact: PlanarImpact, problem: PlanarProblem, before: Before) -> ResolvedImpact:
    """Return an impact at the one contact of a plane of motion. Motion out of the plane stays as it was."""
    path = impact.path
    (t_x, t_y), (n_x, n_y) = problem.contacts[0].tangent, problem.contacts[0].normal
    (x_1, x_2, x_3), (y_1, y_2, y_3) = problem.plane.axes_W.tolist()
    in_world = []
    for t, n in (
        impact.impulse_C,
        impact.compression_C,
        impact.velocity_before_C,
        impact.velocity_after_C,
        *(vertex for _, vertex in path),
    ):
        x, y = t * t_x + n * n_x, t * t_y + n * n_y
        in_world.append((x * x_1 + y * y_1, x * x_2 + y * y_2, x * x_3 + y * y_3))
    vectors_W = np.array(in_world)
    after = with_planar_velocity(problem, before[1], impact.velocity)
    return ResolvedImpact(
        restitution_law=impact.restitution_law,
        outcome=impact.outcome,
        jams=impact.jams,
        state=after,
        impulses_W=vectors_W[:1],
        compression_impulses_W=vectors_W[1:2],
        velocities_before_W=vectors_W[2:3],
        velocities_after_W=vectors_W[3:4],
        path_W=vectors_W[4:],
        path_events=tuple([event for event, _ in path]),
        path_contacts=(0,) * len(path),
        creates_energy=impact.creates_energy,
        **_energies((before,), (after,)),
    )


def several_resolved(
    impact: SeveralImpact | BodiesImpact, *before: Before, surfaces_W: FloatArray | None = None
) -> ResolvedImpact:
    """Return an impact at several contacts in space, of one body with the world, or of two bodies.

    ``surfaces_W``, (n, 3), m/s, are velocities of surfaces that move. Their work is not energy of the law.
    """
    after = impact.states if isinstance(impact, BodiesImpact) else (impact.state, None)
    energies = _energies(before, after)
    work = 0.0 if surfaces_W is None else float(np.sum(impact.impulses_W * surfaces_W))
    first, last = energies["kinetic_energy_before"], energies["kinetic_energy_after"]
    return ResolvedImpact(
        restitution_law=impact.restitution_law,
        several_contacts_law=impact.several_contacts_law,
        converged=impact.verdict == SeveralVerdict.RESOLVED,
        state=after[0],
        other_state=after[1],
        impulses_W=impact.impulses_W,
        velocities_before_W=impact.velocities_before_W,
        velocities_after_W=impact.velocities_after_W,
        creates_energy=created(last - first - work, first + abs(work)),
        **_along_path(impact.strikes, len(impact.impulses_W)),
        **energies,
    )


def sequence_resolved(impact: ImpactSequence, before: Before) -> ResolvedImpact:
    """Return one or more strikes in time. ``before`` is the body just before the first."""
    first = impact.strikes[0].seconds
    impulses = np.zeros((len(impact.contacts), 3))
    velocities_before, velocities_after = np.zeros_like(impulses), np.zeros_like(impulses)
    for strike in reversed(impact.strikes):
        velocities_before[strike.contact] = strike.impact.velocity_before_W
    for strike in impact.strikes:
        impulses[strike.contact] += strike.impact.impulse_W
        velocities_after[strike.contact] = strike.impact.velocity_after_W
    return ResolvedImpact(
        restitution_law=impact.restitution_law,
        converged=impact.end != SequenceEnd.MAX_STRIKES,
        state=impact.state,
        impulses_W=impulses,
        velocities_before_W=velocities_before,
        velocities_after_W=velocities_after,
        creates_energy=impact.creates_energy,
        strikes=tuple(
            SequenceStrike(
                seconds=strike.seconds - first,
                contact=strike.contact,
                outcome=strike.impact.outcome,
                p_WC_W=strike.p_WC_W,
                impulse_W=strike.impact.impulse_W,
                state_before=strike.state_before,
                state_after=strike.impact.state,
            )
            for strike in impact.strikes
        ),
        end=impact.end,
        staying=impact.staying,
        limit_seconds=None if impact.limit_seconds is None else impact.limit_seconds - first,
        **_along_path([(strike.contact, strike.impact) for strike in impact.strikes], len(impulses)),
        **_energies((before,), (impact.state,)),
    )


def with_orders(resolved: ResolvedImpact, outcomes: OrderedOutcomes) -> ResolvedImpact:
    """Return an impact with the outcomes over the admissible orders of its contacts."""
    return replace(
        resolved,
        orders=outcomes.orders,
        order_velocities_W=outcomes.velocities_W,
        orders_complete=outcomes.complete,
        orders_not_converged=outcomes.not_converged,
    )


def _energies(before: Sequence[Before], after: Sequence[BodyState | None]) -> dict[str, Any]:
    """Return the kinetic energies of one or two bodies before and after an impact."""
    moved = [(body, state) for (body, _), state in zip(before, after, strict=False) if state is not None]
    return {
        "kinetic_energy_before": sum(kinetic_energy(body, state) for body, state in before),
        "kinetic_energy_after": sum(kinetic_energy(body, state) for body, state in moved),
    }


def _along_path(strikes: Sequence[tuple[int, SpatialImpact]], n: int) -> dict[str, Any]:
    """Return the path of strikes at n contacts, and the outcome of the hardest of them, if there are any."""
    if not strikes:
        return {}
    _, hardest = max(strikes, key=lambda each: float(each[1].impulse_W @ each[1].impulse_W))
    so_far, compression = np.zeros((2, n, 3))
    path: list[FloatArray] = []
    events: list[PathEvent] = []
    contacts: list[int] = []
    for contact, strike in strikes:
        path.append(so_far[contact] + strike.path_W)
        so_far[contact] += strike.impulse_W
        compression[contact] += strike.compression_W
        events += strike.path_events
        contacts += [contact] * len(strike.path_events)
    return {
        "outcome": hardest.outcome,
        "jams": hardest.jams,
        "compression_impulses_W": compression,
        "path_W": np.concatenate(path),
        "path_events": tuple(events),
        "path_contacts": tuple(contacts),
    }
