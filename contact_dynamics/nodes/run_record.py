# SPDX-License-Identifier: Apache-2.0
"""The record of a run's configuration in its log, at the beginning and at each change. Reading needs no ROS.

`PARAMETERS` and `TOPICS` are JSON, which preserves types and all bits. A change is an event of ROS,
`rcl_interfaces/ParameterEvent`, logged at the time from which it applies.
"""

from __future__ import annotations

import json
import platform
from importlib.metadata import version
from typing import TYPE_CHECKING, Any, Final, Protocol

from contact_dynamics.nodes.other_parameters import PARAMETERS_OF_OTHERS
from contact_dynamics.nodes.parameter_reader import ConfigurationError, ParameterSource
from contact_dynamics.recording.cdr import cut_to_its_end
from contact_dynamics.recording.definitions import find_definition
from contact_dynamics.version import version_of_this_package

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from rclpy.node import Node

PARAMETERS: Final = "parameters"  # the key of the node's parameters, which are a JSON object by name

TOPICS: Final = "state_topics"
"""The key of the full names of the topics of states, which are a JSON object by parameter."""


def versions_here() -> dict[str, str]:
    """Return the versions that affect the last bits of an answer.

    The platform includes the processor type and the C library, whose sines Python uses.
    """
    libraries = {name: version(name) for name in ("numpy", "scipy")}
    return {
        "version": version_of_this_package(),
        "python": platform.python_version(),
        **libraries,
        "platform": f"{platform.machine()} {' '.join(platform.libc_ver())}",
    }


def run_record(parameters: Mapping[str, Any], topics: Mapping[str, str]) -> dict[str, str]:
    """Return the log's record of a run. The log itself adds the package's version."""
    versions = {name: text for name, text in versions_here().items() if name != "version"}
    return {**versions, PARAMETERS: json.dumps(dict(parameters)), TOPICS: json.dumps(dict(topics))}


class LoggedParameters(ParameterSource):
    """The parameters in the record of a run. Missing ones have their defaults."""

    def __init__(self, run: Mapping[str, str], instead: Mapping[str, Any] | None = None) -> None:
        """Read a record of `run_record`, or raise `ConfigurationError` if it is invalid.

        The values ``instead`` replace those in the log until its end.
        """
        self._instead = dict(instead or {})
        try:
            self._logged = dict(json.loads(run.get(PARAMETERS, "{}")))
            self._logged_topics = dict(json.loads(run.get(TOPICS, "{}")))
        except (ValueError, TypeError) as error:
            raise ConfigurationError(f"the log's record of its run cannot be read: {error}") from None
        # Another version of the server may have had other parameters.
        super().__init__({**self._logged, **self._instead}, also_known=[*self._logged, *PARAMETERS_OF_OTHERS])

    def changed(self, values: Mapping[str, Any]) -> LoggedParameters:
        """Return the parameters after a change of some values. None removes a parameter."""
        merged = {**self._logged, **values}
        after = {name: value for name, value in merged.items() if value is not None}
        return LoggedParameters(run_record(after, self._logged_topics), self._instead)

    def resolved_topic(self, name: str, topic: str) -> str:
        """Return the full name under which a topic was logged (see `ParameterSource`)."""
        if name in self._logged_topics and name not in self._instead:
            topic = self._logged_topics[name]
        return super().resolved_topic(name, topic)


def plain(value: Any) -> Any:
    """Return the value of a parameter in a form for JSON and for the record of a run."""
    return value if isinstance(value, (bool, int, float, str, type(None))) else list(value)


CHANGES: Final = "/parameter_events"  # the topic of changes

CHANGE_TYPE: Final = "rcl_interfaces/msg/ParameterEvent"

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
"""The name of the field that contains a value, by the number of its type."""


class _Parameter(Protocol):
    name: str
    value: Any


class ParameterEvent(Protocol):
    """The fields of the message, from ROS or from a log."""

    node: str
    new_parameters: Iterable[_Parameter]
    changed_parameters: Iterable[_Parameter]
    deleted_parameters: Iterable[_Parameter]


def changed_values(event: ParameterEvent) -> dict[str, Any]:
    """Return the values of an event by the parameters' names, with None for removed ones."""
    values: dict[str, Any] = {each.name: None for each in event.deleted_parameters}
    for each in (*event.new_parameters, *event.changed_parameters):
        field = _FIELDS[each.value.type]
        values[each.name] = None if field is None else plain(getattr(each.value, field))
    return values


def event_of_change(node: Node, before: Mapping[str, Any], after: Mapping[str, Any]) -> bytes | None:
    """Return a change of a node's parameters as the bytes of an event, or None if nothing changed."""
    from rcl_interfaces.msg import Parameter as ParameterMsg  # imported here, since logs are read without ROS
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
    return cut_to_its_end(serialize_message(event), find_definition(CHANGE_TYPE))
