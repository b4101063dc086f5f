"""Converts `nav_msgs/Odometry` to a body's state and back.

The pose is that of the child frame in `header.frame_id`. The twist is in the child frame's axes and at its
origin (REP 105 and the message's own comment).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from nav_msgs.msg import Odometry

from contact_dynamics.rigid_body.published_frame import (
    origin_of_published_frame,
    state_of_center_of_mass,
    velocity_of_published_frame,
)
from contact_dynamics.rotations.one import rotation_matrix
from contact_dynamics.validation import check_unit
from msg_adapters.frames import check_frame
from msg_adapters.geometry import pose_to_msg, quaternion_from_msg, vector_from_msg, vector_to_msg
from msg_adapters.in_world import in_world
from msg_adapters.published_covariance import covariance_from_msg, of_pose_and_twist, with_covariance
from msg_adapters.stamps import stamp_ns_from_msg, stamp_to_msg
from msg_adapters.state_adapter import StateAdapter

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.questions.uncertain_state import KnownState
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray
    from msg_adapters.state_adapter import Reader, SourceSettings


def body_state_from_odometry(msg: Odometry, *, world_frame: str, p_FB_F: FloatArray) -> BodyState:
    """Return the state of the body whose centre of mass is at ``p_FB_F``, (3,), m, in the child frame.

    Raises:
        FrameMismatchError: `header.frame_id` is not the world frame.
        InvalidFieldError: a number is not finite, or the quaternion is not unit.
    """
    check_frame("header.frame_id", msg.header.frame_id, world_frame)
    q_WF = check_unit("pose.pose.orientation", quaternion_from_msg(msg.pose.pose.orientation), 4)
    R_WF = rotation_matrix(q_WF)
    return state_of_center_of_mass(
        p_WF_W=vector_from_msg(msg.pose.pose.position),
        q_WF=q_WF,
        v_WF_W=R_WF @ vector_from_msg(msg.twist.twist.linear),
        w_WF_W=R_WF @ vector_from_msg(msg.twist.twist.angular),
        p_FB_F=p_FB_F,
        stamp_ns=stamp_ns_from_msg(msg.header.stamp),
    )


def _read(msg: Odometry, settings: SourceSettings) -> KnownState:
    if msg.child_frame_id:  # many publishers leave it out
        check_frame("child_frame_id", msg.child_frame_id, settings.body_frame)
    frame = msg.header.frame_id
    state = body_state_from_odometry(msg, world_frame=frame, p_FB_F=settings.p_FB_F)
    covariance = of_pose_and_twist(
        covariance_from_msg(msg.pose.covariance), covariance_from_msg(msg.twist.covariance)
    )
    known = with_covariance(state, covariance, settings.p_FB_F, twist_in_body_axes=True)
    return in_world(known, frame, settings)


def _readers(settings: SourceSettings) -> Sequence[Reader]:
    return (lambda msg: _read(msg, settings),)


ODOMETRY: Final = StateAdapter(
    type_names=("nav_msgs/msg/Odometry",), readers=_readers, is_whole=True, is_of_one_body=True
)


def odometry_from_body_state(
    state: BodyState, *, world_frame: str, child_frame: str, p_FB_F: FloatArray
) -> Odometry:
    """Return the state as a message, with the twist in the child frame's axes and at its origin."""
    R_FW = state.R_WB.T
    msg = Odometry(child_frame_id=child_frame)
    msg.header.stamp = stamp_to_msg(state.stamp_ns)
    msg.header.frame_id = world_frame
    msg.pose.pose = pose_to_msg(origin_of_published_frame(state, p_FB_F), state.q_WB)
    msg.twist.twist.linear = vector_to_msg(R_FW @ velocity_of_published_frame(state, p_FB_F))
    msg.twist.twist.angular = vector_to_msg(R_FW @ state.w_WB_W)
    return msg
