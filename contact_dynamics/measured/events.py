# SPDX-License-Identifier: Apache-2.0
"""Finds all events of a measured body: flights, landings, impacts, rests and slides.

Flights and strikes are found from poses alone (`flights`). The time of a landing is independent of the shape
of the body: if another flight follows after at most one frame, it is the time of the strike; otherwise it is
halfway between the last frame of the flight and the next frame. Shape and surfaces only determine whether the
flight ended with a landing, and on which surface.

In each window (`MODE_SPAN`) outside flights, a quadratic function of time is fitted to the poses (position
and rotation vector), because friction decelerates a slide uniformly. If the residuals are within the noise,
the slopes in the middle of the window are the velocities there. Contact points whose speed along the surface
is below `MODE_SPEED`, plus the noise of the slopes, are fixed (`f`), and the others slide (`c`). If a contact
point moves faster than this along the normal, the window contains neither a rest nor a slide. Adjacent
windows of the same kind form one event.

At the end of a recording, the rest begins when the pose stays at the mean of its last `REST_SPAN`. This
requires no surface, and yields the most precise pose.

Not covered: rocking, rolling, tipping and spinning on a point, which are neither rest nor slide; slides
shorter than a window.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from itertools import chain, pairwise
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.constants import ns_after, to_ns
from contact_dynamics.contact.found import contacts_within
from contact_dynamics.measured.flight_fit import FEWEST_FRAMES, MeasuredState, fit_flight
from contact_dynamics.measured.flights import (
    ALONE,
    AT_ONCE,
    DEVIATIONS,
    ORIENTATION_SLACK,
    POSITION_SLACK,
    find_flights,
    first_part,
    last_part,
    strike_between,
)
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rotations.many import crosses, matrices_of, rotation_vectors, turned
from contact_dynamics.tolerances import (
    IMPACT_SPAN,
    LANDING_GAP,
    MODE_SPAN,
    MODE_SPEED,
    SHARP_VELOCITY,
    TOUCHING_GAP,
)
from contact_dynamics.world import Surface

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from contact_dynamics.measured.motion import MeasuredMotion, MeasuredPoses
    from contact_dynamics.validation import FloatArray

    IntArray = NDArray[np.intp]
    BoolArray = NDArray[np.bool_]

REST_SPAN: Final = 0.05
"""s. A body whose pose is constant for this time is at rest. The time is short because the published
recordings of cubes end soon after the cube stops."""

REST_SPEED: Final = 0.02
"""m/s. Mean speed over `REST_SPAN` below which a body is at rest: friction of 0.2 ends such a slide in
10 ms."""

REST_SPIN: Final = 0.2  # rad/s. Mean angular speed over `REST_SPAN` below which a body of a decimetre rests.


class EventKind(Enum):
    """Kinds of events. `docs/evaluate.md` lists the criteria."""

    FLIGHT = "flight"  # the poses agree with a free flight
    LANDING = "landing"  # first contact: a flight ends at a surface
    IMPACT = "impact"  # a flight ends at a surface, and another begins soon after
    REST = "rest"  # the body touches a surface, and no contact moves
    SLIDING = "sliding"
    """The body touches a surface, no contact separates or approaches, and at least one slides."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FoundEvent(MeasuredState):
    """An event of a body, with the state at its time; for an impact, the state ``duration`` later.

    ``time``, s after the epoch, is the time of the comparison with a prediction: near the end of a flight, a
    rest or a slide, and at a landing or an impact.
    """

    kind: EventKind
    body: str  # name of the body
    surface: str  # name of the surface; empty for a flight
    # s after the epoch, start of the flight, rest or slide; for other events, of the flight before.
    since: float
    first_sample: int  # the sample at ``since``; earlier states are not used to predict this event
    time_ns: int  # ``time`` as a stamp, ns
    time_std: float  # standard deviation of ``time``, s; zero if it is the time of a sample
    # m, height of the lowest point above the surface, negative below it; None without a flat surface.
    gap: float | None = None
    # s, from the first contact of an impact to the beginning of the flight after it; 0 otherwise.
    duration: float = 0.0
    mode: str = ""  # measured letters of the contacts of a rest or a slide; empty otherwise
    # True if several corners may have struck: another corner is higher than the lowest one by less than
    # `ALONE` of the size of the body, or more than one frame is between both flights.
    several: bool = False

    def asked_ns(self, horizon: float) -> int:
        """Return the time of a prediction ``horizon``, s, before the event, ns."""
        return ns_after(self.time_ns, -horizon)


def find_events(motion: MeasuredMotion) -> list[FoundEvent]:
    """Return the flights, landings, impacts, rests and slides of a body (criteria in `docs/evaluate.md`).

    If the body has no shape or the world no surfaces, only flights are found.
    """
    flights = find_flights(motion)
    events = [_flight(motion, flight) for flight in flights]
    for flight, after in pairwise([*flights, None]):
        if flight is not None:
            events += _end(motion, flight, after)
    count = max(5, round(MODE_SPAN * motion.rate))
    begins = [0, *(flight.stop for flight in flights)]
    ends = [*(flight.start for flight in flights), len(motion)]
    for begin, end in zip(begins, ends, strict=True):
        events += _modes(motion, range(begin, end - count + 1, max(1, count // 4)), count)
    return sorted(events, key=lambda event: (event.since, event.time))


def _flight(motion: MeasuredMotion, flight: slice) -> FoundEvent:
    last = flight.stop - 2  # the last frame may show the body just after its strike
    time = float(motion.times[last])
    fitted = fit_flight(motion, last_part(motion, flight, last + 1)).at(time)
    state = BodyState(
        p_WB_W=motion.p_WB_W[last],
        q_WB=motion.q_WB[last],
        v_WB_W=fitted.state.v_WB_W,
        w_WB_W=fitted.state.w_WB_W,
        stamp_ns=motion.stamp_ns(last),
    )
    return FoundEvent(
        kind=EventKind.FLIGHT,
        body=motion.body.name,
        surface="",
        since=float(motion.times[flight.start]),
        first_sample=flight.start,
        time=time,
        time_ns=state.stamp_ns,
        time_std=0.0,
        state=state,
        position_std=motion.position_noise,
        orientation_std=np.full(3, motion.orientation_noise),
        velocity_std=fitted.velocity_std,
        angular_velocity_std=fitted.angular_velocity_std,
    )


def _end(motion: MeasuredMotion, flight: slice, after: slice | None) -> Iterator[FoundEvent]:
    if flight.stop >= len(motion):  # nothing was measured after it
        return
    strike = None if after is None else strike_between(motion, flight, after)
    if strike is not None:
        time_std, landing = strike.time_std, strike.before
    else:
        last, following = float(motion.times[flight.stop - 1]), float(motion.times[flight.stop])
        fit = fit_flight(motion, last_part(motion, flight, flight.stop - 1))
        time_std, landing = (following - last) / math.sqrt(12.0), fit.at(0.5 * (last + following))
    contacts = _contacts(motion, landing.state.p_WB_W[None], landing.state.q_WB[None], within=LANDING_GAP)
    if not contacts.near.any():
        return
    surface, gap = contacts.nearest(0)
    low = contacts.gaps[0] < contacts.gaps[0].min() + ALONE * motion.body.shape.reach
    if gap is not None and gap < -LANDING_GAP:
        return

    def event(kind: EventKind, compared: MeasuredState) -> FoundEvent:
        return FoundEvent(
            kind=kind,
            body=motion.body.name,
            surface=surface,
            since=float(motion.times[flight.start]),
            first_sample=flight.start,
            time=landing.time,
            time_ns=ns_after(motion.epoch_ns, landing.time),
            time_std=time_std,
            state=compared.state,
            position_std=compared.position_std,
            orientation_std=compared.orientation_std,
            velocity_std=compared.velocity_std,
            angular_velocity_std=compared.angular_velocity_std,
            gap=gap,
            duration=max(0.0, compared.time - landing.time),
            several=kind is EventKind.IMPACT and (strike is None or int(low.sum()) > 1),
        )

    yield event(EventKind.LANDING, landing)
    if after is None or float(motion.times[after.start] - motion.times[flight.stop - 1]) > IMPACT_SPAN:
        return
    # the flights may meet after the first frame of the second one, which may then show the body in contact
    clear = strike is not None and motion.times[after.start] >= landing.time
    start = after.start if clear else after.start + 1
    fit = fit_flight(motion, first_part(motion, slice(start, after.stop)), reference=start)
    departure = fit.at(float(motion.times[start]))
    if _is_sharp(motion, landing) and _is_sharp(motion, departure):
        yield event(EventKind.IMPACT, departure)


def _is_sharp(motion: MeasuredMotion, found: MeasuredState) -> bool:
    properties = motion.body.mass_properties
    gyration = math.sqrt(float(np.trace(properties.I_B)) / (3.0 * properties.mass))
    spin_std = float(found.angular_velocity_std.max())
    return max(found.velocity_std, gyration * spin_std) <= SHARP_VELOCITY


class _Contacts(NamedTuple):
    """The m points at which a body may touch in each of k poses."""

    surfaces: tuple[str, ...]  # names of the surfaces
    numbers: IntArray  # (k, m), numbers of the surfaces
    points_W: FloatArray  # (k, m, 3), m
    normals_W: FloatArray  # (k, m, 3)
    gaps: FloatArray  # (k, m), m, above a flat surface; infinite at an obstacle
    near: BoolArray  # (k, m), whether the point touches

    def nearest(self, pose: int) -> tuple[str, float | None]:
        """Return the surface that a body touches in a pose, and the gap of the lowest point, m, or None."""
        near = np.flatnonzero(self.near[pose])
        lowest = near[self.gaps[pose, near].argmin()]
        gap = float(self.gaps[pose, lowest])
        return self.surfaces[self.numbers[pose, lowest]], gap if gap < math.inf else None


def _contacts(motion: MeasuredMotion, p_WB_W: FloatArray, q_WB: FloatArray, *, within: float) -> _Contacts:
    """Return the contacts of a body in k poses within a gap, m. There are none without shape or surfaces."""
    shape, surfaces, count = motion.body.shape, motion.world.surfaces, len(p_WB_W)
    names = tuple(surface.name for surface in surfaces)
    if shape.is_polyhedron and len(motion.surfaces) == len(surfaces):  # common, and takes a tenth
        corners = p_WB_W[:, None] + shape.vertices @ matrices_of(q_WB).transpose(0, 2, 1)
        numbers = np.repeat(np.arange(len(surfaces)), len(shape.vertices))
        numbers = np.broadcast_to(numbers, (count, len(numbers)))
        normals = np.array([surface.normal_W for surface in motion.surfaces]).reshape(-1, 3)
        points = np.tile(corners, (1, len(surfaces), 1))
        gaps = np.concatenate(
            [np.zeros((count, 0)), *(flat.gaps(corners) for flat in motion.surfaces)], axis=1
        )
        return _Contacts(names, numbers, points, normals[numbers], gaps, gaps <= within)
    found = [
        contacts_within(
            motion.body, BodyState(p_WB_W=p, q_WB=q, v_WB_W=[0, 0, 0], w_WB_W=[0, 0, 0]), surfaces, within
        )
        for p, q in zip(p_WB_W, q_WB, strict=True)
        if not shape.is_empty
    ]
    most = max((len(each) for each in found), default=0)
    contacts = _Contacts(
        names,
        np.zeros((count, most), dtype=np.intp),
        np.zeros((count, most, 3)),
        np.zeros((count, most, 3)),
        np.full((count, most), math.inf),
        np.zeros((count, most), dtype=bool),
    )
    for row, each in enumerate(found):
        contacts.near[row, : len(each)] = True
        contacts.points_W[row, : len(each)] = each.p_WC_W
        contacts.normals_W[row, : len(each)] = each.normals_W
        for k, name in enumerate(each.surfaces):
            number = names.index(name)
            contacts.numbers[row, k], surface = number, surfaces[number]
            if isinstance(surface, Surface):
                contacts.gaps[row, k] = surface.gaps(each.p_WC_W[k])
    return contacts


class _Window(NamedTuple):
    """A window of frames in which a body rests or slides."""

    kind: EventKind
    samples: IntArray  # (count,)
    pose: FloatArray  # (6,), relative to the measured pose in the middle, m and rad
    rates: FloatArray  # (6,), m/s and rad/s
    stds: FloatArray  # (2,), standard deviations of linear and angular rates
    contacts: _Contacts
    slide: BoolArray  # (k, m), of all k windows
    row: int  # number of this window


def _modes(motion: MeasuredMotion, firsts: range, count: int) -> Iterator[FoundEvent]:
    """Yield the rests and slides in windows of ``count`` samples, whose first samples are ``firsts``."""
    first: _Window | None = None
    last: _Window | None = None
    for window in chain(_windows(motion, firsts, count), [None]):
        if first is not None and last is not None and (window is None or window.kind is not last.kind):
            yield _mode_event(motion, first, last)
            first = None
        first, last = first or window, window


def _windows(motion: MeasuredMotion, firsts: range, count: int) -> Iterator[_Window | None]:
    """Yield for each window of ``count`` samples a rest or a slide at its middle, or None."""
    noise = np.repeat([motion.position_noise, motion.orientation_noise], 3)
    allowed = DEVIATIONS * noise + np.repeat([POSITION_SLACK, ORIENTATION_SLACK], 3)
    reach = motion.body.shape.reach
    for at in range(0, len(firsts), AT_ONCE):
        samples = np.array(firsts[at : at + AT_ONCE])[:, None] + np.arange(count)
        middles = samples[:, count // 2]
        times = motion.times[samples] - motion.times[middles][:, None]
        places = motion.p_WB_W[samples] - motion.p_WB_W[middles][:, None]
        turns = rotation_vectors(
            motion.q_WB[samples].reshape(-1, 4), np.repeat(motion.q_WB[middles], count, axis=0)
        )
        poses = np.concatenate([places, turns.reshape(places.shape)], axis=2)
        powers = np.stack([np.ones_like(times), times, times * times], axis=2)
        orthogonal, triangle = np.linalg.qr(powers)
        fitted = np.linalg.solve(triangle, orthogonal.transpose(0, 2, 1) @ poses)
        fits = (np.abs(poses - powers @ fitted) <= allowed).all(axis=(1, 2))
        spreads = np.sqrt(np.square(times - times.mean(axis=1, keepdims=True)).sum(axis=1))
        stds = noise[[0, 3]] / spreads[:, None]
        p_WB_W = motion.p_WB_W[middles] + fitted[:, 0, :3]
        contacts = _contacts(
            motion, p_WB_W, turned(motion.q_WB[middles], fitted[:, 0, 3:]), within=TOUCHING_GAP
        )
        v, w = fitted[:, 1, :3], fitted[:, 1, 3:]
        arms = contacts.points_W - p_WB_W[:, None]
        velocities = v[:, None] + crosses(w[:, None], arms)
        across = (velocities * contacts.normals_W).sum(axis=2)
        along = np.linalg.norm(velocities - across[..., None] * contacts.normals_W, axis=2)
        noises = np.hypot(stds[:, :1], np.linalg.norm(arms, axis=2) * stds[:, 1:])
        leave = contacts.near & (np.abs(across) > MODE_SPEED + DEVIATIONS * noises)
        slide = contacts.near & (along > MODE_SPEED + DEVIATIONS * noises)
        speeds = np.maximum(np.linalg.norm(v, axis=1), reach * np.linalg.norm(w, axis=1))
        slow = speeds <= MODE_SPEED + DEVIATIONS * (stds @ [1.0, reach])
        slides = slide.any(axis=1)
        # a window with a separating or approaching contact, rolling, or spinning on a point does not count
        counts = fits & contacts.near.any(axis=1) & ~leave.any(axis=1) & (slides | slow)
        for k in range(len(samples)):
            kind = EventKind.SLIDING if slides[k] else EventKind.REST
            yield (
                _Window(kind, samples[k], fitted[k, 0], fitted[k, 1], stds[k], contacts, slide, k)
                if counts[k]
                else None
            )


def _mode_event(motion: MeasuredMotion, first: _Window, last: _Window) -> FoundEvent:
    begin, middle = int(first.samples[0]), int(last.samples[len(last.samples) // 2])
    velocity_std, angular_velocity_std = last.stds.tolist()
    surface, gap = last.contacts.nearest(last.row)
    letters = np.where(last.slide[last.row], "c", "f")[last.contacts.near[last.row]]
    return FoundEvent(
        kind=last.kind,
        body=motion.body.name,
        surface=surface,
        since=float(motion.times[begin]),
        first_sample=begin,
        time=float(motion.times[middle]),
        time_ns=motion.stamp_ns(middle),
        time_std=0.0,
        state=BodyState(
            p_WB_W=motion.p_WB_W[middle] + last.pose[:3],
            q_WB=turned(motion.q_WB[middle], last.pose[None, 3:])[0],
            v_WB_W=last.rates[:3],
            w_WB_W=last.rates[3:],
            stamp_ns=motion.stamp_ns(middle),
        ),
        position_std=motion.position_noise,
        orientation_std=np.full(3, motion.orientation_noise),
        velocity_std=velocity_std,
        angular_velocity_std=np.full(3, angular_velocity_std),
        gap=gap,
        mode="".join(letters.tolist()),
    )


def find_rest(poses: MeasuredPoses) -> MeasuredState | None:
    """Return the mean pose in which a body rests at the end of a recording, or None if it still moves.

    Its time is that of the first frame from which the pose is constant. The velocities are zero.
    """
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
    time = float(poses.times[begin])
    return MeasuredState(
        time=time,
        state=BodyState(
            p_WB_W=mean[:3],
            q_WB=turned(poses.q_WB[-1], mean[None, 3:])[0],
            v_WB_W=np.zeros(3),
            w_WB_W=np.zeros(3),
            stamp_ns=to_ns(time),
        ),
        position_std=float(std[0]),
        orientation_std=std[3:],
        velocity_std=0.0,
        angular_velocity_std=np.zeros(3),
    )


def _drift(times: FloatArray, poses: FloatArray) -> FloatArray:
    """Return the absolute mean rate of each column of ``poses``, (n, 6)."""
    centred = times - times.mean()
    sizes: FloatArray = np.abs(centred @ poses) / (centred @ centred)
    return sizes
