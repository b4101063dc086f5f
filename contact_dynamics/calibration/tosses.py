"""Long recordings cut into tosses: a flight with what follows it, until the body rests or is thrown again.

A flight after a pause belongs to another toss only if the body was off its surfaces in between, as in a hand.
A body that tips over from an edge to a face, half a second after its last flight, falls for some frames too.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.measured.events import REST_SPAN, find_rest
from contact_dynamics.measured.flight_fit import FEWEST_FRAMES
from contact_dynamics.measured.flights import find_flights
from contact_dynamics.rotations.many import matrices_of
from contact_dynamics.world import Surface

if TYPE_CHECKING:
    from contact_dynamics.evaluation.motion import MeasuredMotion

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
