# SPDX-License-Identifier: Apache-2.0
"""A body's states in stretches, and how well their poses are measured."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from contact_dynamics.measured.motion import StateColumns, estimated_noise, motions_of
from contact_dynamics.questions.uncertain_state import UncertainState
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.tolerances import LEAST_ORIENTATION_NOISE, LEAST_POSITION_NOISE
from evaluation.made_motion import BRICK, P_NOISE, Q_NOISE, bounces, only_motion, world_of


def states_at(stamps_ns: list[int]) -> list[BodyState]:
    return [
        BodyState(p_WB_W=[1e-9 * stamp, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[1, 0, 0], stamp_ns=stamp)
        for stamp in stamps_ns
    ]


def test_states_come_in_order_of_their_stamps_and_of_two_the_last_counts() -> None:
    stamps = [10_000_000 * i for i in range(20)]
    states = states_at(stamps)
    mixed = [*states[10:], *states[:10], states_at([stamps[5]])[0]]
    arrivals = list(range(len(mixed)))
    (motion,) = motions_of(BRICK, world_of(BRICK), StateColumns(mixed, arrivals))
    assert motion.stamps_ns.tolist() == stamps
    assert motion.arrivals_ns[5] == 20
    assert motion.rate == pytest.approx(100.0)
    assert motion.times == pytest.approx(1e-9 * np.array(stamps))


def test_a_gap_ends_a_stretch_and_short_ones_are_left_out() -> None:
    first = [10_000_000 * i for i in range(30)]
    short = [first[-1] + 60_000_000 + 10_000_000 * i for i in range(8)]
    last = [short[-1] + 60_000_000 + 10_000_000 * i for i in range(20)]
    states = states_at([*first, *short, *last])
    motions = motions_of(BRICK, world_of(BRICK), StateColumns(states, [0] * len(states)))
    assert [len(motion) for motion in motions] == [30, 20]
    assert motions[1].epoch_ns == 0  # times of all stretches count from the first state
    assert motions[1].times[0] == pytest.approx(1e-9 * last[0])
    some_missing = states_at([stamp for i, stamp in enumerate(first) if i % 4])
    assert len(motions_of(BRICK, world_of(BRICK), StateColumns(some_missing, [0] * len(some_missing)))) == 1


@pytest.mark.parametrize("seed", range(3))
def test_noise_is_estimated_through_flights_strikes_and_rest(seed: int) -> None:
    motion = only_motion(bounces(seed=seed).recording)
    position, orientation = estimated_noise(motion.p_WB_W, motion.q_WB)
    # 390 frames: their median is off by some 3 %, correlated differences make it a little more
    assert position == pytest.approx(P_NOISE, rel=0.1)
    assert orientation == pytest.approx(Q_NOISE, rel=0.1)


def test_poses_without_scatter_have_the_least_noise() -> None:
    motion = only_motion(bounces(noise=0.0).recording)
    position, orientation = estimated_noise(motion.p_WB_W, motion.q_WB)
    assert LEAST_POSITION_NOISE <= position < 0.02 * P_NOISE
    assert LEAST_ORIENTATION_NOISE <= orientation < 0.02 * Q_NOISE


def test_what_was_known_by_a_time_was_stamped_and_had_arrived() -> None:
    stamps = [10_000_000 * i for i in range(20)]
    arrivals = [stamp + (100_000_000 if i == 7 else 1_000_000) for i, stamp in enumerate(stamps)]
    (motion,) = motions_of(BRICK, world_of(BRICK), StateColumns(states_at(stamps), arrivals))
    assert motion.known_by(100_500_000, since=2).tolist() == [
        2,
        3,
        4,
        5,
        6,
        8,
        9,
    ]  # 7 is late, and 10 is half a millisecond from arriving
    counts = [len(motion.known_by(time)) for time in range(0, 300_000_000, 1_000_000)]
    assert all(earlier <= later for earlier, later in pairwise(counts))


def test_a_state_comes_back_to_the_bit_with_its_covariance_if_it_had_one() -> None:
    covariance = np.diag(np.arange(1.0, 13.0))
    states = states_at([10_000_000 * i for i in range(20)])
    known = [
        UncertainState(state=states[i], covariance=covariance) if i % 2 else states[i] for i in range(20)
    ]
    (motion,) = motions_of(BRICK, world_of(BRICK), StateColumns(known[::-1], range(20)))
    assert motion.state(4).to_dict() == states[4].to_dict()
    assert motion.state(5).to_dict() == known[5].to_dict()
    assert motion.part(5, 8).state(0).to_dict() == known[5].to_dict()
