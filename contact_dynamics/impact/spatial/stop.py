"""How much normal impulse brings a swerving contact to its stop, without following it there.

A contact that stops does so in an invariant direction f with g < 0 that attracts its neighbours. Here g is
d|u|/dp, and h is |u| times the rate of turning (`sliding_law`). Let x be the angle from f. Near f, the
impulse that is left until the stop is |u| F(x), and friction dissipates mu |u|^2 G(x) on the way. Along the
path d|u| : dx : dp = g : h/|u| : 1, so that

    h F' + g F = -1,        h G' + 2 g G = -1.

The solutions that are regular at f are power series with the recurrence below. Both converge as far as the
next zero of h.

Where the direction turns slowly in comparison with the slowing down, |h| << |g|, the iteration
F = -1/g - (h/g) F' gives the same solution anywhere, also far from f. Its terms fall like (h/g)^n until they
are far below rounding. Then the path has all but stopped before its direction turns.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

from contact_dynamics.numerics.elementwise import Number, larger, sqrt
from contact_dynamics.tolerances import AT_THE_STOP, LAST_TERM, SLOW_TURNING

if TYPE_CHECKING:
    from contact_dynamics.impact.spatial.sliding_law import SlidingLaw

TERMS: Final = 24
"""Terms of the series. With the limit on the last of them it reaches a third to a half of the way to the next
zero of h."""

FARTHEST: Final = 0.8
"""rad. Beyond it the series is not tried, since it would not converge."""

ROUNDS: Final = 8
"""Newton's steps towards f. They converge quadratically."""

SLOW_TERMS: Final = 10
"""Terms of the iteration for slow turning. They need derivatives up to this order."""


class Stop(NamedTuple):
    """What lies between a sliding contact and its stop.

    Attributes:
        p: N s, the normal impulse until the stop.
        dissipated: J, the energy that friction dissipates until the stop, or NaN if it was not asked for.
        d1: The first component of the sliding direction at the stop.
        d2: The second component of the sliding direction at the stop.
    """

    p: Number
    dissipated: Number
    d1: Number
    d2: Number


def stop_ahead(
    sliding: SlidingLaw, u: tuple[float, float], first_speed: float, *, with_work: bool
) -> Stop | None:
    """Return the stop ahead of a contact that slides with ``u``, m/s, and slows down.

    The answer is None if no stop is near or no series converges. The dissipation is only worked out if
    ``with_work`` asks for it. Errors are compared with ``first_speed``, m/s, the sliding speed at the
    beginning of the whole path.
    """
    speed = math.sqrt(u[0] * u[0] + u[1] * u[1])
    d1, d2 = u[0] / speed, u[1] / speed
    if turns_slowly(sliding, d1, d2, speed, first_speed):
        stop, last = slow_stop(sliding, d1, d2, speed, with_work=with_work)
        if last * speed <= LAST_TERM * max(first_speed, speed):
            return stop
    return _near_stop(sliding, u, with_work=with_work)


def turns_slowly(sliding: SlidingLaw, d1: Number, d2: Number, speed: Number, first_speed: Number) -> Number:
    """Return whether a contact that slows down in the direction (d1, d2) all but stops before it turns.

    The answer also demands that v_n rises all the way until then, or falls all the way. It does so if the
    rate of v_n has the same sign in all directions near by.
    """
    turning, change = abs(sliding.turning(d1, d2)), abs(sliding.attraction(d1, d2))
    ratio = (turning + change) / abs(sliding.speeding(d1, d2))
    squared = ratio * ratio
    eighth = squared * squared * squared * squared
    coupling = sliding.mu * sqrt(sliding.k1 * sliding.k1 + sliding.k2 * sliding.k2)
    keeps_rate = (sliding.kn > coupling) | (abs(sliding.lifting(d1, d2)) > 0.5 * coupling)
    return (eighth * squared * speed <= SLOW_TURNING * first_speed) & keeps_rate


def _near_stop(sliding: SlidingLaw, u: tuple[float, float], *, with_work: bool) -> Stop | None:
    """Return the stop in an attracting direction close to that of ``u``, or None."""
    speed = math.sqrt(u[0] * u[0] + u[1] * u[1])
    d1, d2 = u[0] / speed, u[1] / speed
    angle = fixed = math.atan2(u[1], u[0])
    for _ in range(ROUNDS):
        attraction = sliding.attraction(d1, d2)
        if attraction >= 0.0:
            return None
        step = sliding.turning(d1, d2) / attraction
        fixed -= step
        if abs(fixed - angle) > FARTHEST:
            return None
        d1, d2 = math.cos(fixed), math.sin(fixed)
        if abs(step) < AT_THE_STOP:
            break
    if sliding.speeding(d1, d2) >= 0.0 or sliding.attraction(d1, d2) >= 0.0:
        return None
    x = angle - fixed
    g, h = expansions(sliding, d1, d2, TERMS)
    left = _regular_solution(g, h, x, 1.0)
    if left is None:
        return None
    dissipation = _regular_solution(g, h, x, 2.0) if with_work else math.nan
    if dissipation is None:
        return None
    return Stop(speed * left, sliding.mu * speed * speed * dissipation, d1, d2)


def slow_stop(
    sliding: SlidingLaw, d1: Number, d2: Number, speed: Number, *, with_work: bool
) -> tuple[Stop, Number]:
    """Return the stop of a contact that turns slowly, and its relative error."""
    g, h = expansions(sliding, d1, d2, SLOW_TERMS)
    reciprocal = [1.0 / g[0]]
    for n in range(1, SLOW_TERMS + 1):
        known = g[n] * reciprocal[0]
        for i in range(1, n):
            known = known + g[n - i] * reciprocal[i]
        reciprocal.append(-known * reciprocal[0])
    left, last = _slow_solution(reciprocal, h, 1.0)
    dissipation = math.nan * left
    if with_work:
        dissipation, last_too = _slow_solution(reciprocal, h, 0.5)
        last = larger(last, last_too)
    return Stop(speed * left, sliding.mu * speed * speed * dissipation, d1, d2), last


def _slow_solution(reciprocal: list[Number], h: list[Number], share: float) -> tuple[Number, Number]:
    """Return F with h F' + g F / share = -1 for slow turning, and the relative size of its last terms."""
    term = [-share * r for r in reciprocal]
    total = term[0]
    last = previous = abs(total)
    for terms in range(SLOW_TERMS, 0, -1):
        slope = [(n + 1) * term[n + 1] for n in range(terms)]
        product = [_coefficient(h, slope, n) for n in range(terms)]
        term = [-share * _coefficient(reciprocal, product, n) for n in range(terms)]
        total = total + term[0]
        previous, last = last, abs(term[0])
    return total, (previous + last) / abs(total)


def _coefficient(a: list[Number], b: list[Number], n: int) -> Number:
    """Return coefficient ``n`` of a product of series."""
    total = a[n] * b[0]
    for i in range(1, n + 1):
        total = total + a[n - i] * b[i]
    return total


def expansions(sliding: SlidingLaw, d1: Number, d2: Number, terms: int) -> tuple[list[Number], list[Number]]:
    """Return the Taylor coefficients of g and h in the angle from the direction (d1, d2), up to ``terms``."""
    mean = 0.5 * sliding.mu * (sliding.l1 + sliding.l2)
    spread = 0.5 * sliding.mu * (sliding.l1 - sliding.l2)
    along = sliding.k1 * d1 + sliding.k2 * d2
    across = sliding.k2 * d1 - sliding.k1 * d2
    cos_2, sin_2 = d1 * d1 - d2 * d2, 2.0 * d1 * d2
    g, h = [], []
    share = 1.0
    for n in range(terms + 1):
        # n-th derivatives: g = k.d - mean - spread cos 2a, h = k x d + spread sin 2a.
        g.append((along - spread * cos_2) * share)
        h.append((across + spread * sin_2) * share)
        along, across = across, -along
        cos_2, sin_2 = -2.0 * sin_2, 2.0 * cos_2
        share /= n + 1
    g[0] = g[0] - mean
    return g, h


def next_coefficient(
    g: list[Number], h: list[Number], f: list[Number], slope: list[Number], *, power: float
) -> Number:
    """Return the next coefficient of F with h F' + power g F = -1, after those in ``f``.

    Args:
        g: Coefficients of g.
        h: Coefficients of h. The first is 0.
        f: Coefficients of F so far. There is at least one.
        slope: Coefficients of F' so far. There is one fewer.
        power: The power of |u| to which the sought quantity is proportional.
    """
    m = len(f)
    known = g[m] * f[0]
    for i in range(1, m):
        known = known + g[m - i] * f[i]
    known = power * known
    for i in range(m - 1):
        known = known + h[m - i] * slope[i]
    return -known / (m * h[1] + power * g[0])


def _regular_solution(g: list[float], h: list[float], x: float, power: float) -> float | None:
    """Return F(x) with h F' + power g F = -1, regular at 0, or None if the series has not converged."""
    f = [-1.0 / (power * g[0])]
    slope: list[float] = []
    total, x_n = f[0], 1.0
    last = 0.0
    for m in range(1, TERMS + 1):
        f.append(next_coefficient(g, h, f, slope, power=power))
        slope.append(m * f[m])
        x_n *= x
        term = f[m] * x_n
        total += term
        if m >= 2 and abs(term) + abs(last) <= LAST_TERM * abs(total):
            return total
        last = term
    return None
