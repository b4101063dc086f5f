# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.evaluation.recording import evaluate_recording, recording_of_toss
from contact_dynamics.evaluation.report import report
from contact_dynamics.evaluation.result import Evaluation
from contact_dynamics.evaluation.settings import Settings
from contact_dynamics.measured.cube_tosses import HALF_SIDE, RATE
from contact_dynamics.measured.events import EventKind, find_rest
from contact_dynamics.measured.flights import corner_heights, find_strikes
from contact_dynamics.measured.read_toss import read_toss
from contact_dynamics.motion.velocity_estimate import FEWEST_FRAMES
from oracles.rigid_flight import about, fly, matrix

CORNERS = HALF_SIDE * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])


def toss_table(*, tilt: float, flight: int, between: int) -> np.ndarray:
    """A cube that falls without spin, jumps, and lies still, each for some frames: 14 columns as published.

    ``tilt``: how far one corner points down, 1 wholly, 0 flat.
    """
    down = about(np.array([1.0, -1.0, 0.0]) / np.sqrt(2.0), tilt * np.arctan(np.sqrt(2.0)))
    touching = -(CORNERS @ matrix(down).T)[:, 2].min()
    before = np.arange(-flight, 0) / RATE
    after = np.arange(between) / RATE
    p_1, q_1, _, _ = fly(before, [0.0, 0.0, touching], down, [0.5, 0.0, -1.0], np.zeros(3), step=0.01)
    p_2, q_2, _, _ = fly(
        after, [0.0, 0.0, touching], down, [0.4, 0.0, 0.5 * 9.81 * between / RATE], np.zeros(3), step=0.01
    )
    p_3, q_3 = np.tile(p_2[-1] * [1.0, 1.0, 0.0] + [0.0, 0.0, touching], (30, 1)), np.tile(down, (30, 1))
    p, q = np.concatenate([p_1, p_2, p_3]), np.concatenate([q_1, q_2, q_3])
    published = np.full((len(p), 6), 1e6)  # nonsense, which nobody may read
    return np.column_stack([np.arange(len(p)) / RATE, p, q, published])


def save(path: Path, *tables: np.ndarray) -> Path:
    offsets = np.cumsum([0, *(len(table) for table in tables)])
    np.savez(path, data=np.concatenate(tables), offsets=offsets, columns=np.array(["t"] * 14))
    return path


def test_events_of_a_toss_have_the_times_of_its_file(tmp_path: Path) -> None:
    """The first frames have no velocity, and are left out. Times do not begin anew after them."""
    path = save(tmp_path / "t.npz", toss_table(tilt=1.0, flight=18, between=14))
    (motion,) = recording_of_toss(read_toss(path)).motions
    with np.load(path) as arrays:
        assert motion.times == pytest.approx(arrays["data"][-len(motion) :, 0], abs=1e-9)
    assert motion.times[0] > 0.02


@pytest.mark.parametrize(("tilt", "several"), [(1.0, False), (0.0, True)])
def test_impacts_of_one_corner_and_of_several_have_tables_of_their_own(
    tmp_path: Path,
    tilt: float,
    several: bool,  # noqa: FBT001  a value of a parametrized test
) -> None:
    path = save(tmp_path / "t.npz", toss_table(tilt=tilt, flight=24, between=14))
    found = evaluate_recording(recording_of_toss(read_toss(path, index=0)), Settings(horizons=(0.02,)))
    assert [event.several for event in found.events if event.kind is EventKind.IMPACT] == [several]
    printed = report(Evaluation(versions={}, configuration="", results=(found,)))
    assert ("impacts of several corners, or longer ones" in printed) == several
    assert ("impacts of a single corner: " in printed) != several
    assert ("compare laws and coefficients on impacts of a single corner" in printed) == several


def test_an_index_selects_a_toss(tmp_path: Path) -> None:
    path = save(tmp_path / "t.npz", *(toss_table(tilt=1.0, flight=f, between=14) for f in (10, 14, 12)))
    lengths = [len(read_toss(path, index=index)) for index in range(3)]
    assert lengths == [f + 14 + 30 - (FEWEST_FRAMES - 1) for f in (10, 14, 12)]
    assert len(read_toss(path)) == lengths[0]
    assert len(read_toss(f"{path}#1")) == lengths[1]
    assert len(read_toss(f"{path}:2")) == lengths[2]
    with pytest.raises(InvalidFieldError, match="index must be 0 to 2, got 3"):
        read_toss(f"{path}#3")


def test_velocities_come_from_the_poses_and_have_no_lag(tmp_path: Path) -> None:
    toss = read_toss(save(tmp_path / "t.npz", toss_table(tilt=1.0, flight=18, between=14)))
    falling = toss.times < 18 / RATE
    expected = -1.0 - 9.81 * (toss.times[falling] - 18 / RATE)
    assert toss.v_WB_W[falling, 2] == pytest.approx(expected, abs=1e-9)
    assert toss.w_WB_W[falling] == pytest.approx(np.zeros((falling.sum(), 3)), abs=1e-9)


def test_the_published_constants_go_with_it(tmp_path: Path) -> None:
    toss = read_toss(save(tmp_path / "t.npz", toss_table(tilt=1.0, flight=18, between=14)))
    assert toss.body.mass_properties.mass == 0.37
    assert toss.body.mass_properties.I_B.tolist() == np.diag([8.1e-4] * 3).tolist()
    assert np.abs(toss.body.vertices_B).tolist() == np.full((8, 3), 0.0524).tolist()
    assert (toss.surface.friction, toss.surface.restitution) == (0.18, 0.125)
    assert toss.rate == 148.0


def test_a_file_that_is_not_as_described_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "t.npz"
    np.savez(path, data=np.zeros((3, 14)))
    with pytest.raises(InvalidFieldError, match="must be arrays data and offsets"):
        read_toss(path)
    np.savez(path, data=np.zeros((3, 13)), offsets=[0, 3])
    with pytest.raises(InvalidFieldError, match=r"data must be .*, got shape \(3, 13\)"):
        read_toss(path)
    for offsets in ([0], [0, 4], [2, 1], [-1, 3]):
        np.savez(path, data=np.zeros((3, 14)), offsets=offsets)
        with pytest.raises(InvalidFieldError, match="offsets"):
            read_toss(path)
    np.savez_compressed(path, data=np.zeros((300, 14)), offsets=[0, 300])
    whole = path.read_bytes()
    with (tmp_path / "array.npy").open("wb") as stream:
        np.save(stream, np.zeros(3))
    one_array = (tmp_path / "array.npy").read_bytes()
    flipped = whole[:60] + b"\xff" * 4 + whole[64:]  # within the packed numbers
    for content in (b"no archive", b"", whole[:200], flipped, one_array):
        path.write_bytes(content)
        with pytest.raises(InvalidFieldError, match="plain arrays"):
            read_toss(path)


ROOT = Path(__file__).parents[2]
BESIDE = ROOT.parent / "shared" / "data" / "cube_tosses" / "tosses.npz"
MEASURED = Path(os.environ.get("CUBE_TOSSES", BESIDE))


@pytest.mark.skipif(not MEASURED.is_file(), reason=f"no published tosses at {MEASURED} (CUBE_TOSSES)")
def test_published_tosses_fly_strike_and_come_to_rest() -> None:
    assert read_toss(f"{MEASURED}#344").source.startswith("measured toss 344 ")
    with_strikes = 0
    tosses = range(0, 360, 12)
    for index in tosses:
        toss = read_toss(MEASURED, index=index)
        assert np.linalg.norm(toss.v_WB_W, axis=1).max() < 3.0  # thrown at 1.4 m/s from 15 cm
        rest = find_rest(toss)
        assert rest is not None
        # the board is where corners are at rest, to what frame, half side and board are known
        assert -0.006 < corner_heights(toss, rest.state).min() < 0.002
        with_strikes += len(find_strikes(toss)) > 0
    assert with_strikes > 0.7 * len(tosses)  # of all 360, 281 have a strike between two flights


@pytest.mark.skipif(not MEASURED.is_file(), reason=f"no published tosses at {MEASURED} (CUBE_TOSSES)")
def test_no_toss_on_which_errors_are_told_is_another_one_that_is_turned_about_the_vertical() -> None:
    """Such a turn changes neither heights nor the vertical in body axes."""
    split = json.loads((ROOT / "benchmarks" / "cube_split.json").read_text(encoding="utf-8"))
    with np.load(MEASURED) as file:
        rows, offsets = file["data"], file["offsets"]

    def fingerprint(index: int) -> tuple[float, ...]:
        toss = rows[offsets[index] : offsets[index + 1]]
        up_B = np.array([matrix(q)[2] for q in toss[:20:5, 4:8]])
        return (float(len(toss)), *np.round([*toss[:20:5, 3], *up_B.ravel()], 9).tolist())

    tested = [fingerprint(index) for index in split["test"]]
    fitted = {fingerprint(index) for index in split["fit"]}
    assert len(set(tested)) == len(tested) == 160
    assert not fitted & set(tested)
    assert len({fingerprint(index) for index in range(360)}) == 333  # so the twins are found
