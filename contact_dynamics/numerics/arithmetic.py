# SPDX-License-Identifier: Apache-2.0
"""Arithmetic for the constants of a rotation: doubles, arrays of doubles, or decimals.

The formulas are written once for all these numbers. Long motions need extended precision: an error of one
last bit in the rate of a phase becomes an error of radians after 1e16 rad. Near the middle axis this happens
much earlier, because rates depend on small differences there. In doubles the constants take a third of the
time.
"""

from __future__ import annotations

import contextlib
import enum
import math
from dataclasses import dataclass
from decimal import (
    MAX_EMAX,
    MIN_EMIN,
    ROUND_HALF_EVEN,
    Decimal,
    DivisionByZero,
    InvalidOperation,
    Overflow,
    localcontext,
)
from decimal import (
    Context as DecimalContext,
)
from typing import TYPE_CHECKING, Any, Final, Generic, TypeAlias, TypeVar

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractContextManager

    from numpy.typing import NDArray

FloatArray: TypeAlias = "NDArray[np.float64]"
Scalar = TypeVar("Scalar", float, Decimal)
Number = TypeVar("Number", float, Decimal, "FloatArray")


class Precision(enum.Enum):
    """The numbers in which the constants of a motion are computed. Attitudes are always doubles."""

    DOUBLE = "double"
    """Errors of attitude grow with time: about 1e-16 of the angle turned, times the motion's sensitivity."""

    EXTENDED = "extended"
    """Errors of attitude stay at the last bits, for the doubles given, over 1e9 revolutions and more."""


@dataclass(frozen=True, slots=True)
class Arithmetic(Generic[Number]):
    """The operations that the formulas require of a type of number.

    Attributes:
        number: Function that converts a double exactly.
        any: Function that returns whether a comparison is true for any element of an array.
        sums: Decimal context for sums that cancel.
        rates: Decimal context for numbers that are multiplied by time.
        cancelled: Rounding of a sum that should be zero, relative to its terms.
        half_precise: Relative difference whose square is below the last digit.
        eighth_precise: Relative difference whose eighth power is, for numbers that do not grow with time.
    """

    number: Callable[[float], Number]
    any: Callable[[Any], bool]
    largest: Callable[[Number, Number, Number], Number]
    sqrt: Callable[[Number], Number]
    pi: Number
    sums: DecimalContext | None
    rates: DecimalContext | None
    cancelled: Number
    half_precise: Number
    eighth_precise: Number


DOUBLES: Final = Arithmetic(
    number=float,
    any=bool,
    largest=max,
    sqrt=math.sqrt,
    pi=math.pi,
    sums=None,
    rates=None,
    cancelled=1e-16,
    half_precise=1e-8,
    eighth_precise=1e-2,
)


def _context(digits: int) -> DecimalContext:
    """Return a context that sets every option, independently of the caller's and the default context."""
    return DecimalContext(
        prec=digits,
        rounding=ROUND_HALF_EVEN,
        Emin=MIN_EMIN,
        Emax=MAX_EMAX,
        capitals=1,
        clamp=0,
        flags=[],
        traps=[DivisionByZero, InvalidOperation, Overflow],
    )


DECIMALS: Final = Arithmetic(
    number=Decimal,
    any=bool,
    largest=max,
    sqrt=Decimal.sqrt,
    pi=Decimal("3.14159265358979323846264338327950288419716939937510582097494459"),
    sums=_context(120),  # after a cancellation of 80 digits, those of a double remain
    rates=_context(38),  # a double-double's 32 digits, and six for the way there
    cancelled=Decimal("1e-100"),
    half_precise=Decimal("1e-19"),
    eighth_precise=Decimal("3e-3"),  # 1e-21: a double, and what cancels where a flip is reached
)

ARRAYS: Final = Arithmetic(
    number=np.asarray,
    any=lambda x: bool(np.any(x)),
    largest=lambda x, y, z: np.maximum(np.maximum(x, y), z),
    sqrt=np.sqrt,
    pi=np.asarray(math.pi),
    sums=None,
    rates=None,
    cancelled=np.asarray(DOUBLES.cancelled),
    half_precise=np.asarray(DOUBLES.half_precise),
    eighth_precise=np.asarray(DOUBLES.eighth_precise),
)


def within(context: DecimalContext | None) -> AbstractContextManager[object]:
    """Return a context manager in which decimals have the digits of a context, or none for doubles."""
    return contextlib.nullcontext() if context is None else localcontext(context)
