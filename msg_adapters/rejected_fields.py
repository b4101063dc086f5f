# SPDX-License-Identifier: Apache-2.0
"""Rejects requests with invalid values: those in fields that are not read, and numbers that rclpy corrupted.

An explicit state with the flag of the newest one, or a plane's normal for a spatial problem, would otherwise
be ignored, and the response would be to another question. Each table has the fields of a service that are
read only under a condition. All other fields of its request are always read. A field has no value if it has
its default.

Without ROS_PYTHON_CHECK_FIELDS=1, rclpy checks no types. For an int or a ``numpy.float32`` in a float64
field, it sends the wrong bytes: a number just above zero, or NaN. The response to such a request would be
wrong. rclpy converts numbers in lists correctly, but they are checked too.
"""

from __future__ import annotations

import re
from operator import attrgetter
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias, TypeVar, cast

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.tolerances import MANGLED
from msg_adapters.field_names import FIELDS, renamed

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from msg_adapters.field_names import Refused


Value = TypeVar("Value")


class When(NamedTuple):
    """A condition on one field of a request."""

    field: str  # may be a field of a message in the request
    # Names of constants of the request, one of which is the field's value. Without any, it is not zero.
    constants: tuple[str, ...] = ()
    is_zero: bool = False  # whether the field must be zero instead

    def is_met(self, request: object) -> bool:
        """Return whether a request meets the condition."""
        if self.constants:
            return getattr(request, self.field) in [getattr(request, name) for name in self.constants]
        return self.is_zero is not any(
            _is_not_zero(leaf.read(request)) for leaf in _leaves(request, self.field)
        )

    def words(self, request: object) -> str:
        """Return the condition as text."""
        if self.constants:
            return f"{self.field} is " + _either(
                [f"{name} ({getattr(request, name)})" for name in self.constants]
            )
        value: object = attrgetter(self.field)(request)
        of_flags, of_numbers = ("true", "false"), ("not zero", "zero")
        return f"{self.field} is {(of_flags if isinstance(value, bool) else of_numbers)[self.is_zero]}"

    def remedy(self, request: object) -> str:
        """Return a text with a value that meets the condition, or an empty text if no single value does."""
        if self.constants:
            return f"set {self.field}: {getattr(request, self.constants[0])} to use it"
        value: object = attrgetter(self.field)(request)
        return (
            f"set {self.field}: {str(not self.is_zero).lower()} to use it" if isinstance(value, bool) else ""
        )


class ReadIf(NamedTuple):
    """Fields of a request that are read only if it meets one of some conditions."""

    fields: tuple[str, ...]
    conditions: tuple[When, ...]


def check_unread(
    request: object, table: tuple[ReadIf, ...], *, part: object | None = None, path: str = ""
) -> None:
    """Raise `InvalidFieldError` for a value in a field that is not read, and name the field.

    The fields may be those of a part of the request, to which ``path`` leads.
    """
    message = request if part is None else part
    _, rows = _ROWS.get((type(message), id(table))) or _rows(type(message), table)
    for read, defaults, fields, conditions in rows:
        if read(message) == defaults or any(condition.is_met(request) for condition in conditions):
            continue
        for leaf in _leaves(message, *fields):
            found = leaf.read(message)
            if found != leaf.default and not _is_empty(found):
                known = _either([condition.words(request) for condition in conditions])
                allowed = f"left out unless {known}"
                shown = found if isinstance(found, str) or not hasattr(found, "__iter__") else list(found)
                raise InvalidFieldError(path + leaf.path, shown, allowed, conditions[0].remedy(request))


_Row: TypeAlias = tuple[
    "Callable[[object], tuple[object, ...]]", tuple[object, ...], tuple[str, ...], tuple[When, ...]
]

_ROWS: Final[dict[tuple[type, int], tuple[tuple[ReadIf, ...], list[_Row]]]] = {}
"""The rows of tables for types of requests, with a function that reads all fields of a row, and its result
for an empty request. The table is stored because its `id` is part of the key."""


def _rows(request_type: type, table: tuple[ReadIf, ...]) -> tuple[tuple[ReadIf, ...], list[_Row]]:
    empty, rows = request_type(), list[_Row]()
    for fields, conditions in table:
        read = values_of(request_type, [leaf.path for leaf in _leaves(empty, *fields)])
        rows.append((read, read(empty), fields, conditions))
    return _ROWS.setdefault((request_type, id(table)), (table, rows))


class _Leaf(NamedTuple):
    """A number, a text or a list in a request, and its default."""

    path: str
    read: Callable[[object], object]
    default: object


_KNOWN: Final[dict[tuple[type, tuple[str, ...]], tuple[_Leaf, ...]]] = {}


def _leaves(request: object, *fields: str) -> tuple[_Leaf, ...]:
    """Return the leaves of some fields of a request, whose type has the defaults."""
    key = (type(request), fields)
    if key not in _KNOWN:
        empty = type(request)()
        _KNOWN[key] = tuple(leaf for each in fields for leaf in leaves_of(each, attrgetter(each)(empty)))
    return _KNOWN[key]


def values_of(message: type, paths: Sequence[str]) -> Callable[[object], tuple[Value, ...]]:
    """Return a function that returns the values of fields of a message, and then its class twice.

    It reads the slots of ROS's messages, whose properties take five times as long. With the class, the result
    is a tuple even for a single field.
    """
    is_ros = hasattr(message, "get_fields_and_field_types")
    slots = ["_" + path.replace(".", "._") for path in paths] if is_ros else paths
    return attrgetter(*slots, "__class__", "__class__")


def leaves_of(path: str, default: object) -> Iterator[_Leaf]:
    """Yield the leaves of a field of a message, with its path and default."""
    names = field_names(default)
    if not names:
        yield _Leaf(path, attrgetter(path), default)
    for name in names:
        yield from leaves_of(f"{path}.{name}", getattr(default, name))


def field_names(value: object) -> Sequence[str]:
    """Return the names of the fields of a message, or none for any other value."""
    if hasattr(value, "get_fields_and_field_types"):  # made by ROS; others are made from a log's texts
        return tuple(value.get_fields_and_field_types())
    return tuple(field.name for field in getattr(value, "FIELDS", ()))


def _is_empty(value: object) -> bool:
    """Return whether a value is a list without elements, which is the default of every list in a request."""
    return hasattr(value, "__len__") and len(value) == 0


def _is_not_zero(value: object) -> bool:
    return any(value) if hasattr(value, "__iter__") else bool(value)


def _either(words: list[str]) -> str:
    return " or ".join([", ".join(words[:-1]), words[-1]] if words[1:] else words)


_EXPLICIT: Final = When("state_source", ("STATE_EXPLICIT",))
_PUBLISHED: Final = When("state_source", ("STATE_NEWEST", "STATE_AT_STAMP"))
_FOUND: Final = When("contact_source", ("CONTACTS_FROM_GEOMETRY",))
_IN_PLANE: Final = When("problem", ("PLANAR",))
_MAY_BE_PLANAR: Final = When("problem", ("AUTOMATIC", "PLANAR"))
_IN_TIME: Final = When("several_contacts_law", ("SEQUENTIAL_IN_TIME",))
_PLANE: Final = ("plane_normal", "out_of_plane_tolerance")

_STAMP: Final = ReadIf(("stamp",), (When("state_source", ("STATE_AT_STAMP",)),))
_STATE: Final = (ReadIf(("state",), (_EXPLICIT,)), _STAMP)
_FITTED_STATE: Final = (*_STATE, ReadIf(("fit_window",), (_PUBLISHED,)))
_CONTACTS: Final = ReadIf(("contacts",), (When("contact_source", ("CONTACTS_EXPLICIT",)),))
_CONTACT_MODES: Final = (
    *_STATE,
    _CONTACTS,
    ReadIf(_PLANE, (_MAY_BE_PLANAR,)),
    ReadIf(("distance_tolerance",), (_FOUND, _MAY_BE_PLANAR)),
)

CONTACT_MODE: Final = (
    *_CONTACT_MODES,
    ReadIf(("friction_facets",), (When("problem", ("AUTOMATIC", "SPATIAL")),)),
    # AUTOMATIC solves these in space, because no plane holds uncertain contacts.
    ReadIf(_PLANE, (_IN_PLANE, When("include_geometry_margins", is_zero=True))),
    ReadIf(_PLANE, (_IN_PLANE, When("uncertainty_points", is_zero=True))),
    ReadIf(_PLANE, (_IN_PLANE, When("uncertainty_normals", is_zero=True))),
    ReadIf(("margin_length",), (When("include_margins"), When("include_statics"))),
)
"""The fields of `PredictContactMode`."""

CONTACT_MODE_BATCH: Final = (*_CONTACT_MODES, ReadIf(("margin_length",), (When("include_margins"),)))
"""The fields of `PredictContactModeBatch`."""

BODIES_CONTACT_MODE: Final = (_STAMP,)  # the fields of `PredictBodiesContactMode`

STATE_OF_BODY: Final = (
    ReadIf(("header", "pose", "linear_velocity", "angular_velocity", "covariance"), (_EXPLICIT,)),
)
"""The fields of each of its states, beside the body's name."""

IMPACT: Final = (
    *_FITTED_STATE,
    _CONTACTS,
    ReadIf(("horizon",), (_FOUND,)),
    ReadIf(_PLANE, (_IN_PLANE,)),
    ReadIf(("distance_tolerance",), (_FOUND, _IN_TIME, _IN_PLANE)),
    ReadIf(("strike_window", "max_strikes", "hold_step"), (_IN_TIME,)),
)
"""The fields of `PredictImpact`."""

TUMBLING: Final = (
    *_FITTED_STATE,
    ReadIf(("times",), (When("sampling", ("AT_TIMES",)),)),
    ReadIf(("stamps_ns",), (When("sampling", ("AT_STAMPS",)),)),
    ReadIf(("rate", "duration"), (When("sampling", ("AT_RATE", "UNTIL_CONTACT", "UNTIL_PLANE")),)),
    ReadIf(("plane_point", "plane_normal", "body_point"), (When("sampling", ("UNTIL_PLANE",)),)),
    # Only a body without a torque has polhode and herpolhode.
    ReadIf(("curve_points",), (When("applied_wrench.torque", is_zero=True),)),
    ReadIf(("curve_points",), (When("linear_angular_drag", is_zero=True),)),
    ReadIf(("curve_points",), (When("quadratic_angular_drag", is_zero=True),)),
)
"""The fields of `PredictTumbling`."""

TOSS: Final = (
    *_FITTED_STATE,
    ReadIf(
        (
            "strikes",
            "to_rest",
            "seed",
            "parameter_covariance",
            "velocity_spread",
            "spin_spread",
            "height_spread",
            "lasting_factor_stds",
        ),
        (When("samples"),),
    ),
)
"""The fields of `PredictToss`."""


HINT: Final = (
    "rclpy sends this for an int or a numpy.float32: write 2.0 or float(x), or set "
    "ROS_PYTHON_CHECK_FIELDS=1, so that it raises an error"
)

_FEW: Final = 20  # length of a list up to which Python is faster than NumPy

_NAN: Final = re.compile(r"(?<![\w'])nan(?![\w'])")


def check_numbers(message: object) -> None:
    """Raise `InvalidFieldError` for the first number of a message that rclpy corrupted, and name the field.

    Such a number is positive and below `tolerances.MANGLED`. NaN is checked where the field is read.
    """
    for path, number in _mangled(message):
        raise InvalidFieldError(path, number, "a number of normal size", hint=HINT)


def in_fields(error: Refused) -> Refused:
    """Return an error with the fields' names in messages, and a hint where one helps."""
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
    """Yield the corrupted numbers of a message, with their fields."""
    plan = _plan(type(message))
    numbers = plan.numbers(message)
    for index in _mangled_among(numbers[: len(plan.number_paths)]):
        yield plan.number_paths[index], numbers[index]
    for path, values in zip(plan.list_paths, plan.lists(message), strict=False):
        if len(values) == 0:
            continue
        if isinstance(values[0], float):
            floats = cast("Sequence[float]", values)
            yield from ((f"{path}[{index}]", float(floats[index])) for index in _mangled_among(floats))
        elif field_names(values[0]):
            for index, value in enumerate(values):
                yield from ((f"{path}[{index}].{inner}", number) for inner, number in _mangled(value))


def _mangled_among(numbers: Sequence[float]) -> Sequence[int]:
    """Return the indices of the corrupted numbers."""
    if len(numbers) > _FEW and not isinstance(numbers, tuple):
        array = np.asarray(numbers)
        found: list[int] = ((array > 0.0) & (array < MANGLED)).nonzero()[0].tolist()
        return found
    # There are hardly ever any, and without their indices the search takes half the time.
    if not [number for number in numbers if 0.0 < number < MANGLED]:
        return ()
    return [index for index, number in enumerate(numbers) if 0.0 < number < MANGLED]


class _Plan(NamedTuple):
    """The fields of a type of messages that are checked, and functions that return all of their values."""

    number_paths: tuple[str, ...]
    numbers: Callable[[object], tuple[float, ...]]
    list_paths: tuple[str, ...]
    lists: Callable[[object], tuple[Sequence[object], ...]]


_PLANS: Final[dict[type, _Plan]] = {}


def _plan(message_type: type) -> _Plan:
    if message_type not in _PLANS:
        empty, others = message_type(), (bool, int, float, str, bytes)
        found = [leaf for name in field_names(empty) for leaf in leaves_of(name, getattr(empty, name))]
        numbers = tuple(leaf.path for leaf in found if isinstance(leaf.default, float))
        lists = tuple(leaf.path for leaf in found if not isinstance(leaf.default, others))
        read_numbers, read_lists = values_of(message_type, numbers), values_of(message_type, lists)
        _PLANS[message_type] = _Plan(numbers, read_numbers, lists, read_lists)
    return _PLANS[message_type]
