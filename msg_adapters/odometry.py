# SPDX-License-Identifier: Apache-2.0
"""Converts `nav_msgs/Odometry` to a body's state and back.

The pose is that of the child frame in `header.frame_id`. The twist is in the child frame's axes and at its
origin (REP 105 and the message's own comment).
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np
from nav_msgs.msg import Odometry

from contact_dynamics.constants import NS_PER_S
from contact_dynamics.rigid_body.published_frame import (
    origin_of_published_frame,
    state_of_center_of_mass,
    velocity_of_published_frame,
)
from contact_dynamics.rotations.many import cross_matrices, matrices_of
from contact_dynamics.rotations.one import rotation_matrix
from contact_dynamics.validation import check_unit
from contact_dynamics.validation_batches import unit_rows
from msg_adapters.geometry import pose_to_msg, quaternion_from_msg, vector_from_msg, vector_to_msg
from msg_adapters.published_covariance import covariance_from_msg, of_pose_and_twist, with_covariance
from msg_adapters.stamps import stamp_ns_from_msg, stamp_to_msg
from msg_adapters.state_adapter import StateAdapter, StateRows, in_world
from msg_adapters.transforms import check_frame

if TYPE_CHECKING:
    from contact_dynamics.questions.uncertain_state import KnownState
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray
    from msg_adapters.state_adapter import SourceSettings


@np.errstate(invalid="ignore", over="ignore")  # an infinite twist is rejected, without a warning before
def body_state_from_odometry(msg: Odometry, *, world_frame: str, p_FB_F: FloatArray) -> BodyState:
    """Return the state of the body whose centre of mass is at ``p_FB_F``, (3,), m, in the child frame.

    Raise `FrameMismatchError` if `header.frame_id` is not the world frame, and `InvalidFieldError` if a
    number is not finite, or the quaternion is not unit.
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


def _rows(settings: SourceSettings, msg: Odometry) -> StateRows | None:
    """Return the results of `_read`, to the last bit, for messages in the world frame without covariances."""
    if msg.header.frame_id != settings.world_frame or msg.child_frame_id not in {"", settings.body_frame}:
        return None
    pose, twist, stamp = msg.pose.pose, msg.twist.twist, msg.header.stamp
    q_WF, are_unit = unit_rows(np.column_stack([getattr(pose.orientation, name) for name in "xyzw"]))
    p_WF_W, v_F, w_F = (
        np.column_stack([getattr(vector, name) for name in "xyz"])
        for vector in (pose.position, twist.linear, twist.angular)
    )
    with np.errstate(invalid="ignore", over="ignore"):  # what is not finite is left to `_read`
        R_WF = matrices_of(q_WF)
        v_W, w_W = ((R_WF @ vectors[:, :, None])[:, :, 0] for vectors in (v_F, w_F))
        if settings.p_FB_F.any():
            arms_W = R_WF @ settings.p_FB_F
            p_WF_W, v_W = p_WF_W + arms_W, v_W + (cross_matrices(w_W) @ arms_W[:, :, None])[:, :, 0]
    numbers = np.column_stack([p_WF_W, q_WF, v_W, w_W])
    known = [each.covariance for each in (msg.pose, msg.twist)]
    uncertain = np.logical_and.reduce([(each[:, 0] >= 0.0) & each.any(axis=1) for each in known])
    return StateRows(
        stamps_ns=stamp.sec.astype(np.int64) * NS_PER_S + stamp.nanosec,
        numbers=numbers,
        are_all=are_unit & np.isfinite(numbers).all(axis=1) & ~uncertain,
    )


ODOMETRY: Final = StateAdapter(
    type_names=("nav_msgs/msg/Odometry",),
    readers=lambda settings: (partial(_read, settings=settings),),
    is_whole=True,
    is_of_one_body=True,
    rows=_rows,
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
