# SPDX-License-Identifier: Apache-2.0
"""How a run is configured, as its log records it, at the beginning and at each change. Reading needs no ROS.

`PARAMETERS` and `TOPICS` are JSON, so that a number, a text and a list stay what they are, to the last bit.
Logs before 0.1.0 have each parameter under its own name instead, as Python prints it. A change is an event of
ROS, `rcl_interfaces/ParameterEvent`, at the time from which on it counts.
"""

from __future__ import annotations

import ast
import json
import platform
import re
from importlib.metadata import version
from typing import TYPE_CHECKING, Any, Final, Protocol

from contact_dynamics.nodes.given_parameters import GivenParameters
from contact_dynamics.nodes.parameter_mistakes import refuse_unknown
from contact_dynamics.nodes.parameter_reader import ConfigurationError
from contact_dynamics.nodes.visualizer_parameters import VISUALIZER_PARAMETERS
from contact_dynamics.recording.cdr import cut_to_its_end
from contact_dynamics.recording.definitions import find_definition
from contact_dynamics.version import version_of_this_package

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping

    from rclpy.node import Node

PARAMETERS: Final = "parameters"
"""The key of the node's parameters, which are a JSON object by name."""

TOPICS: Final = "state_topics"
"""The key of the full names of the topics of states, which are a JSON object by parameter."""

_ARRAY: Final = re.compile(r"array\('\w', (\[.*\])\)", re.DOTALL)


def versions_here() -> dict[str, str]:
    """Return the versions that the last bits of an answer depend on.

    The platform has the kind of processor, and the C library, whose sines Python uses.
    """
    libraries = {name: version(name) for name in ("numpy", "scipy")}
    return {
        "version": version_of_this_package(),
        "python": platform.python_version(),
        **libraries,
        "platform": f"{platform.machine()} {' '.join(platform.libc_ver())}",
    }


def run_record(parameters: Mapping[str, Any], topics: Mapping[str, str]) -> dict[str, str]:
    """Return the log's record of a run, by plain values. The log itself adds the package's version."""
    versions = {name: text for name, text in versions_here().items() if name != "version"}
    return {**versions, PARAMETERS: json.dumps(dict(parameters)), TOPICS: json.dumps(dict(topics))}


class LoggedParameters:
    """The record of a run as the source of its parameters, as a `ParameterSource`."""

    def __init__(self, run: Mapping[str, str], instead: Mapping[str, Any] | None = None) -> None:
        """Read a record that `run_record` or an older server wrote.

        Args:
            run: the record.
            instead: values that count instead of those in it, from the log's beginning to its end, also where
                the log tells of a change of theirs.

        Raises:
            ConfigurationError: no server wrote this record.
        """
        self._record = run
        self._instead = dict(instead or {})
        self._read: set[str] = set()
        self._values: dict[str, Any] | None = None
        self._topics: dict[str, str] = {}
        try:
            if PARAMETERS in run:
                self._values = dict(json.loads(run[PARAMETERS]))
                self._topics = dict(json.loads(run.get(TOPICS, "{}")))
        except (ValueError, TypeError) as error:
            message = f"the log's record of its run cannot be read: {error}"
            raise ConfigurationError(message) from None

    def changed(self, values: Mapping[str, Any]) -> LoggedParameters:
        """Return the parameters after a change, which names those that changed; None is one that is gone.

        Raises:
            ConfigurationError: the log is of a server whose parameters could not change.
        """
        if self._values is None:
            message = "the log's record of its run is older than changes of parameters, and has one"
            raise ConfigurationError(message)
        merged = {**self._values, **values}
        after = {name: value for name, value in merged.items() if value is not None}
        record = {PARAMETERS: json.dumps(after), TOPICS: json.dumps(self._topics)}
        return LoggedParameters(record, self._instead)

    def value(
        self,
        name: str,
        default: Any,
        description: str,
        bounds: tuple[float, float] | None = None,  # the server judged those of its own values
    ) -> Any:
        """Return a parameter's value, or its default if the server lacked it (see `ParameterSource`)."""
        self._read.add(name)
        if name in self._instead:
            value = self._instead[name]
            if (default is float or isinstance(default, float)) and type(value) is int:
                value = float(value)
            return GivenParameters({name: value}).value(name, default, description, bounds)
        if self._values is not None:
            found = self._values.get(name)
        else:
            found = _from_text(name, self._record[name], default) if name in self._record else None
        if found is None and not isinstance(default, type):
            return default
        wanted = default if isinstance(default, type) else type(default)
        if not isinstance(found, wanted):
            message = f"{name} is required ({description}), got {found!r} in the log"
            raise ConfigurationError(message)
        return found

    def resolved_topic(self, name: str, topic: str) -> str:
        """Return the full name under which a topic was logged (see `ParameterSource`)."""
        if name in self._topics and name not in self._instead:
            return self._topics[name]
        return GivenParameters({}).resolved_topic(name, topic)

    def refuse_unknown(self, early: Collection[str] | None = None) -> None:
        """Refuse unknown parameters among the values that count instead (see `ParameterSource`).

        Those of the record are not refused: another version of the server may have had other parameters.
        """
        known = {*self._read, *VISUALIZER_PARAMETERS}
        refuse_unknown(self._instead, known, lambda name: self._instead.get(name, []), early)


def plain(value: Any) -> Any:
    """Return the value of a parameter as JSON takes it, and as the parameters of a log are."""
    return value if isinstance(value, (bool, int, float, str, type(None))) else list(value)


def _from_text(name: str, text: str, default: Any) -> Any:
    """Return a value of the default's type from its text."""
    kind = default if isinstance(default, type) else type(default)
    if kind is str:
        return text
    try:
        if kind is float:
            return float(text)
        array = _ARRAY.fullmatch(text)
        return ast.literal_eval(array[1] if array else text)
    except (ValueError, SyntaxError):
        message = f"{name} must be of type {kind.__name__}, got {text!r} in the log"
        raise ConfigurationError(message) from None


CHANGES: Final = "/parameter_events"
"""The topic of changes."""

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
    definition = find_definition(CHANGE_TYPE).text
    return cut_to_its_end(serialize_message(event), type_name=CHANGE_TYPE, definition=definition)
