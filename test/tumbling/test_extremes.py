# SPDX-License-Identifier: Apache-2.0
"""Bodies and times far from the usual: exact as far as doubles mean something, refused by name beyond."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.motion.covariance import covariance_along
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.tumbling import FreeMotion, Regime, free_motion
from contact_dynamics.tumbling.flips import next_flips
from contact_dynamics.tumbling.poinsot_construction import poinsot, rolling_curves
from oracles.tumbling_exact import ExactMotion

TARGET = 5e-15
OBLIQUE = Rotation.from_euler("xyz", [-0.7, 0.4, 1.3])
TURN = Rotation.from_euler("xyz", [0.3, -1.1, 2.0])


def motion_of(I_B: np.ndarray, w: np.ndarray, **place: object) -> FreeMotion:
    state = {"p_WB_W": np.zeros(3), "v_WB_W": np.zeros(3), **place}
    return free_motion(MassProperties(mass=1.0, I_B=I_B), BodyState(q_WB=TURN.as_quat(), w_WB_W=w, **state))


def oblique(moments: tuple[float, ...]) -> np.ndarray:
    R = OBLIQUE.as_matrix()
    I_B = R @ np.diag(moments) @ R.T
    return 0.5 * (I_B + I_B.T)


@pytest.mark.parametrize("inertia_unit", [1e-12, pytest.param(1e12, marks=pytest.mark.slow)])
@pytest.mark.parametrize(("rate", "seconds"), [(1e6, 1e3), (1e6, -1e9), (6.0, 1e9), (1e-6, -1e15)])
@pytest.mark.parametrize(
    "moments", [(1.0, 1.4, 1.9), (0.7, 0.7, 0.7), (1.0, 1.0, 1.6), (0.4, 1.0, 1.0), (1.0, 2.0, 3.0)]
)
def test_any_size_any_spin_any_time(
    moments: tuple[float, ...], rate: float, seconds: float, inertia_unit: float
) -> None:
    """Axes are oblique, so that equal moments are equal to rounding only."""
    I_B = inertia_unit * oblique(moments)
    w = rate * np.array([0.3, -0.5, 0.8])
    motion = motion_of(I_B, w)
    truth = ExactMotion(I_B.tolist(), motion.state.q_WB.tolist(), w.tolist())
    answers = motion.sample(seconds).q_WB, motion.at([seconds] * 20).q_WB[7]
    assert max(truth.errors(seconds, *answers)) <= TARGET


def test_no_number_within_bounds_breaks_anything() -> None:
    """Warnings are errors here, and every answer is finite."""
    units = itertools.product((2e-60, 1e-12, 4e59), (0.0, 5e-324, 1e-300, 1e-59, 1e6, 1e60))
    spins = ((0.3, -0.5, 0.8), (1e-9, 1.0, 1e-9), (0.0, 0.0, 1.0))
    for (inertia, rate), spin in itertools.product(units, spins):
        for moments in ((1.0, 1.4, 1.9), (1.0, 1.0, 1.0), (1.0, 1.0, 2.0), (1e-8, 1.0, 1.0)):
            I_B = np.maximum(inertia * np.diag(moments), 1.1e-60 * np.eye(3))
            motion = motion_of(I_B, rate * np.array(spin))
            for t in (0.0, 1e-300, 1.0, -1e9, 1e60):
                if abs(t) <= motion.farthest:
                    q = motion.state_at(t).q_WB
                    assert abs(math.hypot(*q.tolist()) - 1.0) <= 1e-15
                    assert np.isfinite(motion.at([t] * 20).w_WB_W).all()
            poinsot(motion)
            next_flips(motion, 3, covariance=1e-6 * np.eye(12))
            covariance_along(motion, 1e-6 * np.eye(12), [min(1.0, motion.farthest)])
            if rate > 1e-50:
                rolling_curves(motion, 5)


def test_what_turns_nothing_in_the_age_of_the_universe_is_at_rest() -> None:
    motion = motion_of(np.diag([1.0, 1.4, 1.9]), np.array([0.0, 1e-61, 1e-70]))
    assert motion.regime is Regime.AT_REST
    np.testing.assert_array_equal(motion.state_at(1e17).w_WB_W, 0.0)


def test_times_beyond_the_last_turn_that_doubles_tell_apart_are_refused() -> None:
    motion = motion_of(np.diag([1.0, 1.4, 1.9]), np.array([0.0, 0.0, 10.0]))
    motion.at([9e14])
    for ask in (motion.state_at, lambda t: motion.at([0.0, t])):
        with pytest.raises(InvalidFieldError, match=r"seconds must be .*, got"):
            ask(-1.1e15)
    resting = motion_of(np.diag([1.0, 1.4, 1.9]), np.zeros(3))
    resting.state_at(1e60)
    with pytest.raises(InvalidFieldError, match="seconds"):
        resting.state_at(1e61)
