# SPDX-License-Identifier: Apache-2.0
"""A recording with the states of its bodies and their configuration, and its evaluation."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING, Final

from contact_dynamics.evaluation.asking import Informed, asked_before, compare_event, of_known_center
from contact_dynamics.evaluation.result import SourceResult
from contact_dynamics.measured.events import find_events
from contact_dynamics.measured.motion import StateColumns, motions_of
from contact_dynamics.questions.context import Defaults
from contact_dynamics.records import Record
from contact_dynamics.tolerances import TOUCHING_GAP
from contact_dynamics.world import World

if TYPE_CHECKING:
    from contact_dynamics.evaluation.comparison import Comparison
    from contact_dynamics.evaluation.settings import Settings
    from contact_dynamics.measured.events import FoundEvent
    from contact_dynamics.measured.motion import MeasuredMotion
    from contact_dynamics.measured.recorded_toss import Toss

SLOW: Final = 5.0
"""Number of standard deviations of a corner's velocity, below which a contact of a toss counts as at rest."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Recording(Record):
    """The content of one log or one toss."""

    motions: tuple[MeasuredMotion, ...]  # the measured states, by body and in stretches without gaps
    informed: Informed  # the configuration of bodies, surfaces and tolerances
    damage: str = ""  # description of what could not be read; empty for an intact recording


def evaluate_recording(
    recording: Recording,
    settings: Settings,
    *,
    informed: Informed | None = None,
    share: tuple[int, int] = (0, 1),
) -> SourceResult:
    """Find the events of a recording, predict each from earlier states, and return the comparisons.

    The configuration ``informed`` is used for the predictions, by default that of the recording. With a
    ``share`` (k, n), only the k-th of n equal parts of each motion's events is predicted, k from 0.
    """
    part, parts = share
    events: list[FoundEvent] = []
    rows: list[Comparison] = []
    for motion in recording.motions:
        # A landing and its impacts are predicted from the same states.
        by_instant = groupby(find_events(motion), key=lambda event: (event.first_sample, event.time_ns))
        instants = [list(found) for _, found in by_instant]
        for number, found in enumerate(instants):
            if number * parts // len(instants) == part:
                asker = informed or recording.informed
                known = asked_before(found[0], motion, asker, settings)
                for place, event in enumerate(found, len(events)):
                    rows += compare_event(place, of_known_center(event, motion, asker), known, settings)
            events += found
    return SourceResult(
        events=tuple(events),
        comparisons=tuple(rows),
        states=sum(len(motion) for motion in recording.motions),
        seconds=sum(  # by body, to equal the sum in `joined`
            sum(float(motion.times[-1] - motion.times[0]) for motion in motions)
            for _, motions in groupby(recording.motions, key=lambda motion: motion.body.name)
        ),
        damage=recording.damage,
    )


def recording_of_toss(toss: Toss) -> Recording:
    """Return a recorded toss as a recording, with the times of its file. Each state arrives at its stamp.

    Like the demo, it treats velocities within the measurement noise as zero.
    """
    world = World(bodies=(toss.body,), surfaces=(toss.surface,), gravity_W=toss.gravity_W)
    states = [toss.state(sample) for sample in range(len(toss))]
    slow = SLOW * toss.contact_speed_noise
    defaults = Defaults(velocity_tolerance=slow, distance_tolerance=TOUCHING_GAP, out_of_plane_tolerance=slow)
    return Recording(
        motions=tuple(
            motions_of(
                toss.body,
                world,
                StateColumns(states, [state.stamp_ns for state in states]),
                noise=(toss.position_noise, toss.orientation_noise),
                epoch_ns=0,
            )
        ),
        informed=Informed(world=world, defaults=defaults, state_timeout=0.5),
    )
