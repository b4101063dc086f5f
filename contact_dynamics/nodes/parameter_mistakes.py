# SPDX-License-Identifier: Apache-2.0
"""Finds the mistakes in parameters that ROS does not report. This file imports no ROS.

ROS gives a node the parameters of all sections whose name fits its full name, and says nothing of the others,
so a misspelled name costs all parameters of its section. YAML forbids repeated keys, but ROS silently takes
the last one. It ignores parameters that nobody reads. Where a file gives a parameter a value of one type and
`-p` another of a type that ROS looks at later, it keeps that of the file: `-p log:=0` beside `log: true` goes
on logging.
"""

from __future__ import annotations

import difflib
import json
import re
from collections import defaultdict
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from contact_dynamics.nodes.parameter_reader import ConfigurationError

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
    from pathlib import Path

ANY_NODE: Final = "/**"
"""The name of a section that is for every node."""

_VALUES: Final = "ros__parameters"
_MERGE: Final = "<<"  # a key of YAML itself
_ALIKE: Final = 0.9  # the share of equal letters; a name of 16 letters with two that are swapped has 0.94
_NUMBER: Final = re.compile(r"[_\d]+$")
_FILE: Final = "--params-file"
_GIVEN: Final = re.compile(r"(?:([^:=]+):)?([^:=]+):=(.*)", re.DOTALL)


class Section(NamedTuple):
    """The parameters for the nodes of one name.

    Attributes:
        node: The name as ROS understands it, with a leading slash. It may have `*` and `/**`.
        values: The values by their names, which may be nested.
        repeated: The parameters that stand in it more than once, in words.
    """

    node: str
    values: dict[str, Any]
    repeated: tuple[str, ...] = ()

    def is_for(self, full_name: str) -> bool:
        """Tell whether a node of this full name gets the parameters."""
        # The first replacement makes "(/\w+)*" of "/**", which is what that means.
        return re.fullmatch(self.node.replace("/*", r"(/\w+)"), full_name) is not None


def read_sections(path: Path) -> tuple[Section, ...]:
    """Return the sections of a file.

    Raises:
        ConfigurationError: the file cannot be read, is no YAML, or has something else than sections, or one
            of them twice.
    """
    content, repeated = _content(path)
    if not isinstance(content, dict) or not content:
        message = f"{path} must have parameters of {ANY_NODE} or of a node by its name, got none"
        raise ConfigurationError(message)
    if twice := [str(each) for each in repeated if not each.name]:
        message = f"{path}: {'; '.join(twice)}"
        raise ConfigurationError(message)
    by_section: defaultdict[str, list[str]] = defaultdict(list)
    for each in repeated:
        by_section["".join(map(absolute, each.section[:-1]))].append(str(each))
    return tuple(
        section._replace(repeated=tuple(by_section[section.node])) for section in _sections(path, content, "")
    )


def check_sections(path: Path, sections: Sequence[Section], full_name: str) -> str:
    """Return a warning of a section that was probably meant for a node and misses it, or an empty text.

    Args:
        path: the file.
        sections: its sections.
        full_name: the name of the node with its namespace.

    Raises:
        ConfigurationError: the file has no section for the node, so that it says nothing to it, or one of
            them has a parameter twice, of which ROS would take the last.
    """
    twice = [each for section in sections if section.is_for(full_name) for each in section.repeated]
    if twice:
        message = f"{path}: {'; '.join(twice)}"
        raise ConfigurationError(message)
    others = [section.node for section in sections if not section.is_for(full_name)]
    if len(others) == len(sections):
        nearest = _nearest(others, full_name)
        message = (
            f"{path} must have parameters of {ANY_NODE} or {full_name}, got only those of "
            f"{' and of '.join(others)}, which do not apply to this node; {nearest} is the nearest name"
        )
        raise ConfigurationError(message)
    misspelled = [name for name in others if _is_misspelled(name, full_name)]
    if not misspelled:
        return ""
    return (
        f"{path}: the parameters of {' and of '.join(misspelled)} do not apply to this node, "
        f"whose name is {full_name}"
    )


def files_given(arguments: Sequence[str]) -> list[str]:
    """Return the files of parameters that ROS's arguments name."""
    return [path for flag, path in pairwise(arguments) if flag == _FILE]


def nodes_given(arguments: Sequence[str]) -> list[str]:
    """Return the names of nodes in ROS's arguments of the form `-p NODE:PARAMETER:=VALUE`."""
    return [absolute(match[1]) for match in _given(arguments) if match[1] is not None]


def values_given(arguments: Sequence[str], full_name: str) -> dict[str, str]:
    """Return the texts of the parameters that ROS's arguments give to a node of this full name."""
    return {
        match[2]: match[3].strip()
        for match in _given(arguments)
        if match[1] is None or Section(absolute(match[1]), {}).is_for(full_name)
    }


def _given(arguments: Sequence[str]) -> Iterator[re.Match[str]]:
    """Yield the node, if any, the name and the value of each parameter in ROS's arguments."""
    for flag, text in pairwise(arguments):
        match = _GIVEN.fullmatch(text) if flag in {"-p", "--param"} else None
        if match is not None:
            yield match


def _nearest(names: Sequence[str], full_name: str) -> str:
    return difflib.get_close_matches(full_name, names, n=1, cutoff=0.0)[0]


def _is_misspelled(name: str, full_name: str) -> bool:
    """Tell whether a name is nearly that of a node; several nodes may be numbered, or differ in namespace."""
    own, wanted = name.rpartition("/")[2], full_name.rpartition("/")[2]
    if _NUMBER.sub("", own) == _NUMBER.sub("", wanted):
        return False
    return difflib.SequenceMatcher(None, own, wanted).ratio() >= _ALIKE


def _sections(path: Path, content: dict[str, Any], above: str) -> Iterator[Section]:
    for key, inner in content.items():
        name = f"{above}{absolute(str(key))}"
        if isinstance(inner, dict) and isinstance(inner.get(_VALUES), dict):
            yield Section(name, inner[_VALUES])
        elif isinstance(inner, dict) and inner and _VALUES not in inner:
            yield from _sections(path, inner, name)
        else:
            message = f"{path}: {name.lstrip('/')} must have {_VALUES} (names with values)"
            raise ConfigurationError(message)


def absolute(name: str) -> str:
    """Return a node's name with its leading slash."""
    return name if name.startswith("/") else f"/{name}"


def _content(path: Path) -> tuple[Any, tuple[RepeatedKey, ...]]:
    """Return what a file holds, and the keys that it has more than once."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        message = f"{path}: cannot be read: {error}"
        raise ConfigurationError(message) from None
    try:
        # JSON is YAML, and needs nothing that is not installed
        return json.loads(text, object_pairs_hook=_without_repeated_keys), ()
    except ValueError:
        pass
    import yaml  # only who is configured by a file needs it

    try:
        loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)(text)  # the former is ten times as fast
        root = loader.get_single_node()
        return (None, ()) if root is None else (loader.construct_document(root), repeated_keys(root))
    except yaml.YAMLError as error:
        message = f"{path}: no YAML: {error}"
        raise ConfigurationError(message) from None


def _without_repeated_keys(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Return what the pairs of an object hold; with a key twice, YAML's reader tells the lines."""
    found = dict(pairs)
    if len(found) < len(pairs):
        message = "a key stands twice"
        raise ValueError(message)
    return found


class RepeatedKey(NamedTuple):
    """A key that stands in a file more than once.

    Attributes:
        section: The keys down to `ros__parameters`, or all keys where there is none above it.
        name: The name of the parameter, or an empty text where the key names a section.
        lines: The lines of the first one and of the next, counted from 1.
    """

    section: tuple[str, ...]
    name: str
    lines: tuple[int, int]

    def __str__(self) -> str:
        """Return in words which key stands where."""
        key = self.name or "/".join(self.section)
        return f"{key} must appear once, got lines {self.lines[0]} and {self.lines[1]}"


def repeated_keys(root: Any) -> tuple[RepeatedKey, ...]:
    """Return the keys that a file has more than once.

    A parameter can be written in one word or nested: ``body.brick.mass: 1.0`` and
    ``body: {brick: {mass: 2.0}}`` are the same one.

    Args:
        root: the file as nodes of PyYAML, or None for an empty file.
    """
    lines: dict[tuple[tuple[str, ...], str], int] = {}
    found: list[RepeatedKey] = []
    for path, line, is_leaf in _keys(root, ()):
        after = path.index(_VALUES) + 1 if _VALUES in path else len(path)
        # A group of parameters may be opened twice where one is nested and the other is written in one word.
        place = (path[:after], ".".join(path[after:]) if is_leaf else "/".join(("", *path[after:])))
        if place in lines:
            found.append(RepeatedKey(path[:after], ".".join(path[after:]), (lines[place], line)))
        else:
            lines[place] = line
    return tuple(found)


def _keys(node: Any, above: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], int, bool]]:
    """Yield each key of a node with those above it, its line, and whether its value is no mapping."""
    if getattr(node, "id", "") != "mapping":
        return
    for key, value in node.value:
        if key.value == _MERGE:
            continue
        path = (*above, str(key.value))
        is_leaf = getattr(value, "id", "") != "mapping"
        yield path, key.start_mark.line + 1, is_leaf
        if not is_leaf:
            yield from _keys(value, path)


_BOOLEAN: Final = re.compile(
    r"[yYnN]|yes|Yes|YES|no|No|NO|true|True|TRUE|false|False|FALSE|on|On|ON|off|Off|OFF"
)
_WHOLE: Final = re.compile(r"[-+]?(0[xX][0-9a-fA-F]+|[0-9]+)")
_DECIMAL: Final = re.compile(
    r"[-+]?(([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?|\.?(nan|NaN|NAN|inf|Inf|INF))"
)
IN_WORDS: Final = {
    bool: "true or false",
    int: "a whole number",
    float: "a number with a point, such as 1.0",
    str: "a text",
    list: "a list with an entry, such as [1.0]",
}
"""The types of parameters, in the words of an error."""


def what_is_wrong(text: str, wanted: type[Any]) -> str:
    """Return what a parameter's text would have to be, or nothing where it is of the type that is wanted."""
    return "" if text == "" or _type_of(text) is wanted else IN_WORDS[wanted]


def _type_of(text: str) -> type[Any] | None:
    """Return the type that ROS makes of a text. A list without an entry has none, and ROS ignores it."""
    if text.startswith("["):
        return list if text.strip("[] ") else None
    for pattern, kind in ((_BOOLEAN, bool), (_WHOLE, int), (_DECIMAL, float)):
        if pattern.fullmatch(text):
            return kind
    return str


_OF_ROS: Final = re.compile(r"use_sim_time|start_type_description_service")
_QOS: Final = "qos_overrides"
_POLICIES: Final = ("history", "depth", "reliability")
"""What ROS lets parameters override of a subscription, unless a node asks for more."""
_LIKELY: Final = 0.7
"""Similarity from which on a name counts as a misspelled one, by `difflib`. One letter in four makes 0.75."""
_MEANT: Final = {"radius": "sphere", "size": "box", "com": "center_of_mass", "mu": "friction"}
"""Names that others have for a parameter, with ours."""
_LISTED_BY: Final = {"body": "bodies", "surface": "surfaces"}


def is_of_ros(name: str) -> bool:
    """Tell whether a parameter is one that ROS gives every node."""
    return _OF_ROS.fullmatch(name) is not None or name.startswith(f"{_QOS}.")


def qos_overrides_of(topics: Iterable[str]) -> set[str]:
    """Return the parameters that override the quality of service of subscriptions to topics."""
    return {f"{_QOS}.{topic}.subscription.{policy}" for topic in topics for policy in _POLICIES}


def refuse_unknown(
    given: Iterable[str],
    known: Collection[str],
    listed: Callable[[str], Iterable[str]],
    early: Collection[str] | None = None,
) -> None:
    """Refuse names of parameters that are not known.

    Args:
        given: the names.
        known: those that somebody reads, with `qos_overrides_of` the topics.
        listed: returns what the parameter of a name lists, `bodies` or `surfaces`.
        early: the names of all parameters, where an error has left some unread. Topics are not known then,
            and overrides of their quality of service are not refused.

    Raises:
        ConfigurationError: some are unknown. The message names each, with the most similar known one.
    """
    is_allowed = _OF_ROS.fullmatch if early is None else is_of_ros
    known = {*known, *(early or ())}
    unknown = sorted(name for name in given if name not in known and not is_allowed(name))
    if unknown:
        raise ConfigurationError("\n".join(_unknown(name, known, listed) for name in unknown))


def likely_misspelling(missing: str, given: Iterable[str]) -> str:
    """Return words about a given name that is probably meant by the missing one, or nothing."""
    group, _, last = missing.rpartition(".")
    beside = [name.rpartition(".")[2] for name in given if name.rpartition(".")[0] == group]
    close = difflib.get_close_matches(last, beside, n=1, cutoff=_LIKELY)
    return f" Given is {group}.{close[0]}, which may be misspelled." if close else ""


def _unknown(name: str, known: Collection[str], listed: Callable[[str], Iterable[str]]) -> str:
    kind, _, rest = name.partition(".")
    listing = _LISTED_BY.get(kind)
    if listing and rest:
        own_name = rest.rpartition(".")[0] or rest
        allowed = list(listed(listing))
        if own_name not in allowed:
            return f"{name} must be about one of the names in {listing} {allowed}, got {kind} {own_name!r}"
    group, _, last = name.rpartition(".")
    meant = f"{group}.{_MEANT.get(last, '')}"
    nearest = meant if meant in known else difflib.get_close_matches(name, known, n=1, cutoff=0.0)[0]
    return f"{name}: there is no such parameter; the nearest is {nearest}"
