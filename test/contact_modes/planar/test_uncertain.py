# SPDX-License-Identifier: Apache-2.0
"""Verdicts within an uncertainty of contacts: proofs against samples, margins against closed forms."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import replace

import pytest

from contact_dynamics.contact import ContactUncertainty
from contact_dynamics.contact_modes import ModeVerdict, PlanarContactProblem, contact_modes, geometry_margins
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarWrench
from contact_modes.evidence import check_proofs

BLOCK = PlanarBody(mass=2.0, inertia=0.033)
FRICTION = 0.5
WEIGHT = 19.6


def on_feet(push: float, *places: float, **fields: ContactUncertainty) -> PlanarContactProblem:
    feet = [PlanarContact(r=(x, -0.1), normal=(0.0, 1.0), friction=FRICTION) for x in places]
    wrench = PlanarWrench(f=(push, -WEIGHT))
    return PlanarContactProblem(body=BLOCK, contacts=feet, wrench=wrench, **fields)


def drawn(chance: random.Random) -> PlanarContactProblem:
    """Return one to three contacts anywhere, or feet on a floor, under any load."""
    body = PlanarBody(mass=1.0, inertia=10.0 ** chance.uniform(-1.0, 1.0))
    on_floor = chance.random() < 0.5
    contacts = []
    for _ in range(chance.choice([1, 2, 2, 3])):
        x, y = chance.uniform(-1.0, 1.0), -1.0 if on_floor else chance.uniform(-1.0, 1.0)
        angle = 0.5 * math.pi if on_floor else chance.uniform(-3.2, 3.2)
        contacts.append(
            PlanarContact(
                r=(x, y), normal=(math.cos(angle), math.sin(angle)), friction=chance.uniform(0.0, 1.5)
            )
        )
    wrench = PlanarWrench(
        f=(chance.uniform(-5.0, 5.0), chance.uniform(-10.0, 1.0)), moment=chance.uniform(-1.0, 1.0)
    )
    return PlanarContactProblem(body=body, contacts=contacts, wrench=wrench)


def moved(
    problem: PlanarContactProblem, box: ContactUncertainty, chance: random.Random
) -> PlanarContactProblem:
    """Return a problem in the box: at its corners, or anywhere in it."""
    contacts = []
    for one in problem.contacts:
        share = [chance.choice([-1.0, 1.0, chance.uniform(-1.0, 1.0)]) for _ in range(3)]
        way, turn = chance.uniform(-math.pi, math.pi), share[1] * box.normals
        angle = math.atan2(one.normal[1], one.normal[0]) + turn
        step = share[0] * box.points
        contacts.append(
            replace(
                one,
                r=(one.r[0] + step * math.cos(way), one.r[1] + step * math.sin(way)),
                normal=(math.cos(angle), math.sin(angle)),
                friction=max(0.0, one.friction + share[2] * box.frictions),
            )
        )
    return replace(problem, contacts=contacts, uncertainty=ContactUncertainty())


def boxed(seed: int) -> tuple[PlanarContactProblem, Callable[[], PlanarContactProblem]]:
    """Return a problem with an uncertainty, and what draws problems within it."""
    chance = random.Random(seed)
    box = ContactUncertainty(
        points=10.0 ** chance.uniform(-6.0, -1.0),
        normals=10.0 ** chance.uniform(-6.0, -1.0),
        frictions=chance.choice([0.0, 10.0 ** chance.uniform(-4.0, -1.0)]),
    )
    problem = replace(drawn(chance), uncertainty=box)
    return problem, lambda: moved(problem, box, chance)


def test_what_is_certain_holds_at_every_sample() -> None:
    assert 6 <= check_proofs(map(boxed, range(24)), samples=30) <= 20


@pytest.mark.slow
@pytest.mark.parametrize("block", range(20))
def test_what_is_certain_holds_at_many_samples(block: int) -> None:
    assert check_proofs(map(boxed, range(1000 + 50 * block, 1050 + 50 * block)), samples=200) > 0


@pytest.mark.parametrize("push", [0.0, 9.0, 12.0])
def test_a_block_is_sure_of_its_mode_within_a_tenth_of_a_milliradian(push: float) -> None:
    box = ContactUncertainty(points=1e-5, normals=1e-4, frictions=1e-3)
    answer = contact_modes(on_feet(push, -0.2, 0.2, uncertainty=box))
    assert answer.within is not None
    assert answer.within.certain
    assert answer.within.verdicts == (ModeVerdict.UNIQUE,)
    assert answer.within.modes == (answer.modes[0].mode,)


def test_a_rod_whose_answer_hangs_on_its_wall_has_other_verdicts_nearby() -> None:
    """The lecture's rod, pulled exactly along the wall, slides without force. Turned, it leaves or wedges."""
    theta = math.radians(75.0)
    tip = PlanarContact(
        r=(-4.0 * math.cos(theta), -4.0 * math.sin(theta)),
        normal=(0.0, 1.0),
        friction=math.tan(math.pi / 6.0),
    )
    problem = PlanarContactProblem(
        body=PlanarBody(mass=1.0, inertia=1.0),
        contacts=[tip],
        wrench=PlanarWrench(f=(-1.0, 0.0)),
        uncertainty=ContactUncertainty(normals=1e-3),
    )
    within = contact_modes(problem).within
    assert within is not None
    assert not within.certain
    assert len(within.verdicts) > 1
    assert within.verdicts[0] == ModeVerdict.INDETERMINATE


def test_two_modes_that_hold_everywhere_leave_the_verdict_indeterminate() -> None:
    theta = math.radians(75.0)
    tip = PlanarContact(r=(-4.0 * math.cos(theta), -4.0 * math.sin(theta)), normal=(0.0, 1.0), friction=0.8)
    problem = PlanarContactProblem(
        body=PlanarBody(mass=1.0, inertia=1.0),
        contacts=[tip],
        wrench=PlanarWrench(f=(-1.0, 0.05)),
        uncertainty=ContactUncertainty(points=1e-3, normals=1e-3, frictions=1e-3),
    )
    answer = contact_modes(problem)
    assert {mode.mode for mode in answer.modes} == {"s", "l", "f"}
    assert answer.within is not None
    assert answer.within.certain


def test_margins_bracket_the_angle_and_the_friction_at_which_a_block_slips() -> None:
    """It slips where the floor turns by atan(mu) - atan(push / weight), or mu falls to push / weight."""
    push = 9.0
    points, normals, frictions = geometry_margins(on_feet(push, -0.2, 0.2))
    assert [points.kind, normals.kind, frictions.kind] == ["points", "normals", "frictions"]
    angle = math.atan(FRICTION) - math.atan(push / WEIGHT)
    assert 0.2 * angle < normals.holds_within <= angle <= normals.changes_at < 1.5 * angle
    assert normals.modes_beyond == ("rr",)
    lost = FRICTION - push / WEIGHT
    assert lost / 1.5 < frictions.holds_within <= lost <= frictions.changes_at < 1.6 * lost
    assert 0.0 < points.holds_within < points.changes_at


def test_feet_in_a_row_may_slide_in_many_ways_if_the_row_is_not_exact() -> None:
    """Three feet slide together only if they are exactly in a row."""
    within = contact_modes(on_feet(12.0, -0.2, 0.0, 0.2, uncertainty=ContactUncertainty(normals=1e-7))).within
    assert within is not None
    assert not within.certain
    assert "rrr" in within.modes
    assert len(within.modes) > 1
