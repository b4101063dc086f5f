# SPDX-License-Identifier: Apache-2.0
"""Impacts with known coefficients: how often a change is reported without one, and how soon with one."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from contact_dynamics.monitoring.changes import SurfaceChanges
from contact_dynamics.monitoring.evidence import REGIONS, ImpactEvidence, Parameter
from monitoring.made_impacts import CONFIGURED, made_impact

BEFORE = 30
"""Impacts before a change, from which the scatter is known."""


def test_without_a_change_regions_are_right_and_fewer_than_one_report_in_100_impacts_begins() -> None:
    random, surface = np.random.default_rng(1), SurfaceChanges()
    reports = [surface.add(made_impact(random, *CONFIGURED)) for _ in range(600)]
    assert sum(report.is_new for report in reports) <= 6
    probabilities = np.array([report.impact.probability() for report in reports])
    for region in REGIONS:
        share = float(np.mean(probabilities >= 1.0 - region))
        # Three binomial standard errors, and 1 % since the scatter is itself estimated.
        assert abs(share - region) < 3.0 * math.sqrt(region * (1.0 - region) / 600) + 0.01
    # Without a report the estimate has all impacts, and its standard deviations are right.
    last = reports[-1]
    assert (np.abs(last.values - CONFIGURED) < 4.0 * last.stds).all()
    assert (last.stds < 0.05 * CONFIGURED).all()


@pytest.mark.parametrize("parameter", list(Parameter))
@pytest.mark.parametrize(("factor", "within"), [(0.6, 12), (1.4, 16), (0.8, 20), (1.2, 20)])
def test_a_change_is_reported_named_and_estimated_within_a_number_of_impacts(
    parameter: Parameter, factor: float, within: int
) -> None:
    """40 % within 12 to 16 impacts and 20 % within 20, in at least nine of ten runs.

    Friction changes what a contact does that then sticks, which restitution sometimes explains as well. Of 30
    runs with 20 impacts after the change, at least 29 named the right coefficient.
    """
    k, in_time, named, nearer = list(Parameter).index(parameter), 0, 0, 0
    changed = CONFIGURED.copy()
    changed[k] *= factor
    for seed in range(10):
        random, surface = np.random.default_rng(seed), SurfaceChanges()
        for _ in range(BEFORE):
            surface.add(made_impact(random, *CONFIGURED))
        reports = [surface.add(made_impact(random, *changed)) for _ in range(within)]
        in_time += any(report.changed is not None for report in reports)
        named += reports[-1].changed is parameter
        value = reports[-1].values[k]
        nearer += abs(value - changed[k]) < abs(value - CONFIGURED[k])
    assert in_time >= 9
    assert named >= 7
    assert nearer >= 7


def test_the_report_of_a_change_ends_after_the_change_is_undone() -> None:
    random, surface = np.random.default_rng(4), SurfaceChanges()
    for _ in range(BEFORE):
        surface.add(made_impact(random, *CONFIGURED))
    changed = [surface.add(made_impact(random, 0.4, 0.18)) for _ in range(20)]
    assert changed[-1].changed is Parameter.FRICTION
    undone = [surface.add(made_impact(random, *CONFIGURED)) for _ in range(40)]
    assert undone[-1].changed is None


def test_one_impact_alone_makes_no_change() -> None:
    """It may be two strikes taken for one."""
    random, surface = np.random.default_rng(7), SurfaceChanges()
    for _ in range(BEFORE):
        surface.add(made_impact(random, *CONFIGURED))
    assert surface.add(made_impact(random, 1.0, 0.05)).changed is None


def test_the_friction_of_a_contact_that_sticks_is_unknown() -> None:
    random = np.random.default_rng(3)
    impact = made_impact(random, *CONFIGURED)
    sticks = np.array([0.4, 5.0])
    values, stds = replace(impact, configured=sticks).estimates()
    assert np.isfinite([values[0], stds[0]]).all()
    assert np.isnan([values[1], stds[1]]).all()


def precise_impact(random: np.random.Generator, restitution: float, friction: float) -> ImpactEvidence:
    """An impact without model error, whose normal errors are 10 to 100 times smaller from case to case."""
    one = made_impact(random, restitution, friction)
    exact = -replace(one, measured=np.zeros(6)).differences(np.array([[restitution, friction]]))[0]
    scale = 10.0 ** random.uniform(-2.0, -1.0)
    off = scale * np.linalg.cholesky(np.linalg.inv(one.inverse)) @ random.standard_normal(6)
    return replace(one, measured=exact + off, inverse=one.inverse / scale**2, freedom=math.inf)


def test_precise_impacts_far_from_the_configured_restitution_are_not_hidden_by_their_scatter() -> None:
    """Each is far outside of its region, and another restitution explains it, from the first to the last."""
    random, surface = np.random.default_rng(5), SurfaceChanges()
    reports = [surface.add(precise_impact(random, 0.6, CONFIGURED[1])) for _ in range(40)]
    assert all(report.impact.probability() < 1.0 - REGIONS[-1] for report in reports)
    explained = [report.impact.explained_by() for report in reports]
    assert sum(one is Parameter.RESTITUTION for one in explained) >= 38  # of 40, one in 100 by chance
    assert reports[-1].changed is Parameter.RESTITUTION
    assert reports[-1].scatter[0] < 3.0  # first-order estimates from far away scatter a little more
    assert abs(reports[-1].values[0] - 0.6) < 4.0 * reports[-1].stds[0]


def test_an_outlier_among_precise_impacts_hardly_moves_the_estimate() -> None:
    random, surface = np.random.default_rng(6), SurfaceChanges()
    for _ in range(20):
        surface.add(precise_impact(random, *CONFIGURED))
    before = surface.add(precise_impact(random, *CONFIGURED))
    after = surface.add(precise_impact(random, 0.15, CONFIGURED[1]))
    assert abs(after.values[0] - CONFIGURED[0]) < 4.0 * after.stds[0]
    assert after.stds[0] < 1.5 * before.stds[0]
