# SPDX-License-Identifier: Apache-2.0
"""A change of parameters as ROS tells it, `rcl_interfaces/ParameterEvent`, read and written.

To read one needs no ROS. The log has one for each change, at the time from which on it counts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, Protocol

from contact_dynamics.recording.cdr import cut_to_its_end
from contact_dynamics.recording.definitions import find_definition

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from rclpy.node import Node

TOPIC: Final = "/parameter_events"
TYPE_NAME: Final = "rcl_interfaces/msg/ParameterEvent"

_FIELDS: Final = (
    None,
    "bool_value",
    "integer_value",
    "double_value",
    "string_value",
    "byte_array_value",
    "bool_array_value",
    "integer_array_value",
    "double_array_value",
    "string_array_value",
)
"""The field of a value, by the number of its type."""


class _Parameter(Protocol):
    name: str
    value: Any


class ParameterEvent(Protocol):
    """What the message has, of ROS or of a log."""

    node: str
    new_parameters: Iterable[_Parameter]
    changed_parameters: Iterable[_Parameter]
    deleted_parameters: Iterable[_Parameter]


def changed_values(event: ParameterEvent) -> dict[str, Any]:
    """Return the values of an event by the parameters' names, and None for those that are gone."""
    values: dict[str, Any] = {each.name: None for each in event.deleted_parameters}
    for each in (*event.new_parameters, *event.changed_parameters):
        field = _FIELDS[each.value.type]
        value = None if field is None else getattr(each.value, field)
        values[each.name] = value if isinstance(value, (bool, int, float, str, type(None))) else list(value)
    return values


def event_of_change(node: Node, before: Mapping[str, Any], after: Mapping[str, Any]) -> bytes | None:
    """Return a change of a node's parameters as the bytes of an event, or None if nothing changed.

    Args:
        node: the node, whose clock stamps the event.
        before: the plain values by name.
        after: the same after the change.
    """
    from rcl_interfaces.msg import Parameter as ParameterMsg  # here, for logs are read without ROS
    from rcl_interfaces.msg import ParameterEvent as EventMsg
    from rclpy.parameter import Parameter
    from rclpy.serialization import serialize_message

    def messages(names: Iterable[str]) -> list[ParameterMsg]:
        return [Parameter(name, value=after[name]).to_parameter_msg() for name in names]

    event = EventMsg(
        stamp=node.get_clock().now().to_msg(),
        node=node.get_fully_qualified_name(),
        new_parameters=messages(name for name in after if name not in before),
        changed_parameters=messages(name for name in after if name in before and before[name] != after[name]),
        deleted_parameters=[ParameterMsg(name=name) for name in before if name not in after],
    )
    if not (event.new_parameters or event.changed_parameters or event.deleted_parameters):
        return None
    definition = find_definition(TYPE_NAME).text
    return cut_to_its_end(serialize_message(event), type_name=TYPE_NAME, definition=definition)
