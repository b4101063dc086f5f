# SPDX-License-Identifier: Apache-2.0
"""A configuration can be given beside a recording: a file of parameters, and values on the command line."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from contact_dynamics.nodes.given_parameters import GivenParameters
from contact_dynamics.nodes.parameter_file import ParameterFile
from contact_dynamics.nodes.parameter_reader import ConfigurationError
from contact_dynamics.nodes.run_record import LoggedParameters
from contact_dynamics.nodes.unknown_parameters import refuse_unknown
from contact_dynamics.nodes.visualizer_parameters import VISUALIZER_PARAMETERS

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence
    from pathlib import Path


class Configuration:
    """The parameters in a file, with other topics for some bodies; a `ParameterSource`."""

    def __init__(self, path: Path, topics: Sequence[str] = ()) -> None:
        """Read the file.

        Args:
            path: a file of parameters, as `config/server.yaml`.
            topics: where states are, as "BODY=ODOMETRY_TOPIC" or "BODY=POSE_TOPIC,TWIST_TOPIC". This counts
                before what the file says.

        Raises:
            ConfigurationError: the file has no parameters, or a text in ``topics`` has another form.
        """
        self._file = ParameterFile(path)
        self._topics: dict[str, str] = {}
        for text in topics:
            self._topics |= _topics(text)

    def value(
        self, name: str, default: Any, description: str, bounds: tuple[float, float] | None = None
    ) -> Any:
        """Return a parameter's value; see `ParameterSource`."""
        found = self._file.value(name, default, description, bounds)
        return self._topics.get(name, found)

    def resolved_topic(self, name: str, topic: str) -> str:
        """Return the full name of a topic; see `ParameterSource`."""
        return self._file.resolved_topic(name, topic)

    def refuse_unknown(self, early: Collection[str] | None = None) -> None:
        """Refuse parameters of the file that nothing has read; see `ParameterSource`."""
        self._file.refuse_unknown(early)


class ChangedRun(LoggedParameters):
    """The record of a run with other values for some parameters; a `ParameterSource`.

    These values count from the log's beginning to its end, also where the log tells of a change of theirs.
    """

    def __init__(self, run: Mapping[str, str], instead: Mapping[str, Any]) -> None:
        """Take the record, and the values that count instead of its own."""
        super().__init__(run)
        self._instead = dict(instead)
        self._read: set[str] = set()

    def changed(self, values: Mapping[str, Any]) -> LoggedParameters:
        """Return the parameters after a change that the log tells of; see `LoggedParameters.changed`."""
        return ChangedRun(super().changed(values).record, self._instead)

    def value(
        self, name: str, default: Any, description: str, bounds: tuple[float, float] | None = None
    ) -> Any:
        """Return a parameter's value; see `ParameterSource`."""
        self._read.add(name)
        if name not in self._instead:
            return super().value(name, default, description, bounds)
        value = self._instead[name]
        wanted = default if isinstance(default, type) else type(default)
        if wanted is float and type(value) is int:
            value = float(value)
        return GivenParameters({name: value}).value(name, default, description, bounds)

    def resolved_topic(self, name: str, topic: str) -> str:
        """Return the full name of a topic; see `ParameterSource`."""
        if name in self._instead:
            return GivenParameters({}).resolved_topic(name, topic)
        return super().resolved_topic(name, topic)

    def refuse_unknown(self, early: Collection[str] | None = None) -> None:
        """Refuse values of parameters that the server does not have; see `ParameterSource`."""
        known = {*self._read, *VISUALIZER_PARAMETERS}
        refuse_unknown(self._instead, known, lambda name: self._instead.get(name, []), early)


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
