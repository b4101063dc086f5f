"""A stretch of a swerving impulse path as power series, from its own recurrences.

With a parameter s that runs as ds = dp/|u| the sliding equations (`sliding`) lose their singularity at the
stop,

    du/ds = |u| k - mu L u,    dp/ds = |u|,    dI/ds = -mu u,    dv_n/ds = k_n |u| - mu k . u,

and the series of q = |u| follows from that of q^2 = u.u, term by term. The last terms tell how far the series
reaches, and it is its own interpolant, so that events are located to rounding (Taylor's method; step size
after Jorba and Zou 2005).
"""

from __future__ import annotations

import math
from operator import mul
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from contact_dynamics.impact.sliding import SlidingLaw

ORDER: Final = 16
"""Degree of the series. Higher means longer and dearer stretches: 12 to 24 cost the same within a fifth."""

TRUNCATION: Final = 1e-14
"""Relative. The last term of u may be this part of |u| where a stretch ends; the terms left out are
smaller."""

_MOST_ITERATIONS: Final = 100


class SlidingSeries:
    """One stretch of the path: polynomials in the parameter s, kg, valid from 0 to ``length``.

    Lists hold coefficients of rising powers; `value` evaluates them. Impulses and work count from the start
    of the stretch.
    """

    __slots__ = (
        "length",
        "normal_impulse",
        "normal_velocity",
        "normal_work",
        "speed",
        "t1",
        "t2",
        "u1",
        "u2",
    )

    def __init__(self, law: SlidingLaw, u: tuple[float, float], v_n: float, *, with_work: bool) -> None:
        """Expand about the state ``u``, ``v_n``, m/s, with |u| > 0; the normal work only on demand."""
        k1, k2, kn, mu = law.k1, law.k2, law.kn, law.mu
        m1, m2 = mu * law.l1, mu * law.l2
        u1, u2 = [u[0]], [u[1]]
        q = [math.hypot(u[0], u[1])]
        per_q = 0.5 / q[0]
        for n in range(1, ORDER + 1):
            u1.append((k1 * q[-1] - m1 * u1[-1]) / n)
            u2.append((k2 * q[-1] - m2 * u2[-1]) / n)
            square = sum(map(mul, u1, reversed(u1))) + sum(map(mul, u2, reversed(u2)))
            inner = q[1:]
            q.append((square - sum(map(mul, inner, reversed(inner)))) * per_q)
        self.u1, self.u2, self.speed = u1, u2, q
        self.normal_impulse = _integral(q)  # N s
        self.t1 = _integral([-mu * c for c in u1])  # N s
        self.t2 = _integral([-mu * c for c in u2])
        lifting = [kn * c - mu * (k1 * a + k2 * b) for a, b, c in zip(u1, u2, q, strict=True)]
        self.normal_velocity = _integral(lifting)  # m/s
        self.normal_velocity[0] = v_n
        self.normal_work = [0.0]  # J
        if with_work:
            v = self.normal_velocity
            power = [sum(map(mul, v[: n + 1], q[n::-1])) for n in range(ORDER + 1)]
            self.normal_work = _integral(power)
        # Terms that underflow tell nothing; over half of 1/scale the direction hardly turns even then.
        sure = 0.5 / law.scale
        self.length = min(_reach(q[0], u1, u2, n, sure) for n in (ORDER, ORDER - 1))

    @staticmethod
    def value(series: list[float], s: float) -> float:
        """Return the value of a polynomial at ``s``."""
        total = 0.0
        for c in reversed(series):
            total = total * s + c
        return total

    def gain(self, series: list[float], begin: float, end: float) -> float:
        """Return the growth from ``begin`` to ``end`` of a polynomial that starts at 0."""
        return self.value(series, end) - (self.value(series, begin) if begin != 0.0 else 0.0)

    def crossing(self, series: list[float], level: float, begin: float, end: float) -> float:
        """Return where a polynomial crosses ``level`` between ``begin`` and ``end``; it is monotone there.

        Newton's method inside a bracket that bisection keeps.
        """
        low, high = begin, end
        first, last = self.value(series, begin), self.value(series, end)
        rising = last >= first
        s = (
            begin + (end - begin) * min(max((level - first) / (last - first), 0.0), 1.0)
            if last != first
            else end
        )
        for _ in range(_MOST_ITERATIONS):
            total = slope = 0.0
            for c in reversed(series):
                slope = slope * s + total
                total = total * s + c
            excess = total - level
            if (excess > 0.0) == rising:
                high = s
            else:
                low = s
            guess = s - excess / slope if slope != 0.0 else low
            if abs(guess - s) <= 1e-15 * abs(guess):
                break
            s = guess if low < guess < high else 0.5 * (low + high)
        return s


def _integral(series: list[float]) -> list[float]:
    return [0.0, *[c / (n + 1) for n, c in enumerate(series)]]


def _reach(speed: float, u1: list[float], u2: list[float], n: int, sure: float) -> float:
    """Return the length at which term n of u is `TRUNCATION` of ``speed``; ``sure`` where the term is 0."""
    term = max(abs(u1[n]), abs(u2[n]))
    return (TRUNCATION * speed / term) ** (1.0 / n) if term > 0.0 else sure
