# SPDX-License-Identifier: Apache-2.0
"""The map of modes over applied wrenches beside the modes themselves, and margins beside small pushes."""

from __future__ import annotations

import math
import random

import pytest

from contact_dynamics.contact_modes import (
    ModeVerdict,
    PlanarContactProblem,
    PlanarWrenchSet,
    contact_modes,
    mode_margins,
    wrench_sets,
)
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from contact_modes.evidence import planar_problem
from oracles.contact_mode_cases import draw, rounded
from sweeps import seeds

BODY = PlanarBody(mass=2.0, inertia=0.5)
AT_REST = PlanarVelocity(v=(0.0, 0.0), w=0.0)
BLOCK = [PlanarContact(r=(x, -1.0), normal=(0.0, 1.0), friction=0.5) for x in (-0.5, 0.5)]
WEIGHT = PlanarWrench(f=(0.0, -20.0))
CLEAR = 1e-6  # N: what is nearer to a boundary than this is left to the exact tests


def consistent(
    body: PlanarBody, velocity: PlanarVelocity, contacts: list[PlanarContact], wrench: PlanarWrench
) -> set[str]:
    answer = contact_modes(planar_problem(body, velocity, contacts, wrench))
    return {mode.mode for mode in answer.modes}


@seeds(range(60))
def test_the_map_says_what_the_modes_say(seed: int) -> None:
    body, velocity, contacts, _ = rounded(draw(seed, most_contacts=4))
    sets = wrench_sets(planar_problem(body, velocity, contacts, PlanarWrench(f=(0.0, 0.0))))
    if not sets:
        answer = contact_modes(planar_problem(body, velocity, contacts, PlanarWrench(f=(0.0, 0.0))))
        leaves = all(v_n > 0.0 for _, v_n in answer.contact_velocities)
        assert leaves or answer.kinematic_modes == ()
        return
    chance = random.Random(seed)
    for _ in range(8):
        wrench = PlanarWrench(
            f=(chance.uniform(-9.0, 9.0), chance.uniform(-9.0, 9.0)), moment=chance.uniform(-9.0, 9.0)
        )
        depths = {one.mode: one.depth(wrench, body.radius_of_gyration) for one in sets}
        if any(abs(depth) < CLEAR for depth in depths.values()):
            continue
        found = consistent(body, velocity, contacts, wrench)
        assert found == {mode for mode, depth in depths.items() if depth > 0.0}


def combination(one: PlanarWrenchSet, chance: random.Random) -> PlanarWrench:
    parts = [(wrench, chance.uniform(0.1, 1.0)) for wrench in one.generators]
    shares = [chance.uniform(0.1, 1.0) for _ in one.vertices]
    parts += [(vertex, share / sum(shares)) for vertex, share in zip(one.vertices, shares, strict=True)]
    return PlanarWrench(
        f=(sum(s * w.f[0] for w, s in parts), sum(s * w.f[1] for w, s in parts)),
        moment=sum(s * w.moment for w, s in parts),
    )


@seeds(range(60))
def test_what_the_generators_make_brings_the_mode_about(seed: int) -> None:
    body, velocity, contacts, _ = rounded(draw(seed, most_contacts=4))
    chance = random.Random(seed)
    for one in wrench_sets(planar_problem(body, velocity, contacts, PlanarWrench(f=(0.0, 0.0)))):
        assert one.mode in consistent(body, velocity, contacts, combination(one, chance))


def test_the_margin_of_a_resting_block_to_tipping_and_sliding() -> None:
    (fixed,) = mode_margins(planar_problem(BODY, AT_REST, BLOCK, WEIGHT), margin_length=1e3)
    # With a long length moments cost nothing: the block tips at half its width.
    assert fixed.mode == "ff"
    assert fixed.margin == pytest.approx(20.0 * 0.5 / 1e3, rel=1e-5)
    assert abs(fixed.change.moment) == pytest.approx(10.0, rel=1e-5)
    assert fixed.modes_beyond in {("fs",), ("sf",)}
    # With a short one they cost all: it slides at mu times the weight, at right angles to the cone's edge.
    low = [PlanarContact(r=(x, -1e-3), normal=(0.0, 1.0), friction=0.5) for x in (-0.5, 0.5)]
    (sliding,) = mode_margins(planar_problem(BODY, AT_REST, low, WEIGHT), margin_length=1e-3)
    assert sliding.margin == pytest.approx(20.0 * 0.5 / math.sqrt(1.0 + 0.25), rel=1e-4)
    assert sliding.verdict_beyond == ModeVerdict.UNIQUE
    assert sliding.modes_beyond in {("ll",), ("rr",)}


@seeds(range(300, 380))
def test_the_margin_is_the_least_change_and_just_beyond_it_are_the_modes_that_it_tells(seed: int) -> None:
    body, velocity, contacts, wrench = rounded(draw(seed, most_contacts=4))
    chance = random.Random(seed)
    length = body.radius_of_gyration * chance.choice([0.1, 1.0, 10.0])
    size = math.hypot(*wrench.f, wrench.moment / length)

    def pushed(way: list[float]) -> PlanarWrench:
        x, y, moment = way
        return PlanarWrench(f=(wrench.f[0] + x, wrench.f[1] + y), moment=wrench.moment + moment)

    for margin in mode_margins(planar_problem(body, velocity, contacts, wrench), margin_length=length):
        change = [*margin.change.f, margin.change.moment]
        if math.isinf(margin.margin):
            assert change == [0.0, 0.0, 0.0]
            continue
        assert math.hypot(*change[:2], change[2] / length) == pytest.approx(
            margin.margin, rel=1e-9, abs=1e-12
        )
        assert margin.mode not in margin.modes_beyond
        if margin.margin <= 1e-5 * size:
            continue
        largest = max(size, margin.margin)
        inside, outside = (
            pushed([part * (1.0 + step * largest / margin.margin) for part in change])
            for step in (-1e-7, 1e-5)
        )
        assert margin.mode in consistent(body, velocity, contacts, inside)
        assert set(margin.modes_beyond) == consistent(body, velocity, contacts, outside)
        for _ in range(5):  # no smaller change ends it
            way = [chance.gauss(0.0, 1.0) for _ in range(3)]
            scale = 0.999 * margin.margin / math.hypot(*way)
            smaller = pushed([scale * way[0], scale * way[1], scale * way[2] * length])
            assert margin.mode in consistent(body, velocity, contacts, smaller)


def test_a_wrench_in_a_tray_has_modes_like_rsrs() -> None:
    # Two points on the floor, one at either wall, the right one higher: turning lifts the right-hand side.
    tray = [
        PlanarContact(r=(-1.0, -0.2), normal=(0.0, 1.0), friction=0.25),
        PlanarContact(r=(1.0, -0.2), normal=(0.0, 1.0), friction=0.25),
        PlanarContact(r=(-1.2, 0.2), normal=(1.0, 0.0), friction=0.25),
        PlanarContact(r=(1.2, 0.4), normal=(-1.0, 0.0), friction=0.25),
    ]
    sets = {
        one.mode: one
        for one in wrench_sets(
            PlanarContactProblem(body=BODY, contacts=tray, wrench=PlanarWrench(f=(0.0, 0.0)))
        )
    }
    assert "ffff" in sets
    assert "rsrs" in sets
    chance = random.Random(0)
    wrench = combination(sets["rsrs"], chance)
    answer = contact_modes(planar_problem(BODY, AT_REST, tray, wrench))
    mode = next(mode for mode in answer.modes if mode.mode == "rsrs")
    assert mode.contact_accelerations[0][0] > 0.0
    assert mode.contact_accelerations[1][1] > 0.0
    assert len(sets) <= 18


def test_no_map_without_touching_contacts() -> None:
    up = PlanarVelocity(v=(0.0, 1.0), w=0.0)
    down = PlanarVelocity(v=(0.0, -1.0), w=0.0)
    assert wrench_sets(planar_problem(BODY, up, BLOCK, PlanarWrench(f=(0.0, 0.0)))) == ()
    assert wrench_sets(planar_problem(BODY, down, BLOCK, PlanarWrench(f=(0.0, 0.0)))) == ()
