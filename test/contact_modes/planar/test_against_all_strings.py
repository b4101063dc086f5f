# SPDX-License-Identifier: Apache-2.0
"""The enumeration and every verdict beside an exact trial of all 4^n strings (`oracles.contact_modes`)."""

from __future__ import annotations

import random

import pytest

from contact_dynamics.contact_modes import ModeVerdict, PlanarModeAnswer, contact_modes
from contact_dynamics.contact_modes.planar import cone
from contact_dynamics.contact_modes.planar import wrench_cone as edges
from contact_modes.evidence import check_evidence, planar_problem
from oracles.contact_mode_cases import FloatCase, contact, draw, resting, rounded, with_static_friction
from oracles.contact_modes import ExactCase, consistent_modes, kinematic_modes, uniqueness
from sweeps import seeds

QUICK = range(90)

DEGENERATE = {
    "one contact twice": resting(contact(1, -1), contact(1, -1)),
    "one point, two frictions": resting(contact(1, -1), contact(1, -1, friction="2"), force=(3, -1)),
    "slot": resting(contact(0, 1, (0, -1)), contact(0, -1, (0, 1)), force=(1, 0)),
    "slot, offset": resting(contact(1, 1, (0, -1)), contact(-1, -1, (0, 1)), force=(1, 0), moment=1),
    "slot, three": resting(contact(1, 1, (0, -1)), contact(-1, -1, (0, 1)), contact(2, -1), force=(1, 0)),
    "three feet": resting(contact(-1, -1), contact(0, -1), contact(1, -1)),
    "four feet, pushed": resting(*(contact(x, -1) for x in (-2, -1, 1, 2)), force=(2, -1)),
    "feet of unequal friction": resting(
        contact(-1, -1, friction="0"), contact(0, -1, friction="1"), contact(1, -1), force=(2, -1)
    ),
    "frictionless box": resting(
        *(
            contact(x, y, n, "0")
            for x, y, n in ((1, 0, (-1, 0)), (-1, 0, (1, 0)), (0, 1, (0, -1)), (0, -1, (0, 1)))
        )
    ),
    "caged with friction": resting(
        *(
            contact(x, y, n, "1")
            for x, y, n in ((1, 0, (-1, 0)), (-1, 0, (1, 0)), (0, 1, (0, -1)), (0, -1, (0, 1)))
        )
    ),
    "collinear normals": resting(contact(0, -1), contact(0, -2), contact(0, 1, (0, -1))),
    "corner": resting(contact(-1, -1), contact(-1, -1, (1, 0)), force=(-1, -1)),
    "flush in a corner": resting(
        contact(-1, -1), contact(1, -1), contact(-1, -1, (1, 0)), contact(-1, 1, (1, 0)), force=(-1, -1)
    ),
    "no wrench at all": resting(contact(-1, -1), contact(1, -1), force=(0, 0)),
    "touching at the centre of mass": resting(contact(0, 0), contact(0, 0, (3, 4)), force=(0, -1), moment=1),
    "contact along the line of action": resting(contact(0, -3, (0, 1), "0"), force=(0, -1)),
}


def ask(case: FloatCase) -> PlanarModeAnswer:
    body, velocity, contacts, wrench = case
    return contact_modes(planar_problem(body, velocity, contacts, wrench))


def compare(exact: ExactCase, case: FloatCase) -> PlanarModeAnswer:
    kinematic = kinematic_modes(exact)
    answer = ask(case)
    assert set(answer.kinematic_modes) == kinematic
    assert len(answer.kinematic_modes) == len(kinematic)
    assert {mode.mode for mode in answer.modes} == consistent_modes(exact, kinematic)
    check_evidence(answer, *case)
    return answer


@pytest.mark.parametrize("name", DEGENERATE)
def test_degenerate_sets_made_by_hand(name: str) -> None:
    exact = DEGENERATE[name]
    answer = compare(exact, rounded(exact))
    for mode in answer.modes:
        assert (mode.forces_unique, mode.motion_unique) == uniqueness(exact, mode.mode)
    # The same case turned: now every number is rounded.
    compare(exact, rounded(exact, angle=0.3))


@seeds(range(1000, 1016), slow=range(1016, 1040))
def test_drawn_sets_turned_and_in_other_units(seed: int) -> None:
    exact = draw(seed, most_contacts=4)
    chance = random.Random(seed)
    compare(
        exact,
        rounded(
            exact,
            angle=chance.uniform(0.0, 7.0),
            length=10.0 ** chance.uniform(-3.0, 3.0),
            mass=10.0 ** chance.uniform(-3.0, 3.0),
            time=10.0 ** chance.uniform(-2.0, 2.0),
        ),
    )


@seeds(range(2000, 2030))
def test_drawn_sets_by_the_arrays_that_large_ones_need(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cone, "MANY", 3)
    monkeypatch.setattr(edges, "MANY", 0)
    exact = draw(seed, most_contacts=4)
    compare(exact, rounded(exact, angle=0.3))


@seeds(QUICK, slow=range(20_000, 22_000))
def test_drawn_sets_with_static_friction(seed: int) -> None:
    exact = with_static_friction(draw(seed, most_contacts=4), seed)
    answer = compare(exact, rounded(exact, angle=0.3))
    for mode in answer.modes:
        assert (mode.forces_unique, mode.motion_unique) == uniqueness(exact, mode.mode)


def test_static_friction_makes_more_drawn_sets_indeterminate() -> None:
    found = [draw(seed, most_contacts=4) for seed in QUICK]
    several = [
        [ask(rounded(one)).verdict == ModeVerdict.INDETERMINATE for one in cases]
        for cases in (
            found,
            [with_static_friction(one, seed) for seed, one in zip(QUICK, found, strict=True)],
        )
    ]
    assert sum(several[1]) > sum(several[0]) + 5


def test_the_draws_reach_every_kind_of_answer() -> None:
    answers = [ask(rounded(draw(seed, most_contacts=4))) for seed in QUICK]
    assert {answer.verdict for answer in answers} == {
        ModeVerdict.UNIQUE,
        ModeVerdict.INDETERMINATE,
        ModeVerdict.INCONSISTENT,
    }
    kinds = {(mode.forces_unique, mode.motion_unique) for answer in answers for mode in answer.modes}
    assert kinds == {(True, True), (False, True), (False, False)}
    refusals = {refused.refusal for answer in answers for refused in answer.refused}
    assert len(refusals) == 5
    assert any(answer.contact_velocities[0][0] != 0.0 for answer in answers)


@seeds(QUICK, slow=range(10_000, 13_000))
def test_many_drawn_sets(seed: int) -> None:
    exact = draw(seed, most_contacts=4 if seed in QUICK else 6)
    answer = compare(exact, rounded(exact))
    for mode in answer.modes:
        assert (mode.forces_unique, mode.motion_unique) == uniqueness(exact, mode.mode)
