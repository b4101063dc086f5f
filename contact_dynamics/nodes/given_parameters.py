# SPDX-License-Identifier: Apache-2.0
"""Values by the names of parameters, as the source of the server's parameters, without ROS.

In a file of parameters, as ROS takes it, those sections count that ROS gives to the node
``contact_dynamics``. A later one counts more than an earlier. Nested names are joined by points:
``body: {brick: {mass: 0.4}}`` is ``body.brick.mass``.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.nodes.parameter_mistakes import (
    IN_WORDS,
    check_sections,
    likely_misspelling,
    qos_overrides_of,
    read_sections,
    refuse_unknown,
)
from contact_dynamics.nodes.parameter_reader import NODE_NAME, ConfigurationError, DeclaredParameter
from contact_dynamics.nodes.visualizer_parameters import VISUALIZER_PARAMETERS

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path


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


_NODE: Final = f"/{NODE_NAME}"


class ParameterFile(GivenParameters):
    """The values in a file, with other topics for some bodies; a `ParameterSource`."""

    def __init__(self, path: Path, topics: Sequence[str] = ()) -> None:
        """Read the file.

        Args:
            path: a file of parameters, as `config/server.yaml`.
            topics: where states are, as "BODY=ODOMETRY_TOPIC" or "BODY=POSE_TOPIC,TWIST_TOPIC". This counts
                before what the file says.

        Raises:
            ConfigurationError: it is missing, no YAML, or has no parameters of the server; or it has those of
                a node whose name is nearly the server's; or a text in ``topics`` has another form.
        """
        sections = read_sections(path)
        warning = check_sections(path, sections, _NODE)
        if warning:
            raise ConfigurationError(warning)  # nobody else is configured by what is read here
        values: dict[str, Any] = {}
        for section in sections:
            if section.is_for(_NODE):
                values.update(_flat(section.values))
        for text in topics:
            values.update(_topics(text))
        # One file may configure both nodes.
        super().__init__(values, origin=str(path), also_known=VISUALIZER_PARAMETERS)


def _flat(given: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in given.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


def values_of(config: Path | None, settings: Sequence[str]) -> dict[str, Any]:
    """Return the values of a file of parameters and of texts "name:=value", which count more.

    Raises:
        ConfigurationError: the file has no parameters, or a text has another form.
    """
    values = {} if config is None else dict(ParameterFile(config).values)
    for text in settings:
        name, separator, value = text.partition(":=")
        if not name or not separator:
            message = f"--set must be NAME:=VALUE, got {text!r}"
            raise ConfigurationError(message)
        try:
            values[name] = json.loads(value)
        except ValueError:
            values[name] = value
    return values


def _topics(text: str) -> dict[str, str]:
    body, _, names = text.partition("=")
    found = names.split(",")
    if not body or not all(found) or len(found) > 2:
        message = f"--topics must be BODY=ODOMETRY or BODY=POSE,TWIST, got {text!r}"
        raise ConfigurationError(message)
    odometry, pose, twist = ("", *found) if len(found) == 2 else (found[0], "", "")
    key = f"body.{body}"
    return {f"{key}.odometry_topic": odometry, f"{key}.pose_topic": pose, f"{key}.twist_topic": twist}
