"""The gates at the border of the physics: each returns its value, made safe, or raises by field name.

Only constructors of domain types and public entry points call these; what lies behind them does not check
again.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.tolerances import UNIT_LENGTH_TOLERANCE

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

FloatArray: TypeAlias = "NDArray[np.float64]"


def check_finite(field: str, value: Any) -> float:
    """Return ``value`` as a float; NaN, infinite or non-numeric raises `InvalidFieldError`."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise InvalidFieldError(field, value, "a finite number") from None
    if not math.isfinite(number):
        raise InvalidFieldError(field, value, "a finite number")
    return number


def check_positive(field: str, value: Any) -> float:
    """Return ``value`` as a float > 0."""
    number = check_finite(field, value)
    if number <= 0.0:
        raise InvalidFieldError(field, value, "a number > 0")
    return number


def check_not_negative(field: str, value: Any) -> float:
    """Return ``value`` as a float >= 0."""
    number = check_finite(field, value)
    if number < 0.0:
        raise InvalidFieldError(field, value, "a number >= 0")
    return number


def check_within(field: str, value: Any, lowest: float, highest: float) -> float:
    """Return ``value`` as a float in the closed interval [lowest, highest]."""
    number = check_finite(field, value)
    if not lowest <= number <= highest:
        raise InvalidFieldError(field, value, f"a number in [{lowest:g}, {highest:g}]")
    return number


def check_array(field: str, value: ArrayLike, shape: tuple[int | None, ...]) -> FloatArray:
    """Return a read-only float64 copy of ``value`` with the given shape (None: any length), all finite."""
    wanted = "(" + ", ".join("n" if length is None else str(length) for length in shape) + ")"
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidFieldError(field, value, f"numbers of shape {wanted}") from None
    fits = array.ndim == len(shape) and all(
        want is None or want == have for want, have in zip(shape, array.shape, strict=True)
    )
    if not fits:
        raise InvalidFieldError(field, f"shape {array.shape}", f"shape {wanted}")
    if not np.isfinite(array).all():
        raise InvalidFieldError(field, array, "finite numbers only")
    array.flags.writeable = False
    return array


def check_unit(field: str, value: ArrayLike, length: int) -> FloatArray:
    """Return the vector of ``length`` numbers scaled to norm 1; refuse a norm that is not 1 within tolerance.

    Unit means `UNIT_LENGTH_TOLERANCE`; the rest of rounding is taken out here, so that nothing behind has to.
    """
    array = check_array(field, value, (length,))
    norm = math.sqrt(math.fsum(x * x for x in array.tolist()))
    if abs(norm - 1.0) > UNIT_LENGTH_TOLERANCE:
        raise InvalidFieldError(
            field,
            f"{array.tolist()} of norm {norm:.9g}",
            f"a unit vector (norm within {UNIT_LENGTH_TOLERANCE:g} of 1)",
        )
    unit: FloatArray = array / norm
    unit.flags.writeable = False
    return unit
