"""Answers `~/predict_tumbling`."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.errors import InvalidFieldError, NotSupportedError, TooLargeError
from contact_dynamics.first_contact import first_contact
from contact_dynamics.landing import next_landing
from contact_dynamics.nodes.subject import (
    Knowledge,
    Subject,
    check_has_shape,
    gravity_of,
    or_configured,
    subject_of,
)
from contact_dynamics.poinsot import poinsot
from contact_dynamics.tumbling import FreeMotion, free_motion
from contact_dynamics.validation import check_array, check_unit
from msg_adapters.geometry import point_to_msg, vector_from_msg, vector_to_msg
from msg_adapters.stamps import seconds_between
from msg_adapters.tumbling import poinsot_to_msg, trajectory_to_msg

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray

MOST_SAMPLES: Final = 20_000
"""Longest trajectory in one answer: 2.2 MB of numbers. More would stall the middleware for longer than the answer takes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Event:
    """What ends a trajectory."""

    kind: int
    seconds: float  # s after the state's stamp
    point_W: FloatArray  # (3,), m
    velocity_W: FloatArray  # (3,), m/s
    surface: str


def predict_tumbling(request: Any, response: Any, knowledge: Knowledge) -> None:
    """Answer one request, or raise a `ContactDynamicsError` that says what is wrong with it."""
    _refuse_what_is_not_answered_yet(request)
    subject = subject_of(request, knowledge)
    gravity_W = gravity_of(request, knowledge)
    motion = free_motion(subject.body.mass_properties, subject.state, gravity_W=gravity_W)
    event = None
    if request.sampling == request.AT_TIMES:
        times = _ascending("times", np.array(request.times))
        if len(times) > 0 and times[0] < 0.0:
            raise InvalidFieldError("times[0]", times[0], "a number >= 0 (AT_STAMPS reaches into the past)")
    elif request.sampling == request.AT_STAMPS:
        stamps_ns = request.stamps_ns
        _check_count("stamps_ns", len(stamps_ns))
        times = _ascending(
            "stamps_ns", np.array([seconds_between(subject.state.stamp_ns, stamp) for stamp in stamps_ns])
        )
    elif request.sampling in (request.AT_RATE, request.UNTIL_CONTACT, request.UNTIL_PLANE):
        duration = or_configured("duration", request.duration, knowledge.parameters.horizon)
        rate = or_configured("rate", request.rate, knowledge.parameters.rate)
        if request.sampling == request.UNTIL_CONTACT:
            event = _contact(request, response, subject, knowledge, duration)
        elif request.sampling == request.UNTIL_PLANE:
            event = _plane_reached(request, response, subject, motion, duration)
        times = _at_rate(rate, duration, None if event is None else event.seconds)
    else:
        raise InvalidFieldError("sampling", request.sampling, "AT_TIMES (0) to UNTIL_PLANE (4)")

    response.trajectory = trajectory_to_msg(
        motion.at(times),
        stamp_ns=subject.state.stamp_ns,
        world_frame=subject.world_frame,
        p_FB_F=subject.body.p_FB_F,
    )
    response.method = response.CLOSED_FORM
    response.event = response.NONE if event is None else event.kind
    response.event_time = math.nan
    if event is not None:
        response.event_time = event.seconds
        response.event_point = point_to_msg(event.point_W)
        response.event_velocity = vector_to_msg(event.velocity_W)
        response.event_surface = event.surface
    response.poinsot = poinsot_to_msg(poinsot(motion))
    response.state = subject.state_to_msg(subject.state)


def _refuse_what_is_not_answered_yet(request: Any) -> None:
    wrench, drags = (
        request.applied_wrench,
        ("linear_drag", "quadratic_drag", "linear_angular_drag", "quadratic_angular_drag"),
    )
    numbers = {
        "applied_wrench": np.concatenate([vector_from_msg(wrench.force), vector_from_msg(wrench.torque)]),
        "fit_window": np.array([request.fit_window]),
        **{drag: np.array([getattr(request, drag)]) for drag in drags},
    }
    for field, values in numbers.items():
        if np.any(values):
            raise NotSupportedError(f"{field}: found {values.tolist()}, allowed is zero in this version")
    if request.want_covariance:
        message = "want_covariance: found true, allowed is false in this version"
        raise NotSupportedError(message)


def _contact(
    request: Any, response: Any, subject: Subject, knowledge: Knowledge, duration: float
) -> _Event | None:
    check_has_shape(subject.body)
    landing = next_landing(
        subject.body,
        subject.state,
        replace(knowledge.parameters.world, gravity_W=gravity_of(request, knowledge)),
        horizon=duration,
        distance_tolerance=knowledge.parameters.distance_tolerance,
        velocity_tolerance=knowledge.parameters.velocity_tolerance,
    )
    if landing is None:
        return None
    return _Event(
        kind=response.CONTACT,
        seconds=landing.seconds,
        point_W=landing.contacts.p_WC_W[0],
        velocity_W=landing.velocities_W[0],
        surface=landing.contacts.surfaces[0],
    )


def _plane_reached(
    request: Any, response: Any, subject: Subject, motion: FreeMotion, duration: float
) -> _Event | None:
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
    state = motion.state_at(found.seconds)
    point_W = state.p_WB_W + state.R_WB @ point_B
    return _Event(
        kind=response.PLANE_REACHED,
        seconds=found.seconds,
        point_W=point_W,
        velocity_W=state.velocity_of_point(point_W),
        surface="",
    )


def _at_rate(rate: float, duration: float, end: float | None) -> FloatArray:
    """Return times from 0 at a rate, up to the end of the duration, or to the event that comes before, which is the last."""
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
