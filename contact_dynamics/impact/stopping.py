"""How much normal impulse brings a swerving contact to its stop, without following it there.

A contact that stops does so in an invariant direction f with g < 0 that attracts its neighbours (`sliding`; g
= d|u|/dp, h = |u| times the rate of turning). Near f, with x the angle from it, the impulse that is left
until the stop is |u| F(x), and what friction dissipates on the way is mu |u|^2 G(x). Along the path d|u| : dx
: dp = g : h/|u| : 1, so that

    h F' + g F = -1,        h G' + 2 g G = -1,

whose solutions that are regular at f are power series with the recurrence below; both converge as far as the
next zero of h.
"""

from __future__ import annotations

import math
from operator import mul
from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    from contact_dynamics.impact.sliding import SlidingLaw

TERMS: Final = 24
"""Terms of the series. With the limit on the last of them it reaches a third to a half of the way to the next
zero of h."""

LAST_TERM: Final = 1e-15
"""Relative to the sum. What is left out is of the size of the last term."""

_FARTHEST: Final = 0.8
"""rad. Beyond it the series is not tried, since it would not converge."""


class Stop(NamedTuple):
    """What lies between a sliding contact and its stop."""

    p: float  # N s, normal impulse
    dissipated: float  # J, by friction
    d: tuple[float, float]  # unit, the sliding direction at the stop


def stop_ahead(sliding: SlidingLaw, u1: float, u2: float, *, with_work: bool) -> Stop | None:
    """Return the stop ahead of a contact that slides with (``u1``, ``u2``), m/s.

    None where there is none near, or the series does not converge. Dissipation is only
    worked out where ``with_work`` asks for it, and NaN otherwise.
    """
    speed = math.hypot(u1, u2)
    angle = math.atan2(u2, u1)
    fixed = angle
    for _ in range(8):
        d1, d2 = math.cos(fixed), math.sin(fixed)
        attraction = sliding.attraction(d1, d2)
        if attraction >= 0.0:
            return None
        step = sliding.turning(d1, d2) / attraction
        fixed -= step
        if abs(fixed - angle) > _FARTHEST:
            return None
        if abs(step) < 1e-15:
            break
    d1, d2 = math.cos(fixed), math.sin(fixed)
    if sliding.speeding(d1, d2) >= 0.0:
        return None
    x = angle - fixed
    g, h = _expansions(sliding, d1, d2)
    left = _regular_solution(g, h, x, 1.0)
    dissipation = _regular_solution(g, h, x, 2.0) if with_work else math.nan
    if left is None or dissipation is None:
        return None
    return Stop(speed * left, sliding.mu * speed * speed * dissipation, (d1, d2))


def _expansions(sliding: SlidingLaw, d1: float, d2: float) -> tuple[list[float], list[float]]:
    """Return the Taylor coefficients of g and h in the angle from the direction (d1, d2)."""
    mean = 0.5 * sliding.mu * (sliding.l1 + sliding.l2)
    spread = 0.5 * sliding.mu * (sliding.l1 - sliding.l2)
    along = sliding.k1 * d1 + sliding.k2 * d2
    across = sliding.k2 * d1 - sliding.k1 * d2
    cos_2, sin_2 = d1 * d1 - d2 * d2, 2.0 * d1 * d2
    g, h = [], []
    factorial = 1.0
    for n in range(TERMS + 1):
        # n-th derivatives: g = k.d - mean - spread cos 2a, h = k x d + spread sin 2a.
        g.append((along - spread * cos_2) / factorial)
        h.append((across + spread * sin_2) / factorial)
        along, across = across, -along
        cos_2, sin_2 = -2.0 * sin_2, 2.0 * cos_2
        factorial *= n + 1
    g[0] -= mean
    return g, h


def _regular_solution(g: list[float], h: list[float], x: float, power: float) -> float | None:
    """Return F(x) with h F' + power g F = -1, regular at 0; None where the series has not converged."""
    f = [-1.0 / (power * g[0])]
    slope: list[float] = []  # coefficients of F'
    total, x_n = f[0], 1.0
    for m in range(1, TERMS + 1):
        known = power * sum(map(mul, g[1 : m + 1], reversed(f))) + sum(
            map(mul, h[2 : m + 1], reversed(slope))
        )
        f.append(-known / (m * h[1] + power * g[0]))
        slope.append(m * f[m])
        x_n *= x
        total += f[m] * x_n
        if m >= 2 and abs(f[m] * x_n) + abs(f[m - 1] * x_n) * abs(x) <= LAST_TERM * abs(total):
            return total
    return None
