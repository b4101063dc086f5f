"""All events of a measured body: flights, how each ends, and when it rests or slides.

Flights are found by `measured.flights` in poses alone. A landing's time does not use the body's shape: if
another flight follows with at most one frame between, it is when the two flights' poses agree best; otherwise
it is halfway between the last frame of the flight and the next one. Shape and surfaces say only whether it
was a landing, and on what.

In each window (`MODE_SPAN`) outside of flights the poses, as position and rotation vector, are fitted by a
quadratic function of time, because friction slows a slide evenly. If the poses keep to it as noise allows,
its slopes in the middle of the window are the velocities there. A contact point that is slower than
`MODE_SPEED`, plus the slopes' noise, is fixed (`f`) or slides (`c`), as its velocity along the surface says;
one that is faster across the surface separates or approaches, and then the window holds neither rest nor
sliding. Neighbouring windows of one kind make one event.

Not covered: rolling, tipping and spinning on a point, which are neither; slides shorter than a window.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.constants import ns_after
from contact_dynamics.contact.found import contacts_within
from contact_dynamics.evaluation.found_event import EventKind, FoundEvent
from contact_dynamics.measured.events import FIT_SPAN, MAX_BETWEEN, meeting_of_flights
from contact_dynamics.measured.flight_fit import FEWEST_FRAMES, MeasuredState, fit_flight
from contact_dynamics.measured.flights import DEVIATIONS, ORIENTATION_SLACK, POSITION_SLACK, find_flights
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rotations.many import rotation_vectors, turned
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
    from collections.abc import Sequence

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.evaluation.found_event import FoundEvent
    from contact_dynamics.evaluation.motion import MeasuredMotion
    from contact_dynamics.world import Body, World


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Touch(Record):
    """What a body touches.

    Attributes:
        surface: Name of the nearest surface.
        gap: m, height of the body's lowest point above it, negative below. It is None at an obstacle, whose
            contacts tell no height.
        contacts: All contacts, with whichever surface.
    """

    surface: str
    gap: float | None
    contacts: ContactSet


def touch_of(body: Body, state: BodyState, world: World, *, within: float) -> Touch | None:
    """Return what a body touches within that gap, m. Without a shape or a surface it touches nothing."""
    if body.shape.is_empty or not world.surfaces:
        return None
    contacts = contacts_within(body, state, world.surfaces, within)
    if len(contacts) == 0:
        return None
    flats = {surface.name: surface for surface in world.surfaces if isinstance(surface, Surface)}
    gaps = [
        (float(flats[name].gaps(point)), name)
        for name, point in zip(contacts.surfaces, contacts.p_WC_W, strict=True)
        if name in flats
    ]
    if not gaps:
        return Touch(surface=contacts.surfaces[0], gap=None, contacts=contacts)
    gap, surface = min(gaps)
    return Touch(surface=surface, gap=gap, contacts=contacts)


def find_events(motion: MeasuredMotion) -> list[FoundEvent]:
    """Return the flights, landings, impacts, rests and slides of a body; `docs/evaluate.md` has the criteria.

    Neither landings nor modes are found of a body without a shape, or in a world without surfaces.
    """
    flights, events = flight_events(motion)
    return sorted([*events, *mode_events(motion, flights)], key=lambda event: (event.since, event.time))


def flight_events(motion: MeasuredMotion) -> tuple[list[slice], list[FoundEvent]]:
    """Return the flights, as slices of samples, and the events of flights, landings and impacts."""
    flights = find_flights(motion)
    events = [_flight(motion, flight) for flight in flights]
    for flight, after in pairwise([*flights, None]):
        if flight is not None:
            events += _end(motion, flight, after)
    return flights, events


def _flight(motion: MeasuredMotion, flight: slice) -> FoundEvent:
    last = flight.stop - 2  # the last one may show the body just past its strike
    velocities = fit_flight(motion, _last_part(motion, flight, last + 1)).at(float(motion.times[last]))
    state = BodyState(
        p_WB_W=motion.p_WB_W[last],
        q_WB=motion.q_WB[last],
        v_WB_W=velocities.state.v_WB_W,
        w_WB_W=velocities.state.w_WB_W,
        stamp_ns=motion.stamp_ns(last),
    )
    return FoundEvent(
        kind=EventKind.FLIGHT,
        body=motion.body.name,
        surface="",
        since=float(motion.times[flight.start]),
        first_sample=flight.start,
        time=float(motion.times[last]),
        time_ns=state.stamp_ns,
        time_std=0.0,
        state=state,
        position_std=motion.position_noise,
        orientation_std=np.full(3, motion.orientation_noise),
        velocity_std=velocities.velocity_std,
        angular_velocity_std=velocities.angular_velocity_std,
    )


def _end(motion: MeasuredMotion, flight: slice, after: slice | None) -> list[FoundEvent]:
    if flight.stop >= len(motion):  # nothing was measured after it
        return []
    if after is not None and after.start - flight.stop <= MAX_BETWEEN:
        meeting = meeting_of_flights(motion, flight, after)
        time_std, landing = meeting.time_std, meeting.before
        # the flights may meet a little after the first frame of the second one
        start = after.start if motion.times[after.start] >= landing.time else after.start + 1
    else:
        last, following = float(motion.times[flight.stop - 1]), float(motion.times[flight.stop])
        fit = fit_flight(motion, _last_part(motion, flight, flight.stop - 1))
        time_std, landing = (following - last) / math.sqrt(12.0), fit.at(0.5 * (last + following))
        start = 0 if after is None else after.start + 1  # the first may show the body still in contact
    touch = touch_of(motion.body, landing.state, motion.world, within=LANDING_GAP)
    if touch is None or (touch.gap is not None and touch.gap < -LANDING_GAP):
        return []
    events = [_event(motion, flight, EventKind.LANDING, landing, time_std=time_std, touch=touch)]
    if after is None or float(motion.times[after.start] - motion.times[flight.stop - 1]) > IMPACT_SPAN:
        return events
    departure = _fit_from(motion, after, start)
    if _is_sharp(motion, landing) and _is_sharp(motion, departure):
        events.append(
            _event(
                motion,
                flight,
                EventKind.IMPACT,
                landing,
                time_std=time_std,
                touch=touch,
                departure=departure,
            )
        )
    return events


def _last_part(motion: MeasuredMotion, flight: slice, stop: int) -> slice:
    """Return the last samples of a flight before ``stop`` that velocities are fitted over."""
    count = max(FEWEST_FRAMES, round(FIT_SPAN * motion.rate))
    return slice(max(flight.start, stop - count), stop)


def _fit_from(motion: MeasuredMotion, flight: slice, start: int) -> MeasuredState:
    """Return the state at sample ``start``, fitted over the part of a flight that begins there."""
    count = max(FEWEST_FRAMES, round(FIT_SPAN * motion.rate))
    fit = fit_flight(motion, slice(start, min(flight.stop, start + count)), reference=start)
    return fit.at(float(motion.times[start]))


def _is_sharp(motion: MeasuredMotion, found: MeasuredState) -> bool:
    properties = motion.body.mass_properties
    gyration = math.sqrt(float(np.trace(properties.I_B)) / (3.0 * properties.mass))
    spin_std = float(found.angular_velocity_std.max())
    return max(found.velocity_std, gyration * spin_std) <= SHARP_VELOCITY


def _event(
    motion: MeasuredMotion,
    flight: slice,
    kind: EventKind,
    landing: MeasuredState,
    *,
    time_std: float,
    touch: Touch,
    departure: MeasuredState | None = None,
) -> FoundEvent:
    compared = departure or landing
    return FoundEvent(
        kind=kind,
        body=motion.body.name,
        surface=touch.surface,
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
        gap=touch.gap,
        duration=max(0.0, compared.time - landing.time),
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class _Window(Record):
    """What the contacts do in one window of samples."""

    first: int
    stop: int
    kind: EventKind
    mode: str
    touch: Touch
    middle: BodyState
    velocity_std: float
    angular_velocity_std: float


def mode_events(motion: MeasuredMotion, flights: Sequence[slice]) -> list[FoundEvent]:
    """Return the rests and slides of a body, between its flights."""
    count = max(5, round(MODE_SPAN * motion.rate))
    begins = [0, *(flight.stop for flight in flights)]
    ends = [*(flight.start for flight in flights), len(motion)]
    events = []
    for begin, end in zip(begins, ends, strict=True):
        stretch: list[_Window] = []
        for first in range(begin, end - count + 1, max(1, count // 4)):
            window = _window(motion, first, first + count)
            if stretch and (window is None or window.kind is not stretch[-1].kind):
                events.append(_mode_event(motion, stretch))
                stretch = []
            if window is not None:
                stretch.append(window)
        if stretch:
            events.append(_mode_event(motion, stretch))
    return events


def _window(motion: MeasuredMotion, first: int, stop: int) -> _Window | None:
    middle = (first + stop) // 2
    times = motion.times[first:stop] - motion.times[middle]
    poses = np.hstack(
        [
            motion.p_WB_W[first:stop] - motion.p_WB_W[middle],
            rotation_vectors(motion.q_WB[first:stop], motion.q_WB[middle]),
        ]
    )
    powers = np.column_stack([np.ones_like(times), times, times * times])
    fitted = np.linalg.lstsq(powers, poses, rcond=None)[0]
    at_middle, slopes = fitted[0], fitted[1]
    noise = np.repeat([motion.position_noise, motion.orientation_noise], 3)
    allowed = DEVIATIONS * noise + np.repeat([POSITION_SLACK, ORIENTATION_SLACK], 3)
    if (np.abs(poses - powers @ fitted) > allowed).any():
        return None
    state = BodyState(
        p_WB_W=motion.p_WB_W[middle] + at_middle[:3],
        q_WB=turned(motion.q_WB[middle], at_middle[None, 3:])[0],
        v_WB_W=slopes[:3],
        w_WB_W=slopes[3:],
        stamp_ns=motion.stamp_ns(middle),
    )
    touch = touch_of(motion.body, state, motion.world, within=TOUCHING_GAP)
    if touch is None:
        return None
    spread = float(np.sqrt(np.square(times - times.mean()).sum()))
    velocity_std, angular_velocity_std = noise[0] / spread, noise[3] / spread
    mode = _mode(state, touch, velocity_std, angular_velocity_std)
    if not mode:
        return None
    reach = float(np.linalg.norm(motion.body.shape.vertices, axis=1).max()) + motion.body.shape.rounding
    is_slow = max(
        np.linalg.norm(state.v_WB_W), reach * np.linalg.norm(state.w_WB_W)
    ) <= MODE_SPEED + DEVIATIONS * (velocity_std + reach * angular_velocity_std)
    if "c" not in mode and not is_slow:  # it rolls, or spins on a point
        return None
    return _Window(
        first=first,
        stop=stop,
        kind=EventKind.SLIDING if "c" in mode else EventKind.REST,
        mode=mode,
        touch=touch,
        middle=state,
        velocity_std=velocity_std,
        angular_velocity_std=angular_velocity_std,
    )


def _mode(state: BodyState, touch: Touch, velocity_std: float, angular_velocity_std: float) -> str:
    """Return a letter for each contact, f or c; empty if a contact separates or approaches."""
    letters = []
    for point, normal in zip(touch.contacts.p_WC_W, touch.contacts.normals_W, strict=True):
        velocity = state.velocity_of_point(point)
        arm = float(np.linalg.norm(point - state.p_WB_W))
        allowed = MODE_SPEED + DEVIATIONS * float(np.hypot(velocity_std, arm * angular_velocity_std))
        across = float(velocity @ normal)
        if abs(across) > allowed:
            return ""
        letters.append("c" if float(np.linalg.norm(velocity - across * normal)) > allowed else "f")
    return "".join(letters)


def _mode_event(motion: MeasuredMotion, stretch: Sequence[_Window]) -> FoundEvent:
    last = stretch[-1]
    sample = (last.first + last.stop) // 2
    return FoundEvent(
        kind=last.kind,
        body=motion.body.name,
        surface=last.touch.surface,
        since=float(motion.times[stretch[0].first]),
        first_sample=stretch[0].first,
        time=float(motion.times[sample]),
        time_ns=motion.stamp_ns(sample),
        time_std=0.0,
        state=last.middle,
        position_std=motion.position_noise,
        orientation_std=np.full(3, motion.orientation_noise),
        velocity_std=last.velocity_std,
        angular_velocity_std=np.full(3, last.angular_velocity_std),
        gap=last.touch.gap,
        mode=last.mode,
    )
