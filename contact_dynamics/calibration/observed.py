# SPDX-License-Identifier: Apache-2.0
"""Finds the events of a toss that a calibration uses: its first flight, single-corner strikes, and rest.

Flights are found with the configured body and gravity, which need not be exact (`measured.flights`). A strike
lies between two flights with at most one frame between. It counts if one corner was lower than all others by
`ALONE` of the body's size, and near a surface.

A long recording is cut into tosses. A toss is a flight with what follows it, until the body rests or is
thrown again. A flight after a pause belongs to another toss only if the body was off its surfaces in between,
as in a hand. A body that tips over from an edge to a face, half a second after its last flight, falls for
some frames too.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.measured.events import REST_SPAN, find_rest
from contact_dynamics.measured.flight_fit import FEWEST_FRAMES
from contact_dynamics.measured.flights import ALONE, find_flights, find_strikes
from contact_dynamics.records import Record
from contact_dynamics.rotations.many import matrices_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.measured.flight_fit import MeasuredState
    from contact_dynamics.measured.flights import Strike
    from contact_dynamics.measured.motion import MeasuredMotion
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Surface

NEAR: Final = 1.0
"""Largest distance of a striking corner from a surface, in half sizes. Beyond it, something else was
struck."""

FEWEST_IN_FIRST: Final = 8  # frames. A shorter first flight hardly constrains gravity and mass centre.


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Observed(Record):
    """The events of one toss, which is a recording or a part of one."""

    name: str  # the recording's name, with the number of the toss where there are several
    motion: MeasuredMotion  # the measured states
    flights: tuple[slice, ...]  # all flights, as slices of frames
    first: slice | None  # the frames of the first flight that are used, or None if it is too short
    strikes: tuple[Strike, ...]  # the strikes of single corners
    several: int  # number of strikes of several corners at once, which are not used
    rest: MeasuredState | None  # the pose at rest, or None
    rest_surface: int  # number of the surface on which it rests


def observe(name: str, motion: MeasuredMotion) -> list[Observed]:
    """Return the events of one recording, toss by toss. The names of several tosses have numbers."""
    tosses = tosses_in(motion)
    return [
        _observed(name if len(tosses) == 1 else f"{name}, toss {number}", part, flights)
        for number, (part, flights) in enumerate(tosses)
    ]


def _observed(name: str, motion: MeasuredMotion, flights: tuple[slice, ...]) -> Observed:
    surfaces = motion.surfaces
    found = find_strikes(motion, flights) if surfaces else ()
    reach = motion.body.shape.reach
    alone = [strike for strike in found if strike.margin >= ALONE * reach]
    rest = find_rest(motion)
    first = slice(flights[0].start, flights[0].stop - 1) if flights else slice(0, 0)
    return Observed(
        name=name,
        motion=motion,
        flights=flights,
        first=first if first.stop - first.start >= FEWEST_IN_FIRST else None,
        strikes=tuple(strike for strike in alone if abs(strike.height) <= NEAR * reach),
        several=len(found) - len(alone),
        rest=rest,
        rest_surface=_nearest(surfaces, rest.state.p_WB_W) if rest is not None and surfaces else 0,
    )


def _nearest(surfaces: Sequence[Surface], point_W: FloatArray) -> int:
    return int(np.argmin([abs(float(surface.gaps(point_W))) for surface in surfaces]))


BETWEEN_TOSSES: Final = 0.4
"""s. When a body has not flown for so long, its next flight can be another toss. Between the bounces of one
toss, the published cubes seldom slide or rock for longer."""

LIFTED: Final = 0.1
"""Share of the body's largest half size by which all corners are above the surfaces when it is lifted. The
corners of the published cubes, as configured, go 1 to 6 % into the board when they touch it."""

LONGEST_REST: Final = 4  # spans of rest kept at the end of a toss; more would add little information


def tosses_in(motion: MeasuredMotion) -> list[tuple[MeasuredMotion, tuple[slice, ...]]]:
    """Return each toss with its flights. A recording without flights is one toss without any."""
    groups: list[list[slice]] = []
    for flight in find_flights(motion):
        if groups and not _thrown_again(motion, groups[-1][-1], flight):
            groups[-1].append(flight)
        else:
            groups.append([flight])
    if len(groups) < 2:
        return [(motion, tuple(groups[0]) if groups else ())]
    found = []
    for i, flights in enumerate(groups):
        begin = flights[0].start
        end = groups[i + 1][0].start if i + 1 < len(groups) else len(motion)
        stop = _rests_by(motion, flights[-1].stop, end)
        shifted = tuple(slice(flight.start - begin, flight.stop - begin) for flight in flights)
        found.append((motion.part(begin, stop), shifted))
    return found


def _thrown_again(motion: MeasuredMotion, last: slice, flight: slice) -> bool:
    """Return whether a flight belongs to another toss than the last one."""
    if motion.times[flight.start] - motion.times[last.stop - 1] < BETWEEN_TOSSES:
        return False
    surfaces = motion.surfaces
    shape, between = motion.body.shape, slice(last.stop, flight.stop)
    if not surfaces or not len(shape.vertices):
        return True
    turned = np.einsum("nij,kj->nki", matrices_of(motion.q_WB[between]), shape.vertices)
    corners = motion.p_WB_W[between][:, None] + turned
    gaps = np.min([surface.gaps(corners.reshape(-1, 3)) for surface in surfaces], axis=0)
    lowest = gaps.reshape(len(corners), -1).min(axis=1) - shape.rounding
    return float(lowest.max()) > LIFTED * shape.reach


def _rests_by(motion: MeasuredMotion, begin: int, end: int) -> int:
    """Return the end frame of a toss, which may come to rest before it is picked up."""
    count = LONGEST_REST * max(FEWEST_FRAMES, round(REST_SPAN * motion.rate))
    for stop in np.arange(begin + count, end + 1, max(1, count // 4)).tolist():
        if find_rest(motion.part(stop - count, stop)) is not None:
            return int(stop)
    return end
