# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import numpy as np
import pytest

from contact_dynamics.measured.events import find_rest
from contact_dynamics.measured.flight_fit import MeasuredState
from contact_dynamics.measured.flights import corner_heights, find_strikes
from contact_dynamics.measured.read_toss import read_toss
from measured.brick_truth import TRUTH
from measured.known_toss import CORNERS, P_NOISE, Q_NOISE, as_toss
from oracles.bouncing_toss import MOMENTS, KnownState, Leg, angle_between, toss
from oracles.rigid_flight import fly, matrix

LEGS = [
    Leg(0.2013, (0.7, -0.3, -1.0), (5.0, 3.0, -4.0)),
    Leg(0.1507, (0.6, 0.1, 1.3), (-9.0, 8.0, 2.0)),
    Leg(0.0904, (0.4, 0.2, 0.6), (3.0, -5.0, 6.0)),
]


def scores(found: MeasuredState, truth: KnownState) -> np.ndarray:
    """Errors in stated standard deviations: of position, orientation, velocity, angular velocity."""
    return np.concatenate(
        [
            (found.state.p_WB_W - truth.p) / found.position_std,
            angle_between(truth.q, found.state.q_WB) / found.orientation_std,
            (found.state.v_WB_W - truth.v) / found.velocity_std,
            (found.state.w_WB_W - truth.w) / found.angular_velocity_std,
        ]
    )


def test_without_noise_strikes_are_found_where_they_are() -> None:
    known = toss(LEGS, at_rest=0.2)
    strikes = find_strikes(as_toss(known))
    assert len(strikes) == 2
    for strike, (time, before, after) in zip(strikes, known.strikes, strict=True):
        # the trapezoids of the rotation's fit leave 1e-4 rad, which 10 rad/s turn into 10 us
        assert strike.time == pytest.approx(time, abs=1e-5)
        for found, truth in ((strike.before, before), (strike.after, after)):
            assert found.state.p_WB_W == pytest.approx(truth.p, abs=3e-5)
            assert found.state.v_WB_W == pytest.approx(truth.v, abs=2e-4)
            assert found.state.w_WB_W == pytest.approx(truth.w, abs=0.01)


def test_errors_of_strikes_are_as_large_as_stated() -> None:
    states, times = [], []
    for seed in range(12):
        known = toss(LEGS, at_rest=0.2, p_noise=P_NOISE, q_noise=Q_NOISE, seed=seed)
        strikes = find_strikes(as_toss(known))
        assert len(strikes) == 2
        for strike, (time, before, after) in zip(strikes, known.strikes, strict=True):
            times.append((strike.time - time) / strike.time_std)
            states += [scores(strike.before, before), scores(strike.after, after)]
    # 24 times; 48 states, of which one strike's two share its time, so that some 24 are independent
    assert 0.6 < np.std(times) < 1.4
    for part in np.split(np.array(states), 4, axis=1):
        assert 0.7 < part.std() < 1.25
    assert np.abs(states).max() < 5.0


def test_heights_of_corners_tell_which_struck() -> None:
    known = toss(LEGS, at_rest=0.2)
    measured = as_toss(known)
    for strike, (_, before, _) in zip(find_strikes(measured), known.strikes, strict=True):
        heights = before.p[2] + (CORNERS @ matrix(before.q).T)[:, 2] - 0.3  # the floor of these tosses
        assert strike.heights == pytest.approx(heights, abs=1e-4)
        assert strike.corner == np.argmin(heights)
        lowest, second = np.sort(heights)[:2]
        assert strike.margin == pytest.approx(second - lowest, abs=2e-4)


def test_rest_is_found_with_its_pose() -> None:
    known = toss(LEGS, at_rest=0.4, p_noise=P_NOISE, q_noise=Q_NOISE)
    rest = find_rest(as_toss(known))
    assert rest is not None
    since, p, q = known.rest
    assert since - 0.01 < rest.time < since + 0.01  # the last millimetre of the way counts as rest already
    assert np.abs(rest.state.p_WB_W - p).max() < 4.0 * rest.position_std + 1e-4
    assert np.abs(angle_between(q, rest.state.q_WB)).max() < 4.0 * rest.orientation_std.max() + 1e-3
    assert rest.state.v_WB_W.tolist() == [0.0, 0.0, 0.0]


def test_a_body_that_still_moves_has_no_rest() -> None:
    known = toss(LEGS)
    assert find_rest(as_toss(known)) is None
    slow = toss([Leg(1e-9, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))], at_rest=0.5)
    creeping = slow._replace(p=slow.p + 0.1 * slow.times[:, None] * [0.0, 1.0, 0.0])
    assert find_rest(as_toss(creeping)) is None


def test_a_recording_that_stops_before_rest_is_long_enough_has_none() -> None:
    known = toss(LEGS, at_rest=0.03)
    assert find_rest(as_toss(known)) is None


def truth_at(frame: int, time: float) -> KnownState:
    """The engine's state carried from a frame to a time in the same flight."""
    motion = fly(
        [time - TRUTH.times[frame]],
        TRUTH.p_WB_W[frame],
        TRUTH.q_WB[frame],
        TRUTH.v_WB_W[frame],
        TRUTH.w_WB_W[frame],
        moments=MOMENTS,
    )
    return KnownState(*(part[0] for part in motion))


def test_the_recorded_bricks_strikes_are_those_of_the_engine() -> None:
    strikes = find_strikes(read_toss())
    assert len(strikes) >= 3
    for strike, truth in zip(strikes, TRUTH.strikes, strict=False):
        # the crossing is the centre of the impulse, inside the contact
        assert truth.begin - 3.0 * strike.time_std < strike.time < truth.end + 3.0 * strike.time_std
        frame = int(np.searchsorted(TRUTH.times, truth.begin))
        assert np.abs(scores(strike.before, truth_at(frame - 1, strike.time))).max() < 4.0
        assert np.abs(scores(strike.after, truth_at(frame, strike.time))).max() < 4.0


def test_the_recorded_bricks_first_strike_is_of_one_corner() -> None:
    first = find_strikes(read_toss())[0]
    assert first.margin > 0.01
    # at the centre of a strike of 0.6 ms at 4 m/s the corner would, without floor, be below it by 1 mm
    assert -1.5e-3 < first.heights.min() < 0.0
    assert first.before.state.v_WB_W[2] < -4.0
    assert first.after.state.v_WB_W[2] > 1.0


def test_the_recorded_brick_comes_to_rest_on_a_face() -> None:
    measured = read_toss()
    rest = find_rest(measured)
    assert rest is not None
    # the engine's last contact is made 40 ms later, when the brick has long stopped to move visibly
    assert TRUTH.strikes[-1].end - 0.06 < rest.time < TRUTH.strikes[-1].end + 0.01
    heights = np.sort(corner_heights(measured, rest.state)[0])
    assert heights[:4] == pytest.approx(np.zeros(4), abs=2e-4)
    assert heights[4:] == pytest.approx(np.full(4, 0.05), abs=2e-4)
