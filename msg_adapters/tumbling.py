"""Converts questions and answers about tumbling to the service's request and response, and back."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

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
from contact_dynamics.questions.subject import FitQuality
from contact_dynamics.questions.tumbling import TumblingAnswer, TumblingQuestion
from contact_dynamics.rigid_body.published_frame import centers_of_mass, origins_of_published_frame
from contact_dynamics.tumbling import Trajectory
from contact_dynamics.tumbling.flips import Flips
from contact_dynamics.tumbling.poinsot_construction import Poinsot, RollingCurves, semi_axes
from contact_dynamics.tumbling.regime import Regime
from contact_dynamics_interfaces.msg import Poinsot as PoinsotMsg
from contact_dynamics_interfaces.msg import Trajectory as TrajectoryMsg
from contact_dynamics_interfaces.srv import PredictTumbling
from msg_adapters.asked_fields import asked_gravity, optional, write_given, write_gravity
from msg_adapters.asked_subject import asked_subject, write_fitted_subject
from msg_adapters.body_state import body_state_from_msg, body_state_to_msg, center_of_mass
from msg_adapters.contacts import flat, rows
from msg_adapters.field_names import WRENCH_FIELDS, renamed
from msg_adapters.geometry import point_to_msg, vector_from_msg, vector_to_msg, wrench_to_msg
from msg_adapters.stamps import stamp_to_msg
from msg_adapters.status import with_warnings, without_warnings
from msg_adapters.unread_fields import TUMBLING, check_unread

if TYPE_CHECKING:
    from contact_dynamics.questions.sample_times import Sampling
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import World
    from contact_dynamics_interfaces.srv import PredictImpact, PredictToss

    FittedResponse: TypeAlias = PredictImpact.Response | PredictToss.Response | PredictTumbling.Response


def tumbling_question_from_msg(
    request: PredictTumbling.Request, *, world: World, world_frame: str
) -> TumblingQuestion:
    """Return the question of a `PredictTumbling` request.

    Args:
        request: The request.
        world: The bodies that it can name.
        world_frame: The frame that an explicit state must be in.

    Raises:
        ContactDynamicsError: a field holds what is not allowed, or names a body that is not known.
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
        linear=linear,
        quadratic=quadratic,
        linear_angular=linear_angular,
        quadratic_angular=quadratic_angular,
    )


def _sampling(request: PredictTumbling.Request) -> Sampling:
    """Return the times that a request asks about, or raise `InvalidFieldError`."""
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


def tumbling_question_to_msg(
    question: TumblingQuestion, *, world: World, world_frame: str
) -> PredictTumbling.Request:
    """Return the request of a question about tumbling.

    Args:
        question: The question.
        world: The bodies that the server knows by name.
        world_frame: The frame of its world.

    Raises:
        UnknownBodyError: the question names a body that the world does not have.
        NotSupportedError: the question has no request.
    """
    msg = PredictTumbling.Request()
    write_fitted_subject(msg, question.body, question.state, world, world_frame)
    _write_sampling(msg, question.sampling)
    write_gravity(msg, question.gravity_W)
    msg.applied_wrench = wrench_to_msg(question.wrench.force, question.wrench.torque)
    msg.wrench_in_body_axes = question.wrench.axes is WrenchAxes.BODY
    msg.linear_drag, msg.quadratic_drag = question.drag.linear, question.drag.quadratic
    msg.linear_angular_drag = question.drag.linear_angular
    msg.quadratic_angular_drag = question.drag.quadratic_angular
    msg.include_covariance = question.include_covariance
    msg.curve_points = question.curve_points
    return msg


def _write_sampling(msg: PredictTumbling.Request, sampling: Sampling) -> None:
    if isinstance(sampling, AtTimes):
        msg.sampling, msg.times = msg.AT_TIMES, sampling.times.tolist()
        return
    if isinstance(sampling, AtStamps):
        msg.sampling, msg.stamps_ns = msg.AT_STAMPS, list(sampling.stamps_ns)
        return
    msg.sampling = msg.AT_RATE
    if isinstance(sampling, UntilContact):
        msg.sampling = msg.UNTIL_CONTACT
    elif isinstance(sampling, UntilPlane):
        msg.sampling = msg.UNTIL_PLANE
        msg.plane_point = point_to_msg(sampling.plane_point)
        msg.plane_normal = vector_to_msg(sampling.plane_normal)
        msg.body_point = point_to_msg(sampling.body_point)
    write_given(msg, rate=sampling.rate, duration=sampling.duration)


def tumbling_answer_to_msg(
    answer: TumblingAnswer, *, world_frame: str, into: PredictTumbling.Response | None = None
) -> PredictTumbling.Response:
    """Return an answer as a response, which is new unless an empty one to fill is given."""
    msg = PredictTumbling.Response() if into is None else into
    if answer.poinsot is None or answer.flips is None:
        msg.poinsot = torque_acts()
    else:
        poinsot_to_msg(answer.poinsot, answer.flips, answer.curves, into=msg.poinsot)
    trajectory_to_msg(
        answer.trajectory,
        stamp_ns=answer.state.stamp_ns,
        world_frame=world_frame,
        p_FB_F=answer.p_FB_F,
        into=msg.trajectory,
    )
    if answer.covariance is not None:
        write_covariances(msg.trajectory, answer.covariance)
    write_fit(msg, answer.fit)
    msg.method = int(answer.method)
    msg.message = with_warnings("", answer.warnings)
    event = answer.event
    msg.event = msg.NONE if event is None else int(event.kind)
    msg.event_time = math.nan
    if event is not None:
        msg.event_time = event.seconds
        msg.event_point = point_to_msg(event.point_W)
        msg.event_velocity = vector_to_msg(event.velocity_W)
        msg.event_surface = event.surface
    body_state_to_msg(
        answer.state,
        body_name=answer.body_name,
        world_frame=world_frame,
        p_FB_F=answer.p_FB_F,
        into=msg.state,
    )
    return msg


def tumbling_answer_from_msg(msg: PredictTumbling.Response, *, world: World) -> TumblingAnswer:
    """Return the answer that a response contains. ``world`` knows the bodies' centres of mass.

    Raises:
        InvalidFieldError: a number is not finite, or a quaternion is not unit.
    """
    p_FB_F = center_of_mass(msg.state.body_name, world)
    return TumblingAnswer(
        body_name=msg.state.body_name,
        p_FB_F=p_FB_F,
        state=body_state_from_msg(msg.state, world_frame=msg.state.header.frame_id, p_FB_F=p_FB_F),
        fit=read_fit(msg),
        trajectory=trajectory_from_msg(msg.trajectory, p_FB_F=p_FB_F),
        covariance=read_covariances(msg.trajectory),
        method=Method(msg.method),
        event=None if msg.event == msg.NONE else _event_from_msg(msg),
        poinsot=poinsot_from_msg(msg.poinsot),
        flips=flips_from_msg(msg.poinsot),
        curves=curves_from_msg(msg.poinsot),
        warnings=without_warnings(msg.message)[1],
    )


def _event_from_msg(msg: PredictTumbling.Response) -> Event:
    return Event(
        kind=EventKind(msg.event),
        seconds=msg.event_time,
        point_W=vector_from_msg(msg.event_point),
        velocity_W=vector_from_msg(msg.event_velocity),
        surface=msg.event_surface,
    )


def trajectory_to_msg(
    trajectory: Trajectory,
    *,
    stamp_ns: int,
    world_frame: str,
    p_FB_F: FloatArray,
    into: TrajectoryMsg | None = None,
) -> TrajectoryMsg:
    """Return a trajectory as a message. Times count from ``stamp_ns``, positions are of the frame F.

    The message is new unless an empty one to fill is given.
    """
    msg = TrajectoryMsg() if into is None else into
    msg.header.stamp = stamp_to_msg(stamp_ns)
    msg.header.frame_id = world_frame
    msg.times = flat(trajectory.seconds)
    msg.positions = flat(origins_of_published_frame(trajectory.p_WB_W, trajectory.q_WB, p_FB_F))
    msg.orientations = flat(trajectory.q_WB)
    msg.linear_velocities = flat(trajectory.v_WB_W)
    msg.angular_velocities = flat(trajectory.w_WB_W)
    return msg


def trajectory_from_msg(msg: TrajectoryMsg, *, p_FB_F: FloatArray) -> Trajectory:
    """Return a trajectory of the centre of mass, which is at ``p_FB_F``, (3,), m, in the published frame."""
    orientations = rows(msg.orientations, 4)
    return Trajectory(
        seconds=np.array(msg.times),
        p_WB_W=centers_of_mass(rows(msg.positions), orientations, p_FB_F),
        q_WB=orientations,
        v_WB_W=rows(msg.linear_velocities),
        w_WB_W=rows(msg.angular_velocities),
    )


def write_covariances(msg: TrajectoryMsg, carried: CarriedCovariance) -> None:
    """Write the covariances of its samples into a trajectory."""
    msg.covariances = flat(carried.covariances)
    msg.covariances_trusted = carried.trusted.tolist()


def read_covariances(msg: TrajectoryMsg) -> CarriedCovariance | None:
    """Return the covariances of a trajectory's samples, or None if it has none."""
    if len(msg.covariances) == 0:
        return None
    covariances = rows(msg.covariances, 144).reshape(-1, 12, 12)
    return CarriedCovariance(
        seconds=np.array(msg.times),
        covariances=covariances,
        orientation_deviations=orientation_deviations(covariances),
        trusted=np.array(msg.covariances_trusted),
        method=PropagationMethod.LINEARISED,
    )


def write_fit(response: FittedResponse, fit: FitQuality | None) -> None:
    """Write into a response how good the fit was that its state came from, with NaN for no fit."""
    if fit is None:
        response.fit_position_residual = response.fit_orientation_residual = math.nan
        return
    response.fit_count = fit.count
    response.fit_position_residual = fit.position_residual
    response.fit_orientation_residual = fit.orientation_residual


def read_fit(response: FittedResponse) -> FitQuality | None:
    """Return how good the fit was that a response's state came from, or None without a fit."""
    if response.fit_count == 0:
        return None
    return FitQuality(
        count=response.fit_count,
        position_residual=response.fit_position_residual,
        orientation_residual=response.fit_orientation_residual,
    )


def poinsot_to_msg(
    picture: Poinsot, flips: Flips, curves: RollingCurves | None, *, into: PoinsotMsg | None = None
) -> PoinsotMsg:
    """Return Poinsot's picture of a motion as a message, with the next flips of its middle axis and curves.

    The message is new unless an empty one to fill is given.
    """
    msg = PoinsotMsg() if into is None else into
    msg.regime = int(picture.regime)
    msg.rotational_energy = picture.rotational_energy
    msg.angular_momentum = picture.L_W
    msg.invariable_plane_distance = picture.invariable_plane_distance
    msg.polhode_period = picture.polhode_period
    msg.precession_per_period = picture.precession_per_period
    msg.principal_moments = picture.principal_moments
    msg.principal_axes = picture.principal_axes_B.ravel()
    msg.sensitivity = picture.sensitivity
    msg.flip_times = flat(flips.seconds)
    msg.flip_time_deviations = flat(flips.deviations)
    if curves is not None:
        msg.curve_times = flat(curves.seconds)
        msg.polhode = flat(curves.polhode_B)
        msg.herpolhode = flat(curves.herpolhode_W)
    return msg


def poinsot_from_msg(msg: PoinsotMsg) -> Poinsot | None:
    """Return Poinsot's picture of a motion, or None if a torque acts."""
    if msg.regime == msg.UNKNOWN:
        return None
    moments = np.array(msg.principal_moments)
    return Poinsot(
        regime=Regime(msg.regime),
        rotational_energy=msg.rotational_energy,
        L_W=np.array(msg.angular_momentum),
        invariable_plane_distance=msg.invariable_plane_distance,
        polhode_period=msg.polhode_period,
        precession_per_period=msg.precession_per_period,
        principal_moments=moments,
        principal_axes_B=rows(msg.principal_axes),
        ellipsoid_semi_axes=semi_axes(msg.rotational_energy, moments),
        sensitivity=msg.sensitivity,
    )


def flips_from_msg(msg: PoinsotMsg) -> Flips | None:
    """Return the next flips of the middle axis, of which there may be none, or None if a torque acts."""
    if msg.regime == msg.UNKNOWN:
        return None
    return Flips(seconds=np.array(msg.flip_times), deviations=np.array(msg.flip_time_deviations))


def curves_from_msg(msg: PoinsotMsg) -> RollingCurves | None:
    """Return polhode and herpolhode, or None if the response does not have them."""
    if len(msg.polhode) == 0:
        return None
    return RollingCurves(
        seconds=np.array(msg.curve_times),
        polhode_B=rows(msg.polhode),
        herpolhode_W=rows(msg.herpolhode),
    )


def torque_acts() -> PoinsotMsg:
    """Return the empty message that stands for Poinsot's picture if a torque acts."""
    nan = math.nan
    return PoinsotMsg(
        regime=PoinsotMsg.UNKNOWN,
        rotational_energy=nan,
        angular_momentum=np.full(3, nan),
        invariable_plane_distance=nan,
        polhode_period=nan,
        precession_per_period=nan,
        principal_moments=np.full(3, nan),
        principal_axes=np.full(9, nan),
        sensitivity=nan,
    )
