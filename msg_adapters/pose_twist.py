# SPDX-License-Identifier: Apache-2.0
"""Converts `geometry_msgs/PoseStamped` with `TwistStamped` to a body's state.

The pose is that of the body's published frame in the world frame. The twist belongs to that frame's origin.
Its own header says whether it is in the axes of the world or of the body.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Final, Generic, Protocol, TypeVar

from geometry_msgs.msg import PoseStamped, TwistStamped

from contact_dynamics.errors import FrameMismatchError, InvalidFieldError
from contact_dynamics.rigid_body.published_frame import state_of_center_of_mass
from contact_dynamics.rotations.one import rotation_matrix
from contact_dynamics.validation import check_unit
from msg_adapters.geometry import quaternion_from_msg, vector_from_msg
from msg_adapters.published_covariance import covariance_from_msg, of_pose_and_twist, with_covariance
from msg_adapters.stamps import stamp_ns_from_msg
from msg_adapters.state_adapter import StateAdapter, in_world
from msg_adapters.transforms import check_frame

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from geometry_msgs.msg import PoseWithCovarianceStamped, TwistWithCovarianceStamped
    from std_msgs.msg import Header

    from contact_dynamics.questions.uncertain_state import KnownState
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray
    from msg_adapters.state_adapter import Reader, SourceSettings


def body_state_from_pose_twist(
    pose: PoseStamped, twist: TwistStamped, *, world_frame: str, body_frame: str, p_FB_F: FloatArray
) -> BodyState:
    """Return the state of the body whose centre of mass is at ``p_FB_F``, (3,), m, in its published frame.

    Raise `FrameMismatchError` if the pose is not in the world frame, or the twist in neither the world's nor
    the body's; `InvalidFieldError` if the stamps differ, a number is not finite, or the quaternion is not
    unit.
    """
    check_frame("pose header.frame_id", pose.header.frame_id, world_frame)
    stamp_ns = stamp_ns_from_msg(pose.header.stamp)
    twist_stamp_ns = stamp_ns_from_msg(twist.header.stamp)
    if twist_stamp_ns != stamp_ns:
        raise InvalidFieldError(
            "twist header.stamp", f"{twist_stamp_ns} ns", f"the pose's stamp, {stamp_ns} ns"
        )
    q_WF = check_unit("pose.orientation", quaternion_from_msg(pose.pose.orientation), 4)
    v_WF, w_WF = vector_from_msg(twist.twist.linear), vector_from_msg(twist.twist.angular)
    if twist.header.frame_id == body_frame:
        R_WF = rotation_matrix(q_WF)
        v_WF, w_WF = R_WF @ v_WF, R_WF @ w_WF
    elif twist.header.frame_id != world_frame:
        found = twist.header.frame_id
        message = f"twist header.frame_id must be {world_frame!r} or {body_frame!r}, got {found!r}"
        raise FrameMismatchError(message)
    return state_of_center_of_mass(
        p_WF_W=vector_from_msg(pose.pose.position),
        q_WF=q_WF,
        v_WF_W=v_WF,
        w_WF_W=w_WF,
        p_FB_F=p_FB_F,
        stamp_ns=stamp_ns,
    )


def _joined(
    pose: PoseStamped, twist: TwistStamped, settings: SourceSettings, covariance: FloatArray | None = None
) -> KnownState:
    frame = pose.header.frame_id
    state = body_state_from_pose_twist(
        pose, twist, world_frame=frame, body_frame=settings.body_frame, p_FB_F=settings.p_FB_F
    )
    in_body_axes = twist.header.frame_id == settings.body_frame
    known = with_covariance(state, covariance, settings.p_FB_F, twist_in_body_axes=in_body_axes)
    return in_world(known, frame, settings)


def _joined_with_covariance(
    pose: PoseWithCovarianceStamped, twist: TwistWithCovarianceStamped, settings: SourceSettings
) -> KnownState:
    covariance = of_pose_and_twist(
        covariance_from_msg(pose.pose.covariance), covariance_from_msg(twist.twist.covariance)
    )
    return _joined(
        PoseStamped(header=pose.header, pose=pose.pose.pose),
        TwistStamped(header=twist.header, twist=twist.twist.twist),
        settings,
        covariance,
    )


def _readers(join: Callable[..., KnownState], settings: SourceSettings) -> Sequence[Reader]:
    pairs = Pairs[Stamped, Stamped](partial(join, settings=settings))
    return pairs.first, pairs.second


POSE_TWIST: Final = StateAdapter(
    type_names=("geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/TwistStamped"),
    readers=partial(_readers, _joined),
    is_of_one_body=True,
)
POSE_TWIST_WITH_COVARIANCE: Final = StateAdapter(
    type_names=(
        "geometry_msgs/msg/PoseWithCovarianceStamped",
        "geometry_msgs/msg/TwistWithCovarianceStamped",
    ),
    readers=partial(_readers, _joined_with_covariance),
    is_of_one_body=True,
)


class Stamped(Protocol):
    """A message with a header."""

    header: Header


First = TypeVar("First", bound=Stamped)
Second = TypeVar("Second", bound=Stamped)

MAX_UNPAIRED: Final = 100
"""Number of messages that wait for a partner. Above it, the oldest are discarded."""


class Pairs(Generic[First, Second]):
    """Joins the two messages with the same stamp that form a state, in either order of arrival."""

    def __init__(self, join: Callable[[First, Second], KnownState]) -> None:
        """Begin without messages; ``join`` converts a message of each topic to a state."""
        self._join = join
        self._first: dict[int, First] = {}
        self._second: dict[int, Second] = {}

    def first(self, msg: First) -> KnownState | None:
        """Add a message of the first topic."""
        other = _partner(msg, self._first, self._second)
        return None if other is None else self._join(msg, other)

    def second(self, msg: Second) -> KnownState | None:
        """Add a message of the second topic."""
        other = _partner(msg, self._second, self._first)
        return None if other is None else self._join(other, msg)


def _partner(msg: First, mine: dict[int, First], others: dict[int, Second]) -> Second | None:
    """Return the waiting message with the same stamp, or store this one."""
    stamp_ns = stamp_ns_from_msg(msg.header.stamp)
    partner = others.pop(stamp_ns, None)
    if partner is None:
        mine[stamp_ns] = msg
        if len(mine) > MAX_UNPAIRED:
            del mine[next(iter(mine))]
    return partner
