# SPDX-License-Identifier: Apache-2.0
"""Two evaluations of the same events: equal ones, one that is better, and chance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contact_dynamics.evaluation.comparison import Comparison
from contact_dynamics.evaluation.report import report_changes
from contact_dynamics.evaluation.result import Evaluation, SourceResult
from contact_dynamics.evaluation.settings import Method
from contact_dynamics.evaluation.significance import changes
from contact_dynamics.measured.events import EventKind


def evaluation(errors: np.ndarray, *, shift: float = 0.0) -> Evaluation:
    """Recordings in rows, their events in columns, each with its error of place, m."""
    results = tuple(
        SourceResult(
            source=f"log {i}",
            digest=str(i),
            comparisons=tuple(
                Comparison(
                    event=k,
                    kind=EventKind.FLIGHT,
                    body="brick",
                    surface="",
                    time=0.5 * k + shift,
                    horizon=0.1,
                    method=Method.FIT,
                    position_error=float(error),
                )
                for k, error in enumerate(row)
            ),
        )
        for i, row in enumerate(errors)
    )
    return Evaluation(versions={}, configuration="made", results=results)


def test_the_same_evaluation_twice_differs_by_nothing() -> None:
    errors = np.random.default_rng(1).exponential(size=(12, 4))
    (found,) = changes(evaluation(errors), evaluation(errors))
    assert (found.low, found.high, found.probability) == (0.0, 0.0, 1.0)
    assert (found.pairs, found.units) == (48, "recordings")


def test_a_small_gain_on_events_of_all_sizes_is_found() -> None:
    """Errors spread over two decades; each becomes 10 % smaller. Unpaired, nobody could tell."""
    errors = 10.0 ** np.random.default_rng(2).uniform(-3.0, -1.0, size=(20, 3))
    (found,) = changes(evaluation(errors), evaluation(0.9 * errors))
    assert found.probability < 1e-4
    assert found.low < found.second - found.first < found.high < 0.0
    assert found.second == pytest.approx(0.9 * found.first)
    assert "*" in report_changes([found], names=("one", "two"))


def test_chance_is_called_significant_as_often_as_stated() -> None:
    """Events of one recording share their luck; taken as independent, they would be called far too often."""
    random = np.random.default_rng(3)
    wrong = 0
    for _ in range(80):
        luck = random.standard_normal((10, 1))  # what a recording does to one of the two
        errors = 5.0 + random.standard_normal((10, 6))
        (found,) = changes(
            evaluation(errors), evaluation(errors + luck + 0.1 * random.standard_normal((10, 6)))
        )
        wrong += found.probability < 0.05
    assert wrong <= 10  # of 80 at 5 %: 4, and three deviations more


def test_few_recordings_are_compared_by_events_and_it_is_said() -> None:
    errors = np.random.default_rng(4).exponential(size=(2, 10))
    (found,) = changes(evaluation(errors), evaluation(0.8 * errors))
    assert found.units == "events"
    assert "over events" in report_changes([found], names=("one", "two"))


def test_events_are_the_same_within_a_hundredth_of_a_second() -> None:
    errors = np.ones((6, 2))
    assert changes(evaluation(errors), evaluation(errors, shift=0.004))[0].pairs == 12
    assert changes(evaluation(errors), evaluation(errors, shift=0.02)) == []


def test_recordings_are_paired_by_content_and_not_by_name() -> None:
    errors = np.random.default_rng(5).exponential(size=(8, 2))
    second = evaluation(errors)
    renamed = tuple(replace(result, source=f"moved {i}") for i, result in enumerate(reversed(second.results)))
    (found,) = changes(evaluation(errors), replace(second, results=renamed))
    assert found.pairs == 16
    assert found.first == found.second


def test_probabilities_are_adjusted_for_the_number_of_tests() -> None:
    """Holm: the smallest of m is multiplied by m, the next by m - 1, and none falls below the one before."""
    random = np.random.default_rng(6)
    errors = random.exponential(size=(10, 1))
    alone = changes(evaluation(errors), evaluation(0.9 * errors))[0].probability
    first, second = evaluation(errors), evaluation(0.9 * errors)

    def twice(one: Evaluation) -> Evaluation:
        results = tuple(
            replace(
                result,
                comparisons=(*result.comparisons, *(replace(row, horizon=0.2) for row in result.comparisons)),
            )
            for result in one.results
        )
        return replace(one, results=results)

    both = changes(twice(first), twice(second))
    assert [each.probability for each in both] == pytest.approx([2.0 * alone] * 2)
