"""Makes a node the source of its parameters, and refuses parameters that it does not have."""

from __future__ import annotations

import difflib
import re
from typing import TYPE_CHECKING, Any, Final

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.parameter import Parameter

from contact_dynamics.nodes.parameters import ConfigurationError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rclpy.node import Node

_OF_ROS: Final = re.compile(r"use_sim_time|start_type_description_service|qos_overrides\..*")
_MANDATORY: Final = {float: Parameter.Type.DOUBLE, list: Parameter.Type.DOUBLE_ARRAY}


class NodeParameters:
    """Declares parameters at a node and returns their values, as a `ParameterSource`."""

    def __init__(self, node: Node) -> None:
        """Declare at this node."""
        self._node = node
        self.topics: dict[str, str] = {}  # the full name of each topic, by the parameter that names it

    def value(
        self, name: str, default: Any, description: str, bounds: tuple[float, float] | None = None
    ) -> Any:
        """Return a read-only parameter's value (see `ParameterSource`)."""
        descriptor = ParameterDescriptor(description=description, read_only=True)
        if bounds and isinstance(default, int):
            descriptor.integer_range = [IntegerRange(from_value=int(bounds[0]), to_value=int(bounds[1]))]
        elif bounds:
            descriptor.floating_point_range = [FloatingPointRange(from_value=bounds[0], to_value=bounds[1])]
        declared = _MANDATORY[default] if isinstance(default, type) else default
        try:
            value = self._node.declare_parameter(name, declared, descriptor).value
        except Exception as error:  # noqa: BLE001  rclpy raises several unrelated types for a wrong type or range
            message = f"{name}: {error} ({description})"
            raise ConfigurationError(message) from None
        if value is None:
            message = f"{name}: found nothing, needed is: {description}"
            raise ConfigurationError(message)
        return value

    def resolved_topic(self, name: str, topic: str) -> str:
        """Return the full name of a topic after ROS's remapping (see `ParameterSource`)."""
        try:
            resolved: str = self._node.resolve_topic_name(topic)
        except RuntimeError as error:
            message = f"{name}: found {topic!r}, allowed is a topic's name ({error})"
            raise ConfigurationError(message) from None
        self.topics[name] = resolved
        return resolved


def refuse_unknown_parameters(node: Node, *, also_known: Iterable[str] = ()) -> None:
    """Refuse parameters that a file or the command line sets and the node lacks. ROS would ignore them.

    Args:
        node: a node that has declared all of its own parameters.
        also_known: parameters of another node, which may be in the same file.

    Raises:
        ConfigurationError: there is such a parameter. The message names each, with the most similar known
            one.
    """
    # rclpy has no public way to ask what was given and not declared.
    known = {*node._parameters, *also_known}  # noqa: SLF001
    given = sorted(name for name in node._parameter_overrides if not _OF_ROS.fullmatch(name))  # noqa: SLF001
    unknown = [name for name in given if name not in known]
    if unknown:
        raise ConfigurationError("\n".join(_unknown(name, known, node) for name in unknown))


def _unknown(name: str, known: set[str], node: Node) -> str:
    kind, _, rest = name.partition(".")
    listing = {"body": "bodies", "surface": "surfaces"}.get(kind)
    if listing and rest:
        own_name = rest.rpartition(".")[0] or rest
        listed = [each for each in node.get_parameter(listing).value if each]
        if own_name not in listed:
            return f"{name}: found {kind} {own_name!r}, allowed is one that {listing} lists: {listed}"
    nearest = difflib.get_close_matches(name, known, n=1, cutoff=0.0)
    return f"{name}: there is no such parameter; the nearest is {nearest[0]}"
