"""Finds keys that a YAML file of parameters has twice. YAML forbids that; ROS takes the last one silently.

A parameter can be written in one word or nested: ``body.brick.mass: 1.0`` and ``body: {brick: {mass: 2.0}}``
are the same one. This file imports no ROS.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator

_SEPARATOR: Final = "ros__parameters"
_MERGE: Final = "<<"  # a key of YAML itself


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

    Args:
        root: the file as nodes of PyYAML, or None for an empty file.
    """
    lines: dict[tuple[tuple[str, ...], str], int] = {}
    found: list[RepeatedKey] = []
    for path, line, is_leaf in _keys(root, ()):
        after = path.index(_SEPARATOR) + 1 if _SEPARATOR in path else len(path)
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
