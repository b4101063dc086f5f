# SPDX-License-Identifier: Apache-2.0
"""Checks whether positions are those of one flight: without an impact, and of a falling body.

Model: the residuals of the fitted motion are white noise and, if an impact is among the states, two straight
lines with a break. A wrong force bends a single line instead. Two lines are therefore compared with one
parabola by their likelihoods with noise of unknown size, and must be far better, because noise of trackers is
correlated. The search starts with the last few states and doubles their number in each round.
Of several impacts, it therefore finds the latest.

A body that rests, slides or is carried does not fall: its acceleration is off by more than half of gravity.

If only the newest state is after an impact, there is no second line, and this state is compared with the
parabola of the others by the same criteria.

Not covered: an impact with fewer than two states before it, one whose change of velocity is hidden by the
noise, and contacts that act slowly. A jump of the positions themselves counts as an impact, also that of a
newest state that is an outlier.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.tolerances import LEAST_NOISE

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray

MIN_VARIANCE_RATIO: Final = 9.0
"""Minimum ratio of the variances about a parabola and about two lines with an impact between them."""

LEAST_EVIDENCE: Final = 32.0
"""Least difference of twice the logarithms of the likelihoods. It matters for fewer than a dozen states, for
which noise alone could reach the ratio."""

OFF_GRAVITY: Final = 0.5
"""Largest error of the acceleration of a flight relative to gravity, if the states determine it."""

_FIRST: Final = 6  # states of the first round
_LEAST: Final = 2  # states of a line
_FEWEST_OF_PARABOLA: Final = 4  # a parabola fits any three positions


def velocity_jump(seconds: FloatArray, misses_W: FloatArray) -> float | None:
    """Return the time, s, at which the velocity of a body jumps, or None if the positions show no jump.

    ``misses_W``, (n, 3), m, are the positions at ascending times less those of a smooth motion.
    """
    total, count, after = len(seconds), _FIRST, 0
    while count <= total:
        found = _states_after(seconds[-count:], misses_W[-count:])
        if after and not found:  # an earlier impact is among the states, too
            break
        after = found
        if after and 2 * after <= count:  # otherwise, more states before it show better where it is
            break
        count = total if count < total < 2 * count else 2 * count
    if not after and _newest_is_off(seconds, misses_W):
        after = 1
    return 0.5 * float(seconds[-after - 1] + seconds[-after]) if after else None


def is_held(seconds: FloatArray, misses_W: FloatArray, gravity_W: FloatArray) -> bool:
    """Return whether the acceleration of a body is not that of flight, because it is supported.

    ``misses_W``, (n, 3), m, are the positions at ascending times less those of a flight.
    """
    n, gravity = len(seconds), float(np.linalg.norm(gravity_W))
    if n < _FEWEST_OF_PARABOLA or gravity == 0.0:
        return False
    length = float(seconds[-1] - seconds[0])
    powers, bent, curved = _parabola(seconds, misses_W)
    straight = misses_W - powers[:, :2] @ np.linalg.lstsq(powers[:, :2], misses_W, rcond=None)[0]
    least = n * LEAST_NOISE**2
    ratio = (float(np.square(straight).sum()) + least) / (float(np.square(curved).sum()) + least)
    off = 2.0 * float(np.linalg.norm(bent)) / length**2
    return off > OFF_GRAVITY * gravity and (3 * n - 9) * math.log(ratio) > LEAST_EVIDENCE


def _parabola(t: FloatArray, x: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return powers of the times, from 0 to 1, the coefficient of the squares, and the residuals, (n, 3)."""
    s = (t - t[0]) / (t[-1] - t[0])
    powers = np.column_stack([np.ones_like(s), s, np.square(s)])
    coefficients = np.linalg.lstsq(powers, x, rcond=None)[0]
    return powers, coefficients[2], x - powers @ coefficients


def _states_after(t: FloatArray, x: FloatArray) -> int:
    """Return the number of states after a break, or zero without a break."""
    n = len(t)
    x = x - x.mean(axis=0)
    powers, _, left = _parabola(t, x)
    s, smooth = powers[:, 1], float(np.square(left).sum())
    sums = _squares_about_lines(s, x)[_LEAST - 1 : -_LEAST]
    sums = sums + _squares_about_lines(s[::-1], x[::-1])[::-1][_LEAST : 1 - _LEAST]
    best = int(sums.argmin())
    broken = max(float(sums[best]), 0.0)
    return n - best - _LEAST if _is_far_better(n, smooth, broken, 3 * n - 13) else 0


def _newest_is_off(t: FloatArray, x: FloatArray) -> bool:
    """Return whether the newest state is off the parabola of the others."""
    n = len(t)
    if n <= _FIRST:
        return False
    all_of_them, others = _parabola(t, x)[2], _parabola(t[:-1], x[:-1])[2]
    return _is_far_better(n, float(np.square(all_of_them).sum()), float(np.square(others).sum()), 3 * n - 12)


def _is_far_better(n: int, smooth: float, broken: float, free: int) -> bool:
    """Return whether n positions fit another model far better than one parabola.

    ``smooth`` and ``broken``, m^2, are the sums of squared residuals of the parabola and of the other model,
    and ``free`` is the number of degrees of freedom of the other model.
    """
    least = n * LEAST_NOISE**2
    ratio = (smooth + least) / (broken + least)
    return ratio * free >= MIN_VARIANCE_RATIO * (3 * n - 9) and free * math.log(ratio) >= LEAST_EVIDENCE


def _squares_about_lines(s: FloatArray, x: FloatArray) -> FloatArray:
    """Return the sums of squares of the first 1, 2, …, n points about the line that fits them best, (n,)."""
    count = np.arange(1.0, len(s) + 1.0)
    mean_s, mean_x = np.cumsum(s) / count, np.cumsum(x, axis=0) / count[:, None]
    ss = np.cumsum(s * s) - count * mean_s**2
    sx = np.cumsum(s[:, None] * x, axis=0) - (count * mean_s)[:, None] * mean_x
    xx = np.cumsum(x * x, axis=0) - count[:, None] * mean_x**2
    with np.errstate(invalid="ignore", divide="ignore"):
        explained = np.where(ss[:, None] > 0.0, sx**2 / ss[:, None], 0.0)
    squares: FloatArray = np.maximum(xx - explained, 0.0).sum(axis=1)
    return squares
