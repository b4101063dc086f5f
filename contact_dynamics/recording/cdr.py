# SPDX-License-Identifier: Apache-2.0
"""Deserialises messages (CDR) by the type definitions in the log alone.

A message begins with four bytes of encapsulation, the second of which gives the byte order. Its fields follow
one another. A number is aligned to its own size, counted from the fifth byte. A string is its length with the
closing zero, as uint32, and its bytes. A sequence is its count, as uint32, and its elements.

Source: OMG, Real-time Publish-Subscribe Wire Protocol 2.2, section 10; ROS 2 calls it ``cdr``.

A message that begins with a ``std_msgs/Header`` or a time has int32 seconds and uint32 nanoseconds at bytes
4 and 8. A service event begins with ``service_msgs/ServiceEventInfo``: uint8 event type at 4, stamp at 8 and
12, 16 bytes of client identity at 16, int64 sequence number at 36. These are read without the type.

Each type is compiled once. Consecutive numbers, also across nested messages, are read by one `struct` for
each alignment of their first byte modulo eight, which depends on the length of the strings before them.

The library `mcap` returns messages as bytes. `mcap-ros2-support` rejects types with an underscore in their
name, such as the events of services.
"""

from __future__ import annotations

import enum
import itertools
import struct
import sys
from array import array
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Final, NamedTuple, TypeAlias

import numpy as np

from contact_dynamics.constants import NS_PER_S
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.recording.message_types import PRIMITIVES, Field, Message, message_types

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from contact_dynamics.recording.bag_reader import LoggedMessage
    from contact_dynamics.recording.definitions import TypeDefinition

    Build: TypeAlias = Callable[[list[Any]], Any]
    Read: TypeAlias = Callable[[bytes, int, list[Any]], int]

_HEAD: Final = 4  # bytes of encapsulation
_CDR: Final = {0: ">", 1: "<"}  # second byte: byte order
_NATIVE: Final = "<" if sys.byteorder == "little" else ">"
_ALIGNMENT: Final = 8  # bytes, the largest
_NOTHING: Final = "x"  # a byte that means nothing
_STRING: Final = "s"
_SIZES: Final = {code: struct.calcsize(f"<{code}") for code in PRIMITIVES.values()} | {
    _NOTHING: 1,
    _STRING: 4,  # preceded by its length
}

_Part: TypeAlias = tuple[str, int | None]
"""Code of a number, and how many there are in an array of fixed length, or None for a single one."""


def decode_without_ros(message: LoggedMessage) -> Message:
    """Return the message logged, with the fields of its type; of a service's event, those of the event.

    Raises:
        InvalidFieldError: the log does not describe its type, or the bytes are no message of it.
    """
    if not message.definition:
        raise InvalidFieldError(message.topic, f"no text of {message.type_name}", "its fields, as ros2msg")
    return deserialize(message.data, _type_of(message.type_name, message.definition))


def deserialize(data: bytes, message_type: type[Message]) -> Message:
    """Return the message of a type that the bytes are, or raise `InvalidFieldError`."""
    return _message_and_end(data, message_type)[0]


def _message_and_end(data: bytes, message_type: type[Message]) -> tuple[Message, int]:
    """Return the deserialised message and the position of its end."""
    if len(data) < _HEAD or data[0] != 0 or data[1] not in _CDR:
        raise InvalidFieldError("data", f"bytes that begin with {data[:_HEAD].hex()}", "CDR: 0000 or 0001")
    try:
        kind: Any = message_type  # classes are hashable, which not all tools know
        plan = _plan(kind, _CDR[data[1]])
        return plan.message_at(data, _HEAD)
    except (struct.error, ValueError, OverflowError, RecursionError) as error:
        expected = f"a serialised {message_type.__name__} ({error})"
        raise InvalidFieldError("data", f"{len(data)} bytes", expected) from None


def decode_columns(messages: Sequence[LoggedMessage]) -> tuple[Message, NDArray[np.intp]]:
    """Return many messages of a topic as one, whose numbers are arrays with a row for each of them.

    Only messages with the type, the length and the strings of the first one are included. The second result
    is their indices in ``messages``; it is empty if the type has sequences. The errors are those of
    `decode_without_ros` for the first one.
    """
    first = messages[0]
    one, order, at = decode_without_ros(first), _CDR[first.data[1]], _HEAD
    kind: Any = type(one)
    plan = _plan(kind, order)
    if not plan.parts:
        return one, np.zeros(0, dtype=np.intp)
    looks = first.type_name, first.definition, len(first.data)
    places = [i for i, m in enumerate(messages) if (m.type_name, m.definition, len(m.data)) == looks]
    table = np.frombuffer(b"".join([messages[i].data for i in places]), np.uint8).reshape(len(places), -1)
    alike = (table[:, :_HEAD] == table[0, :_HEAD]).all(axis=1)
    values: list[Any] = []
    for code, count in plan.parts:
        at += (_HEAD - at) % _SIZES[code]
        size = _SIZES[code] * (1 if count is None else count)
        if code == _STRING:
            size += int(table[0, at : at + size].view(f"{order}I")[0])
            alike &= (table[:, at : at + size] == table[0, at : at + size]).all(axis=1)
            values.append(table[0, at + _SIZES[code] : at + size - 1].tobytes().decode())
        elif code != _NOTHING:
            column = np.ascontiguousarray(table[:, at : at + size]).view(f"{order}{code}").astype(code)
            values.append(column[:, 0] if count is None else column)
        at += size
    rows = [value if isinstance(value, str) else value[alike] for value in values]
    return plan.build(rows), np.array(places)[alike]


def cut_to_its_end(data: bytes, definition: TypeDefinition) -> bytes:
    """Return a serialised message without the bytes after its end.

    ``rclpy.serialization.serialize_message`` appends some bytes of uninitialised memory.
    """
    _, end = _message_and_end(data, _type_of(definition.type_name, definition.text))
    return data[:end]


@lru_cache(maxsize=256)
def _type_of(type_name: str, definition: str) -> type[Message]:
    package, _, name = type_name.partition("/")
    return message_types(type_name, definition)[f"{package}/{name.rpartition('/')[2]}"]


class _Plan(NamedTuple):
    """A compiled reader of a type: it reads all values in order, then builds objects from them."""

    reads: tuple[Read, ...]
    build: Build
    parts: tuple[_Part, ...]  # the numbers and strings of the type; empty if it has sequences

    def message_at(self, data: bytes, at: int) -> tuple[Message, int]:
        """Return the message that begins at a position, and the position of its end."""
        values: list[Any] = []
        for read in self.reads:
            at = read(data, at, values)
        return self.build(values), at


def _is_of_numbers(part: _Part | Read) -> bool:
    return isinstance(part, tuple) and part[0] != _STRING


@lru_cache(maxsize=512)
def _plan(message_type: Any, order: str) -> _Plan:
    """Return the compiled reader of a type, which is a subclass of `Message`."""
    parts: list[_Part | Read] = []
    places = itertools.count()  # indices of the values

    def add(owner: type[Message]) -> Build:
        """Add the parts of a message, and return a function that builds it from the values."""
        singles: list[tuple[str, int]] = []
        nested: list[tuple[str, Build]] = []
        if not owner.FIELDS:
            parts.append((_NOTHING, None))  # a type without fields has one padding byte
        for field in owner.FIELDS:
            code = PRIMITIVES.get(field.type_name)
            if not field.is_array and field.type_name in owner.TYPES:
                nested.append((field.name, add(owner.TYPES[field.type_name])))
                continue
            if code is not None and (not field.is_array or field.count is not None):
                parts.append((code, field.count if field.is_array else None))
            else:
                parts.append(_several(field, owner, order) if field.is_array else (_STRING, None))
            singles.append((field.name, next(places)))
        return _building(owner, singles, nested)

    build = add(message_type)
    reads: list[Read] = []
    for are_numbers, group in itertools.groupby(parts, _is_of_numbers):
        numbers: Any = tuple(group)
        if are_numbers:
            reads.append(_numbers(numbers, order))
        else:
            reads += [_string(order) if isinstance(part, tuple) else part for part in numbers]
    fixed = tuple(part for part in parts if isinstance(part, tuple))
    return _Plan(tuple(reads), build, fixed if len(fixed) == len(parts) else ())


def _building(
    message_type: type[Message], singles: list[tuple[str, int]], parts: list[tuple[str, Build]]
) -> Build:
    """Return a function that builds a message: ``singles`` are indices of values, ``parts`` build others."""
    make = message_type.__new__

    def build(values: list[Any]) -> Any:
        made = make(message_type)
        fields = made.__dict__
        for name, place in singles:
            fields[name] = values[place]
        for name, part in parts:
            fields[name] = part(values)
        return made

    return build


def _numbers(numbers: tuple[_Part, ...], order: str) -> Read:
    """Return a function that reads consecutive numbers and arrays of fixed lengths."""
    layouts: dict[int, struct.Struct] = {}
    arrays: list[tuple[int, str, int]] = []  # index among the values, type code, length
    index = 0
    for code, count in numbers:
        if count is not None:
            arrays.append((index, code, count))
        index += code != _NOTHING

    def read(data: bytes, at: int, values: list[Any]) -> int:
        offset = (at - _HEAD) % _ALIGNMENT
        layout = layouts.get(offset)
        if layout is None:
            layout = layouts[offset] = struct.Struct(_layout(numbers, order, offset))
        found = layout.unpack_from(data, at)
        if arrays:
            begin = len(values)
            values.extend(found)
            for place, code, count in arrays:
                values[begin + place] = _fixed(values[begin + place], code, count, order)
        else:
            values.extend(found)
        return at + layout.size

    return read


def _layout(numbers: tuple[_Part, ...], order: str, offset: int) -> str:
    """Return the format of numbers that begin ``offset`` bytes after an aligned position."""
    parts = [order]
    for code, count in numbers:
        size = _SIZES[code]
        gap = -offset % size if count != 0 else 0
        parts.append("x" * gap)
        parts.append(code if count is None else f"{size * count}s")
        offset += gap + size * (1 if count is None else count)
    return "".join(parts)


def _fixed(raw: bytes, code: str, count: int, order: str) -> Any:
    if code == "?":
        return list(struct.unpack(f"{count}?", raw))
    return np.frombuffer(raw, dtype=np.dtype(f"{order}{code}")).astype(code)  # a writable copy


def _several(field: Field, owner: type[Message], order: str) -> Read:
    """Return a function that reads a sequence, or an array of strings or messages."""
    code = PRIMITIVES.get(field.type_name)
    if code is not None:
        return _sequence_of_numbers(field, code, order)
    string = _string(order)
    length = struct.Struct(f"{order}I")

    def read_strings(data: bytes, at: int, values: list[Any]) -> int:
        strings: list[Any] = []
        number, at = _length(field, length, data, at)
        for _ in range(number):
            at = string(data, at, strings)
        values.append(strings)
        return at

    def read_messages(data: bytes, at: int, values: list[Any]) -> int:
        kind: Any = owner.TYPES[field.type_name]
        plan = _plan(kind, order)  # compiled on use, since a type can contain a sequence of itself
        messages: list[Any] = []
        number, at = _length(field, length, data, at)
        for _ in range(number):
            made, at = plan.message_at(data, at)
            messages.append(made)
        values.append(messages)
        return at

    return read_strings if field.type_name == "string" else read_messages


def _sequence_of_numbers(field: Field, code: str, order: str) -> Read:
    length = struct.Struct(f"{order}I")
    size = _SIZES[code]

    def read(data: bytes, at: int, values: list[Any]) -> int:
        number, at = _length(field, length, data, at)
        raw = b""
        if number > 0:
            at += (_HEAD - at) % size
            raw = _bytes(data, at, number * size)
        if code == "?":
            values.append(list(struct.unpack(f"{number}?", raw)))
        else:
            numbers = array(code)
            numbers.frombytes(raw)
            if order != _NATIVE:
                numbers.byteswap()
            values.append(numbers)
        return at + len(raw)

    return read


def _length(field: Field, length: struct.Struct, data: bytes, at: int) -> tuple[int, int]:
    """Return the number of elements and the position of the first one."""
    if field.count is not None:
        number = field.count
    else:
        at += (_HEAD - at) % length.size
        (number,) = length.unpack_from(data, at)
        at += length.size
    if number > len(data) - at:  # each takes at least one byte
        raise ValueError(f"{field.name} claims {number} elements, {len(data) - at} bytes are left")
    return number, at


def _string(order: str) -> Read:
    length = struct.Struct(f"{order}I")

    def read(data: bytes, at: int, values: list[Any]) -> int:
        at += (_HEAD - at) % length.size
        (count,) = length.unpack_from(data, at)
        raw = _bytes(data, at + length.size, count)
        values.append(raw[:-1].decode("utf-8") if raw else "")
        return at + length.size + count

    return read


def _bytes(data: bytes, at: int, count: int) -> bytes:
    raw = data[at : at + count]
    if len(raw) < count:
        raise ValueError(f"{count} bytes are due at {at}, {len(raw)} are left")
    return raw


_LITTLE_ENDIAN: Final = 1
_LEADING_STAMP: Final = {True: struct.Struct("<4xiI"), False: struct.Struct(">4xiI")}
_EVENT_TYPE_AT: Final = 4
_EVENT_INFO: Final = {True: struct.Struct("<4xB3xiI16s4xq"), False: struct.Struct(">4xB3xiI16s4xq")}


class EventType(enum.IntEnum):
    """The kinds of service events, with the values of ``service_msgs/ServiceEventInfo``."""

    REQUEST_SENT = 0
    REQUEST_RECEIVED = 1
    RESPONSE_SENT = 2
    RESPONSE_RECEIVED = 3


_EVENT_TYPES: Final = tuple(EventType)


class EventInfo(NamedTuple):
    """The head of a service event: the client and the time."""

    event_type: EventType  # whether this is a request or a response, at the client or the server
    stamp_ns: int  # time of the clock that was given to ``configure_introspection``, ns
    client_gid: bytes  # 16 bytes that identify the client within this session
    sequence_number: int  # number of the request among those of that client


def leading_stamp_ns(data: bytes) -> int:
    """Return the stamp, ns, of a serialised message that begins with a ``std_msgs/Header`` or a time."""
    seconds, nanoseconds = _unpack(_LEADING_STAMP, data)
    return int(seconds) * NS_PER_S + int(nanoseconds)


def event_info(data: bytes) -> EventInfo:
    """Return the head of a serialised service event."""
    kind, seconds, nanoseconds, gid, sequence_number = _unpack(_EVENT_INFO, data)
    if kind >= len(_EVENT_TYPES):
        raise InvalidFieldError("event_type", kind, "0 to 3")
    return EventInfo(_EVENT_TYPES[kind], seconds * NS_PER_S + nanoseconds, gid, sequence_number)


def event_type_of(data: bytes) -> int | None:
    """Return the kind of a serialised service event, or None if these bytes are too few for one."""
    return data[_EVENT_TYPE_AT] if len(data) > _EVENT_TYPE_AT else None


def _unpack(layout: dict[bool, struct.Struct], data: bytes) -> tuple[Any, ...]:
    try:
        return layout[data[1] == _LITTLE_ENDIAN].unpack_from(data)
    except (IndexError, struct.error):
        raise InvalidFieldError("data", f"{len(data)} bytes", "a serialised message of this type") from None
