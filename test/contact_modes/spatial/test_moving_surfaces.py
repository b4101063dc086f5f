# SPDX-License-Identifier: Apache-2.0
"""Contact modes on surfaces that move: belts, carts, trays and turntables."""

from __future__ import annotations

import itertools
import warnings
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import contact_dynamics as cd
from contact_dynamics.contact import ContactUncertainty, Curvatures
from contact_dynamics.contact_modes import (
    SpatialMode,
    geometry_margins,
    refused_modes,
    spatial_kinematic_modes,
    wrench_sets,
)
from contact_dynamics.errors import FarContactWarning, InvalidFieldError, NotSupportedError
from oracles.relative_motion import RigidMotion, over
from sweeps import seeds

G = 9.81
UP = (0.0, 0.0, 1.0)
MU = 0.5
STILL = np.zeros(3)


def surface(name: str = "cart", normal: tuple[float, float, float] = UP, **changes: object) -> cd.Surface:
    fields = {"p_WS_W": [0, 0, 0], "normal_W": normal, "friction": MU, "restitution": 0.0, **changes}
    return cd.Surface(name=name, **fields)  # type: ignore[arg-type]


def modes_on(
    body: cd.Body, state: cd.BodyState, *surfaces: cd.Surface, **push: list[float]
) -> tuple[cd.SpatialContactProblem, tuple[SpatialMode, ...]]:
    world = cd.World(surfaces=surfaces, gravity_W=[0, 0, -G])
    problem = cd.SpatialContactProblem.of(body, state, world, **push)
    answer = cd.contact_modes(problem)
    assert answer.problem is problem
    assert answer.verdict.name in {"UNIQUE", "INDETERMINATE"}
    return problem, answer.modes


BOX = cd.Body.box((0.2, 0.3, 0.1), 2.0)
ON_FLOOR = cd.BodyState(p_WB_W=[0, 0, 0.05], q_WB=[0, 0, 0, 1])


@pytest.mark.parametrize("way", [(1.0, 0.0, 0.0), (-0.6, 0.8, 0.0)])
@pytest.mark.parametrize("speed", [0.0, 7.0])
def test_a_block_rides_on_a_cart_up_to_mu_g(way: tuple[float, float, float], speed: float) -> None:
    along = np.array(way)
    riding = replace(ON_FLOOR, v_WB_W=speed * along)
    for a, letters in ((0.999 * MU * G, "ffff"), (1.001 * MU * G, "cccc"), (3.0 * MU * G, "cccc")):
        _, (mode,) = modes_on(BOX, riding, surface(v_WS_W=speed * along, a_WS_W=a * along))
        assert mode.mode == letters
        np.testing.assert_allclose(mode.acceleration_W, min(a, MU * G) * along, atol=1e-12)
        np.testing.assert_allclose(mode.angular_acceleration_W, STILL, atol=1e-11)
        slip = (min(a, MU * G) - a) * along  # relative to the cart
        np.testing.assert_allclose(mode.contact_accelerations_W, np.tile(slip, (4, 1)), atol=1e-12)
        if letters == "cccc":
            np.testing.assert_allclose(mode.tangential_directions_W, np.tile(-along, (4, 1)), atol=1e-11)


def test_a_tall_cup_tips_on_a_cart_before_it_slips() -> None:
    width, height = 0.08, 0.4
    cup = cd.Body.box((width, width, height), 0.3)
    standing = cd.BodyState(p_WB_W=[0, 0, height / 2], q_WB=[0, 0, 0, 1])
    tips = G * width / height
    problem, (mode,) = modes_on(cup, standing, surface(a_WS_W=[0.9 * tips, 0, 0]))
    assert mode.mode == "ffff"
    more = cd.largest_load(problem, force_W=[-0.3, 0, 0])  # a further m/s^2 of the cart
    assert more.factor == pytest.approx(0.1 * tips, rel=1e-9)
    assert cd.statics(problem).equilibrium.name == "CERTAIN"
    _, (mode,) = modes_on(cup, standing, surface(a_WS_W=[1.1 * tips, 0, 0]))
    assert set(mode.mode) == {"s", "f"}
    # The moment about the edge that stays turns it: I_edge alpha = m (a h / 2 - g w / 2).
    inertia = 0.3 * (width**2 + height**2) / 3.0
    turn = 0.3 * (1.1 * tips * height - G * width) / 2.0 / inertia
    np.testing.assert_allclose(mode.angular_acceleration_W, [0, -turn, 0], atol=1e-11)


@pytest.mark.parametrize("radius", [0.1, 0.9])
def test_a_block_on_a_turntable_slips_at_mu_g_over_the_square_of_its_rate(radius: float) -> None:
    coin = cd.Body.box((2e-3, 2e-3, 2e-3), 0.01)
    rate = np.sqrt(MU * G / radius)
    for share, letter in ((0.999, "f"), (1.001, "c")):
        w = np.array([0, 0, share * rate])
        state = cd.BodyState(
            p_WB_W=[radius, 0, 1e-3], q_WB=[0, 0, 0, 1], v_WB_W=np.cross(w, [radius, 0, 0]), w_WB_W=w
        )
        _, (mode,) = modes_on(coin, state, surface("turntable", w_WS_W=w))
        assert letter in mode.mode
        if letter == "f":
            assert mode.mode == "ffff"
            np.testing.assert_allclose(mode.acceleration_W, [-(w[2] ** 2) * radius, 0, 0], atol=1e-11)
        else:
            assert mode.acceleration_W[0] == pytest.approx(-MU * G, rel=1e-6)


def test_a_ball_that_rolls_on_a_turntable_turns_aside_by_two_sevenths_of_its_rate() -> None:
    """A uniform ball runs on a circle with 2/7 of the turntable's angular velocity."""
    radius, rate = 0.05, np.array([0, 0, 3.0])
    ball = cd.Body.sphere(radius, 0.4)
    place, v = np.array([0.3, -0.2, radius]), np.array([0.7, 0.4, 0.0])
    # It rolls: v + w x (0, 0, -radius) is the velocity of the turntable there.
    of_table = np.cross(rate, place)
    w = np.cross(UP, v - of_table) / radius
    state = cd.BodyState(p_WB_W=place, q_WB=[0, 0, 0, 1], v_WB_W=v, w_WB_W=w + 0.2 * rate)
    turntable = surface("turntable", w_WS_W=rate)
    _, (mode,) = modes_on(ball, state, turntable)
    assert mode.mode == "f"
    np.testing.assert_allclose(mode.acceleration_W, np.cross(2.0 / 7.0 * rate, v), atol=1e-12)
    # A lid that lifts off has another motion, so that there is no common frame.
    lid = surface("lid", (0.0, 0.0, -1.0), p_WS_W=[0, 0, 2 * radius], a_WS_W=[0, 0, 1.0])
    _, (mode,) = modes_on(ball, state, turntable, lid)
    assert mode.mode == "fs"
    np.testing.assert_allclose(mode.acceleration_W, np.cross(2.0 / 7.0 * rate, v), atol=1e-12)


def test_a_box_between_a_belt_and_a_fixed_wall_is_pressed_on_it() -> None:
    belt = surface("belt", v_WS_W=[1.0, 0, 0])
    wall = surface("wall", (-1.0, 0.0, 0.0), p_WS_W=[0.1, 0, 0], friction=0.0)
    _, (mode,) = modes_on(BOX, ON_FLOOR, belt, wall)
    np.testing.assert_allclose(mode.acceleration_W, STILL, atol=1e-12)
    np.testing.assert_allclose(mode.contact_forces_W[:4].sum(axis=0), [MU * 2 * G, 0, 2 * G], atol=1e-11)
    np.testing.assert_allclose(mode.contact_forces_W[4:].sum(axis=0), [-MU * 2 * G, 0, 0], atol=1e-11)
    # The belt pulls it out sideways as soon as it moves at an angle.
    _, (mode,) = modes_on(BOX, ON_FLOOR, replace(belt, v_WS_W=[3.0, 4.0, 0]), wall)
    assert mode.acceleration_W[1] == pytest.approx(0.8 * MU * G, abs=1e-12)
    # A belt that gains speed instead drags it too; towards the wall, the wall takes it.
    for a, expected in ((-2.0, -2.0), (-20.0, -MU * G), (2.0, 0.0)):
        _, modes = modes_on(BOX, ON_FLOOR, surface("belt", a_WS_W=[a, 0, 0]), wall)
        assert {round(float(mode.acceleration_W[0]), 9) for mode in modes} == {round(expected, 9)}


def test_fingers_that_move_apart_let_go_and_those_that_close_cannot_be() -> None:
    """Two fingers hold a box without gravity. Accelerations of both, not of one rigid body, decide."""
    left = surface("left", (1.0, 0.0, 0.0), p_WS_W=[-0.1, 0, 0])
    right = surface("right", (-1.0, 0.0, 0.0), p_WS_W=[0.1, 0, 0])
    world = cd.World(surfaces=(left, replace(right, a_WS_W=[0.5, 0, 0])), gravity_W=STILL)
    answer = cd.contact_modes(cd.SpatialContactProblem.of(BOX, ON_FLOOR, world, force_W=[0.1, 0, 0]))
    assert answer.verdict.name == "UNIQUE"
    np.testing.assert_allclose(answer.modes[0].acceleration_W, [0.05, 0, 0], atol=1e-12)
    assert answer.modes[0].mode == "ssssssss"
    closing = replace(world, surfaces=(left, replace(right, a_WS_W=[-0.5, 0, 0])))
    answer = cd.contact_modes(cd.SpatialContactProblem.of(BOX, ON_FLOOR, closing))
    assert answer.modes == ()
    assert answer.verdict.name == "INCONSISTENT"  # rigid bodies cannot be squeezed
    assert (
        cd.contact_modes(
            cd.SpatialContactProblem.of(
                BOX, ON_FLOOR, replace(world, surfaces=(left, replace(right, v_WS_W=[-0.5, 0, 0])))
            )
        ).verdict.name
        == "IMPACT"
    )


# Random problems


def moving_problem(seed: int, *, one_motion: bool) -> tuple[cd.SpatialContactProblem, list[RigidMotion]]:
    """Contacts at rest and sliding, on surfaces that move as one or each by itself, and their motions."""
    chance = np.random.default_rng(seed)
    n = int(chance.integers(1, 4))
    body = cd.Body.box(chance.uniform(0.1, 0.5, 3), float(chance.uniform(0.5, 3.0))).mass_properties
    state = cd.BodyState(
        p_WB_W=chance.normal(size=3),
        q_WB=Rotation.random(random_state=seed).as_quat(),
        v_WB_W=chance.normal(size=3),
        w_WB_W=chance.normal(size=3),
    )
    moving = RigidMotion(state.p_WB_W, state.v_WB_W, state.w_WB_W, STILL, STILL)
    common = RigidMotion(*chance.normal(size=(5, 3)))
    points = state.p_WB_W + 0.2 * chance.normal(size=(n, 3))
    normals = chance.normal(size=(n, 3)) + 2.0 * np.array(UP)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    motions = []
    for i in range(n):
        own = RigidMotion(*chance.normal(size=(5, 3)))
        # Velocities are such that contacts touch, and every other one is at rest.
        relative = np.cross(normals[i], chance.normal(size=3)) * (i % 2)
        velocity = moving.at(points[i])[0] - relative
        motions.append(own._replace(point=points[i], v=velocity))
    if one_motion:  # the body moves with the surfaces, and slides and turns on one of them alone
        motions = [common] * n
        slide, spin = (np.cross(normals[0], chance.normal(size=3)), normals[0]) if n == 1 else (STILL, STILL)
        v = common.at(state.p_WB_W)[0] + slide - np.cross(spin, points[0] - state.p_WB_W)
        state = state.with_velocities(v, common.w + spin)
        if n > 1:  # another surface leaves the body
            leaving = (
                RigidMotion(state.p_WB_W, v, common.w + spin, STILL, STILL).at(points[-1])[0] - normals[-1]
            )
            motions[-1] = own._replace(point=points[-1], v=leaving)
    contacts = cd.ContactSet(
        p_WC_W=points,
        normals_W=normals,
        frictions=chance.uniform(0.1, 1.2, n),
        surface_velocities_W=[one.at(p)[0] for one, p in zip(motions, points, strict=True)],
        surface_angular_velocities_W=[one.w for one in motions],
        surface_accelerations_W=[one.at(p)[1] for one, p in zip(motions, points, strict=True)],
    )
    problem = cd.SpatialContactProblem(
        body=body,
        state=state,
        contacts=contacts,
        force_W=10.0 * (chance.normal(size=3) - normals.mean(axis=0)),
        torque_W=chance.normal(size=3),
    )
    return problem, motions


def check_laws(problem: cd.SpatialContactProblem, motions: list[RigidMotion], mode: SpatialMode) -> None:
    """Newton's law in the world, Coulomb's cone, and letters by how points move over their surfaces."""
    body, state, contacts = problem.body, problem.state, problem.contacts
    inertia, forces = body.inertia_in_world(state.R_WB), mode.contact_forces_W
    scale = float(np.abs(forces).sum() + np.abs(problem.force_W).sum()) + 1.0
    np.testing.assert_allclose(
        body.mass * mode.acceleration_W, problem.force_W + forces.sum(axis=0), atol=1e-10 * scale
    )
    torque = problem.torque_W + np.cross(contacts.p_WC_W - state.p_WB_W, forces).sum(axis=0)
    spun = inertia @ mode.angular_acceleration_W + np.cross(state.w_WB_W, inertia @ state.w_WB_W)
    np.testing.assert_allclose(spun, torque, atol=1e-10 * scale)
    moving = RigidMotion(
        state.p_WB_W, state.v_WB_W, state.w_WB_W, mode.acceleration_W, mode.angular_acceleration_W
    )
    for i, (letter, contact) in enumerate(zip(mode.mode, contacts, strict=True)):
        velocity, acceleration = over(moving, motions[i], contact.p_WC_W)
        fast = 1.0 + float(np.abs(acceleration).max()) + scale / body.mass
        np.testing.assert_allclose(mode.contact_accelerations_W[i], acceleration, atol=1e-9 * fast)
        normal, force = contact.normal_W, forces[i]
        pressing = float(force @ normal)
        across = force - pressing * normal
        assert pressing >= -1e-9 * scale
        assert np.linalg.norm(across) <= contact.friction * pressing + 1e-8 * scale
        rising = float(acceleration @ normal)
        if letter == "s":
            assert not force.any()
            assert velocity @ normal > 1e-9 or rising > 0.0
            continue
        assert abs(rising) <= 1e-8 * fast
        sliding = velocity - (velocity @ normal) * normal
        if np.linalg.norm(sliding) <= problem.velocity_tolerance:
            sliding = acceleration - rising * normal
        if letter == "f":
            assert np.linalg.norm(velocity) <= problem.velocity_tolerance
            np.testing.assert_allclose(acceleration, STILL, atol=1e-7 * fast)
        else:
            way = sliding / np.linalg.norm(sliding)
            np.testing.assert_allclose(across, -contact.friction * pressing * way, atol=1e-6 * scale)


@pytest.mark.parametrize("one_motion", [True, False])
@seeds(range(10), slow=range(10, 400))
def test_modes_obey_the_laws_by_how_points_move_over_their_surfaces(seed: int, *, one_motion: bool) -> None:
    problem, motions = moving_problem(seed, one_motion=one_motion)
    answer = cd.contact_modes(problem)
    assert answer.verdict.name != "IMPACT"
    for mode in answer.modes:
        check_laws(problem, motions, mode)


@seeds(range(15), slow=range(15, 200))
def test_modes_are_those_of_a_still_problem_with_explicit_pseudo_forces(seed: int) -> None:
    """A still world, and the same seen from a frame that turns and accelerates, with its pseudo-forces."""
    chance = np.random.default_rng(1000 + seed)
    moving, _ = moving_problem(seed, one_motion=False)
    at_rest = dict.fromkeys(cd.ContactSet.SURFACE_MOTION)
    state = moving.state
    points, normals = moving.contacts.p_WC_W, moving.contacts.normals_W
    v, w = (0.0 * STILL, 0.0 * STILL) if seed % 3 else (STILL, chance.normal() * normals[0])
    v = v - np.cross(w, points[0] - state.p_WB_W)
    still = replace(moving, state=state.with_velocities(v, w), contacts=replace(moving.contacts, **at_rest))
    first = cd.contact_modes(still)
    frame = RigidMotion(*chance.normal(size=(5, 3)))
    # What is at rest in the frame moves like that; a velocity there adds to it, as does an acceleration.
    W, A = frame.w, frame.alpha
    v_frame, a_frame = frame.at(state.p_WB_W)
    v_world, w_world = v_frame + v, W + w
    pseudo = a_frame + 2.0 * np.cross(W, v)
    alpha_pseudo = A + np.cross(W, w)
    inertia = still.body.inertia_in_world(state.R_WB)
    force = still.force_W + still.body.mass * pseudo
    torque = (
        still.torque_W
        + inertia @ alpha_pseudo
        + np.cross(w_world, inertia @ w_world)
        - np.cross(w, inertia @ w)
    )
    carried = replace(
        still.contacts,
        surface_velocities_W=[frame.at(p)[0] for p in points],
        surface_angular_velocities_W=W,
        surface_accelerations_W=[frame.at(p)[1] for p in points],
    )
    second = cd.contact_modes(
        replace(
            still,
            state=state.with_velocities(v_world, w_world),
            contacts=carried,
            force_W=force,
            torque_W=torque,
        )
    )
    assert second.verdict == first.verdict
    assert [mode.mode for mode in second.modes] == [mode.mode for mode in first.modes]
    for one, two in zip(first.modes, second.modes, strict=True):
        size = 1e-9 * (1.0 + np.abs(one.contact_forces_W).max())
        np.testing.assert_allclose(two.acceleration_W, one.acceleration_W + pseudo, atol=size)
        np.testing.assert_allclose(
            two.angular_acceleration_W, one.angular_acceleration_W + alpha_pseudo, atol=100 * size
        )
        np.testing.assert_allclose(two.contact_forces_W, one.contact_forces_W, atol=size)
        np.testing.assert_allclose(two.contact_accelerations_W, one.contact_accelerations_W, atol=10 * size)


@seeds(range(20), slow=range(20, 400))
def test_no_mode_is_missed_where_all_contacts_slide(seed: int) -> None:
    """Friction is then known, so that each string of s and c is one system of linear equations."""
    problem, motions = moving_problem(seed, one_motion=False)
    chance = np.random.default_rng(seed)
    contacts, state = problem.contacts, problem.state
    n = len(contacts)
    ways = np.cross(contacts.normals_W, chance.normal(size=(n, 3)))
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    moving = RigidMotion(state.p_WB_W, state.v_WB_W, state.w_WB_W, STILL, STILL)
    velocities = np.array([moving.at(p)[0] for p in contacts.p_WC_W])
    motions = [m._replace(v=v) for m, v in zip(motions, velocities - ways, strict=True)]
    problem = replace(problem, contacts=replace(contacts, surface_velocities_W=velocities - ways))
    edges = contacts.normals_W - contacts.frictions[:, None] * ways
    inverse = np.linalg.inv(problem.body.inertia_in_world(state.R_WB))
    gyroscopic = np.cross(state.w_WB_W, np.linalg.solve(inverse, state.w_WB_W))

    def rises(forces: np.ndarray) -> np.ndarray:
        each = forces[:, None] * edges
        torque = problem.torque_W - gyroscopic + np.cross(contacts.p_WC_W - state.p_WB_W, each).sum(axis=0)
        a, alpha = (problem.force_W + each.sum(axis=0)) / problem.body.mass, inverse @ torque
        now = moving._replace(a=a, alpha=alpha)
        return np.array(
            [
                over(now, motion, p)[1] @ normal
                for motion, p, normal in zip(motions, contacts.p_WC_W, contacts.normals_W, strict=True)
            ]
        )

    free = rises(np.zeros(n))
    matrix = np.column_stack([rises(unit) - free for unit in np.eye(n)])
    expected = set()
    for staying in itertools.product([False, True], repeat=n):
        on = np.flatnonzero(staying)
        forces = np.zeros(n)
        forces[on] = np.linalg.solve(matrix[np.ix_(on, on)], -free[on])
        left = rises(forces)
        left[on] = 1.0
        if forces.min() >= 0.0 and left.min() > 0.0:
            expected.add("".join("c" if stays else "s" for stays in staying))
    answer = cd.contact_modes(problem)
    assert {mode.mode for mode in answer.modes} == expected
    assert answer.verdict.name == (
        "UNIQUE" if len(expected) == 1 else "INDETERMINATE" if expected else "INCONSISTENT"
    )


@pytest.mark.parametrize("one_motion", [True, False])
@seeds(range(4), slow=range(4, 100))
def test_margins_end_the_mode_and_no_smaller_change_does(seed: int, *, one_motion: bool) -> None:
    problem, _ = moving_problem(seed, one_motion=one_motion)
    answer = cd.contact_modes(problem)
    for margin in cd.mode_margins(problem, answer):
        if not np.isfinite(margin.margin) or margin.margin == 0.0:
            continue
        for share, inside in ((0.999, True), (1.001, False)):
            wrench = problem.wrench_W + share * margin.change_W
            there = cd.contact_modes(replace(problem, force_W=wrench[:3], torque_W=wrench[3:]))
            if there.verdict.name != "UNDECIDED":
                assert (margin.mode in {mode.mode for mode in there.modes}) == inside


@pytest.mark.parametrize("one_motion", [True, False])
@seeds(range(3), slow=range(3, 30))
def test_the_applied_wrench_lies_in_the_set_of_each_of_its_modes(seed: int, *, one_motion: bool) -> None:
    problem, _ = moving_problem(seed, one_motion=one_motion)
    problem = replace(problem, friction_facets=4, sharpen=False)
    found = {mode.mode for mode in cd.contact_modes(problem).modes}
    sets = wrench_sets(problem)
    inside = {one.mode for one in sets if one.depth(problem.wrench_W, 0.1) >= 0.0}
    assert inside == found
    for one in sets:
        for vertex in one.vertices:
            assert one.depth(vertex, 0.1) >= -1e-6 * (1.0 + np.abs(vertex).max())


def test_refused_modes_and_kinematic_modes_take_surfaces_that_move() -> None:
    for a, possible in ((0.5, ("c", "s")), (-0.5, ("c", "s"))):
        contact = cd.ContactSet(
            p_WC_W=[[0, 0, -0.1]], normals_W=UP, frictions=0.0, surface_accelerations_W=[0, 0, a]
        )
        problem = cd.SpatialContactProblem(
            body=BOX, state=replace(ON_FLOOR, p_WB_W=STILL), contacts=contact, force_W=[0, 0, -0.2]
        )
        assert spatial_kinematic_modes(problem.state, contact) == possible
        answer = cd.contact_modes(problem)
        (refused,) = refused_modes(problem, answer)
        # The body falls with 0.1 m/s^2: the surface catches it, or leaves it.
        assert (answer.modes[0].mode, refused.mode) == (("f", "s") if a > -0.1 else ("s", "c"))
        assert refused.amount == pytest.approx(-0.1 - a if a > -0.1 else 2.0 * (0.1 + a), abs=1e-12)


def test_statics_are_those_of_a_body_at_rest_on_its_surfaces() -> None:
    """On a cart that accelerates it is that of a floor under a load that leans, on a turntable outwards."""
    leaning = modes_on(BOX, ON_FLOOR, surface(), force_W=[-4.0, 0, 0])[0]
    carted = modes_on(BOX, ON_FLOOR, surface(v_WS_W=[1, 2, 0], a_WS_W=[2.0, 0, 0]))[0]
    turned = modes_on(BOX, ON_FLOOR, surface(p_WS_W=[0.5, 0, 0], w_WS_W=[0, 0, 2.0]))[0]
    expected = cd.statics(leaning)
    for other in (carted, turned):
        found = cd.statics(other)
        assert found.equilibrium == expected.equilibrium
        assert found.stable_disturbance == pytest.approx(expected.stable_disturbance, rel=1e-9)
    load = {"force_W": [0.0, 1.0, 0.0], "at_W": [0.0, 0.0, 0.0]}
    resting = replace(carted, state=replace(ON_FLOOR, v_WB_W=np.array([1.0, 2.0, 0.0])))
    assert cd.largest_load(resting, **load).factor == pytest.approx(cd.largest_load(leaning, **load).factor)
    with pytest.raises(InvalidFieldError, match="stays fixed without the additional load or motion"):
        cd.largest_load(carted, **load)  # it slides on the cart


def test_uncertain_contacts_are_those_of_a_still_problem_seen_from_the_cart() -> None:
    off = ContactUncertainty(points=1e-4, normals=1e-3)
    leaning = modes_on(BOX, ON_FLOOR, surface(), force_W=[-4.0, 0, 0])[0]
    carted = modes_on(BOX, ON_FLOOR, surface(a_WS_W=[2.0, 0, 0]))[0]
    three = [
        replace(one, contacts=one.contacts.subset([0, 1, 2]), uncertainty=off) for one in (leaning, carted)
    ]
    still, moving = (cd.contact_modes(one).within for one in three)
    assert still is not None
    assert moving is not None
    assert (moving.verdicts, moving.modes, moving.certain) == (still.verdicts, still.modes, still.certain)


def test_what_needs_surfaces_that_move_as_one_says_so() -> None:
    belt, wall = surface("belt", v_WS_W=[1, 0, 0]), surface("wall", (-1.0, 0.0, 0.0), p_WS_W=[0.1, 0, 0])
    problem, _ = modes_on(BOX, ON_FLOOR, belt, wall)
    uncertain = replace(problem, uncertainty=ContactUncertainty(points=1e-4))
    for call in (
        lambda: cd.statics(problem),
        lambda: cd.largest_load(problem, force_W=[0, 1, 0]),
        lambda: geometry_margins(problem),
        lambda: cd.contact_modes(uncertain),
    ):
        with pytest.raises(NotSupportedError, match="or surfaces that move as one rigid body"):
            call()


def test_a_wall_that_a_body_leaves_keeps_its_own_motion() -> None:
    """A box on a cart moves off a fixed wall, whose contacts are reported relative to the wall."""
    riding = replace(ON_FLOOR, v_WB_W=np.array([-1.0, 0, 0]))
    wall = surface("wall", (-1.0, 0.0, 0.0), p_WS_W=[0.1, 0, 0])
    _, (mode,) = modes_on(BOX, riding, surface(v_WS_W=[-1.0, 0, 0], a_WS_W=[-2.0, 0, 0]), wall)
    assert mode.mode == "ffffssss"
    np.testing.assert_allclose(mode.acceleration_W, [-2.0, 0, 0], atol=1e-12)
    np.testing.assert_allclose(mode.contact_accelerations_W[:4], np.zeros((4, 3)), atol=1e-12)
    np.testing.assert_allclose(mode.contact_accelerations_W[4:], np.tile([-2.0, 0, 0], (4, 1)), atol=1e-12)


def test_a_disc_on_two_belts_has_the_terms_of_curved_sides_relative_to_each() -> None:
    """A cylinder is held between two rollers' belts: it turns at half the difference of their speeds."""
    radius, v_low, v_high = 0.1, 0.4, 1.0
    points = [[0, 0, -radius], [0, 0, radius]]
    disc = cd.Body.cylinder(radius, 0.2, 1.0)
    curved = Curvatures(along=[1 / radius] * 2, across=[0.0] * 2, directions_W=[[1, 0, 0]] * 2)
    contacts = cd.ContactSet(
        p_WC_W=points,
        normals_W=[UP, (0, 0, -1)],
        frictions=0.5,
        body_curvatures=replace(curved, across=[1.0] * 2),
        surface_velocities_W=[[v_low, 0, 0], [v_high, 0, 0]],
    )
    state = cd.BodyState(
        p_WB_W=STILL,
        q_WB=Rotation.from_euler("x", 90, degrees=True).as_quat(),
        v_WB_W=[0.5 * (v_low + v_high), 0, 0],
        w_WB_W=[0, 0.5 * (v_high - v_low) / radius, 0],
    )
    problem = cd.SpatialContactProblem(body=disc, state=state, contacts=contacts, force_W=[0, 0, -G])
    answer = cd.contact_modes(problem)
    assert [mode.mode for mode in answer.modes] == ["ff"]
    np.testing.assert_allclose(answer.modes[0].acceleration_W, STILL, atol=1e-12)
    np.testing.assert_allclose(answer.modes[0].angular_acceleration_W, STILL, atol=1e-10)


def test_a_box_rests_on_a_tray_that_falls_freely_and_turns() -> None:
    """What is left of its weight is rounding, which must not say that it leaves or slides."""
    turn = Rotation.from_euler("xyz", [0.3, -0.2, 0.7])
    place, w = np.array([0.3, 0.1, 0.7]), np.array([0.0, 0.0, 0.0])
    for v in (STILL, np.array([0.1, 0.7, -3.3])):
        state = cd.BodyState(p_WB_W=place, q_WB=turn.as_quat(), v_WB_W=v, w_WB_W=w)
        under = place - turn.apply([0, 0, 0.05])
        tray = surface("tray", p_WS_W=under, normal_W=turn.apply(UP), v_WS_W=v, a_WS_W=[0, 0, -G])
        _, (mode,) = modes_on(BOX, state, tray)
        assert mode.mode == "ffff"
        assert not mode.contact_forces_W.any()
        np.testing.assert_allclose(mode.acceleration_W, [0, 0, -G], atol=1e-12)


@pytest.mark.parametrize(
    ("moving", "spin"), [({"a_WS_W": [1e60, 0, 0]}, 0.0), ({"w_WS_W": [0, 0, 1e26]}, 1e36)]
)
def test_an_extreme_motion_is_not_blamed_on_the_wrench(moving: dict[str, object], spin: float) -> None:
    """On surfaces that move, the body's own motion and theirs cause inertial forces beyond the limit."""
    still = cd.SpatialContactProblem.of(BOX, ON_FLOOR, cd.World(surfaces=(surface(**moving),)))
    tilted = cd.MassProperties(mass=2.0, I_B=[[0.2, 0.0, 0.05], [0.0, 0.3, 0.0], [0.05, 0.0, 0.25]])
    problem = replace(still, body=tilted, state=ON_FLOOR.with_velocities(STILL, [0, 0, spin]))
    with pytest.raises(InvalidFieldError, match=r"^state, contacts: velocities and inertial wrench relative"):
        cd.contact_modes(problem)


def test_friction_and_points_beyond_all_scales_warn_of_no_overflow() -> None:
    problem = cd.SpatialContactProblem.of(BOX, ON_FLOOR, cd.World(surfaces=(surface(friction=1e200),)))
    assert cd.statics(problem).equilibrium.name == "CERTAIN"
    points = problem.contacts.p_WC_W.copy()
    points[0, 0] -= 1e59
    far = replace(problem, contacts=replace(problem.contacts, p_WC_W=points, frictions=MU))
    with warnings.catch_warnings(action="ignore", category=FarContactWarning):
        assert cd.contact_modes(far).verdict.name == "UNDECIDED"


def test_a_box_that_is_put_on_a_belt_is_dragged_along() -> None:
    _, (mode,) = modes_on(BOX, ON_FLOOR, surface("belt", v_WS_W=[0.0, 1.5, 0.0]))
    assert mode.mode == "cccc"
    np.testing.assert_allclose(mode.acceleration_W, [0, MU * G, 0], atol=1e-12)
    np.testing.assert_allclose(mode.contact_accelerations_W, np.tile([0, MU * G, 0], (4, 1)), atol=1e-12)
    carried = replace(ON_FLOOR, v_WB_W=np.array([0.0, 1.5, 0.0]))
    _, (mode,) = modes_on(BOX, carried, surface("belt", v_WS_W=[0.0, 1.5, 0.0]))
    assert mode.mode == "ffff"


@pytest.mark.parametrize(("angle", "rate"), [(0.4, 0.0), (0.0, 3.0), (-0.3, 2.0), (0.9, 5.0)])
def test_a_cup_on_a_tray_that_swings_freely_feels_no_force_along_it(angle: float, rate: float) -> None:
    """The waiter's trick: a tray that swings from a pivot pulls on the cup along its normal only."""
    length, height = 1.2, 0.1
    cup = cd.Body.box((0.06, 0.06, height), 0.2)
    alpha = -G / length * np.sin(angle)  # a pendulum whose length is that to the cup's centre of mass
    turn = Rotation.from_euler("y", -angle)
    pivot, w = np.array([0, 0, 2.0]), np.array([0, -rate, 0])
    arm = turn.apply([0, 0, -length])
    state = cd.BodyState(p_WB_W=pivot + arm, q_WB=turn.as_quat(), v_WB_W=np.cross(w, arm), w_WB_W=w)
    tray = surface(
        "tray",
        p_WS_W=pivot + turn.apply([0, 0, -length - height / 2]),
        normal_W=turn.apply(UP),
        friction=1e-3,
        v_WS_W=np.cross(w, turn.apply([0, 0, -length - height / 2])),
        w_WS_W=w,
        a_WS_W=np.cross(w, np.cross(w, turn.apply([0, 0, -length - height / 2])))
        + np.cross([0, -alpha, 0], turn.apply([0, 0, -length - height / 2])),
        alpha_WS_W=[0, -alpha, 0],
    )
    _, (mode,) = modes_on(cup, state, tray)
    assert mode.mode == "ffff"
    force = turn.inv().apply(mode.contact_forces_W.sum(axis=0))
    np.testing.assert_allclose(force, [0, 0, 0.2 * (G * np.cos(angle) + rate**2 * length)], atol=1e-11)
