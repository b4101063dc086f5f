# SPDX-License-Identifier: Apache-2.0
"""Sticking and sliding in space: closed forms, the planar answers in a plane of symmetry, evidence."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from contact_dynamics import BodyState, ContactSet, MassProperties, ModeVerdict
from contact_dynamics.contact_modes import SpatialContactProblem, contact_modes
from contact_dynamics.contact_modes.result import applied_wrench
from contact_dynamics.errors import InvalidFieldError, NoContactError, TooLargeError
from contact_dynamics.world import Body, Surface, World
from contact_modes.evidence import check_laws, planar_problem, spatial_problem
from oracles.contact_mode_cases import FloatCase, draw, rounded
from sweeps import seeds

MASS = 2.0
WEIGHT = MASS * 10.0
BODY = MassProperties(mass=MASS, I_B=np.diag([0.3, 0.4, 0.5]))
FEET = [(-1.0, -0.5, -0.2), (1.0, -0.5, -0.2), (1.0, 0.5, -0.2), (-1.0, 0.5, -0.2)]
SOLVED = 1e-7  # relative: linear programs are solved to 1e-9, and their errors add up


def on_floor(points: list[tuple[float, ...]], friction: float) -> ContactSet:
    return ContactSet(p_WC_W=np.array(points).reshape(-1, 3), normals_W=[0.0, 0.0, 1.0], frictions=friction)


def state(v: tuple[float, ...] = (0, 0, 0), w: tuple[float, ...] = (0, 0, 0)) -> BodyState:
    return BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0], v_WB_W=np.array(v), w_WB_W=np.array(w))


@pytest.mark.parametrize("contacts", [6, 9, 30])
def test_more_contacts_than_the_motion_has_dimensions(contacts: int) -> None:
    # A cup of contacts around the lower half: the weight rests in it, whatever pushes a little.
    angles = 2.0 * math.pi * np.arange(contacts) / contacts
    lean = 0.4 + 0.5 * (np.arange(contacts) % 3)
    normals = np.column_stack([np.sin(lean) * np.cos(angles), np.sin(lean) * np.sin(angles), np.cos(lean)])
    chance = np.random.default_rng(contacts)
    cup = ContactSet(
        p_WC_W=-normals + 0.1 * chance.normal(size=(contacts, 3)), normals_W=normals, frictions=0.8
    )
    wrench = np.array([0.3, 0.2, -WEIGHT, 0.1, 0.0, 0.2])
    problem = spatial_problem(BODY, state(), cup, wrench[:3], wrench[3:])
    answer = contact_modes(problem)
    assert "f" * contacts in [mode.mode for mode in answer.modes]
    for mode in answer.modes:
        check_laws(problem, mode, answer.flush_within)


def in_space(case: FloatCase) -> tuple[MassProperties, BodyState, ContactSet, np.ndarray]:
    """Put a planar case into the plane y = 0; the planar y is the world's z."""
    body, velocity, contacts, wrench = case
    inertia = body.inertia
    return (
        MassProperties(mass=body.mass, I_B=np.diag([0.8 * inertia, inertia, 0.9 * inertia])),
        state(v=(velocity.v[0], 0.0, velocity.v[1]), w=(0.0, -velocity.w, 0.0)),
        ContactSet(
            p_WC_W=np.array([(one.r[0], 0.0, one.r[1]) for one in contacts]),
            normals_W=np.array([(one.normal[0], 0.0, one.normal[1]) for one in contacts]),
            frictions=np.array([one.friction for one in contacts]),
        ),
        np.array([wrench.f[0], 0.0, wrench.f[1], 0.0, -wrench.moment, 0.0]),
    )


@seeds(range(40))
def test_every_planar_mode_is_one_in_space(seed: int) -> None:
    case = rounded(draw(seed, most_contacts=2))
    body, now, contacts, wrench = in_space(case)
    problem = spatial_problem(body, now, contacts, wrench[:3], wrench[3:], friction_facets=4)
    answer = contact_modes(problem)
    for mode in answer.modes:
        check_laws(problem, mode, answer.flush_within)
    planar = contact_modes(planar_problem(case[0], case[1], case[2], case[3]))
    for mode in planar.modes:
        # A frictionless contact that stays is c or f by its acceleration.
        letters = "".join("c" if letter in "lr" else letter for letter in mode.mode)
        alike = [one for one in answer.modes if one.mode == letters]
        assert alike
        if mode.motion_unique:
            x, z = mode.acceleration
            scale = 1e-5 * (1.0 + math.hypot(x, z) + abs(mode.angular_acceleration))
            assert any(
                np.abs(one.acceleration_W - [x, 0.0, z]).max() <= scale
                and abs(one.angular_acceleration_W[1] + mode.angular_acceleration) <= scale
                for one in alike
            )


def test_free_leaving_and_approaching_bodies() -> None:
    free = contact_modes(spatial_problem(BODY, state(w=(1, 2, 3)), on_floor([], 0.5), (0, 0, -WEIGHT)))
    (mode,) = free.modes
    assert mode.mode == ""
    L = BODY.I_B @ [1.0, 2.0, 3.0]
    np.testing.assert_allclose(BODY.I_B @ mode.angular_acceleration_W, -np.cross([1.0, 2.0, 3.0], L))
    contacts = on_floor(FEET, 0.5)
    leaving = contact_modes(spatial_problem(BODY, state(v=(0, 0, 1)), contacts, (0, 0, -WEIGHT)))
    assert [one.mode for one in leaving.modes] == ["ssss"]
    strikes = contact_modes(spatial_problem(BODY, state(v=(0, 0, -1)), contacts, (0, 0, -WEIGHT)))
    assert strikes.verdict == ModeVerdict.IMPACT
    assert strikes.approaching == (0, 1, 2, 3)


def drawn_feet(seed: int) -> tuple[ContactSet, np.ndarray]:
    """Return two feet and a wall, whose contacts slide in ways that no pyramid has an edge against."""
    chance = np.random.default_rng(seed)
    normals = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    points = np.array([[0.4, -0.5, -0.3], [0.3, 0.6, -0.3], [-0.9, 0.1, 0.0]]) + 0.1 * chance.normal(
        size=(3, 3)
    )
    contacts = ContactSet(p_WC_W=points, normals_W=normals, frictions=[0.2, 0.3, 0.2])
    return contacts, np.array([-15.0, 12.0, -WEIGHT, 0.0, 0.0, 0.0]) + chance.normal(size=6)


@seeds(range(10))
def test_a_pyramid_turns_friction_by_half_a_sector_at_most(seed: int) -> None:
    contacts, wrench = drawn_feet(seed)
    for facets in (6, 24):
        answer = contact_modes(
            spatial_problem(
                BODY, state(), contacts, wrench[:3], wrench[3:], friction_facets=facets, sharpen=False
            )
        )
        assert all(1e-6 < mode.misdirection <= math.pi / facets + 1e-9 for mode in answer.modes)


def test_four_feet_share_a_load_and_one_foot_has_no_choice() -> None:
    resting = contact_modes(spatial_problem(BODY, state(), on_floor(FEET, 0.4), (2.0, 0.0, -WEIGHT)))
    (mode,) = resting.modes
    assert (mode.motion_unique, mode.forces_unique) == (True, False)
    # Least squares: the load's line of force meets the floor 0.02 m from the middle.
    np.testing.assert_allclose(mode.contact_forces_W[:, :2], np.tile([-0.5, 0.0], (4, 1)), atol=1e-9)
    np.testing.assert_allclose(
        mode.contact_forces_W[:, 2], WEIGHT / 4.0 * np.array([0.98, 1.02, 1.02, 0.98]), atol=1e-9
    )
    balanced = contact_modes(
        spatial_problem(BODY, state(), on_floor([(0, 0, -0.2)], 0.4), (0.0, 0.0, -WEIGHT))
    )
    (mode,) = balanced.modes
    assert (mode.mode, mode.motion_unique, mode.forces_unique) == ("f", True, True)


def test_too_many_contacts_are_refused() -> None:
    with pytest.raises(TooLargeError, match="contacts"):
        contact_modes(spatial_problem(BODY, state(), on_floor(FEET * 9, 0.5), (0, 0, -1)))


def test_a_body_that_turns_about_its_contacts_has_the_modes_of_one_at_rest_under_another_load() -> None:
    """A corner in a groove and another one on a third flat: all points on the line between them rest.

    With their common centripetal acceleration c, the load of a body at rest with the same modes has m c more
    force, and the torque that the turning body needs less. The question had 4,539 programs and no end.
    """
    body = MassProperties(mass=0.08, I_B=np.diag([1.1e-4, 1.2e-4, 2.0e-4]))
    corner, other = np.array([0.0038, 0.0447, -0.1423]), np.array([-0.0469, -0.0655, 0.0236])
    normals = np.array([[0.964, -0.049, 0.2616], [-0.965, -0.03, 0.2616], [-0.043, 0.964, 0.2616]])
    contacts = ContactSet(
        p_WC_W=[corner, corner, other],
        normals_W=normals / np.linalg.norm(normals, axis=1)[:, None],
        frictions=[1.5, 0.05, 0.2],
    )
    w = 33.1 * (other - corner)
    load = np.array([0.0, 0.0, -0.776])
    turns = contact_modes(spatial_problem(body, state(-np.cross(w, corner), w), contacts, load))
    centripetal = np.cross(w, np.cross(w, corner))
    rests = contact_modes(
        spatial_problem(body, state(), contacts, load + body.mass * centripetal, -np.cross(w, body.I_B @ w))
    )
    assert turns.verdict == rests.verdict == ModeVerdict.UNIQUE
    assert turns.modes[0].mode == rests.modes[0].mode
    np.testing.assert_allclose(
        turns.modes[0].acceleration_W + centripetal, rests.modes[0].acceleration_W, atol=SOLVED
    )
    np.testing.assert_allclose(
        turns.modes[0].angular_acceleration_W, rests.modes[0].angular_acceleration_W, rtol=SOLVED
    )


LIGHT = MassProperties(mass=0.7, I_B=np.diag([0.02, 0.05, 0.06]))


@seeds(range(20))
def test_the_applied_wrench_follows_from_each_mode(seed: int) -> None:
    """The body is turned and spins, and up to three contacts leave or stay."""
    random = np.random.default_rng(seed)
    q = random.normal(size=4)
    turned = BodyState(
        p_WB_W=random.normal(size=3),
        q_WB=q / np.linalg.norm(q),
        w_WB_W=random.normal(size=3) * (0.0 if seed % 2 else 3.0),
    )
    arms = random.uniform(-0.2, 0.2, size=(1 + seed % 3, 3)) - (0.0, 0.0, 0.2)
    points = turned.p_WB_W + arms
    contacts = ContactSet(p_WC_W=points, normals_W=np.tile([0.0, 0.0, 1.0], (len(arms), 1)), frictions=0.5)
    approach = min(0.0, float(turned.velocity_of_point(points)[:, 2].min()))
    turned = BodyState(
        p_WB_W=turned.p_WB_W, q_WB=turned.q_WB, v_WB_W=[0.0, 0.0, -approach], w_WB_W=turned.w_WB_W
    )
    force_W, torque_W = random.normal(size=3) - (0.0, 0.0, 5.0), 0.1 * random.normal(size=3)
    problem = spatial_problem(LIGHT, turned, contacts, force_W, torque_W)
    found = contact_modes(problem)
    assert found.modes
    for mode in found.modes:
        wrench_W = applied_wrench(LIGHT, turned, contacts, mode)
        size = math.hypot(*force_W) + float(np.abs(mode.contact_forces_W).sum())
        np.testing.assert_allclose(wrench_W, [*force_W, *torque_W], atol=1e-9 * size)


def test_a_push_at_a_point_and_the_weight_make_the_wrench() -> None:
    """By hand: a crate of 20 kg that is pushed 0.2 m above its centre, and tips from m g 0.2 / 0.5 on."""
    crate = Body.box((0.4, 0.3, 0.6), mass=20.0, name="crate")
    floor = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.5, restitution=0.3)
    world = World(surfaces=(floor,), gravity_W=[0, 0, -10.0])
    turned = BodyState(p_WB_W=[1, 0, 0.3], q_WB=[0, 0, 0, 1])
    for push, mode in ((79.9, "ffff"), (80.1, "ssff")):
        problem = SpatialContactProblem.of(
            crate, turned, world, force_W=[push, 0, 0], at_W=[0.8, 0, 0.5], torque_W=[0, 0, 0.1]
        )
        np.testing.assert_allclose(problem.wrench_W, [push, 0, -200.0, 0, 0.2 * push, 0.1], atol=1e-12)
        assert [found.mode for found in contact_modes(problem).modes] == [mode]
    # A point without a force would be ignored. A sweep of pushes may begin at zero.
    with pytest.raises(InvalidFieldError, match=r"^at_W must be left out unless force_W is given"):
        SpatialContactProblem.of(crate, turned, world, torque_W=[0, 0, 0.1], at_W=[0.8, 0, 0.5])
    SpatialContactProblem.of(crate, turned, world, force_W=[0, 0, 0], at_W=[0.8, 0, 0.5])
    with pytest.raises(NoContactError, match=r"no point of 'crate' is within 1e-06 m of a surface"):
        SpatialContactProblem.of(crate, replace(turned, p_WB_W=[0, 0, 0.31]), world)
