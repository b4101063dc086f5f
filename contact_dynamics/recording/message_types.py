# SPDX-License-Identifier: Apache-2.0
"""Converts logged bytes to message objects: of ROS's classes, or of classes made from the log's definitions.

The latter require no ROS. A log contains the full text of each type (`definitions`), from which a class with
the fields, defaults and constants of the type is made. Code that reads ROS messages can read its objects too.

Not covered: texts in encodings other than MCAP's ros2msg; wide strings.
"""

from __future__ import annotations

import importlib
import re
from array import array
from dataclasses import dataclass, field
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.recording.definitions import EVENT_SUFFIX

if TYPE_CHECKING:
    from collections.abc import Mapping

    from contact_dynamics.recording.bag_reader import LoggedMessage


PRIMITIVES: Final = {  # the numeric types with their codes in the `struct` module
    "bool": "?", "byte": "B", "char": "B", "int8": "b", "uint8": "B", "int16": "h", "uint16": "H",
    "int32": "i", "uint32": "I", "int64": "q", "uint64": "Q", "float32": "f", "float64": "d",
}  # fmt: skip

_HEADING: Final = re.compile(r"^=+\r?\nMSG: (\S+)\r?$", re.MULTILINE)
_LINE: Final = re.compile(
    r"(?P<type>[A-Za-z][\w/]*)(?:<=\d+)?(?P<array>\[(?:<=)?(?P<count>\d*)\])?\s+(?P<name>\w+)\s*(?P<rest>.*)"
)
_BOUNDED: Final = "<="


@dataclass(frozen=True, slots=True, kw_only=True)
class Field:
    """A field of a message."""

    name: str
    type_name: str  # a key of `PRIMITIVES`, "string", or "package/Name"
    is_array: bool = False  # whether it is an array or a sequence
    count: int | None = None  # the number of elements, or None for a sequence
    default: Any = None  # the default in the definition, or None if it has none
    # The names of its values: the constants of its type that precede it in the definition.
    names: Mapping[Any, str] = field(default_factory=dict, compare=False)


class Message:
    """A message of a type that a log describes.

    Attributes:
        FIELDS: The fields of the type.
        TYPES: The types of nested messages, by "package/Name".
    """

    FIELDS: ClassVar[tuple[Field, ...]] = ()
    TYPES: ClassVar[dict[str, type[Message]]] = {}

    def __init__(self, **values: Any) -> None:
        """Set each field to its value, or to its default."""
        for each in self.FIELDS:
            setattr(self, each.name, values[each.name] if each.name in values else self.empty(each))

    @classmethod
    def empty(cls, field: Field) -> Any:
        """Return the default of a field."""
        if field.is_array:
            return cls._empty_array(field)
        if field.type_name in cls.TYPES:
            return cls.TYPES[field.type_name]()
        if field.default is not None:
            return field.default
        return "" if field.type_name == "string" else PYTHON_TYPES[field.type_name]()

    @classmethod
    def _empty_array(cls, field: Field) -> Any:
        code = PRIMITIVES.get(field.type_name)
        if field.default is not None:
            return list(field.default)
        if code is None or code == "?":
            one = Field(name=field.name, type_name=field.type_name)
            return [cls.empty(one) for _ in range(field.count or 0)]
        return array(code) if field.count is None else np.zeros(field.count, dtype=code)


PYTHON_TYPES: Final = {  # the Python type of each of `PRIMITIVES`
    name: {"?": bool, "f": float, "d": float}.get(code, int) for name, code in PRIMITIVES.items()
}


@lru_cache(maxsize=256)
def message_types(type_name: str, definition: str) -> dict[str, type[Message]]:
    """Return the classes of a type and of all its nested types, by "package/Name".

    The ``definition`` is its text in MCAP's ros2msg form. Raise `InvalidFieldError` if a line of it is not
    valid, or a type that it uses is missing.
    """
    package, _, name = type_name.partition("/")[0], "", type_name.rpartition("/")[2]
    first, *others = _HEADING.split(definition)
    texts = {f"{package}/{name}": first, **dict(zip(others[::2], others[1::2], strict=True))}
    types: dict[str, type[Message]] = {}
    for full_name, text in texts.items():
        types[full_name] = _class(full_name, text, types)
    for full_name, made in types.items():
        for each in made.FIELDS:
            if each.type_name not in {*types, *PRIMITIVES, "string"}:
                raise InvalidFieldError(
                    "definition", f"{full_name}.{each.name} of the type {each.type_name}", "types it defines"
                )
    return types


def _class(full_name: str, text: str, types: dict[str, type[Message]]) -> type[Message]:
    package, _, name = full_name.rpartition("/")
    fields: list[Field] = []
    constants: dict[str, Any] = {}
    names: dict[Any, str] = {}  # constants that stand before the next field
    for number, line in enumerate(text.splitlines(), start=1):
        stripped = line.strip()
        if not stripped or stripped.startswith("#"):
            continue
        match = _LINE.fullmatch(stripped)
        if match is None:
            raise InvalidFieldError(
                "definition", f"{full_name}, line {number}: {line!r}", "a type and a name"
            )
        rest = match["rest"]
        if rest.startswith("=") and not match["array"]:
            constants[match["name"]] = value = _value(rest[1:].strip(), match["type"])
            names[value] = match["name"]
            continue
        rest = rest.partition("#")[0].strip() if not rest.startswith(("'", '"')) else rest
        bounded = _BOUNDED in (match["array"] or "")
        fields.append(
            Field(
                name=match["name"],
                type_name=_full(match["type"], package),
                is_array=match["array"] is not None,
                count=int(match["count"]) if match["count"] and not bounded else None,
                default=_default(rest, match["type"], is_array=match["array"] is not None) if rest else None,
                names=names,
            )
        )
        names = {}
    return type(name, (Message,), {"FIELDS": tuple(fields), "TYPES": types, **constants})


def _full(type_name: str, package: str) -> str:
    if type_name in PRIMITIVES or type_name in {"string", "wstring"} or "/" in type_name:
        return type_name.replace("/msg/", "/")
    return "std_msgs/Header" if type_name == "Header" else f"{package}/{type_name}"


def _default(text: str, type_name: str, *, is_array: bool) -> Any:
    if not is_array:
        return _value(text, type_name)
    return [_value(each.strip(), type_name) for each in text.strip("[]").split(",") if each.strip()]


def _value(text: str, type_name: str) -> Any:
    """Return a constant or a default. Text after a number is a comment."""
    if type_name in {"string", "wstring"}:
        quoted = re.match(r"""(["'])(.*)\1""", text)
        return quoted[2] if quoted else text
    word = text.partition("#")[0].strip()
    if type_name == "bool":
        return word.lower() in {"true", "1"}
    try:
        return float(word) if PYTHON_TYPES.get(type_name) is float else int(word, 0)
    except ValueError:
        raise InvalidFieldError("definition", f"{text!r} for a {type_name}", "a number") from None


@cache
def message_class(type_name: str) -> Any:
    """Return the class of ``package/msg/Name``, or the event class of ``package/srv/Name_Event``.

    Raise `InvalidFieldError` if the name has another form, or its package is not installed.
    """
    try:
        package, folder, name = type_name.split("/")
        module = importlib.import_module(f"{package}.{folder}")
        if folder == "srv" and name.endswith(EVENT_SUFFIX):
            return getattr(module, name[: -len(EVENT_SUFFIX)]).Event
        return getattr(module, name)
    except (ValueError, ImportError, AttributeError) as error:
        raise InvalidFieldError(
            "type_name", type_name, f"an interface whose package is installed ({error})"
        ) from error


def decode(message: LoggedMessage) -> Any:
    """Return the logged ROS message. A service's event has ``info``, ``request`` and ``response``."""
    from rclpy.serialization import deserialize_message  # imported here, since logs are also read without ROS

    return deserialize_message(message.data, message_class(message.type_name))
