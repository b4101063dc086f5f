# SPDX-License-Identifier: Apache-2.0
"""Least squares over clusters: linear problems whose answers are known, and how often regions hold them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from scipy.stats import f

from contact_dynamics.numerics.clustered_fit import HUBER, ClusteredFit, Group, fit_clustered


def line(
    values: np.ndarray, places: np.ndarray, clusters: np.ndarray
) -> Callable[[np.ndarray], Sequence[Group]]:
    """Residuals of a line with unit noise."""
    design = np.column_stack([np.ones_like(places), places])

    def at(x: np.ndarray) -> list[Group]:
        return [
            Group(residuals=(design @ x - values)[:, None], derivatives=design[:, None, :], clusters=clusters)
        ]

    return at


def fitted(values: np.ndarray, places: np.ndarray, clusters: np.ndarray, **how: float) -> ClusteredFit:
    return fit_clustered(
        np.zeros(2),
        groups_at=line(values, places, clusters),
        lower=np.array([-np.inf, how.get("lower", -np.inf)]),
        upper=np.full(2, np.inf),
        clusters=int(clusters.max()) + 1,
    )


PLACES = np.tile(np.linspace(-1.0, 1.0, 5), 40)
CLUSTERS = np.repeat(np.arange(40), 5)


def test_a_line_is_found_with_the_covariance_of_its_noise() -> None:
    random = np.random.default_rng(0)
    found = fitted(3.0 - 2.0 * PLACES + random.standard_normal(200), PLACES, CLUSTERS)
    expected = 1.0 / np.array([200.0, np.square(PLACES).sum()])
    assert np.abs(found.parameters - [3.0, -2.0]).max() < 5.0 * np.sqrt(expected.max())
    assert found.covariance.diagonal() == pytest.approx(expected, rel=0.5)
    assert found.converged
    assert found.by_cluster


def test_errors_that_clusters_share_make_the_covariance_as_large_as_it_is() -> None:
    """The naive variance of the height is 1 / 200, but 40 clusters with errors of 0.9 leave 0.81 / 40."""
    random = np.random.default_rng(1)
    shared = 0.9 * random.standard_normal(40)[CLUSTERS]
    found = fitted(3.0 + shared + 0.01 * random.standard_normal(200), PLACES, CLUSTERS)
    assert found.covariance[0, 0] == pytest.approx(0.81 / 40.0, rel=0.4)


def test_long_tails_have_the_covariance_of_hubers_estimate() -> None:
    """Huber's formula for a height: the mean square of the score by the squared mean of its slope.

    Against it, the variance with the weights for slopes would be 40 % too small.
    """
    values = 2.0 * np.random.default_rng(4).laplace(size=400)
    found = fit_clustered(
        np.zeros(1),
        groups_at=lambda x: [
            Group(
                residuals=(x[0] - values)[:, None], derivatives=np.ones((400, 1, 1)), clusters=np.arange(400)
            )
        ],
        lower=np.array([-np.inf]),
        upper=np.array([np.inf]),
        clusters=400,
        rejected=np.inf,
    )
    off = found.parameters[0] - values
    expected = np.square(np.clip(off, -HUBER, HUBER)).sum() / np.square((np.abs(off) < HUBER).sum())
    # a jackknife of 400 differs from the formula by some 1 / 400
    assert found.covariance[0, 0] == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize(
    ("noise", "shared"), [(1.0, 0.0), (2.0, 0.0), (0.7, 0.7)], ids=["as assumed", "twice", "half is shared"]
)
def test_90_percent_regions_hold_the_truth_in_85_to_95_percent(noise: float, shared: float) -> None:
    """Six parameters from forty clusters, whose errors are as assumed, larger, or those of the whole cluster.

    With the covariance of the model, it would be 10 to 20 % where the errors are twice what is assumed.
    """
    sets, clusters, count = 150, 40, 6
    random = np.random.default_rng(5)
    limit = count * f.ppf(0.9, count, clusters - 1)
    held = 0
    for _ in range(sets):
        sizes = 3.0 * np.exp(0.5 * random.standard_normal((clusters, 1, 1)))
        design = sizes * random.standard_normal((clusters, 6, count))
        errors = noise * random.standard_normal((clusters, 6)) + shared * random.standard_normal(
            (clusters, 1)
        )

        def at(x: np.ndarray, design: np.ndarray = design, errors: np.ndarray = errors) -> list[Group]:
            return [Group(residuals=design @ x - errors, derivatives=design, clusters=np.arange(clusters))]

        found = fit_clustered(
            np.zeros(count),
            groups_at=at,
            lower=np.full(count, -np.inf),
            upper=np.full(count, np.inf),
            clusters=clusters,
        )
        held += found.parameters @ np.linalg.solve(found.covariance, found.parameters) <= limit
    assert 0.85 <= held / sets <= 0.95


@pytest.mark.parametrize(("apart", "directions"), [(0.02, 1), (0.5, 0)])
def test_parameters_that_replace_each_other_are_undetermined(apart: float, directions: int) -> None:
    """A height, and one that differs from it by a share: each has 1 / apart times the error of their sum."""
    values = 3.0 + np.random.default_rng(7).standard_normal(200)
    design = np.column_stack([np.ones(200), 1.0 + apart * PLACES])
    scale = 1e3  # so much data that each direction is known far better than what is plausible
    found = fit_clustered(
        np.zeros(2),
        groups_at=lambda x: [
            Group(
                residuals=(design @ x * scale - values)[:, None],
                derivatives=scale * design[:, None, :],
                clusters=CLUSTERS,
            )
        ],
        lower=np.full(2, -np.inf),
        upper=np.full(2, np.inf),
        clusters=40,
    )
    assert len(found.undetermined) == directions
    assert scale * found.parameters.sum() == pytest.approx(3.0, abs=0.3)
    if directions:
        assert np.abs(found.undetermined[0]) == pytest.approx(np.sqrt([0.5, 0.5]), abs=1e-3)
        assert found.parameters[0] == pytest.approx(found.parameters[1], rel=0.05)


def test_degrees_of_freedom_are_those_of_the_clusters_that_say_something() -> None:
    """The slope is told by four of eight clusters alike, the height by all of them, or by one above all."""
    clusters = np.repeat(np.arange(8), 2)
    places = np.where(clusters < 4, np.tile([-1.0, 1.0], 8), 0.0)
    values = np.random.default_rng(5).standard_normal(16)
    height, slope = fitted(values, places, clusters).degrees
    assert height == pytest.approx(7.0)
    assert slope == pytest.approx(3.0)
    many = np.where(np.arange(1000) < 7, np.arange(1000), 7)
    assert fitted(np.zeros(1000), np.linspace(-1.0, 1.0, 1000), many).degrees[0] == 1.0


def test_outliers_count_for_nothing() -> None:
    random = np.random.default_rng(2)
    values = 3.0 - 2.0 * PLACES + random.standard_normal(200)
    spoiled = values.copy()
    spoiled[:10] += 50.0
    found = fitted(spoiled, PLACES, CLUSTERS)
    assert (found.sizes[0] > 5.0).sum() == 10
    assert np.abs(found.parameters - fitted(values[10:], PLACES[10:], CLUSTERS[10:]).parameters).max() < 0.02


def test_a_direction_without_data_is_undetermined_and_not_moved() -> None:
    random = np.random.default_rng(3)
    found = fitted(3.0 + random.standard_normal(200), np.zeros(200), CLUSTERS)
    assert np.abs(found.undetermined) == pytest.approx(np.array([[0.0, 1.0]]))
    assert found.parameters[1] == 0.0
    assert found.covariance[1, 1] == 0.0


def test_two_parameters_that_only_their_sum_is_known_of_make_one_direction() -> None:
    found = fitted(3.0 * np.ones(200), np.ones(200), CLUSTERS)
    assert np.abs(found.undetermined @ [1.0, -1.0]) == pytest.approx([np.sqrt(2.0)])
    assert found.parameters == pytest.approx([1.5, 1.5])


def test_a_parameter_stays_within_its_bound_and_is_said_to_lie_there() -> None:
    found = fitted(3.0 - 2.0 * PLACES, PLACES, CLUSTERS, lower=-1.0)
    assert found.parameters == pytest.approx([3.0, -1.0], abs=1e-6)
    assert found.at_bound.tolist() == [False, True]


def test_few_clusters_give_the_covariance_of_the_model() -> None:
    found = fitted(3.0 - 2.0 * PLACES[:15], PLACES[:15], CLUSTERS[:15])
    assert not found.by_cluster
    assert found.covariance[0, 0] == pytest.approx(1.0 / 15.0)
