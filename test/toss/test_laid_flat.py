# SPDX-License-Identifier: Apache-2.0
"""Samples that only rattle on a face are laid flat: where that holds, and where it must not be done."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest

from contact_dynamics.impact import RestitutionLaw
from contact_dynamics.rigid_body import inertia
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.shapes import ConvexShape, box
from contact_dynamics.toss import TossEnd, sampled_toss, toss
from contact_dynamics.toss.laid_flat import RATTLING, laid_flat
from contact_dynamics.toss.solid import heights_and_rates, numbers_of, solid_of
from contact_dynamics.world import Body, Surface, World
from sweeps import seeds

if TYPE_CHECKING:
    from collections.abc import Sequence

FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.2, restitution=0.3)
GRAVITY = 9.80665


def a_box(*size: float) -> Body:
    properties = inertia.box(size=size, mass=0.4).mass_properties
    return Body(name="box", mass_properties=properties, shape=box(size=size))


def unit(numbers: Sequence[float]) -> list[float]:
    size = math.hypot(*numbers)
    return [x / size for x in numbers]


def tilted(body: Body, tilt: float, v: list[float], w: list[float]) -> BodyState:
    """A box that is tilted about its y axis, rad, with its lowest edge on the floor."""
    q = [0.0, math.sin(0.5 * tilt), 0.0, math.cos(0.5 * tilt)]
    lying = BodyState(p_WB_W=[0, 0, 0], q_WB=q, v_WB_W=v, w_WB_W=w)
    lowest = float((body.vertices_B @ lying.R_WB.T)[:, 2].min())
    return BodyState(p_WB_W=[0, 0, -lowest], q_WB=q, v_WB_W=v, w_WB_W=w)


def laid(body: Body, state: BodyState, *surfaces: Surface) -> list[float] | None:
    solid = solid_of(body, World(surfaces=surfaces or (FLOOR,)))
    found = laid_flat(solid, numbers_of(state), {}, RestitutionLaw.POISSON)
    return None if found is None else found[0]


def test_it_lies_flush_and_slides_with_the_momentum_that_the_rattling_leaves() -> None:
    body = a_box(0.1, 0.12, 0.08)
    y = laid(body, tilted(body, 0.01, [0.3, 0.4, -0.05], [0.1, -0.1, 1.5]))
    assert y is not None
    heights = sorted(heights_and_rates(solid_of(body, World(surfaces=(FLOOR,))), y))[:4]
    assert max(abs(height) for height, _, _ in heights) < 1e-12
    assert max(abs(rate) for _, rate, _ in heights) < 1e-12
    # What stops 0.05 m/s along the normal brings friction of 0.2 times that, against 0.5 m/s.
    np.testing.assert_allclose(y[7:10], [0.3 * 0.98, 0.4 * 0.98, 0.0], atol=1e-12)
    np.testing.assert_allclose(y[10:], [0.0, 0.0, 1.5], atol=1e-12)


def test_energy_out_of_the_plane_bounds_it_relative_to_what_tipping_takes() -> None:
    body = a_box(0.1, 0.12, 0.08)
    tipping = math.hypot(0.05, 0.04) - 0.04
    fast = math.sqrt(2.0 * GRAVITY * RATTLING * tipping)
    assert laid(body, tilted(body, 0.0, [0.5, 0.0, -0.99 * fast], [0, 0, 0])) is not None
    assert laid(body, tilted(body, 0.0, [0.5, 0.0, -1.01 * fast], [0, 0, 0])) is None


def test_a_plate_on_its_narrow_face_is_not_laid_on_it() -> None:
    """It tips over with a fortieth of a millimetre, which a slow turn has. On its wide face it lies."""
    turn = [0.0, 0.2, 0.0]
    narrow, wide = a_box(0.004, 0.1, 0.08), a_box(0.08, 0.1, 0.004)
    assert laid(narrow, tilted(narrow, 0.005, [0, 0, 0], turn)) is None
    assert laid(wide, tilted(wide, 0.005, [0, 0, 0], turn)) is not None


def test_a_tall_body_that_friction_trips_is_not_laid_while_it_slides() -> None:
    """Friction of 0.2 acts 0.15 m below the mass centre, and the face ends 0.02 m from it."""
    tall = a_box(0.04, 0.1, 0.3)
    assert laid(tall, tilted(tall, 0.0, [0.5, 0.0, 0.0], [0, 0, 0])) is None
    assert laid(tall, tilted(tall, 0.0, [0.0, 0.5, 0.0], [0, 0, 0])) is not None
    assert laid(tall, tilted(tall, 0.0, [0.0, 0.0, 0.0], [0, 0, 0])) is not None


def test_only_a_body_near_one_flat_is_laid() -> None:
    body = a_box(0.1, 0.12, 0.08)
    state = tilted(body, 0.001, [0.2, 0, 0], [0, 0, 0])
    near, far = (
        Surface(name="wall", p_WS_W=[x, 0, 0], normal_W=[-1, 0, 0], friction=0.2, restitution=0.3)
        for x in (0.052, 0.2)
    )
    assert laid(body, state, FLOOR, near) is None
    assert laid(body, state, FLOOR, far) is not None
    ceiling = Surface(name="lid", p_WS_W=[0, 0, 0], normal_W=[0, 0, -1], friction=0.2, restitution=0.3)
    above = BodyState(p_WB_W=[0, 0, -0.04], q_WB=[0, 0, 0, 1])
    assert laid(body, above, ceiling) is None


@seeds(range(8))
def test_a_sample_rests_where_the_toss_does(seed: int) -> None:
    """A box slides two to four decimetres and rattles for a tenth of a second."""
    body, chance = a_box(0.1, 0.12, 0.08), np.random.default_rng(seed)
    state = BodyState(
        p_WB_W=[0, 0, 0.08],
        q_WB=unit([*chance.normal(0.0, 0.05, 3), 1.0]),
        v_WB_W=[*chance.uniform(0.4, 1.0, 2), 0.0],
        w_WB_W=chance.uniform(-1.0, 1.0, 3),
    )
    world = World(bodies=(body,), surfaces=(FLOOR,))
    alone = toss(body, state, world, max_alternatives=0)
    told = sampled_toss(
        body, state, world, count=1, to_rest=True, restitution_law=RestitutionLaw.POISSON, horizon=5.0
    )
    assert alone.end == TossEnd.RESTS
    assert told.rest is not None
    assert told.face_normals_B[0] @ alone.resting_normal_B > 0.999
    off = told.rest.positions[2] - alone.state.p_WB_W
    assert np.linalg.norm(off) < 3e-3


FLAT = ([0, 0, 1],)
SLOPE = ([0.15, 0, 0.9886859967],)
FLOOR_AND_WALL = ([0, 0, 1], [-1, 0, 0])


@pytest.mark.parametrize("normals", [FLAT, SLOPE, FLOOR_AND_WALL])
@pytest.mark.parametrize("restitution", [0.0, 0.3, 0.7])
@pytest.mark.parametrize(
    "size", [(0.1, 0.1, 0.1), (0.15, 0.1, 0.06), (0.2, 0.15, 0.01), (0.3, 0.03, 0.03)], ids=str
)
def test_samples_rest_when_and_where_the_toss_does(
    size: tuple[float, float, float], restitution: float, normals: tuple[list[float], ...]
) -> None:
    """A cube, a brick, a thin plate and a stick. A sample that took another course tells nothing.

    The duration of the rattling is approximate: its median error is at most 9 ms in 60 draws of each, and
    3 ms with a restitution of 0.5 or less. Without it, samples rest up to 170 ms too early.
    """
    body, chance = Body.box(size, mass=0.4), np.random.default_rng(1)
    friction = 0.5 if restitution > 0.5 else 0.3
    world = World(
        surfaces=tuple(
            Surface(
                name=f"flat {k}",
                p_WS_W=[0.25 * k, 0, 0],
                normal_W=normal,
                friction=friction,
                restitution=restitution,
            )
            for k, normal in enumerate(normals)
        )
    )
    off = []
    for _ in range(12):
        state = BodyState(
            p_WB_W=[0, 0, 0.2],
            q_WB=unit(chance.normal(size=4)),
            v_WB_W=[*chance.normal(0.0, 0.7, 2), chance.normal(0.0, 0.3)],
            w_WB_W=chance.normal(0.0, 4.0, 3),
        )
        alone = toss(body, state, world)
        found = sampled_toss(body, state, world, count=1, to_rest=True)
        assert found.rest is not None
        if np.linalg.norm(found.rest.positions[2] - alone.state.p_WB_W) < 5e-3:
            assert found.face_normals_B[0] @ alone.resting_normal_B > 0.999
            off.append(found.rest.seconds[2] - alone.seconds)
    assert len(off) >= 8
    assert abs(np.median(off)) < (0.02 if restitution > 0.5 else 0.004)


def test_corners_that_are_not_in_one_plane_do_not_prolong_the_rattling() -> None:
    """Corners are off by 0.1 mm, as in samples. If one of four never came down, the median would be 25 ms.

    As above, the duration of the rattling is approximate.
    """
    chance, off = np.random.default_rng(2), []
    world = World(surfaces=(FLOOR,))
    for _ in range(12):
        shape = ConvexShape(vertices=box(size=(0.1, 0.1, 0.1)).vertices + chance.normal(0.0, 1e-4, (8, 3)))
        body = Body(name="cube", mass_properties=a_box(0.1, 0.1, 0.1).mass_properties, shape=shape)
        state = BodyState(
            p_WB_W=[0, 0, 0.2],
            q_WB=unit(chance.normal(size=4)),
            v_WB_W=[*chance.normal(0.0, 0.7, 2), 0.0],
            w_WB_W=chance.normal(0.0, 4.0, 3),
        )
        alone = toss(body, state, world, max_alternatives=0)
        found = sampled_toss(body, state, world, count=1, to_rest=True)
        assert found.rest is not None
        if np.linalg.norm(found.rest.positions[2] - alone.state.p_WB_W) < 5e-3:
            off.append(found.rest.seconds[2] - alone.seconds)
    assert len(off) >= 8
    assert abs(np.median(off)) < 0.004
