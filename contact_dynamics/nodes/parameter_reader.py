# SPDX-License-Identifier: Apache-2.0
"""Reads the parameters of the nodes, and rejects invalid values and unknown names.

This file imports no ROS. The values come from a node (`node_parameters`), from a file (`parameter_file`), or
from the log of an earlier run (`run_record`).
"""

from __future__ import annotations

import difflib
import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final, NamedTuple, TypeVar

from contact_dynamics.errors import ContactDynamicsError, InvalidFieldError
from contact_dynamics.world import LONGEST_NAME
from msg_adapters.field_names import renamed

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Mapping

T = TypeVar("T")

NODE_NAME: Final = "contact_dynamics"  # the name of the server's node


class ConfigurationError(ContactDynamicsError):
    """A parameter is missing or invalid. The message names it."""


class DeclaredParameter(NamedTuple):
    """A parameter as it is declared or read, in the order of the arguments of `ParameterSource.value`."""

    name: str  # its name
    value: Any  # its default, or the value that was read
    description: str  # its description
    bounds: tuple[float, float] | None = None  # its smallest and largest value, or None


@dataclass(frozen=True, slots=True, kw_only=True)
class ConfiguredTopic:
    """A topic as it is configured."""

    name: str  # its name in the configuration
    full_name: str  # its name after ROS's remapping
    parameter: str  # the parameter that names it


class ParameterSource:
    """Values of parameters. Reading an invalid one raises a `ConfigurationError`.

    Attributes:
        values: Plain values by the parameters' names.
        read: The parameters read so far, by name, with their values.
        topics: The full names of the topics read so far, by parameter.
    """

    def __init__(
        self,
        values: Mapping[str, Any],
        *,
        origin: str = "",
        also_known: Iterable[str] = (),
        resolve: Callable[[str, str], str] | None = None,
    ) -> None:
        """Set the values.

        Args:
            values: values by the parameters' names.
            origin: prefix of each error message.
            also_known: names of parameters that are allowed but not read.
            resolve: returns the full name of a topic, like `resolved_topic`, which remaps nothing.
        """
        self.values = values
        self.read: dict[str, DeclaredParameter] = {}
        self.topics: dict[str, str] = {}
        self._before = f"{origin}: " if origin else ""
        self._also_known = frozenset(also_known)
        self._resolve = resolve
        self._single_topics: dict[str, str] = {}  # the parameter of each topic that only one may name

    def value(
        self, name: str, default: Any, description: str, bounds: tuple[float, float] | None = None
    ) -> Any:
        """Return a parameter's value, which has the type of the default.

        The default `float` makes the parameter mandatory; the ``bounds`` are the smallest and largest value.
        Raise `ConfigurationError` if the value is missing, has another type, or is out of bounds.
        """
        found = self.values.get(name)
        if found is None and default is float:
            raise ConfigurationError(f"{self._before}{name} is required ({description})")
        value, allowed = _as_default(default if found is None else found, default)
        if not allowed and bounds is not None and not bounds[0] <= value <= bounds[1]:
            allowed = f"in [{bounds[0]:g}, {bounds[1]:g}]"
        if allowed:
            raise ConfigurationError(f"{self._before}{name} must be {allowed} ({description}), got {found!r}")
        self.read[name] = DeclaredParameter(name, value, description, bounds)
        return value

    def zero_or(
        self, name: str, default: float, description: str, bounds: tuple[float, float], *, unit: str
    ) -> float | None:
        """Return a number within bounds, or None if it is zero."""
        least, most = bounds
        found: float = self.value(name, default, description, (0.0, most))
        if 0.0 < found < least:
            message = f"{name} must be 0 or in [{least:g}, {most:g}] {unit}, got {found:g} {unit}"
            raise ConfigurationError(message)
        return found or None

    def filled(
        self, default: T, names: Mapping[str, str] | None = None, /, **fields: tuple[str, tuple[float, float]]
    ) -> T:
        """Return a dataclass whose fields are parameters, with the defaults in ``default``.

        ``fields`` contains the description and the bounds of each, and ``names`` the parameter's name of each
        field that has another name.
        """
        values = {
            field: self.value((names or {}).get(field, field), getattr(default, field), description, bounds)
            for field, (description, bounds) in fields.items()
        }
        return replace(default, **values)  # type: ignore[type-var]  # only dataclasses are given

    def name(self, name: str, default: str, description: str) -> str:
        """Return a name, which must not be empty."""
        return _checked_name(name, self.value(name, default, description))

    def names(self, name: str, description: str) -> list[str]:
        """Return the names in a list. A single empty name means none, since ROS has no empty lists."""
        given: list[str] = self.value(name, [""], description)
        if given == [""]:
            return []
        found = [_checked_name(f"{name}[{i}]", each) for i, each in enumerate(given)]
        if len(set(found)) < len(found):
            raise ConfigurationError(f"{name} must be different names, got {found}")
        return found

    def topic(self, name: str, description: str) -> ConfiguredTopic | None:
        """Return a topic, which no other parameter may have, or None if the parameter is empty."""
        topic: str = self.value(name, "", description)
        if not topic:
            return None
        found = self._configured(name, topic)
        other = self._single_topics.setdefault(found.full_name, name)
        if other != name:
            raise ConfigurationError(f"{name} must be another topic than that of {other}, got {topic!r}")
        return found

    def topics_of(self, name: str, description: str) -> tuple[ConfiguredTopic, ...]:
        """Return the topics in a list, which several bodies may share."""
        return tuple(
            self._configured(f"{name}[{i}]", topic) for i, topic in enumerate(self.names(name, description))
        )

    def _configured(self, parameter: str, topic: str) -> ConfiguredTopic:
        full_name = self.resolved_topic(parameter, topic)
        return ConfiguredTopic(name=topic, full_name=full_name, parameter=parameter)

    def resolved_topic(self, name: str, topic: str) -> str:
        """Return the full name of the topic in a parameter, or raise `ConfigurationError`."""
        if self._resolve is not None:
            resolved = self._resolve(name, topic)
        elif topic.startswith("~"):
            resolved = f"/{NODE_NAME}{topic[1:]}"
        else:
            resolved = topic if topic.startswith("/") else f"/{topic}"
        self.topics[name] = resolved
        return resolved

    @staticmethod
    def build(prefix: str, make: Callable[[], T]) -> T:
        """Return what ``make`` builds. Errors name a field as the parameter ``prefix.field``."""
        try:
            return make()
        except InvalidFieldError as error:
            told = renamed(error)
            message = f"{prefix}.{told}" if prefix else str(told)
            raise ConfigurationError(message) from None

    def refuse_unknown(self, known: Iterable[str]) -> None:
        """Reject unknown parameters, except for overrides of the quality of service.

        Raise `ConfigurationError` with the most similar known names.
        """
        given = [name for name in self.values if not is_of_ros(name)]
        self._refuse_others(given, {*known, *self._also_known})

    def refuse_unknown_overrides(self) -> None:
        """Reject overrides of the quality of service of topics that were not read, as above."""
        overrides = {
            f"{_QOS}.{topic}.subscription.{policy}" for topic in self.topics.values() for policy in _POLICIES
        }
        given = [name for name in self.values if name.startswith(f"{_QOS}.")]
        self._refuse_others(given, {*self.read, *self._also_known, *overrides})

    def _refuse_others(self, given: Iterable[str], known: Collection[str]) -> None:
        unknown = sorted(name for name in given if name not in known)
        if unknown:
            told = "\n".join(self._unknown(name, known) for name in unknown)
            raise ConfigurationError(f"{self._before}{told}")

    def _unknown(self, name: str, known: Collection[str]) -> str:
        kind, _, rest = name.partition(".")
        listing = _LISTED_BY.get(kind)
        if listing and rest:
            own_name = rest.rpartition(".")[0] or rest
            allowed = [each for each in self.values.get(listing, []) if each]
            if not {own_name, own_name.rpartition(".")[0]} & {*allowed}:  # a part has one more name
                return (
                    f"{name} must be about one of the names in {listing} {allowed}, got {kind} {own_name!r}"
                )
        group, _, last = name.rpartition(".")
        meant = f"{group}.{_MEANT.get(last, '')}"
        nearest = meant if meant in known else difflib.get_close_matches(name, known, n=1, cutoff=0.0)[0]
        return f"{name}: there is no such parameter; the nearest is {nearest}"


_IN_WORDS: Final = {
    bool: "true or false",
    int: "a whole number",
    float: "a number",
    str: "a text",
    list: "a list, such as [1.0]",
}
"""The types of parameters in errors."""


def _as_default(value: Any, default: Any) -> tuple[Any, str]:
    """Return a value as the type of a default, and the allowed type in words if it has another one."""
    kind: type[Any] = default if isinstance(default, type) else type(default)
    if kind is float and type(value) is int:
        return float(value), ""
    if type(value) is not kind:
        return value, _IN_WORDS[kind]
    if kind is list and default:
        found = [_as_default(each, default[0]) for each in value]
        wrong = next((allowed for _, allowed in found if allowed), "")
        return [each for each, _ in found], f"a list of which each is {wrong}" if wrong else ""
    return value, ""


def _checked_name(parameter: str, name: str) -> str:
    if name and name == name.strip() and len(name) <= LONGEST_NAME:
        return name
    allowed = f"a name of 1 to {LONGEST_NAME} letters, without blanks around it"
    raise ConfigurationError(str(InvalidFieldError(parameter, repr(name), allowed)))


_OF_ROS: Final = re.compile(r"use_sim_time|start_type_description_service")
_QOS: Final = "qos_overrides"
_POLICIES: Final = ("history", "depth", "reliability")
"""The policies of a subscription that parameters can override by default."""
_MEANT: Final = {"radius": "sphere", "size": "box", "com": "center_of_mass", "mu": "friction"}
"""Names of parameters in other software, with ours."""
_LISTED_BY: Final = {"body": "bodies", "surface": "surfaces"}


def is_of_ros(name: str) -> bool:
    """Return whether a parameter is one that every node of ROS has."""
    return _OF_ROS.fullmatch(name) is not None or name.startswith(f"{_QOS}.")
