# SPDX-License-Identifier: Apache-2.0
"""A free body integrated by Taylor series with 40 digits: q' = q w / 2 and I w' = I w x w (lecture 25)."""

from __future__ import annotations

from collections.abc import Sequence

import mpmath
from mpmath import mpf

DIGITS = 40
ORDER = 32
REACH = 0.12
"""Radians a step: 0.12^32 is 1e-29."""


def integrated(
    moments: Sequence[float], q_WB: Sequence[float], w_B: Sequence[float], seconds: float
) -> list[mpf]:
    """Return the quaternion x, y, z, w of a body with principal axes x, y, z at a time of either sign."""
    with mpmath.workdps(DIGITS):
        moment, q, w = ([mpf(x) for x in values] for values in (moments, q_WB, w_B))
        steps = int(abs(seconds) * float(mpmath.norm(w)) / REACH) + 1
        for _ in range(steps):
            q, w = _step(moment, q, w, mpf(seconds) / steps)
        return q


def _step(moment: list[mpf], q0: list[mpf], w0: list[mpf], h: mpf) -> tuple[list[mpf], list[mpf]]:
    q, w = [[x] for x in q0], [[x] for x in w0]
    for n in range(ORDER):
        x, y, z, s = (_series(n, q, w, terms) for terms in _QUATERNION)
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            w[i].append((moment[j] - moment[k]) / moment[i] * _convolution(n, w[j], w[k]) / (n + 1))
        for component, rate in zip(q, (x, y, z, s), strict=True):
            component.append(rate / (2 * (n + 1)))
    return [_sum(c, h) for c in q], [_sum(c, h) for c in w]


_QUATERNION = (  # of q' = q w / 2: sign, component of q, component of w
    ((1, 3, 0), (1, 1, 2), (-1, 2, 1)),
    ((1, 3, 1), (1, 2, 0), (-1, 0, 2)),
    ((1, 3, 2), (1, 0, 1), (-1, 1, 0)),
    ((-1, 0, 0), (-1, 1, 1), (-1, 2, 2)),
)


def _series(n: int, q: list[list[mpf]], w: list[list[mpf]], terms: Sequence[tuple[int, int, int]]) -> mpf:
    return sum((sign * _convolution(n, q[i], w[j]) for sign, i, j in terms), mpf(0))


def _convolution(n: int, a: list[mpf], b: list[mpf]) -> mpf:
    return mpmath.fdot(a[: n + 1], b[n::-1])


def _sum(coefficients: list[mpf], h: mpf) -> mpf:
    total = mpf(0)
    for coefficient in reversed(coefficients):
        total = total * h + coefficient
    return total
