"""Makes states from the messages that are published about a body, live or logged.

It needs the classes of messages and no other part of ROS.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from msg_adapters.odometry import body_state_from_odometry
from msg_adapters.pose_twist import body_state_from_pose_twist
from msg_adapters.stamps import stamp_ns_from_msg

if TYPE_CHECKING:
    from collections.abc import Callable

    from geometry_msgs.msg import PoseStamped, TwistStamped

    from contact_dynamics.nodes.parameters import StateTopics
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray

_MOST_UNPAIRED = 100


@dataclass(frozen=True, slots=True, kw_only=True)
class StateSource:
    """One topic with messages about a body.

    Attributes:
        topic: Its name, as it is configured.
        parameter: The parameter that names it.
        type_name: "package/msg/Name".
        state_from: Function from a message to a state, or to None if another message must complete it.
        is_whole: Whether each message is a state by itself. It can then be read later, or never.
    """

    topic: str
    parameter: str
    type_name: str
    state_from: Callable[[Any], BodyState | None]
    is_whole: bool = False


def state_sources(topics: StateTopics, *, world_frame: str, p_FB_F: FloatArray) -> tuple[StateSource, ...]:
    """Return the topics with messages about a body, whose centre of mass is at ``p_FB_F``, m, (3,)."""
    sources = []
    if topics.odometry:
        sources.append(
            StateSource(
                topic=topics.odometry,
                parameter=f"body.{topics.body_name}.odometry_topic",
                type_name="nav_msgs/msg/Odometry",
                state_from=lambda msg: body_state_from_odometry(msg, world_frame=world_frame, p_FB_F=p_FB_F),
                is_whole=True,
            )
        )
    if topics.pose:
        pair = _Pairing(
            lambda pose, twist: body_state_from_pose_twist(
                pose, twist, world_frame=world_frame, body_frame=topics.frame, p_FB_F=p_FB_F
            )
        )
        for topic, kind, name, state_from in (
            (topics.pose, "pose", "PoseStamped", pair.pose),
            (topics.twist, "twist", "TwistStamped", pair.twist),
        ):
            sources.append(
                StateSource(
                    topic=topic,
                    parameter=f"body.{topics.body_name}.{kind}_topic",
                    type_name=f"geometry_msgs/msg/{name}",
                    state_from=state_from,
                )
            )
    return tuple(sources)


class _Pairing:
    """Joins the pose and the twist of one stamp, whichever comes first."""

    def __init__(self, join: Callable[[PoseStamped, TwistStamped], BodyState]) -> None:
        self._join = join
        self._poses: dict[int, PoseStamped] = {}
        self._twists: dict[int, TwistStamped] = {}

    def pose(self, msg: PoseStamped) -> BodyState | None:
        twist = self._partner(msg, self._poses, self._twists)
        return None if twist is None else self._join(msg, twist)

    def twist(self, msg: TwistStamped) -> BodyState | None:
        pose = self._partner(msg, self._twists, self._poses)
        return None if pose is None else self._join(pose, msg)

    @staticmethod
    def _partner(msg: Any, mine: dict[int, Any], others: dict[int, Any]) -> Any:
        stamp_ns = stamp_ns_from_msg(msg.header.stamp)
        partner = others.pop(stamp_ns, None)
        if partner is None:
            mine[stamp_ns] = msg
            if len(mine) > _MOST_UNPAIRED:  # one topic is silent
                del mine[next(iter(mine))]
        return partner
