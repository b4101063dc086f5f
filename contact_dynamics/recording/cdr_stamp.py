# SPDX-License-Identifier: Apache-2.0
"""Reads stamps and identities from serialised messages (CDR) without a message class.

CDR has four bytes of encapsulation, the second of which gives the byte order. Then come the fields, each
aligned to its own size, counted from the fifth byte. So a message that begins with a ``std_msgs/Header`` or a
time has int32 seconds and uint32 nanoseconds at bytes 4 and 8. A service event begins with
``service_msgs/ServiceEventInfo``: uint8 event type at 4, stamp at 8 and 12, 16 bytes of client identity at
16, int64 sequence number at 36 (aligned to 8).
"""

from __future__ import annotations

import enum
import struct
from typing import Any, Final, NamedTuple

from contact_dynamics.constants import NS_PER_S
from contact_dynamics.errors import InvalidFieldError

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
    """The head of a service event: who asked, and when."""

    event_type: EventType  # whether this is a request or a response, at the client or the server
    stamp_ns: int  # time of the clock that was given to ``configure_introspection``, ns
    client_gid: bytes  # 16 bytes that identify the client within this session
    sequence_number: int  # number of the request among those of that client


def leading_stamp_ns(data: bytes) -> int:
    """Return the stamp, in ns, of a serialised message that begins with a ``std_msgs/Header`` or a time."""
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
