# SPDX-License-Identifier: Apache-2.0
"""A time-stepping scheme for contacts that strike, stick and separate too fast to be resolved (Moreau 1988).

Strikes and contact modes can alternate at one instant, for example if planes jam the body and several motions
are nearly consistent. In a short step, each contact has one impulse without restitution that replaces the
strikes and forces of the step and keeps the body out of the planes at its end. The impulses do no positive
work, so that energy never increases. The scheme is of first order.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from contact_dynamics.rotations.one import normalised
from contact_dynamics.tolerances import (
    DISTANCE_TOLERANCE,
    SHORT_STEP_CREEPS,
    SHORTEST_SHORT_STEP,
    SLIDING_STOPPED,
)
from contact_dynamics.toss import vectors as vec
from contact_dynamics.toss.forces import out_of_flats, pushed_by_contacts
from contact_dynamics.toss.impacts import sure_impact
from contact_dynamics.toss.phase import PhaseStep, straight_step
from contact_dynamics.toss.solid import Held, energy_of, heights_and_rates, kinetic_energy_of

if TYPE_CHECKING:
    from contact_dynamics.toss.solid import Numbers, Solid


class ShortStep(NamedTuple):
    """A short step.

    Attributes:
        y: State at its end.
        step: Motion during the step.
        mode: Contacts with an impulse, and whether they slide at the end.
    """

    y: Numbers
    step: PhaseStep
    mode: tuple[Held, ...]


def short_step(solid: Solid, y: Numbers, *, start: float, span: float) -> ShortStep:
    """Return a short step from a state.

    Args:
        solid: The body and the planes.
        y: Initial state.
        start: Time of that state, s.
        span: Largest duration of the step, s, > 0. The step ends earlier if a corner arrives.
    """
    listed = heights_and_rates(solid, y)
    for height, rate, _ in listed:
        if height > DISTANCE_TOLERANCE and rate < 0.0:
            span = min(span, max(-height / rate, SHORTEST_SHORT_STEP))
    free = pushed_by_contacts(solid, y, ())
    pushed = [*y[:7], *(a + span * b for a, b in zip(y[7:], free.rates[7:], strict=True))]
    pose = free.pose
    reached = DISTANCE_TOLERANCE + 2.0 * span * (vec.norm(pose.v) + solid.reach * vec.norm(pose.w))
    near = [(max(height, 0.0) / span, touch) for height, _, touch in listed if height <= reached]
    touching = [touch for _, touch in near]
    impact = sure_impact(solid, pushed, touching, [room for room, _ in near], SHORT_STEP_CREEPS)
    v, w = impact.y[7:10], impact.y[10:]
    rates = [*pushed_by_contacts(solid, impact.y, ()).rates[:7], *[0.0] * 6]
    after = [a + span * b for a, b in zip(impact.y, rates, strict=True)]
    after = out_of_flats(solid, [*after[:3], *normalised(after[3:7]), *v, *w])
    gained = energy_of(solid, after) - energy_of(solid, y)
    kinetic = kinetic_energy_of(solid, after)
    if gained > 0.0:  # due to the rotation during the step
        slower = math.sqrt(max(1.0 - gained / kinetic, 0.0)) if kinetic > 0.0 else 0.0
        after = [*after[:7], *(slower * each for each in after[7:])]
    # The velocities at the start conserve energy over the fall or rise during the step.
    fallen = energy_of(solid, [*after[:3], *impact.y[3:]]) - energy_of(solid, impact.y)
    begun = math.sqrt(max(1.0 + fallen / kinetic, 0.0)) if kinetic > 0.0 else 1.0
    first = [*y[:7], *(begun * each for each in after[7:])]
    slopes = [*rates[:7], *((a - b) / span for a, b in zip(after[7:], first[7:], strict=True))]
    mode = tuple(
        Held(touch, math.hypot(motion[0], motion[1]) > SLIDING_STOPPED)
        for touch, motion, impulse in zip(touching, impact.motions, impact.impulses, strict=True)
        if impulse != (0.0, 0.0, 0.0)
    )
    return ShortStep(after, straight_step(solid, start, span, first, slopes), mode)
