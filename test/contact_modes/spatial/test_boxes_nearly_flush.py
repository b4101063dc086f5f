# SPDX-License-Identifier: Apache-2.0
"""Boxes on feet, in slots, in stacks and as pegs are decided, and soon, whatever the noise of their contacts.

Each mode is checked by mechanics alone, with the contacts that were given.
"""

from __future__ import annotations

import time
from collections import Counter

import numpy as np
import pytest

from contact_dynamics import BodyState, ContactSet, MassProperties
from contact_dynamics.contact_modes import ModeVerdict, SpatialContactProblem, SpatialMode, contact_modes
from contact_dynamics.tolerances import FLUSH, FLUSH_ROUGHLY, STRICT
from contact_modes.evidence import spatial_problem
from oracles.boxes_nearly_flush import MASS, Flush, flush
from sweeps import seeds

EXACT = 1e-9  # relative: what modes may miss mechanics by, beside what flush contacts differ by
LEANS = 2.0  # times the tolerance: friction leans with the normal, and so does the sliding that it opposes
ROUNDING = 4.0 * np.finfo(float).eps  # of an acceleration, relative to the fastest one
TOUCHES = 1e-6  # m/s
MOST_UNDECIDED = 0.02
SOON = 0.2  # s of processor time
MOST_LATE = 0.05  # share of boxes: those with eight contacts that can move in many ways
BOXES = 2000
DECADES = range(-14, -2)


def problem_of(box: Flush) -> SpatialContactProblem:
    return spatial_problem(
        MassProperties(mass=MASS, I_B=np.diag(box.inertia)),
        BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=box.velocity),
        ContactSet(p_WC_W=box.points, normals_W=box.normals, frictions=box.frictions),
        box.wrench[:3],
        box.wrench[3:],
        velocity_tolerance=TOUCHES,
    )


def noise_of(seed: int, decade: int) -> float:
    return float(10.0 ** (decade + np.random.default_rng(seed).random()))


def worst_miss(box: Flush, mode: SpatialMode, flush_within: float) -> float:
    """Return the largest ratio of what a mode misses mechanics by to what it may.

    These are Newton's, Euler's and Coulomb's laws, and the accelerations that letters stand for. The mode is
    that of contacts within ``flush_within`` of those of the box.

    - Forces lean by as much with their contacts.
    - The accelerations of points at rest come from n forces that lean: each accelerates the mass centre, and
      turns the body by its lever arm, so that a point as far away accelerates by (reach / gyration)^2 of it.
    - The direction of an acceleration is only as good as the acceleration itself, in doubles.
    """
    forces, points, normals = mode.contact_forces_W, mode.contact_accelerations_W, box.normals
    size = max(float(np.abs(forces).max()), float(np.abs(box.wrench[:3]).max()))
    fast = max(float(np.abs(points).max()), size / MASS)
    force = forces.sum(axis=0) + box.wrench[:3] - MASS * mode.acceleration_W
    torque = np.cross(box.points, forces).sum(axis=0) + box.wrench[3:]
    torque -= box.inertia * mode.angular_acceleration_W
    leaning = EXACT + LEANS * flush_within
    reach = float(np.linalg.norm(box.points, axis=1).max())
    turning = MASS * reach**2 / float(np.min(box.inertia))
    moving = EXACT + LEANS * len(forces) * (1.0 + turning) * flush_within
    missed = [float(np.abs(each).max()) / size / leaning for each in (force, torque)]
    pressing, rising = np.sum(forces * normals, axis=1), np.sum(points * normals, axis=1)
    across = forces - pressing[:, None] * normals
    sliding = points - rising[:, None] * normals
    for i, letter in enumerate(mode.mode):
        if letter == "s":
            missed.append(float(np.abs(forces[i]).max()) / size / leaning)
            if abs(normals[i] @ box.velocity) <= TOUCHES:
                missed.append(-float(rising[i]) / fast / moving)
            continue
        most = box.frictions[i] * pressing[i]
        missed += [abs(float(rising[i])) / fast / moving, -float(pressing[i]) / size / leaning]
        missed.append((float(np.linalg.norm(across[i])) - most) / size / leaning)
        if letter == "f":
            missed.append(float(np.linalg.norm(sliding[i])) / fast / moving)
        elif most > 0.0:
            way = box.velocity - (normals[i] @ box.velocity) * normals[i]
            moves = float(np.linalg.norm(way)) > TOUCHES
            way = way if moves else sliding[i]
            speed = float(np.linalg.norm(way))
            if speed > STRICT * fast:
                rounded = 0.0 if moves else ROUNDING * fast / speed
                off = float(np.linalg.norm(across[i] + most * way / speed)) / size
                missed.append(off / (leaning + rounded))
    return max(missed)


def check(seed: int, noise: float) -> tuple[ModeVerdict, float]:
    """Check each mode of a box, and return the verdict and the processor time that it took, s."""
    box = flush(seed, noise)
    problem = problem_of(box)
    start = time.process_time()
    answer = contact_modes(problem)
    took = time.process_time() - start
    assert answer.flush_within in {0.0, FLUSH, FLUSH_ROUGHLY}
    for mode in answer.modes:
        assert worst_miss(box, mode, answer.flush_within) <= 1.0, (seed, mode.mode)
    return answer.verdict, took


@pytest.mark.parametrize("decade", DECADES)
def test_some_boxes_are_decided(decade: int) -> None:
    verdicts = Counter(check(seed, noise_of(seed, decade))[0] for seed in range(200, 203))
    assert ModeVerdict.UNDECIDED not in verdicts


@pytest.mark.slow
@pytest.mark.parametrize("decade", DECADES)
def test_two_thousand_boxes_of_each_decade_are_decided_and_soon(decade: int) -> None:
    wrong, undecided, late = [], 0, 0
    for seed in range(BOXES):
        try:
            verdict, took = check(seed, noise_of(seed, decade))
        except AssertionError as error:
            wrong.append(str(error).splitlines()[0])
            continue
        undecided += verdict == ModeVerdict.UNDECIDED
        late += took > SOON
    assert wrong == []
    assert undecided <= MOST_UNDECIDED * BOXES
    assert late <= MOST_LATE * BOXES


@seeds(range(200, 207), slow=range(207, 216))
def test_noise_that_counts_as_none_changes_no_verdict_and_no_letter(seed: int) -> None:
    exact = contact_modes(problem_of(flush(seed, 0.0)))
    for noise in (1e-13, 1e-11, 3e-10):
        noisy = contact_modes(problem_of(flush(seed, noise)))
        assert noisy.verdict == exact.verdict
        assert {mode.mode for mode in noisy.modes} == {mode.mode for mode in exact.modes}
        assert noisy.flush_within in {0.0, FLUSH}


def test_forces_that_hide_the_motion_make_no_mode() -> None:
    """In this stack a mode was found with forces of 3e14 N, under which contacts penetrate at 0.01 m/s^2."""
    check(1922, noise_of(1922, -4))
    modes = contact_modes(problem_of(flush(1922, noise_of(1922, -4)))).modes
    assert "ffffffff" in {mode.mode for mode in modes}
    assert all(np.abs(mode.contact_forces_W).max() <= 1e3 for mode in modes)


def test_friction_that_misses_the_sliding_by_more_than_rounding_makes_no_mode() -> None:
    """A contact that slid at 1e-7 of the load was 1.2 times as far off its friction as is allowed."""
    check(890, noise_of(890, -5))


@pytest.mark.parametrize(("seed", "decade"), [(74, -13), (74, -11), (1398, -9)])
def test_stacks_that_may_begin_to_turn_about_a_foot_are_decided_soon(seed: int, decade: int) -> None:
    """Near a foot about which a stack turns, feet slide any way, but those above each other the same way.

    The search took 1,500 to 4,700 linear programs, and up to 9 s.
    """
    answer = contact_modes(problem_of(flush(seed, noise_of(seed, decade))))
    assert answer.verdict == ModeVerdict.INDETERMINATE
    assert len(answer.modes) >= 5
    assert answer.examined <= 1000


@pytest.mark.parametrize(("seed", "decade"), [(1073, -8), (1235, -10), (407, -10)])
def test_no_choice_of_contacts_that_stay_is_decided_twice(seed: int, decade: int) -> None:
    """After each search of pyramids all modes were sought anew, with 2,000 to 2,900 programs in all."""
    assert contact_modes(problem_of(flush(seed, noise_of(seed, decade)))).examined <= 1300


def test_contacts_that_are_flush_are_left_as_they_are() -> None:
    for seed in range(200, 216):
        assert contact_modes(problem_of(flush(seed, 0.0))).flush_within == 0.0


def test_no_mode_that_is_listed_penetrates() -> None:
    """A leaving contact went into its wall at 3e-6 m/s^2."""
    check(1025, noise_of(1025, -5))


def test_a_box_in_a_slot_whose_walls_are_off_by_single_precision_may_rest() -> None:
    """The search took 0.6 s for it and ended in UNDECIDED."""
    verdict, _ = check(21, noise_of(21 + 12345, -7))
    assert verdict == ModeVerdict.UNIQUE
