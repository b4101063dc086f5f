# SPDX-License-Identifier: Apache-2.0
"""A file of parameters, as ROS takes it, as the source of the server's parameters, without ROS.

Those sections count that ROS gives to the node ``contact_dynamics``. A later one counts more than an earlier.
Nested names are joined by points: ``body: {brick: {mass: 0.4}}`` is ``body.brick.mass``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.nodes.given_parameters import GivenParameters
from contact_dynamics.nodes.parameter_reader import ConfigurationError
from contact_dynamics.nodes.parameter_sections import check_sections, read_sections
from contact_dynamics.nodes.run_record import NODE_NAME
from contact_dynamics.nodes.visualizer_parameters import VISUALIZER_PARAMETERS

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_NODE: Final = f"/{NODE_NAME}"


class ParameterFile(GivenParameters):
    """The values in a file; a `ParameterSource`."""

    def __init__(self, path: Path) -> None:
        """Read the file.

        Raises:
            ConfigurationError: it is missing, no YAML, or has no parameters of the server; or it has those of
                a node whose name is nearly the server's.
        """
        sections = read_sections(path)
        warning = check_sections(path, sections, _NODE)
        if warning:
            raise ConfigurationError(warning)  # nobody else is configured by what is read here
        values: dict[str, Any] = {}
        for section in sections:
            if section.is_for(_NODE):
                values.update(_flat(section.values))
        # One file may configure both nodes.
        super().__init__(values, origin=str(path), also_known=VISUALIZER_PARAMETERS)


def _flat(given: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in given.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value
