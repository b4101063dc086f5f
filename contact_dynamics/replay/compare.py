# SPDX-License-Identifier: Apache-2.0
"""Compares two responses field by field."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.recording.message_types import PRIMITIVES, PYTHON_TYPES, Field, Message

if TYPE_CHECKING:
    from collections.abc import Iterator

_PUBLISHERS: Final = re.compile(r" \(\d+ publishers?\)")
"""In a message: how many publishers there were, which no log has. It is not compared either."""

MEASURED: Final = frozenset({"computation_time"})
"""These fields of a response say how the answer was made, not what it is. They are not compared."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Difference:
    """One field in which two responses differ.

    Attributes:
        field: Path of the field within the response, as in "modes[2].margin".
        logged: Its value in the log.
        recomputed: Its value when the question is asked again.
        size: The difference relative to the larger of the two, or to 1 if both are smaller. It is infinite if
            the values are not numbers, if one of them is not finite, or if arrays have unequal lengths.
    """

    field: str
    logged: object
    recomputed: object
    size: float


def differences(logged: Message, recomputed: object, *, path: str = "") -> Iterator[Difference]:
    """Yield each field of a logged message whose value in another message is not the same to the last bit."""
    for field in logged.FIELDS:
        if not path and field.name in MEASURED:
            continue
        name = f"{path}.{field.name}" if path else field.name
        ours = getattr(logged, field.name)
        if not hasattr(recomputed, field.name):
            yield Difference(field=name, logged=ours, recomputed="no such field", size=math.inf)
            continue
        theirs = getattr(recomputed, field.name)
        if not field.is_array:
            yield from _of_one(field, name, ours, theirs)
        elif field.type_name in PRIMITIVES:
            yield from _of_numbers(field, name, ours, theirs)
        elif len(ours) != len(theirs):
            yield _of_lengths(name, len(ours), len(theirs))
        else:
            for index, (one, other) in enumerate(zip(ours, theirs, strict=True)):
                yield from _of_one(field, f"{name}[{index}]", one, other)


def _of_one(field: Field, name: str, ours: Any, theirs: Any) -> Iterator[Difference]:
    if field.type_name in PRIMITIVES:
        yield from _of_numbers(field, name, [ours], [theirs], is_array=False)
    elif field.type_name == "string":
        if _PUBLISHERS.sub("", ours) != _PUBLISHERS.sub("", theirs):
            yield Difference(field=name, logged=ours, recomputed=theirs, size=math.inf)
    else:
        yield from differences(ours, theirs, path=name)


def _of_numbers(
    field: Field, name: str, ours: Any, theirs: Any, *, is_array: bool = True
) -> Iterator[Difference]:
    if len(ours) != len(theirs):
        yield _of_lengths(name, len(ours), len(theirs))
        return
    code = PRIMITIVES[field.type_name]
    one, other = np.array(ours, dtype=code), np.array(theirs, dtype=code)
    if one.tobytes() == other.tobytes():
        return
    to_python = PYTHON_TYPES[field.type_name]
    for index in range(len(one)):
        x, y = to_python(one[index]), to_python(other[index])
        if one[index].tobytes() == other[index].tobytes() or (math.isnan(x) and math.isnan(y)):
            continue
        where = f"{name}[{index}]" if is_array else name
        size = _size(x, y) if to_python is float else math.inf
        yield Difference(field=where, logged=x, recomputed=y, size=size)


def _of_lengths(name: str, ours: int, theirs: int) -> Difference:
    return Difference(field=f"number of {name}", logged=ours, recomputed=theirs, size=math.inf)


def _size(x: float, y: float) -> float:
    """Return the distance of two numbers relative to the larger one, or to 1 if both are smaller."""
    if not (math.isfinite(x) and math.isfinite(y)):
        return math.inf
    return abs(x - y) / max(1.0, abs(x), abs(y))
