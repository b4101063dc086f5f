# SPDX-License-Identifier: Apache-2.0
"""Converts trajectories to `nav_msgs/Path`, which RViz draws."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path

from contact_dynamics.constants import ns_after
from msg_adapters.geometry import pose_to_msg
from msg_adapters.stamps import stamp_ns_from_msg, stamp_to_msg

if TYPE_CHECKING:
    from contact_dynamics_interfaces.msg import Trajectory as TrajectoryMsg

MAX_POSES: Final = 200
"""Largest number of poses. A pose costs some 0.1 ms as a nested message, and a drawn line needs no more."""


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
