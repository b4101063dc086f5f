"""Subscriptions to published states: each message is logged as it came and kept as a state.

The messages come as bytes. The log keeps these bytes, so it has exactly what was sent, and one
deserialisation gives the state.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rclpy.qos import QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.serialization import deserialize_message

from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.nodes.refused_messages import RefusedMessages
from contact_dynamics.nodes.state_sources import state_sources
from contact_dynamics.recording.decoding import message_class

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node

    from contact_dynamics.nodes.parameters import StateTopics
    from contact_dynamics.questions.state_store import StateStore
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray

STATE_QOS = QoSProfile(depth=1000)
"""The queue is reliable and deep. A second of states at 1 kHz may wait for a stalled process, and the log
loses none."""


def subscribe_to_states(
    node: Node,
    topics: StateTopics,
    *,
    world_frame: str,
    p_FB_F: FloatArray,
    states: StateStore,
    record: Callable[[str, bytes], None],
) -> dict[str, str]:
    """Subscribe to a body's states, record every message, keep every state. Return topics and their types.

    A message that is no state, or whose stamp is in the future, is recorded, and counted in a warning, and
    not kept.
    """
    refused = RefusedMessages(node.get_logger().warning)

    def keep(make_state: Callable[[], BodyState | None], topic: str) -> None:
        try:
            state = make_state()
            if state is not None:
                states.add(topics.body_name, state, now_ns=present_ns(node))
        except (ContactDynamicsError, RuntimeError) as error:  # bytes that are no message raise the latter
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
    for source in state_sources(topics, world_frame=world_frame, p_FB_F=p_FB_F):
        types[subscribe(message_class(source.type_name), source.topic, source.state_from)] = source.type_name
    return types


def present_ns(node: Node) -> int | None:
    """Return the present time, ns, or None if a simulation's clock has not told it yet."""
    clock = node.get_clock()
    now_ns: int = clock.now().nanoseconds
    return None if now_ns == 0 and clock.ros_time_is_active else now_ns
