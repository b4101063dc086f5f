"""The base class of the library's values: a short `repr`, a readable `str`, and a `dict` that JSON takes."""

from __future__ import annotations

import dataclasses
import enum
import html
import inspect
import math
from collections.abc import Iterable, Mapping
from decimal import Decimal
from fractions import Fraction
from typing import Any, Final, TypeVar

import numpy as np

from contact_dynamics.validation_types import check_names, checks_fields

Made = TypeVar("Made", bound="Record")

_DIGITS: Final = 6
"""Significant digits of a number that is shown. `to_dict` keeps all of them."""

_MAX_SHOWN: Final = 9
"""Largest number of elements of an array or a list that is shown. Longer ones are shown as their shape."""


_NUMBERS: Final = (float, Decimal, Fraction, np.floating)


class NamedInt(enum.IntEnum):
    """An enumeration of whole numbers, as messages have them, that prints as its name on every Python."""

    def __str__(self) -> str:
        """Return the name."""
        return self.name

    def __format__(self, spec: str) -> str:
        """Return the name, laid out as a string is."""
        return format(self.name, spec)


_LINE: Final = 100
"""Up to this number of letters, a value in a list is shown in one line. A longer one has a line for each
field."""


class Record:
    """A value of named fields, made by `dataclasses.dataclass` with ``repr=False``.

    Fields whose name begins with an underscore, functions, and fields of ``field(repr=False)``, which are how
    a value works inside, are not shown. A record that checks its fields when it is made, in
    ``__post_init__``, has their types checked first.
    """

    __slots__ = ()

    def __new__(cls: type[Made], *_: object, **fields: object) -> Made:  # noqa: PYI019  Python 3.10 has no Self
        """Refuse fields of names that there are not. The error names the one that was probably meant."""
        if fields:
            check_names(cls, fields)
        return object.__new__(cls)

    def __init_subclass__(cls) -> None:
        """Have the types of fields checked, once, although `dataclass` makes a class with slots anew."""
        post_init = vars(cls).get("__post_init__")
        if post_init is not None and not hasattr(post_init, "__wrapped__"):
            type.__setattr__(cls, "__post_init__", checks_fields(post_init, inspect.get_annotations(cls)))

    def __repr__(self) -> str:
        """Return the fields in one line: short numbers, names of enumerations, shapes of long arrays."""
        shown = ", ".join(f"{name}={_short(value)}" for name, value in _fields(self))
        return f"{type(self).__name__}({shown})"

    def __str__(self) -> str:
        """Return the fields, one on each line."""
        return "\n".join([type(self).__name__, *_lines(self, "  ")])

    def _repr_html_(self) -> str:
        """Return the fields as a table, which notebooks show. Fields of fields open with a click."""
        return _table(self)

    def to_dict(self) -> dict[str, Any]:
        """Return the fields by name, as plain numbers, strings, lists and dicts that JSON takes.

        Enumerations stand by name. Numbers that are not finite, which JSON does not have, are the strings
        "nan", "inf" and "-inf", which `float` takes.
        """
        return {name: _plain(value) for name, value in _fields(self)}


def _fields(record: object) -> list[tuple[str, Any]]:
    """Return the fields that are shown, and their values."""
    if isinstance(record, tuple):
        return list(record._asdict().items())  # type: ignore[attr-defined]  # a NamedTuple
    return [
        (field.name, value)
        for field in dataclasses.fields(record)  # type: ignore[arg-type]
        if field.repr
        and not field.name.startswith("_")
        and not callable(value := getattr(record, field.name))
    ]


def _has_fields(value: object) -> bool:
    return (dataclasses.is_dataclass(value) and not isinstance(value, type)) or hasattr(value, "_asdict")


def _plain(value: Any) -> Any:
    """Return a value as JSON has it."""
    plain: Any
    if isinstance(value, enum.Enum):
        plain = value.name
    elif value is None or isinstance(value, str | bool | int):
        plain = value
    elif isinstance(value, _NUMBERS):
        number = float(value)
        plain = number if math.isfinite(number) else str(number)
    elif isinstance(value, np.ndarray | np.generic):
        plain = _plain(value.tolist())
    elif _has_fields(value):
        plain = {name: _plain(inner) for name, inner in _fields(value)}
    elif isinstance(value, Mapping):
        plain = {str(_plain(key)): _plain(inner) for key, inner in value.items()}
    elif isinstance(value, Iterable):
        plain = [_plain(inner) for inner in value]
    else:
        plain = str(value)
    return plain


def _short(value: Any) -> str:
    """Return a value in a few words."""
    if isinstance(value, enum.Enum):
        shown = value.name
    elif isinstance(value, _NUMBERS):
        shown = f"{float(value):.{_DIGITS}g}"
    elif isinstance(value, np.ndarray):
        shown = _short(value.tolist()) if value.size <= _MAX_SHOWN else f"array of shape {value.shape}"
    elif _has_fields(value) and not isinstance(value, Record):
        shown = f"{type(value).__name__}(...)"
    elif isinstance(value, list | tuple | frozenset | set | Mapping) and len(value) > _MAX_SHOWN:
        shown = f"{len(value)} entries"
    elif isinstance(value, tuple):
        shown = "(" + ", ".join(map(_short, value)) + ")"
    elif isinstance(value, list):
        shown = "[" + ", ".join(map(_short, value)) + "]"
    else:
        shown = repr(value)
    return shown


def _lines(record: object, indent: str) -> list[str]:
    """Return a line for each field. Fields of fields are indented."""
    named = _fields(record)
    width = max((len(name) for name, _ in named), default=0)
    lines = []
    for name, value in named:
        if isinstance(value, Record):
            lines += [f"{indent}{name}: {type(value).__name__}", *_lines(value, indent + "  ")]
        elif isinstance(value, tuple | list) and value and all(isinstance(each, Record) for each in value):
            lines.append(f"{indent}{name}:")
            for i, each in enumerate(value):
                if len(repr(each)) <= _LINE:
                    lines.append(f"{indent}  [{i}] {each!r}")
                else:
                    lines += [f"{indent}  [{i}] {type(each).__name__}", *_lines(each, indent + "    ")]
        else:
            lines.append(f"{indent}{name:{width}}  {_short(value)}")
    return lines


def _table(record: object) -> str:
    """Return the fields as a table in HTML."""
    rows = "".join(
        f'<tr><th style="text-align:left">{html.escape(name)}</th>'
        f'<td style="text-align:left">{_cell(value)}</td></tr>'
        for name, value in _fields(record)
    )
    return f"<table><caption>{type(record).__name__}</caption>{rows}</table>"


def _cell(value: Any) -> str:
    """Return a value in a table. Other results, and lists of them, are closed until they are clicked."""
    if isinstance(value, Record):
        return f"<details><summary>{type(value).__name__}</summary>{_table(value)}</details>"
    if isinstance(value, tuple | list) and value and all(isinstance(each, Record) for each in value):
        tables = "".join(_table(each) for each in value[:_MAX_SHOWN])
        more = f"<p>and {len(value) - _MAX_SHOWN} more</p>" if len(value) > _MAX_SHOWN else ""
        return f"<details><summary>{len(value)} entries</summary>{tables}{more}</details>"
    return html.escape(_short(value))
