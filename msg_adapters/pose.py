# SPDX-License-Identifier: Apache-2.0
"""Converts poses alone, with covariance or without, to states. The velocities come from the poses."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from msg_adapters.geometry import quaternion_from_msg, vector_from_msg
from msg_adapters.pose_track import PoseTrack
from msg_adapters.published_covariance import covariance_from_msg
from msg_adapters.stamps import stamp_ns_from_msg
from msg_adapters.state_adapter import StateAdapter
from msg_adapters.transforms import FramePose

if TYPE_CHECKING:
    from collections.abc import Sequence

    from geometry_msgs.msg import Pose, PoseStamped, PoseWithCovarianceStamped
    from std_msgs.msg import Header

    from contact_dynamics.questions.uncertain_state import KnownState
    from contact_dynamics.validation import FloatArray
    from msg_adapters.state_adapter import Reader, SourceSettings


def pose_in_world(header: Header, pose: Pose, settings: SourceSettings) -> FramePose:
    """Return a body's pose in the world.

    Raises:
        FrameMismatchError: the header's frame is not the world's, and no static transform leads to it.
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


class _Poses:
    """Reads the poses of one body."""

    def __init__(self, settings: SourceSettings) -> None:
        self._settings = settings
        self._track = PoseTrack(settings)

    def plain(self, msg: PoseStamped) -> KnownState | None:
        return self._add(msg.header, msg.pose, None)

    def with_covariance(self, msg: PoseWithCovarianceStamped) -> KnownState | None:
        return self._add(msg.header, msg.pose.pose, covariance_from_msg(msg.pose.covariance))

    def _add(self, header: Header, pose: Pose, covariance: FloatArray | None) -> KnownState | None:
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


def _plain(settings: SourceSettings) -> Sequence[Reader]:
    return (_Poses(settings).plain,)


def _with_covariance(settings: SourceSettings) -> Sequence[Reader]:
    return (_Poses(settings).with_covariance,)


POSE: Final = StateAdapter(type_names=("geometry_msgs/msg/PoseStamped",), readers=_plain, is_of_one_body=True)
POSE_WITH_COVARIANCE: Final = StateAdapter(
    type_names=("geometry_msgs/msg/PoseWithCovarianceStamped",),
    readers=_with_covariance,
    is_of_one_body=True,
)
