# SPDX-License-Identifier: Apache-2.0
"""Noise that is correlated in time or differs from flight to flight: fits state covariances that hold."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2, multivariate_normal

from contact_dynamics import BodyState, MassProperties, free_motion
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.motion import Drag, FitResult, StateNoise, fit_free_motion, fit_motion, measured_noise
from contact_dynamics.motion.integrated import forced_motion
from contact_dynamics.motion.state_noise import fit_whitened
from motion.evidence import error, turned

BODY = MassProperties(mass=0.4, I_B=np.diag([3.5e-4, 8.3e-4, 1.02e-3]))
NEWEST = BodyState(
    p_WB_W=[0.1, -0.2, 1.0], q_WB=[0.0, 0.6, 0.0, 0.8], v_WB_W=[1.0, 0.5, -1.0], w_WB_W=[0.5, 6.0, 1.0]
)
SLOW = StateNoise(position=2e-4, orientation=1e-3, position_time=0.02, orientation_time=0.05)
WHITE = replace(SLOW, position_time=0.0, orientation_time=0.0)
STUDENT = replace(SLOW, degrees_of_freedom=4.0)
DRAG = Drag(quadratic=0.02)
TRIALS = 100


def correlated(rng: np.random.Generator, seconds: np.ndarray, deviation: float, time: float) -> np.ndarray:
    """Draws of exp(-dt / time), by the Cholesky factor of the whole matrix."""
    apart = np.abs(seconds[:, None] - seconds)
    matrix = np.exp(-apart / time) if time else np.eye(len(seconds))
    draws: np.ndarray = deviation * np.linalg.cholesky(matrix) @ rng.normal(size=(len(seconds), 3))
    return draws


def flight(noise: StateNoise, seed: int, *, count: int = 12, drag: Drag | None = None) -> list[BodyState]:
    """Poses at 150 Hz that end near `NEWEST`, at times that are not even."""
    rng = np.random.default_rng(seed)
    seconds = (np.arange(1 - count, 1) + rng.uniform(-0.3, 0.3, count)) / 150.0
    motion = free_motion(BODY, NEWEST) if drag is None else forced_motion(BODY, NEWEST, drag=drag)
    nu = noise.degrees_of_freedom
    scale = 1.0 if nu is None else math.sqrt((nu - 2.0) / rng.chisquare(nu))
    places = scale * correlated(rng, seconds, noise.position, noise.position_time)
    turns = scale * correlated(rng, seconds, noise.orientation, noise.orientation_time)
    states = []
    for second, place, turn in zip(seconds.tolist(), places, turns, strict=True):
        true = motion.state_at(second)
        # the angular velocity tells the whole turns, and does not enter the fit
        states.append(turned(true, turn, p_WB_W=true.p_WB_W + place, v_WB_W=np.zeros(3)))
    return states


def inside(found: FitResult, drag: Drag | None = None) -> np.ndarray:
    """The probability of the regions of position and of rotation, (2,), in whose border the truth lies."""
    ahead = found.state.stamp_ns * 1e-9
    motion = free_motion(BODY, NEWEST) if drag is None else forced_motion(BODY, NEWEST, drag=drag)
    true = motion.state_at(ahead)
    off = error(found.state, true)
    parts = [np.r_[0:3, 6:9], np.r_[3:6, 9:12]]
    squares = [off[at] @ np.linalg.solve(found.covariance[np.ix_(at, at)], off[at]) for at in parts]
    probabilities: np.ndarray = chi2.cdf(squares, 6)
    return probabilities


def check_coverage(regions: list[np.ndarray], *, wider: float = 0.0) -> None:
    """Regions of 50 and 90 % hold as many, within 3.5 binomial deviations, and ``wider`` more."""
    for share in (0.5, 0.9):
        held = np.mean(np.array(regions) < share, axis=0)
        slack = 3.5 * math.sqrt(share * (1.0 - share) / len(regions))
        assert (held > share - slack).all(), (share, held)
        assert (held < share + slack + wider).all(), (share, held)


@pytest.mark.parametrize("noise", [SLOW, WHITE, STUDENT])
def test_fits_with_a_given_noise_state_a_covariance_that_holds(noise: StateNoise) -> None:
    """Student's errors are a little closer to 0 than a Gaussian of their variance, with 34 degrees left."""
    regions = [inside(fit_free_motion(BODY, flight(noise, seed), noise=noise)) for seed in range(TRIALS)]
    check_coverage(regions)


def test_white_noise_would_not_do() -> None:
    regions = [inside(fit_free_motion(BODY, flight(SLOW, seed), noise=WHITE)) for seed in range(TRIALS)]
    assert (np.mean(np.array(regions) < 0.9, axis=0) < 0.6).all()


def test_fits_under_drag_too() -> None:
    regions = [
        inside(fit_motion(BODY, flight(SLOW, seed, drag=DRAG), drag=DRAG, noise=SLOW), DRAG)
        for seed in range(20)
    ]
    check_coverage(regions)


@pytest.mark.parametrize(("noise", "wider"), [(SLOW, 0.2), (WHITE, 0.05)])
def test_an_unknown_noise_is_told_by_a_long_window(noise: StateNoise, wider: float) -> None:
    """Of 64 poses. The average over correlation times is wider than the true one where some of them fit."""
    regions = [inside(fit_free_motion(BODY, flight(noise, seed, count=64))) for seed in range(TRIALS)]
    check_coverage(regions, wider=wider)


def test_a_short_window_does_not_pass_slow_errors_for_motion() -> None:
    """Of 12 poses with slow errors, regions of 90 % as for white noise hold fewer than half of the truths."""
    regions = [inside(fit_free_motion(BODY, flight(SLOW, seed))) for seed in range(TRIALS)]
    assert (np.mean(np.array(regions) < 0.9, axis=0) > 0.75).all()


def test_an_unknown_noise_under_drag() -> None:
    """As of the free fit to the same poses, up to correlation times that positions and orientations share."""
    states = flight(SLOW, 0)
    free, dragged = fit_free_motion(BODY, states), fit_motion(BODY, states, drag=Drag(quadratic=1e-9))
    ratios = dragged.covariance.diagonal() / free.covariance.diagonal()
    assert ((ratios > 0.4) & (ratios < 2.5)).all(), ratios


@pytest.mark.parametrize("time", [0.0, 0.004, 0.03])
def test_whitened_fits_are_those_of_the_whole_matrix(time: float) -> None:
    """The generalised least squares, and the restricted likelihood from contrasts free of the unknowns."""
    rng = np.random.default_rng(1)
    seconds = np.sort(rng.uniform(0.0, 0.1, 9))
    design, values = rng.normal(size=(9, 3, 4)), rng.normal(size=(9, 3, 1))
    fits = fit_whitened(design, values, seconds, np.array([0.01, time]))
    apart = np.abs(seconds[:, None] - seconds)
    matrix = np.kron(np.exp(-apart / time) if time else np.eye(9), np.eye(3))
    flat, seen = design.reshape(27, 4), values.ravel()
    covariance = np.linalg.inv(flat.T @ np.linalg.solve(matrix, flat))
    np.testing.assert_allclose(fits.inverse[1] @ fits.inverse[1].T, covariance, rtol=1e-9, atol=1e-12)
    step = covariance @ flat.T @ np.linalg.solve(matrix, seen)
    np.testing.assert_allclose(fits.step[1, :, 0], step, rtol=1e-9)
    contrasts = np.linalg.svd(flat)[0][:, 4:]
    log = multivariate_normal.logpdf(contrasts.T @ seen, cov=contrasts.T @ matrix @ contrasts)
    size = 0.5 * np.linalg.slogdet(flat.T @ flat)[1]
    found = fits.log_weight[1] - 0.5 * fits.cost[1]
    assert found - 0.5 * 23 * math.log(2 * math.pi) + size == pytest.approx(log)


def test_noise_is_measured_from_flights() -> None:
    """40 flights: the ratio of variance and time, which sets the errors of fits, to some 10 %."""
    found = measured_noise(BODY, [flight(STUDENT, seed, count=20) for seed in range(40)])
    spread = found.orientation**2 / found.orientation_time / (STUDENT.orientation**2 / 0.05)
    assert 0.6 < spread < 1.6
    assert 0.01 < found.orientation_time < 0.1
    assert found.position == pytest.approx(STUDENT.position, rel=0.4)
    assert found.position_time == pytest.approx(STUDENT.position_time, rel=0.5)
    assert found.degrees_of_freedom is not None
    assert 2.5 < found.degrees_of_freedom < 9.0
    white = measured_noise(BODY, [flight(WHITE, seed, count=20) for seed in range(40)])
    assert white.position_time < 0.002
    assert white.orientation_time < 0.002
    assert white.orientation == pytest.approx(WHITE.orientation, rel=0.1)
    assert white.degrees_of_freedom is not None
    assert white.degrees_of_freedom > 30.0


def test_measured_noise_leaves_out_flights_that_are_none() -> None:
    flights = [flight(SLOW, seed, count=20) for seed in range(30)]
    clean = measured_noise(BODY, flights)
    wild = replace(SLOW, position=2e-3, orientation=0.02)
    found = measured_noise(BODY, [*flights, *(flight(wild, seed, count=20) for seed in range(5))])
    assert found.orientation == pytest.approx(clean.orientation, rel=0.2)


def test_few_flights_are_refused() -> None:
    with pytest.raises(InvalidFieldError, match=r"flights must be at least 10, got 9 of 9 that"):
        measured_noise(BODY, [flight(SLOW, seed) for seed in range(9)])
    with pytest.raises(InvalidFieldError, match="got 0 of 0"):
        measured_noise(BODY, [])
