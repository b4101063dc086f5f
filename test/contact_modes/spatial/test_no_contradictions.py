# SPDX-License-Identifier: Apache-2.0
"""Modes, statics, margins and wrench sets of one question in space, which never contradict each other."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact_modes import (
    BodyStatics,
    Certainty,
    ModeVerdict,
    SpatialContactProblem,
    SpatialModeAnswer,
    contact_modes,
    mode_margins,
    statics,
    wrench_sets,
)
from contact_dynamics.errors import TooLargeError, UndecidedError
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_modes.evidence import spatial_problem
from oracles.equilibria_in_space import KINDS, resting
from sweeps import seeds

AT_REST = BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0])
BODY = MassProperties(mass=2.0, I_B=np.diag([0.3, 0.4, 0.5]))
FLOOR = [(x, y, -0.1) for x in (-0.1, 0.1) for y in (-0.1, 0.1)]
HELD = 1e-9  # relative to the load: what counts as balanced
SLIPPING = 1e-12  # relative to the load: a hundred times the rounding of an acceleration of a body that stays
ALIKE = 1e-5  # relative to the load: two computations of one distance, from hulls of nearly the same points


class Draw(NamedTuple):
    """A problem, and whether its load was made of forces inside of the friction cones."""

    problem: SpatialContactProblem
    rests: bool


def drawn(seed: int) -> Draw:
    """Return a problem: degenerate, on the border of what friction holds, or drawn at random."""
    chance = np.random.default_rng(seed)
    kind = seed % 3
    if kind == 0:
        case = resting(int(chance.integers(10_000)))
        points, normals, frictions, wrench = case.points, case.normals, case.frictions, case.wrench
    elif kind == 1:  # a box that is pushed with all its friction, more or less
        points, normals = np.array(FLOOR), np.tile([0.0, 0.0, 1.0], (4, 1))
        frictions = np.full(4, 0.5)
        share = 1.0 + float(chance.choice([-1.0, 0.0, 1.0]) * 10.0 ** chance.uniform(-15.0, -3.0))
        heading = chance.uniform(0.0, 2.0 * math.pi)
        push = 5.0 * share * np.array([math.cos(heading), math.sin(heading)])
        wrench = np.array([*push, -10.0, -0.1 * push[1], 0.1 * push[0], 0.0])
    else:
        n = int(chance.integers(2, 5))
        points, normals = chance.normal(size=(n, 3)), chance.normal(size=(n, 3))
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        frictions, wrench = chance.choice([0.0, 0.3, 1.0, 3.0], size=n), chance.normal(size=6)
    problem = spatial_problem(
        BODY,
        AT_REST,
        ContactSet(p_WC_W=points, normals_W=normals, frictions=frictions),
        wrench[:3],
        wrench[3:],
        friction_facets=4,
    )
    return Draw(problem, rests=kind == 0)


def at_rest(answer: SpatialModeAnswer, problem: SpatialContactProblem) -> bool:
    """Whether a mode has no acceleration at all. It then has one letter, because no contact moves."""
    load = float(np.abs(problem.wrench_W).max())
    return any(
        set(mode.mode) == {"f"}
        and max(np.abs(mode.acceleration_W).max(), np.abs(mode.angular_acceleration_W).max()) <= HELD * load
        for mode in answer.modes
    )


def slowest(answer: SpatialModeAnswer, problem: SpatialContactProblem) -> float:
    """Return the least acceleration of all modes, relative to the load. It is infinite without modes."""
    load = float(np.abs(problem.wrench_W).max())
    sizes = [np.abs([mode.acceleration_W, mode.angular_acceleration_W]).max() for mode in answer.modes]
    return float(min(sizes, default=math.inf)) / load


def has_one_motion(problem: SpatialContactProblem) -> bool:
    """Whether contacts that stick keep the body from moving."""
    rough = problem.contacts.frictions > 0.0
    rows = [np.hstack([np.eye(3), -cross(p)]) for p in problem.contacts.p_WC_W[rough]]
    sizes = np.linalg.svd(np.vstack([np.zeros((6, 6)), *rows]), compute_uv=False)
    return bool(sizes[5] > 0.01 * sizes[0])


def cross(p: np.ndarray) -> np.ndarray:
    return np.array([[0.0, -p[2], p[1]], [p[2], 0.0, -p[0]], [-p[1], p[0], 0.0]])


def check_modes_and_statics(answer: SpatialModeAnswer, held: BodyStatics, draw: Draw) -> None:
    problem = draw.problem
    assert answer.verdict != ModeVerdict.INCONSISTENT or not draw.rests
    assert not (draw.rests and held.equilibrium == Certainty.NO)
    if held.equilibrium == Certainty.NO:
        assert slowest(answer, problem) > SLIPPING
        assert (held.jammed, math.isnan(held.stable_disturbance)) == (Certainty.NO, True)
        return
    assert at_rest(answer, problem)
    assert held.stable_disturbance >= 0.0
    assert held.jammed in {Certainty.NO, Certainty.UNKNOWN, held.equilibrium}
    if held.equilibrium == Certainty.CERTAIN:
        assert (answer.verdict, len(answer.modes)) == (ModeVerdict.UNIQUE, 1)
    else:  # statics stop at a second mode, and may not take one that is none
        alone = answer.verdict == ModeVerdict.UNIQUE and answer.modes[0].motion_unique
        assert not alone
    if math.isinf(held.stable_disturbance):
        assert held.wedged


def check_disturbance(held: BodyStatics, problem: SpatialContactProblem, seed: int) -> None:
    """Check that the body can stay under changes of the wrench that it is said to take."""
    way = np.random.default_rng(seed).normal(size=6)
    room = min(held.stable_disturbance, 10.0 * float(np.linalg.norm(problem.wrench_W)))
    length = held.margin_length
    change = 0.999 * room * way / np.linalg.norm(way) * [1.0, 1.0, 1.0, length, length, length]
    moved = replace(problem, force_W=problem.force_W + change[:3], torque_W=problem.torque_W + change[3:])
    assert statics(moved).equilibrium != Certainty.NO


def check(draw: Draw, seed: int) -> str:
    """Check one draw, and return what was undecided."""
    problem = draw.problem
    n = len(problem.contacts)
    answer = contact_modes(problem)
    try:
        held = statics(problem)
    except UndecidedError:
        return "statics"
    check_modes_and_statics(answer, held, draw)
    if held.stable_disturbance > 0.0:
        check_disturbance(held, problem, seed)
    letters = [mode.mode for mode in answer.modes]
    load = float(np.linalg.norm(problem.wrench_W))
    try:
        margins = mode_margins(problem, answer)
        (still,) = wrench_sets(problem, modes=["f" * n]) if np.all(problem.contacts.frictions) else (None,)
    except (UndecidedError, TooLargeError):
        return "margins or sets"
    assert [margin.mode for margin in margins] == letters
    assert not any(margin.margin < 0.0 for margin in margins)
    if still is not None:
        depth = still.depth(problem.wrench_W, held.margin_length)
        if depth > ALIKE * load:
            assert "f" * n in letters
            if has_one_motion(problem):
                assert held.equilibrium != Certainty.NO
                if held.stable_disturbance > 0.0:
                    assert depth == pytest.approx(held.stable_disturbance, rel=ALIKE, abs=ALIKE * load)
        for margin in margins:
            if margin.mode == "f" * n:  # in round cones, which reach further than pyramids inside them
                assert margin.margin >= depth - ALIKE * load
    return ""


def test_answers_do_not_contradict_each_other() -> None:
    undecided = [check(drawn(seed), seed) for seed in range(6)]
    assert undecided.count("") >= 2


def test_a_box_slips_by_what_friction_does_not_hold() -> None:
    """The push is larger than friction by 2.6e-9 of it. The box slides, and rounds to 1e-15 of the push."""
    problem = drawn(586).problem
    excess = math.hypot(*problem.force_W[:2]) - 5.0
    answer = contact_modes(problem)
    assert [mode.mode for mode in answer.modes] == ["cccc"]
    assert statics(problem).equilibrium == Certainty.NO
    assert np.linalg.norm(answer.modes[0].acceleration_W) == pytest.approx(
        excess / BODY.mass, rel=0.0, abs=1e-14
    )


@pytest.mark.parametrize("seed", [18, 189, 708])
def test_a_body_rests_on_contacts_that_are_nearly_one(seed: int) -> None:
    """Its forces left 1e-9 to 5e-7 of the load, where other forces in the cones leave rounding.

    The contacts are a micrometre apart, or those of draw 708 four nanometres.
    """
    problem = drawn(seed).problem
    assert at_rest(contact_modes(problem), problem)


@pytest.mark.slow
@pytest.mark.parametrize("block", range(60))
def test_hundreds_of_answers_do_not_contradict_each_other(block: int) -> None:
    undecided = [check(drawn(seed), seed) for seed in range(20 * block, 20 * block + 20)]
    assert undecided.count("") >= 10


@seeds(range(len(KINDS)))
def test_statics_do_not_depend_on_the_order_of_contacts(seed: int) -> None:
    problem = drawn(3 * seed).problem
    order = np.random.default_rng(seed).permutation(len(problem.contacts))
    contacts = ContactSet(
        p_WC_W=problem.contacts.p_WC_W[order],
        normals_W=problem.contacts.normals_W[order],
        frictions=problem.contacts.frictions[order],
    )
    before, after = statics(problem), statics(replace(problem, contacts=contacts))
    assert (after.equilibrium, after.jammed, after.wedged) == (
        before.equilibrium,
        before.jammed,
        before.wedged,
    )
