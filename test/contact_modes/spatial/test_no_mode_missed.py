# SPDX-License-Identifier: Apache-2.0
"""No mode is missed on several planes: each that was made by construction is listed, or one is unproven."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics import BodyState, ContactSet, MassProperties, ModeVerdict, SpatialContactProblem
from contact_dynamics.contact_modes import SpatialModeAnswer, contact_modes
from contact_modes.evidence import problem_of_made, spatial_problem
from oracles.modes_on_planes import Made, made, worst_violation
from sweeps import seeds

NEAR = 0.01  # relative, of accelerations: modes whose directions of sliding differ by 1e-3 rad count as one
EXACT = 1e-9
FEW, BLOCK = 60, 1000
AT_REST = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1])


def place_of(case: Made, answer: SpatialModeAnswer) -> str:
    """Return where an answer has the mode that was made."""
    size = max(EXACT, NEAR * float(np.abs(case.motion).max()))
    for mode in answer.modes:
        motion = np.concatenate([mode.acceleration_W, mode.angular_acceleration_W])
        if mode.mode == case.letters and (
            not mode.motion_unique or np.abs(motion - case.motion).max() <= size
        ):
            return "listed"
    return "undecided" if answer.verdict == ModeVerdict.UNDECIDED else "missed"


def check_modes(case: Made, answer: SpatialModeAnswer) -> None:
    """Check each mode by mechanics alone."""
    for mode in answer.modes:
        motion = np.concatenate([mode.acceleration_W, mode.angular_acceleration_W])
        missed = worst_violation(case, mode.mode, motion, mode.contact_forces_W, mode.contact_accelerations_W)
        assert missed <= EXACT, mode.mode


def places_of(seeds: range) -> Counter[str]:
    """Return how many answers list the mode that was made, and how many leave a mode unproven."""
    places: Counter[str] = Counter()
    for seed in seeds:
        case = made(seed)
        answer = contact_modes(problem_of_made(case))
        check_modes(case, answer)
        places[place_of(case, answer)] += 1
        places["unproven"] += answer.verdict == ModeVerdict.UNDECIDED
        if answer.verdict == ModeVerdict.UNDECIDED:
            assert answer.undecided
    return places


def test_no_mode_that_was_made_on_planes_is_missed() -> None:
    places = places_of(range(FEW))
    assert places["missed"] == 0
    assert places["unproven"] <= 0.02 * FEW


def test_a_contact_that_begins_to_slide_does_so_as_fast_as_was_found() -> None:
    """At 4e-8 m/s^2, rounding took its direction further from its friction than 1e-9."""
    assert places_of(range(8255, 8256))["missed"] == 0


@pytest.mark.parametrize(("seed", "modes"), [(194, ["fccccc", "cccccc"]), (326, ["fcccc", "ccccc"])])
def test_a_body_that_slides_at_all_contacts_but_one_may_stick_there_or_begin_to_slide(
    seed: int, modes: list[str]
) -> None:
    """Whichever of the modes is found first, the other one is not missed."""
    answer = contact_modes(problem_of_made(made(seed)))
    assert [mode.mode for mode in answer.modes] == modes


@seeds(range(12), slow=range(12, 300))
def test_modes_are_listed_in_the_order_of_their_letters(seed: int) -> None:
    order = {"s": 0, "f": 1, "c": 2}
    keys = [
        [order[letter] for letter in mode.mode] for mode in contact_modes(problem_of_made(made(seed))).modes
    ]
    assert keys == sorted(keys)


def test_what_sticks_has_one_motion_and_what_only_begins_to_translate_too() -> None:
    """Loads that eight contacts share in many ways do not change how the body translates."""
    (sliding,) = contact_modes(problem_of_made(made(93))).modes
    assert (sliding.mode, sliding.forces_unique, sliding.motion_unique) == ("c" * 8, False, True)
    assert sliding.angular_acceleration_W == pytest.approx(np.zeros(3), abs=1e-9)
    still = next(mode for mode in contact_modes(problem_of_made(made(5))).modes if mode.mode == "f" * 7)
    assert (still.forces_unique, still.motion_unique) == (False, True)


@pytest.mark.slow
@pytest.mark.parametrize("block", range(20))
def test_no_mode_that_was_made_on_planes_is_missed_in_twenty_thousand_draws(block: int) -> None:
    """The draws are of one to eight contacts on one to four planes, at rest and moving."""
    places = places_of(range(BLOCK * block, BLOCK * (block + 1)))
    assert places["missed"] == 0
    assert places["unproven"] <= 0.02 * BLOCK


@seeds(range(5), slow=range(5, 300))
def test_the_answer_does_not_depend_on_the_facets(seed: int) -> None:
    case = made(seed)
    answers = [contact_modes(problem_of_made(case, friction_facets=facets)) for facets in (3, 8, 24)]
    assert len({one.verdict for one in answers}) == 1
    assert len({tuple(sorted(mode.mode for mode in one.modes)) for one in answers}) == 1


def test_three_feet_on_a_floor_and_two_on_a_wall_have_three_modes() -> None:
    y, z = [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]
    points = np.array([[-0.3, -0.5, 0], [0.4, 0, -0.5], [0.5, 0, -0.5], [-0.4, -0.5, 0.5], [-0.1, 0.3, -0.5]])
    force, torque = np.array([5.75, -3.5, -5.0]), np.array([-0.5, -0.325, 1.6])
    contacts = ContactSet(p_WC_W=points, normals_W=[y, z, z, y, z], frictions=0.5)
    # All five slide along x at 1.5 m/s^2, which these forces bring about.
    pressing = np.array([3.0, 2.0, 0.5, 0.5, 2.5])
    forces = pressing[:, None] * (np.array([y, z, z, y, z]) - [0.5, 0.0, 0.0])
    assert forces.sum(axis=0) + force == pytest.approx([1.5, 0.0, 0.0], abs=1e-12)
    assert np.cross(points, forces).sum(axis=0) + torque == pytest.approx(np.zeros(3), abs=1e-12)
    for facets in (3, 8, 16, 24):
        answer = contact_modes(
            spatial_problem(
                MassProperties(mass=1, I_B=np.diag([0.6, 0.7, 0.9])),
                AT_REST,
                contacts,
                force,
                torque,
                friction_facets=facets,
            )
        )
        assert answer.verdict == ModeVerdict.INDETERMINATE
        assert {mode.mode for mode in answer.modes} == {"ccccc", "ccscc", "csccc"}
        (together,) = (mode for mode in answer.modes if mode.mode == "ccccc")
        assert together.acceleration_W == pytest.approx([1.5, 0.0, 0.0], abs=1e-9)
        assert together.motion_unique


def test_two_feet_that_leave_a_squeezed_box_are_found() -> None:
    """With fewer and wider regions of motions the mode `cccssc` could be neither found nor refuted."""
    points = [
        (0.5, -0.2, 0.5),
        (0.5, 0.2, 0.5),
        (-0.5, -0.2, -0.5),
        (0, -0.2, 0.5),
        (-0.5, -0.2, 0),
        (0, 0.2, 0),
    ]
    answer = contact_modes(
        spatial_problem(
            MassProperties(mass=2.0, I_B=np.diag([0.3, 0.4, 0.5])),
            BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1]),
            ContactSet(
                p_WC_W=points, normals_W=[(0, -math.copysign(1.0, y), 0) for _, y, _ in points], frictions=0.5
            ),
            [-5, 0, 0],
        )
    )
    assert answer.verdict == ModeVerdict.INDETERMINATE
    assert {mode.mode for mode in answer.modes} == {"ffffff", "ffcccc", "cccssc", "cccccc"}


@pytest.mark.parametrize("draw", range(4))
def test_three_fingers_around_a_part_hold_it_let_it_slip_or_turn_about_two_of_them(draw: int) -> None:
    # In equilibrium the three normal forces are equal. If two contacts began to slide down beside one that
    # sticks, their friction would be at its limit, and the torque of the third, which is not, would lower it.
    rng = np.random.default_rng(draw)
    around = 2.0 * np.pi / 3.0 * np.arange(3) + rng.uniform(0.0, 2.0)
    normals = -np.column_stack([np.cos(around), np.sin(around), np.zeros(3)])
    turn = Rotation.random(random_state=draw).as_matrix()
    fingers = ContactSet(
        p_WC_W=-0.05 * normals @ turn.T, normals_W=normals @ turn.T, frictions=rng.uniform(0.2, 1.2)
    )
    part = MassProperties(mass=0.5, I_B=1e-3 * turn @ np.diag([1.0, 1.2, 1.5]) @ turn.T)
    answer = contact_modes(
        SpatialContactProblem(body=part, state=AT_REST, contacts=fingers, force_W=turn @ [0.0, 0.0, -4.9])
    )
    assert answer.verdict == ModeVerdict.INDETERMINATE
    assert sorted(mode.mode for mode in answer.modes) == ["ccc", "cff", "fcf", "ffc", "fff"]
