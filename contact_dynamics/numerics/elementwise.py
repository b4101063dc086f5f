"""Arithmetic for one case and for many: a number is a float, or an array with one element for each case.

Code that uses only these functions gives one case and a batch the same bits, because Python and NumPy both
round sums, products, quotients and square roots correctly. They do not round other functions equally, so
NumPy's are not used for those. `sum` is not used either, because it compensates rounding from Python 3.12 on.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

import numpy as np

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray

Real = TypeVar("Real", float, "FloatArray")
"""A float, or an array of shape (N,)."""

Number: TypeAlias = Any
"""The same in the fields of a named tuple, and in what has such fields: before Python 3.11 a named tuple
cannot be generic, and with a union of the two no batch could index its own arrays."""


def sqrt(x: Real) -> Real:
    """Return the square root."""
    return math.sqrt(x) if isinstance(x, float) else np.sqrt(x)


def larger(x: Real, y: Real | float) -> Real:
    """Return the larger of two. ``y`` may be a float where ``x`` is an array."""
    return max(x, y) if isinstance(x, float) else np.maximum(x, y)


def sign(x: Real) -> Real:
    """Return 1 or -1 with the sign of ``x``."""
    return math.copysign(1.0, x) if isinstance(x, float) else np.copysign(1.0, x)
