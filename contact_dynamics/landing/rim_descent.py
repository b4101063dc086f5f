"""Finds the lowest point of a rim above a plane, and for how long none of its points can come down.

The points of a rim at the angle phi have heights h + a . u(phi) and rates h' + b . u(phi), with
u = (cos phi, sin phi) and a, b the heights and rates of two orthogonal radii. If no point is pulled down by
more than P, none is below -g before the first root of

    h + g + h' t - P t^2 / 2 - |a + b t|,

which is concave in t. So Newton's steps that start beyond the root come down to it. A time at which any one
point of the rim is at -g is beyond the root.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from contact_dynamics.tolerances import GRAZING_DEPTH, RIM_ACCURACY

_MAX_STEPS: Final = 60
"""Largest number of Newton's steps. Four are usual. Towards a nearly double root, each step halves the
distance."""


class RimAbove(NamedTuple):
    """A rim above a plane at one time.

    Attributes:
        height: Height of its centre, m.
        rate: Rate of that height, m/s.
        a: Heights of the ends of two orthogonal radii above the centre, m.
        b: Rates of these heights, m/s.
    """

    height: float
    rate: float
    a: tuple[float, float]
    b: tuple[float, float]

    def lowest(self) -> tuple[float, float, tuple[float, float]]:
        """Return the lowest point's height, m, its rate, m/s, and its direction (cos, sin).

        If all points have the same height, it is the one that sinks fastest.
        """
        (a_1, a_2), (b_1, b_2) = self.a, self.b
        size = math.hypot(a_1, a_2)
        if size > 0.0:
            u = (-a_1 / size, -a_2 / size)
        else:
            fastest = math.hypot(b_1, b_2)
            u = (-b_1 / fastest, -b_2 / fastest) if fastest > 0.0 else (1.0, 0.0)
        return self.height - size, self.rate + b_1 * u[0] + b_2 * u[1], u

    def free_for(self, pull: float) -> float:
        """Return for how long, s, no point can arrive that accelerates down by at most ``pull``, m/s^2."""
        pull = max(pull, 0.0)
        (a_1, a_2), (b_1, b_2) = self.a, self.b
        low, rate, _ = self.lowest()
        slowest = self.rate - math.hypot(b_1, b_2)
        if low <= 0.0:  # it rises from below the plane: it is free while all points rise, or for a graze
            return max(slowest, math.sqrt(2.0 * GRAZING_DEPTH * pull)) / pull if pull > 0.0 else math.inf
        beyond = _arrival(low + GRAZING_DEPTH, rate, pull)
        if slowest < 0.0:  # the point that sinks fastest is no higher than the rim's top
            top = self.height + math.hypot(a_1, a_2)
            beyond = min(beyond, _arrival(top + GRAZING_DEPTH, slowest, pull))
        if math.isinf(beyond):
            return beyond
        t = beyond
        for _ in range(_MAX_STEPS):
            x, y = a_1 + b_1 * t, a_2 + b_2 * t
            size = math.hypot(x, y)
            value = self.height + GRAZING_DEPTH + t * (self.rate - 0.5 * pull * t) - size
            slope = self.rate - pull * t - ((b_1 * x + b_2 * y) / size if size > 0.0 else 0.0)
            if value >= 0.0 or slope >= 0.0:
                break
            before, t = t, max(t - value / slope, 0.0)
            if before - t <= RIM_ACCURACY * before:
                break
        return t


def _arrival(height: float, rate: float, pull: float) -> float:
    """Return when a point at a height > 0 that is always pulled down arrives at zero, or inf if never."""
    root = math.sqrt(rate * rate + 2.0 * pull * height)
    if rate < 0.0:
        return 2.0 * height / (root - rate)
    return (rate + root) / pull if pull > 0.0 else math.inf
