"""At which times a trajectory is asked for, and what ends it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.constants import seconds_between
from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.landing.earliest import next_landing
from contact_dynamics.landing.plane_arrival import first_contact
from contact_dynamics.motion.integrated import ForcedMotion
from contact_dynamics.nodes.subject import Knowledge, Subject, check_has_shape, or_configured
from contact_dynamics.validation import check_array, check_unit
from msg_adapters.geometry import vector_from_msg

if TYPE_CHECKING:
    from contact_dynamics.tumbling import FreeMotion
    from contact_dynamics.validation import FloatArray

MOST_SAMPLES: Final = 20_000
"""Longest trajectory in one answer: 2.2 MB of numbers. More would stall the middleware for longer than the
answer takes."""

MOST_INTEGRATED_TURNS: Final = 100.0
"""Longest motion under torque or drag in one answer, in turns at the present rate: 1 or 2 s of computing,
during which nobody else is answered."""

MOST_INTEGRATED_STEPS: Final = 6000
"""Of the integrator, for the same reason: what a torque spins up takes more than its present rate says."""

MOST_SEARCHED_TURNS: Final = 1000.0
"""Longest search for a contact in one answer, in turns, for the same reason: a body that spins close to a
surface without touching it takes a millisecond a turn."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Event:
    """What ends a trajectory."""

    kind: int  # a constant of the response
    seconds: float  # s after the state's stamp
    point_W: FloatArray  # (3,), m
    velocity_W: FloatArray  # (3,), m/s
    surface: str  # name of the surface that is touched; empty: a plane of the request's


def times_of(
    request: Any, response: Any, subject: Subject, motion: FreeMotion | ForcedMotion, knowledge: Knowledge
) -> tuple[FloatArray, Event | None]:
    """Return the times, (n,), s after the state's stamp, that a request asks for, and what ends them.

    Raises:
        ContactDynamicsError: times that do not ascend, are too many, or are sampled in an unknown way.
    """
    if request.sampling == request.AT_TIMES:
        times = _ascending("times", np.array(request.times))
        if len(times) > 0 and times[0] < 0.0:
            raise InvalidFieldError("times[0]", times[0], "a number >= 0 (AT_STAMPS reaches into the past)")
        _check_reach("times", motion, times)
        return times, None
    if request.sampling == request.AT_STAMPS:
        stamps_ns = request.stamps_ns
        _check_count("stamps_ns", len(stamps_ns))
        seconds = [seconds_between(subject.state.stamp_ns, stamp) for stamp in stamps_ns]
        times = _ascending("stamps_ns", np.array(seconds))
        _check_reach("stamps_ns", motion, times)
        return times, None
    duration = or_configured("duration", request.duration, knowledge.parameters.horizon)
    rate = or_configured("rate", request.rate, knowledge.parameters.rate)
    _check_reach("duration", motion, np.array([duration]), search=request.sampling != request.AT_RATE)
    if request.sampling == request.AT_RATE:
        event = None
    elif request.sampling == request.UNTIL_CONTACT:
        event = _contact(response, subject, motion, knowledge, duration)
    elif request.sampling == request.UNTIL_PLANE:
        event = _plane_reached(request, response, subject, motion, duration)
    else:
        allowed = "AT_TIMES (0), AT_STAMPS (1), AT_RATE (2), UNTIL_CONTACT (3) or UNTIL_PLANE (4)"
        raise InvalidFieldError("sampling", request.sampling, allowed)
    return _at_rate(rate, duration, None if event is None else event.seconds), event


def _contact(
    response: Any, subject: Subject, motion: FreeMotion | ForcedMotion, knowledge: Knowledge, duration: float
) -> Event | None:
    check_has_shape(subject.body)
    parameters = knowledge.parameters
    landing = next_landing(
        subject.body,
        subject.state,
        parameters.world,
        horizon=duration,
        distance_tolerance=parameters.distance_tolerance,
        velocity_tolerance=parameters.velocity_tolerance,
        motion=motion,
    )
    if landing is None:
        return None
    return Event(
        kind=response.CONTACT,
        seconds=landing.seconds,
        point_W=landing.contacts.p_WC_W[0],
        velocity_W=landing.velocities_W[0],
        surface=landing.contacts.surfaces[0],
    )


def _plane_reached(
    request: Any, response: Any, subject: Subject, motion: FreeMotion | ForcedMotion, duration: float
) -> Event | None:
    point_B = check_array("body_point", vector_from_msg(request.body_point), (3,)) - subject.body.p_FB_F
    found = first_contact(
        motion,
        point_B[None, :],
        check_array("plane_point", vector_from_msg(request.plane_point), (3,)),
        check_unit("plane_normal", vector_from_msg(request.plane_normal), 3),
        horizon=duration,
    )
    if found is None:
        return None
    return Event(
        kind=response.PLANE_REACHED,
        seconds=found.seconds,
        point_W=found.p_WC_W,
        velocity_W=found.v_WC_W,
        surface="",
    )


def _check_reach(
    field: str, motion: FreeMotion | ForcedMotion, times: FloatArray, *, search: bool = False
) -> None:
    """Refuse what would be integrated or searched for too long, before it is."""
    if isinstance(motion, ForcedMotion):
        most, when = MOST_INTEGRATED_TURNS, "under torque or drag"
    elif search:
        most, when = MOST_SEARCHED_TURNS, "to search for a contact"
    else:
        return  # the closed form reaches everywhere
    check_turns(field, motion, times, most, when)


def check_turns(
    field: str, motion: FreeMotion | ForcedMotion, times: FloatArray, most: float, when: str
) -> None:
    """Refuse times, (n,), s, by which a body turns more than ``most``, at its present rate; say why."""
    w_WB_W = motion.state.w_WB_W
    turns = float(np.abs(times).max(initial=0.0)) * math.sqrt(w_WB_W @ w_WB_W) / (2.0 * math.pi)
    if turns > most:
        raise InvalidFieldError(field, f"{turns:.6g} turns of the body ahead", f"at most {most:g} {when}")


def _at_rate(rate: float, duration: float, end: float | None) -> FloatArray:
    """Return times from 0 at a rate, up to the duration, or to the event, which is then the last."""
    until = duration if end is None else end
    _check_count("rate * duration", until * rate)
    times = np.arange(math.floor(until * rate * (1.0 + 1e-12)) + 1) / rate
    return times if end is None else np.append(times[times < end], end)


def _ascending(field: str, times: FloatArray) -> FloatArray:
    _check_count(field, len(times))
    checked = check_array(field, times, (None,))
    steps = np.diff(checked)
    for i in np.flatnonzero(steps < 0.0)[:1]:
        raise InvalidFieldError(
            f"{field}[{i + 1}]", f"{-steps[i]:.9g} s before {field}[{i}]", "ascending times"
        )
    return checked


def _check_count(field: str, count: float) -> None:
    if count > MOST_SAMPLES:
        raise TooLargeError(field, f"{count:.9g} samples", f"at most {MOST_SAMPLES}")
