# SPDX-License-Identifier: Apache-2.0
"""Writes how a run was configured as text into its log, and reads it back without ROS.

`PARAMETERS` and `TOPICS` are JSON, so that a number, a text and a list stay what they are, to the last bit.
Logs before 0.1.0 have each parameter under its own name instead, as Python prints it.
"""

from __future__ import annotations

import ast
import json
import platform
import re
from importlib.metadata import version
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.nodes.parameter_reader import ConfigurationError
from contact_dynamics.version import version_of_this_package

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

PARAMETERS: Final = "parameters"
"""The key of the node's parameters, which are a JSON object by name."""

TOPICS: Final = "state_topics"
"""The key of the full names of the topics of states, which are a JSON object by parameter."""

NODE_NAME: Final = "contact_dynamics"

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
    """The record of a run as the source of its parameters, as a `ParameterSource`.

    Attributes:
        record: The record.
    """

    def __init__(self, run: Mapping[str, str]) -> None:
        """Read a record that `run_record` or an older server wrote.

        Raises:
            ConfigurationError: no server wrote this record.
        """
        self.record = run
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
        return LoggedParameters({PARAMETERS: json.dumps(after), TOPICS: json.dumps(self._topics)})

    def value(
        self,
        name: str,
        default: Any,
        description: str,
        bounds: tuple[float, float] | None = None,  # noqa: ARG002  the server judged them
    ) -> Any:
        """Return a parameter's value, or its default if the server lacked it (see `ParameterSource`)."""
        if self._values is not None:
            found = self._values.get(name)
        else:
            found = _from_text(name, self.record[name], default) if name in self.record else None
        if found is None and not isinstance(default, type):
            return default
        wanted = default if isinstance(default, type) else type(default)
        if not isinstance(found, wanted):
            message = f"{name} is required ({description}), got {found!r} in the log"
            raise ConfigurationError(message)
        return found

    def resolved_topic(self, name: str, topic: str) -> str:
        """Return the full name under which a topic was logged (see `ParameterSource`)."""
        if name in self._topics:
            return self._topics[name]
        if topic.startswith("~"):
            return f"/{NODE_NAME}{topic[1:]}"
        return topic if topic.startswith("/") else f"/{topic}"

    def refuse_unknown(self, early: Collection[str] | None = None) -> None:
        """Do nothing: another version of the server may have had other parameters (see `ParameterSource`)."""


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
