# SPDX-License-Identifier: Apache-2.0
"""Fits of free motions: exact data, known noise, another minimiser, and windows that say too little."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.motion.free_fit import FitResult, fit_free_motion
from contact_dynamics.motion.state_noise import StateNoise
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.tumbling import FreeMotion, free_motion
from motion.evidence import error, published, turned
from sweeps import seeds
from tumbling.known_motions import MOTIONS, motion_of

WINDOW = 1.3 + np.linspace(0.0, 0.22, 12)
NOISE = StateNoise(position=1e-3, orientation=5e-3)
WITH_RATES = StateNoise(position=1e-3, orientation=5e-3, linear_velocity=0.02, angular_velocity=0.05)


def window(motion: FreeMotion, times: np.ndarray, noise: StateNoise | None, seed: int = 0) -> list[BodyState]:
    """States of a motion as a tracker would see them."""
    rng = np.random.default_rng(seed)
    states = [motion.state_at(t) for t in times]
    return states if noise is None else [published(state, rng, noise) for state in states]


def truth(motion: FreeMotion, stamp_ns: int) -> BodyState:
    return motion.state_at((stamp_ns - motion.state.stamp_ns) * 1e-9)


def fit(motion: FreeMotion, states: list[BodyState], noise: StateNoise | None = None) -> FitResult:
    return fit_free_motion(motion.body, states, gravity_W=motion.gravity_W, noise=noise)


# Exact data


@pytest.mark.parametrize("name", sorted(MOTIONS))
@pytest.mark.parametrize("noise", [None, NOISE, WITH_RATES])
def test_exact_states_are_found(name: str, noise: StateNoise | None) -> None:
    """To rounding: stamps are whole ns, which at these speeds are 1e-9 m and rad, hence the tolerance."""
    motion = motion_of(name)
    states = window(motion, WINDOW, None)
    found = fit(motion, states, noise)
    np.testing.assert_allclose(
        error(found.state, truth(motion, found.state.stamp_ns)), 0.0, rtol=0.0, atol=2e-8
    )
    assert found.converged
    assert found.rounds <= 4
    assert found.count == 12
    assert found.state.stamp_ns == states[-1].stamp_ns
    assert found.position_residual < 5e-9
    assert found.orientation_residual < 5e-9


positive = st.floats(0.3, 3.0)
component = st.floats(-8.0, 8.0)


@given(
    a=positive,
    b=positive,
    share=st.floats(0.05, 0.95),
    w=st.tuples(component, component, component),
    gaps=st.lists(st.integers(1_000_000, 60_000_000), min_size=2, max_size=12),
)
def test_any_body_any_window(a: float, b: float, share: float, w: tuple, gaps: list[int]) -> None:
    moments = np.array([a, b, abs(a - b) + share * (a + b - abs(a - b))])
    motion = free_motion(
        MassProperties(mass=1.0, I_B=np.diag(moments)),
        BodyState(p_WB_W=np.ones(3), q_WB=[0.0, 0.6, 0.0, 0.8], v_WB_W=np.ones(3), w_WB_W=w),
    )
    times = np.concatenate([[0], np.cumsum(gaps)]) * 1e-9
    found = fit(motion, window(motion, times, None))
    # Rounding over the length of the window is that of rates; the reference itself rounds its time to 1e-9 s.
    span = times[-1]
    limits = np.repeat([1e-9, 1e-8, 1e-9 / span, 1e-8 / span], 3)
    wrong = np.abs(error(found.state, truth(motion, found.state.stamp_ns)))
    assert (wrong < limits).all(), wrong / limits


# Noise


@pytest.mark.parametrize(
    ("name", "noise"),
    [
        ("about the major axis", NOISE),
        ("a rod", WITH_RATES),
        pytest.param("about the major axis", WITH_RATES, marks=pytest.mark.slow),
        pytest.param("a rod", NOISE, marks=pytest.mark.slow),
        *(
            pytest.param(name, noise, marks=pytest.mark.slow)
            for name in ("near the middle axis", "at rest")
            for noise in (NOISE, WITH_RATES)
        ),
    ],
)
def test_errors_are_as_large_as_the_covariance_says(name: str, noise: StateNoise) -> None:
    """Squared errors beside the covariance are chi squared of 12 degrees: mean 12, variance 24."""
    motion, trials = motion_of(name), 50
    squares, places, turns = [], [], []
    for seed in range(trials):
        found = fit(motion, window(motion, WINDOW, noise, seed), noise)
        wrong = error(found.state, truth(motion, found.state.stamp_ns))
        squares.append(wrong @ np.linalg.solve(found.covariance, wrong))
        places.append(found.position_residual**2)
        turns.append(found.orientation_residual**2)
    deviation = math.sqrt(24.0 / trials)
    assert abs(np.mean(squares) - 12.0) < 3.5 * deviation
    assert np.percentile(squares, 95) < 21.03 + 4.0  # 5 % of chi squared of 12 are above 21.03
    if noise is NOISE:
        # Residuals lose the 6 unknowns of 36 numbers; a mean square of 30 has a deviation of a quarter.
        free = 3.0 * 30.0 / 36.0
        assert np.mean(places) == pytest.approx(
            free * noise.position**2, rel=3.5 * math.sqrt(2.0 / 30.0 / trials)
        )
        assert np.mean(turns) == pytest.approx(
            free * noise.orientation**2, rel=3.5 * math.sqrt(2.0 / 30.0 / trials)
        )


def test_without_a_known_noise_residuals_tell_it() -> None:
    """Of 120 states, whose residuals exclude that their noise is correlated."""
    motion = motion_of("about the minor axis")
    ratios = []
    for seed in range(30):
        states = window(motion, np.linspace(1.3, 1.52, 120), NOISE, seed)
        told, found = fit(motion, states, NOISE), fit(motion, states)
        np.testing.assert_allclose(found.state.w_WB_W, told.state.w_WB_W, rtol=0.0, atol=1e-9)
        ratios.append(found.covariance.diagonal() / told.covariance.diagonal())
    np.testing.assert_allclose(
        np.mean(ratios, axis=0), 1.0, rtol=0.0, atol=3.5 * math.sqrt(2.0 / 354.0 / 30.0)
    )


def test_what_each_state_misses_is_told() -> None:
    """A state that is off by a known shift and turn misses by nearly that, and the others by little."""
    motion = motion_of(min(MOTIONS))
    states = window(motion, WINDOW, None)
    off = states[5]
    states[5] = turned(off, [0.02, 0.0, 0.0], p_WB_W=off.p_WB_W + np.array([0, 0.01, 0]))
    found = fit(motion, states, NOISE)
    assert found.position_misses_W.shape == found.orientation_misses_W.shape == (12, 3)
    # one of twelve states pulls the fit to itself by its leverage, which is below 0.4 in the middle
    assert found.position_misses_W[5, 1] == pytest.approx(0.01, rel=0.4)
    assert found.orientation_misses_W[5, 0] == pytest.approx(0.02, rel=0.4)
    rms = math.sqrt(np.square(found.position_misses_W).sum() / 12)
    assert rms == pytest.approx(found.position_residual)


@pytest.mark.parametrize("noise", [None, NOISE, WITH_RATES])
def test_it_says_how_the_state_changes_with_gravity(noise: StateNoise | None) -> None:
    """As a fit under another gravity has it; of many positions alone, by T^2 / 12 and T / 2."""
    motion, pull = motion_of(min(MOTIONS)), np.array([0.3, -0.2, 0.1])
    states = window(motion, np.linspace(1.3, 1.5, 400), NOISE)
    found, other = (
        fit_free_motion(motion.body, states, gravity_W=motion.gravity_W + each, noise=noise)
        for each in (np.zeros(3), pull)
    )
    assert found.by_gravity is not None
    place, rate = found.by_gravity
    np.testing.assert_allclose(other.state.p_WB_W - found.state.p_WB_W, place * pull, rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(other.state.v_WB_W - found.state.v_WB_W, rate * pull, rtol=1e-6, atol=1e-12)
    if noise is not WITH_RATES:
        assert place == pytest.approx(0.2**2 / 12.0, rel=0.01)
        assert rate == pytest.approx(0.2 / 2.0, rel=0.01)


@pytest.mark.parametrize("noise", [NOISE, WITH_RATES])
def test_another_minimiser_finds_the_same(noise: StateNoise) -> None:
    motion = motion_of("near the middle axis")
    states = window(motion, WINDOW, WITH_RATES, 5)
    found = fit(motion, states, noise).state
    times = np.array([state.stamp_ns - found.stamp_ns for state in states]) * 1e-9

    def residuals(x: np.ndarray) -> np.ndarray:
        state = turned(
            found,
            x[3:6],
            p_WB_W=found.p_WB_W + x[:3],
            v_WB_W=found.v_WB_W + x[6:9],
            w_WB_W=found.w_WB_W + x[9:],
        )
        then = free_motion(motion.body, state, gravity_W=motion.gravity_W).at(times)
        seen = Rotation.from_quat([state.q_WB for state in states])
        parts = [
            (then.p_WB_W - [state.p_WB_W for state in states]) / noise.position,
            (seen * Rotation.from_quat(then.q_WB).inv()).as_rotvec() / noise.orientation,
        ]
        if noise.linear_velocity and noise.angular_velocity:
            parts.append((then.v_WB_W - [state.v_WB_W for state in states]) / noise.linear_velocity)
            parts.append((then.w_WB_W - [state.w_WB_W for state in states]) / noise.angular_velocity)
        return np.concatenate(parts).ravel()

    start = np.repeat([1e-2, -2e-2, 1e-2, 3e-2], 3)
    other = least_squares(residuals, start, xtol=1e-14, ftol=1e-14, gtol=1e-14)
    # Gauss and Newton leave out that a rotation vector's rate is not quite the angular velocity: second order
    # in residuals of 5e-3.
    np.testing.assert_allclose(other.x, 0.0, rtol=0.0, atol=2e-4)
    assert np.square(residuals(np.zeros(12))).sum() == pytest.approx(2.0 * other.cost, rel=1e-4)


# Windows that say too little, or too much


def test_two_states_are_too_few() -> None:
    motion = motion_of("flat")
    for count in (0, 1, 2):
        with pytest.raises(InvalidFieldError, match=f"states must be at least 3.*, got {count} states"):
            fit(motion, window(motion, WINDOW[:count], None))


def test_too_many_states() -> None:
    with pytest.raises(TooLargeError, match="2001 states"):
        fit(motion_of("flat"), [motion_of("flat").state] * 2001)


@pytest.mark.parametrize("times", [[0.0, 0.0, 0.0], [0.0, 0.1, 0.1, 0.2], [0.0, 0.2, 0.1], [0.3, 0.2, 0.1]])
def test_stamps_ascend(times: list[float]) -> None:
    with pytest.raises(InvalidFieldError, match=r"states must be .*, got stamps"):
        fit(motion_of("flat"), window(motion_of("flat"), np.array(times), None))


def test_a_window_beyond_prediction() -> None:
    motion = motion_of("about the middle axis")
    with pytest.raises(InvalidFieldError, match=r"states must be .*, got 3000 s"):
        fit(motion, window(motion, np.linspace(0.0, 3000.0, 2000), None))


@seeds(range(6))
def test_needles_are_found_whose_spin_is_lost_in_their_momentum(seed: int) -> None:
    rng = np.random.default_rng(seed)
    slim = 10.0 ** rng.uniform(-5.0, -3.0)
    body = MassProperties(mass=1.0, I_B=np.diag([slim, 1.0, 1.0 + 0.5 * slim]))
    w = rng.normal(size=3)
    begin = BodyState(p_WB_W=np.zeros(3), q_WB=(0, 0, 0, 1), w_WB_W=10.0 * w / np.linalg.norm(w))
    motion = free_motion(body, begin)
    fit = fit_free_motion(body, [motion.state_at(0.01 * i) for i in range(12)])
    assert fit.converged
    assert fit.orientation_residual < 1e-8
