"""Arithmetic that one case and many share: a number is a float, or an array with a case an element.

What is written with it once gives one case and a batch the same bits: sums, products, quotients and square
roots are rounded correctly by both. Other functions are not, so that NumPy's are not used for them; nor is
`sum`, which compensates rounding from Python 3.12 on.
"""

from __future__ import annotations

import math
from itertools import repeat
from typing import Any, TypeAlias

import numpy as np

Number: TypeAlias = Any  # float, or FloatArray of shape (N,)
Vector3: TypeAlias = "tuple[Number, Number, Number]"


def sqrt(x: Number) -> Number:
    """Return the square root."""
    return math.sqrt(x) if isinstance(x, float) else np.sqrt(x)


def power(x: Number, exponent: float) -> Number:
    """Return ``x`` >= 0 to the power of ``exponent``."""
    return x**exponent if isinstance(x, float) else np.array(list(map(pow, x.tolist(), repeat(exponent))))


def larger(x: Number, y: Number) -> Number:
    """Return the larger of two; ``y`` may be a float where ``x`` is an array."""
    return max(x, y) if isinstance(x, float) else np.maximum(x, y)


def smaller(x: Number, y: Number) -> Number:
    """Return the smaller of two; ``y`` may be a float where ``x`` is an array."""
    return min(x, y) if isinstance(x, float) else np.minimum(x, y)


def sign(x: Number) -> Number:
    """Return 1 or -1 with the sign of ``x``."""
    return math.copysign(1.0, x) if isinstance(x, float) else np.copysign(1.0, x)


def dot(a: Vector3, b: Vector3) -> Number:
    """Return the scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector3, b: Vector3) -> Vector3:
    """Return the vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def combined(x: Number, a: Vector3, y: Number, b: Vector3) -> Vector3:
    """Return x a + y b."""
    return (x * a[0] + y * b[0], x * a[1] + y * b[1], x * a[2] + y * b[2])
