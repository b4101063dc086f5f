# SPDX-License-Identifier: Apache-2.0
"""Distances in deviations, against drawing."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import chi2, f

from contact_dynamics.evaluation.comparison import (
    Comparison,
    arrival_std,
    as_normal,
    in_deviations,
    pose_difference,
)
from contact_dynamics.evaluation.report import report
from contact_dynamics.evaluation.result import Evaluation, SourceResult
from contact_dynamics.evaluation.settings import Method
from contact_dynamics.evaluation.summary import is_inside, summarise
from contact_dynamics.measured.events import EventKind
from contact_dynamics.questions.sample_times import Event
from contact_dynamics.questions.sample_times import EventKind as Ending
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rotations.many import matrices_of, quaternions_of
from evaluation.made_motion import BRICK, world_of

RANDOM = np.random.default_rng(7)


def row(**values: object) -> Comparison:
    return Comparison(
        **{  # type: ignore[arg-type]
            "event": 0,
            "kind": EventKind.FLIGHT,
            "body": "brick",
            "surface": "",
            "time": 0.0,
            "horizon": 0.1,
            "method": Method.FIT,
            **values,
        }
    )


def test_a_distance_with_long_tails_becomes_the_normal_one_of_the_same_probability() -> None:
    assert as_normal(2.0, 6, np.inf) == 2.0
    for distance in (0.5, 2.0, 10.0):
        probability = f.sf(distance**2 / 6, 6, 3)
        assert chi2.sf(as_normal(distance, 6, 3.0) ** 2, 6) == pytest.approx(probability, rel=1e-9)


def test_the_time_of_arrival_spreads_as_drawn_poses_arrive() -> None:
    """A corner at a lever of decimetres falls onto the floor; its pose is uncertain in six ways at once."""
    root = RANDOM.standard_normal((6, 6)) * np.repeat([3e-4, 2e-3], 3)[:, None]
    covariance = root @ root.T
    state = BodyState(p_WB_W=[0.1, 0.2, 0.09], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, -1.5])
    corner = np.array([0.25, 0.28, 0.0])
    event = Event(
        kind=Ending.CONTACT,
        seconds=0.1,
        point_W=corner,
        velocity_W=np.array([0.3, 0.0, -1.5]),
        surface="floor",
    )
    stated = arrival_std(event, state, covariance, world_of(BRICK))
    drawn = RANDOM.multivariate_normal(np.zeros(6), covariance, size=20_000)
    lever = corner - state.p_WB_W
    heights = drawn[:, 2] + (matrices_of(quaternions_of(drawn[:, 3:])) @ lever - lever)[:, 2]
    assert stated == pytest.approx(np.std(heights) / 1.5, rel=0.03)  # 4 deviations of a spread of 20000


def test_a_measurement_without_prediction_noise_counts_its_own_deviations() -> None:
    stds = np.array([1e-3, 2e-3, 3e-3])
    assert in_deviations(2.0 * stds, np.zeros((3, 3)), stds) == pytest.approx(2.0 * np.sqrt(3.0))
    assert in_deviations(stds, np.full((3, 3), np.nan), stds) is None


def test_differences_of_drawn_states_are_inside_as_often_as_stated() -> None:
    root = RANDOM.standard_normal((6, 6))
    covariance, stds = root @ root.T, RANDOM.uniform(0.5, 2.0, 6)
    drawn = RANDOM.multivariate_normal(np.zeros(6), covariance + np.diag(stds**2), size=2000)
    rows = [row(distance=in_deviations(each, covariance, stds), degrees=6) for each in drawn]
    (summary,) = summarise(rows)
    assert summary.covariances == 2000
    assert summary.covered == pytest.approx([0.5, 0.9, 0.95], abs=0.045)  # 4 deviations of a share of 2000


@pytest.mark.parametrize(
    ("degrees", "level", "edge"), [(1, 0.95, 3.8415), (6, 0.9, 10.6446), (6, 0.5, 5.3481)]
)
def test_the_edge_of_a_region_is_that_of_the_tables(degrees: int, level: float, edge: float) -> None:
    assert is_inside(row(distance=np.sqrt(0.999 * edge), degrees=degrees), level) is True
    assert is_inside(row(distance=np.sqrt(1.001 * edge), degrees=degrees), level) is False
    assert is_inside(row(), level) is None


def test_the_difference_of_attitudes_turns_the_predicted_into_the_measured() -> None:
    turn = np.array([0.1, -0.2, 0.3])
    still = {"v_WB_W": [0, 0, 0], "w_WB_W": [0, 0, 0]}
    predicted = BodyState(p_WB_W=[1, 2, 3], q_WB=[0, 0, 0, 1], **still)
    measured = BodyState(p_WB_W=[1, 2, 4], q_WB=quaternions_of(turn[None])[0], **still)
    assert pose_difference(predicted, measured) == pytest.approx([0, 0, 1, *turn])


def test_a_summary_counts_what_was_refused_and_keeps_the_sign_of_a_bias() -> None:
    rows = [row(kind=EventKind.LANDING, time_error=error) for error in (-3e-3, -2e-3, -1e-3, 4e-3)]
    (summary,) = summarise([*rows, row(kind=EventKind.LANDING, refused="NoContactError: none")])
    assert (summary.asked, summary.refused) == (5, 1)
    spread = summary.errors["time_error"]
    assert (spread.bias, spread.median, spread.count) == pytest.approx((-1.5e-3, 2.5e-3, 4))
    assert summary.modes_right is None
    assert summary.covered == ()


def test_requests_before_the_impact_is_over_are_neither_correct_nor_incorrect_modes() -> None:
    """Of five slides one is predicted as such, one as a rest, and three as an impact still to come."""
    answers = [("ccff", True), ("ffff", False), *[("IMPACT", False)] * 3]
    rows = [
        row(kind=EventKind.SLIDING, method=Method.NEWEST, predicted_mode=mode, mode_is_right=right)
        for mode, right in answers
    ]
    (summary,) = summarise(rows)
    assert (summary.asked, summary.impacts, summary.modes_right) == (5, 3, 0.5)
    result = SourceResult(source="log", digest="", states=9, seconds=1.0, comparisons=tuple(rows))
    text = report(Evaluation(versions={}, configuration="as recorded", results=(result,)))
    assert "3 of 5 requests 100 ms in advance returned an impact" in text
