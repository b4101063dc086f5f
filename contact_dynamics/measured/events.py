"""This file finds in hindsight the strikes of a measured toss, with the states around them, and its rest.

A strike is between two flights with at most one frame between them. Both flights are fitted over the frames
next to the strike. The time of the strike is when their positions and orientations agree best, because the
pose is continuous while velocities jump. This gives the time far more sharply than the spacing of frames, and
does not use where corners or surface are. For a strike of some length it is the centre of the impulse.

The body rests from when its pose no longer leaves the mean of its last `REST_SPAN`.

Each number has its standard deviation, so that an error of prediction can be compared with the noise of
measurement. Not covered: strikes in such quick succession that `flights` finds no flight in between, and
rocking and sliding contact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.constants import to_ns
from contact_dynamics.measured.flight_fit import FEWEST_FRAMES, FlightFit, MeasuredState, fit_flight
from contact_dynamics.measured.flights import DEVIATIONS, ORIENTATION_SLACK, POSITION_SLACK, find_flights
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rotations.many import rotation_vectors, turned

if TYPE_CHECKING:
    from contact_dynamics.measured.poses import MeasuredPoses
    from contact_dynamics.measured.recorded_toss import Toss
    from contact_dynamics.validation import FloatArray

FIT_SPAN: Final = 0.08
"""s. The velocity is fitted over this much of a flight next to a strike. In a longer span, errors of the
model, such as gravity off by 2 %, would be larger than the gain in noise."""

MAX_BETWEEN: Final = 1
"""Most frames between two flights that one strike may take. Such a frame shows the body in contact."""

REST_SPAN: Final = 0.05
"""s. A body that kept its pose for this time is at rest. It is short because the published recordings of
cubes stop soon after the cube does."""

REST_SPEED: Final = 0.02
"""m/s. Mean speed over `REST_SPAN` below which a body rests: friction of 0.2 ends such a slide in 10 ms."""

REST_SPIN: Final = 0.2
"""rad/s. Mean angular speed over `REST_SPAN` below which a body of a decimetre rests."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FlightMeeting(Record):
    """Where one flight passes into the next, by their poses alone.

    Attributes:
        time: When the poses of both flights agree best, s, on the recording's clock.
        time_std: Standard deviation of that time, s.
        before: The state at that time, from the flight that ends.
        after: The state at that time, from the flight that begins.
    """

    time: float
    time_std: float
    before: MeasuredState
    after: MeasuredState


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class MeasuredStrike(FlightMeeting):
    """One strike between two flights, at the time when their poses agree best.

    Attributes:
        heights: (k,), m, of the body's corners above the surface at that time, from both flights' mean.
    """

    heights: FloatArray

    @property
    def corner(self) -> int:
        """Index of the lowest corner: the row of the body's vertices that struck."""
        return int(np.argmin(self.heights))

    @property
    def margin(self) -> float:
        """How much higher the next corner was, m: small where an edge or a face struck."""
        lowest, second = np.sort(self.heights)[:2]
        return float(second - lowest)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class RestingPose(Record):
    """The pose that a body keeps at the end of a recording.

    Attributes:
        time: Time of the first frame from which on the pose stayed, s.
        state: The mean pose from then on, at velocity 0.
        position_std: Standard deviation of each coordinate of the mean, m.
        orientation_std: Standard deviation of each component of the mean, rad.
    """

    time: float
    state: BodyState
    position_std: float
    orientation_std: float


def find_strikes(toss: Toss) -> tuple[MeasuredStrike, ...]:
    """Return the strikes of a recorded toss in the order of time."""
    return tuple(
        _strike(toss, before, after)
        for before, after in pairwise(find_flights(toss))
        if after.start - before.stop <= MAX_BETWEEN
    )


def corner_heights(toss: Toss, state: BodyState) -> FloatArray:
    """Return the heights, (k,), m, of the body's corners above the toss's surface."""
    return toss.surface.gaps(state.p_WB_W + toss.body.vertices_B @ state.R_WB.T)


def _strike(toss: Toss, before: slice, after: slice) -> MeasuredStrike:
    meeting = meeting_of_flights(toss, before, after)
    heights = 0.5 * (corner_heights(toss, meeting.before.state) + corner_heights(toss, meeting.after.state))
    return MeasuredStrike(
        time=meeting.time,
        time_std=meeting.time_std,
        before=meeting.before,
        after=meeting.after,
        heights=heights,
    )


def meeting_of_flights(poses: MeasuredPoses, before: slice, after: slice) -> FlightMeeting:
    """Return when one flight passes into the next, with at most `MAX_BETWEEN` frames between them."""
    count = max(FEWEST_FRAMES, round(FIT_SPAN * poses.rate))
    fit_after = fit_flight(
        poses, slice(after.start, min(after.stop, after.start + count)), reference=after.start
    )
    stop = before.stop
    while True:
        fit_before = fit_flight(poses, slice(max(before.start, stop - count), stop))
        time, time_std = _crossing(fit_before, fit_after)
        # a frame just past the strike may have passed for flight: then the crossing comes before it
        if time >= poses.times[stop - 1] - time_std or stop - 1 - before.start < FEWEST_FRAMES:
            break
        stop -= 1
    return FlightMeeting(time=time, time_std=time_std, before=fit_before.at(time), after=fit_after.at(time))


def _crossing(before: FlightFit, after: FlightFit) -> tuple[float, float]:
    """Return when two flights agree best in position and orientation, s, and its standard deviation."""
    time, time_std = 0.5 * (before.reference + after.reference), math.inf
    for _ in range(3):  # Newton's steps; the paths are nearly straight, so that the first is nearly exact
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


def find_rest(poses: MeasuredPoses) -> RestingPose | None:
    """Return the pose in which a body rests at the end of a recording, or None if it still moves."""
    n = max(FEWEST_FRAMES, round(REST_SPAN * poses.rate))
    rows = np.hstack([poses.p_WB_W, rotation_vectors(poses.q_WB, poses.q_WB[-1])])
    noise = np.repeat([poses.position_noise, poses.orientation_noise], 3)
    moves = np.repeat([REST_SPEED, REST_SPIN], 3)
    if n > len(poses) or (_drift(poses.times[-n:], rows[-n:]) > moves).any():
        return None
    allowed = DEVIATIONS * noise + np.repeat([POSITION_SLACK, ORIENTATION_SLACK], 3)
    moved = np.flatnonzero((np.abs(rows - rows[-n:].mean(axis=0)) > allowed).any(axis=1))
    begin = int(moved[-1]) + 1 if len(moved) else 0
    if len(poses) - begin < n:
        return None
    mean, std = rows[begin:].mean(axis=0), noise / math.sqrt(len(poses) - begin)
    return RestingPose(
        time=float(poses.times[begin]),
        state=BodyState(
            p_WB_W=mean[:3],
            q_WB=turned(poses.q_WB[-1], mean[None, 3:])[0],
            v_WB_W=np.zeros(3),
            w_WB_W=np.zeros(3),
            stamp_ns=to_ns(float(poses.times[begin])),
        ),
        position_std=float(std[0]),
        orientation_std=float(std[3]),
    )


def _drift(times: FloatArray, poses: FloatArray) -> FloatArray:
    """Return the size of the mean rate of each column of ``poses``, (n, 6)."""
    centred = times - times.mean()
    sizes: FloatArray = np.abs(centred @ poses) / (centred @ centred)
    return sizes
