# SPDX-License-Identifier: Apache-2.0
"""Converts `builtin_interfaces/Time` to whole nanoseconds and back.

Seconds since 1970 as a float would be 0.24 us apart.
"""

from __future__ import annotations

from builtin_interfaces.msg import Time

from contact_dynamics.constants import NS_PER_S


def stamp_ns_from_msg(msg: Time) -> int:
    """Return a stamp in ns."""
    return int(msg.sec) * NS_PER_S + int(msg.nanosec)


def stamp_to_msg(stamp_ns: int, *, into: Time | None = None) -> Time:
    """Return a stamp in ns as a message, which is new unless one to fill is given."""
    msg = Time() if into is None else into
    msg.sec, msg.nanosec = divmod(int(stamp_ns), NS_PER_S)
    return msg
