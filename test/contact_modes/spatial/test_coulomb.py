# SPDX-License-Identifier: Apache-2.0
"""Every mode of an answer obeys Newton's and Coulomb's laws, or the verdict says that it may not."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact_modes import (
    ModeVerdict,
    SpatialContactProblem,
    SpatialMode,
    SpatialModeAnswer,
    contact_modes,
)
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_modes.evidence import spatial_problem
from oracles.equilibria_in_space import resting
from sweeps import seeds

AT_REST = BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0])
BODY = MassProperties(mass=2.0, I_B=np.diag([0.3, 0.4, 0.5]))
BOX = MassProperties(mass=1.0, I_B=np.diag([0.0043, 0.0043, 0.0053]))
STRAIGHT = 1e-8  # rad, of friction to the way against sliding
SMALL = 1e-8  # relative to the forces, and to the accelerations that they would cause alone


def check_laws(problem: SpatialContactProblem, mode: SpatialMode, flush_within: float) -> None:
    """Check a mode of a body in world axes against the equations, from scratch.

    Modes of contacts that are taken as flush miss those of the given contacts by as much as these differ.
    """
    small = max(SMALL, flush_within)
    body, contacts, state = problem.body, problem.contacts, problem.state
    forces, arms, w = mode.contact_forces_W, contacts.p_WC_W - state.p_WB_W, state.w_WB_W
    size = float(np.abs(forces).max(initial=0.0)) + float(np.abs(problem.wrench_W).max())
    reach = float(np.linalg.norm(arms, axis=1).max())
    fast = size * (1.0 / body.mass + (reach + reach**2) / float(np.diag(body.I_B).min()))
    force = problem.force_W + forces.sum(axis=0)
    torque = problem.torque_W + np.cross(arms, forces).sum(axis=0) - np.cross(w, body.I_B @ w)
    assert np.abs(body.mass * mode.acceleration_W - force).max() <= small * size
    assert np.abs(body.I_B @ mode.angular_acceleration_W - torque).max() <= small * size * (1.0 + reach)
    accelerations = mode.acceleration_W + np.cross(mode.angular_acceleration_W, arms)
    accelerations += np.cross(w, np.cross(w, arms))
    velocities = state.velocity_of_point(contacts.p_WC_W)
    for i, letter in enumerate(mode.mode):
        normal, friction = contacts.normals_W[i], float(contacts.frictions[i])
        pressing, rising = float(forces[i] @ normal), float(accelerations[i] @ normal)
        across = forces[i] - pressing * normal
        speed = velocities[i] - float(velocities[i] @ normal) * normal
        way = speed if np.linalg.norm(speed) > 1e-9 else accelerations[i] - rising * normal
        if letter == "s":
            assert np.abs(forces[i]).max() == 0.0
            assert rising > 0.0 or velocities[i] @ normal > 0.0
            continue
        assert pressing >= -small * size
        assert abs(rising) <= small * fast
        assert np.linalg.norm(across) <= friction * pressing + small * size
        if letter == "f":
            assert np.linalg.norm(way) <= small * fast
        else:
            straight = -friction * pressing * way / np.linalg.norm(way)
            assert np.abs(across - straight).max() <= small * size * max(1.0, friction)


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
