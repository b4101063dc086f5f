# SPDX-License-Identifier: Apache-2.0
"""The base class of the library's records: a short `repr`, a readable `str`, and a JSON-compatible `dict`."""

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
"""Significant digits of a displayed number. `to_dict` keeps all digits."""

_MAX_SHOWN: Final = 9
"""Maximum number of elements of a displayed array or list. Longer ones are displayed as their shape."""


_PUT: Final[dict[type[Record], tuple[Callable[[Record, object], None], ...]]] = {}
"""The field setters that `made` uses, cached for each class."""

_NUMBERS: Final = (float, Decimal, Fraction, np.floating)


class MembersInHelp(enum.EnumMeta):
    """The metaclass of enumerations whose help lists the members with their descriptions in the source."""

    @property
    def __doc__(cls) -> str:  # type: ignore[override]  # computed on access, since it reads the source
        """The enumeration's own text, and its members."""
        own = inspect.cleandoc(vars(cls).get("__doc__") or "")
        texts = _texts_of_members(cls)
        found = vars(cls)["_member_map_"].items()
        members = [f"    {name}: {texts.get(name, repr(one))}" for name, one in found]
        return "\n".join([own, "", "Members:", *members]) if members else own

    if not TYPE_CHECKING:

        def __getattr__(cls, name: str) -> Any:
            """Return a member, as older Python versions require, or raise an error that lists the members."""
            members = vars(cls).get("_member_map_", {})
            if name.startswith("_") or name in members:
                return members[name] if name in members else type.__getattribute__(cls, name)
            near = difflib.get_close_matches(name, members, n=1)
            meant = f", did you mean {near[0]}?" if near else "."
            raise AttributeError(f"{cls.__name__} has no member {name!r}{meant} It has {', '.join(members)}")


@functools.cache
def _texts_of_members(cls: type) -> dict[str, str]:
    """Return the description that follows each member in the source, if the source is available."""
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
    """An enumeration of integers, as in messages, that prints as its name in every Python version."""

    def __str__(self) -> str:
        """Return the name."""
        return self.name

    def __format__(self, spec: str) -> str:
        """Return the name, formatted as a string."""
        return format(self.name, spec)


_LINE: Final = 100
"""Characters of a displayed line."""

_LONGEST_ARRAY: Final = 75
"""Maximum characters of a displayed array. A longer array is displayed as its shape."""

_LINES: Final = 20
"""Maximum lines of a printed value."""

_MAX_TABLE: Final = 5
"""Maximum rows and columns of an array that is displayed row by row if there is room."""

_FEW: Final = 4
"""Minimum lines available for a list of records that is displayed in part."""


class Record:
    """A value with named fields, created by `dataclasses.dataclass` with ``repr=False``.

    Internal fields are not displayed: those whose name begins with an underscore, functions, and fields with
    ``field(repr=False)``. If a record validates its fields in ``__post_init__``, their types are checked
    first.
    """

    __slots__ = ()

    def __init_subclass__(cls) -> None:
        """Add the checks of names and types of fields, once: `dataclass` recreates a class with slots."""
        post_init, init = vars(cls).get("__post_init__"), vars(cls).get("__init__")
        if post_init is not None and not hasattr(post_init, "__wrapped__"):
            type.__setattr__(cls, "__post_init__", checks_fields(post_init, inspect.get_annotations(cls)))
        if init is not None and not hasattr(init, "__wrapped__"):
            type.__setattr__(cls, "__init__", checks_names(init))
        super().__init_subclass__()

    if not TYPE_CHECKING:  # type checkers know the attributes

        def __getattr__(self, name: str) -> Any:
            """Raise an error for an unknown attribute that suggests the one probably meant."""
            if name.startswith("_") or hasattr(type(self), name):
                return object.__getattribute__(self, name)  # a property's own error
            raise AttributeError(no_attribute(self, name))

    def __repr__(self) -> str:
        """Return the fields, as many as fit into one line."""
        return _in_a_line(self, _LINE)

    def __str__(self) -> str:
        """Return a summary, and below it the fields, in at most 20 lines."""
        gist = textwrap.wrap(self.in_short(), _LINE, subsequent_indent="  ", break_on_hyphens=False)
        return "\n".join([*gist, *_lines(self, _LINES - len(gist))])

    def in_short(self) -> str:
        """Return a summary in a few words. Results whose summary is not one of their fields override this."""
        return type(self).__name__

    def _repr_html_(self) -> str:
        """Return the fields as a table for notebooks. Nested fields expand on a click."""
        return _table(self)

    def to_dict(self) -> dict[str, Any]:
        """Return the fields by name, as JSON-compatible numbers, strings, lists and dicts.

        Enumeration members are represented by name, and non-finite numbers, which JSON lacks, by the strings
        "nan", "inf" and "-inf", which `float` accepts.
        """
        return {name: _plain(value) for name, value in _fields(self)}


def made(cls: type[Made], *values: object) -> Made:
    """Return a record of unchecked values, one for each field that its own class defines.

    It takes a third of the time of a constructor call.
    """
    record, puts = object.__new__(cls), _PUT.get(cls) or _puts_of(cls)
    if len(values) != len(puts):
        raise AssertionError
    for put, value in zip(puts, values):  # noqa: B905  `strict` takes longer
        put(record, value)
    return record


def _puts_of(cls: type[Record]) -> tuple[Callable[[Record, object], None], ...]:
    """Return the setter of each field, which also works on frozen records."""
    return _PUT.setdefault(
        cls, tuple([vars(cls)[name].__set__ for name in cast("tuple[str, ...]", cls.__slots__)])
    )


class Rows(Record):
    """A result for many cases or times, whose arrays have one row for each."""

    __slots__ = ()

    def to_frame(self) -> Any:
        """Return the result as a pandas `DataFrame` with one row for each case or time.

        Each component of a vector has a column, such as ``v_WB_W.x``. Components of other arrays are numbered
        from 0. Fields that are None or equal for all rows are omitted.

        Raises:
            NotSupportedError: pandas is not installed.
        """
        try:
            import pandas as pd  # few need it
        except ModuleNotFoundError:
            raise NotSupportedError("to_frame needs pandas: pip install pandas") from None
        return pd.DataFrame(dict(_columns("", self)))


def _columns(prefix: str, rows: Rows) -> Iterator[tuple[str, Any]]:
    """Yield the name and values of each column."""
    for name, value in _fields(rows):
        if isinstance(value, Rows):
            yield from _columns(f"{prefix}{name}.", value)
        elif isinstance(value, np.ndarray):
            for index in np.ndindex(value.shape[1:]):
                is_vector = value.shape[1:] in {(3,), (4,)}
                parts = ["xyzw"[k] if is_vector else str(k) for k in index]
                yield ".".join([prefix + name, *parts]), value[(slice(None), *index)]


def _fields(record: object) -> list[tuple[str, Any]]:
    """Return the displayed fields and their values."""
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
    """Return a value as JSON-compatible types."""
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
    """Return the entries of a list, or their number if they are records or too many."""
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
    """Return an array in which numbers within the rounding of the largest are zero."""
    if array.dtype.kind != "f" or not np.isfinite(array).all():
        return array
    return np.where(abs(array) < SHOWN_AS_ZERO * abs(array).max(initial=0.0), 0.0, array)


def _in_a_line(record: Record, longest: int) -> str:
    """Return as many fields of a record as fit in one line."""
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
    """Return a line for each field, followed by lines for nested fields if there is room."""
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
    """Return the fields as an HTML table."""
    rows = "".join(
        f'<tr><th style="text-align:left">{html.escape(name)}</th>'
        f'<td style="text-align:left">{_cell(value)}</td></tr>'
        for name, value in _fields(record)
    )
    return f"<table><caption>{type(record).__name__}</caption>{rows}</table>"


def _cell(value: Any) -> str:
    """Return a table cell. Nested records, and lists of them, are collapsed until they are clicked."""
    if isinstance(value, Record):
        return f"<details><summary>{type(value).__name__}</summary>{_table(value)}</details>"
    if isinstance(value, tuple | list) and value and all(isinstance(each, Record) for each in value):
        tables = "".join(_table(each) for each in value[:_MAX_SHOWN])
        more = f"<p>and {len(value) - _MAX_SHOWN} more</p>" if len(value) > _MAX_SHOWN else ""
        return f"<details><summary>{len(value)} entries</summary>{tables}{more}</details>"
    return html.escape(_short(value))
