# SPDX-License-Identifier: Apache-2.0
"""Converts `mocap4r2_msgs/RigidBodies` to states of all bodies that a motion capture sees.

A body is found by its frame, which is the `rigid_body_name` there. The velocities come from its poses. The
package `mocap4r2_msgs` is needed only where this source is used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Protocol

from msg_adapters.pose import pose_in_world
from msg_adapters.pose_track import PoseTrack
from msg_adapters.stamps import stamp_ns_from_msg
from msg_adapters.state_adapter import StateAdapter

if TYPE_CHECKING:
    from collections.abc import Sequence

    from geometry_msgs.msg import Pose
    from std_msgs.msg import Header

    from contact_dynamics.questions.uncertain_state import KnownState
    from msg_adapters.state_adapter import Reader, SourceSettings


class RigidBody(Protocol):
    """What is read of a `mocap4r2_msgs/RigidBody`."""

    rigid_body_name: str
    pose: Pose


class RigidBodies(Protocol):
    """What is read of a `mocap4r2_msgs/RigidBodies`."""

    header: Header
    rigidbodies: Sequence[RigidBody]


class _RigidBody:
    """Reads the poses of one body."""

    def __init__(self, settings: SourceSettings) -> None:
        self._settings = settings
        self._track = PoseTrack(settings)

    def read(self, msg: RigidBodies) -> KnownState | None:
        for body in msg.rigidbodies:
            if body.rigid_body_name == self._settings.body_frame:
                pose = pose_in_world(msg.header, body.pose, self._settings)
                return self._track.add(pose.p, pose.q, stamp_ns=stamp_ns_from_msg(msg.header.stamp))
        return None


def _readers(settings: SourceSettings) -> Sequence[Reader]:
    return (_RigidBody(settings).read,)


RIGID_BODIES: Final = StateAdapter(type_names=("mocap4r2_msgs/msg/RigidBodies",), readers=_readers)
