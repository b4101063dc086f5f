"""Trajectories and Poinsot's picture to messages."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.rigid_body import angular_momentum, rotational_energy
from contact_dynamics_interfaces.msg import Poinsot as PoinsotMsg
from contact_dynamics_interfaces.msg import Trajectory as TrajectoryMsg
from msg_adapters.contacts import flat
from msg_adapters.frames import origins_of_published_frame
from msg_adapters.stamps import stamp_to_msg

if TYPE_CHECKING:
    from contact_dynamics.tumbling import FreeMotion, Trajectory
    from contact_dynamics.validation import FloatArray


def trajectory_to_msg(
    trajectory: Trajectory, *, stamp_ns: int, world_frame: str, p_FB_F: FloatArray
) -> TrajectoryMsg:
    """Return a trajectory, whose times count from ``stamp_ns``, with positions of the published frame F."""
    msg = TrajectoryMsg()
    msg.header.stamp = stamp_to_msg(stamp_ns)
    msg.header.frame_id = world_frame
    msg.times = flat(trajectory.seconds)
    msg.positions = flat(origins_of_published_frame(trajectory.p_WB_W, trajectory.q_WB, p_FB_F))
    msg.orientations = flat(trajectory.q_WB)
    msg.linear_velocities = flat(trajectory.v_WB_W)
    msg.angular_velocities = flat(trajectory.w_WB_W)
    return msg


def poinsot_to_msg(motion: FreeMotion) -> PoinsotMsg:
    """Return Poinsot's picture of a motion."""
    body, state = motion.body, motion.state
    L_W = angular_momentum(body, state)
    size = math.sqrt(L_W @ L_W)
    energy = rotational_energy(body, state)
    first, second = (np.array([float(x) for x in axis]) for axis in motion.frame.axes_B[:2])
    return PoinsotMsg(
        regime=int(motion.regime),
        rotational_energy=energy,
        angular_momentum=L_W,
        invariable_plane_distance=2.0 * energy / size if size > 0.0 else math.nan,
        polhode_period=math.nan,
        precession_per_period=math.nan,
        principal_moments=np.array([float(moment) for moment in motion.frame.moments]),
        principal_axes=np.column_stack([first, second, np.cross(first, second)]).ravel(),
        sensitivity=math.nan,
    )
