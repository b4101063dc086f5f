"""What a calibration uses of one toss: its first flight, its strikes of single corners, and its rest.

Flights are found with the configured body and gravity, which need not be exact (`measured.flights`). A strike
lies between two flights with at most one frame between. It counts if one corner was lower than all others by
`ALONE` of the body's size, and above a surface. Of each flight next to a strike the part within `FIT_SPAN`
is kept, on its side of the time at which both flights' poses meet.

A long recording is cut into tosses. A toss is a flight with what follows it, until the body rests or is
thrown again. A flight after a pause belongs to another toss only if the body was off its surfaces in between,
as in a hand. A body that tips over from an edge to a face, half a second after its last flight, falls for
some frames too.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.measured.events import FIT_SPAN, MAX_BETWEEN, REST_SPAN, find_rest, meeting_of_flights
from contact_dynamics.measured.flight_fit import FEWEST_FRAMES
from contact_dynamics.measured.flights import find_flights
from contact_dynamics.records import Record
from contact_dynamics.rotations.many import matrices_of
from contact_dynamics.world import Surface

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.evaluation.motion import MeasuredMotion
    from contact_dynamics.measured.events import FlightMeeting, RestingPose
    from contact_dynamics.validation import FloatArray

ALONE: Final = 0.1
"""Share of the body's largest half size by which the second corner is higher in a strike of a single one."""

NEAR: Final = 1.0
"""Largest distance of a striking corner from a surface, in half sizes. Beyond it, something else was
struck."""

FEWEST_IN_FIRST: Final = 8
"""Frames. A shorter first flight says next to nothing of gravity and mass centre."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Strike(Record):
    """One strike of one corner.

    Attributes:
        meeting: When both flights' poses meet, and the states then.
        before: Frames of the flight before it that are used.
        after: Frames of the flight after it that are used.
        corner: Number of the corner that struck.
        surface: Number of the surface that it struck, of the motion's flat surfaces.
        height: m, of the corner above that surface, as configured.
    """

    meeting: FlightMeeting
    before: slice
    after: slice
    corner: int
    surface: int
    height: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Observed(Record):
    """What was found in one toss, which is a recording or a part of one.

    Attributes:
        name: The recording's name, with the number of the toss where there are several.
        motion: The measured states.
        flights: All flights, as slices of frames.
        first: The frames of the first flight that are used, or None if it is too short.
        strikes: The strikes of single corners.
        several: Number of strikes of several corners at once, which are not used.
        rest: The pose at rest, or None.
        rest_surface: Number of the surface on which it rests.
    """

    name: str
    motion: MeasuredMotion
    flights: tuple[slice, ...]
    first: slice | None
    strikes: tuple[Strike, ...]
    several: int
    rest: RestingPose | None
    rest_surface: int


def surfaces_of(motion: MeasuredMotion) -> list[Surface]:
    """Return the flat surfaces of the world that the motion was measured in."""
    return [surface for surface in motion.world.surfaces if isinstance(surface, Surface)]


def observe(name: str, motion: MeasuredMotion) -> list[Observed]:
    """Return what is found in one recording, toss by toss. Of several tosses, the names have numbers."""
    tosses = tosses_in(motion)
    return [
        _observed(name if len(tosses) == 1 else f"{name}, toss {number}", part, flights)
        for number, (part, flights) in enumerate(tosses)
    ]


def _observed(name: str, motion: MeasuredMotion, flights: tuple[slice, ...]) -> Observed:
    surfaces = surfaces_of(motion)
    reach = _reach(motion)
    strikes, several = [], 0
    for before, after in pairwise(flights):
        if after.start - before.stop > MAX_BETWEEN or not surfaces:
            continue
        strike = _strike(motion, before, after, surfaces, reach)
        if strike is None:
            several += 1
        elif abs(strike.height) <= NEAR * reach:
            strikes.append(strike)
    rest = find_rest(motion)
    first = slice(flights[0].start, flights[0].stop - 1) if flights else slice(0, 0)
    return Observed(
        name=name,
        motion=motion,
        flights=flights,
        first=first if first.stop - first.start >= FEWEST_IN_FIRST else None,
        strikes=tuple(strikes),
        several=several,
        rest=rest,
        rest_surface=_nearest(surfaces, rest.state.p_WB_W) if rest is not None and surfaces else 0,
    )


def _strike(
    motion: MeasuredMotion, before: slice, after: slice, surfaces: Sequence[Surface], reach: float
) -> Strike | None:
    meeting = meeting_of_flights(motion, before, after)
    shape = motion.body.shape
    R = meeting.before.state.R_WB
    p = 0.5 * (meeting.before.state.p_WB_W + meeting.after.state.p_WB_W)
    corners = p + shape.vertices @ R.T
    heights = np.array([surface.gaps(corners) for surface in surfaces]) - shape.rounding
    nearest = int(np.abs(heights.min(axis=1)).argmin())
    order = np.argsort(heights[nearest])
    if len(order) > 1 and heights[nearest][order[1]] - heights[nearest][order[0]] < ALONE * reach:
        return None
    count = max(FEWEST_FRAMES, round(FIT_SPAN * motion.rate))
    half_frame = 0.5 / motion.rate
    stop = before.stop
    while stop - before.start > FEWEST_FRAMES and motion.times[stop - 1] > meeting.time + half_frame:
        stop -= 1
    start = after.start
    while after.stop - start > FEWEST_FRAMES and motion.times[start] < meeting.time - half_frame:
        start += 1
    return Strike(
        meeting=meeting,
        before=slice(max(before.start, stop - count), stop),
        after=slice(start, min(after.stop, start + count)),
        corner=int(order[0]),
        surface=nearest,
        height=float(heights[nearest][order[0]]),
    )


def _nearest(surfaces: Sequence[Surface], point_W: FloatArray) -> int:
    return int(np.argmin([abs(float(surface.gaps(point_W))) for surface in surfaces]))


def _reach(motion: MeasuredMotion) -> float:
    shape = motion.body.shape
    if shape.is_empty:
        return 0.0
    vertices = shape.vertices if len(shape.vertices) else np.array([rim.center for rim in shape.rims])
    middle = vertices.mean(axis=0)
    return float(np.linalg.norm(vertices - middle, axis=1).max()) + shape.rounding


BETWEEN_TOSSES: Final = 0.4
"""s. When a body has not flown for so long, its next flight can be another toss. Between the bounces of one
toss, the published cubes seldom slide or rock for longer."""

LIFTED: Final = 0.1
"""Share of the body's largest half size by which all corners are above the surfaces when it is lifted. The
corners of the published cubes, as configured, go 1 to 6 % into the board when they touch it."""

LONGEST_REST: Final = 4
"""Spans of rest that are kept at the end of a toss. More would say little more."""


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
        found.append((part_of(motion, begin, stop), shifted))
    return found


def _thrown_again(motion: MeasuredMotion, last: slice, flight: slice) -> bool:
    """Return whether a flight belongs to another toss than the last one."""
    if motion.times[flight.start] - motion.times[last.stop - 1] < BETWEEN_TOSSES:
        return False
    surfaces = [surface for surface in motion.world.surfaces if isinstance(surface, Surface)]
    shape, between = motion.body.shape, slice(last.stop, flight.stop)
    if not surfaces or not len(shape.vertices):
        return True
    turned = np.einsum("nij,kj->nki", matrices_of(motion.q_WB[between]), shape.vertices)
    corners = motion.p_WB_W[between][:, None] + turned
    gaps = np.min([surface.gaps(corners.reshape(-1, 3)) for surface in surfaces], axis=0)
    lowest = gaps.reshape(len(corners), -1).min(axis=1) - shape.rounding
    reach = float(np.linalg.norm(shape.vertices - shape.vertices.mean(axis=0), axis=1).max())
    return float(lowest.max()) > LIFTED * (reach + shape.rounding)


def part_of(motion: MeasuredMotion, begin: int, stop: int) -> MeasuredMotion:
    """Return the states from one number up to another, with the times that they had."""
    return replace(
        motion,
        published=motion.published[begin:stop],
        arrivals_ns=motion.arrivals_ns[begin:stop],
        times=motion.times[begin:stop],
        p_WB_W=motion.p_WB_W[begin:stop],
        q_WB=motion.q_WB[begin:stop],
    )


def _rests_by(motion: MeasuredMotion, begin: int, end: int) -> int:
    """Return the frame up to which a toss goes that may come to rest before it is picked up."""
    count = LONGEST_REST * max(FEWEST_FRAMES, round(REST_SPAN * motion.rate))
    for stop in np.arange(begin + count, end + 1, max(1, count // 4)).tolist():
        if find_rest(part_of(motion, stop - count, stop)) is not None:
            return int(stop)
    return end
