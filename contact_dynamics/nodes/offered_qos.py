"""Watches what the publishers of a topic offer, which the log says of it as rosbag2 does."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node
    from rclpy.topic_endpoint_info import TopicEndpointInfo


class OfferedQosWatch:
    """Tells what the publishers of a topic offer, whenever that has changed.

    DDS does not say how deep the queues of a publisher are. The history is then unknown, as in bags of
    rosbag2.
    """

    def __init__(self, node: Node, topic: str, tell: Callable[[str, list[Any]], object]) -> None:
        """Watch for a node. ``tell`` takes the topic and the ``QoSProfile`` of each publisher."""
        self._node = node
        self._topic = topic
        self._tell = tell
        self._told: list[Any] = []

    def look(self) -> list[TopicEndpointInfo]:
        """Look at who publishes, and return it. Those that left are remembered until others come."""
        publishers: list[TopicEndpointInfo] = self._node.get_publishers_info_by_topic(self._topic)
        found = [info.qos_profile for info in publishers]
        if found and found != self._told:
            self._told = found
            self._tell(self._topic, found)
        return publishers
