"""Serialised messages (CDR) to objects, with nothing but the types' texts in the log.

A message begins with four bytes of encapsulation, of which the second says the byte order. Its fields follow
one after the other. A number is aligned to its own size, counted from the fifth byte. A string is its length
with the closing zero, as uint32, and its bytes. A sequence is its count, as uint32, and its elements.

Source: OMG, Real-time Publish-Subscribe Wire Protocol 2.2, section 10; ROS 2 calls it ``cdr``.

The library `mcap` leaves messages as bytes. `mcap-ros2-support` refuses types with an underscore in their
name, which the events of services have.
"""

from __future__ import annotations

import struct
import sys
from array import array
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.recording.message_types import PRIMITIVES, Field, Message, message_types

if TYPE_CHECKING:
    from contact_dynamics.recording.bag_reader import LoggedMessage

_HEAD: Final = 4  # bytes of encapsulation
_CDR: Final = {0: ">", 1: "<"}  # second byte: byte order
_NATIVE: Final = "<" if sys.byteorder == "little" else ">"
_NUMBERS: Final = {
    order: {name: struct.Struct(order + code) for name, code in PRIMITIVES.items()} for order in "<>"
}


def decode_without_ros(message: LoggedMessage) -> Message:
    """Return the message logged, with the fields of its type, or of its event if it is a service's.

    Raises:
        InvalidFieldError: the log does not describe its type, or the bytes are no message of it.
    """
    if not message.definition:
        raise InvalidFieldError(message.topic, f"no text of {message.type_name}", "its fields, as ros2msg")
    package, _, name = message.type_name.partition("/")
    message_type = message_types(message.type_name, message.definition)[
        f"{package}/{name.rpartition('/')[2]}"
    ]
    return deserialize(message.data, message_type)


def deserialize(data: bytes, message_type: type[Message]) -> Message:
    """Return the message of a type that the bytes are.

    Raises:
        InvalidFieldError: they are none.
    """
    if len(data) < _HEAD or data[0] != 0 or data[1] not in _CDR:
        raise InvalidFieldError("data", f"bytes that begin with {data[:_HEAD].hex()}", "CDR: 0000 or 0001")
    try:
        return _Cursor(data, _CDR[data[1]]).message(message_type)
    except (struct.error, ValueError, RecursionError) as error:
        expected = f"a serialised {message_type.__name__} ({error})"
        raise InvalidFieldError("data", f"{len(data)} bytes", expected) from None


class _Cursor:
    """A place in the bytes of a message."""

    def __init__(self, data: bytes, order: str) -> None:
        self._data = data
        self._at = _HEAD
        self._swap = order != _NATIVE
        self._numbers = _NUMBERS[order]

    def message(self, message_type: type[Message]) -> Message:
        """Return the message that begins here."""
        made = message_type.__new__(message_type)
        for field in message_type.FIELDS:
            value = self._several if field.is_array else self._one
            setattr(made, field.name, value(field, message_type))
        if not message_type.FIELDS:
            self._at += 1  # a type without fields has a byte that means nothing
        return made

    def _one(self, field: Field, owner: type[Message]) -> Any:
        number = self._numbers.get(field.type_name)
        if number is not None:
            self._align(number.size)
            (value,) = number.unpack_from(self._data, self._at)
            self._at += number.size
            return value
        if field.type_name == "string":
            return self._string()
        return self.message(owner.TYPES[field.type_name])

    def _several(self, field: Field, owner: type[Message]) -> Any:
        count = self._length() if field.count is None else field.count
        code = PRIMITIVES.get(field.type_name)
        if count > len(self._data) - self._at:  # each takes a byte at least
            message = f"{field.name} claims {count} elements, {len(self._data) - self._at} bytes are left"
            raise ValueError(message)
        if code is None or code == "?":
            return [self._one(field, owner) for _ in range(count)]
        numbers = array(code)
        if count > 0:
            self._align(numbers.itemsize)
            numbers.frombytes(self._bytes(count * numbers.itemsize))
        if self._swap:
            numbers.byteswap()
        return numbers if field.count is None else np.array(numbers)

    def _string(self) -> str:
        raw = self._bytes(self._length())
        return raw[:-1].decode("utf-8") if raw else ""

    def _length(self) -> int:
        length: int = self._one(_COUNT, Message)
        return length

    def _align(self, size: int) -> None:
        self._at += (_HEAD - self._at) % size

    def _bytes(self, count: int) -> bytes:
        raw = self._data[self._at : self._at + count]
        if len(raw) < count:
            message = f"{count} bytes are due at {self._at}, {len(raw)} are left"
            raise ValueError(message)
        self._at += count
        return raw


_COUNT: Final = Field(name="length", type_name="uint32")
