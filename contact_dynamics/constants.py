# SPDX-License-Identifier: Apache-2.0
"""This file holds the constants that more than one chapter uses, and conversions that follow from them alone.

Stamps are whole nanoseconds and durations are seconds. They are converted here, and in `msg_adapters.stamps`
where they are messages.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

STANDARD_GRAVITY_W: Final = (0.0, 0.0, -9.80665)
"""Standard gravity, m/s^2, world axes, z up (REP 103): the conventional value of the third CGPM, 1901."""

HORIZON: Final = 10.0
"""s, how far a motion is followed if no other time is asked for. A body that is tossed by hand rests within
two."""

DEFAULT_PREDICTIONS: Final = 4
"""Number of latest predictions of a body whose paths are drawn."""

NS_PER_S: Final = 1_000_000_000
"""Nanoseconds in a second."""


def to_ns(seconds: float) -> int:
    """Return a duration, s, to the nearest nanosecond."""
    return round(seconds * NS_PER_S)


def ns_after(stamp_ns: int, seconds: float) -> int:
    """Return the stamp, ns, that is a duration, s, after another, to the nearest ns."""
    return stamp_ns + to_ns(seconds)


def to_seconds(duration_ns: int) -> float:
    """Return a duration, ns, in seconds."""
    return duration_ns / NS_PER_S


def seconds_between(earlier_ns: int, later_ns: int) -> float:
    """Return the duration, s, between two stamps, ns."""
    return to_seconds(later_ns - earlier_ns)


def seconds_since(reference_ns: int, stamps_ns: Sequence[int]) -> NDArray[np.float64]:
    """Return the durations, (n,), s, between one stamp, ns, and many.

    They are products with 1e-9, whose last bit may differ from that of a quotient. Fits of states depend on
    that bit.
    """
    seconds: NDArray[np.float64] = np.array([stamp_ns - reference_ns for stamp_ns in stamps_ns]) * 1e-9
    return seconds
