# SPDX-License-Identifier: Apache-2.0
"""Converts poses alone to states, with velocities that are estimated from the poses.

The messages contain poses of one body, with covariance or without; the frames of `tf2_msgs/TFMessage`; or the
poses of all bodies in a motion capture system, `mocap4r2_msgs/RigidBodies`. The packages of the last two are
required only for these sources.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Protocol

import numpy as np

from msg_adapters.geometry import quaternion_from_msg, vector_from_msg
from msg_adapters.pose_track import PoseTrack
from msg_adapters.published_covariance import covariance_from_msg
from msg_adapters.stamps import stamp_ns_from_msg
from msg_adapters.state_adapter import StateAdapter
from msg_adapters.transforms import FramePose, TransformTree

if TYPE_CHECKING:
    from collections.abc import Sequence

    from geometry_msgs.msg import Pose, PoseStamped, PoseWithCovarianceStamped
    from std_msgs.msg import Header

    from contact_dynamics.questions.uncertain_state import KnownState
    from contact_dynamics.validation import FloatArray
    from msg_adapters.state_adapter import SourceSettings
    from msg_adapters.transforms import TFMessage


def pose_in_world(header: Header, pose: Pose, settings: SourceSettings) -> FramePose:
    """Return a body's pose in the world.

    Raise `FrameMismatchError` if the header's frame is not the world's, and no static transform leads to it.
    """
    found = FramePose(p=vector_from_msg(pose.position), q=quaternion_from_msg(pose.orientation))
    if header.frame_id == settings.world_frame:
        return found
    outer = settings.static.pose(
        header.frame_id,
        in_frame=settings.world_frame,
        stamp_ns=stamp_ns_from_msg(header.stamp),
        field="header.frame_id",
    )
    return outer.of(found)


class RigidBody(Protocol):
    """The fields of `mocap4r2_msgs/RigidBody` that are read."""

    rigid_body_name: str
    pose: Pose


class RigidBodies(Protocol):
    """The fields of `mocap4r2_msgs/RigidBodies` that are read."""

    header: Header
    rigidbodies: Sequence[RigidBody]


class _Poses:
    """Reads the poses of one body."""

    def __init__(self, settings: SourceSettings) -> None:
        self._settings = settings
        self._track = PoseTrack(settings)
        self._tree = TransformTree(settings.static)

    def plain(self, msg: PoseStamped) -> KnownState | None:
        return self._add(msg.header, msg.pose)

    def with_covariance(self, msg: PoseWithCovarianceStamped) -> KnownState | None:
        return self._add(msg.header, msg.pose.pose, covariance_from_msg(msg.pose.covariance))

    def of_capture(self, msg: RigidBodies) -> KnownState | None:
        """Read the body with the frame's name."""
        for body in msg.rigidbodies:
            if body.rigid_body_name == self._settings.body_frame:
                return self._add(msg.header, body.pose)
        return None

    def of_transforms(self, msg: TFMessage) -> KnownState | None:
        """Read the pose of the body's own frame, which moves.

        The transforms between it and the world are static (on the static topic), or have the same stamp and
        arrive before the body's frame or in the same message.
        """
        frame = self._settings.body_frame
        self._tree.add(msg, is_static=False)
        if all(each.child_frame_id != frame for each in msg.transforms):
            return None
        stamp_ns = self._tree.stamp_ns(frame)
        if stamp_ns is None:
            return None
        pose = self._tree.pose(
            frame, in_frame=self._settings.world_frame, stamp_ns=stamp_ns, field="child_frame_id"
        )
        return self._track.add(pose.p, pose.q, stamp_ns=stamp_ns)

    def _add(self, header: Header, pose: Pose, covariance: FloatArray | None = None) -> KnownState | None:
        found = pose_in_world(header, pose, self._settings)
        if covariance is not None and header.frame_id != self._settings.world_frame:
            covariance = _turned(covariance, found, pose)
        stamp_ns = stamp_ns_from_msg(header.stamp)
        return self._track.add(found.p, found.q, stamp_ns=stamp_ns, covariance=covariance)


def _turned(covariance: FloatArray, found: FramePose, pose: Pose) -> FloatArray:
    """Return a covariance, (6, 6), in world axes instead of those of the header's frame."""
    inner = FramePose(p=np.zeros(3), q=quaternion_from_msg(pose.orientation))
    turn = np.kron(np.eye(2), found.of(inner.inverse()).R)
    turned: FloatArray = turn @ covariance @ turn.T
    return turned


POSE: Final = StateAdapter(
    type_names=("geometry_msgs/msg/PoseStamped",),
    readers=lambda settings: (_Poses(settings).plain,),
    is_of_one_body=True,
)
POSE_WITH_COVARIANCE: Final = StateAdapter(
    type_names=("geometry_msgs/msg/PoseWithCovarianceStamped",),
    readers=lambda settings: (_Poses(settings).with_covariance,),
    is_of_one_body=True,
)
TF: Final = StateAdapter(
    type_names=("tf2_msgs/msg/TFMessage",), readers=lambda settings: (_Poses(settings).of_transforms,)
)
RIGID_BODIES: Final = StateAdapter(
    type_names=("mocap4r2_msgs/msg/RigidBodies",), readers=lambda settings: (_Poses(settings).of_capture,)
)
