# SPDX-License-Identifier: Apache-2.0
"""Values by the names of parameters, as the source of the server's parameters, without ROS."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from contact_dynamics.nodes.argument_values import IN_WORDS
from contact_dynamics.nodes.parameter_reader import ConfigurationError, DeclaredParameter
from contact_dynamics.nodes.run_record import NODE_NAME
from contact_dynamics.nodes.unknown_parameters import likely_misspelling, qos_overrides_of, refuse_unknown

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Mapping


class GivenParameters:
    """Values that are given; a `ParameterSource`.

    Attributes:
        values: Plain values by the parameters' names.
        read: The parameters that were read from it, by name, with their values.
    """

    def __init__(
        self,
        values: Mapping[str, Any],
        *,
        origin: str = "",
        also_known: Iterable[str] = (),
        resolve: Callable[[str, str], str] | None = None,
    ) -> None:
        """Take the values.

        Args:
            values: plain values by the parameters' names.
            origin: where they come from, which begins each complaint.
            also_known: names that may be given although nothing reads them.
            resolve: finds the full name of a topic, as `resolved_topic`. Without it, nothing is remapped.
        """
        self.values = values
        self._before = f"{origin}: " if origin else ""
        self._also_known = frozenset(also_known)
        self._resolve = resolve
        self.read: dict[str, DeclaredParameter] = {}
        self._topics: set[str] = set()

    def value(
        self, name: str, default: Any, description: str, bounds: tuple[float, float] | None = None
    ) -> Any:
        """Return a parameter's value; see `ParameterSource`."""
        found = self.values.get(name)
        if found is None and not isinstance(default, type):
            found = default
        wanted = default if isinstance(default, type) else type(default)
        if not isinstance(found, wanted) or (isinstance(found, bool) and wanted is not bool):
            meant = likely_misspelling(name, self.values) if found is None else ""
            problem = "is required" if found is None else f"must be {IN_WORDS[wanted]}, got {found!r}"
            message = f"{self._before}{name} {problem} ({description}){meant}"
            raise ConfigurationError(message)
        number: Any = found  # it has the default's type, which is a number where there are bounds
        if bounds is not None and not bounds[0] <= number <= bounds[1]:
            message = f"{self._before}{name} must be in [{bounds[0]:g}, {bounds[1]:g}], got {found!r}"
            raise ConfigurationError(message)
        self.read[name] = DeclaredParameter(name, found, description, bounds)
        return found

    def resolved_topic(self, name: str, topic: str) -> str:
        """Return the full name of a topic; see `ParameterSource`."""
        if self._resolve is not None:
            resolved = self._resolve(name, topic)
        elif topic.startswith("~"):
            resolved = f"/{NODE_NAME}{topic[1:]}"
        else:
            resolved = topic if topic.startswith("/") else f"/{topic}"
        self._topics.add(resolved)
        return resolved

    def refuse_unknown(self, early: Collection[str] | None = None) -> None:
        """Refuse parameters that nothing has read; see `ParameterSource`."""
        known = {*self.read, *self._also_known, *qos_overrides_of(self._topics)}
        try:
            refuse_unknown(self.values, known, lambda name: self.values.get(name, []), early)
        except ConfigurationError as error:
            message = f"{self._before}{error}"
            raise ConfigurationError(message) from None
