# SPDX-License-Identifier: Apache-2.0
"""All questions of one planar problem answer alike: modes, statics, margins, wrench sets and refusals.

The problems are at random, degenerate, next to degeneracy and permuted.
"""

from __future__ import annotations

import math
import random
from dataclasses import replace

import pytest

from contact_dynamics import (
    ModeVerdict,
    PlanarBody,
    PlanarContact,
    PlanarContactProblem,
    PlanarWrench,
    mode_margins,
    statics,
)
from contact_dynamics.contact_modes import Certainty, PlanarModeAnswer, contact_modes, wrench_sets
from contact_dynamics.errors import UndecidedError

# Relative to the wrench and what forces it takes: wrenches as near as this to a boundary are on either side.
NEAR = 1e-7


def problem(seed: int) -> PlanarContactProblem:
    chance = random.Random(seed)
    body = PlanarBody(mass=1.0, inertia=10.0 ** chance.uniform(-1.0, 1.0))
    kind = chance.choice(["random", "degenerate", "near"])
    contacts: list[PlanarContact] = []
    for _ in range(chance.choice([1, 2, 2, 3, 4])):
        x, y, angle = chance.uniform(-1.0, 1.0), chance.uniform(-1.0, 1.0), chance.uniform(-3.2, 3.2)
        friction = chance.choice([0.0, 0.3, chance.uniform(0.0, 2.0)])
        if kind != "random":
            x, y = float(chance.randint(-1, 1)), float(chance.randint(-1, 1))
            angle = 0.5 * math.pi * chance.randint(0, 3)
        if kind == "near":
            x += 10.0 ** chance.uniform(-14.0, -3.0)
            angle += chance.choice([0.0, 10.0 ** chance.uniform(-14.0, -3.0)])
        contacts.append(PlanarContact(r=(x, y), normal=(math.cos(angle), math.sin(angle)), friction=friction))
    f_x, f_y, moment = (
        chance.choice([float(chance.randint(-1, 1)), chance.uniform(-1.0, 1.0)]) for _ in "123"
    )
    return PlanarContactProblem(
        body=body, contacts=contacts, wrench=PlanarWrench(f=(f_x, f_y), moment=moment)
    )


def permuted(one: PlanarContactProblem, seed: int) -> tuple[PlanarContactProblem, list[int]]:
    order = list(range(len(one.contacts)))
    random.Random(seed).shuffle(order)
    return replace(one, contacts=[one.contacts[i] for i in order]), order


def check_agreement(one: PlanarContactProblem) -> PlanarModeAnswer:
    answer = contact_modes(one)
    rho = one.body.radius_of_gyration
    load = math.hypot(*one.wrench.f, one.wrench.moment / rho)
    names = [mode.mode for mode in answer.modes]
    assert answer.verdict != ModeVerdict.INCONSISTENT  # a body at rest always has a consistent mode
    if answer.verdict == ModeVerdict.UNDECIDED:
        assert answer.undecided_modes
    else:
        assert answer.verdict == (ModeVerdict.UNIQUE if len(names) == 1 else ModeVerdict.INDETERMINATE)
    assert len(set(answer.kinematic_modes)) == len(names) + len(answer.refused) + len(answer.undecided_modes)

    sets = {found.mode: found for found in wrench_sets(one)}
    assert set(sets) == set(answer.kinematic_modes)
    for mode in answer.modes:
        assert sets[mode.mode].depth(one.wrench, rho) >= -NEAR * load
    for refused in answer.refused:
        # A refused mode is on the boundary of its wrenches, or outside.
        assert sets[refused.mode].depth(one.wrench, rho) <= NEAR * load or load == 0.0

    margins = mode_margins(one, answer)
    assert [margin.mode for margin in margins] == names
    for margin in margins:
        depth = sets[margin.mode].depth(one.wrench, rho)
        assert margin.margin == pytest.approx(max(0.0, depth), rel=1e-6, abs=NEAR * load)

    try:
        held = statics(one)
    except UndecidedError:
        assert "f" * len(one.contacts) in answer.undecided_modes
        return answer
    check_statics(one, answer, held.equilibrium, held.stable_disturbance, load)
    return answer


def check_statics(
    one: PlanarContactProblem, answer: PlanarModeAnswer, equilibrium: Certainty, room: float, load: float
) -> None:
    rho = one.body.radius_of_gyration
    resting = [mode for mode in answer.modes if set(mode.mode) <= {"f"}]
    if equilibrium == Certainty.NO:
        assert math.isnan(room)
        for mode in resting:
            assert math.hypot(*mode.acceleration, rho * mode.angular_acceleration) > 0.0
        return
    assert resting
    assert (equilibrium == Certainty.CERTAIN) == (answer.verdict == ModeVerdict.UNIQUE)
    if math.isinf(room):
        return
    # Every change of the wrench that statics allow leaves the body at rest possible.
    for k in range(8):
        way = (math.cos(k), math.sin(k) * math.cos(3.0 * k), math.sin(k) * math.sin(3.0 * k))
        x, y, z = (0.999 * room * part for part in way)
        changed = PlanarWrench(
            f=(one.wrench.f[0] + x, one.wrench.f[1] + y), moment=one.wrench.moment + z * rho
        )
        there = contact_modes(replace(one, wrench=changed))
        assert resting[0].mode not in {mode.mode for mode in there.refused} or room <= NEAR * load


@pytest.mark.parametrize("block", range(3))
def test_no_answer_contradicts_another(block: int) -> None:
    for seed in range(50 * block, 50 * block + 50):
        one = problem(seed)
        answer = check_agreement(one)
        other, order = permuted(one, seed)
        there = check_agreement(other)
        assert there.verdict == answer.verdict
        assert {"".join(mode.mode[i] for i in order) for mode in answer.modes} == {
            mode.mode for mode in there.modes
        }


@pytest.mark.parametrize("seed", [10433, 11076, 11412, 11809, 14278, 16841, 17279, 17876])
def test_what_once_contradicted_itself(seed: int) -> None:
    """The first four were inconsistent at rest. In the others a refused mode had the problem's own wrench."""
    check_agreement(problem(seed))


def test_a_body_turns_about_a_contact_at_its_centre_of_mass() -> None:
    feet = [
        PlanarContact(r=(x, 0.0), normal=(0.0, 1.0), friction=friction)
        for x, friction in ((1.0, 1.2), (0.0, 1.0))
    ]
    wrench = PlanarWrench(f=(-0.6, -0.7), moment=0.9)
    answer = contact_modes(
        PlanarContactProblem(body=PlanarBody(mass=1.0, inertia=0.2), contacts=feet, wrench=wrench)
    )
    assert [mode.mode for mode in answer.modes] == ["sf"]


@pytest.mark.slow
@pytest.mark.parametrize("block", range(40))
def test_no_answer_contradicts_another_in_many_problems(block: int) -> None:
    for seed in range(10_000 + 200 * block, 10_200 + 200 * block):
        check_agreement(problem(seed))
