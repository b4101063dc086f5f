# SPDX-License-Identifier: Apache-2.0
"""Static friction in space: all modes of problems whose sticking contacts have more friction than the others.

A mode in which some contacts stick and others do not is one of the problem with static friction at the
former, and friction at the latter, as the only coefficients. So the union over all choices is the answer.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from contact_dynamics import (
    Body,
    BodyState,
    ContactSet,
    ModeVerdict,
    SpatialContactProblem,
    Surface,
    World,
    largest_acceleration,
    largest_load,
    largest_tilt,
    least_friction,
)
from contact_dynamics.contact_modes import contact_modes, mode_margins, statics, wrench_sets
from contact_dynamics.tolerances import ONLY_REST_WITHIN
from contact_modes.evidence import problem_of_made
from contact_modes.spatial.test_no_mode_missed import EXACT, NEAR
from oracles.modes_on_planes import Made, made, worst_violation
from sweeps import seeds

AT_REST = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1])
BOX = Body.box((0.4, 0.4, 0.2), mass=2.0)
WEIGHT = 2.0 * 9.80665
KINETIC, STATIC = 0.3, 0.4
HALVED = ONLY_REST_WITHIN * STATIC / KINETIC  # `only_rest` is found by halving, relative to the factor


def on_floor(
    friction: float = KINETIC, static: float | None = STATIC, **load: object
) -> SpatialContactProblem:
    floor = Surface(
        name="floor",
        p_WS_W=[0, 0, 0],
        normal_W=[0, 0, 1],
        friction=friction,
        restitution=0.0,
        static_friction=static,
    )
    state = BodyState(p_WB_W=[0, 0, 0.1], q_WB=[0, 0, 0, 1])
    return SpatialContactProblem.of(BOX, state, World(surfaces=(floor,)), **load)


def drawn(seed: int) -> SpatialContactProblem:
    """Return feet on a floor, or contacts with any normals, with loads under which many modes hold."""
    chance = np.random.default_rng([28, seed])
    n = int(chance.integers(1, 5 if seed % 2 else 4))
    if seed % 2:
        points = np.column_stack([chance.uniform(-0.3, 0.3, (n, 2)), np.full(n, -0.1)])
        normals = np.tile([0.0, 0.0, 1.0], (n, 1))
        force, torque = np.append(4.0 * chance.normal(size=2), -9.8), 0.4 * chance.normal(size=3)
    else:
        points, normals = chance.uniform(-0.3, 0.3, (n, 3)), chance.normal(size=(n, 3))
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        force = 5.0 * chance.normal(size=3) - 4.0 * normals.sum(axis=0)
        torque = chance.normal(size=3)
    frictions = chance.uniform(0.0, 0.8, n) * (chance.random(n) < 0.9)
    static = frictions + chance.uniform(0.0, 0.5, n) * (chance.random(n) < 0.8)
    contacts = ContactSet(p_WC_W=points, normals_W=normals, frictions=frictions, static_frictions=static)
    body = Body.box((0.4, 0.3, 0.2), mass=1.0).mass_properties
    return SpatialContactProblem(body=body, state=AT_REST, contacts=contacts, force_W=force, torque_W=torque)


def modes_of_all_choices(problem: SpatialContactProblem) -> tuple[set[str], bool]:
    """Return the modes, and whether these are all."""
    contacts, found, decided = problem.contacts, set(), True
    gripping = np.flatnonzero(contacts.holding_frictions > contacts.frictions).tolist()
    for count in range(len(gripping) + 1):
        for sticks in itertools.combinations(gripping, count):
            frictions = contacts.frictions.copy()
            frictions[list(sticks)] = contacts.holding_frictions[list(sticks)]
            with_one = replace(contacts, frictions=frictions, static_frictions=None)
            answer = contact_modes(replace(problem, contacts=with_one))
            decided &= answer.verdict != ModeVerdict.UNDECIDED
            found |= {
                mode.mode
                for mode in answer.modes
                if [i for i in gripping if mode.mode[i] == "f"] == list(sticks)
            }
    return found, decided


@seeds(range(40), slow=range(40, 2000))
def test_the_modes_are_those_of_each_choice_of_contacts_that_stick(seed: int) -> None:
    problem = drawn(seed)
    answer = contact_modes(problem)
    assert answer.verdict != ModeVerdict.UNDECIDED
    listed, (expected, decided) = {mode.mode for mode in answer.modes}, modes_of_all_choices(problem)
    assert expected <= listed
    assert listed == expected or not decided


def with_static(case: Made, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return frictions and static frictions with which a mode that was made is one, each (n,)."""
    chance = np.random.default_rng([29, seed])
    sticks = np.array([letter == "f" for letter in case.letters])
    less, more = chance.uniform(0.3, 1.0, sticks.shape), chance.uniform(1.0, 2.0, sticks.shape)
    return case.frictions * np.where(sticks, less, 1.0), case.frictions * np.where(sticks, 1.0, more)


@seeds(range(40), slow=range(40, 2000))
def test_no_mode_that_was_made_on_planes_is_missed(seed: int) -> None:
    case = made(seed)
    frictions, static = with_static(case, seed)
    problem = problem_of_made(case)
    contacts = replace(problem.contacts, frictions=frictions, static_frictions=static)
    answer = contact_modes(replace(problem, contacts=contacts))
    size = max(EXACT, NEAR * float(np.abs(case.motion).max()))
    listed = answer.verdict == ModeVerdict.UNDECIDED
    for mode in answer.modes:
        motion = np.concatenate([mode.acceleration_W, mode.angular_acceleration_W])
        own = np.where([letter == "f" for letter in mode.mode], static, frictions)
        missed = worst_violation(
            case._replace(frictions=own),
            mode.mode,
            motion,
            mode.contact_forces_W,
            mode.contact_accelerations_W,
        )
        assert missed <= EXACT
        near = not mode.motion_unique or np.abs(motion - case.motion).max() <= size
        listed |= mode.mode == case.letters and near
    assert listed


@seeds(range(20))
def test_equal_static_friction_changes_no_bit(seed: int) -> None:
    problem = problem_of_made(made(seed))
    given = replace(problem.contacts, static_frictions=problem.contacts.frictions)
    answers = [contact_modes(replace(problem, contacts=one)) for one in (problem.contacts, given)]
    one, other = ({**answer.to_dict(), "problem": None} for answer in answers)
    assert one == other


@pytest.mark.parametrize(
    ("push", "modes", "equilibrium"),
    [
        (0.29, {"ffff"}, "CERTAIN"),
        (0.31, {"ffff", "cccc"}, "POSSIBLE"),
        (0.39, {"ffff", "cccc"}, "POSSIBLE"),
        (0.41, {"cccc"}, "NO"),
    ],
)
def test_a_pushed_block(push: float, modes: set[str], equilibrium: str) -> None:
    problem = on_floor(force_W=[push * WEIGHT, 0, 0])
    answer = contact_modes(problem)
    assert {mode.mode for mode in answer.modes} == modes
    assert (answer.verdict == ModeVerdict.UNIQUE) == (len(modes) == 1)
    assert statics(problem).equilibrium.name == equilibrium
    for mode in answer.modes:
        slides = mode.mode == "cccc"
        expected = (push - KINETIC) * WEIGHT / 2.0 if slides else 0.0
        assert mode.acceleration_W == pytest.approx([expected, 0.0, 0.0], abs=1e-12)


def test_what_a_floor_holds_depends_on_static_friction_and_what_follows_on_friction() -> None:
    problem = on_floor()
    load = largest_load(problem, force_W=[1, 0, 0], at_W=[0, 0, 0])
    assert load.factor == pytest.approx(STATIC * WEIGHT, rel=1e-9)
    assert load.only_rest == pytest.approx(KINETIC * WEIGHT, rel=HALVED)
    assert load.modes_beyond == ("cccc",)
    assert largest_acceleration(problem, [1, 0, 0]).factor == pytest.approx(STATIC * 9.80665, rel=1e-9)
    tilt = largest_tilt(problem, [0, 1, 0])
    assert tilt.factor == pytest.approx(math.atan(STATIC), rel=1e-9)
    assert tilt.only_rest == pytest.approx(math.atan(KINETIC), rel=HALVED)


def test_the_least_friction_scales_both_coefficients_and_is_that_of_static_friction() -> None:
    found = least_friction(on_floor(force_W=[0.2 * WEIGHT, 0, 0], at_W=[0, 0, 0]))
    assert found.factor == pytest.approx(0.5, rel=1e-6)
    assert found.frictions == pytest.approx([0.2] * 4, rel=1e-6)


def test_margins_of_rest_and_of_sliding_end_at_their_own_friction() -> None:
    """Sideways, rest ends at mu_s N and sliding at mu_k N; the least change also changes the weight."""
    resting, sliding = mode_margins(on_floor(force_W=[0.35 * WEIGHT, 0, 0], at_W=[0, 0, 0]))
    assert (resting.mode, sliding.mode) == ("ffff", "cccc")
    # Pyramids inside the round cones limit what is proven, and boundaries are those of round cones.
    assert resting.margin == pytest.approx((STATIC - 0.35) * WEIGHT / math.hypot(1.0, STATIC), rel=1e-6)
    assert math.isnan(sliding.margin)
    assert "other modes are not excluded" in sliding.unknown


def test_wrench_sets_of_rest_and_sliding_overlap_between_both_frictions() -> None:
    problem = on_floor(force_W=[0.35 * WEIGHT, 0, 0], at_W=[0, 0, 0])
    sets = wrench_sets(replace(problem, friction_facets=4), modes=["ffff", "cccc"])
    length = problem.body.mean_radius_of_gyration
    inside = {one.mode for one in sets if one.depth(problem.wrench_W, length) > 0.0}
    assert inside == {"ffff", "cccc"}
