# SPDX-License-Identifier: Apache-2.0
"""The base class of the library's values: a short `repr`, a readable `str`, and a `dict` that JSON takes."""

from __future__ import annotations

import ast
import dataclasses
import difflib
import enum
import functools
import html
import inspect
import itertools
import math
import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping
from decimal import Decimal
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Final, TypeVar, cast

import numpy as np

from contact_dynamics.errors import NotSupportedError
from contact_dynamics.tolerances import SHOWN_AS_ZERO
from contact_dynamics.validation_types import checks_fields, checks_names, no_attribute

Made = TypeVar("Made", bound="Record")

_DIGITS: Final = 6
"""Significant digits of a number that is shown. `to_dict` keeps all of them."""

_MAX_SHOWN: Final = 9
"""Largest number of elements of an array or a list that is shown. Longer ones are shown as their shape."""


_PUT: Final[dict[type[Record], tuple[Callable[[Record, object], None], ...]]] = {}
"""What `made` puts values into records with, once one of the class was made."""

_NUMBERS: Final = (float, Decimal, Fraction, np.floating)


class MembersInHelp(enum.EnumMeta):
    """The kind of an enumeration whose help lists its members with what the source says of each."""

    @property
    def __doc__(cls) -> str:  # type: ignore[override]  # made where it is asked for, since it reads the source
        """The enumeration's own text, and its members."""
        own = inspect.cleandoc(vars(cls).get("__doc__") or "")
        texts = _texts_of_members(cls)
        found = vars(cls)["_member_map_"].items()
        members = [f"    {name}: {texts.get(name, repr(one))}" for name, one in found]
        return "\n".join([own, "", "Members:", *members]) if members else own

    if not TYPE_CHECKING:

        def __getattr__(cls, name: str) -> Any:
            """Return a member, which older Pythons look for here, or raise an error that names the others."""
            members = vars(cls).get("_member_map_", {})
            if name.startswith("_") or name in members:
                return members[name] if name in members else type.__getattribute__(cls, name)
            near = difflib.get_close_matches(name, members, n=1)
            meant = f", did you mean {near[0]}?" if near else "."
            raise AttributeError(f"{cls.__name__} has no member {name!r}{meant} It has {', '.join(members)}")


@functools.cache
def _texts_of_members(cls: type) -> dict[str, str]:
    """Return the text that follows each member in the source, where there is a source."""
    try:
        (kind,) = ast.parse(textwrap.dedent(inspect.getsource(cls))).body
    except (OSError, TypeError, SyntaxError):
        return {}
    found = {}
    for member, after in itertools.pairwise(getattr(kind, "body", ())):
        match member, after:
            case ast.Assign(targets=[ast.Name(id=name)]), ast.Expr(value=ast.Constant(value=str(text))):
                found[name] = " ".join(text.split())
    return found


class NamedInt(enum.IntEnum, metaclass=MembersInHelp):
    """An enumeration of whole numbers, as messages have them, that prints as its name on every Python."""

    def __str__(self) -> str:
        """Return the name."""
        return self.name

    def __format__(self, spec: str) -> str:
        """Return the name, laid out as a string is."""
        return format(self.name, spec)


_LINE: Final = 100
"""Letters of a line that is shown."""

_LONGEST_ARRAY: Final = 75
"""Letters of an array whose numbers are shown. A longer one is shown as its shape."""

_LINES: Final = 20
"""Lines of a value that is printed."""

_MAX_TABLE: Final = 5
"""Rows and columns of an array that is shown row by row, where there is room."""

_FEW: Final = 4
"""Lines that are worth a list of records of which more follow."""


class Record:
    """A value of named fields, made by `dataclasses.dataclass` with ``repr=False``.

    Fields whose name begins with an underscore, functions, and fields of ``field(repr=False)``, which are how
    a value works inside, are not shown. A record that checks its fields when it is made, in
    ``__post_init__``, has their types checked first.
    """

    __slots__ = ()

    def __init_subclass__(cls) -> None:
        """Have the names and types of fields checked, once: `dataclass` makes a class with slots anew."""
        post_init, init = vars(cls).get("__post_init__"), vars(cls).get("__init__")
        if post_init is not None and not hasattr(post_init, "__wrapped__"):
            type.__setattr__(cls, "__post_init__", checks_fields(post_init, inspect.get_annotations(cls)))
        if init is not None and not hasattr(init, "__wrapped__"):
            type.__setattr__(cls, "__init__", checks_names(init))
        super().__init_subclass__()

    if not TYPE_CHECKING:  # type checkers know which attributes there are

        def __getattr__(self, name: str) -> Any:
            """Raise the error that there is no such attribute, and name the one that was probably meant."""
            if name.startswith("_") or hasattr(type(self), name):
                return object.__getattribute__(self, name)  # a property's own error
            raise AttributeError(no_attribute(self, name))

    def __repr__(self) -> str:
        """Return the fields, as many as fit into one line."""
        return _in_a_line(self, _LINE)

    def __str__(self) -> str:
        """Return what it is in short, and below it the fields, in at most 20 lines."""
        gist = textwrap.wrap(self.in_short(), _LINE, subsequent_indent="  ", break_on_hyphens=False)
        return "\n".join([*gist, *_lines(self, _LINES - len(gist))])

    def in_short(self) -> str:
        """Return what it is in a few words. Results whose gist is not a field of theirs have more to say."""
        return type(self).__name__

    def _repr_html_(self) -> str:
        """Return the fields as a table, which notebooks show. Fields of fields open with a click."""
        return _table(self)

    def to_dict(self) -> dict[str, Any]:
        """Return the fields by name, as plain numbers, strings, lists and dicts that JSON takes.

        Enumerations stand by name. Numbers that are not finite, which JSON does not have, are the strings
        "nan", "inf" and "-inf", which `float` takes.
        """
        return {name: _plain(value) for name, value in _fields(self)}


def made(cls: type[Made], *values: object) -> Made:
    """Return a record of values, one for each field of its own class, that need no checks.

    It takes a third of the time of a call of the class.
    """
    record, puts = object.__new__(cls), _PUT.get(cls) or _puts_of(cls)
    if len(values) != len(puts):
        raise AssertionError
    for put, value in zip(puts, values):  # noqa: B905  `strict` takes longer
        put(record, value)
    return record


def _puts_of(cls: type[Record]) -> tuple[Callable[[Record, object], None], ...]:
    """Return what puts a value into each field, although records are frozen."""
    return _PUT.setdefault(
        cls, tuple([vars(cls)[name].__set__ for name in cast("tuple[str, ...]", cls.__slots__)])
    )


class Rows(Record):
    """A result of many cases or times, whose arrays have a row for each."""

    __slots__ = ()

    def to_frame(self) -> Any:
        """Return the result as a `DataFrame` of pandas, with a row for each case or time.

        Each component of a vector has a column, such as ``v_WB_W.x``. Other arrays count theirs from 0.
        What is None, or the same for all rows, is left out.

        Raises:
            NotSupportedError: pandas is not installed.
        """
        try:
            import pandas as pd  # few need it
        except ModuleNotFoundError:
            raise NotSupportedError("to_frame needs pandas: pip install pandas") from None
        return pd.DataFrame(dict(_columns("", self)))


def _columns(prefix: str, rows: Rows) -> Iterator[tuple[str, Any]]:
    """Yield the columns of a result of many, by their names."""
    for name, value in _fields(rows):
        if isinstance(value, Rows):
            yield from _columns(f"{prefix}{name}.", value)
        elif isinstance(value, np.ndarray):
            for index in np.ndindex(value.shape[1:]):
                is_vector = value.shape[1:] in {(3,), (4,)}
                parts = ["xyzw"[k] if is_vector else str(k) for k in index]
                yield ".".join([prefix + name, *parts]), value[(slice(None), *index)]


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
        is_all_finite = value.dtype.kind == "f" and bool(np.isfinite(value).all())
        plain = value.tolist() if is_all_finite else _plain(value.tolist())
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
    """Return a value in a few words: short numbers, names of enumerations, shapes of long arrays."""
    if isinstance(value, enum.Enum):
        shown = value.name
    elif isinstance(value, _NUMBERS):
        shown = f"{float(value) + 0.0:.{_DIGITS}g}"
    elif isinstance(value, np.ndarray):
        shown = _short(_without_rounding(value).tolist()) if value.size <= _MAX_SHOWN else ""
        if not shown or len(shown) > _LONGEST_ARRAY:
            shown = f"array of shape {value.shape}"
    elif isinstance(value, Record):
        shown = _in_a_line(value, _LINE // 2)
    elif _has_fields(value):
        shown = f"{type(value).__name__}(...)"
    elif isinstance(value, list | tuple | frozenset | set | Mapping):
        shown = _in_words(value)
    else:
        shown = repr(value)
    return shown


def _in_words(values: Any) -> str:
    """Return the entries of a list, or how many there are where they are records, or many."""
    records = {type(each).__name__ for each in values if isinstance(each, Record)}
    if records:
        return f"{len(values)} {' or '.join(sorted(records))}"
    if len(values) > _MAX_SHOWN or isinstance(values, frozenset | set | Mapping):
        return f"{len(values)} entries"
    inside = ", ".join(map(_short, values))
    if isinstance(values, list):
        return f"[{inside}]"
    return f"({inside},)" if len(values) == 1 else f"({inside})"


def _without_rounding(array: Any) -> Any:
    """Return an array whose numbers that are nothing but the rounding of the others are zero."""
    if array.dtype.kind != "f" or not np.isfinite(array).all():
        return array
    return np.where(abs(array) < SHOWN_AS_ZERO * abs(array).max(initial=0.0), 0.0, array)


def _in_a_line(record: Record, longest: int) -> str:
    """Return the fields of a record in one line, as many as fit."""
    name = type(record).__name__
    shown: list[str] = []
    left = longest - len(name) - len("(, ...)")
    for field, value in _fields(record):
        text = f"{field}={_short(value)}"
        left -= len(text) + 2
        if left < 0:
            return f"{name}({', '.join([*shown, '...'])})"
        shown.append(text)
    return f"{name}({', '.join(shown)})"


def _lines(record: Record, count: int) -> list[str]:
    """Return a line for each field. Where there is room, lines for what is in a field follow."""
    named = _fields(record)
    width = max((len(name) for name, _ in named), default=0)
    hidden = named[count - 1 :] if len(named) > count else []
    named = named[: len(named) - len(hidden)]
    room = count - len(named)
    lines = []
    for name, value in named:
        below: list[str] = []
        if isinstance(value, Record) and len(_in_a_line(value, 10 * _LINE)) > _LINE // 2:
            below = [f"{field}={_short(inner)}" for field, inner in _fields(value)]
        elif isinstance(value, tuple | list) and not any(type(each) is type(record) for each in value):
            below = [
                f"[{k}] {_in_a_line(each, _LINE - 8)}"
                for k, each in enumerate(value)
                if isinstance(each, Record)
            ]
        elif isinstance(value, np.ndarray) and value.ndim == 2 and max(value.shape) <= _MAX_TABLE:
            below = [_short(row) for row in value] if value.size > _MAX_SHOWN else []
        if len(below) > room and isinstance(value, tuple | list) and room >= _FEW:
            below = [*below[: room - 1], f"... and {len(below) - room + 1} more"]
        if len(below) <= room:
            room -= len(below)
        else:
            below = []
        text = type(value).__name__ if below and isinstance(value, Record) else _short(value)
        lines.append(_cut(f"  {name:{width}}  {text}"))
        lines += [_cut(f"    {each}") for each in below]
    if hidden:
        lines.append(_cut(f"  and {', '.join(name for name, _ in hidden)}"))
    return lines


def _cut(line: str) -> str:
    return line if len(line) <= _LINE else line[: _LINE - 3] + "..."


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
