# SPDX-License-Identifier: Apache-2.0
"""How large a push may become: by hand, and against all modes just before and just beyond."""

from __future__ import annotations

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
    contact_modes,
    largest_load,
)
from contact_dynamics.errors import InvalidFieldError
from contact_modes.evidence import spatial_problem
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
    assert (found.factor, found.modes_beyond) == (math.inf, ())
    assert found.only_rest == math.inf
    assert found.in_short() == "LargestLoad: it stays fixed under any multiple of the load"


def test_a_body_that_moves_and_a_load_that_is_none_are_errors() -> None:
    problem = on_floor(0.5)
    with pytest.raises(InvalidFieldError, match=r"^problem must be one of a body that stays.*it slides"):
        largest_load(replace(problem, force_W=[150.0, 0, -WEIGHT]), force_W=[1, 0, 0])
    with pytest.raises(InvalidFieldError, match=r"^force_W must be a load, or torque_W, got no load"):
        largest_load(problem, force_W=[0, 0, 0])


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
