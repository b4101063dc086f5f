# SPDX-License-Identifier: Apache-2.0
"""The second way: its residuals do not hang on rounding, and are those of the first way's data."""

from __future__ import annotations

import numpy as np
import pytest

from calibration.made_tosses import Truth, made_tosses
from contact_dynamics.calibration.calibrate import _data
from contact_dynamics.calibration.estimation import Fitting, Spread
from contact_dynamics.calibration.free import GEOMETRY, STANDARD
from contact_dynamics.calibration.model import Model
from contact_dynamics.calibration.observed import observe
from contact_dynamics.calibration.paths import BETWEEN, Paths

TRUTH = Truth(law_velocity=0.01, law_spin=0.1)
SHARP = [each for each in STANDARD if each not in GEOMETRY]
SPREAD = Spread(velocity=0.01, spin=0.1)


@pytest.fixture(scope="module")
def strikes() -> tuple[Fitting, Paths]:
    motions = made_tosses(TRUTH, 5, 1001)
    model = Model(motions[0].body, motions[0].surfaces)
    observed = [each for number, motion in enumerate(motions) for each in observe(str(number), motion)]
    fitting = Fitting(model, _data(model, observed, SHARP), SHARP)
    return fitting, Paths(fitting, observed)


def at_truth(fitting: Fitting) -> np.ndarray:
    values = np.array([*TRUTH.center, np.log(TRUTH.inertia), TRUTH.friction, TRUTH.restitution])
    truth: np.ndarray = values / fitting.steps
    return truth


def squares(strikes: tuple[Fitting, Paths]) -> np.ndarray:
    """The squared distance of each strike at the truth."""
    fitting, paths = strikes
    (name, group), *rest = paths.groups_at(at_truth(fitting), SPREAD)
    assert name == "trajectories through impacts"
    assert not rest
    found: np.ndarray = np.square(group.residuals).sum(axis=1)
    return found


def test_the_same_parameters_have_the_same_residuals_each_time(strikes: tuple[Fitting, Paths]) -> None:
    """A strike's unknowns move by their rounding each time. That must not turn up as a residual."""
    for _ in range(2):  # until the unknowns have arrived
        squares(strikes)
    once, again = squares(strikes), squares(strikes)
    assert again == pytest.approx(once, rel=1e-5)


def test_at_the_truth_they_are_as_large_as_their_number_says(strikes: tuple[Fitting, Paths]) -> None:
    # chi squared with 11 for each of 5 strikes lies between 27 and 94 in 99.9 %
    assert 27.0 < squares(strikes).sum() < 94.0
    assert len(squares(strikes)) * BETWEEN == 55
