# SPDX-License-Identifier: Apache-2.0
"""Reads and declares the parameters of a node, and rejects parameter files without any for it."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.parameter import Parameter

from contact_dynamics.nodes.links import with_links_read
from contact_dynamics.nodes.parameter_file import (
    ANY_NODE,
    Section,
    check_sections,
    files_given,
    nodes_given,
    read_sections,
    values_given,
)
from contact_dynamics.nodes.parameter_reader import ConfigurationError, ParameterSource
from contact_dynamics.nodes.run_record import plain

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from rclpy.node import Node

    from contact_dynamics.nodes.parameter_reader import DeclaredParameter


class NodeParameters(ParameterSource):
    """The values of a node's parameters. A parameter is declared when it is read.

    If the values of a parameter in a file and in `-p` have different types, such as `log: true` and
    `-p log:=0`, ROS may use that of the file. Here, `-p` overrides the file.
    """

    def __init__(
        self,
        node: Node,
        *,
        ros_arguments: Sequence[str] = (),
        also_known: Iterable[str] = (),
        read_only: bool,
    ) -> None:
        """Set the node, ROS's arguments, further allowed names, and whether parameters are read-only."""
        self._node = node
        self._read_only = read_only
        self._overrides = node._parameter_overrides  # noqa: SLF001  rclpy has no public access
        values = {name: plain(each.value) for name, each in self._overrides.items()}
        values |= values_given(ros_arguments, node.get_fully_qualified_name())
        of_ros = node._parameters  # noqa: SLF001  as above
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always", UserWarning)
            found = with_links_read(values)
        for each in warned:
            node.get_logger().warning(str(each.message))
        for name in values.keys() - found.keys():
            self._overrides.pop(name, None)
        super().__init__(found, also_known=[*also_known, *of_ros], resolve=self._resolved_by_ros)

    def value(
        self, name: str, default: Any, description: str, bounds: tuple[float, float] | None = None
    ) -> Any:
        """Return a parameter's value, and declare it."""
        found = super().value(name, default, description, bounds)
        if name in self.values:
            self._overrides[name] = Parameter(name, value=found)
        declared = Parameter.Type.DOUBLE if default is float else default
        self._node.declare_parameter(name, declared, self._descriptor(default, description, bounds))
        return found

    def declare(self, parameter: DeclaredParameter) -> None:
        """Declare a parameter after a change, without the override of a file."""
        name, value, description, bounds = parameter
        descriptor = self._descriptor(value, description, bounds)
        self._node.declare_parameter(name, value, descriptor, ignore_override=True)

    def _resolved_by_ros(self, name: str, topic: str) -> str:
        """Return the full name of a topic after ROS's remapping."""
        try:
            resolved: str = self._node.resolve_topic_name(topic)
        except RuntimeError as error:
            raise ConfigurationError(f"{name} must be a topic's name ({error}), got {topic!r}") from None
        return resolved

    def _descriptor(
        self, default: Any, description: str, bounds: tuple[float, float] | None
    ) -> ParameterDescriptor:
        descriptor = ParameterDescriptor(description=description, read_only=self._read_only)
        if bounds and isinstance(default, int):
            descriptor.integer_range = [IntegerRange(from_value=int(bounds[0]), to_value=int(bounds[1]))]
        elif bounds:
            descriptor.floating_point_range = [FloatingPointRange(from_value=bounds[0], to_value=bounds[1])]
        return descriptor


def refuse_lost_sections(node: Node, arguments: Sequence[str]) -> None:
    """Reject parameter files in ROS's arguments without parameters for a node; warn of similar names.

    Raise `ConfigurationError`, which lists the sections of the file, if it has none for the node.
    """
    full_name = node.get_fully_qualified_name()
    found = [(path, read_sections(path)) for path in map(Path, files_given(arguments))]
    single = tuple(Section(name, {}) for name in nodes_given(arguments))
    if single:
        found.append((Path("-p"), (*single, Section(ANY_NODE, {}))))
    for path, sections in found:
        warning = check_sections(path, sections, full_name)
        if warning:
            node.get_logger().warning(warning)
