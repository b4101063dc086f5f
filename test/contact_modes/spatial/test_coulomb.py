# SPDX-License-Identifier: Apache-2.0
"""Every mode of an answer obeys Newton's and Coulomb's laws, or the verdict says that it may not."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from contact_dynamics import (
    BodyState,
    ContactSet,
    MassProperties,
    ModeVerdict,
    SpatialContactProblem,
    statics,
)
from contact_dynamics.contact_modes import Certainty, SpatialModeAnswer, contact_modes
from contact_modes.evidence import check_laws, spatial_problem
from oracles.equilibria_in_space import resting
from oracles.modes_of_two_bodies import Bodies, all_modes
from sweeps import seeds

AT_REST = BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0])
BODY = MassProperties(mass=2.0, I_B=np.diag([0.3, 0.4, 0.5]))
BOX = MassProperties(mass=1.0, I_B=np.diag([0.0043, 0.0043, 0.0053]))
STRAIGHT = 1e-8  # rad, of friction to the way against sliding


def check(problem: SpatialContactProblem) -> SpatialModeAnswer:
    """Check that modes obey the laws, and that the verdict tells of others that may not."""
    answer = contact_modes(problem)
    for mode in answer.modes:
        assert mode.misdirection <= STRAIGHT
        check_laws(problem, mode, answer.flush_within)
    assert (answer.verdict == ModeVerdict.UNDECIDED) == bool(answer.undecided)
    assert answer.undecided or not answer.undecided_modes
    return answer


def turned_feet(seed: int) -> SpatialContactProblem:
    """Return a box that turns on 4 to 12 feet, which can share its load in many ways."""
    chance = np.random.default_rng(seed)
    n = int(chance.integers(4, 13))
    angles = 2.0 * np.pi * np.arange(n) / n + 0.3
    return spatial_problem(
        BOX,
        AT_REST,
        ContactSet(
            p_WC_W=np.column_stack([0.1 * np.cos(angles), 0.1 * np.sin(angles), np.full(n, -0.1)]),
            normals_W=[0.0, 0.0, 1.0],
            frictions=0.3,
        ),
        chance.normal(size=3) * [3.0, 3.0, 0.0] - [0.0, 0.0, 9.8],
        chance.normal(size=3) * [0.05, 0.05, 1.0],
    )


def pivoting(seed: int) -> SpatialContactProblem:
    """Return a body that turns about an axis with two contacts at rest, and slides at a third."""
    chance = np.random.default_rng(seed)
    centre, w = chance.normal(size=3), chance.normal(size=3)
    points = centre + np.array([w * chance.normal(), w * chance.normal(), chance.normal(size=3)])
    normals = np.array(
        [chance.normal(size=3), chance.normal(size=3), centre + w * chance.normal() - points[2]]
    )
    return spatial_problem(
        BODY,
        BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0], v_WB_W=-np.cross(w, centre), w_WB_W=w),
        ContactSet(
            p_WC_W=points,
            normals_W=normals / np.linalg.norm(normals, axis=1)[:, None],
            frictions=chance.choice([0.3, 1.0], size=3),
        ),
        5.0 * chance.normal(size=3),
    )


def degenerate(seed: int) -> SpatialContactProblem:
    """Return a body at rest by construction, with contacts that are nearly the same."""
    case = resting(seed)
    contacts = ContactSet(p_WC_W=case.points, normals_W=case.normals, frictions=case.frictions)
    return spatial_problem(BODY, AT_REST, contacts, case.wrench[:3], case.wrench[3:])


def test_feet_that_share_a_load_in_many_ways_have_friction_straight_against_their_sliding() -> None:
    answers = [check(turned_feet(seed)) for seed in range(30)]
    shared = [mode for one in answers for mode in one.modes if not mode.motion_unique]
    assert len(shared) > 20
    assert not any(one.verdict == ModeVerdict.UNDECIDED for one in answers)


def test_a_box_that_just_slides_has_one_mode_although_its_feet_share_the_load() -> None:
    # Friction of the pyramids is short by up to 3e-4 here, more than what accelerates the box.
    feet = ContactSet(
        p_WC_W=[(x, y, -0.1) for x in (-0.1, 0.1) for y in (-0.1, 0.1)],
        normals_W=[0.0, 0.0, 1.0],
        frictions=0.5,
    )
    push = 5.0 * (1.0 + 1e-5) * np.array([np.cos(0.5), np.sin(0.5)])
    problem = spatial_problem(
        BODY, AT_REST, feet, (*push, -10.0), (-0.1 * push[1], 0.1 * push[0], 0.0), friction_facets=5
    )
    answer = check(problem)
    assert (answer.verdict, [mode.mode for mode in answer.modes]) == (ModeVerdict.UNIQUE, ["cccc"])
    assert np.linalg.norm(answer.modes[0].acceleration_W) == pytest.approx(2.5e-5, rel=1e-6)


@pytest.mark.parametrize("make", [turned_feet, pivoting, degenerate])
@seeds(range(20), slow=range(20, 1000))
def test_modes_obey_the_laws(make: Callable[[int], SpatialContactProblem], seed: int) -> None:
    check(make(seed))


@pytest.mark.parametrize("seed", [775, 1306])
def test_contacts_in_line_or_pinched_are_straight_or_undecided(seed: int) -> None:
    check(degenerate(seed))


ALIKE = 1e-6  # relative: accelerations of the directions that Newton's method finds


@seeds(range(40), slow=range(40, 10_000))
def test_one_contact_has_the_modes_of_its_round_cone(seed: int) -> None:
    chance = np.random.default_rng(seed)
    sizes = chance.uniform(0.05, 1.0, size=3)
    inertia = np.diag(0.5 * (sizes.sum() - sizes)) * 10.0 ** chance.uniform(-2.0, 1.0)
    r = chance.normal(size=3) * 10.0 ** chance.uniform(-1.0, 0.5)
    normal = 0.3 * chance.normal(size=3) + [0.0, 0.0, 1.0]
    normal /= np.linalg.norm(normal)
    friction = float(10.0 ** chance.uniform(-1.0, 0.7))
    wrench = np.concatenate([5.0 * chance.normal(size=3) - [0.0, 0.0, 8.0], np.zeros(3)])
    wrench[3:] = chance.normal(size=3) * chance.choice([0.0, 1.0])
    answer = contact_modes(
        spatial_problem(
            MassProperties(mass=1.0, I_B=inertia),
            AT_REST,
            ContactSet(p_WC_W=[r], normals_W=[normal], frictions=friction),
            wrench[:3],
            wrench[3:],
        )
    )
    none = np.zeros((1, 3))
    expected = all_modes(
        Bodies(
            masses=np.ones(1),
            inertias=inertia[None],
            centres=none,
            v=none,
            w=none,
            forces=wrench[None, :3],
            torques=wrench[None, 3:],
            points=r[None],
            normals=normal[None],
            frictions=np.array([friction]),
            pairs=[(0, None)],
        )
    )
    assert expected.clear or seed >= 40
    if not expected.clear:
        return
    assert sorted(mode.mode for mode in answer.modes) == sorted(mode.letters for mode in expected.modes)
    for letter, _, motion in expected.modes:
        found = [one.contact_accelerations_W for one in answer.modes if one.mode == letter]
        assert min(np.abs(one - motion).max() for one in found) <= ALIKE * (1.0 + np.abs(motion).max())
    assert all(mode.misdirection <= STRAIGHT for mode in answer.modes)


@pytest.mark.parametrize("heading", [0.1, 0.39, 1.0, 2.2])
@pytest.mark.parametrize(("share", "mode"), [(1.0 - 1e-7, "ffff"), (1.0 + 1e-6, "cccc")])
def test_a_box_sticks_up_to_the_angle_of_friction_in_any_direction(
    heading: float, share: float, mode: str
) -> None:
    # Its own pyramids lean against the push. A torque turns each of them away from it.
    feet = np.array([[x, y, 0.0] for x in (-0.1, 0.1) for y in (-0.1, 0.1)])
    push = share * 0.5 * 9.8
    problem = spatial_problem(
        MassProperties(mass=1.0, I_B=np.diag([0.0043, 0.0043, 0.0053])),
        AT_REST,
        ContactSet(p_WC_W=feet, normals_W=[0.0, 0.0, 1.0], frictions=0.5),
        (push * math.cos(heading), push * math.sin(heading), -9.8),
        friction_facets=5,
    )
    answer = contact_modes(problem)
    assert [one.mode for one in answer.modes] == [mode]
    holds = statics(problem).equilibrium
    assert holds == (Certainty.CERTAIN if mode == "ffff" else Certainty.NO)
