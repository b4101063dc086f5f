"""A file of parameters, as ROS takes it, as the source of the server's parameters, without ROS.

Parameters of ``/**`` and of the node ``contact_dynamics`` count, the latter more. Nested names are joined by
points: ``body: {brick: {mass: 0.4}}`` is ``body.brick.mass``.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.nodes.parameters import ConfigurationError
from contact_dynamics.nodes.run_record import NODE_NAME

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_NODES: Final = ("/**", NODE_NAME, f"/{NODE_NAME}")


class ParameterFile:
    """The values in a file; a `ParameterSource`."""

    def __init__(self, path: Path) -> None:
        """Read the file.

        Raises:
            ConfigurationError: it is missing, no YAML, or has no parameters of the server.
        """
        self._path = path
        self._values: dict[str, Any] = {}
        content = _content(path)
        nodes = [name for name in _NODES if isinstance(content, dict) and name in content]
        if not nodes:
            message = f"{path}: found no parameters, needed are those of {_NODES[0]} or {NODE_NAME}"
            raise ConfigurationError(message)
        for name in nodes:
            given = content[name]
            if not isinstance(given, dict) or not isinstance(given.get("ros__parameters"), dict):
                message = f"{path}: {name}: found no ros__parameters, needed are names with values"
                raise ConfigurationError(message)
            self._values.update(_flat(given["ros__parameters"]))

    def value(
        self, name: str, default: Any, description: str, bounds: tuple[float, float] | None = None
    ) -> Any:
        """Return a parameter's value; see `ParameterSource`."""
        found = self._values.get(name)
        if found is None and not isinstance(default, type):
            return default
        wanted = default if isinstance(default, type) else type(default)
        if not isinstance(found, wanted) or (isinstance(found, bool) and wanted is not bool):
            message = f"{self._path}: {name}: found {found!r}, needed is: {description}"
            raise ConfigurationError(message)
        number: Any = found  # it has the default's type, which is a number where there are bounds
        if bounds is not None and not bounds[0] <= number <= bounds[1]:
            message = f"{self._path}: {name}: found {found!r}, allowed is {bounds[0]:g} to {bounds[1]:g}"
            raise ConfigurationError(message)
        return found

    def resolved_topic(self, name: str, topic: str) -> str:  # noqa: ARG002  a file remaps nothing
        """Return the full name of a topic; see `ParameterSource`."""
        if topic.startswith("~"):
            return f"/{NODE_NAME}{topic[1:]}"
        return topic if topic.startswith("/") else f"/{topic}"


def _content(path: Path) -> Any:
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        message = f"{path}: cannot be read: {error}"
        raise ConfigurationError(message) from None
    try:
        return json.loads(text)  # JSON is YAML, and needs nothing that is not installed
    except ValueError:
        pass
    try:
        import yaml  # comes with ROS, and with the extra [evaluate]
    except ImportError:
        message = f"{path}: to read YAML, PyYAML is needed: pip install '.[evaluate]'"
        raise ConfigurationError(message) from None
    try:
        return yaml.safe_load(text)
    except yaml.YAMLError as error:
        message = f"{path}: no YAML: {error}"
        raise ConfigurationError(message) from None


def _flat(given: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in given.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value
