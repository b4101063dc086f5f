# SPDX-License-Identifier: Apache-2.0
"""The noise of published poses is correlated in time, and its size differs from flight to flight.

Model: each component of a pose's error is a stationary Gauss-Markov process (Ornstein and Uhlenbeck) of one
standard deviation and correlation time, exp(-dt / tau). The variance is common to a window. From window to
window it is drawn from a scaled inverse chi-squared distribution, whose degrees of freedom are those of the
heavy tails: errors over many windows are then Student's. A window's own residuals update the variance.

Where the noise is not known, the covariance is the average over correlation times (`FRAMES`), weighted by
the restricted likelihood of the residuals, whose variance has Jeffreys' prior. A dozen states cannot
distinguish slow errors from motion, so their average is wider than for white noise. From about thirty states
on, the residuals determine the result.

Not covered: noise in the axes of a camera, and errors that last longer than all recorded flights.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.records import Record
from contact_dynamics.tolerances import LEAST_NOISE
from contact_dynamics.validation import FloatArray, check_not_negative, check_positive

FRAMES: Final = (0.0, 1.0, 2.0, 4.0, 8.0, 16.0)
"""Correlation times, in intervals between states, over which the covariance of unknown noise is averaged."""

LEAST_DEGREES: Final = 2.0
"""Student's distribution has no variance with so few degrees of freedom."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class StateNoise(Record):
    """Noise of each component of published states. Poses have correlated noise, velocities white noise.

    `measured_noise` estimates it from recorded flights.

    Attributes:
        position: m, > 0, standard deviation.
        orientation: rad, > 0, standard deviation of the components of a rotation vector.
        linear_velocity: m/s, > 0, or None if published linear velocities are not used.
        angular_velocity: rad/s, > 0, or None if published angular velocities are not used.
        position_time: s, >= 0, correlation time of the positions. 0 is white noise.
        orientation_time: s, >= 0, correlation time of the orientations.
        degrees_of_freedom: > 2, of Student's distribution of the errors over many flights. The fewer, the
            more the noise differs from flight to flight. If None, the noise is Gaussian.

    Raises:
        InvalidFieldError: a number is out of its range.
    """

    position: float
    orientation: float
    linear_velocity: float | None = None
    angular_velocity: float | None = None
    position_time: float = 0.0
    orientation_time: float = 0.0
    degrees_of_freedom: float | None = None

    def __post_init__(self) -> None:
        """Check the given values."""
        for name in ("position", "orientation", "linear_velocity", "angular_velocity"):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, check_positive(f"{name}_noise", value))
        for name in ("position_time", "orientation_time"):
            object.__setattr__(self, name, check_not_negative(name, getattr(self, name)))
        if self.degrees_of_freedom is not None:
            degrees = check_positive("degrees_of_freedom", self.degrees_of_freedom)
            if degrees <= LEAST_DEGREES:
                raise InvalidFieldError("degrees_of_freedom", degrees, f"> {LEAST_DEGREES:g}")
            object.__setattr__(self, "degrees_of_freedom", degrees)


def variance_factor(noise: StateNoise, cost: float, free: int) -> float:
    """Return the factor on given variances after a window with ``free`` degrees of freedom.

    ``cost`` is the sum of squares of its whitened residuals, in the given deviations.
    """
    if noise.degrees_of_freedom is None:
        return 1.0
    prior = noise.degrees_of_freedom - LEAST_DEGREES
    return (prior + cost) / (prior + free)


def scaled(noise: StateNoise, position: float, orientation: float) -> StateNoise:
    """Return a noise with factors on the variances of its positions and orientations."""
    return replace(
        noise,
        position=noise.position * math.sqrt(position),
        orientation=noise.orientation * math.sqrt(orientation),
    )


def whitened(rows: FloatArray, seconds: FloatArray, time: float | FloatArray) -> FloatArray:
    """Return rows at times (n,), (n, ...), without the correlation of ``time`` (s) from row to row.

    Each row after the first becomes its innovation (prediction error) over the standard deviation of that.
    For several correlation times, (t,), the result is (t, n, ...).
    """
    if isinstance(time, float) and time == 0.0:
        return rows
    share, scale = (each.reshape(*each.shape, *(1,) * (rows.ndim - 1)) for each in _steps(seconds, time))
    later = (rows[1:] - share * rows[:-1]) / scale
    first = np.broadcast_to(rows[:1], (*later.shape[: -rows.ndim], *rows[:1].shape))
    return np.concatenate([first, later], axis=-rows.ndim)


def _steps(seconds: FloatArray, time: float | FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return correlations from row to row, and standard deviations of innovations, (n - 1,) or (t, n - 1)."""
    time = np.asarray(time, dtype=np.float64)[..., None]
    shape = np.broadcast_shapes(time.shape, (len(seconds) - 1,))
    between = np.divide(np.diff(seconds), time, out=np.full(shape, np.inf), where=time > 0.0)
    return np.exp(-between), np.sqrt(-np.expm1(-2.0 * between))


@dataclass(frozen=True, slots=True, eq=False)
class Whitened:
    """Linear fits to rows that were whitened for t correlation times."""

    cost: FloatArray  # (t,), sums of squares of the residuals, for unit variance
    free: int  # number of residuals less that of the unknowns
    log_weight: FloatArray  # (t,), logarithms of the restricted likelihood, but for cost and variance
    inverse: FloatArray  # (t, k, k); inverse @ inverse^T is the covariance of the unknowns for unit variance
    step: FloatArray  # (t, k, b), the fitted unknowns


def fit_whitened(design: FloatArray, values: FloatArray, seconds: FloatArray, times: FloatArray) -> Whitened:
    """Fit design (n, a, k) to values (n, a, b) at times (n,), for each correlation time of noise, (t,), s."""
    n, a, k = design.shape
    b = values.shape[2]
    rows = whitened(design, seconds, times).reshape(-1, n * a, k)
    sizes = np.sqrt(np.square(rows).sum(axis=1))
    orthogonal, triangle = np.linalg.qr(rows / sizes[:, None])
    seen = whitened(values, seconds, times).reshape(-1, n * a, b)
    explained = orthogonal.transpose(0, 2, 1) @ seen
    inverse = np.linalg.inv(triangle) / sizes[:, :, None]
    diagonal = np.abs(np.diagonal(triangle, axis1=1, axis2=2))
    determinant = (np.log(diagonal) + np.log(sizes)).sum(axis=1)
    scales = np.log(_steps(seconds, times)[1]).sum(axis=1)
    return Whitened(
        cost=np.square(seen - orthogonal @ explained).sum(axis=(1, 2)),
        free=(n * a - k) * b,
        log_weight=-a * b * scales - b * determinant,
        inverse=inverse,
        step=inverse @ explained,
    )


def average_covariance(design: FloatArray, misses: FloatArray, seconds: FloatArray) -> FloatArray:
    """Return the covariance, (k, k), of a least-squares fit whose noise is not known.

    Args:
        design: (n, a, k), the derivatives of what is seen by the unknowns.
        misses: (n, a, b), the residuals. The b columns are of independent unknowns with the same design.
        seconds: (n,), the times.

    Each correlation time has its own best fit, and its distance from the given one counts as an error.
    """
    interval = float(np.median(np.diff(seconds)))
    fits = fit_whitened(design, misses, seconds, interval * np.array(FRAMES))
    least = LEAST_NOISE**2 * misses.size
    logs = fits.log_weight - 0.5 * fits.free * np.log(fits.cost + least)
    weights = np.exp(logs - logs.max())
    variances = (fits.cost / (fits.free - LEAST_DEGREES))[:, None, None]
    steps = fits.step @ fits.step.transpose(0, 2, 1) / misses.shape[2]
    covariances = variances * fits.inverse @ fits.inverse.transpose(0, 2, 1) + steps
    average: FloatArray = np.tensordot(weights / weights.sum(), covariances, 1)
    return average
