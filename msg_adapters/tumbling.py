# SPDX-License-Identifier: Apache-2.0
"""Converts requests about tumbling to questions, and answers to responses and back.

A trajectory also becomes a `nav_msgs/Path`, which RViz draws.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path

from contact_dynamics.constants import ns_after
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.motion.covariance import CarriedCovariance, PropagationMethod, orientation_deviations
from contact_dynamics.motion.forces import NO_DRAG, NO_WRENCH, ConstantWrench, Drag, WrenchAxes
from contact_dynamics.motion.integrated import Method
from contact_dynamics.questions.sample_times import (
    AtRate,
    AtStamps,
    AtTimes,
    Event,
    EventKind,
    UntilContact,
    UntilPlane,
)
from contact_dynamics.questions.tumbling import TumblingAnswer, TumblingQuestion
from contact_dynamics.rigid_body.published_frame import centers_of_mass, origins_of_published_frame
from contact_dynamics.tumbling import Trajectory
from contact_dynamics.tumbling.flips import Flips
from contact_dynamics.tumbling.poinsot_construction import Poinsot, RollingCurves, semi_axes
from contact_dynamics.tumbling.polhode import Regime
from contact_dynamics_interfaces.msg import Poinsot as PoinsotMsg
from contact_dynamics_interfaces.msg import Trajectory as TrajectoryMsg
from contact_dynamics_interfaces.srv import PredictTumbling
from msg_adapters import fields
from msg_adapters.asked_fields import asked_gravity, asked_subject, optional
from msg_adapters.contacts import flat, rows
from msg_adapters.field_names import WRENCH_FIELDS, renamed
from msg_adapters.geometry import pose_to_msg, vector_from_msg
from msg_adapters.rejected_fields import TUMBLING, check_unread
from msg_adapters.stamps import stamp_ns_from_msg, stamp_to_msg

if TYPE_CHECKING:
    from contact_dynamics.questions.sample_times import Sampling
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import World


def tumbling_question_from_msg(
    request: PredictTumbling.Request, *, world: World, world_frame: str
) -> TumblingQuestion:
    """Return the question of a `PredictTumbling` request, which can name the bodies of the ``world``.

    An explicit state must be in ``world_frame``. Raise `ContactDynamicsError` if a field is not allowed, or
    names an unknown body.
    """
    gravity_W, wrench, drag = asked_gravity(request), _wrench(request), _drag(request)
    body, state = asked_subject(request, world, world_frame, fit_window=request.fit_window)
    sampling = _sampling(request)
    check_unread(request, TUMBLING)
    return TumblingQuestion(
        body=body,
        state=state,
        sampling=sampling,
        gravity_W=gravity_W,
        wrench=wrench,
        drag=drag,
        include_covariance=request.include_covariance,
        curve_points=request.curve_points,
    )


def _wrench(request: PredictTumbling.Request) -> ConstantWrench:
    """Return the wrench that acts on the body of a request."""
    wrench = request.applied_wrench
    force, torque = wrench.force, wrench.torque
    if not any((force.x, force.y, force.z, torque.x, torque.y, torque.z)):
        return NO_WRENCH
    try:
        return ConstantWrench(
            force=vector_from_msg(force),
            torque=vector_from_msg(torque),
            axes=WrenchAxes.BODY if request.wrench_in_body_axes else WrenchAxes.WORLD,
        )
    except InvalidFieldError as error:
        raise renamed(error, WRENCH_FIELDS) from None


def _drag(request: PredictTumbling.Request) -> Drag:
    """Return the drag that acts on the body of a request."""
    linear, quadratic = request.linear_drag, request.quadratic_drag
    linear_angular, quadratic_angular = request.linear_angular_drag, request.quadratic_angular_drag
    if not any((linear, quadratic, linear_angular, quadratic_angular)):
        return NO_DRAG
    return Drag(
        linear=linear, quadratic=quadratic, linear_angular=linear_angular, quadratic_angular=quadratic_angular
    )


def _sampling(request: PredictTumbling.Request) -> Sampling:
    """Return the times of the samples, or raise `InvalidFieldError`."""
    if request.sampling == request.AT_TIMES:
        if len(request.times) == 0:
            raise InvalidFieldError(
                "times",
                "none",
                "at least one time where sampling is AT_TIMES (0), the default",
                hint="rate and duration need sampling: 2 (AT_RATE), 3 (UNTIL_CONTACT) or 4 (UNTIL_PLANE)",
            )
        return AtTimes(times=request.times)
    if request.sampling == request.AT_STAMPS:
        return AtStamps(stamps_ns=request.stamps_ns)
    rate, duration = optional(request.rate), optional(request.duration)
    if request.sampling == request.AT_RATE:
        return AtRate(rate=rate, duration=duration)
    if request.sampling == request.UNTIL_CONTACT:
        return UntilContact(rate=rate, duration=duration)
    if request.sampling == request.UNTIL_PLANE:
        return UntilPlane(
            rate=rate,
            duration=duration,
            plane_point=vector_from_msg(request.plane_point),
            plane_normal=vector_from_msg(request.plane_normal),
            body_point=vector_from_msg(request.body_point),
        )
    allowed = "AT_TIMES (0), AT_STAMPS (1), AT_RATE (2), UNTIL_CONTACT (3) or UNTIL_PLANE (4)"
    raise InvalidFieldError("sampling", request.sampling, allowed)


def _write_trajectory(msg: object, field: str, trajectory: Trajectory, frame: fields.Frame) -> None:
    into: TrajectoryMsg = getattr(msg, field)
    stamp_to_msg(frame.stamp_ns, into=into.header.stamp)
    into.header.frame_id = frame.world_frame
    into.times = flat(trajectory.seconds)
    into.positions = flat(origins_of_published_frame(trajectory.p_WB_W, trajectory.q_WB, frame.p_FB_F))
    into.orientations = flat(trajectory.q_WB)
    into.linear_velocities = flat(trajectory.v_WB_W)
    into.angular_velocities = flat(trajectory.w_WB_W)


def _read_trajectory(msg: object, field: str, frame: fields.Frame) -> Trajectory:
    found: TrajectoryMsg = getattr(msg, field)
    orientations = rows(found.orientations, 4)
    return Trajectory(
        seconds=np.array(found.times),
        p_WB_W=centers_of_mass(rows(found.positions), orientations, frame.p_FB_F),
        q_WB=orientations,
        v_WB_W=rows(found.linear_velocities),
        w_WB_W=rows(found.angular_velocities),
    )


def _write_covariances(msg: object, field: str, carried: CarriedCovariance | None, _: fields.Frame) -> None:
    if carried is not None:
        trajectory = getattr(msg, field)
        trajectory.covariances = flat(carried.covariances)
        trajectory.covariances_trusted = carried.trusted.tolist()


def _read_covariances(msg: object, field: str, _: fields.Frame) -> CarriedCovariance | None:
    trajectory = getattr(msg, field)
    if len(trajectory.covariances) == 0:
        return None
    covariances = rows(trajectory.covariances, 144).reshape(-1, 12, 12)
    return CarriedCovariance(
        seconds=np.array(trajectory.times),
        covariances=covariances,
        orientation_deviations=orientation_deviations(covariances),
        trusted=np.array(trajectory.covariances_trusted),
        method=PropagationMethod.LINEARISED,
    )


COVARIANCES: Final = fields.Kind(_write_covariances, _read_covariances)
"""The covariances of a trajectory's samples, or None without them."""

TRAJECTORY: Final = fields.Kind(_write_trajectory, _read_trajectory)
"""A trajectory, whose times are relative to the frame's stamp."""


def _write_torque(msg: PoinsotMsg) -> None:
    """Write that a torque acts, so that the motion has no Poinsot construction."""
    msg.regime = msg.UNKNOWN
    for field in (
        "rotational_energy",
        "invariable_plane_distance",
        "polhode_period",
        "precession_per_period",
        "sensitivity",
    ):
        setattr(msg, field, math.nan)
    msg.angular_momentum = msg.principal_moments = np.full(3, math.nan)
    msg.principal_axes = np.full(9, math.nan)


def _poinsot(rotational_energy: float, principal_moments: FloatArray, **others: object) -> Poinsot:
    """Return the Poinsot construction, whose semi-axes are not in the message."""
    return Poinsot(
        rotational_energy=rotational_energy,
        principal_moments=principal_moments,
        ellipsoid_semi_axes=semi_axes(rotational_energy, principal_moments),
        **others,  # type: ignore[arg-type]  # the table has their kinds
    )


def _is_torque(msg: PoinsotMsg) -> bool:
    return bool(msg.regime == msg.UNKNOWN)


POINSOT: Final = fields.Table(
    _poinsot,
    PoinsotMsg,
    fields.Row("regime", "regime", fields.one_of(Regime)),
    fields.Row("rotational_energy", "rotational_energy"),
    fields.Row("L_W", "angular_momentum", fields.FIXED),
    fields.Row("invariable_plane_distance", "invariable_plane_distance"),
    fields.Row("polhode_period", "polhode_period"),
    fields.Row("precession_per_period", "precession_per_period"),
    fields.Row("principal_moments", "principal_moments", fields.FIXED),
    fields.Row("principal_axes_B", "principal_axes", fields.Converted(np.ravel, rows)),
    fields.Row("sensitivity", "sensitivity"),
).nested(_is_torque, _write_torque)
"""The Poinsot construction of a motion, or None if a torque acts."""

FLIPS: Final = fields.Table(
    Flips,
    PoinsotMsg,
    fields.Row("seconds", "flip_times", fields.NUMBERS),
    fields.Row("deviations", "flip_time_deviations", fields.NUMBERS),
).nested(_is_torque)
"""The next flips of the intermediate axis, possibly none, or None if a torque acts."""

CURVES: Final = fields.Table(
    RollingCurves,
    PoinsotMsg,
    fields.Row("seconds", "curve_times", fields.NUMBERS),
    fields.Row("polhode_B", "polhode", fields.rows_of(3)),
    fields.Row("herpolhode_W", "herpolhode", fields.rows_of(3)),
).nested(lambda msg: len(msg.polhode) == 0)
"""Polhode and herpolhode, or None without them."""


def _write_no_event(msg: PredictTumbling.Response) -> None:
    msg.event, msg.event_time = msg.NONE, math.nan


_EVENT: Final = fields.Table(
    Event,
    PredictTumbling.Response,
    fields.Row("kind", "event", fields.one_of(EventKind)),
    fields.Row("seconds", "event_time"),
    fields.Row("point_W", "event_point", fields.VECTOR),
    fields.Row("velocity_W", "event_velocity", fields.VECTOR),
    fields.Row("surface", "event_surface"),
)

_ANSWER: Final = fields.AnswerTable(
    TumblingAnswer,
    PredictTumbling.Response,
    fields.Row("state", "state", fields.STATE),
    fields.Row("fit", "", fields.FIT),
    fields.Row("trajectory", "trajectory", TRAJECTORY),
    fields.Row("covariance", "trajectory", COVARIANCES),
    fields.Row("method", "method", fields.one_of(Method)),
    fields.Row("event", "", _EVENT.nested(lambda msg: msg.event == msg.NONE, _write_no_event)),
    fields.Row("poinsot", "poinsot", POINSOT),
    fields.Row("flips", "poinsot", FLIPS),
    fields.Row("curves", "poinsot", CURVES),
    fields.Row("warnings", "message", fields.WARNINGS),
)
tumbling_answer_to_msg: Final = _ANSWER.response_of
tumbling_answer_from_msg: Final = _ANSWER.answer_of


MAX_POSES: Final = 200
"""Largest number of poses, which is enough to draw a line. Each takes some 0.1 ms as a nested message."""


def path_from_trajectory(trajectory: TrajectoryMsg) -> Path:
    """Return at most `MAX_POSES` poses of a trajectory's message, with the first and the last."""
    count = len(trajectory.times)
    chosen = np.unique(np.linspace(0, count - 1, min(count, MAX_POSES)).round().astype(int)).tolist()
    positions = np.array(trajectory.positions).reshape(-1, 3)
    orientations = np.array(trajectory.orientations).reshape(-1, 4)
    begin_ns = stamp_ns_from_msg(trajectory.header.stamp)
    path = Path(header=trajectory.header)
    for i in chosen:
        pose = PoseStamped(pose=pose_to_msg(positions[i], orientations[i]))
        pose.header.frame_id = trajectory.header.frame_id
        pose.header.stamp = stamp_to_msg(ns_after(begin_ns, trajectory.times[i]))
        path.poses.append(pose)
    return path
