"""Time at the border: `builtin_interfaces/Time` and int nanoseconds.

Never float seconds since 1970, which are spaced 0.24 us.
"""

from __future__ import annotations

from typing import Final

from builtin_interfaces.msg import Time

NS_PER_S: Final = 1_000_000_000


def stamp_ns_from_msg(msg: Time) -> int:
    """Return a stamp in ns."""
    return int(msg.sec) * NS_PER_S + int(msg.nanosec)


def stamp_to_msg(stamp_ns: int) -> Time:
    """Return a stamp in ns as a message."""
    msg = Time()
    msg.sec, msg.nanosec = divmod(int(stamp_ns), NS_PER_S)
    return msg


def seconds_between(earlier_ns: int, later_ns: int) -> float:
    """Return the duration in s between two stamps in ns."""
    return (later_ns - earlier_ns) / NS_PER_S


def ns_after(stamp_ns: int, seconds: float) -> int:
    """Return the stamp, ns, that is a duration in s after another, to the nearest ns."""
    return stamp_ns + round(seconds * NS_PER_S)
