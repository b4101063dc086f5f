# SPDX-License-Identifier: Apache-2.0
"""Coulomb's round cones in space: one contact against an independent solution, several against themselves."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact_dynamics import BodyState, ContactSet, MassProperties, statics
from contact_dynamics.contact_modes import Certainty, contact_modes
from contact_modes.evidence import spatial_problem
from oracles.modes_of_two_bodies import Bodies, all_modes
from sweeps import seeds

AT_REST = BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0])
STRAIGHT = 1e-8  # rad, of friction to the way against sliding
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
