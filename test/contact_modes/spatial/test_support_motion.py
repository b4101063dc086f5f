# SPDX-License-Identifier: Apache-2.0
"""How far a support may accelerate, tilt and spin, how little friction is enough, and closure of grasps."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

from contact_dynamics import (
    Body,
    BodyState,
    ContactSet,
    MassProperties,
    SpatialContactProblem,
    Surface,
    World,
    closure,
    contact_modes,
    largest_acceleration,
    largest_spin,
    largest_tilt,
    least_friction,
)
from contact_dynamics.contact_modes import LargestLoad
from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_modes.evidence import pyramid_wrenches, spatial_problem
from sweeps import seeds

G = 9.80665
MASS = 2.0
WIDTH, HEIGHT = 0.2, 0.4
BOX = Body.box((WIDTH, 0.6, HEIGHT), mass=MASS)
STANDING = BodyState(p_WB_W=[0, 0, 0.2], q_WB=[0, 0, 0, 1])
TIPS = WIDTH / HEIGHT  # the friction from which the box tips before it slides


def on_tray(friction: float) -> SpatialContactProblem:
    tray = Surface(name="tray", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=friction, restitution=0.0)
    return SpatialContactProblem.of(BOX, STANDING, World(surfaces=(tray,)))


def drawn(seed: int) -> SpatialContactProblem:
    """Feet on a floor that hold the weight, and in every other draw one on a wall."""
    random = np.random.default_rng(seed)
    points = np.column_stack([random.uniform(-0.3, 0.3, (4, 2)), np.full(4, -0.2)])
    points[:3, :2] = [[-0.3, -0.2], [0.3, -0.2], [0.0, 0.3]]
    normals = np.tile([0.0, 0.0, 1.0], (4, 1))
    if seed % 2:
        points, normals = np.vstack([points, [[0.1, -0.3, 0.1]]]), np.vstack([normals, [[0.0, 1.0, 0.0]]])
    contacts = ContactSet(p_WC_W=points, normals_W=normals, frictions=random.uniform(0.2, 0.8, len(points)))
    state = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1])
    push = random.normal(size=3) * 0.5
    return spatial_problem(BOX.mass_properties, state, contacts, [push[0], push[1], -MASS * G])


def may_rest(problem: SpatialContactProblem) -> bool:
    return "f" * len(problem.contacts) in {mode.mode for mode in contact_modes(problem).modes}


@pytest.mark.parametrize("friction", [0.3, 0.8])
def test_a_box_on_a_tray_slides_or_tips(friction: float) -> None:
    problem, grip = on_tray(friction), min(friction, TIPS)
    words = "then it slides" if friction < TIPS else "then it tips"
    for found, limit in (
        (largest_acceleration(problem, [3, 0, 0]), grip * G),
        (largest_tilt(problem, [0, -2, 0]), math.atan(grip)),
        (largest_spin(problem, [0, 0, 1], at_W=[0.5, 0, 7]), math.sqrt(grip * G / 0.5)),
    ):
        assert found.factor == pytest.approx(limit, rel=1e-9)
        assert found.only_rest == pytest.approx(limit, rel=1e-9)
        assert words in found.in_short()
        assert f"up to {limit:.3g} {found.unit}" in found.in_short()


def test_a_spin_about_a_tilted_axis_turns_the_body_by_itself() -> None:
    """About its centre, at 45 degrees: no centrifugal force, but the moment of a rotor out of balance."""
    problem = on_tray(0.8)
    turning = BOX.mass_properties.I_B
    moment = abs(turning[2, 2] - turning[0, 0]) / 2.0  # times the square of the spin, about y
    found = largest_spin(problem, [1, 0, 1], at_W=STANDING.p_WB_W)
    assert found.factor == pytest.approx(math.sqrt(MASS * G * WIDTH / 2.0 / moment), rel=1e-9)


def test_a_spin_about_a_principal_axis_through_the_centre_loads_nothing() -> None:
    """Also where rounding of its place and attitude moves it off the axis by a little."""
    turned = Rotation.from_euler("z", 0.3)
    for place in ([0.0, 0.0, 0.0], [0.1, 0.7, 0.0], [1e6, -0.3, 0.0]):
        standing = replace(STANDING, p_WB_W=STANDING.p_WB_W + place, q_WB=turned.as_quat())
        tray = on_tray(0.4).contacts
        feet = tray.p_WC_W @ turned.as_matrix().T + place
        problem = replace(on_tray(0.4), state=standing, contacts=replace(tray, p_WC_W=feet))
        for axis in ([0, 0, 1], turned.apply([1, 0, 0])):
            found = largest_spin(problem, axis, at_W=standing.p_WB_W + 0.3 * np.array(axis))
            assert (found.factor, found.only_rest, found.modes_beyond) == (math.inf, math.inf, ())
            assert found.in_short() == "LargestLoad: it stays fixed at any spin"
    with pytest.raises(InvalidFieldError, match=r"^problem must be one of a body that stays fixed"):
        largest_spin(replace(problem, force_W=[30.0, 0.0, -MASS * G]), [0, 0, 1], at_W=standing.p_WB_W)


def tilted(problem: SpatialContactProblem, axis: NDArray[np.float64], angle: float) -> SpatialContactProblem:
    weight = np.array([0.0, 0.0, -MASS * G])
    turned = Rotation.from_rotvec(-angle * axis).apply(weight)
    return replace(problem, force_W=problem.force_W - weight + turned)


@seeds(range(4), slow=range(4, 10))
def test_rest_is_consistent_at_all_smaller_tilts_and_not_just_beyond(seed: int) -> None:
    problem = drawn(seed)
    axis = np.random.default_rng([seed, 1]).normal(size=3) * [
        1.0,
        1.0,
        0.3,
    ]  # a steeper one may never end rest
    axis /= np.linalg.norm(axis)
    found = largest_tilt(problem, axis, gravity_W=[0, 0, -G])
    assert 0.0 < found.factor < 2.0 * math.pi
    for share in (0.2, 0.4, 0.6, 0.8, 0.95, 1.0 - 1e-5):
        assert may_rest(tilted(problem, axis, share * found.factor))
    assert not may_rest(tilted(problem, axis, (1.0 + 1e-5) * found.factor))


def test_a_push_that_turns_with_the_tray() -> None:
    """A push along the tray takes up its friction, and the weight along the tray adds to it or opposes it."""
    problem = replace(on_tray(0.49), force_W=[0.4 * MASS * G, 0, -MASS * G])
    found = largest_tilt(problem, [0, 1, 0], gravity_W=[0, 0, -G])
    limit = next(a for a in np.arange(0.0, 1.0, 1e-5) if 0.4 + math.sin(a) > 0.49 * math.cos(a))
    assert found.factor == pytest.approx(limit, abs=2e-5)
    back = largest_tilt(problem, [0, -1, 0], gravity_W=[0, 0, -G])
    limit = next(a for a in np.arange(0.0, 3.0, 1e-5) if math.sin(a) - 0.4 > 0.49 * math.cos(a))
    assert back.factor == pytest.approx(limit, abs=2e-5)


def test_a_body_in_a_vice_stays_at_any_tilt_where_friction_wedges_it() -> None:
    fingers = ContactSet(
        p_WC_W=[[-0.1, 0, 0], [0.1, 0, 0.05], [0.1, 0.05, -0.05], [0.1, -0.05, -0.05]],
        normals_W=[[1, 0, 0], [-1, 0, 0], [-1, 0, 0], [-1, 0, 0]],
        frictions=0.5,
    )
    problem = spatial_problem(BOX, STANDING, fingers, [0, 0, -MASS * G])
    centred = replace(problem, state=replace(STANDING, p_WB_W=[0, 0, 0]))
    found = largest_tilt(centred, [0, 1, 0])
    assert (found.factor, found.only_rest) == (math.inf, 0.0)
    assert "at any tilt" in found.in_short()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda p: largest_tilt(p, [0, 0, 0]), r"^axis_W must be a direction, got \[0\.0, 0\.0, 0\.0\]"),
        (lambda p: largest_tilt(p, [0, 0, 1]), r"^axis_W, gravity_W must be an axis at an angle to gravity"),
        (
            lambda p: largest_tilt(replace(p, force_W=[30.0, 0.0, -MASS * G]), [0, 1, 0]),
            r"^problem must be one of a body that stays fixed without the additional load or motion",
        ),
    ],
)
def test_what_cannot_be_asked(call: Callable[[SpatialContactProblem], LargestLoad], message: str) -> None:
    with pytest.raises(InvalidFieldError, match=message):
        call(on_tray(0.5))


def test_a_tray_that_accelerates_already() -> None:
    problem = on_tray(0.8)
    moving = replace(problem, contacts=replace(problem.contacts, surface_accelerations_W=[2.0, 0.0, 0.0]))
    assert largest_acceleration(moving, [1, 0, 0]).factor == pytest.approx(TIPS * G - 2.0, rel=1e-9)
    assert least_friction(moving).frictions == pytest.approx([2.0 / G] * 4, rel=1e-7)
    for call in (largest_tilt, largest_spin):
        with pytest.raises(
            NotSupportedError, match=rf"^problem\.contacts must have surfaces at rest in {call.__name__}"
        ):
            call(moving, [0, 1, 0])


def test_a_tilt_is_that_of_the_problems_own_weight() -> None:
    moon = replace(on_tray(0.3), force_W=[0, 0, -MASS * 1.62])
    assert largest_tilt(moon, [0, 1, 0]).factor == pytest.approx(math.atan(0.3), rel=1e-9)


@pytest.mark.parametrize(
    ("fingers", "down", "turned"), [(3, 20.0, 0.0), (3, 5.0, 0.3), (4, 20.0, 0.3), (5, 10.0, 0.2)]
)
def test_fingers_that_press_a_part_down_need_the_friction_of_their_slope(
    fingers: int, down: float, turned: float
) -> None:
    """However hard they press. It was 2 / sqrt(3) of that, since large forces were not tried."""
    slope, angles = math.radians(down), turned + 2.0 * math.pi * np.arange(fingers) / fingers
    out = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(fingers)])
    contacts = ContactSet(
        p_WC_W=0.05 * out, normals_W=-math.cos(slope) * out - [0.0, 0.0, math.sin(slope)], frictions=0.5
    )
    part = MassProperties(mass=0.2, I_B=1e-4 * np.eye(3))
    held = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1])
    problem = spatial_problem(part, held, contacts, [0, 0, -0.2 * G])
    needed = least_friction(problem).frictions[0]
    assert math.tan(slope) * (1.0 - 1e-7) <= needed <= math.tan(slope) * (1.0 + 1e-4)
    smooth = replace(problem, contacts=replace(contacts, frictions=0.0))
    with pytest.raises(
        InvalidFieldError, match=r"^problem\.contacts\.frictions must be > 0 where there is friction"
    ):
        least_friction(smooth)


def test_the_least_friction_of_a_ladder() -> None:
    """A ladder on a rough floor, at a smooth wall, with its weight in the middle: half the tangent."""
    angle, half = 0.4, 1.5  # rad from the wall, m
    across, up = half * math.sin(angle), half * math.cos(angle)
    ladder = ContactSet(
        p_WC_W=[[across, -0.2, -up], [across, 0.2, -up], [-across, 0.0, up]],
        normals_W=[[0, 0, 1], [0, 0, 1], [1, 0, 0]],
        frictions=[0.9, 0.9, 0.0],
    )
    state = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1])
    problem = spatial_problem(BOX.mass_properties, state, ladder, [0, 0, -MASS * G])
    found = least_friction(problem)
    needed = 0.5 * math.tan(angle)
    assert found.frictions == pytest.approx((needed, needed, 0.0), rel=1e-7)  # as its docstring says
    assert f"friction of 0 to {needed:.3g}" in found.in_short()
    assert found.modes_below
    assert "fff" not in found.modes_below


@seeds(range(4), slow=range(4, 10))
def test_rest_is_consistent_with_a_little_more_than_the_least_friction(seed: int) -> None:
    problem = drawn(seed)
    problem = replace(problem, force_W=problem.force_W + np.array([3.0, 1.0, 0.0]))
    found = least_friction(problem)
    assert 0.0 < found.factor < math.inf
    for share, rests in ((1.0 + 1e-6, True), (1.0 - 1e-6, False)):
        contacts = replace(problem.contacts, frictions=share * np.array(found.frictions))
        assert may_rest(replace(problem, contacts=contacts)) is rests


def test_friction_that_is_not_needed_and_friction_that_is_not_enough() -> None:
    problem = on_tray(0.5)
    assert least_friction(problem).factor == 0.0
    assert "without friction" in least_friction(problem).in_short()
    lifted = replace(problem, force_W=[0.0, 0.0, 1.0])
    assert least_friction(lifted).factor == math.inf
    assert least_friction(lifted).modes_below == ("ssss",)
    assert "no friction holds it" in least_friction(lifted).in_short()


def test_two_fingers_that_press_hard_enough_hold_with_any_friction() -> None:
    fingers = ContactSet(
        p_WC_W=[[x, y, 0] for x in (-0.05, 0.05) for y in (-0.02, 0.02)],
        normals_W=[[1, 0, 0]] * 2 + [[-1, 0, 0]] * 2,
        frictions=0.5,
    )
    state = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1])
    found = least_friction(spatial_problem(BOX.mass_properties, state, fingers, [0, 0, -MASS * G]))
    assert 0.0 < found.factor < 1e-9
    assert "any friction above 0, with large contact forces" in found.in_short()


def positively_spans(wrenches: NDArray[np.float64]) -> bool:
    """Whether positive combinations of rows are all of R^6, by a linear program."""
    if np.linalg.matrix_rank(wrenches) < 6:
        return False
    zero = linprog(np.zeros(len(wrenches)), A_eq=wrenches.T, b_eq=np.zeros(6), bounds=(1.0, None))
    return bool(zero.status == 0)


@seeds(range(2), slow=range(2, 5))
def test_closure_of_drawn_grasps_is_that_of_a_linear_program(seed: int) -> None:
    random = np.random.default_rng(seed)
    seen = set()
    for _ in range(20):
        n = int(random.integers(2, 12))
        normals = random.normal(size=(n, 3))
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        points = -0.1 * normals + 0.04 * random.normal(size=(n, 3))
        grasp = ContactSet(p_WC_W=points, normals_W=normals, frictions=random.uniform(0.05, 0.6))
        found = closure(grasp)
        assert found.form is positively_spans(pyramid_wrenches(grasp, 3, 0.0))
        inner = positively_spans(pyramid_wrenches(grasp, 48, 1.0))
        outer = positively_spans(pyramid_wrenches(grasp, 48, 1.0 / math.cos(math.pi / 48)))
        assert found.force is inner or inner is not outer
        seen.add((found.form, found.force))
    assert len(seen) > 1


def test_closure_in_words() -> None:
    opposite = ContactSet(
        p_WC_W=[[-0.1, 0, 0], [0.1, 0, 0]], normals_W=[[1, 0, 0], [-1, 0, 0]], frictions=0.5
    )
    assert (
        closure(opposite).in_short() == "Closure: neither form nor force closure"
    )  # it turns about the line
    three = ContactSet(
        p_WC_W=[[-0.1, 0, 0], [0.1, 0, 0.05], [0.1, 0.05, 0]],
        normals_W=[[1, 0, 0], [-1, 0, 0], [-1, 0, 0]],
        frictions=0.5,
    )
    assert closure(three).in_short() == "Closure: force closure"
    assert not closure(three.subset([])).force


@pytest.mark.parametrize("heading", [0.0, 0.2, math.pi / 8.0, 0.6])
def test_a_cup_tips_over_the_sides_of_an_octagon(heading: float) -> None:
    """As documented, a flush rim counts as eight points: 92 % to 100 % of the tangent of the tilt."""
    radius, height = 0.05, 0.1
    cup = Body.cylinder(radius, 2.0 * height, 1.0)
    floor = Surface(name="tray", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=2.0, restitution=0.0)
    state = BodyState(p_WB_W=[0, 0, height], q_WB=[0, 0, 0, 1])
    problem = SpatialContactProblem.of(cup, state, World(surfaces=(floor,), gravity_W=[0, 0, -G]))
    tilt = largest_tilt(problem, [math.cos(heading), math.sin(heading), 0.0]).factor
    from_middle = math.remainder(heading - math.pi / 8.0, math.pi / 4.0)  # of a side
    reach = radius * math.cos(math.pi / 8.0) / math.cos(from_middle)
    assert math.tan(tilt) == pytest.approx(reach / height, rel=1e-9)
