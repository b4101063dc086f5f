"""Trajectories and Poinsot's picture to messages."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics_interfaces.msg import Poinsot as PoinsotMsg
from contact_dynamics_interfaces.msg import Trajectory as TrajectoryMsg
from msg_adapters.contacts import flat
from msg_adapters.frames import origins_of_published_frame
from msg_adapters.stamps import stamp_to_msg

if TYPE_CHECKING:
    from contact_dynamics.motion.covariance import CarriedCovariance
    from contact_dynamics.motion.free_fit import FitResult
    from contact_dynamics.tumbling import Trajectory
    from contact_dynamics.tumbling.flips import Flips
    from contact_dynamics.tumbling.poinsot_construction import Poinsot, RollingCurves
    from contact_dynamics.validation import FloatArray
    from contact_dynamics_interfaces.srv import PredictImpact, PredictTumbling


def trajectory_to_msg(
    trajectory: Trajectory,
    *,
    stamp_ns: int,
    world_frame: str,
    p_FB_F: FloatArray,
    into: TrajectoryMsg | None = None,
) -> TrajectoryMsg:
    """Return a trajectory, whose times count from ``stamp_ns``, with positions of the published frame F.

    It is a new message, or the empty one to fill.
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


def write_covariances(msg: TrajectoryMsg, carried: CarriedCovariance) -> None:
    """Write the covariances of its samples into a trajectory."""
    msg.covariances = flat(carried.covariances)
    msg.covariances_trusted = carried.trusted.tolist()


def write_fit(response: PredictImpact.Response | PredictTumbling.Response, fit: FitResult | None) -> None:
    """Write into a response which fit its state came from."""
    if fit is not None:
        response.fit_count = fit.count
        response.fit_position_residual = fit.position_residual
        response.fit_orientation_residual = fit.orientation_residual


def poinsot_to_msg(
    picture: Poinsot, flips: Flips, curves: RollingCurves | None, *, into: PoinsotMsg | None = None
) -> PoinsotMsg:
    """Return Poinsot's picture of a motion, with the next flips of its middle axis, and curves if any.

    It is a new message, or the empty one to fill.
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


def torque_acts() -> PoinsotMsg:
    """Return what is left of Poinsot's picture under a torque: nothing."""
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
