# SPDX-License-Identifier: Apache-2.0
"""A source of states of one's own: `geometry_msgs/PoseArray`, as simulators publish all their bodies.

A body's place in the array is the number at the end of its frame, as in `box_3`. In the configuration:

    body.box.frame: box_3
    body.box.source: pose_array
    body.box.source_topics: [/boxes]
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from contact_dynamics.errors import InvalidFieldError
from msg_adapters.pose import pose_in_world
from msg_adapters.pose_track import PoseTrack
from msg_adapters.stamps import stamp_ns_from_msg
from msg_adapters.state_adapter import Reader, SourceSettings, StateAdapter

if TYPE_CHECKING:
    from geometry_msgs.msg import PoseArray

    from contact_dynamics.questions.uncertain_state import KnownState


def readers(settings: SourceSettings) -> tuple[Reader]:
    """Return what reads the array for one body; it is called once for each body."""
    place = int(settings.body_frame.rpartition("_")[2])
    track = PoseTrack(settings)  # finds the velocity, as an array of poses has none

    def read(msg: PoseArray) -> KnownState | None:
        if place >= len(msg.poses):  # the server counts and tells what an adapter refuses
            raise InvalidFieldError("poses", f"{len(msg.poses)} poses", f"more than {place}")
        pose = pose_in_world(msg.header, msg.poses[place], settings)
        return track.add(pose.p, pose.q, stamp_ns=stamp_ns_from_msg(msg.header.stamp))

    return (read,)


POSE_ARRAY = StateAdapter(type_names=("geometry_msgs/msg/PoseArray",), readers=readers)
