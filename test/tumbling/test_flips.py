# SPDX-License-Identifier: Apache-2.0
"""Flips near the middle axis: when they come, and how surely."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from contact_dynamics.tumbling import FreeMotion, free_motion
from contact_dynamics.tumbling.flips import next_flips
from contact_dynamics.tumbling.poinsot_construction import poinsot
from tumbling.known_motions import MOTIONS, motion_of

FLIPPING = ("near the middle axis", "nearer to it")


def middle_rate(motion: FreeMotion, seconds: float) -> float:
    state = motion.state_at(seconds)
    return float(poinsot(motion).principal_axes_B[:, 1] @ state.R_WB.T @ state.w_WB_W)


@pytest.mark.parametrize("name", FLIPPING)
def test_the_spin_about_the_middle_axis_changes_sign_at_each(name: str) -> None:
    motion = motion_of(name)
    flips = next_flips(motion, 5)
    assert len(flips.seconds) == 5
    assert np.isnan(flips.deviations).all()
    assert flips.seconds[0] >= 0.0
    period = poinsot(motion).polhode_period
    assert np.diff(flips.seconds) == pytest.approx(period / 2.0, rel=1e-12)
    for t in flips.seconds:
        assert abs(middle_rate(motion, t)) < 1e-12
        assert middle_rate(motion, t - 1.0) * middle_rate(motion, t + 1.0) < -0.1
    between = np.linspace(0.0, flips.seconds[0] - 1e-3, 200)
    assert len({middle_rate(motion, float(t)) > 0.0 for t in between}) == 1


@pytest.mark.parametrize("name", sorted(set(MOTIONS) - {*FLIPPING, "separatrix", "its other branch"}))
def test_other_spins_have_none(name: str) -> None:
    assert len(next_flips(motion_of(name), 3).seconds) == 0


@pytest.mark.parametrize("name", ["separatrix", "its other branch"])
def test_the_separatrix_has_one_or_none_left(name: str) -> None:
    motion = motion_of(name)
    rising = middle_rate(motion, 1.0) > middle_rate(motion, 0.0)
    flips = next_flips(motion, 3)
    assert len(flips.seconds) == (1 if middle_rate(motion, 0.0) * (1.0 if rising else -1.0) < 0.0 else 0)
    for t in flips.seconds:
        assert abs(middle_rate(motion, t)) < 1e-14


def noisy_covariance(w_deviation: float, angle_deviation: float) -> np.ndarray:
    return np.diag([1e-6] * 3 + [angle_deviation**2] * 3 + [1e-4] * 3 + [w_deviation**2] * 3)


@pytest.mark.parametrize("name", FLIPPING)
@pytest.mark.parametrize(
    ("w_deviation", "angle_deviation"),
    [
        *(pytest.param(*one, marks=pytest.mark.slow) for one in [(1e-5, 0.0), (0.0, 1e-5)]),
        (3e-4, 1e-4),
        pytest.param(3e-3, 0.0, marks=pytest.mark.slow),
    ],
)
def test_deviations_are_those_of_noisy_states(name: str, w_deviation: float, angle_deviation: float) -> None:
    motion = motion_of(name)
    flips = next_flips(motion, 2, covariance=noisy_covariance(w_deviation, angle_deviation))
    rng = np.random.default_rng(3)
    samples = []
    for _ in range(1600):
        state = motion.state
        turn = rng.normal(scale=angle_deviation, size=3)
        w_B_change = np.cross(state.w_WB_W, turn)  # seen from the body
        rate = state.w_WB_W + rng.normal(scale=w_deviation, size=3) + w_B_change
        other = replace(state, w_WB_W=rate)
        samples.append(next_flips(free_motion(motion.body, other), 2).seconds)
    # The deviation of a logarithm, with its long tail: these samples know it to some 5 %, the 1000 of the
    # answer to 6 %; three times both together.
    assert flips.deviations == pytest.approx(np.std(samples, axis=0), rel=0.25)


def test_no_noise_no_deviation() -> None:
    flips = next_flips(motion_of(FLIPPING[0]), 2, covariance=np.zeros((12, 12)))
    assert flips.deviations == pytest.approx(0.0, abs=1e-9)
    assert not any(map(math.isnan, flips.deviations))
