"""Answers `~/predict_tumbling`."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.errors import TooLargeError
from contact_dynamics.motion.covariance import CarriedCovariance, covariance_along
from contact_dynamics.motion.forces import NO_WRENCH, ConstantWrench, Drag, WrenchAxes
from contact_dynamics.motion.integrated import ForcedMotion, motion_of
from contact_dynamics.motion.integrated_fit import fit_motion
from contact_dynamics.nodes.sampling import MOST_INTEGRATED_STEPS, check_turns, times_of
from contact_dynamics.nodes.subject import Knowledge, Subject, covariance_of, gravity_of, subject_of
from contact_dynamics.tumbling import free_motion
from contact_dynamics.tumbling.flips import next_flips
from contact_dynamics.tumbling.poinsot_construction import poinsot, rolling_curves
from contact_dynamics.validation import check_array
from msg_adapters.geometry import point_to_msg, vector_from_msg, vector_to_msg
from msg_adapters.tumbling import (
    poinsot_to_msg,
    torque_acts,
    trajectory_to_msg,
    write_covariances,
    write_fit,
)

if TYPE_CHECKING:
    from contact_dynamics.tumbling import FreeMotion
    from contact_dynamics.validation import FloatArray
    from contact_dynamics_interfaces.msg import Poinsot as PoinsotMsg

FLIPS: Final = 3
"""How many of the next flips are told."""

MOST_COVARIANCES: Final = 2000
"""Most samples with covariances in one answer, for the same reason as `sampling.MOST_SAMPLES`."""

MOST_CARRIED_TURNS: Final = 30.0
"""Longest motion under torque or drag with covariances, in turns: 1 or 2 s of computing."""

MOST_CURVE_POINTS: Final = 10_000
"""Of polhode and herpolhode, for the same reason."""


def predict_tumbling(request: Any, response: Any, knowledge: Knowledge) -> None:
    """Answer one request, or raise a `ContactDynamicsError` that says what is wrong with it."""
    forces: dict[str, Any] = {
        "gravity_W": gravity_of(request, knowledge),
        "wrench": _wrench_of(request),
        "drag": _drag_of(request),
        "most_steps": MOST_INTEGRATED_STEPS,
    }
    subject = subject_of(request, knowledge, fit=partial(fit_motion, **forces))
    motion, method = motion_of(subject.body.mass_properties, subject.state, **forces)
    times, event = times_of(request, response, subject, motion, knowledge)
    response.poinsot = _poinsot(request, subject, motion, response.poinsot)
    trajectory_to_msg(
        motion.at(times),
        stamp_ns=subject.state.stamp_ns,
        world_frame=subject.world_frame,
        p_FB_F=subject.body.p_FB_F,
        into=response.trajectory,
    )
    if request.want_covariance:
        write_covariances(response.trajectory, _covariances(subject, motion, times))
    write_fit(response, subject.fit)
    response.method = int(method)
    response.event = response.NONE if event is None else event.kind
    response.event_time = math.nan
    if event is not None:
        response.event_time = event.seconds
        response.event_point = point_to_msg(event.point_W)
        response.event_velocity = vector_to_msg(event.velocity_W)
        response.event_surface = event.surface
    subject.state_to_msg(subject.state, into=response.state)


def _poinsot(
    request: Any, subject: Subject, motion: FreeMotion | ForcedMotion, msg: PoinsotMsg
) -> PoinsotMsg:
    if isinstance(motion, ForcedMotion):
        if not motion.rotates_freely:
            return torque_acts()
        motion = free_motion(motion.body, motion.state)
    count = request.curve_points
    if count > MOST_CURVE_POINTS:
        raise TooLargeError("curve_points", count, f"at most {MOST_CURVE_POINTS}")
    return poinsot_to_msg(
        poinsot(motion),
        next_flips(motion, FLIPS, covariance=subject.covariance),
        rolling_curves(motion, count) if count else None,
        into=msg,
    )


def _covariances(subject: Subject, motion: FreeMotion | ForcedMotion, times: FloatArray) -> CarriedCovariance:
    if len(times) > MOST_COVARIANCES:
        raise TooLargeError("times", f"{len(times)} samples with covariances", f"at most {MOST_COVARIANCES}")
    if isinstance(motion, ForcedMotion):
        check_turns("times", motion, times, MOST_CARRIED_TURNS, "with covariances under torque or drag")
    return covariance_along(motion, covariance_of(subject), times)


def _wrench_of(request: Any) -> ConstantWrench:
    wrench = request.applied_wrench
    force, torque = wrench.force, wrench.torque
    if not any((force.x, force.y, force.z, torque.x, torque.y, torque.z)):
        return NO_WRENCH
    return ConstantWrench(
        force=check_array("applied_wrench.force", vector_from_msg(force), (3,)),
        torque=check_array("applied_wrench.torque", vector_from_msg(torque), (3,)),
        axes=WrenchAxes.BODY if request.wrench_in_body_axes else WrenchAxes.WORLD,
    )


def _drag_of(request: Any) -> Drag:
    return Drag(
        linear=request.linear_drag,
        quadratic=request.quadratic_drag,
        linear_angular=request.linear_angular_drag,
        quadratic_angular=request.quadratic_angular_drag,
    )
