# SPDX-License-Identifier: Apache-2.0
"""Rejects numbers that rclpy mangled before it sent them.

Without ROS_PYTHON_CHECK_FIELDS=1, rclpy checks no types. Of an int or a ``numpy.float32`` in a float64 field
it sends the wrong bytes: a number just above zero, or NaN. A question with such a number would have a wrong
answer. Numbers in lists are safe, because rclpy converts those, and are looked at nevertheless.
"""

from __future__ import annotations

import re
from operator import attrgetter
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.tolerances import MANGLED
from msg_adapters.field_names import FIELDS, renamed
from msg_adapters.unread_fields import field_names, leaves_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from msg_adapters.field_names import Refused

HINT: Final = (
    "rclpy sends this for an int or a numpy.float32: write 2.0 or float(x), or set "
    "ROS_PYTHON_CHECK_FIELDS=1, so that it raises an error"
)
"""What to do about such a number."""

_NAN: Final = re.compile(r"(?<![\w'])nan(?![\w'])")


def check_numbers(message: object) -> None:
    """Raise `InvalidFieldError` for the first number of a message that rclpy has mangled, and name the field.

    Such a number is positive and below `tolerances.MANGLED`. NaN is left to whoever reads the field.
    """
    for path, number in _mangled(message):
        raise InvalidFieldError(path, number, "a number of normal size", hint=HINT)


def in_fields(error: Refused) -> Refused:
    """Return an error in the words of messages: by their fields, and with a hint where one helps."""
    told = renamed(error, FIELDS)
    if not isinstance(told, InvalidFieldError) or told.hint:
        return told
    hint = ""
    if _NAN.search(str(told.found)):
        hint = HINT
    elif (told.field, told.found) == ("stamp", 0):
        hint = "fill in header.stamp, with the node's clock"
    return type(told)(told.field, told.found, told.allowed, hint=hint) if hint else told


def _mangled(message: object) -> Iterator[tuple[str, float]]:
    """Yield the numbers of a message that are mangled, by their fields."""
    plan = _plan(type(message))
    for path, number in zip(plan.number_paths, plan.numbers(message), strict=False):
        if 0.0 < number < MANGLED:
            yield path, number
    for path, values in zip(plan.list_paths, plan.lists(message), strict=False):
        if len(values):
            yield from ((f"{path}{place}", number) for place, number in _mangled_in_list(values))


def _mangled_in_list(values: Sequence[object]) -> Iterator[tuple[str, float]]:
    if isinstance(values[0], float):
        numbers = np.asarray(values)
        for index in np.flatnonzero((numbers > 0.0) & (numbers < MANGLED)).tolist():
            yield f"[{index}]", float(numbers[index])
    elif field_names(values[0]):
        for index, value in enumerate(values):
            yield from ((f"[{index}].{path}", number) for path, number in _mangled(value))


class _Plan(NamedTuple):
    """The fields of a type of messages that are looked at, and functions that return all of their values."""

    number_paths: tuple[str, ...]
    numbers: Callable[[object], tuple[float, ...]]
    list_paths: tuple[str, ...]
    lists: Callable[[object], tuple[Sequence[object], ...]]


_PLANS: Final[dict[type, _Plan]] = {}


def _plan(message_type: type) -> _Plan:
    if message_type not in _PLANS:
        _PLANS[message_type] = _planned(message_type())
    return _PLANS[message_type]


def _planned(message: object) -> _Plan:
    found = [leaf for name in field_names(message) for leaf in leaves_of(name, getattr(message, name))]
    others = (bool, int, float, str, bytes)
    numbers = tuple(leaf.path for leaf in found if isinstance(leaf.default, float))
    lists = tuple(leaf.path for leaf in found if not isinstance(leaf.default, others))
    # Two more values, because a getter of one returns no tuple.
    is_ros = hasattr(message, "get_fields_and_field_types")  # whose properties take five times as long
    read, read_lists = (
        attrgetter(*["_" + path.replace(".", "._") if is_ros else path for path in paths], *["__class__"] * 2)
        for paths in (numbers, lists)
    )
    return _Plan(numbers, read, lists, read_lists)
