# SPDX-License-Identifier: Apache-2.0
"""Converts `tf2_msgs/TFMessage` to states: a body's frame in the world frame, with velocities from its poses.

The body's own frame moves. Frames between it and the world stand still (they come on the static topic), or
are told with the same stamp, before the body's frame or in the same message.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from msg_adapters.pose_track import PoseTrack
from msg_adapters.state_adapter import StateAdapter
from msg_adapters.transforms import TransformTree

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.questions.uncertain_state import KnownState
    from msg_adapters.state_adapter import Reader, SourceSettings
    from msg_adapters.transforms import TFMessage


class _BodyFrame:
    """Reads where one body's frame is."""

    def __init__(self, settings: SourceSettings) -> None:
        self._settings = settings
        self._tree = TransformTree(settings.static)
        self._track = PoseTrack(settings)

    def read(self, msg: TFMessage) -> KnownState | None:
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


def _readers(settings: SourceSettings) -> Sequence[Reader]:
    return (_BodyFrame(settings).read,)


TF: Final = StateAdapter(type_names=("tf2_msgs/msg/TFMessage",), readers=_readers)
