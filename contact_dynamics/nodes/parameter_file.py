# SPDX-License-Identifier: Apache-2.0
"""Reads parameter files without ROS, and finds mistakes in them that ROS does not report.

ROS passes a node the parameters of all sections that match its full name, and ignores other sections
silently, such as one with a misspelled name. YAML forbids repeated keys, but ROS silently uses the last one.
Later sections override earlier ones. Nested names are joined by points: ``body: {brick: {mass: 0.4}}`` is
``body.brick.mass``.
"""

from __future__ import annotations

import difflib
import json
import re
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from contact_dynamics.nodes.links import with_links_read
from contact_dynamics.nodes.other_parameters import PARAMETERS_OF_OTHERS
from contact_dynamics.nodes.parameter_reader import NODE_NAME, ConfigurationError, ParameterSource

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

ANY_NODE: Final = "/**"  # the name of a section that is for every node

_VALUES: Final = "ros__parameters"
_MERGE: Final = "<<"  # a key of YAML
_ALIKE: Final = 0.9  # share of equal letters; a name of 16 letters with two swapped letters has 0.94
_NUMBER: Final = re.compile(r"[_\d]+$")
_FILE: Final = "--params-file"
_GIVEN: Final = re.compile(r"(?:([^:=]+):)?([^:=]+):=(.*)", re.DOTALL)


class Section(NamedTuple):
    """The parameters for the nodes of one name."""

    node: str  # The name as ROS understands it, with a leading slash. It may have `*` and `/**`.
    values: dict[str, Any]  # the values by their names, which may be nested
    repeated: tuple[str, ...] = ()  # a sentence for each parameter that it contains more than once

    def is_for(self, full_name: str) -> bool:
        """Return whether a node of this full name gets the parameters."""
        # The replacement turns "/**" into "(/\w+)*".
        return re.fullmatch(self.node.replace("/*", r"(/\w+)"), full_name) is not None


def read_sections(path: Path) -> tuple[Section, ...]:
    """Return the sections of a file.

    Raise `ConfigurationError` if it cannot be read, is not YAML, or does not consist of different sections.
    """
    import yaml  # only nodes with a parameter file need it

    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigurationError(f"{path}: cannot be read: {error}") from None
    try:
        loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)(text)  # ten times as fast
        root = loader.get_single_node()
        if _items(root):
            return tuple(_sections(path, root, "", construct=loader.construct_document))
    except yaml.YAMLError as error:
        raise ConfigurationError(f"{path}: no YAML: {error}") from None
    raise ConfigurationError(f"{path} must have parameters of {ANY_NODE} or of a node by its name, got none")


def _sections(
    path: Path, mapping: Any, above: str, *, construct: Callable[[Any], dict[str, Any]]
) -> Iterator[Section]:
    """Yield the sections in a mapping of names, which is a node of PyYAML."""
    lines: dict[str, int] = {}
    for key, inner in mapping.value:
        name, line = f"{above}{absolute(str(key.value))}", key.start_mark.line + 1
        if lines.setdefault(name, line) != line:
            message = f"{path}: {name.lstrip('/')} must appear once, got lines {lines[name]} and {line}"
            raise ConfigurationError(message)
        parameters = [value for key, value in _items(inner) if key.value == _VALUES]
        if parameters and parameters[0].id == "mapping":
            yield Section(name, construct(parameters[0]), tuple(_repeated(parameters[0])))
        elif _items(inner) and not parameters:
            yield from _sections(path, inner, name, construct=construct)
        else:
            raise ConfigurationError(f"{path}: {name.lstrip('/')} must have {_VALUES} (names with values)")


def _items(node: Any) -> list[tuple[Any, Any]]:
    """Return the keys and values of a node of PyYAML, or none if it is not a mapping."""
    return node.value if getattr(node, "id", "") == "mapping" else []


def _repeated(parameters: Any) -> Iterator[str]:
    """Yield a sentence for each parameter, or group of parameters, that a section contains more than once.

    ``body.brick.mass: 1.0`` and ``body: {brick: {mass: 2.0}}`` are the same parameter. A group may be written
    in both ways.
    """
    lines: dict[str, int] = {}
    for path, line, is_leaf in _keys(parameters, ()):
        name = ".".join(path)
        if (first := lines.setdefault(name if is_leaf else "/".join(("", *path)), line)) != line:
            yield f"{name} must appear once, got lines {first} and {line}"


def _keys(node: Any, above: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], int, bool]]:
    """Yield each key of a node with its parents, its line, and whether its value is not a mapping."""
    for key, value in _items(node):
        if key.value != _MERGE:
            path = (*above, str(key.value))
            yield path, key.start_mark.line + 1, value.id != "mapping"
            yield from _keys(value, path)


def check_sections(path: Path, sections: Sequence[Section], full_name: str) -> str:
    """Return a warning if a section's name is nearly that of a node, ``full_name``, or an empty text.

    Raise `ConfigurationError` if the file has no section for the node, or one with a parameter twice.
    """
    twice = [each for section in sections if section.is_for(full_name) for each in section.repeated]
    if twice:
        raise ConfigurationError(f"{path}: {'; '.join(twice)}")
    others = [section.node for section in sections if not section.is_for(full_name)]
    if len(others) == len(sections):
        nearest = difflib.get_close_matches(full_name, others, n=1, cutoff=0.0)[0]
        raise ConfigurationError(
            f"{path} must have parameters of {ANY_NODE} or {full_name}, got only those of "
            f"{' and of '.join(others)}, which do not apply to this node; {nearest} is the nearest name"
        )
    misspelled = [name for name in others if _is_misspelled(name, full_name)]
    if not misspelled:
        return ""
    return (
        f"{path}: the parameters of {' and of '.join(misspelled)} do not apply to this node, "
        f"whose name is {full_name}"
    )


def files_given(arguments: Sequence[str]) -> list[str]:
    """Return the parameter files in ROS's arguments."""
    return [path for flag, path in pairwise(arguments) if flag == _FILE]


def nodes_given(arguments: Sequence[str]) -> list[str]:
    """Return the names of nodes in ROS's arguments of the form `-p NODE:PARAMETER:=VALUE`."""
    return [absolute(match[1]) for match in _given(arguments) if match[1] is not None]


def values_given(arguments: Sequence[str], full_name: str) -> dict[str, Any]:
    """Return the values of parameters in ROS's arguments for a node of this full name."""
    return {
        match[2]: _value_of(match[3].strip())
        for match in _given(arguments)
        if match[1] is None or Section(absolute(match[1]), {}).is_for(full_name)
    }


def _given(arguments: Sequence[str]) -> Iterator[re.Match[str]]:
    """Yield the node, if any, the name and the value of each parameter in ROS's arguments."""
    for flag, text in pairwise(arguments):
        match = _GIVEN.fullmatch(text) if flag in {"-p", "--param"} else None
        if match is not None:
            yield match


def _is_misspelled(name: str, full_name: str) -> bool:
    """Return whether a name is nearly that of a node. Numbered names and other namespaces do not count."""
    own, wanted = name.rpartition("/")[2], full_name.rpartition("/")[2]
    if _NUMBER.sub("", own) == _NUMBER.sub("", wanted):
        return False
    return difflib.SequenceMatcher(None, own, wanted).ratio() >= _ALIKE


def absolute(name: str) -> str:
    """Return a node's name with its leading slash."""
    return name if name.startswith("/") else f"/{name}"


_NODE: Final = f"/{NODE_NAME}"


class ParameterFile(ParameterSource):
    """The values in a file, with other topics for some bodies if given."""

    def __init__(self, path: Path, topics: Sequence[str] = ()) -> None:
        """Read the file. The ``topics`` ("BODY=ODOMETRY" or "BODY=POSE,TWIST") override those in the file.

        Raise `ConfigurationError` if the file is missing, is not YAML, has no parameters of the server or a
        section with nearly its name, or if a text in ``topics`` has another form.
        """
        sections = read_sections(path)
        warning = check_sections(path, sections, _NODE)
        if warning:
            raise ConfigurationError(warning)  # the file configures only the server here
        values: dict[str, Any] = {}
        for section in sections:
            if section.is_for(_NODE):
                values.update(_flat(section.values))
        for text in topics:
            values.update(_topics(text))
        # One file may configure all nodes.
        super().__init__(with_links_read(values), origin=str(path), also_known=PARAMETERS_OF_OTHERS)


def _flat(given: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in given.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


def values_of(config: Path | None, settings: Sequence[str]) -> dict[str, Any]:
    """Return the values of a parameter file, overridden by texts "name:=value".

    Raise `ConfigurationError` if the file has no parameters, or a text has another form.
    """
    values = {} if config is None else dict(ParameterFile(config).values)
    for text in settings:
        name, separator, value = text.partition(":=")
        if not name or not separator:
            raise ConfigurationError(f"--set must be NAME:=VALUE, got {text!r}")
        values[name] = _value_of(value)
    return values


def _value_of(text: str) -> Any:
    """Return the value in a text of the command line. Any other text is a value itself."""
    import yaml

    try:
        found = json.loads(text)  # in YAML, 1e3 is not a number
    except ValueError:
        try:
            found = yaml.safe_load(text)
        except yaml.YAMLError:
            return text
    return found if isinstance(found, (bool, int, float, str, list)) and found != [] else text


def _topics(text: str) -> dict[str, str]:
    body, _, names = text.partition("=")
    found = names.split(",")
    if not body or not all(found) or len(found) > 2:
        raise ConfigurationError(f"--topics must be BODY=ODOMETRY or BODY=POSE,TWIST, got {text!r}")
    odometry, pose, twist = ("", *found) if len(found) == 2 else (found[0], "", "")
    key = f"body.{body}"
    return {f"{key}.odometry_topic": odometry, f"{key}.pose_topic": pose, f"{key}.twist_topic": twist}
