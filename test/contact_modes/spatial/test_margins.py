# SPDX-License-Identifier: Apache-2.0
"""Margins in space: closed forms, and the margin's own meaning put to the test."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact_modes import (
    ModeVerdict,
    SpatialContactProblem,
    SpatialModeMargin,
    closure,
    contact_modes,
    mode_margins,
    statics,
)
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_modes.evidence import balance, problem_of_made, pyramid_wrenches, spatial_problem
from oracles.boxes_nearly_flush import flush
from oracles.modes_on_planes import MASS, made
from sweeps import seeds

WEIGHT = 20.0
BODY = MassProperties(mass=2.0, I_B=np.diag([0.3, 0.4, 0.5]))
SHORT = 1e-3  # m: with it torques are dear, and the nearest boundary is reached by a force
DOWN = (0.0, 0.0, -WEIGHT)
SLIGHTLY = 1e-3  # relative, of changes before and behind a boundary
FINE = 48  # edges of a pyramid, whose friction is that of the cone to 0.2 %
COARSELY = 2e-2  # relative, of changes on a body whose friction is that of such a pyramid


def state(v: tuple[float, ...] = (0, 0, 0), w: tuple[float, ...] = (0, 0, 0)) -> BodyState:
    return BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0], v_WB_W=np.array(v), w_WB_W=np.array(w))


def feet(height: float, friction: float) -> ContactSet:
    corners = [(-1.0, -0.5), (1.0, -0.5), (1.0, 0.5), (-1.0, 0.5)]
    return ContactSet(
        p_WC_W=np.array([(x, y, -height) for x, y in corners]), normals_W=[0.0, 0.0, 1.0], frictions=friction
    )


@pytest.mark.parametrize("facets", [4, 8, 16])
def test_a_block_at_rest_slips_at_the_edge_of_its_friction_cone(facets: int) -> None:
    (margin,) = mode_margins(
        spatial_problem(BODY, state(), feet(0.2, 0.4), DOWN, friction_facets=facets), margin_length=SHORT
    )
    assert margin.mode == "ffff"
    assert margin.margin == pytest.approx(WEIGHT * math.sin(math.atan(0.4)), rel=1e-9)
    assert margin.length == SHORT
    np.testing.assert_allclose(np.linalg.norm(margin.change_W[:3]), margin.margin, rtol=1e-6)
    assert margin.modes_beyond == ("cccc",)
    assert margin.verdict_beyond == ModeVerdict.UNIQUE


def test_a_tall_block_tips_over_its_nearer_edge() -> None:
    (margin,) = mode_margins(
        spatial_problem(BODY, state(), feet(1.0, 2.0), DOWN, friction_facets=16), margin_length=SHORT
    )
    assert margin.margin == pytest.approx(WEIGHT * math.sin(math.atan(0.5)), rel=1e-6)
    assert margin.modes_beyond in (("ssff",), ("ffss",))
    # Pushed to the limit there is none left, and a torque about the edge is worth its lever.
    (limit,) = mode_margins(
        spatial_problem(BODY, state(), feet(1.0, 2.0), (0.0, 0.5 * WEIGHT, -WEIGHT), friction_facets=16),
        margin_length=SHORT,
    )
    assert limit.margin == pytest.approx(0.0, abs=1e-9)
    (by_torque,) = mode_margins(
        spatial_problem(BODY, state(), feet(1.0, 2.0), DOWN, friction_facets=16), margin_length=1e3
    )
    assert by_torque.margin == pytest.approx(WEIGHT * 0.5 / 1e3, rel=1e-5)


def turning_case(seed: int) -> tuple[BodyState, ContactSet, np.ndarray]:
    """Return a body that turns about an axis which the normals of its two contacts meet."""
    chance = np.random.default_rng(seed)
    centre, w = 0.3 * chance.normal(size=3), chance.normal(size=3)
    points = np.array([centre + chance.normal(size=3) for _ in range(2)])
    normals = np.array([centre + w * chance.normal() - point for point in points])
    contacts = ContactSet(
        p_WC_W=points, normals_W=normals / np.linalg.norm(normals, axis=1)[:, None], frictions=0.4
    )
    return state(tuple(-np.cross(w, centre)), tuple(w)), contacts, 3.0 * chance.normal(size=6)


@seeds(range(12))
def test_no_smaller_change_ends_a_mode_and_the_stated_one_does(seed: int) -> None:
    now, contacts, wrench = turning_case(seed)
    chance = np.random.default_rng(seed + 100)
    margins = mode_margins(
        spatial_problem(BODY, now, contacts, wrench[:3], wrench[3:], friction_facets=16), margin_length=0.5
    )
    metric = np.array([1.0, 1.0, 1.0, 0.5, 0.5, 0.5])
    for margin in margins:
        assert 0.0 <= margin.margin < math.inf
        for part, stays in ((0.999, True), (1.001, False)):
            changed = wrench + part * margin.change_W
            there = contact_modes(spatial_problem(BODY, now, contacts, changed[:3], changed[3:]))
            assert (margin.mode in [mode.mode for mode in there.modes]) == stays
        for _ in range(6):
            way = chance.normal(size=6)
            changed = wrench + 0.999 * margin.margin * way / np.linalg.norm(way) * metric
            there = contact_modes(spatial_problem(BODY, now, contacts, changed[:3], changed[3:]))
            assert margin.mode in [mode.mode for mode in there.modes]


def test_modes_without_a_margin_and_without_an_end() -> None:
    (free,) = mode_margins(
        spatial_problem(BODY, state(v=(0, 0, 1.0)), feet(0.2, 0.4), DOWN, friction_facets=16)
    )
    assert (free.mode, free.margin, free.modes_beyond) == ("ssss", math.inf, ("ssss",))
    np.testing.assert_array_equal(free.change_W, np.zeros(6))
    assert (
        mode_margins(spatial_problem(BODY, state(v=(0, 0, -1.0)), feet(0.2, 0.4), DOWN, friction_facets=16))
        == ()
    )


@pytest.mark.parametrize(("push", "facets"), [((9.0, 0.0), 4), ((10.0, 2.0), 8), ((-7.0, 7.0), 8)])
def test_a_block_that_begins_to_slide_stops_at_the_edge_of_its_cone(
    push: tuple[float, float], facets: int
) -> None:
    (margin,) = mode_margins(
        spatial_problem(BODY, state(), feet(0.2, 0.4), (*push, -WEIGHT), friction_facets=facets),
        margin_length=SHORT,
    )
    assert margin.mode == "cccc"
    assert margin.margin == pytest.approx((math.hypot(*push) - 0.4 * WEIGHT) / math.hypot(1.0, 0.4), rel=1e-9)
    assert margin.modes_beyond == ("ffff",)
    np.testing.assert_allclose(margin.change_W[2], -0.4 / math.hypot(1.0, 0.4) * margin.margin, rtol=1e-2)


def modes_at(problem: SpatialContactProblem, change: np.ndarray) -> list[str]:
    """Return the modes under a changed wrench."""
    changed = replace(problem, force_W=problem.force_W + change[:3], torque_W=problem.torque_W + change[3:])
    return [mode.mode for mode in contact_modes(changed).modes]


def check_margin(problem: SpatialContactProblem, margin: SpatialModeMargin, ways: np.ndarray) -> None:
    """Check that the stated change leaves the mode, and that changes in other ways, (k, 6), do not before."""
    metric = np.array([1.0, 1.0, 1.0, *[margin.length] * 3])
    assert np.linalg.norm(margin.change_W / metric) == pytest.approx(margin.margin, rel=1e-9)
    assert margin.mode in modes_at(problem, (1.0 - SLIGHTLY) * margin.change_W)
    assert margin.mode not in modes_at(problem, (1.0 + SLIGHTLY) * margin.change_W)
    assert sorted(set(modes_at(problem, (1.0 + SLIGHTLY) * margin.change_W))) == sorted(margin.modes_beyond)
    for way in ways:
        change = (1.0 - SLIGHTLY) * margin.margin * way / np.linalg.norm(way) * metric
        assert margin.mode in modes_at(problem, change)


@seeds(range(4), slow=range(4, 8))
def test_margins_of_a_foot_are_exact(seed: int) -> None:
    chance = np.random.default_rng(seed)
    foot = ContactSet(p_WC_W=chance.normal(size=(1, 3)), normals_W=[0.0, 0.0, 1.0], frictions=0.3)
    wrench = np.append(chance.normal(size=3) * 5.0 - [0.0, 0.0, WEIGHT], chance.normal(size=3))
    asked = spatial_problem(BODY, state(), foot, wrench[:3], wrench[3:])
    for margin in mode_margins(asked, margin_length=float(chance.choice([0.1, 0.45, 2.0]))):
        assert 0.0 < margin.margin < math.inf
        check_margin(asked, margin, chance.normal(size=(40, 6)))


def pushed_and_turned(seed: int) -> SpatialContactProblem:
    """Return a box that begins to slide and to turn."""
    chance = np.random.default_rng(seed)
    friction, heading = float(chance.choice([0.3, 0.5, 0.8])), chance.uniform(0.0, 2.0 * math.pi)
    push = 9.8 * friction * chance.uniform(1.0, 1.3) * np.array([math.cos(heading), math.sin(heading)])
    corners = ContactSet(
        p_WC_W=np.array([(x, y, -0.1) for x in (-0.1, 0.1) for y in (-0.1, 0.1)]),
        normals_W=[0.0, 0.0, 1.0],
        frictions=friction,
    )
    return spatial_problem(
        MassProperties(mass=1.0, I_B=np.diag([0.0043, 0.0043, 0.0053])),
        state(),
        corners,
        (*push, -9.8),
        chance.normal(size=3) * [0.02, 0.02, 0.1],
    )


@seeds(range(3), slow=range(3, 40))
def test_margins_of_boxes_that_begin_to_slide_and_to_turn_are_exact(seed: int) -> None:
    """Their feet can share the load in many ways, and the mode ends where the last of them does."""
    asked = pushed_and_turned(seed)
    ways = np.random.default_rng(seed).normal(size=(2, 6))
    for margin in mode_margins(asked):
        if not math.isnan(margin.margin):
            check_margin(asked, margin, ways)


def test_most_margins_of_boxes_that_begin_to_slide_and_to_turn_are_known() -> None:
    margins = [margin for seed in range(8) for margin in mode_margins(pushed_and_turned(seed))]
    assert sum(math.isnan(margin.margin) for margin in margins) <= 1


def on_cone(problem: SpatialContactProblem, change: np.ndarray, *, around: bool) -> bool:
    """Return whether forces in fine pyramids in or around the cones balance a wrench."""
    wider = 1.0 / math.cos(math.pi / FINE) if around else 1.0
    wrenches = pyramid_wrenches(problem.contacts, FINE, wider, problem.state.p_WB_W)
    return balance(wrenches, problem.wrench_W + change)


@seeds(range(2), slow=range(2, 60))
def test_margins_of_bodies_that_stick_are_between_those_of_fine_pyramids(seed: int) -> None:
    chance = np.random.default_rng(seed)
    n = int(chance.integers(3, 6))
    normals = chance.normal(size=(n, 3)) * 0.4 + [0.0, 0.0, 1.0]
    forces = normals / np.linalg.norm(normals, axis=1)[:, None] + 0.1 * chance.normal(size=(n, 3))
    points = chance.normal(size=(n, 3))
    asked = spatial_problem(
        BODY,
        state(),
        ContactSet(
            p_WC_W=points, normals_W=normals / np.linalg.norm(normals, axis=1)[:, None], frictions=0.5
        ),
        -forces.sum(axis=0),
        -np.cross(points, forces).sum(axis=0),
    )
    margins = [margin for margin in mode_margins(asked) if margin.mode == "f" * n]
    assert len(margins) == 1
    margin = margins[0]
    assert not on_cone(asked, (1.0 + COARSELY) * margin.change_W, around=True)
    metric = np.array([1.0, 1.0, 1.0, *[margin.length] * 3])
    for way in [margin.change_W / metric, *chance.normal(size=(20, 6))]:
        change = (1.0 - COARSELY) * margin.margin * way / np.linalg.norm(way) * metric
        assert on_cone(asked, change, around=False)


@seeds(range(6), slow=range(6, 100))
def test_margins_do_not_depend_on_the_facets(seed: int) -> None:
    case = made(seed, most=4)
    asked = problem_of_made(case)
    coarse, fine = (mode_margins(replace(asked, friction_facets=facets)) for facets in (3, 24))
    for one, other in zip(coarse, fine, strict=True):
        assert (one.mode, one.verdict_beyond) == (other.mode, other.verdict_beyond)
        assert one.modes_beyond == other.modes_beyond
        assert one.margin == pytest.approx(other.margin, rel=1e-6, abs=1e-9, nan_ok=True)


def ring(feet: int) -> SpatialContactProblem:
    """Return a body on a ring of feet that begins to slide."""
    angles = 2.0 * math.pi * np.arange(feet) / feet
    contacts = ContactSet(
        p_WC_W=np.column_stack([np.cos(angles), np.sin(angles), np.full(feet, -0.1)]),
        normals_W=[0.0, 0.0, 1.0],
        frictions=0.4,
    )
    return spatial_problem(BODY, state(), contacts, (10.0, 0.0, -WEIGHT))


def on_two(
    second: tuple[float, ...],
    normal: tuple[float, ...],
    *,
    push: float = 6.0,
    frictions: float | tuple[float, ...] = 0.3,
    now: BodyState | None = None,
) -> SpatialContactProblem:
    """Return a body on a foot 0.1 m below it and on another contact, pushed along y and turned about x."""
    contacts = ContactSet(
        p_WC_W=[(0.0, 0.0, -0.1), second], normals_W=[(0.0, 0.0, 1.0), normal], frictions=frictions
    )
    torque = (1.5 * push - 6.0, 0.0, 0.0)
    return spatial_problem(BODY, now or state(), contacts, (0.0, push, -WEIGHT), torque)


@pytest.mark.parametrize(
    ("problem", "mode", "reason"),
    [
        (ring(12), "c" * 12, "the contacts on a plane have more than 8 corners"),
        (pushed_and_turned(30), "cccc", "other modes are not excluded, and the contacts can share the load"),
        (
            on_two((0.1, 0.0, -0.1), (0.0, 0.0, 1.0), push=12.0, now=state((0.0, 0.0, 0.0), (0.0, 0.0, 0.1))),
            "cc",
            "contacts begin to slide on a body or surface that moves",
        ),
        (
            on_two((0.0, 0.0, 0.1), (0.0, 0.0, 1.0), frictions=(1.0, 0.1)),
            "fc",
            "some contacts begin to slide while others stick",
        ),
        (
            on_two((-0.1, 0.0, 0.0), (1.0, 0.0, 0.0), push=12.0),
            "cc",
            "no change is proven to be too small to end the mode",
        ),
    ],
)
def test_a_margin_that_is_unknown_has_a_reason(
    problem: SpatialContactProblem, mode: str, reason: str
) -> None:
    margin = next(found for found in mode_margins(problem) if found.mode == mode)
    assert math.isnan(margin.margin)
    assert margin.unknown.startswith(reason)
    assert margin.in_short().endswith(f"its margin is unknown: {margin.unknown} (change_W in N and N m)")
    assert margin.mode in margin.modes_beyond
    np.testing.assert_array_equal(margin.change_W, np.zeros(6))


@seeds(range(2), slow=range(2, 20))
def test_the_reason_contains_a_lower_bound_where_there_is_one(seed: int) -> None:
    """No drawn change below it ends the mode."""
    chance = np.random.default_rng(seed)
    told = 0
    while told == 0:
        asked = replace(pushed_and_turned(int(chance.integers(1000))), torque_W=0.3 * chance.normal(size=3))
        for margin in mode_margins(asked):
            bound = re.match(r"no change below (.*) N ends the mode, and the mode continues", margin.unknown)
            for way in chance.normal(size=(20 if bound else 0, 6)):
                told += 1
                metric = np.array([1.0, 1.0, 1.0, *[margin.length] * 3])
                change = (1.0 - 1e-2) * float(bound[1]) * way / np.linalg.norm(way) * metric  # of 3 digits
                assert margin.mode in modes_at(asked, change)


def test_a_body_that_round_cones_wedge_stays_under_any_wrench() -> None:
    """Forces in the round cones balance every wrench, while those in pyramids of 8 edges do not."""
    chance = np.random.default_rng(95)
    points, normals = chance.uniform(-0.15, 0.15, (4, 3)), chance.normal(size=(4, 3)) * 0.6 + [0.0, 0.0, 1.0]
    contacts = ContactSet(
        p_WC_W=points,
        normals_W=normals / np.linalg.norm(normals, axis=1)[:, None],
        frictions=[2.0, 0.1, 2.0, 0.3],
    )
    problem = spatial_problem(BODY, state(), contacts, DOWN)
    assert closure(contacts).force
    assert math.isfinite(statics(problem).stable_disturbance)
    margin = next(found for found in mode_margins(problem) if found.mode == "ffff")
    assert (margin.margin, margin.unknown) == (math.inf, "")


@seeds(range(3000, 3010), slow=range(3010, 3200))
def test_modes_a_millionth_beyond_the_margin_are_those_beyond(seed: int) -> None:
    """Nearer than that, some verdicts are UNDECIDED, or the mode is still found."""
    box = flush(seed, 0.0)
    problem = spatial_problem(
        MassProperties(mass=MASS, I_B=np.diag(box.inertia)),
        state(tuple(box.velocity)),
        ContactSet(p_WC_W=box.points, normals_W=box.normals, frictions=box.frictions),
        box.wrench[:3],
        box.wrench[3:],
    )
    answer = contact_modes(problem)
    for margin in mode_margins(problem, answer) if answer.verdict == ModeVerdict.UNIQUE else ():
        if not 0.0 < margin.margin < math.inf:
            continue
        for further in (1e-6, 1e-5, 1e-3):
            found = modes_at(problem, (1.0 + further) * margin.change_W)
            assert sorted(set(found)) == sorted(margin.modes_beyond)
