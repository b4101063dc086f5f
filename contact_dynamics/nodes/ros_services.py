"""Keeps a request to one of the services that ROS gives every node from ending the process.

rclpy raises where it cannot do what is asked, and an exception in a service goes through the executor. So it
is with a lifecycle transition that is none of the present state, for which managers ask: one that brings up
all its nodes asks a node to configure that is active already. rclcpp answers that it was no success.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.service import Service


def refuse_what_ros_cannot_do(node: Node) -> None:
    """Let the services that a node has so far answer with what an empty response says, and tell why."""
    for service in node.services:
        _guard(service, node)


def _guard(service: Service, node: Node) -> None:
    answer = service.callback

    def answer_or_refuse(request: Any, response: Any) -> Any:
        try:
            return answer(request, response)
        except Exception as error:  # noqa: BLE001  rclpy raises several unrelated types
            node.get_logger().warning(f"{service.service_name}: request refused: {error}")
            return type(response)()

    service.callback = answer_or_refuse
