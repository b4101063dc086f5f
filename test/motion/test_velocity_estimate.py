# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from contact_dynamics.motion.velocity_estimate import (
    FEWEST_FRAMES,
    causal_velocities,
    frames_in_window,
    slope_noise,
)
from contact_dynamics.rotations.many import turned
from oracles.rigid_flight import Motion, about, fly

TIMES = np.arange(24) / 240.0
Q_0 = about([0.6, 0.0, 0.8], 1.1)


def flight(w_W: Sequence[float], moments: Sequence[float] = (1.0, 1.0, 1.0)) -> Motion:
    return fly(TIMES, [0.1, 0.2, 1.0], Q_0, [0.7, -0.3, 0.4], w_W, moments=moments)


@pytest.mark.parametrize("spin", [[0.0, 0.0, 0.0], [9.0, -4.0, 6.0]])
def test_in_free_flight_the_estimate_is_the_velocity_at_its_own_stamp(spin: list[float]) -> None:
    p, q, v, w = flight(spin)
    linear, angular = causal_velocities(TIMES, p, q, frames=12)
    assert linear[FEWEST_FRAMES - 1 :] == pytest.approx(v[FEWEST_FRAMES - 1 :], abs=1e-10)
    assert angular[FEWEST_FRAMES - 1 :] == pytest.approx(w[FEWEST_FRAMES - 1 :], abs=1e-9)


def test_tumbling_is_within_the_cubic_that_a_quadratic_leaves_out() -> None:
    moments = (0.000353, 0.000833, 0.00102)
    p, q, _, w = flight([5.0, 3.0, -4.0], moments)
    _, estimate = causal_velocities(TIMES, p, q, frames=12)
    jerk = np.abs(np.diff(w, 2, axis=0)).max() * 240.0**2
    span = 11 / 240.0
    # over a span T the best quadratic leaves c T^3 / 20 times Legendre's third polynomial of c t^3, whose
    # slope at the end is 12 / T; here c is a sixth of the rate's second derivative
    bound = 12.0 / 20.0 * jerk / 6.0 * span**2
    error = np.abs(estimate[11:] - w[11:]).max()
    assert 0.0 < error < bound < 0.1


def test_the_future_is_not_used() -> None:
    p, q, _, _ = flight([1.0, 2.0, 3.0])
    before = causal_velocities(TIMES[:15], p[:15], q[:15], frames=12)
    p[15:] += 1.0
    q[15:] = Q_0
    after = causal_velocities(TIMES, p, q, frames=12)
    for short, long in zip(before, after, strict=True):
        np.testing.assert_array_equal(short, long[:15])


def test_without_history_there_is_no_estimate() -> None:
    p, q, _, _ = flight([1.0, 2.0, 3.0])
    v, w = causal_velocities(TIMES, p, q, frames=12)
    assert np.isnan(v[: FEWEST_FRAMES - 1]).all()
    assert np.isnan(w[: FEWEST_FRAMES - 1]).all()
    assert np.isfinite(v[FEWEST_FRAMES - 1 :]).all()


@pytest.mark.parametrize("frames", [5, 8, 12])
def test_noise_is_as_large_as_the_formula_says(frames: int) -> None:
    random = np.random.default_rng(frames)
    n = 3000
    times = np.arange(n) / 240.0
    p = 2e-4 * random.standard_normal((n, 3))
    q = turned(Q_0, 1e-3 * random.standard_normal((n, 3)))
    v, w = causal_velocities(times, p, q, frames=frames)
    # windows overlap, so of 9000 draws about 9000 / frames are independent; four standard errors
    tolerance = 4.0 / np.sqrt(2.0 * 9000 / frames)
    assert v[frames:].std() == pytest.approx(
        slope_noise(frames=frames, rate=240.0, noise=2e-4), rel=tolerance
    )
    assert w[frames:].std() == pytest.approx(
        slope_noise(frames=frames, rate=240.0, noise=1e-3), rel=tolerance
    )


def test_the_window_is_a_time() -> None:
    assert frames_in_window(240.0) == 12
    assert frames_in_window(148.0) == 7
    assert frames_in_window(30.0) == FEWEST_FRAMES
