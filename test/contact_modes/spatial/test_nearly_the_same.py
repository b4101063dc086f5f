# SPDX-License-Identifier: Apache-2.0
"""Contacts in space that are nearly the same: equilibria by construction, whose sticking is never missed."""

from __future__ import annotations

import contextlib

import numpy as np
import pytest

from contact_dynamics import (
    BodyState,
    ContactSet,
    MassProperties,
    ModeVerdict,
    SpatialContactProblem,
    mode_margins,
    statics,
)
from contact_dynamics.contact_modes import Certainty, contact_modes, wrench_sets
from contact_dynamics.errors import TooLargeError, UndecidedError
from contact_modes.evidence import spatial_problem
from oracles.equilibria_in_space import KINDS, Resting, resting, rough
from sweeps import seeds

AT_REST = BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0])
BODY = MassProperties(mass=2.0, I_B=np.diag([0.3, 0.4, 0.5]))
BOX = MassProperties(mass=1.0, I_B=np.diag([0.0043, 0.0043, 0.0053]))
FEET = np.array([[x, y, -0.1] for x in (-0.1, 0.1) for y in (-0.1, 0.1)])
HELD = 1e-9  # relative to the forces: what may be left of an equilibrium
PRESSED = 0.01 * HELD  # relative to the forces: how exact the normal forces are, which friction multiplies


def problem_of(case: Resting, body: MassProperties = BODY) -> SpatialContactProblem:
    return spatial_problem(
        body,
        AT_REST,
        ContactSet(p_WC_W=case.points, normals_W=case.normals, frictions=case.frictions),
        case.wrench[:3],
        case.wrench[3:],
    )


def check_sticking(problem: SpatialContactProblem) -> None:
    """Check that sticking is among the modes, with forces within the cones that leave nothing over.

    The forces are those of contacts within `flush_within` of the given ones, whose cones lean by as much.
    """
    n = len(problem.contacts)
    answer = contact_modes(problem)
    still = [mode for mode in answer.modes if mode.mode == "f" * n]
    assert len(still) == 1
    forces, normals = still[0].contact_forces_W, problem.contacts.normals_W
    size = float(np.abs(forces).max())
    pressing = np.sum(forces * normals, axis=1)
    across = np.linalg.norm(forces - pressing[:, None] * normals, axis=1)
    frictions = problem.contacts.frictions
    beyond = HELD + PRESSED * frictions + answer.flush_within * (1.0 + frictions)
    assert np.all(across <= frictions * pressing + beyond * size)
    # Contacts that are merged rest to what parts them: relative to what the forces alone would bring about.
    reach = float(np.linalg.norm(problem.contacts.p_WC_W, axis=1).max())
    alone = size * (1.0 / problem.body.mass + reach**2 / float(np.diag(problem.body.I_B).min()))
    assert np.abs(still[0].contact_accelerations_W).max() <= (HELD + answer.flush_within) * alone


@seeds([*range(12), 2077], slow=range(12, 6000))  # 2077 went in circles in a linear program
def test_a_body_at_rest_by_construction_may_stick(seed: int) -> None:
    check_sticking(problem_of(resting(seed)))


@seeds(range(8), slow=range(8, 1000))
def test_friction_up_to_a_million_and_arms_of_ten_thousand_radii_of_gyration(seed: int) -> None:
    case, gyration = rough(seed)
    body = MassProperties(mass=1.0, I_B=gyration**2 * np.diag([0.6, 0.8, 1.0]))
    check_sticking(problem_of(case, body))


@pytest.mark.parametrize("seed", [42, 47, 49, 57, 60])
def test_statics_do_not_deny_what_wide_cones_hold(seed: int) -> None:
    case, gyration = rough(seed)
    body = MassProperties(mass=1.0, I_B=gyration**2 * np.diag([0.6, 0.8, 1.0]))
    with contextlib.suppress(UndecidedError):
        assert statics(problem_of(case, body)).equilibrium != Certainty.NO


@pytest.mark.parametrize("angle", [1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4])
def test_a_box_under_its_weight_sticks_whatever_the_noise_of_its_normals(angle: float) -> None:
    chance = np.random.default_rng(4)
    normals = np.tile([0.0, 0.0, 1.0], (4, 1))
    for _ in range(3):
        normals[:, :2] = angle * chance.normal(size=(4, 2))
        contacts = ContactSet(
            p_WC_W=FEET, normals_W=normals / np.linalg.norm(normals, axis=1)[:, None], frictions=0.5
        )
        answer = contact_modes(spatial_problem(BOX, AT_REST, contacts, (0, 0, -9.8)))
        assert (answer.verdict, [mode.mode for mode in answer.modes]) == (ModeVerdict.UNIQUE, ["ffff"])


@pytest.mark.parametrize("gap", [1e-9, 1e-7, 1e-5, 1e-3])
def test_two_contacts_side_by_side_far_from_the_centre(gap: float) -> None:
    points = np.array([[1.0, 0.0, -0.1], [1.0, gap, -0.1], [-1.0, 0.3, -0.1], [-1.0, -0.3, -0.1]])
    contacts = ContactSet(p_WC_W=points, normals_W=[0.0, 0.0, 1.0], frictions=0.5)
    check_sticking(spatial_problem(BODY, AT_REST, contacts, (0.5, 0.2, -9.8)))


@seeds(range(len(KINDS)), slow=range(len(KINDS), 4 * len(KINDS)))
def test_questions_about_one_case_do_not_contradict_each_other(seed: int) -> None:
    problem = problem_of(resting(seed, max_friction=1.0))
    n = len(problem.contacts)
    answer = contact_modes(problem)
    letters = [mode.mode for mode in answer.modes]
    assert "f" * n in letters
    assert answer.verdict != ModeVerdict.INCONSISTENT
    with contextlib.suppress(UndecidedError):
        held = statics(problem)
        assert held.equilibrium != Certainty.NO
        assert held.stable_disturbance >= 0.0
        if held.equilibrium == Certainty.CERTAIN:
            assert answer.verdict == ModeVerdict.UNIQUE
    with contextlib.suppress(UndecidedError):
        assert [margin.mode for margin in mode_margins(problem, answer)] == letters
    with contextlib.suppress(UndecidedError, TooLargeError):
        # The wrench is held by the round cones: outside of the pyramids' set by what these leave out at most.
        (still,) = wrench_sets(problem, modes=["f" * n])
        short = 1.0 - np.cos(np.pi / problem.friction_facets)
        forces = next(mode for mode in answer.modes if mode.mode == "f" * n).contact_forces_W
        assert still.depth(problem.wrench_W, 1.0) >= -2.0 * short * float(np.abs(forces).sum())


@seeds(range(len(KINDS)))
def test_contacts_in_another_order_have_the_same_modes(seed: int) -> None:
    case = resting(seed)
    order = np.random.default_rng(seed).permutation(len(case.points))
    moved = case._replace(
        points=case.points[order], normals=case.normals[order], frictions=case.frictions[order]
    )
    before, after = (contact_modes(problem_of(one)) for one in (case, moved))
    assert "f" * len(order) in [mode.mode for mode in before.modes]
    if ModeVerdict.UNDECIDED not in (before.verdict, after.verdict):
        renamed = sorted({"".join(mode.mode[i] for i in order) for mode in before.modes})
        assert sorted({mode.mode for mode in after.modes}) == renamed
