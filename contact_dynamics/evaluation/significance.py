# SPDX-License-Identifier: Apache-2.0
"""Whether one evaluation is better than another on the same events, by more than chance.

Errors of one event under both are paired: what makes an event hard to predict is then in both, and cancels.
Errors have long tails (a corner that strikes or just misses), so the test is Wilcoxon's signed-rank test,
which goes by the order of the differences and needs no normal distribution; a t-test would be ruled by the
tails. It is SciPy's, two-sided. Events of one recording share body, surface, noise and often the throw, and
do not count as independent: where there are at least `FEWEST_RECORDINGS`, their mean differences are what is
tested. With fewer recordings the events are, and the result says so.

The interval of the mean difference is a paired bootstrap: the same units are drawn with replacement, with a
fixed seed. Because many groups are tested at once, the probabilities are adjusted by Holm's method, so that
the chance of even one wrong "significant" stays below the level.

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
"""Least number of recordings that are tested as such: 5 pairs cannot come below a probability of 0.06."""

DRAWS: Final = 2000
"""Draws of the bootstrap: the ends of a 95 % interval are off by some percent of its length."""

_SEED: Final = 1945


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Change(Group):
    """One error of one group under two evaluations.

    Attributes:
        error: Which error, of `ERRORS`, or ``wrong_mode``, which is 1 where the mode is wrong, else 0.
        pairs: Events that both evaluations answered.
        units: What is taken as independent, "recordings" or "events".
        first: Mean size of the error under the first evaluation.
        second: Mean size of the error under the second one.
        low: Lower end of the 95 % interval of the mean difference, second less first.
        high: Upper end of it.
        probability: How probable so large a difference is by chance, adjusted for the number of tests.
    """

    error: str
    pairs: int
    units: str
    first: float
    second: float
    low: float
    high: float
    probability: float


def changes(first: Evaluation, second: Evaluation) -> list[Change]:
    """Return how each error of each group changed from one evaluation to another on the same recordings.

    Recordings are the same if their contents are. Events are the same if they are of one kind and body and
    closer than `SAME_EVENT`. Events that only one evaluation has, or only one answers, are left out.
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
    """Return the group of a comparison without what another configuration may change."""
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
    if not differences.any():  # the same to the bit: there is nothing to order
        return 1.0
    from scipy.stats import wilcoxon

    return float(wilcoxon(differences).pvalue)


def _adjusted(found: Sequence[Change]) -> list[Change]:
    """Return the changes with Holm's probabilities, in their order."""
    order = sorted(range(len(found)), key=lambda i: found[i].probability)
    adjusted = list(found)
    largest = 0.0
    for rank, i in enumerate(order):
        largest = max(largest, min(1.0, (len(found) - rank) * found[i].probability))
        adjusted[i] = replace(found[i], probability=largest)
    return adjusted
