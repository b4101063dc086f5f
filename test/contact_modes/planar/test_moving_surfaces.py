# SPDX-License-Identifier: Apache-2.0
"""Contact modes in the plane on surfaces that move."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

from contact_dynamics.contact import ContactUncertainty
from contact_dynamics.contact_modes import (
    PlanarContactProblem,
    PlanarModeAnswer,
    contact_modes,
    geometry_margins,
    mode_margins,
    refused_modes,
    statics,
    wrench_sets,
)
from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_dynamics.plane import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from contact_dynamics.plane.lifting import planar_in_space
from contact_modes.evidence import check_forces, planar_problem, spatial_problem
from oracles.contact_mode_cases import FloatCase, draw, rounded
from sweeps import seeds

G, MU = 9.81, 0.4
BLOCK = PlanarBody(mass=2.0, inertia=0.05)
WEIGHT = PlanarWrench(f=(0.0, -2.0 * G))


class Motion(NamedTuple):
    """A rigid motion in the plane; the velocity and acceleration are those of the origin."""

    v: tuple[float, float] = (0.0, 0.0)
    w: float = 0.0
    a: tuple[float, float] = (0.0, 0.0)
    alpha: float = 0.0

    def carried(self, contact: PlanarContact) -> PlanarContact:
        """Return the contact with a surface that moves like this."""
        x, y = contact.r
        return replace(
            contact,
            surface_velocity=(self.v[0] - self.w * y, self.v[1] + self.w * x),
            surface_angular_velocity=self.w,
            surface_acceleration=(
                self.a[0] - self.alpha * y - self.w**2 * x,
                self.a[1] + self.alpha * x - self.w**2 * y,
            ),
        )


def feet(width: float = 0.3, height: float = 0.2, friction: float = MU) -> list[PlanarContact]:
    return [
        PlanarContact(r=(x, -height / 2), normal=(0.0, 1.0), friction=friction)
        for x in (-width / 2, width / 2)
    ]


def problem_on(motion: Motion, velocity: PlanarVelocity, *contacts: PlanarContact) -> PlanarContactProblem:
    return planar_problem(BLOCK, velocity, [motion.carried(one) for one in contacts], WEIGHT)


def test_a_block_between_two_belts_is_dragged_by_both() -> None:
    """The lower belt runs to the right under it, and the upper one, pressed down, to the left."""
    low, high = feet(), [replace(one, r=(one.r[0], 0.1), normal=(0.0, -1.0)) for one in feet()]
    right, left = Motion(v=(1.0, 0.0)), Motion(v=(-2.0, 0.0))
    contacts = [*map(right.carried, low), *map(left.carried, high)]
    for v, letters, a in ((0.0, "llss", MU * G), (1.5, "rrss", -MU * G), (1.0, "ffss", 0.0)):
        moving = PlanarVelocity(v=(v, 0.0), w=0.0)
        problem = planar_problem(BLOCK, moving, contacts, WEIGHT)
        answer = contact_modes(problem)
        assert answer.contact_velocities[2] == pytest.approx((-(v + 2.0), 0.0))  # right is towards -x above
        assert {mode.mode[:2] for mode in answer.modes} == {letters[:2]}
        assert {round(mode.acceleration[0], 9) for mode in answer.modes} == {round(a, 9)}
    # A cart that carries both adds its acceleration to all.
    cart = [replace(one, surface_acceleration=(-0.5 * MU * G, 0.0)) for one in contacts]
    carried = planar_problem(BLOCK, PlanarVelocity(v=(1.0, 0.0), w=0.0), cart, WEIGHT)
    modes = contact_modes(carried).modes
    assert {mode.mode[:2] for mode in modes} == {"ff"}
    assert modes[0].acceleration[0] == pytest.approx(-0.5 * MU * G)


def drawn_motion(seed: int) -> Motion:
    chance = np.random.default_rng(seed)
    (v_x, v_y, w, a_x, a_y, alpha) = chance.normal(size=6).tolist()
    return Motion((v_x, v_y), w, (a_x, a_y), alpha)


def seen(case: FloatCase, motion: Motion) -> PlanarContactProblem:
    """Return a problem whose surfaces, body and wrench are carried by a motion, with its pseudo-forces."""
    body, velocity, contacts, wrench = case
    (v_x, v_y), w = velocity.v, velocity.w
    x, y = pseudo(velocity, motion)
    return planar_problem(
        body,
        PlanarVelocity(v=(v_x + motion.v[0], v_y + motion.v[1]), w=w + motion.w),
        [motion.carried(one) for one in contacts],
        PlanarWrench(
            f=(wrench.f[0] + body.mass * x, wrench.f[1] + body.mass * y),
            moment=wrench.moment + body.inertia * motion.alpha,
        ),
    )


def pseudo(velocity: PlanarVelocity, motion: Motion) -> tuple[float, float]:
    """Return the acceleration of the frame at the centre of mass, with Coriolis' part."""
    return (motion.a[0] - 2.0 * motion.w * velocity.v[1], motion.a[1] + 2.0 * motion.w * velocity.v[0])


def letters(answer: PlanarModeAnswer) -> tuple[object, ...]:
    return answer.verdict, sorted(mode.mode for mode in answer.modes), answer.kinematic_modes


@seeds(range(24), slow=range(24, 1000))
def test_modes_are_those_of_a_still_problem_with_explicit_pseudo_forces(seed: int) -> None:
    case, motion = rounded(draw(seed, most_contacts=4)), drawn_motion(seed)
    body, velocity, contacts, wrench = case
    tolerances = {"velocity_tolerance": 1e-7, "acceleration_tolerance": 1e-7}
    still = PlanarContactProblem(body=body, velocity=velocity, contacts=contacts, wrench=wrench, **tolerances)
    moving = replace(seen(case, motion), **tolerances)
    first, second = contact_modes(still), contact_modes(moving)
    assert letters(second) == letters(first)
    check_forces(second, body, moving.contacts, moving.wrench)
    x, y = pseudo(velocity, motion)
    found = {mode.mode: mode for mode in second.modes}
    for one in first.modes:
        two = found[one.mode]
        if not (one.motion_unique and one.forces_unique):
            continue
        size = 1e-6 * (1.0 + max(abs(part) for force in one.contact_forces for part in force))
        assert two.acceleration == pytest.approx((one.acceleration[0] + x, one.acceleration[1] + y), abs=size)
        assert two.angular_acceleration == pytest.approx(
            one.angular_acceleration + motion.alpha, abs=size / body.radius_of_gyration
        )
        np.testing.assert_allclose(two.contact_accelerations, one.contact_accelerations, atol=size)
    for one_margin, two_margin in zip(mode_margins(still), mode_margins(moving, second), strict=True):
        assert two_margin.mode == one_margin.mode
        assert two_margin.margin == pytest.approx(one_margin.margin, rel=1e-5, abs=1e-5)
    assert refused_modes(moving, second) == second.refused
    for still_set, moving_set in zip(wrench_sets(still), wrench_sets(moving), strict=True):
        assert moving_set.mode == still_set.mode
        depths = still_set.depth(wrench, 1.0), moving_set.depth(moving.wrench, 1.0)
        assert depths[1] == pytest.approx(depths[0], rel=1e-5, abs=1e-5)
        for vertex in moving_set.vertices:
            assert moving_set.depth(vertex, 1.0) >= -1e-6 * (1.0 + abs(vertex.f[0]) + abs(vertex.f[1]))


@seeds(range(20), slow=range(20, 300))
def test_the_plane_agrees_with_space(seed: int) -> None:
    """The same bodies on surfaces that move as one, in the plane and in space, away from ties."""
    chance = np.random.default_rng(seed)
    motion, width = drawn_motion(seed), chance.uniform(0.1, 0.4)
    contacts = [motion.carried(one) for one in feet(width, 0.2, float(chance.uniform(0.1, 1.0)))]
    slide, turn = (chance.normal(), 0.0) if seed % 2 else (0.0, chance.uniform(0.0, 2.0))
    first = contacts[0].r  # it slides on both feet, or turns about the first one and lifts the other
    velocity = PlanarVelocity(
        v=(motion.v[0] + slide + turn * first[1], motion.v[1] - turn * first[0]), w=motion.w + turn
    )
    f_x, f_y, moment = chance.normal(size=3).tolist()
    problem = planar_problem(
        BLOCK, velocity, contacts, PlanarWrench(f=(5 * f_x, 10 * f_y - 20), moment=moment)
    )
    body, state, lifted = planar_in_space(BLOCK, velocity, contacts, axes_W=[[1, 0, 0], [0, 1, 0]])
    wrench = problem.wrench
    in_space = contact_modes(spatial_problem(body, state, lifted, [*wrench.f, 0], [0, 0, wrench.moment]))
    in_plane = contact_modes(problem)
    as_in_space = str.maketrans("lr", "cc")
    assert [one.mode.translate(as_in_space) for one in in_plane.modes] == [one.mode for one in in_space.modes]
    for one, two in zip(in_plane.modes, in_space.modes, strict=True):
        np.testing.assert_allclose(two.acceleration_W, [*one.acceleration, 0.0], atol=1e-10)
        np.testing.assert_allclose(two.angular_acceleration_W[2], one.angular_acceleration, atol=1e-9)


def test_statics_and_geometry_are_seen_from_the_cart() -> None:
    cart = Motion(v=(2.0, 1.0), a=(1.0, 0.5))
    moving = problem_on(cart, PlanarVelocity(v=(2.0, 1.0), w=0.0), *feet())
    still = replace(
        moving,
        velocity=PlanarVelocity(v=(0, 0), w=0.0),
        contacts=feet(),
        wrench=PlanarWrench(f=(-2.0, -2.0 * (G + 0.5))),
    )
    assert statics(moving).to_dict() == pytest.approx(statics(still).to_dict())
    other_velocity = replace(moving, velocity=PlanarVelocity(v=(7.0, 1.0), w=0.3))
    assert statics(other_velocity).to_dict() == pytest.approx(statics(still).to_dict())
    for one, two in zip(geometry_margins(moving), geometry_margins(still), strict=True):
        assert one.to_dict() == two.to_dict()
    off = ContactUncertainty(points=1e-5)
    within = contact_modes(replace(moving, uncertainty=off)).within
    assert within is not None
    assert within.certain


REST, TURNING = PlanarVelocity(v=(0.0, 0.0), w=0.0), PlanarVelocity(v=(0.0, 0.0), w=0.5)
LEFT, RIGHT = feet()
MIDDLE = [replace(LEFT, r=(0.0, y), normal=(0.0, -math.copysign(1.0, y))) for y in (-0.1, 0.1)]
FAST, FASTER = Motion(v=(1.0, 0.0)), Motion(v=(2.0, 0.0))
BELTS = [FAST.carried(LEFT), FASTER.carried(RIGHT)]


@pytest.mark.parametrize(
    ("contacts", "velocity"),
    [
        ([LEFT, Motion(a=(0.0, -1.0)).carried(MIDDLE[0]), RIGHT], REST),
        ([*BELTS, Motion(a=(0.5, 0.0)).carried(MIDDLE[0])], REST),
        ([LEFT, replace(RIGHT, surface_angular_velocity=1.0)], REST),
        ([FAST.carried(MIDDLE[0]), FASTER.carried(MIDDLE[1])], TURNING),
        ([*BELTS[:1], replace(BELTS[1], surface_curvature=2.0)], REST),
    ],
    ids=["bends", "one accelerates", "one turns", "the body turns", "curved"],
)
def test_what_the_plane_does_not_answer_points_to_space(
    contacts: Sequence[PlanarContact], velocity: PlanarVelocity
) -> None:
    problem = planar_problem(BLOCK, velocity, contacts, WEIGHT)
    calls: list[Callable[[], object]] = [lambda: contact_modes(problem), lambda: mode_margins(problem)]
    for call in calls:
        with pytest.raises(NotSupportedError, match=r"belts with equal accelerations.*SpatialContactProblem"):
            call()


def test_statics_need_one_motion() -> None:
    problem = PlanarContactProblem(body=BLOCK, contacts=BELTS, wrench=WEIGHT)
    assert contact_modes(problem).verdict.name == "UNIQUE"
    with pytest.raises(NotSupportedError, match="contacts must have surfaces that move as one rigid body"):
        statics(problem)


def test_a_surface_that_comes_is_an_impact_whatever_the_others_do() -> None:
    contacts = [Motion(v=(0.0, 0.1)).carried(LEFT), MIDDLE[0], Motion(a=(0.5, 0.0)).carried(RIGHT)]
    answer = contact_modes(PlanarContactProblem(body=BLOCK, contacts=contacts, wrench=WEIGHT))
    assert answer.verdict.name == "IMPACT"
    assert answer.approaching == (0,)


def test_an_extreme_acceleration_of_a_surface_is_not_blamed_on_the_wrench() -> None:
    with pytest.raises(InvalidFieldError, match=r"^state, contacts: velocities and inertial wrench relative"):
        contact_modes(problem_on(Motion(a=(1e60, 0.0)), REST, LEFT, RIGHT))
