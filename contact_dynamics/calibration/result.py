# SPDX-License-Identifier: Apache-2.0
"""The result of a calibration: estimates with covariance, their data, and warnings."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.records import Record

if TYPE_CHECKING:
    from contact_dynamics.calibration.estimation import Spread
    from contact_dynamics.calibration.first_flights import IntArray
    from contact_dynamics.calibration.observed import Observed
    from contact_dynamics.calibration.slides import LastingFriction
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body, Surface

CONTRADICTED: Final = 3.0
"""Standard deviations. A configured value that is farther from the estimate is contradicted."""

DISAGREE: Final = 0.0455
"""Probability with which chance alone makes the two ways disagree in any parameter: that of a normal number
beyond two standard deviations."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Estimate(Record):
    """One parameter.

    Attributes:
        name: Such as ``friction.floor`` or ``center_of_mass.x``.
        unit: m, rad, m/s^2, or empty. Factors have none.
        configured: The value before.
        value: The estimate from velocities before and after strikes.
        std: Its standard deviation, by the scatter between tosses and by the choice between free size and
            free surface height where they explain the data alike; NaN where the data say too little, and at
            a bound.
        by_paths: The estimate from whole trajectories through strikes; NaN if that was not requested.
        by_paths_std: Its standard deviation.
        difference_std: Standard deviation of the difference of both estimates, which come from the same data;
            NaN for a single toss.
        determined: Whether the data determine it alone, not only in combination with others. If not, the
            value is the configured one, or one of many that fit equally well.
        at_bound: Whether it lies at a bound, such as friction 0. It is then no estimate, unless it was
            configured so.
    """

    name: str
    unit: str
    configured: float
    value: float
    std: float
    by_paths: float = math.nan
    by_paths_std: float = math.nan
    difference_std: float = math.nan
    determined: bool = True
    at_bound: bool = False

    @property
    def contradiction(self) -> float:
        """Return the deviation of the configured value, in standard deviations; 0 if unknown."""
        if not self.determined or self.at_bound or not self.std > 0.0:
            return 0.0
        return abs(self.value - self.configured) / self.std

    @property
    def disagreement(self) -> float:
        """Return the difference of both ways, in standard deviations; 0 if unknown."""
        if math.isnan(self.by_paths) or not self.difference_std > 0.0:
            return 0.0
        return abs(self.value - self.by_paths) / self.difference_std


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Outlier(Record):
    """An observation that was rejected."""

    recording: str  # name of the toss
    kind: str  # kind of the observation, such as "velocities after impacts"
    time: float  # s, on the recording's clock; NaN for observations without a single time
    size: float  # size of its residuals, in standard deviations


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class MeasuredGravity(Record):
    """Gravity, measured in first flights."""

    mean_W: FloatArray  # (3,), m/s^2, mean over the tosses, world axes
    # m/s^2, standard deviation of a component of the mean, by the scatter between tosses; NaN for a single
    # one
    mean_std: float
    size: float  # m/s^2, mean size
    size_std: float  # m/s^2, its standard deviation; NaN for a single toss
    tilt: float  # rad, median angle between a toss's gravity and the mean
    expected_tilt: float  # rad, this angle under the noise of positions alone
    count: int  # number of tosses whose first flight determines gravity
    # m/s^2, scatter from toss to toss without the noise of positions: standard deviation of each component
    # across the mean. Tilted recordings cause it.
    turning: float
    changing: float  # m/s^2, the same along the mean

    @property
    def covariance_W(self) -> FloatArray:
        """Return how uncertain gravity is in one more toss, (3, 3), m^2/s^4, world axes."""
        down = self.mean_W / np.linalg.norm(self.mean_W)
        along = np.outer(down, down)
        found: FloatArray = (
            self.mean_std**2 * np.eye(3) + self.turning**2 * (np.eye(3) - along) + self.changing**2 * along
        )
        return found


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Calibration(Record):
    """The result of a calibration.

    Attributes:
        body: The body as calibrated. Its mass is the configured one, since motion does not determine it.
        surfaces: The surfaces as calibrated.
        gravity_W: (3,), m/s^2, as calibrated, or as configured where it is not free.
        estimates: The free parameters.
        covariance: (f, f), of the estimates' values, in their order and units.
        by_paths_covariance: (f, f), of the second way's values, in the same units, or None if only the first
            was asked for.
        undetermined: Directions in parameter space that the data do not determine, in words.
        gravity: Gravity as measured, or None without first flights.
        spread: How far residuals scatter beyond the noise of measurement.
        lasting_frictions: The friction of sustained contact, for each surface with enough observed slides.
        residuals: (n, 6), m/s and rad/s, predicted less measured velocities after each strike.
        residual_stds: (n, 6), the standard deviations that they should have by the noise of measurement.
        strike_recordings: (n,), number of each strike's toss.
        observed: The tosses and what was found in them.
        outliers: What was left out.
        warnings: Doubtful results, in sentences.
        problems: Problems that prevent a result, in sentences.
        clusters: Number of tosses that the estimates rest on.
        by_cluster: Whether errors are those by the scatter between tosses.
    """

    body: Body
    surfaces: tuple[Surface, ...]
    gravity_W: FloatArray
    estimates: tuple[Estimate, ...]
    covariance: FloatArray
    by_paths_covariance: FloatArray | None
    undetermined: tuple[str, ...]
    gravity: MeasuredGravity | None
    spread: Spread
    lasting_frictions: tuple[LastingFriction, ...]
    residuals: FloatArray
    residual_stds: FloatArray
    strike_recordings: IntArray
    observed: tuple[Observed, ...] = field(repr=False)
    outliers: tuple[Outlier, ...]
    warnings: tuple[str, ...]
    problems: tuple[str, ...]
    clusters: int
    by_cluster: bool

    def estimate(self, name: str) -> Estimate:
        """Return the estimate of that name, or raise `KeyError`."""
        for each in self.estimates:
            if each.name == name:
                return each
        raise KeyError(name)

    @property
    def correlations(self) -> FloatArray:
        """Return the correlations of the estimates, (f, f); NaN where one is not determined."""
        stds = np.sqrt(self.covariance.diagonal())
        with np.errstate(invalid="ignore", divide="ignore"):
            correlations: FloatArray = self.covariance / np.outer(stds, stds)
        return correlations

    def region(self, probability: float) -> float:
        """Return the squared distance, by the covariance, within which the truth lies with a probability."""
        from scipy.stats import chi2

        return float(chi2.ppf(probability, int(np.sum(self.covariance.diagonal() > 0.0))))

    def distance(self, truth: FloatArray, *, by_paths: bool = False) -> float:
        """Return the squared distance of other values, (f,), from the estimates, by the covariance.

        With ``by_paths``, the estimates are those of the second way; it is infinite if there are none.
        """
        covariance = self.by_paths_covariance if by_paths else self.covariance
        if covariance is None:
            return math.inf
        found = np.array([each.by_paths if by_paths else each.value for each in self.estimates])
        off, known = found - truth, covariance.diagonal() > 0.0
        return float(off[known] @ np.linalg.solve(covariance[np.ix_(known, known)], off[known]))
