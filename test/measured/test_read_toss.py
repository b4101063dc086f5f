# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.measured.read_toss import DEFAULT_RECORDING, read_toss
from contact_dynamics.motion.velocity_estimate import causal_velocities, frames_in_window
from measured.brick_truth import TRUTH
from oracles.rigid_flight import fly, matrix


def edited(tmp_path: Path, old: str, new: str) -> Path:
    text = DEFAULT_RECORDING.read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "edited.csv"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    return path


def test_the_recording_comes_with_the_package_and_is_small() -> None:
    assert DEFAULT_RECORDING.stat().st_size < 200_000
    toss = read_toss()
    assert toss.body.name == "brick"
    assert toss.body.mass_properties.mass == 0.4
    assert toss.surface.friction == 0.3
    assert toss.gravity_W.tolist() == [0.0, 0.0, -9.81]
    assert np.diff(toss.times) == pytest.approx(1.0 / toss.rate, abs=2e-9)  # times are rounded to 1 ns


def test_corners_are_those_of_the_box() -> None:
    toss = read_toss()
    assert np.ptp(toss.body.vertices_B, axis=0) == pytest.approx(toss.box_size)
    assert toss.body.vertices_B.mean(axis=0) == pytest.approx(np.zeros(3), abs=1e-15)


def test_inertia_is_that_of_a_uniform_box() -> None:
    toss = read_toss()
    a, b, c = toss.box_size
    expected = toss.body.mass_properties.mass / 12.0 * np.diag([b * b + c * c, c * c + a * a, a * a + b * b])
    inertia = toss.body.mass_properties.I_B
    assert inertia == pytest.approx(expected, abs=1e-9)


def test_it_flies_strikes_with_one_corner_flies_on_and_comes_to_rest_on_a_face() -> None:
    toss = read_toss()
    first, second = TRUTH.strikes[:2]
    assert first.begin > 0.4
    assert first.most_contacts == 1
    assert second.begin - first.end > 0.1
    rest = toss.times > toss.times[-1] - 0.7
    heights = toss.p_WB_W[rest, None, 2] + toss.body.vertices_B @ matrix(toss.q_WB[-1])[2]
    lowest = np.sort(heights, axis=1)[:, :4]
    # four corners on the floor, each off by the noise of position and of orientation times the lever
    assert np.abs(lowest).max() < 5.0 * (toss.position_noise + 0.09 * toss.orientation_noise)
    assert np.abs(TRUTH.table[rest, 8:11]).max() < 1e-3


def test_noise_is_what_the_header_says() -> None:
    toss = read_toss()
    n = 3 * len(toss)
    four_errors = 4.0 / np.sqrt(2.0 * n)
    assert (toss.p_WB_W - TRUTH.p_WB_W).std() == pytest.approx(toss.position_noise, rel=four_errors)
    turns = np.array([_turn(a, b) for a, b in zip(TRUTH.q_WB, toss.q_WB, strict=True)])
    assert turns.std() == pytest.approx(toss.orientation_noise, rel=four_errors)


def test_velocities_are_estimates_from_the_poses_of_the_file_itself() -> None:
    toss = read_toss()
    window = frames_in_window(toss.rate)
    v, w = causal_velocities(toss.times, toss.p_WB_W, toss.q_WB, frames=window)
    # four decimals in the file; the orientations are normalised again after reading
    assert toss.v_WB_W[window - 1 :] == pytest.approx(v[window - 1 :], abs=1e-4)
    assert toss.w_WB_W[window - 1 :] == pytest.approx(w[window - 1 :], abs=2e-4)


@pytest.mark.parametrize("part", ["flight", "rest"])
def test_velocities_are_as_good_as_the_noise_allows(part: str) -> None:
    toss = read_toss()
    rows = (
        toss.times < TRUTH.strikes[0].begin if part == "flight" else toss.times > TRUTH.strikes[-1].end + 0.06
    )
    v_error = (toss.v_WB_W - TRUTH.v_WB_W)[rows]
    w_error = (toss.w_WB_W - TRUTH.w_WB_W)[rows]
    # 105 and 180 overlapping windows of 12: some 9 and 15 independent ones, of three components, so
    # that 0.4 is three standard errors of the deviation
    assert v_error.std() == pytest.approx(toss.velocity_noise, rel=0.4)
    assert w_error.std() == pytest.approx(toss.angular_velocity_noise, rel=0.4)


def test_the_engine_flies_as_a_free_rigid_body_does() -> None:
    """The truth beside the recording is a torque-free flight: else no prediction could match it."""
    toss = read_toss()
    rows = np.flatnonzero(toss.times < TRUTH.strikes[0].begin)[::10]
    p, q, _, _ = fly(
        toss.times[rows],
        TRUTH.p_WB_W[0],
        TRUTH.q_WB[0],
        TRUTH.v_WB_W[0],
        TRUTH.w_WB_W[0],
        moments=toss.body.mass_properties.I_B.diagonal(),
    )
    # the truth's start is rounded to 1e-6 rad, 1e-4 rad/s and 1e-4 m/s, over 0.43 s
    assert p == pytest.approx(TRUTH.p_WB_W[rows], abs=5e-5)
    turns = [_turn(a, b) for a, b in zip(q, TRUTH.q_WB[rows], strict=True)]
    assert np.abs(turns).max() < 1.5e-4


def test_a_state_is_one_row_with_its_stamp() -> None:
    toss = read_toss()
    state = toss.state(3, epoch_ns=1_000)
    assert state.stamp_ns == 1_000 + round(toss.times[3] * 1e9)
    np.testing.assert_array_equal(state.p_WB_W, toss.p_WB_W[3])
    np.testing.assert_array_equal(state.w_WB_W, toss.w_WB_W[3])


def test_arrays_cannot_be_written() -> None:
    toss = read_toss()
    for array in (
        toss.times,
        toss.p_WB_W,
        toss.q_WB,
        toss.v_WB_W,
        toss.w_WB_W,
        toss.box_size,
        toss.gravity_W,
    ):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0.0


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("# mass [kg]: 0.4\n", "", "header must be .*, got nothing for mass"),
        ("# mass [kg]: 0.4", "# mass [g]: 400", "mass must be .*, got unit 'g'"),
        ("# mass [kg]: 0.4", "# mass [kg]: -0.4", "mass must be .*, got -0.4"),
        ("# mass [kg]: 0.4", "# mass [kg]: 0,4", "mass must be a value in JSON.*, got 0,4"),
        ("# gravity [m/s^2]: 9.81", '# gravity [m/s^2]: "down"', "gravity must be .*, got down"),
        ("t,px,py", "t,x,y", "columns"),
        ("0.004166667,", "0.000000000,", "times"),
        ("0.004166667,", "now,", "samples"),
        ("0.004166667,", "nan,", "times"),
        ("0.004166667,", "", "samples"),
    ],
)
def test_a_file_that_is_not_as_described_is_refused_by_name(
    tmp_path: Path, old: str, new: str, message: str
) -> None:
    with pytest.raises(InvalidFieldError, match=message):
        read_toss(edited(tmp_path, old, new))


def test_other_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="TOSS"):
        read_toss(tmp_path / "none.csv")
    other = tmp_path / "toss.txt"
    other.write_text("", encoding="utf-8")
    with pytest.raises(InvalidFieldError, match="TOSS"):
        read_toss(other)
    with pytest.raises(InvalidFieldError, match="one toss"):
        read_toss(f"{DEFAULT_RECORDING}#3")
    not_text = tmp_path / "toss.csv"
    not_text.write_bytes(b"\xf1\x00\xff")
    with pytest.raises(InvalidFieldError, match=r"toss.csv must be text in UTF-8.*, got .*"):
        read_toss(not_text)


def _turn(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The small rotation from a to b: the antisymmetric part of B A^T."""
    turn = matrix(b) @ matrix(a).T
    return 0.5 * np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
