# SPDX-License-Identifier: Apache-2.0
"""Detects changes of a surface's coefficients in successive impacts, and estimates the coefficients.

The detector is Page's (1954) cumulative sum of log-likelihood ratios, with one sum for each alternative value
of a coefficient. This is a generalised likelihood ratio test over these values (Lorden 1971). A sum that
falls below zero is reset. A change is reported from the time at which the largest sum exceeds `THRESHOLD`
until it falls below `ENDS`.

The estimate is recursive: one weighted Gauss-Newton step per impact, with the weights of Student's t. When a
change is detected, the estimate restarts at the first impact in the sum.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.monitoring.evidence import Parameter, alternatives, inverse_of_known, is_known
from contact_dynamics.records import Record

if TYPE_CHECKING:
    from contact_dynamics.monitoring.evidence import ImpactEvidence
    from contact_dynamics.validation import FloatArray

THRESHOLD: Final = 5.0
"""Sum of log-likelihood ratios at which a change is reported. Of 2000 simulated impacts without a change, 3
started a report, for both coefficients together."""

ENDS: Final = 0.5 * THRESHOLD
"""Sum at which the report of a change ends. This hysteresis avoids repeated reports of one change."""

LARGEST_SUM: Final = 2.0 * THRESHOLD
"""Upper limit of a sum, so that a report ends soon after the coefficient has returned to its old value."""

LEARNED: Final = 10  # smallest number of impacts from which the scatter of a coefficient is estimated

UNKNOWN_SCATTER: Final = 2.0
"""Factor on the standard deviations along both coefficients before that. On the published cube tosses it is
1.7 along restitution and 2.1 along friction."""

_MEDIAN_CHANGES: Final = {True: 0.8542, False: 0.6745}
"""Median of |x - y| / sqrt(2) for two variables: Student's t with `FREEDOM`, and standard normal."""

LARGEST_RATIO: Final = 2.0
"""Upper limit of one impact's log-likelihood ratio, so that a detection needs at least three impacts. A
single outlier may be two strikes that were detected as one."""

REMEMBERED: Final = 200  # number of stored impacts, with which an estimate can restart


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SurfaceReport(Record):
    """Estimates of a surface's coefficients, and detected changes, after an impact."""

    impact: ImpactEvidence  # the latest impact, widened by ``scatter``
    # (2,), >= 1, factor on the standard deviations along restitution and friction, for the scatter of the
    # coefficients from impact to impact
    scatter: FloatArray
    impacts: int  # number of impacts since the start of the estimate
    values: FloatArray  # (2,), estimated restitution and friction, NaN if unknown
    stds: FloatArray  # (2,), their standard deviations
    # (2,), largest sum of log-likelihood ratios for a changed restitution and a changed friction
    sums: FloatArray
    # Coefficient whose change explains the impacts best, or None if no change is detected
    changed: Parameter | None
    is_new: bool  # True at the impact at which the change is first detected


class SurfaceChanges:
    """Detects changes of one surface's coefficients, and estimates them."""

    def __init__(self) -> None:
        """Start without impacts."""
        self._impacts: list[ImpactEvidence] = []
        self._alone: list[FloatArray] = []
        self._sums: list[FloatArray] = []  # limited ratios, for detection
        self._whole: list[FloatArray] = []  # unlimited ratios, which select the value
        self._lengths: list[FloatArray] = []
        self._estimate: _Estimate | None = None
        self._changed: Parameter | None = None

    def add(self, impact: ImpactEvidence) -> SurfaceReport:
        """Add an impact, and return the estimates and detected changes."""
        scatter = self._scatter(is_heavy=math.isfinite(impact.freedom))
        self._alone = [*self._alone[1 - REMEMBERED :], impact.each_alone()]
        impact = impact.widened(scatter)
        if self._impacts and not np.array_equal(impact.configured, self._impacts[-1].configured):
            self._sums, self._changed = [], None  # the reference values have changed
        self._impacts = [*self._impacts[1 - REMEMBERED :], impact]
        self._add_ratios(impact)
        largest = np.array([sums.max(initial=0.0) for sums in self._sums])
        limit = THRESHOLD if self._changed is None else ENDS
        likely = [
            np.where(sums > limit, whole, -math.inf)
            for sums, whole in zip(self._sums, self._whole, strict=True)
        ]
        before, k = self._changed, int(np.argmax([each.max(initial=-math.inf) for each in likely]))
        self._changed = tuple(Parameter)[k] if largest.max() > limit else None
        if before is not None and self._changed is None:  # the unlimited sums would stay large
            self._whole = [np.zeros_like(sums) for sums in self._whole]
        is_new = self._changed is not None and before is None
        if is_new:
            best = int(likely[k].argmax())
            since = int(self._lengths[k][best])
            self._estimate = _Estimate(alternatives(impact.configured, k)[best])
            for each in self._impacts[-since:]:
                self._estimate.add(each)
        else:
            self._estimate = self._estimate or _Estimate(impact.configured)
            self._estimate.add(impact)
        return SurfaceReport(
            impact=impact,
            scatter=scatter,
            impacts=self._estimate.impacts,
            values=self._estimate.values,
            stds=self._estimate.stds,
            sums=largest,
            changed=self._changed,
            is_new=is_new,
        )

    def _scatter(self, *, is_heavy: bool) -> FloatArray:
        """Return the factor, (2,), by which coefficients of single impacts scatter more than expected.

        It is estimated from differences of successive impacts, because a change of a coefficient affects only
        one of them, and a wrong configured one affects none.
        """
        factors = np.full(2, UNKNOWN_SCATTER)
        for k, rows in enumerate(np.array(self._alone).reshape(-1, 2, 2).transpose(2, 0, 1)):
            values, stds = rows[~np.isnan(rows[:, 0])].T
            if len(values) >= LEARNED:
                ratios = np.abs(np.diff(values)) / np.hypot(stds[1:], stds[:-1])
                factors[k] = max(1.0, float(np.median(ratios)) / _MEDIAN_CHANGES[is_heavy])
        return factors

    def _add_ratios(self, impact: ImpactEvidence) -> None:
        others = [alternatives(impact.configured, k) for k in range(len(Parameter))]
        if [len(values) for values in others] != [len(sums) for sums in self._sums]:
            self._sums = [np.zeros(len(values)) for values in others]
            self._whole = [np.zeros(len(values)) for values in others]
            self._lengths = [np.zeros(len(values), dtype=int) for values in others]
        found = impact.log_likelihoods(np.vstack([impact.configured[None], *others]))
        for k, ratio in enumerate(np.split(found[1:] - found[0], [len(others[0])])):
            limited = self._sums[k] + np.minimum(ratio, LARGEST_RATIO)
            self._sums[k] = np.clip(limited, 0.0, LARGEST_SUM)
            self._whole[k] = np.maximum(self._whole[k] + ratio, 0.0)
            self._lengths[k] = np.where(self._sums[k] > 0.0, self._lengths[k] + 1, 0)


class _Estimate:
    """Recursive estimate of restitution and friction, with its information matrix."""

    def __init__(self, at: FloatArray) -> None:
        """Start at coefficients, (2,), without information. Outliers are weighted relative to them."""
        self.impacts = 0
        self._at = at
        self._information = np.zeros((2, 2))

    def add(self, impact: ImpactEvidence) -> None:
        """Update the estimate with an impact, by one Gauss-Newton step."""
        self.impacts += 1
        slopes, difference = impact.slopes(self._at), impact.differences(self._at[None])[0]
        own, gradient = slopes.T @ impact.inverse @ slopes, slopes.T @ impact.inverse @ difference
        weight = impact.weight(self._at)
        self._information = self._information + weight * own
        at, known = self._at.copy(), is_known(self._information)
        at[known] += weight * inverse_of_known(self._information)[known][:, known] @ gradient[known]
        self._at = np.clip(at, 0.0, [1.0, math.inf])

    @property
    def values(self) -> FloatArray:
        """(2,), NaN for an unknown coefficient."""
        return np.where(is_known(self._information), self._at, math.nan)

    @property
    def stds(self) -> FloatArray:
        """(2,), NaN for an unknown coefficient."""
        stds: FloatArray = np.sqrt(np.diag(inverse_of_known(self._information)))
        return stds
