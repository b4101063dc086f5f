"""Constants that more than one chapter uses."""

from __future__ import annotations

from typing import Final

STANDARD_GRAVITY_W: Final = (0.0, 0.0, -9.80665)
"""m/s^2, world axes, z up (REP 103); the conventional value of the third CGPM, 1901."""

NS_PER_S: Final = 1_000_000_000
"""Nanoseconds in a second. Stamps are whole nanoseconds, durations are seconds."""
