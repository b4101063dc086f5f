# SPDX-License-Identifier: Apache-2.0
"""Phases grow linearly with time. Here they lose no digits modulo one, over any number of turns.

The rate and the offset are double-doubles (unevaluated sums of two doubles, 32 digits). The product of the
rate with a time is formed together with its rounding error (Dekker 1971), and whole turns are taken off
before anything is rounded. So the error of the remainder is about 1e-32 of the number of turns, plus the last
bit of the remainder itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.records import Record

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray

_SPLITTER: Final = 134217729.0
"""2^27 + 1: splits a double into two halves of 26 bits, whose products are exact."""


@dataclass(frozen=True, slots=True, repr=False)
class LinearPhase(Record):
    """The phase ``rate * t + offset``, in turns.

    Attributes:
        rate: Leading part of the rate, turns/s.
        rate_rest: What ``rate`` leaves of the rate, turns/s.
        rate_upper: Upper half of the bits of ``rate``, turns/s.
        rate_lower: Lower half of the bits of ``rate``, turns/s.
        offset: Leading part of the offset, turns.
        offset_rest: What ``offset`` leaves of the offset, turns.
    """

    rate: float
    rate_rest: float
    rate_upper: float
    rate_lower: float
    offset: float
    offset_rest: float

    def fraction(self, seconds: float) -> tuple[float, float]:
        """Return the phase at a time, s, as its fraction in [-1/2, 1/2] and its whole turns."""
        product = self.rate * seconds
        scaled = _SPLITTER * seconds
        upper = scaled - (scaled - seconds)
        lower = seconds - upper
        error = ((self.rate_upper * upper - product) + self.rate_upper * lower + self.rate_lower * upper) + (
            self.rate_lower * lower
        )
        turns = float(round(product))
        rest = product - turns
        total = rest + self.offset
        back = total - rest
        error += (rest - (total - back)) + (self.offset - back)
        more = float(round(total))
        return (total - more) + (error + (self.rate_rest * seconds + self.offset_rest)), turns + more

    def fractions(self, seconds: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return `fraction` for times (n,), s, as arrays (n,) of fractions and of whole turns."""
        product = self.rate * seconds
        upper = _SPLITTER * seconds
        upper -= upper - seconds
        lower = seconds - upper
        error = self.rate_upper * upper
        error -= product
        error += self.rate_upper * lower
        error += self.rate_lower * upper
        error += self.rate_lower * lower
        turns = np.rint(product)
        product -= turns
        total = product + self.offset
        back = total - product
        error += product - (total - back)
        error += self.offset - back
        error += self.rate_rest * seconds + self.offset_rest
        more = np.rint(total)
        total -= more
        total += error
        turns += more
        return total, turns


def linear_phase(rate: Decimal | float, offset: Decimal | float) -> LinearPhase:
    """Return the phase with the given rate, turns/s, and offset, turns, each rounded to 32 digits."""
    high, low = _split(rate)
    scaled = _SPLITTER * high
    upper = scaled - (scaled - high)
    offset_high, offset_low = _split(offset)
    return LinearPhase(
        rate=high,
        rate_rest=low,
        rate_upper=upper,
        rate_lower=high - upper,
        offset=offset_high,
        offset_rest=offset_low,
    )


def _split(number: Decimal | float) -> tuple[float, float]:
    high = float(number)
    return high, float(number - Decimal(high)) if isinstance(number, Decimal) else 0.0
