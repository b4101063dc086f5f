# SPDX-License-Identifier: Apache-2.0
"""Tests the significance of the difference between two evaluations of the same events.

The errors of an event in both evaluations are paired, so that the difficulty of the event cancels. Errors
have long tails (a corner that strikes or just misses), which would dominate a t-test. The test is SciPy's
two-sided Wilcoxon signed-rank test, which uses the order of the differences and assumes no normal
distribution. Events of one recording share body, surface, noise and often the throw, and are not
independent. With at least `FEWEST_RECORDINGS` recordings, the mean differences of recordings are tested, and
otherwise those of events; `Change.units` states which.

The interval of the mean difference is from a paired bootstrap with a fixed seed. Because many groups are
tested at once, the probabilities are adjusted by Holm's method, which limits the probability of any false
positive to the significance level.

Sources: F. Wilcoxon, "Individual comparisons by ranking methods", Biometrics Bulletin 1 (1945) 80; S. Holm,
"A simple sequentially rejective multiple test procedure", Scand. J. Statistics 6 (1979) 65.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.evaluation.summary import ERRORS, Group, group_of
from contact_dynamics.tolerances import SAME_EVENT

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from contact_dynamics.evaluation.comparison import Comparison
    from contact_dynamics.evaluation.result import Evaluation
    from contact_dynamics.validation import FloatArray

FEWEST_RECORDINGS: Final = 6
"""Smallest number of recordings that are tested as units: with 5 pairs, the smallest possible p is 0.06."""

DRAWS: Final = 2000
"""Bootstrap samples: the errors of the ends of a 95 % interval are a few percent of its length."""

_SEED: Final = 1945


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Change(Group):
    """One error of one group in two evaluations."""

    error: str  # name of the error, from `ERRORS`, or ``wrong_mode``, which is 1 for a wrong mode, else 0
    pairs: int  # number of events that both evaluations predicted
    units: str  # independent units of the test, "recordings" or "events"
    first: float  # mean absolute error in the first evaluation
    second: float  # mean absolute error in the second evaluation
    low: float  # lower end of the 95 % interval of the mean difference, second minus first
    high: float  # upper end of this interval
    probability: float  # p-value of the difference, adjusted for the number of tests


def changes(first: Evaluation, second: Evaluation) -> list[Change]:
    """Return the change of each error of each group between two evaluations of the same recordings.

    Recordings are matched by the hash of their content. Events match if they have the same kind and body and
    are closer in time than `SAME_EVENT`. Events that only one evaluation found or predicted are left out.
    """
    found: dict[tuple[Group, str], dict[str, list[tuple[float, float]]]] = defaultdict(
        lambda: defaultdict(list)
    )
    for recording, one, other in _pairs(first, second):
        for error in ERRORS:
            before, after = getattr(one, error), getattr(other, error)
            if before is not None and after is not None:
                found[group_of(one), error][recording].append((abs(before), abs(after)))
        if one.mode_is_right is not None and other.mode_is_right is not None:
            wrong = (float(not one.mode_is_right), float(not other.mode_is_right))
            found[group_of(one), "wrong_mode"][recording].append(wrong)
    return _adjusted([_change(group, error, pairs) for (group, error), pairs in found.items()])


def _pairs(first: Evaluation, second: Evaluation) -> Iterator[tuple[str, Comparison, Comparison]]:
    others = {result.digest: result for result in second.results if result.digest}
    for result in first.results:
        other = others.get(result.digest)
        if other is None:
            continue
        candidates: dict[Group, list[Comparison]] = defaultdict(list)
        for row in other.comparisons:
            candidates[_what(row)].append(row)
        for row in result.comparisons:
            near = [each for each in candidates[_what(row)] if abs(each.time - row.time) <= SAME_EVENT]
            if near:
                yield result.digest, row, min(near, key=lambda each: abs(each.time - row.time))


def _what(row: Comparison) -> Group:
    """Return the group of a comparison without the fields that depend on the configuration."""
    return replace(group_of(row), surface="", several=False)


def _change(group: Group, error: str, pairs: dict[str, list[tuple[float, float]]]) -> Change:
    events = np.array([pair for each in pairs.values() for pair in each])
    if len(pairs) >= FEWEST_RECORDINGS:
        units, tested = "recordings", np.array([np.mean(each, axis=0) for each in pairs.values()])
    else:
        units, tested = "events", events
    differences = tested[:, 1] - tested[:, 0]
    low, high = _interval(differences)
    return Change(
        **Group.shared(group),
        error=error,
        pairs=len(events),
        units=units,
        first=float(tested[:, 0].mean()),
        second=float(tested[:, 1].mean()),
        low=low,
        high=high,
        probability=_probability(differences),
    )


def _interval(differences: FloatArray) -> tuple[float, float]:
    random = np.random.default_rng(_SEED)
    drawn = random.integers(len(differences), size=(DRAWS, len(differences)))
    low, high = np.quantile(differences[drawn].mean(axis=1), [0.025, 0.975])
    return float(low), float(high)


def _probability(differences: FloatArray) -> float:
    if not differences.any():  # Wilcoxon's test needs a difference
        return 1.0
    from scipy.stats import wilcoxon

    return float(wilcoxon(differences).pvalue)


def _adjusted(found: Sequence[Change]) -> list[Change]:
    """Return the changes in their order, with probabilities adjusted by Holm's method."""
    order = sorted(range(len(found)), key=lambda i: found[i].probability)
    adjusted = list(found)
    largest = 0.0
    for rank, i in enumerate(order):
        largest = max(largest, min(1.0, (len(found) - rank) * found[i].probability))
        adjusted[i] = replace(found[i], probability=largest)
    return adjusted
