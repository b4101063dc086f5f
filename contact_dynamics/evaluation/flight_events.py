"""The flights of a measured body, and how each ends: a first contact, and an impact if it flies on.

Flights are found by `measured.flights` in poses alone. A landing's time does not use the body's shape: if
another flight follows with at most one frame between, it is when the two flights' poses agree best; otherwise
it is halfway between the last frame of the flight and the next one. Shape and surfaces say only whether it
was a landing, and on what.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.constants import ns_after
from contact_dynamics.evaluation.found_event import EventKind, FoundEvent
from contact_dynamics.evaluation.touching import touch_of
from contact_dynamics.measured.events import FIT_SPAN, MAX_BETWEEN, meeting_of_flights
from contact_dynamics.measured.flight_fit import FEWEST_FRAMES, MeasuredState, fit_flight
from contact_dynamics.measured.flights import find_flights
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.tolerances import IMPACT_SPAN, LANDING_GAP, SHARP_VELOCITY

if TYPE_CHECKING:
    from contact_dynamics.evaluation.motion import MeasuredMotion
    from contact_dynamics.evaluation.touching import Touch


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
