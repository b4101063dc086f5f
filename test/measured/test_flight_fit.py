# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import numpy as np
import pytest

from contact_dynamics.measured.flight_fit import fit_flight
from measured.known_toss import P_NOISE, Q_NOISE, as_toss
from oracles.bouncing_toss import MOMENTS, RATE, Leg, angle_between, toss
from oracles.rigid_flight import fly

LEG = Leg(0.2, (0.7, -0.3, -1.0), (9.0, -6.0, 11.0))
FRAMES = slice(5, 24)


def test_an_exact_flight_is_found() -> None:
    known = toss([LEG])
    fit = fit_flight(as_toss(known), FRAMES)
    truth = fly([known.times[23]], known.p[0], known.q[0], LEG.v, LEG.w, moments=MOMENTS)
    found = fit.at(known.times[23])
    assert found.state.p_WB_W == pytest.approx(truth.p[0], abs=1e-12)
    assert found.state.v_WB_W == pytest.approx(truth.v[0], abs=1e-10)
    # trapezoids of 4.2 ms at 16 rad/s leave (w dt)^2 / 12 = 4e-4 of the rate; a fifth of noise's effect
    assert np.abs(found.state.w_WB_W - truth.w[0]).max() < 0.005
    assert np.abs(angle_between(truth.q[0], found.state.q_WB)).max() < 1e-4


def test_a_steady_spin_is_found_to_rounding() -> None:
    known = toss([Leg(0.2, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))])
    spin = np.array([0.0, 0.0, 20.0])
    steady = fly(
        known.times, known.p[0], np.array([0.0, 0.0, 0.0, 1.0]), [0.0, 0.0, 0.0], spin, moments=MOMENTS
    )
    fit = fit_flight(as_toss(known._replace(q=steady.q)), FRAMES)
    found = fit.at(known.times[20])
    assert found.state.w_WB_W == pytest.approx(spin, abs=1e-8)
    assert np.abs(angle_between(steady.q[20], found.state.q_WB)).max() < 1e-9


@pytest.mark.parametrize("ahead", [-2.0, 0.0, 1.7])
def test_errors_are_as_large_as_stated(ahead: float) -> None:
    clean = toss([LEG])
    time = clean.times[23] + ahead / RATE
    truth = fly([time], clean.p[0], clean.q[0], LEG.v, LEG.w, moments=MOMENTS)
    scores = []
    for seed in range(60):
        known = toss([LEG], p_noise=P_NOISE, q_noise=Q_NOISE, seed=seed)
        found = fit_flight(as_toss(known), FRAMES).at(time)
        scores.append(
            np.concatenate(
                [
                    (found.state.p_WB_W - truth.p[0]) / found.position_std,
                    (found.state.v_WB_W - truth.v[0]) / found.velocity_std,
                    angle_between(truth.q[0], found.state.q_WB) / found.orientation_std,
                    (found.state.w_WB_W - truth.w[0]) / found.angular_velocity_std,
                ]
            )
        )
    for part in np.split(np.array(scores), 4, axis=1):
        # 180 draws: a deviation of 1 has a standard error of 0.053; Birge's ratio makes stated errors
        # some 5 % larger
        assert 0.75 < part.std() < 1.2
        assert abs(part.mean()) < 4.0 / np.sqrt(180)


def test_residuals_larger_than_the_stated_noise_enlarge_the_errors() -> None:
    known = toss([LEG], p_noise=10 * P_NOISE, q_noise=10 * Q_NOISE)
    modest = fit_flight(as_toss(known), FRAMES).at(known.times[23])
    stated = fit_flight(as_toss(known, p_noise=10 * P_NOISE, q_noise=10 * Q_NOISE), FRAMES).at(
        known.times[23]
    )
    # 19 frames: the residuals' own deviation is known to a tenth
    assert modest.velocity_std == pytest.approx(stated.velocity_std, rel=0.3)
    assert modest.angular_velocity_std == pytest.approx(stated.angular_velocity_std, rel=0.3)


def test_a_state_is_stamped_with_its_time() -> None:
    known = toss([LEG])
    assert fit_flight(as_toss(known), FRAMES).at(0.0975).state.stamp_ns == 97_500_000
