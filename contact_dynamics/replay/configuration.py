"""A configuration can be given beside a recording: a file of parameters, and topics on the command line."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from contact_dynamics.nodes.parameter_file import ParameterFile
from contact_dynamics.nodes.parameter_reader import ConfigurationError

if TYPE_CHECKING:
    from collections.abc import Sequence
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

    def refuse_unknown(self) -> None:
        """Refuse parameters of the file that nothing has read; see `ParameterSource`."""
        self._file.refuse_unknown()


def _topics(text: str) -> dict[str, str]:
    body, _, names = text.partition("=")
    found = names.split(",")
    if not body or not all(found) or len(found) > 2:
        message = f"--topics: found {text!r}, allowed are BODY=ODOMETRY and BODY=POSE,TWIST"
        raise ConfigurationError(message)
    odometry, pose, twist = ("", *found) if len(found) == 2 else (found[0], "", "")
    key = f"body.{body}"
    return {f"{key}.odometry_topic": odometry, f"{key}.pose_topic": pose, f"{key}.twist_topic": twist}
