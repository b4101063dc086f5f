# SPDX-License-Identifier: Apache-2.0
"""Reads parameters from a source, and refuses what is not allowed by the parameter's name.

This file imports no ROS. The values come from a `ParameterSource`: a node (`node_parameters`), or the log of
a run that is over (`run_record`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final, NamedTuple, Protocol, TypeVar

from contact_dynamics.errors import ContactDynamicsError, InvalidFieldError
from contact_dynamics.world import LONGEST_NAME
from msg_adapters.field_names import renamed

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping

T = TypeVar("T")

NODE_NAME: Final = "contact_dynamics"
"""The name of the server's node."""


class ConfigurationError(ContactDynamicsError):
    """A parameter is missing or not allowed. The message names it."""


class DeclaredParameter(NamedTuple):
    """A parameter as it is declared or read, in the order of the arguments of `ParameterSource.value`.

    Attributes:
        name: Its name.
        value: Its default, or the value that was read.
        description: What it means, for people.
        bounds: Its least and greatest value, if it has any.
    """

    name: str
    value: Any
    description: str
    bounds: tuple[float, float] | None = None


class ParameterSource(Protocol):
    """A source of the values of parameters."""

    def value(
        self, name: str, default: Any, description: str, bounds: tuple[float, float] | None = None
    ) -> Any:
        """Return a parameter's value, which has the type of the default.

        Args:
            name: the name of the parameter.
            default: its value if none is given. A type, `float` or `list`, makes the parameter mandatory.
            description: what it means, for people.
            bounds: least and greatest value.

        Raises:
            ConfigurationError: there is no value, or it has another type or is out of bounds.
        """

    def resolved_topic(self, name: str, topic: str) -> str:
        """Return the full name of the topic that a parameter names.

        Raises:
            ConfigurationError: the name is not that of a topic.
        """

    def refuse_unknown(self, early: Collection[str] | None = None) -> None:
        """Refuse parameters that are given and that nothing has read.

        Args:
            early: the names of all parameters, where an error has left some unread.

        Raises:
            ConfigurationError: there are such. The message names each, with the most similar known one.
        """


@dataclass(frozen=True, slots=True, kw_only=True)
class ConfiguredTopic:
    """A topic as it is configured.

    Attributes:
        name: Its name in the configuration.
        full_name: Its name after ROS's remapping.
        parameter: The parameter that names it.
    """

    name: str
    full_name: str
    parameter: str


class ParameterReader:
    """Reads parameters from a source. Every mistake becomes a `ConfigurationError`."""

    def __init__(self, source: ParameterSource) -> None:
        self._source = source
        self.read = source.value
        self._topics: dict[str, str] = {}  # the parameter of each topic, by the topic's full name

    def zero_or(
        self, name: str, default: float, description: str, bounds: tuple[float, float], *, unit: str
    ) -> float | None:
        """Return a number within bounds, or None for zero, which stands for none."""
        least, most = bounds
        found: float = self.read(name, default, description, (0.0, most))
        if 0.0 < found < least:
            message = f"{name} must be 0 or in [{least:g}, {most:g}] {unit}, got {found:g} {unit}"
            raise ConfigurationError(message)
        return found or None

    def filled(
        self,
        default: T,
        names: Mapping[str, str] | None = None,
        /,
        **fields: tuple[str, tuple[float, float]],
    ) -> T:
        """Return a dataclass whose fields are parameters, with the values of ``default`` as theirs.

        Args:
            default: The defaults.
            names: The parameter of each field that is not named as the field is.
            fields: The description and the bounds of each.
        """
        values = {
            field: self.read((names or {}).get(field, field), getattr(default, field), description, bounds)
            for field, (description, bounds) in fields.items()
        }
        return replace(default, **values)  # type: ignore[type-var]  # only dataclasses are given

    def name(self, name: str, default: str, description: str) -> str:
        """Return a name of something, which cannot be empty."""
        return _checked_name(name, self.read(name, default, description))

    def names(self, name: str, description: str) -> list[str]:
        """Return the names in a list. An empty one alone stands for none, since ROS knows no empty lists."""
        given: list[str] = self.read(name, [""], description)
        if given == [""]:
            return []
        found = [_checked_name(f"{name}[{i}]", each) for i, each in enumerate(given)]
        if len(set(found)) < len(found):
            message = f"{name} must be different names, got {found}"
            raise ConfigurationError(message)
        return found

    def topic(self, name: str, description: str) -> ConfiguredTopic | None:
        """Return a topic that no other parameter names, or None if there is none."""
        topic: str = self.read(name, "", description)
        if not topic:
            return None
        found = self._configured(name, topic)
        if found.full_name in self._topics:
            message = (
                f"{name} must be another topic than that of {self._topics[found.full_name]}, got {topic!r}"
            )
            raise ConfigurationError(message)
        self._topics[found.full_name] = name
        return found

    def topics(self, name: str, description: str) -> tuple[ConfiguredTopic, ...]:
        """Return the topics of a list, which several bodies may share."""
        return tuple(
            self._configured(f"{name}[{i}]", topic) for i, topic in enumerate(self.names(name, description))
        )

    def _configured(self, parameter: str, topic: str) -> ConfiguredTopic:
        full_name = self._source.resolved_topic(parameter, topic)
        return ConfiguredTopic(name=topic, full_name=full_name, parameter=parameter)

    @staticmethod
    def build(prefix: str, make: Callable[[], T]) -> T:
        """Return what ``make`` builds. A field that it refuses is named as the parameter ``prefix.field``."""
        try:
            return make()
        except InvalidFieldError as error:
            told = renamed(error)
            message = f"{prefix}.{told}" if prefix else str(told)
            raise ConfigurationError(message) from None


def _checked_name(parameter: str, name: str) -> str:
    if name and name == name.strip() and len(name) <= LONGEST_NAME:
        return name
    allowed = f"a name of 1 to {LONGEST_NAME} letters, without blanks around it"
    raise ConfigurationError(str(InvalidFieldError(parameter, repr(name), allowed)))
