# SPDX-License-Identifier: Apache-2.0
"""This file bounds the accelerations of a moving body's points towards a plane, all along its motion.

A point at r from the centre of mass has the acceleration a + w' x r + w x (w x r). Its part along a plane's
normal n is at least -(fall + |r| turning), with

    fall = max(-n . a),    turning = max(|w|^2 (1 + 1/sqrt 3) + |I^-1 N|),

because |I^-1 (I w x w)| <= |w|^2 / sqrt 3. Its first component is |I_2 - I_3| / I_1 |w_2 w_3|, the others
follow by cyclic permutation, and no body has |I_2 - I_3| > I_1.

Without torque the bound holds for all time (`FreeMotion`). Under forces (`ForcedMotion`) it holds along one
step of the integrator. In the step every variable is a polynomial of degree 7, and a polynomial stays within
its Bernstein coefficients (Farin, Curves and Surfaces for CAGD, 4.3). So the largest force and torque of the
step are bounded, not sampled. The bounds are those of the integrated motion, whose accuracy
`motion.integrated` states.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

import numpy as np

from contact_dynamics.motion.integrated import ForcedMotion
from contact_dynamics.tolerances import GRAZING_DEPTH
from contact_dynamics.tumbling import FreeMotion
from contact_dynamics.tumbling.polhode import Spin, largest_rate

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.validation import FloatArray

Motion: TypeAlias = FreeMotion | ForcedMotion

_GYROSCOPIC: Final = 1.0 / math.sqrt(3.0)
_DEGREE: Final = 7

_FEW: Final = 24
"""Up to this number of points, floats cost less than NumPy's calls."""


class Bound(NamedTuple):
    """A bound that holds from the time asked for until another."""

    until: float  # end of the bound, s, later than the time asked for
    fall: float  # largest acceleration of the centre of mass against the normal, m/s^2, may be negative
    turning: float  # largest acceleration of a point relative to it, for each metre of distance, 1/s^2


def bounds_of(motion: Motion, normal_W: FloatArray) -> Callable[[float], Bound]:
    """Return the bound that holds from a time >= 0, s, for planes with a unit normal, (3,), world axes."""
    if isinstance(motion, FreeMotion):
        steady = isinstance(motion.rotation, Spin)  # about one axis: the angular acceleration is zero
        turning = (1.0 if steady else 1.0 + _GYROSCOPIC) * largest_rate(motion.rotation) ** 2
        forever = Bound(math.inf, -float(normal_W @ motion.gravity_W), turning)
        return lambda _: forever
    return _Along(motion, normal_W)


def free_for(height: float, rate: float, pull: float) -> float:
    """Return for how long, s, a point above a plane cannot arrive, if ``pull`` is its largest acceleration.

    Arguments are in m, m/s, m/s^2. A dip of less than `GRAZING_DEPTH` does not count as arrival.
    """
    if height <= 0.0:  # it rises from below the plane: it is free while it rises, and for a graze at least
        return max(rate, math.sqrt(2.0 * GRAZING_DEPTH * pull)) / pull if pull > 0.0 else math.inf
    allowed = height + GRAZING_DEPTH
    stop = rate * rate + 2.0 * pull * allowed
    if rate < 0.0:
        return 2.0 * allowed / (math.sqrt(stop) - rate) if stop >= 0.0 else math.inf
    return (rate + math.sqrt(stop)) / pull if pull > 0.0 else math.inf


def all_free_for(heights: FloatArray, rates: FloatArray, pulls: FloatArray) -> float:
    """Return for how long, s, none of many points can arrive: the least `free_for` of arrays (k,)."""
    if len(heights) <= _FEW:
        return min(map(free_for, heights.tolist(), rates.tolist(), pulls.tolist()), default=math.inf)
    # Divisors are zero for a point that nothing pulls, or that does not fall.
    with np.errstate(divide="ignore", invalid="ignore"):
        allowed = heights + GRAZING_DEPTH
        stop = rates * rates + 2.0 * pulls * allowed
        root = np.sqrt(np.maximum(stop, 0.0))
        falling = np.where(stop >= 0.0, 2.0 * allowed / (root - rates), np.inf)
        rising = np.where(pulls > 0.0, (rates + root) / pulls, np.inf)
        below = np.where(pulls > 0.0, np.maximum(rates, np.sqrt(2.0 * GRAZING_DEPTH * pulls)) / pulls, np.inf)
    return float(np.where(heights > 0.0, np.where(rates < 0.0, falling, rising), below).min())


class _Along:
    """The bound of the integrator's step at a time. It is kept until another step is asked for."""

    def __init__(self, motion: ForcedMotion, normal_W: FloatArray) -> None:
        self.motion = motion
        self.normal_W = normal_W
        self.least_moment = float(np.linalg.eigvalsh(motion.body.I_B)[0])  # kg m^2
        self.start = self.end = 0.0  # s
        self.bound: Bound

    def __call__(self, seconds: float) -> Bound:
        if not self.start <= seconds < self.end:
            self._step(seconds)
        return self.bound

    def _step(self, seconds: float) -> None:
        step = self.motion.step_at(seconds)
        self.start, self.end = step.start, step.end
        span = step.end - step.start
        values = step.variables(step.start + span * _NODES)
        force_rows, momentum = values[3:6], step.scale * values[10:13]  # m/s beside the parabola; kg m^2/s
        accelerations = _derivatives(force_rows, span) + self.motion.gravity_W[:, None]
        torques = _norms(_derivatives(momentum, span))
        twisting = float(torques.max()) / self.least_moment  # 1/s^2
        rate = float(_norms(_BERNSTEIN @ momentum.T, axis=1).max()) / self.least_moment  # |w| <= |L| / I_1
        # The rate at the start gives another bound, x = w_0 + span (twisting + x^2 / sqrt 3), for the whole
        # step.
        began = self.motion.sample(step.start).w_WB_W
        grown = math.sqrt(sum(w * w for w in began)) + span * twisting
        root = 1.0 - 4.0 * _GYROSCOPIC * span * grown
        if root > 0.0:
            rate = min(rate, 2.0 * grown / (1.0 + math.sqrt(root)))
        self.bound = Bound(
            until=step.end,
            fall=float((-self.normal_W @ accelerations).max()),
            turning=(1.0 + _GYROSCOPIC) * rate * rate + twisting,
        )


def _derivatives(values: FloatArray, span: float) -> FloatArray:
    """Return the Bernstein coefficients, (k, 7), of the rates of polynomials, (k, 8) at `_NODES`."""
    # Differences come first, because their size then sets the rounding.
    coefficients = (values - values[:, :1]) @ _BERNSTEIN.T
    rates: FloatArray = np.diff(coefficients, axis=1) * (_DEGREE / span)
    return rates


def _norms(vectors: FloatArray, axis: int = 0) -> FloatArray:
    lengths: FloatArray = np.linalg.norm(vectors, axis=axis)
    return lengths


def _bernstein_at(nodes: FloatArray) -> FloatArray:
    """Return the Bernstein polynomials, one a column, at nodes in [0, 1]."""
    return np.array(
        [
            [math.comb(_DEGREE, i) * x**i * (1.0 - x) ** (_DEGREE - i) for i in range(_DEGREE + 1)]
            for x in nodes.tolist()
        ]
    )


_NODES: Final = 0.5 - 0.5 * np.cos(np.pi * np.arange(_DEGREE + 1) / _DEGREE)
"""Chebyshev's nodes of a step in [0, 1], ends included. Eight values determine a polynomial of degree 7."""

_BERNSTEIN: Final = np.linalg.inv(_bernstein_at(_NODES))
"""Matrix from values at `_NODES` to Bernstein coefficients."""
