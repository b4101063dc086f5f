"""Taylor's method gives a stretch of a swerving impulse path as power series.

With a parameter s that runs as ds = |law's scale| dp/|u|, the sliding equations (`sliding_law`) lose their
singularity at the stop. Their coefficients are then of size 1. Apart from the scale, which divides each,

    du/ds = |u| k - mu L u,    dp/ds = |u|,    dI/ds = -mu u,    dv_n/ds = k_n |u| - mu k . u.

The series of q = |u| follows from that of q^2 = u.u, term by term. The last terms tell how far a series
reaches (after Jorba and Zou 2005). A series is its own interpolant, so that events are located to rounding.

A coefficient is a number, or an array with one element for each case (`elementwise`). So the stretches of
many impacts are expanded and evaluated by the same lines, with the same bits.
"""

from __future__ import annotations

from operator import mul
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.numerics.elementwise import Number, larger, power, smaller, sqrt
from contact_dynamics.tolerances import EVENT_LOCATED, TRUNCATION

if TYPE_CHECKING:
    from contact_dynamics.impact.spatial.sliding_law import SlidingLaw

ORDER: Final = 24
"""Degree of the series. A decay e^-s, whose series converges everywhere, is reached over s = 0.9 by 16 terms
and over s = 2.6 by 24, for twice the work."""

LONGEST: Final = 16.0
"""Longest stretch, in s. It only matters where hardly anything changes."""

SURE: Final = 0.5
"""Length of a stretch, in s, where the last terms underflow to zero, so that they do not say how far the
series reaches. The direction hardly turns over this length."""

MAX_ITERATIONS: Final = 100

_SHARES: Final = tuple(1.0 / n for n in range(1, ORDER + 2))

_STEPS: Final = tuple(
    (n, _SHARES[n - 1], tuple((i, n - i) for i in range(1, (n + 1) // 2))) for n in range(1, ORDER + 1)
)
"""For each n, the number n itself, 1/n, and the pairs of different numbers >= 1 whose sum is n."""


class SlidingSeries:
    """One stretch of the path as polynomials in the parameter s, from 0 to ``length``.

    Lists hold coefficients of rising powers, and `value` evaluates them. Impulses and work count from the
    start of the stretch.
    """

    __slots__ = (
        "length",
        "lifting",
        "normal_impulse",
        "normal_velocity",
        "normal_work",
        "t1",
        "t2",
        "u1",
        "u2",
    )

    def __init__(self, law: SlidingLaw, u: tuple[Number, Number], v_n: Number, *, with_work: bool) -> None:
        """Expand about the state ``u``, ``v_n``, m/s, with |u| > 0. The work is expanded on demand only."""
        per_scale = 1.0 / law.scale
        k1, k2, kn, mu = law.k1 * per_scale, law.k2 * per_scale, law.kn * per_scale, law.mu
        m1, m2 = mu * law.l1 * per_scale, mu * law.l2 * per_scale
        x, y = u
        x_n, y_n, q_n = x, y, sqrt(x * x + y * y)
        first, per_speed = q_n, 1.0 / q_n
        self.u1, self.u2 = u1, u2 = [x_n], [y_n]
        q = [q_n]
        for n, share, pairs in _STEPS:
            x_n, y_n = (k1 * q_n - m1 * x_n) * share, (k2 * q_n - m2 * y_n) * share
            u1.append(x_n)
            u2.append(y_n)
            # Half of what u.u has in its n-th coefficient beyond the known part of q's square.
            half = x * x_n + y * y_n
            for i, j in pairs:
                half += u1[i] * u1[j] + u2[i] * u2[j] - q[i] * q[j]
            if n % 2 == 0:
                i = n // 2
                half += 0.5 * (u1[i] * u1[i] + u2[i] * u2[i] - q[i] * q[i])
            q_n = half * per_speed
            q.append(q_n)
        opposing = -(mu * per_scale)
        self.normal_impulse = _integral([per_scale * c for c in q])  # N s
        self.t1 = _integral([opposing * c for c in u1])  # N s
        self.t2 = _integral([opposing * c for c in u2])
        b1, b2 = mu * k1, mu * k2
        self.lifting = [kn * c - b1 * a - b2 * b for a, b, c in zip(u1, u2, q, strict=True)]  # dv_n/ds
        self.normal_velocity = _integral(self.lifting)  # m/s
        self.normal_velocity[0] = v_n
        self.normal_work = self._work(q, per_scale) if with_work else []  # J
        length = smaller(*(_reach(first, (u1[n], u2[n], _SHARES[n] * q[n]), n) for n in (ORDER, ORDER - 1)))
        if with_work:
            # The work is a product of two series, which leaves out more than either.
            work = self.normal_work
            size = larger(abs(work[1]), abs(work[2]))
            length = smaller(length, smaller(*(_reach(size, (work[n],), n) for n in (ORDER + 1, ORDER))))
        self.length = length

    def _work(self, q: list[Number], per_scale: Number) -> list[Number]:
        v = self.normal_velocity
        power_series = []
        for n in range(ORDER + 1):
            total = v[0] * q[n]
            for i in range(1, n + 1):
                total += v[i] * q[n - i]
            power_series.append(per_scale * total)
        return _integral(power_series)


def value(series: list[Number], s: Number) -> Number:
    """Return the value of a polynomial at ``s``."""
    total = series[-1]
    for c in series[-2::-1]:
        total = total * s + c
    return total


def gain(series: list[float], begin: float, end: float) -> float:
    """Return the growth from ``begin`` to ``end`` of one polynomial that starts at 0."""
    total: float = value(series, end)
    return total - value(series, begin) if begin != 0.0 else total


def value_and_slope(series: list[Number], s: Number) -> tuple[Number, Number]:
    """Return the value and the derivative of a polynomial at ``s``."""
    total = series[-1]
    slope = 0.0 * total
    for c in series[-2::-1]:
        slope = slope * s + total
        total = total * s + c
    return total, slope


def crossing(series: list[float], level: float, begin: float, end: float) -> float:
    """Return where one polynomial, which is monotone there, crosses ``level`` between ``begin`` and ``end``.

    Newton's method works inside a bracket that bisection keeps.
    """
    low, high = begin, end
    first, last = value(series, begin), value(series, end)
    rising = last >= first
    s = end
    if last != first:
        s = begin + (end - begin) * min(max((level - first) / (last - first), 0.0), 1.0)
    for _ in range(MAX_ITERATIONS):
        total, slope = value_and_slope(series, s)
        excess = total - level
        if (excess > 0.0) == rising:
            high = s
        else:
            low = s
        guess = s - excess / slope if slope != 0.0 else high
        if abs(guess - s) <= EVENT_LOCATED * abs(guess) and slope != 0.0:
            break
        s = guess if low < guess < high else 0.5 * (low + high)
    return s


def _integral(series: list[Number]) -> list[Number]:
    return [0.0 * series[0], *map(mul, _SHARES, series)]


def _reach(size: Number, terms: tuple[Number, ...], n: int) -> Number:
    """Return the length at which the largest of the ``terms`` of degree ``n`` is `TRUNCATION` of ``size``.

    For the velocities, the terms are those of u and of the integral of |u|. Of |u| only the integral matters,
    and |u| has singularities of its own if the normal does not couple with u.
    """
    term = abs(terms[0])
    for other in terms[1:]:
        term = larger(term, abs(other))
    if isinstance(term, float):
        return min((TRUNCATION * size / term) ** (1.0 / n), LONGEST) if term > 0.0 else SURE
    some = term > 0.0
    reach = np.full(len(term), SURE)
    reach[some] = np.minimum(power(TRUNCATION * size[some] / term[some], 1.0 / n), LONGEST)
    return reach
