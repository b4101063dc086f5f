# SPDX-License-Identifier: Apache-2.0
"""The checks of batches and of covariances. A batch has a row for each case, or one row for all cases.

Batches are checked as single calls are. Each error names the field and the first row that is not allowed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.tolerances import (
    LARGEST_NUMBER,
    LENGTH_ROUNDING,
    NEGATIVE_VARIANCE_TOLERANCE,
    SYMMETRY_TOLERANCE,
    UNIT_LENGTH_TOLERANCE,
)
from contact_dynamics.validation import FloatArray, check_array, check_magnitude

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import ArrayLike, NDArray


_STATE: Final = 12
"""Numbers of a state's deviation: position, rotation vector, velocity, angular velocity."""


def check_rows(
    field: str,
    value: ArrayLike,
    shape: tuple[int, ...] = (),
    allowed: str = "",
    test: Callable[[FloatArray], NDArray[np.bool_]] | None = None,
) -> FloatArray:
    """Return ``value`` as finite numbers, (N, *shape). For a single case N is 1.

    Args:
        field: The name of the value in an error.
        value: An array of shape (N, *shape) or ``shape``.
        shape: The shape of one case.
        allowed: The words of an error for what is allowed.
        test: A function that returns which rows are allowed.
    """
    try:
        single = np.ndim(value) == len(shape)
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise InvalidFieldError(field, value, f"numbers, (N, *{shape}) or {shape}") from None
    rows = check_array(field, array[None] if single else array, (None, *shape))
    if test is not None:
        for i in np.flatnonzero(~test(rows))[:1]:
            raise InvalidFieldError(f"{field}[{i}]", rows[i].tolist(), allowed)
    return rows


def check_positive_rows(field: str, value: ArrayLike) -> FloatArray:
    """Return numbers > 0, (N,)."""
    return check_rows(field, value, (), "> 0", lambda x: x > 0.0)


def check_sizes(field: str, rows: FloatArray) -> FloatArray:
    """Return numbers > 0 if none is beyond `LARGEST_NUMBER` or below its inverse."""
    least = 1.0 / LARGEST_NUMBER
    for i in np.flatnonzero((rows < least) | (rows > LARGEST_NUMBER))[:1]:
        raise InvalidFieldError(f"{field}[{i}]", float(rows[i]), f"in [{least:g}, {LARGEST_NUMBER:g}]")
    return rows


def check_not_negative_rows(field: str, value: ArrayLike) -> FloatArray:
    """Return numbers >= 0, (N,)."""
    return check_rows(field, value, (), ">= 0", lambda x: x >= 0.0)


def check_share_rows(field: str, value: ArrayLike) -> FloatArray:
    """Return numbers in [0, 1], (N,)."""
    return check_rows(field, value, (), "in [0, 1]", lambda x: (x >= 0.0) & (x <= 1.0))


def check_unit_rows(field: str, value: ArrayLike, width: int) -> FloatArray:
    """Return vectors scaled to norm 1, (N, width), as `check_unit` scales each."""
    rows = check_rows(field, value, (width,))
    unit, allowed = unit_rows(rows)
    for i in np.flatnonzero(~allowed)[:1]:
        raise InvalidFieldError(f"{field}[{i}]", rows[i].tolist(), "a unit vector")
    return unit


def unit_rows(rows: FloatArray) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return vectors scaled to norm 1, (N, width), and which of them `check_unit` takes, (N,)."""
    norms = np.zeros(len(rows))
    with np.errstate(over="ignore", invalid="ignore"):  # what overflows is no unit vector either
        for column in rows.T:
            norms += column * column
        off = abs(np.sqrt(norms, out=norms) - 1.0)
    scaled = (off > LENGTH_ROUNDING) & (off <= UNIT_LENGTH_TOLERANCE)
    unit = rows / np.where(scaled, norms, 1.0)[:, None] if scaled.any() else rows
    return unit, off <= UNIT_LENGTH_TOLERANCE


def common_length(fields: Mapping[str, FloatArray]) -> int:
    """Return the number of cases. Fields must have equal lengths, except single rows."""
    lengths = {name: len(rows) for name, rows in fields.items() if len(rows) != 1}
    if len(set(lengths.values())) > 1:
        raise InvalidFieldError("batch", f"arrays of lengths {lengths}", "one length N, or single cases")
    return next(iter(lengths.values()), 1)


def check_covariance(field: str, value: ArrayLike, size: int = _STATE) -> FloatArray:
    """Return a covariance, (``size``, ``size``), made exactly symmetric.

    Raises:
        InvalidFieldError: the matrix has another shape, is not symmetric, or has a number that is not finite
            or beyond the square of `LARGEST_NUMBER`, a negative variance, a correlation beyond 1, or a
            direction in which the variance is negative.
    """
    try:
        given = check_array(field, value, (size, size))
    except InvalidFieldError as error:
        if size != _STATE:
            raise
        hint = f"{error.allowed}, as rigid_body.state_covariance makes one from standard deviations"
        raise InvalidFieldError(field, error.found, hint) from None
    matrix = check_magnitude(field, given, LARGEST_NUMBER**2)
    variances = matrix.diagonal()
    if (variances < 0.0).any():
        raise InvalidFieldError(field, f"variances {variances.tolist()}", "variances >= 0")
    scale = np.sqrt(variances)
    unit = np.outer(scale, scale)
    if np.any(matrix[unit == 0.0]):
        raise InvalidFieldError(
            field, "a correlation with what has no variance", "zero beside a zero variance"
        )
    correlation = np.divide(matrix, unit, out=np.zeros_like(matrix), where=unit > 0.0)
    asymmetry = float(np.abs(correlation - correlation.T).max())
    if asymmetry > SYMMETRY_TOLERANCE:
        raise InvalidFieldError(field, f"correlations that differ by {asymmetry:g}", "a symmetric matrix")
    lowest = float(np.linalg.eigvalsh(0.5 * (correlation + correlation.T))[0])
    if lowest < -NEGATIVE_VARIANCE_TOLERANCE:
        raise InvalidFieldError(
            field, f"correlations with an eigenvalue of {lowest:g}", "a positive semidefinite matrix"
        )
    symmetric: FloatArray = 0.5 * (matrix + matrix.T)
    symmetric.flags.writeable = False
    return symmetric
