# SPDX-License-Identifier: Apache-2.0
"""Finds the free flights of a measured body, and the strikes between them.

A flight is extended frame by frame. Each new pose is compared with the prediction from a fit to the last
frames (`SPAN`), and the flight ends where the difference exceeds noise and model errors. An interval of at
least `SPAN` is a flight if the fitted acceleration is closer to gravity than to zero, the acceleration of a
supported body. For white noise sigma over n frames and a time T, the standard deviation of this acceleration
is sigma sqrt(720 / n) / T^2, which is 0.7 m/s^2 for the recorded brick.

A strike separates two flights with at most one frame between them. Both flights are fitted over the frames
next to the strike. Because the pose is continuous while velocities jump, the time of the strike is that at
which positions and orientations of both fits agree best. It is much more precise than the frame interval and
independent of corners and surfaces. For a strike of finite duration it is the centre of the impulse.

All results have standard deviations, so that prediction errors can be compared with measurement noise. Not
covered: flights shorter than `SPAN`, between strikes in quick succession; impacts that hardly change the
poses within `SPAN`; spins by more than half a turn within half of `SPAN`; and slender bodies that tumble
fast, because noise of their axis is a large error of their spin about it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.measured.flight_fit import (
    FEWEST_FRAMES,
    FittedPoses,
    FlightFit,
    MeasuredState,
    fit_flight,
)
from contact_dynamics.records import Record
from contact_dynamics.rotations.many import rotation_vectors

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from contact_dynamics.measured.motion import MeasuredPoses
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray

    IntArray = NDArray[np.intp]

SPAN: Final = 0.047
"""s. Duration of the shortest flight, and of the part of a longer one from which its next frame is
predicted."""

DEVIATIONS: Final = 5.0
"""Largest deviation of a coordinate from its prediction, in standard deviations. Noise exceeds it once in 1.7
million frames."""

POSITION_SLACK: Final = 5e-4
"""m. Additional error within `SPAN` by drag, 2 % of gravity and a millimetre of the centre of mass."""

ORIENTATION_SLACK: Final = 5e-3  # rad. Additional error within `SPAN` by a few percent of inertia.

AT_ONCE: Final = 64
"""Number of intervals that are fitted together: about the frames of a flight, since fits beyond its end are
wasted."""

FIT_SPAN: Final = 0.08
"""s. Duration of the part of a flight next to a strike to which velocities are fitted. With a longer one,
model errors, such as 2 % of gravity, would exceed the reduction of noise."""

ALONE: Final = 0.1
"""Minimum height of the second corner above the lowest one in a single-corner strike, relative to the largest
half size of the body."""

MAX_BETWEEN: Final = 1
"""Maximum number of frames between the two flights of a strike. They show the body in contact."""


def find_flights(poses: MeasuredPoses) -> list[slice]:
    """Return the flights as slices of frames, in the order of time."""
    shortest = max(5, round(SPAN * poses.rate) + 1)
    flights: list[slice] = []
    begin = _next_begin(poses, 0, shortest)
    while begin is not None:
        flights.append(slice(begin, _end(poses, begin + shortest, shortest)))
        begin = _next_begin(poses, flights[-1].stop, shortest)
    return flights


def _next_begin(poses: MeasuredPoses, first: int, shortest: int) -> int | None:
    """Return the first frame, from ``first`` on, at which a flight begins, or None."""
    for at in range(first, len(poses) - shortest + 1, AT_ONCE):
        begins = np.arange(at, min(at + AT_ONCE, len(poses) - shortest + 1))
        stretches = begins[:, None] + np.arange(shortest)
        stretches = stretches[_fall(poses, stretches)]
        if len(stretches):
            fit = fit_flight(poses, stretches, reference=stretches[:, shortest // 2])
            expected = fit.poses_of_frames(poses.times[stretches])
            fits = (_deviations(poses, stretches, expected) <= 1.0).all(axis=1)
            if fits.any():
                return int(stretches[fits.argmax(), 0])
    return None


def _end(poses: MeasuredPoses, end: int, shortest: int) -> int:
    """Return the first frame, from ``end`` on, that deviates from the fit to the frames before it."""
    for at in range(end, len(poses), AT_ONCE):
        ends = np.arange(at, min(at + AT_ONCE, len(poses)))[:, None]
        expected = fit_flight(poses, ends + np.arange(-shortest, 0)).poses_at(poses.times[ends])
        off = _deviations(poses, ends, expected)[:, 0] > 1.0
        if off.any():
            return at + int(off.argmax())
    return len(poses)


def _fall(poses: MeasuredPoses, stretches: IntArray) -> NDArray[np.bool_]:
    """Return whether the acceleration along gravity exceeds half of gravity in each interval, (k, n)."""
    times = poses.times[stretches]
    times = times - times.mean(axis=1, keepdims=True)
    square = times * times
    sum_2, sum_3 = square.sum(axis=1, keepdims=True), (square * times).sum(axis=1, keepdims=True)
    bent = square - sum_3 / sum_2 * times - sum_2 / stretches.shape[1]  # orthogonal to lines
    along = poses.p_WB_W[stretches] @ poses.gravity_W
    accelerations = 2.0 * (bent * along).sum(axis=1) / (bent * bent).sum(axis=1)
    return np.asarray(accelerations > 0.5 * float(poses.gravity_W @ poses.gravity_W))


def _deviations(poses: MeasuredPoses, frames: IntArray, expected: FittedPoses) -> FloatArray:
    """Return the deviations of the poses of frames, (k, m), relative to the allowed ones, (k, m)."""
    p_std = np.hypot(poses.position_noise, expected.position_std)
    q_std = np.hypot(poses.orientation_noise, expected.orientation_std)
    p_off = np.abs(poses.p_WB_W[frames] - expected.p_WB_W).max(axis=-1)
    turns = rotation_vectors(poses.q_WB[frames].reshape(-1, 4), expected.q_WB.reshape(-1, 4))
    q_off = np.abs(turns).reshape(q_std.shape)
    worst: FloatArray = np.maximum(
        p_off / (DEVIATIONS * p_std + POSITION_SLACK),
        (q_off / (DEVIATIONS * q_std + ORIENTATION_SLACK)).max(axis=-1),
    )
    return worst


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Strike(Record):
    """The transition from one flight to the next, at the time at which their poses agree best."""

    time: float  # s, on the clock of the recording
    time_std: float  # standard deviation of ``time``, s
    before: MeasuredState  # the state at that time, from the flight that ends
    after: MeasuredState  # the state at that time, from the flight that begins
    frames_before: slice  # frames of the flight that ends, within `FIT_SPAN`
    frames_after: slice  # frames of the flight that begins, within `FIT_SPAN`
    # Number of the nearest flat surface, or None without flat surfaces or corners.
    surface: int | None
    # (k,), m, of the corners above this surface, from the mean of both flights; empty without a surface.
    heights: FloatArray

    @property
    def corner(self) -> int:
        """Index of the lowest corner among the vertices of the body."""
        return int(np.argmin(self.heights))

    @property
    def height(self) -> float:
        """Height of the lowest corner above the configured surface, m."""
        return float(self.heights.min())

    @property
    def margin(self) -> float:
        """Height of the next corner above the lowest one, m. It is small if an edge or a face struck."""
        lowest, second = np.sort(self.heights)[:2] if len(self.heights) > 1 else (0.0, math.inf)
        return float(second - lowest)


def find_strikes(poses: MeasuredPoses, flights: Sequence[slice] | None = None) -> tuple[Strike, ...]:
    """Return the strikes in the order of time. If flights are not given, they are detected."""
    return tuple(
        strike
        for before, after in pairwise(find_flights(poses) if flights is None else flights)
        if (strike := strike_between(poses, before, after)) is not None
    )


def strike_between(poses: MeasuredPoses, before: slice, after: slice) -> Strike | None:
    """Return the strike between two flights, or None if more than `MAX_BETWEEN` frames are between them."""
    if after.start - before.stop > MAX_BETWEEN:
        return None
    fit_after = fit_flight(poses, first_part(poses, after), reference=after.start)
    stop = before.stop
    while True:
        fit_before = fit_flight(poses, last_part(poses, before, stop))
        time, time_std = _crossing(fit_before, fit_after)
        # the flight may include a frame just after the strike: the crossing is then before that frame
        if time >= poses.times[stop - 1] - time_std or stop - 1 - before.start < FEWEST_FRAMES:
            break
        stop -= 1
    half_frame = 0.5 / poses.rate
    stop, start = before.stop, after.start
    while stop - before.start > FEWEST_FRAMES and poses.times[stop - 1] > time + half_frame:
        stop -= 1
    while after.stop - start > FEWEST_FRAMES and poses.times[start] < time - half_frame:
        start += 1
    ending, beginning = fit_before.at(time), fit_after.at(time)
    heights = 0.5 * (corner_heights(poses, ending.state) + corner_heights(poses, beginning.state))
    surface = int(np.abs(heights.min(axis=1)).argmin()) if heights.size else None
    return Strike(
        time=time,
        time_std=time_std,
        before=ending,
        after=beginning,
        frames_before=last_part(poses, before, stop),
        frames_after=first_part(poses, slice(start, after.stop)),
        surface=surface,
        heights=np.zeros(0) if surface is None else heights[surface],
    )


def last_part(poses: MeasuredPoses, flight: slice, stop: int) -> slice:
    """Return the last frames of a flight before ``stop``, to which velocities are fitted."""
    return slice(max(flight.start, stop - _frames_of_fit(poses)), stop)


def first_part(poses: MeasuredPoses, flight: slice) -> slice:
    """Return the first frames of a flight, to which velocities are fitted."""
    return slice(flight.start, min(flight.stop, flight.start + _frames_of_fit(poses)))


def _frames_of_fit(poses: MeasuredPoses) -> int:
    return max(FEWEST_FRAMES, round(FIT_SPAN * poses.rate))


def _crossing(before: FlightFit, after: FlightFit) -> tuple[float, float]:
    """Return the time at which the poses of two flights agree best, s, and its standard deviation."""
    time, time_std = 0.5 * float(before.reference + after.reference), math.inf
    for _ in range(3):  # Newton's method; the first step is nearly exact, as the paths are nearly straight
        a, b = before.at(time), after.at(time)
        gap = np.concatenate(
            [b.state.p_WB_W - a.state.p_WB_W, rotation_vectors(b.state.q_WB[None], a.state.q_WB)[0]]
        )
        rate = np.concatenate([b.state.v_WB_W - a.state.v_WB_W, b.state.w_WB_W - a.state.w_WB_W])
        p_variance = a.position_std**2 + b.position_std**2
        q_variance = a.orientation_std**2 + b.orientation_std**2
        weight = 1.0 / np.concatenate([np.full(3, p_variance), q_variance])
        information = float(rate @ (weight * rate))
        time -= float(rate @ (weight * gap)) / information
        time_std = 1.0 / math.sqrt(information)
    return time, time_std


def corner_heights(poses: MeasuredPoses, state: BodyState) -> FloatArray:
    """Return the heights of the k corners of a body above each of s flat surfaces, (s, k), m."""
    hulls = poses.body.shape.hulls
    corners = state.p_WB_W + np.concatenate([hull.vertices for hull in hulls]) @ state.R_WB.T
    roundings = np.repeat([hull.rounding for hull in hulls], [len(hull.vertices) for hull in hulls])
    gaps = [surface.gaps(corners) - roundings for surface in poses.surfaces]
    return np.array(gaps).reshape(len(gaps), len(corners))
