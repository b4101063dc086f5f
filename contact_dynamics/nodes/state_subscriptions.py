"""Subscriptions to published states: each message is logged as it came and kept as a state.

They are raw: the log takes the bytes, so that it holds what was sent, and one deserialisation gives the
state.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from geometry_msgs.msg import PoseStamped, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.qos import QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.serialization import deserialize_message

from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.nodes.refused_messages import RefusedMessages
from msg_adapters.odometry import body_state_from_odometry
from msg_adapters.pose_twist import body_state_from_pose_twist
from msg_adapters.stamps import stamp_ns_from_msg

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node

    from contact_dynamics.nodes.parameters import StateTopics
    from contact_dynamics.questions.state_store import StateStore
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray

STATE_QOS = QoSProfile(depth=1000)
"""Reliable, and deep: a second of states at 1 kHz may wait for a stalled process, and the log loses none."""

_MOST_UNPAIRED = 100


def subscribe_to_states(
    node: Node,
    topics: StateTopics,
    *,
    world_frame: str,
    p_FB_F: FloatArray,
    states: StateStore,
    record: Callable[[str, bytes], None],
) -> dict[str, str]:
    """Subscribe to a body's states, record every message, keep every state; return topics and their types.

    A message that is no state, or whose stamp is from the future, is recorded, counted and told, not kept.
    """
    refused = RefusedMessages(node.get_logger().warning)

    def keep(make_state: Callable[[], BodyState | None], topic: str) -> None:
        try:
            state = make_state()
            if state is not None:
                states.add(topics.body_name, state, now_ns=present_ns(node))
        except (ContactDynamicsError, RuntimeError) as error:  # the latter of bytes that are no message
            refused.add(topic, error)

    def subscribe(msg_type: type[Any], topic: str, state_from: Callable[[Any], BodyState | None]) -> str:
        def receive(data: bytes) -> None:
            record(resolved, data)
            keep(lambda: state_from(deserialize_message(data, msg_type)), resolved)

        overrides = QoSOverridingOptions.with_default_policies()
        subscription = node.create_subscription(
            msg_type, topic, receive, STATE_QOS, raw=True, qos_overriding_options=overrides
        )
        resolved: str = subscription.topic_name
        return resolved

    types: dict[str, str] = {}
    if topics.odometry:
        resolved = subscribe(
            Odometry,
            topics.odometry,
            lambda msg: body_state_from_odometry(msg, world_frame=world_frame, p_FB_F=p_FB_F),
        )
        types[resolved] = "nav_msgs/msg/Odometry"
    if topics.pose:
        pair = _Pairing(
            lambda pose, twist: body_state_from_pose_twist(
                pose, twist, world_frame=world_frame, body_frame=topics.frame, p_FB_F=p_FB_F
            )
        )
        types[subscribe(PoseStamped, topics.pose, pair.pose)] = "geometry_msgs/msg/PoseStamped"
        types[subscribe(TwistStamped, topics.twist, pair.twist)] = "geometry_msgs/msg/TwistStamped"
    return types


def present_ns(node: Node) -> int | None:
    """Return the present time, ns; None where a simulation's clock has not told it yet."""
    clock = node.get_clock()
    now_ns: int = clock.now().nanoseconds
    return None if now_ns == 0 and clock.ros_time_is_active else now_ns


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
            if (
                len(mine) > _MOST_UNPAIRED
            ):  # one of the two topics is silent: what waits longest waits in vain
                del mine[next(iter(mine))]
        return partner
