# SPDX-License-Identifier: Apache-2.0
"""No mode of a few oblique contacts is missed: each that was made by construction is listed, or named."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact_modes import (
    ModeVerdict,
    SpatialContactProblem,
    SpatialModeAnswer,
    contact_modes,
)
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_modes.evidence import spatial_problem
from oracles.modes_by_construction import INERTIA, MASS, Made, made

NEAR = 0.01  # relative, of accelerations: modes whose directions of sliding differ by 1e-3 rad count as one


def problem_of(case: Made) -> SpatialContactProblem:
    return spatial_problem(
        MassProperties(mass=MASS, I_B=INERTIA),
        BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0], v_WB_W=case.v, w_WB_W=case.w),
        ContactSet(p_WC_W=case.points, normals_W=case.normals, frictions=case.frictions),
        case.wrench[:3],
        case.wrench[3:],
    )


def place_of(case: Made, answer: SpatialModeAnswer) -> str:
    """Return where an answer has the mode that was made."""
    size = NEAR * float(np.abs(case.motion).max())
    for mode in answer.modes:
        motion = np.concatenate([mode.acceleration_W, mode.angular_acceleration_W])
        if mode.mode == case.letters and (
            not mode.motion_unique or np.abs(motion - case.motion).max() <= size
        ):
            return "listed"
    if case.letters in answer.undecided_modes:
        return "named"
    return "undecided" if answer.undecided else "missed"


def places(seeds: range) -> Counter[str]:
    return Counter(place_of(case, contact_modes(problem_of(case))) for case in map(made, seeds))


def test_no_mode_that_was_made_is_missed() -> None:
    found = places(range(15))
    assert found["missed"] == 0
    assert found["listed"] >= 14


def test_no_mode_of_a_spinning_body_is_missed_where_two_contacts_are_at_rest() -> None:
    # Friction of all of them lies between the edges of the pyramids.
    spinning = [1619, 1635, 1647]
    assert [place_of(case, contact_modes(problem_of(case))) for case in map(made, spinning)] == ["listed"] * 3


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
    at_rest = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1])
    answer = contact_modes(
        SpatialContactProblem(body=part, state=at_rest, contacts=fingers, force_W=turn @ [0.0, 0.0, -4.9])
    )
    assert answer.verdict == ModeVerdict.INDETERMINATE
    assert sorted(mode.mode for mode in answer.modes) == ["ccc", "cff", "fcf", "ffc", "fff"]


@pytest.mark.slow
@pytest.mark.parametrize("block", range(40))
def test_no_mode_that_was_made_is_missed_in_two_thousand_draws(block: int) -> None:
    found = places(range(50 * block, 50 * block + 50))
    assert found["missed"] == 0
    assert found["listed"] >= 45
