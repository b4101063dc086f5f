# SPDX-License-Identifier: Apache-2.0
"""Fits the parameters to the strikes in one of two ways, together with first flights and rests.

Each kind of residual has a spread of its own in addition to the measurement noise, since the impact law, the
surface and the body deviate from the model. It is the spread at which the residuals have the median of a
normal distribution. It is estimated twice, each time before a fit, so that a poor start does no harm.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.calibration.free import GEOMETRY, Free
from contact_dynamics.calibration.impacts import jump_covariances, jumps
from contact_dynamics.numerics.clustered_fit import REJECTED, Group, fit_clustered
from contact_dynamics.records import Record
from contact_dynamics.tolerances import DERIVATIVE_STEP, SPREAD_FOUND

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from contact_dynamics.calibration.first_flights import Gravity, Straightness
    from contact_dynamics.calibration.model import Model
    from contact_dynamics.calibration.strikes import Strikes, Touching
    from contact_dynamics.numerics.clustered_fit import ClusteredFit
    from contact_dynamics.validation import FloatArray

MEDIAN_OF_SQUARES: Final = {1: 0.4549, 2: 1.3863, 3: 2.3660}  # medians of chi squared, by degrees of freedom

SPREAD_ROUNDS: Final = 3
"""Fits, each with the spreads of the one before. The third changes estimates by a small part of their
errors."""

ALIKE: Final = 1.25
"""Ratio of the robust sums of squares below which two choices of free parameters fit the data alike."""

FRICTIONS: Final = (1.0, 0.4)  # shares of the configured friction from which the first fit starts


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Spread(Record):
    """Scatter of the residuals beyond the measurement noise."""

    velocity: float = 0.0  # m/s, of each component of a velocity after a strike: the law's own spread
    spin: float = 0.0  # rad/s, of each component of an angular velocity after a strike
    strike_height: float = 0.0  # m, of the height of a corner that strikes
    rest_height: float = 0.0  # m, of the height of a corner at rest
    flight: float = 1.0  # factor on the noise of positions, for the mass centre from first flights
    turn: float = 1.0  # factor on the noise of orientations, for the ratios of moments from first flights


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Data(Record):
    """The data of the fit."""

    clusters: int  # number of recordings
    strikes: Strikes  # the strikes
    gravity: Gravity  # gravity of each recording
    center: Straightness  # residuals of first flights in the mass centre
    ratios: Straightness | None  # their residuals in the ratios of moments, or None if these are not free
    resting: Touching  # the corners at rests


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Estimation(Record):
    """One way's estimate."""

    fit: ClusteredFit  # the fit, in standard units, of the free parameters
    values: FloatArray  # (p,), all parameters
    spread: Spread  # the spreads in the weights of the residuals
    kinds: tuple[str, ...]  # names of the groups of residuals, in the order of the fit's sizes


class Fitting:
    """The residuals of one set of free parameters."""

    def __init__(self, model: Model, data: Data, free: Sequence[Free]) -> None:
        self.model = model
        self.data = data
        self.free = free
        self.at = model.chosen(free)
        self._lower = np.array([p.lower for p in model.parameters])[self.at]
        self._upper = np.array([p.upper for p in model.parameters])[self.at]
        self.steps = model.steps[self.at]

    def values(self, x: FloatArray) -> FloatArray:
        """Return all parameters for free ones, (f,), in standard units."""
        values = self.model.configured.copy()
        values[self.at] = x * self.steps
        return values

    def start(self) -> FloatArray:
        """Return the configured values of the free parameters, in standard units."""
        start: FloatArray = self.model.configured[self.at] / self.steps
        return start

    def derivatives(
        self, x: FloatArray, of: Callable[[FloatArray], FloatArray]
    ) -> tuple[FloatArray, FloatArray]:
        """Return a function of all parameters, (n, k), and its derivatives by the free ones, (n, k, f).

        The function takes several rows of all parameters, (v, p), and returns (v, n, k).
        """
        steps = np.where((x + DERIVATIVE_STEP) * self.steps <= self._upper, DERIVATIVE_STEP, -DERIVATIVE_STEP)
        rows = np.vstack([x, x + np.diag(steps)])
        found = of(np.array([self.values(row) for row in rows]))
        return found[0], np.moveaxis((found[1:] - found[0]) / steps[:, None, None], 0, -1)

    def estimate(
        self,
        strikes_at: Callable[[FloatArray, Spread], Sequence[tuple[str, Group]]],
        *,
        spread: Spread | None = None,
        start: FloatArray | None = None,
        rounds: int = SPREAD_ROUNDS,
    ) -> Estimation:
        """Return the estimate.

        ``strikes_at`` returns the residuals of the strikes at free parameters, and their names. The spreads
        are estimated if ``spread`` is None. The ``start``, (f,), in standard units, is by default the
        configured values. Each of the ``rounds`` of fits starts from the result of the previous one; the last
        one rejects outliers.
        """
        x = self.start() if start is None else start
        kinds: list[str] = []
        for number in range(rounds):
            weighed = self.spread_at(x) if spread is None else spread

            def groups_at(x: FloatArray, weighed: Spread = weighed) -> list[Group]:
                named = [*strikes_at(x, weighed), *self._others(x, weighed)]
                kinds[:] = [name for name, _ in named]
                return [group for _, group in named]

            starts = self._starts(x) if start is None and number == 0 else [x]
            fits = [
                fit_clustered(
                    each,
                    groups_at=groups_at,
                    lower=self._lower / self.steps,
                    upper=self._upper / self.steps,
                    clusters=self.data.clusters,
                    rejected=REJECTED if number == rounds - 1 else math.inf,
                )
                for each in starts
            ]
            fit = min(fits, key=lambda each: each.cost)
            x = fit.parameters
        return Estimation(fit=fit, values=self.values(x), spread=weighed, kinds=tuple(kinds))

    def choice(self, found: Estimation, covariances: FloatArray) -> FloatArray:
        """Return the change of the estimate, (f,), with other free parameters that explain the heights.

        A slightly smaller body, a slightly lower surface and slightly rounder corners explain the same
        heights. If the rounding with the other one of size and surface height fits nearly as well (`ALIKE`),
        or better, the data do not support this choice.
        """
        moved: FloatArray = np.zeros(len(self.at))
        heights = {Free.ROUNDING, Free.SIZE, Free.SURFACE_HEIGHT} & set(self.free)
        both = heights >= {Free.SIZE, Free.SURFACE_HEIGHT}
        faces = Free.ROUNDING in self.model.standard
        if not heights or both or not faces or not len(self.data.strikes):
            return moved
        instead = Free.SIZE if Free.SURFACE_HEIGHT in heights else Free.SURFACE_HEIGHT
        free = [*(set(self.free) - heights), Free.ROUNDING, instead]
        other = Fitting(self.model, self.data, free)
        there = other.estimate(
            lambda x, spread: other.whitened_jumps(x, spread, covariances),
            spread=found.spread,
            start=found.values[other.at] / other.steps,
            rounds=2,
        )
        if there.fit.cost < ALIKE * found.fit.cost:
            moved = (there.values - found.values)[self.at] / self.steps * ~found.fit.at_bound
        return moved

    def _starts(self, x: FloatArray) -> list[FloatArray]:
        """Return the starts: the configured values, and less friction.

        If friction is so large that every corner sticks, the residuals do not depend on it.
        """
        frictions = [self.model.parameters[number].group is Free.FRICTION for number in self.at]
        return [np.where(frictions, share * x, x) for share in (FRICTIONS if any(frictions) else (1.0,))]

    def whitened_jumps(
        self, x: FloatArray, spread: Spread, covariances: FloatArray
    ) -> list[tuple[str, Group]]:
        """Return the residuals of the first way, whitened by covariances of measurement, (n, 6, 6)."""
        strikes = self.data.strikes
        if len(strikes) == 0:
            return []
        base, slopes = self.derivatives(
            x, lambda values: jumps(self.model, values, strikes, self.data.gravity)
        )
        whole = covariances + np.diag(np.repeat([spread.velocity**2, spread.spin**2], 3))
        factors = np.linalg.inv(np.linalg.cholesky(whole))
        group = Group(
            residuals=np.einsum("nij,nj->ni", factors, base),
            derivatives=factors @ slopes,
            clusters=strikes.recordings,
        )
        return [("velocities after impacts", group)]

    def spread_at(self, x: FloatArray) -> Spread:
        """Return the spreads at which the medians of residuals are those of normal ones."""
        data, values = self.data, self.values(x)
        described = self.model.describe(values)
        velocity = spin = 0.0
        if len(data.strikes):
            off = jumps(self.model, values[None], data.strikes, data.gravity)[0]
            covariances = jump_covariances(self.model, values, data.strikes, data.gravity)
            velocity = extra_spread(off[:, :3], covariances[:, :3, :3])
            spin = extra_spread(off[:, 3:], covariances[:, 3:, 3:])
        heights = [
            extra_spread(touch.heights(described)[:, None], touch.stds[:, None, None] ** 2)
            for touch in (data.strikes, data.resting)
        ]
        return Spread(
            velocity=velocity,
            spin=spin,
            strike_height=heights[0],
            rest_height=heights[1],
            flight=_factor_of(data.center, values[:3]),
            turn=1.0 if data.ratios is None else _factor_of(data.ratios, values[4:6]),
        )

    def _others(self, x: FloatArray, spread: Spread) -> list[tuple[str, Group]]:
        found = []
        values, data = self.values(x), self.data
        if Free.CENTER_OF_MASS in self.free and len(data.center.recordings):
            found.append(("first flights", self._straight(data.center, values[:3], 0, spread.flight)))
        if Free.INERTIA_RATIOS in self.free and data.ratios is not None and len(data.ratios.recordings):
            found.append(("turns of first flights", self._straight(data.ratios, values[4:6], 4, spread.turn)))
        if not set(self.free) & set(GEOMETRY):
            return found
        for name, touch, extra in (
            ("heights at impacts", data.strikes, spread.strike_height),
            ("heights at rest", data.resting, spread.rest_height),
        ):
            if len(touch.stds) == 0:
                continue

            def heights(values: FloatArray, touch: Touching = touch) -> FloatArray:
                return np.array([touch.heights(self.model.describe(row)) for row in values])[:, :, None]

            base, slopes = self.derivatives(x, heights)
            weights = 1.0 / np.hypot(touch.stds, extra)[:, None]
            group = Group(
                residuals=weights * base, derivatives=weights[:, :, None] * slopes, clusters=touch.recordings
            )
            found.append((name, group))
        return found

    def _straight(self, given: Straightness, x: FloatArray, first: int, factor: float) -> Group:
        """Return the residuals of a `Straightness`, linear in the parameters from number ``first`` on."""
        derivatives = np.zeros((*given.at_zero.shape, len(self.at)))
        for k in range(given.slopes.shape[2]):
            column = np.flatnonzero(self.at == first + k)
            derivatives[:, :, column[0]] = given.slopes[:, :, k] * self.steps[column[0]] / factor
        return Group(
            residuals=(given.at_zero + given.slopes @ x) / factor,
            derivatives=derivatives,
            clusters=given.recordings,
        )


def _factor_of(given: Straightness, x: FloatArray) -> float:
    if len(given.recordings) == 0:
        return 1.0
    squares = np.square(given.at_zero + given.slopes @ x).sum(axis=1)
    return float(np.sqrt(max(1.0, float(np.median(squares)) / MEDIAN_OF_SQUARES[3])))


def extra_spread(residuals: FloatArray, covariances: FloatArray) -> float:
    """Return the extra standard deviation of normal residuals, (n, k), with covariances, (n, k, k).

    With it, their median squared distance is that of chi squared with k degrees of freedom. It is 0 if the
    covariances suffice.
    """
    if len(residuals) == 0:
        return 0.0
    width = residuals.shape[1]
    target = MEDIAN_OF_SQUARES[width]

    def median(variance: float) -> float:
        whole = covariances + variance * np.eye(width)
        solved = np.linalg.solve(whole, residuals[:, :, None])[:, :, 0]
        return float(np.median(np.einsum("nk,nk->n", residuals, solved)))

    if median(0.0) <= target:
        return 0.0
    low, high = 0.0, float(np.square(residuals).sum(axis=1).max())
    while high - low > SPREAD_FOUND * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if median(middle) > target else (low, middle)
    return float(np.sqrt(high))
