# SPDX-License-Identifier: Apache-2.0
"""Makes a node the source of its parameters, and refuses parameters that it does not have."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.parameter import Parameter

from contact_dynamics.nodes.parameter_mistakes import (
    ANY_NODE,
    IN_WORDS,
    Section,
    check_sections,
    files_given,
    likely_misspelling,
    nodes_given,
    qos_overrides_of,
    read_sections,
    refuse_unknown,
    values_given,
    what_is_wrong,
)
from contact_dynamics.nodes.parameter_reader import ConfigurationError

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Sequence

    from rclpy.node import Node

    from contact_dynamics.nodes.parameter_reader import DeclaredParameter

_MANDATORY: Final = {float: Parameter.Type.DOUBLE, list: Parameter.Type.DOUBLE_ARRAY}

_WITH_POINTS: Final = "a list of numbers with points, such as [1.0]"


class NodeParameters:
    """Declares parameters at a node and returns their values, as a `ParameterSource`."""

    def __init__(
        self,
        node: Node,
        *,
        ros_arguments: Sequence[str] = (),
        also_known: Iterable[str] = (),
        read_only: bool,
    ) -> None:
        """Declare at this node.

        Args:
            node: the node.
            ros_arguments: ROS's arguments, whose values must be of the type that a parameter has.
            also_known: names of parameters that may be given besides.
            read_only: whether the parameters stay as they are from then on.
        """
        self._node = node
        self._read_only = read_only
        self._also_known = also_known
        self._given = values_given(ros_arguments, node.get_fully_qualified_name())
        self.topics: dict[str, str] = {}  # the full name of each topic, by the parameter that names it

    def value(
        self, name: str, default: Any, description: str, bounds: tuple[float, float] | None = None
    ) -> Any:
        """Return a parameter's value (see `ParameterSource`)."""
        descriptor = _descriptor(default, description, bounds, read_only=self._read_only)
        declared = _MANDATORY[default] if isinstance(default, type) else default
        wanted = default if isinstance(default, type) else type(default)
        given = self._node._parameter_overrides.get(name)  # noqa: SLF001  rclpy has no public way to it
        number: Any = None if given is None else given.value
        allowed = what_is_wrong(self._given.get(name, ""), wanted) or _lacks_a_point(number, default)
        if allowed:
            message = f"{name} must be {allowed} ({description}), got {self._given.get(name, number)}"
            raise ConfigurationError(message)
        if bounds and type(number) is type(default) and not bounds[0] <= number <= bounds[1]:
            message = f"{name} must be in [{bounds[0]:g}, {bounds[1]:g}] ({description}), got {number!r}"
            raise ConfigurationError(message)
        if (default is list or isinstance(default, list)) and isinstance(number, (bool, int, float, str)):
            message = f"{name} must be a list, such as [{number}], got {number} ({description})"
            raise ConfigurationError(message)
        try:
            value = self._node.declare_parameter(name, declared, descriptor).value
        except Exception as error:  # noqa: BLE001  rclpy raises several unrelated types for a wrong type or range
            message = f"{name}: {error} ({description})"
            raise ConfigurationError(message) from None
        if value is None:
            given_names = self._node._parameter_overrides  # noqa: SLF001
            message = f"{name} is required ({description}){likely_misspelling(name, given_names)}"
            raise ConfigurationError(message)
        return value

    def declare(self, parameter: DeclaredParameter) -> None:
        """Declare a parameter that has come with a change, whatever a file says of it."""
        name, value, description, bounds = parameter
        descriptor = _descriptor(value, description, bounds, read_only=self._read_only)
        self._node.declare_parameter(name, value, descriptor, ignore_override=True)

    def resolved_topic(self, name: str, topic: str) -> str:
        """Return the full name of a topic after ROS's remapping (see `ParameterSource`)."""
        try:
            resolved: str = self._node.resolve_topic_name(topic)
        except RuntimeError as error:
            message = f"{name} must be a topic's name ({error}), got {topic!r}"
            raise ConfigurationError(message) from None
        self.topics[name] = resolved
        return resolved

    def refuse_unknown(self, early: Collection[str] | None = None) -> None:
        """Refuse parameters that are set and that the node lacks (see `ParameterSource`)."""
        # rclpy has no public way to ask what was given and not declared.
        known = {*self._node._parameters, *self._also_known, *qos_overrides_of(self.topics.values())}  # noqa: SLF001
        refuse_unknown(self._node._parameter_overrides, known, self._listed, early)  # noqa: SLF001

    def _listed(self, name: str) -> list[str]:
        return [each for each in self._node.get_parameter(name).value if each]


def _lacks_a_point(number: object, default: object) -> str:
    """Return what whole numbers of a file would have to be, or nothing where they are of the wanted type."""
    if type(number) is int and (default is float or isinstance(default, float)):
        return IN_WORDS[float]
    numbers = number if isinstance(number, list) else []
    of_floats = default is list or (
        isinstance(default, list) and any(type(each) is float for each in default)
    )
    return _WITH_POINTS if of_floats and any(type(each) is int for each in numbers) else ""


def _descriptor(
    default: Any, description: str, bounds: tuple[float, float] | None, *, read_only: bool
) -> ParameterDescriptor:
    descriptor = ParameterDescriptor(description=description, read_only=read_only)
    if bounds and isinstance(default, int):
        descriptor.integer_range = [IntegerRange(from_value=int(bounds[0]), to_value=int(bounds[1]))]
    elif bounds:
        descriptor.floating_point_range = [FloatingPointRange(from_value=bounds[0], to_value=bounds[1])]
    return descriptor


def refuse_lost_sections(node: Node, arguments: Sequence[str]) -> None:
    """Refuse files of parameters that have none for a node; warn of sections that miss it by a few letters.

    Args:
        node: the node.
        arguments: ROS's arguments, which name the files.

    Raises:
        ConfigurationError: a file has no parameters for the node. The message names whose it has.
    """
    full_name = node.get_fully_qualified_name()
    for path in map(Path, files_given(arguments)):
        warning = check_sections(path, read_sections(path), full_name)
        if warning:
            node.get_logger().warning(warning)
    single = [Section(name, {}) for name in nodes_given(arguments)]
    if single:
        warning = check_sections(Path("-p"), [*single, Section(ANY_NODE, {})], full_name)
        if warning:
            node.get_logger().warning(warning)
