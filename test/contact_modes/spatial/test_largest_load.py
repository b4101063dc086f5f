# SPDX-License-Identifier: Apache-2.0
"""How large a push may become: by hand, and against all modes just before and just beyond."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import ArrayLike
from scipy.optimize import linprog

from contact_dynamics import (
    Body,
    BodyState,
    ContactSet,
    ModeVerdict,
    SpatialContactProblem,
    Surface,
    World,
    contact_modes,
    largest_load,
)
from contact_dynamics.contact_modes.spatial.largest_load import (
    LargestLoad,
    largest_acceleration,
    largest_spin,
    largest_tilt,
    least_friction,
)
from contact_dynamics.errors import InvalidFieldError
from contact_modes.evidence import pyramid_wrenches, spatial_problem
from sweeps import seeds

WEIGHT = 20.0 * 10.0
CRATE = Body.box((0.4, 0.3, 0.6), mass=20.0, name="crate")
LYING = BodyState(p_WB_W=[0, 0, 0.3], q_WB=[0, 0, 0, 1])


def on_floor(friction: float) -> SpatialContactProblem:
    floor = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=friction, restitution=0.0)
    return SpatialContactProblem.of(CRATE, LYING, World(surfaces=(floor,), gravity_W=[0, 0, -10.0]))


@pytest.mark.parametrize(
    ("friction", "push", "factor", "mode"),
    [
        (0.5, {"force_W": [1, 0, 0], "at_W": [-0.2, 0, 0.5]}, WEIGHT * 0.2 / 0.5, "ssff"),  # tips
        (0.3, {"force_W": [1, 0, 0], "at_W": [-0.2, 0, 0.5]}, 0.3 * WEIGHT, "cccc"),  # slides
        (0.5, {"force_W": [1, 1, 0], "at_W": [0, 0, 0.0]}, 0.5 * WEIGHT / math.sqrt(2.0), "cccc"),
        (0.5, {"torque_W": [0, 0, 1]}, 0.5 * WEIGHT * 0.25, "cccc"),  # turns: the feet are 0.25 m away
        (0.5, {"force_W": [0, 0, 2]}, 0.5 * WEIGHT, "ssss"),  # is lifted
    ],
)
def test_a_crate_on_its_feet(friction: float, push: dict[str, list[float]], factor: float, mode: str) -> None:
    found = largest_load(on_floor(friction), **push)
    assert found.factor == pytest.approx(factor, rel=1e-10)
    assert found.only_rest == pytest.approx(factor, rel=1e-10)
    assert (found.verdict_beyond, found.modes_beyond) == (ModeVerdict.UNIQUE, (mode,))
    assert f"it stays fixed up to {factor:.3g} times the load, then " in found.in_short()


def test_a_push_within_the_friction_cone_may_become_any() -> None:
    found = largest_load(on_floor(0.5), force_W=[0.4, 0, -1.0], at_W=[0, 0, 0])
    assert (found.factor, found.verdict_beyond, found.modes_beyond) == (math.inf, None, ())
    assert found.only_rest == math.inf
    assert found.in_short() == "LargestLoad: it stays fixed under any multiple of the load"


def test_a_body_that_moves_and_a_load_that_is_none_are_errors() -> None:
    problem = on_floor(0.5)
    with pytest.raises(InvalidFieldError, match=r"^problem must be one of a body that stays.*it slides"):
        largest_load(replace(problem, force_W=[150.0, 0, -WEIGHT]), force_W=[1, 0, 0])
    with pytest.raises(InvalidFieldError, match=r"^force_W must be at least 1e-60 N .* or torque_W"):
        largest_load(problem, force_W=[0, 0, 0])
    with pytest.raises(InvalidFieldError, match=r"^force_W must be at least 1e-60 N .*, got 1e-300"):
        largest_load(problem, force_W=[1e-300, 0, 0])
    tiny, one = largest_load(problem, force_W=[1e-59, 0, 0]), largest_load(problem, force_W=[1, 0, 0])
    assert tiny.factor == pytest.approx(1e59 * one.factor, rel=1e-10)
    assert tiny.modes_beyond == one.modes_beyond
    with pytest.raises(InvalidFieldError, match=r"^at_W must be left out unless force_W is given"):
        largest_load(problem, torque_W=[0, 0, 1], at_W=[0, 0, 1])


def test_two_fingers_may_let_go_before_they_must() -> None:
    """A plate between two fingers that no force presses rests, or falls under any weight."""
    fingers = ContactSet(
        p_WC_W=[[-0.05, 0, 0], [0.05, 0, 0]], normals_W=[[1, 0, 0], [-1, 0, 0]], frictions=0.5
    )
    plate = Body.box((0.1, 0.1, 0.1), mass=1.0)
    state = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1])
    problem = spatial_problem(plate, state, fingers, [0, 0, -1e-3])
    found = largest_load(problem, force_W=[0, 0, -1])
    assert (found.factor, found.only_rest) == (math.inf, 0.0)
    assert found.in_short() == "LargestLoad: it may stay fixed under any multiple of the load"


@seeds(range(4), slow=range(4, 8))
def test_rest_is_consistent_just_before_and_not_just_beyond(seed: int) -> None:
    """Among all modes, which are found in another way; feet on a floor, and some on a wall."""
    random = np.random.default_rng(seed)
    feet = 3 + seed % 3
    points = np.column_stack([random.uniform(-0.3, 0.3, (feet, 2)), np.full(feet, -0.3)])
    points[:3, :2] = [[-0.3, -0.2], [0.3, -0.2], [0.0, 0.3]]  # the weight is between them
    normals = np.tile([0.0, 0.0, 1.0], (feet, 1))
    if seed % 2:
        points, normals = np.vstack([points, [[0.1, -0.3, 0.1]]]), np.vstack([normals, [[0.0, 1.0, 0.0]]])
    contacts = ContactSet(p_WC_W=points, normals_W=normals, frictions=random.uniform(0.2, 0.8, len(points)))
    state = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1])
    problem = spatial_problem(CRATE.mass_properties, state, contacts, [0, 0, -WEIGHT])
    load = random.normal(size=6) * [1, 1, 0.3, 0.2, 0.2, 0.2]
    found = largest_load(problem, force_W=load[:3], torque_W=load[3:])
    rest = "f" * len(points)
    assert 0.0 < found.factor < math.inf
    for factor, is_consistent in ((1.0 - 1e-4, True), (1.0 + 1e-4, False)):
        wrench = problem.wrench_W + factor * found.factor * load
        modes = contact_modes(replace(problem, force_W=wrench[:3], torque_W=wrench[3:])).modes
        assert (rest in {mode.mode for mode in modes}) is is_consistent
    assert rest not in found.modes_beyond


def between_fingers(grip: ArrayLike | None = None, friction: float = 0.5, **load: list[float]) -> LargestLoad:
    """Return the largest load on a plate of 1 kg without weight, 0.1 m wide, between two fingers along x."""
    fingers = ContactSet(
        p_WC_W=[[-0.05, 0, 0], [0.05, 0, 0]], normals_W=[[1, 0, 0], [-1, 0, 0]], frictions=friction
    )
    plate, state = Body.box((0.1, 0.1, 0.1), mass=1.0), BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1])
    return largest_load(spatial_problem(plate, state, fingers, [0, 0, 0]), **load, max_normal_forces=grip)


@pytest.mark.parametrize(
    ("grip", "load", "factor", "overloaded"),
    [
        (20.0, {"force_W": [0, 0, -1]}, 20.0, (0, 1)),  # 2 mu F
        ([20.0, 30.0], {"force_W": [0, 0, -1]}, 20.0, (0,)),  # both press with the same force
        ([math.inf, 20.0], {"force_W": [0, 0, -1]}, 20.0, (1,)),
        (20.0, {"force_W": [1, 0, 0]}, 20.0, (1,)),  # the other finger lets go
        (20.0, {"torque_W": [0, 1, 0]}, 1.0, (0, 1)),  # mu F d
        ([0.0, 20.0], {"force_W": [1, 0, 0]}, 20.0, (0, 1)),
    ],
)
def test_a_gripper_holds_what_its_largest_force_allows(
    grip: ArrayLike, load: dict[str, list[float]], factor: float, overloaded: tuple[int, ...]
) -> None:
    found = between_fingers(grip, **load)
    assert found.factor == pytest.approx(factor, rel=1e-9)
    assert found.overloaded == overloaded
    assert (found.verdict_beyond, found.modes_beyond) == (ModeVerdict.UNDECIDED, ())
    assert "limited by the maximum normal force of contact" in found.in_short()


def test_fingers_that_cannot_press_hold_nothing() -> None:
    found = between_fingers(0.0, force_W=[0, 0, -1])
    assert (found.factor, found.overloaded) == (0.0, (0, 1))


def test_limits_that_do_not_bind_change_nothing() -> None:
    problem = on_floor(0.3)
    push = {"force_W": [1, 0, 0], "at_W": [-0.2, 0, 0.5]}
    free, limited = largest_load(problem, **push), largest_load(problem, **push, max_normal_forces=WEIGHT)
    assert limited.factor == pytest.approx(free.factor, rel=1e-10)
    assert (limited.overloaded, limited.modes_beyond) == ((), free.modes_beyond)


def test_limits_that_are_none_or_too_small_are_errors() -> None:
    push = {"force_W": [1, 0, 0]}
    with pytest.raises(InvalidFieldError, match=r"^max_normal_forces must be limits within which"):
        largest_load(on_floor(0.3), **push, max_normal_forces=WEIGHT / 8)


def test_each_question_about_the_load_knows_the_limits() -> None:
    """Four feet of a crate, each of which bears at most a quarter more than its share of the weight."""
    problem, limit = on_floor(2.0), 1.25 * WEIGHT / 4
    # The centre of mass is 0.3 m above the feet, which are 0.4 m apart: m a h = 2 * 0.25 * (m g / 4) * 0.4.
    brakes = largest_acceleration(problem, [1, 0, 0], max_normal_forces=limit)
    assert brakes.factor == pytest.approx(2 * 0.25 / 4 * 10.0 * 0.4 / 0.3, rel=1e-9)
    assert brakes.overloaded == (0, 1)
    tilts = largest_tilt(problem, [0, 1, 0], max_normal_forces=limit)
    # cos + (h / (d / 2)) sin = 1.25
    assert math.cos(tilts.factor) + 1.5 * math.sin(tilts.factor) == pytest.approx(1.25, rel=1e-9)
    spins = largest_spin(problem, [0, 0, 1], at_W=[-1.0, 0, 0], max_normal_forces=limit)
    assert spins.factor**2 == pytest.approx(brakes.factor, rel=1e-9)  # at 1 m from the axis


def test_a_gripper_needs_this_friction() -> None:
    fingers = ContactSet(
        p_WC_W=[[-0.05, 0, 0], [0.05, 0, 0]], normals_W=[[1, 0, 0], [-1, 0, 0]], frictions=0.5
    )
    plate, state = Body.box((0.1, 0.1, 0.1), mass=1.0), BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1])
    problem = spatial_problem(plate, state, fingers, [0, 0, -10.0])
    found = least_friction(problem, max_normal_forces=20.0)
    assert found.frictions == pytest.approx((0.25, 0.25), rel=1e-6)
    assert (found.verdict_below, found.modes_below) == (ModeVerdict.UNDECIDED, ())


@seeds(range(6), slow=range(6, 60))
def test_limits_against_a_linear_program(seed: int) -> None:
    """Pyramids inside and around the round cones give the program's bounds on the factor."""
    random = np.random.default_rng(seed)
    n, edges = 3 + seed % 3, 48
    normals = random.normal(size=(n, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    points, friction = -0.1 * normals + random.normal(0.0, 0.02, (n, 3)), random.uniform(0.3, 1.0, n)
    contacts = ContactSet(p_WC_W=points, normals_W=normals, frictions=friction)
    limits = random.uniform(5.0, 50.0, n) * 10.0 ** random.integers(-6, 7)
    limits[seed % n] = np.inf if seed % 2 else limits[seed % n]
    state = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1])
    load = random.normal(size=6) * [1, 1, 1, 0.05, 0.05, 0.05]
    problem = spatial_problem(Body.box((0.1, 0.1, 0.1), mass=1.0).mass_properties, state, contacts, [0, 0, 0])
    found = largest_load(problem, force_W=load[:3], torque_W=load[3:], max_normal_forces=limits)

    def bound(scale: float) -> float:
        wrenches = pyramid_wrenches(contacts, edges, scale)
        pressing = np.zeros((n, n * edges))
        for i in range(n):
            at = slice(i * edges, (i + 1) * edges)
            pressing[i, at] = wrenches[at, :3] @ normals[i]
        bounded = np.isfinite(limits)
        program = linprog(
            np.append(np.zeros(n * edges), -1.0),
            A_ub=np.hstack([pressing, np.zeros((n, 1))])[bounded],
            b_ub=limits[bounded],
            A_eq=np.hstack([wrenches.T, load[:, None]]),
            b_eq=np.zeros(6),
        )
        return float("inf") if program.status == 3 else float(program.x[-1])

    # A pyramid of 48 edges is inside the round cone, and around it if wider by 1 / cos(pi / 48).
    inside, around = bound(1.0), bound(1.0 / math.cos(math.pi / edges))
    assert inside * (1.0 - 1e-7) <= found.factor <= around * (1.0 + 1e-7)
