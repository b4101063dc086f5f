# SPDX-License-Identifier: Apache-2.0
"""Gives each result of the impact chapter the one form that it has in an answer.

The chapter has separate results for one contact and for several, in the plane and in space, for one body and
for two.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from contact_dynamics.impact import BodiesImpact, SequenceEnd, SeveralContactsLaw, SeveralVerdict
from contact_dynamics.impact.energy import created
from contact_dynamics.plane.lifting import with_planar_velocity
from contact_dynamics.questions.impact_question import ResolvedImpact, SequenceStrike
from contact_dynamics.rigid_body.body import kinetic_energy

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.impact import (
        ImpactSequence,
        OrderedOutcomes,
        PlanarImpact,
        RestitutionLaw,
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
    return _resolved(
        before,
        (impact.state,) if impact.other_state is None else (impact.state, impact.other_state),
        [(0, impact)],
        restitution_law=impact.restitution_law,
        impulses_W=impact.impulse_W[None],
        velocities_W=(impact.velocity_before_W[None], impact.velocity_after_W[None]),
        creates_energy=impact.creates_energy,
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
    resolved = _resolved(
        [before],
        [with_planar_velocity(problem, before[1], impact.velocity)],
        restitution_law=impact.restitution_law,
        impulses_W=vectors_W[:1],
        velocities_W=(vectors_W[2:3], vectors_W[3:4]),
        creates_energy=impact.creates_energy,
    )
    return replace(
        resolved,
        outcome=impact.outcome,
        jams=impact.jams,
        compression_impulses_W=vectors_W[1:2],
        path_W=vectors_W[4:],
        path_events=tuple(event for event, _ in path),
        path_contacts=(0,) * len(path),
    )


def several_resolved(
    impact: SeveralImpact | BodiesImpact, *before: Before, surfaces_W: FloatArray | None = None
) -> ResolvedImpact:
    """Return an impact at several contacts in space, of one body with the world, or of two bodies.

    ``surfaces_W``, (n, 3), m/s, are velocities of surfaces that move. Their work is not energy of the law.
    """
    resolved = _resolved(
        before,
        impact.states if isinstance(impact, BodiesImpact) else [impact.state],
        impact.strikes,
        restitution_law=impact.restitution_law,
        impulses_W=impact.impulses_W,
        velocities_W=(impact.velocities_before_W, impact.velocities_after_W),
        creates_energy=False,
    )
    work = 0.0 if surfaces_W is None else float(np.sum(impact.impulses_W * surfaces_W))
    first, last = resolved.kinetic_energy_before, resolved.kinetic_energy_after
    return replace(
        resolved,
        several_contacts_law=impact.several_contacts_law,
        converged=impact.verdict == SeveralVerdict.RESOLVED,
        creates_energy=created(last - first - work, first + abs(work)),
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
    resolved = _resolved(
        [before],
        [impact.state],
        [(strike.contact, strike.impact) for strike in impact.strikes],
        restitution_law=impact.restitution_law,
        impulses_W=impulses,
        velocities_W=(velocities_before, velocities_after),
        creates_energy=impact.creates_energy,
    )
    return replace(
        resolved,
        converged=impact.end != SequenceEnd.MAX_STRIKES,
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


def _resolved(
    before: Sequence[Before],
    after: Sequence[BodyState],
    strikes: Sequence[tuple[int, SpatialImpact]] = (),
    *,
    restitution_law: RestitutionLaw,
    impulses_W: FloatArray,
    velocities_W: tuple[FloatArray, FloatArray],
    creates_energy: bool,
) -> ResolvedImpact:
    """Return an impact of bodies, with the path of its strikes. Its outcome is that of the hardest."""
    resolved = ResolvedImpact(
        restitution_law=restitution_law,
        several_contacts_law=SeveralContactsLaw.SEQUENTIAL,
        converged=True,
        state=after[0],
        other_state=after[1] if len(after) > 1 else None,
        impulses_W=impulses_W,
        velocities_before_W=velocities_W[0],
        velocities_after_W=velocities_W[1],
        kinetic_energy_before=sum(kinetic_energy(body, state) for body, state in before),
        kinetic_energy_after=sum(
            kinetic_energy(body, state) for (body, _), state in zip(before, after, strict=True)
        ),
        creates_energy=creates_energy,
    )
    if not strikes:
        return resolved
    hardest = max((strike for _, strike in strikes), key=lambda each: float(each.impulse_W @ each.impulse_W))
    so_far, compression = np.zeros((2, len(impulses_W), 3))
    path = []
    for contact, strike in strikes:
        path.append(so_far[contact] + strike.path_W)
        so_far[contact] += strike.impulse_W
        compression[contact] += strike.compression_W
    return replace(
        resolved,
        outcome=hardest.outcome,
        jams=hardest.jams,
        compression_impulses_W=compression,
        path_W=np.concatenate(path),
        path_events=tuple(event for _, strike in strikes for event in strike.path_events),
        path_contacts=tuple(contact for contact, strike in strikes for _ in strike.path_events),
    )
