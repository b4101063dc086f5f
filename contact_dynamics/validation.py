# SPDX-License-Identifier: Apache-2.0
"""The checks of input: each returns its value, made safe, or raises an error that names the field.

Only constructors of domain types and public functions call these. The code behind them does not check again.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final, Protocol, TypeAlias

import numpy as np

from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_dynamics.tolerances import LARGEST_NUMBER, LENGTH_ROUNDING, UNIT_LENGTH_TOLERANCE

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

FloatArray: TypeAlias = "NDArray[np.float64]"

_FEW: Final = 20
_LARGEST_WHOLE: Final = 2**63 - 1
_LATEST: Final = 10**80


def check_finite(field: str, value: Any) -> float:
    """Return ``value`` as a float. If it is NaN, infinite or no number, raise `InvalidFieldError`."""
    if type(value) is float and math.isfinite(value):  # the common case
        return value
    try:
        number = math.nan if isinstance(value, str | bytes) else float(value)
    except (TypeError, ValueError, OverflowError):
        raise InvalidFieldError(field, value, "a finite number") from None
    if not math.isfinite(number):
        raise InvalidFieldError(field, value, "a finite number")
    return number


def check_positive(field: str, value: Any) -> float:
    """Return ``value`` as a float > 0."""
    number = check_finite(field, value)
    if number <= 0.0:
        raise InvalidFieldError(field, value, "> 0")
    return number


def check_not_negative(field: str, value: Any) -> float:
    """Return ``value`` as a float >= 0."""
    number = check_finite(field, value)
    if number < 0.0:
        raise InvalidFieldError(field, value, ">= 0")
    return number


def check_static(
    static: Any, friction: float, field: str = "static_friction", kinetic: str = "friction"
) -> float | None:
    """Return a coefficient of static friction as a float that is not below that of friction, or None."""
    if static is None:
        return None
    number = check_finite(field, static)
    if number < friction:
        raise InvalidFieldError(field, static, f"at least {kinetic}, which is {friction:g}")
    return number


def check_within(field: str, value: Any, lowest: float, highest: float) -> float:
    """Return ``value`` as a float in the closed interval [lowest, highest]."""
    number = check_finite(field, value)
    if not lowest <= number <= highest:
        raise InvalidFieldError(field, value, f"in [{lowest:g}, {highest:g}]")
    return number


def check_size(field: str, value: Any) -> float:
    """Return ``value`` as a float from 1 / `LARGEST_NUMBER` to `LARGEST_NUMBER`, whose square is a float."""
    return check_within(field, value, 1.0 / LARGEST_NUMBER, LARGEST_NUMBER)


def check_whole(field: str, value: Any, lowest: int, highest: int | None = None) -> int:
    """Return ``value`` as a whole number of at least ``lowest`` and, if given, at most ``highest``.

    It is below 2^63 in any case, as in messages.
    """
    whole = isinstance(value, (int, np.integer)) and not isinstance(value, (bool, np.bool_))
    if not whole or value < lowest or value > (_LARGEST_WHOLE if highest is None else highest):
        most = "" if highest is None else f" and <= {highest}"
        raise InvalidFieldError(field, value, f"a whole number >= {lowest}{most}")
    return int(value)


def check_stamp(field: str, value: Any) -> int:
    """Return a stamp, ns, as a whole number. It may exceed 64 bits, since motions are followed for ages."""
    whole = isinstance(value, (int, np.integer)) and not isinstance(value, (bool, np.bool_))
    if not whole or abs(int(value)) > _LATEST:
        raise InvalidFieldError(field, value, "a whole number of nanoseconds")
    return int(value)


def check_array(
    field: str, value: ArrayLike, shape: tuple[int | None, ...], *, infinite: bool = False
) -> FloatArray:
    """Return a read-only float64 copy of ``value`` with the given shape, all finite. None is any length.

    If ``infinite``, numbers may be plus infinity, which means that there is no limit.
    Where any number of rows is allowed, an error names the first one that is not finite.
    """
    if getattr(getattr(value, "dtype", None), "kind", "f") == "c":  # NumPy would drop a part and only warn
        raise InvalidFieldError(field, value, f"real numbers of shape {_in_words(shape)}")
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise InvalidFieldError(field, value, f"numbers of shape {_in_words(shape)}") from None
    if array.shape != shape and not _fits(array.shape, shape):
        raise InvalidFieldError(field, f"shape {array.shape}", f"of shape {_in_words(shape)}")
    # Where a sum is finite, so are its terms: the faster test for a few of them.
    surely_finite = array.size <= _FEW and math.isfinite(sum(array.ravel().tolist()))
    if not surely_finite and not (np.isfinite(array) | (infinite & (array == np.inf))).all():
        if shape[:1] != (None,):
            raise InvalidFieldError(field, array, "finite")
        rows = np.isfinite(array.reshape(len(array), -1)).all(axis=1)
        first = int(rows.argmin())
        raise InvalidFieldError(f"{field}[{first}]", array[first], "finite")
    array.flags.writeable = False
    return array


def _fits(shape: tuple[int, ...], wanted: tuple[int | None, ...]) -> bool:
    return len(shape) == len(wanted) and all(
        want is None or want == have for want, have in zip(wanted, shape, strict=True)
    )


def _in_words(shape: tuple[int | None, ...]) -> str:
    lengths = ", ".join("n" if length is None else str(length) for length in shape)
    return f"({lengths},)" if len(shape) == 1 else f"({lengths})"


def check_sides(size: ArrayLike, y: float | None, z: float | None) -> FloatArray:
    """Return the side lengths, (3,), of a box along x, y, z, given as one sequence or as three numbers."""
    if y is None and z is None:
        return check_array("size", size, (3,))
    sides: list[Any] = [size, y, z]
    return check_array("size, y, z", sides, (3,))


def check_magnitude(field: str, value: FloatArray, most: float = LARGEST_NUMBER) -> FloatArray:
    """Return ``value`` if no number in it is larger than ``most`` in magnitude."""
    few = value.size <= _FEW  # floats are faster for these
    largest = max(map(abs, value.ravel().tolist()), default=0.0) if few else float(np.abs(value).max())
    if not largest <= most:
        raise InvalidFieldError(field, f"{largest:g}", f"at most {most:g} in magnitude")
    return value


def check_vector3(field: str, value: ArrayLike) -> FloatArray:
    """Return a vector, (3,), whose numbers are at most `LARGEST_NUMBER` in magnitude."""
    return check_magnitude(field, check_array(field, value, (3,)))


class MayMove(Protocol):
    """A world or contacts, whose surfaces may move."""

    @property
    def surfaces_move(self) -> bool:
        """Whether any surface moves."""


def check_at_rest(argument: str, value: MayMove, call: str) -> None:
    """Raise `NotSupportedError` where surfaces move, in a call that takes only surfaces at rest."""
    if value.surfaces_move:
        raise NotSupportedError(f"{argument} must have surfaces at rest in {call}, got surfaces that move")


def check_motion(field: str, value: ArrayLike | None, n: int | None = None) -> FloatArray | None:
    """Return a velocity or acceleration, (3,), or one for each of n contacts, (n, 3), or None for rest.

    One vector may be given for all contacts. Numbers are at most `LARGEST_NUMBER` in magnitude.
    """
    if value is None:
        return None
    if n is not None and np.ndim(value) == 1:
        value = np.broadcast_to(value, (n, len(np.asarray(value))))
    checked = check_array(field, value, (3,) if n is None else (n, 3))
    return check_magnitude(field, checked) if checked.any() else None


def check_unit(field: str, value: ArrayLike, length: int) -> FloatArray:
    """Return the vector of ``length`` numbers scaled to norm 1. Its norm must be 1 within tolerance.

    The tolerance is `UNIT_LENGTH_TOLERANCE`. The code behind can rely on norm 1 to rounding.
    """
    array = check_array(field, value, (length,))
    total = 0.0
    for x in array.tolist():
        total += x * x
    norm = math.sqrt(total)
    if abs(norm - 1.0) > UNIT_LENGTH_TOLERANCE:
        raise InvalidFieldError(
            field,
            f"{array.tolist()} of norm {norm:.9g}",
            f"a unit vector (norm within {UNIT_LENGTH_TOLERANCE:g} of 1)",
        )
    if abs(norm - 1.0) <= LENGTH_ROUNDING:
        return array
    unit: FloatArray = array / norm
    unit.flags.writeable = False
    return unit
