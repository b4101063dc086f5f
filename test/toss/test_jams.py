# SPDX-License-Identifier: Apache-2.0
"""Bodies that jam between flats: what happens at one instant is found for all contacts together."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics import Body, BodyState, MassProperties, Surface, World
from contact_dynamics.toss import TossEnd, toss
from contact_dynamics.toss.forces import pushed_by_contacts
from contact_dynamics.toss.impacts import inelastic_impact
from contact_dynamics.toss.short_step import short_step
from contact_dynamics.toss.solid import (
    Held,
    Numbers,
    Solid,
    energy_of,
    heights_and_rates,
    numbers_of,
    solid_of,
)
from sweeps import seeds, sweep

G = 9.81
SIZE = (0.1, 0.1, 0.1)
CUBE = Body.box(SIZE, mass=0.4, name="cube")


def groove(friction: float, other: float | None = None, *, slope: float = 0.25 * math.pi) -> World:
    """Two flats through the origin that rise to both sides."""
    sides = (("left", 1.0, friction), ("right", -1.0, friction if other is None else other))
    return World(
        bodies=(CUBE,),
        surfaces=tuple(
            Surface(
                name=name,
                p_WS_W=[0, 0, 0],
                normal_W=[sign * math.sin(slope), 0, math.cos(slope)],
                friction=mu,
                restitution=0.0,
            )
            for name, sign, mu in sides
        ),
        gravity_W=[0, 0, -G],
    )


@pytest.mark.parametrize(
    ("q", "v", "w"),
    [([-2, -2, -1, 2], [-0.5, 0.5, 0.5], [-1, 3, -2]), ([0, 1, 2, 0], [-0.5, 1, -1], [2, 1, 1])],
)
def test_a_cube_in_a_groove_does_not_freeze_at_one_instant(
    q: list[float], v: list[float], w: list[float]
) -> None:
    """Two corners settled in turn for ever at 0.50232 s, and one mode came again and again at 0.24659 s."""
    state = BodyState(p_WB_W=[0, 0, 0.3], q_WB=np.array(q) / np.linalg.norm(q), v_WB_W=v, w_WB_W=w)
    went = toss(CUBE, state, groove(0.5), max_alternatives=0)
    assert went.end == TossEnd.RESTS
    assert len(went.events) < 200
    assert went.energy.lost_in_strikes > 0.0
    assert went.energy.first == pytest.approx(went.energy.lost_in_strikes + went.energy.lost_in_contact)


def jammed(rng: np.random.Generator) -> tuple[Solid, Numbers, list[tuple[int, int]]]:
    """A body of six points, each on one of two flats that face each other more or less, in any motion."""
    points = rng.normal(size=(6, 3))
    points *= 0.08 / np.linalg.norm(points, axis=1, keepdims=True)
    solid = solid_of(
        Body(
            name="points",
            mass_properties=MassProperties(mass=0.4, I_B=np.diag(rng.uniform(4e-4, 7e-4, 3))),
            vertices_B=points,
        ),
        groove(rng.uniform(0.0, 0.7), rng.uniform(0.0, 0.7), slope=rng.uniform(0.3, 1.4)),
    )
    q = rng.normal(size=4)
    y = [0.0, 0.0, 0.0, *(q / np.linalg.norm(q)), *rng.normal(size=3), *(5.0 * rng.normal(size=3))]
    count = int(rng.integers(2, 7))
    return solid, y, [(int(rng.integers(2)), k) for k in range(count)]


@pytest.mark.parametrize("block", sweep(1, whole=30))
def test_an_impact_without_restitution_obeys_its_laws(block: int) -> None:
    """Sweeps over single contacts do not always converge. Short steps leave friction out then."""
    found = [check_impact(seed) for seed in range(100 * block, 100 * (block + 1))]
    assert sum(found) >= 90


def check_impact(seed: int) -> bool:
    """Impulses are in their cones, no contact approaches, and friction opposes what slides (Moreau 1988)."""
    solid, y, touching = jammed(np.random.default_rng(seed))
    impact = inelastic_impact(solid, y, touching)
    if impact is None:
        return False
    R = Rotation.from_quat(y[3:7]).as_matrix()
    v, w = np.array(impact.y[7:10]), np.array(impact.y[10:])
    total, moment = np.zeros(3), np.zeros(3)
    for (surface, corner), impulse in zip(touching, np.array(impact.impulses), strict=True):
        flat, arm = solid.flats[surface], R @ np.array(solid.corners[corner])
        n = np.array(flat.normal)
        velocity = v + np.cross(w, arm)
        total, moment = total + impulse, moment + np.cross(arm, impulse)
        pressing, leaving = float(impulse @ n), float(velocity @ n)
        friction, sliding = impulse - pressing * n, velocity - leaving * n
        assert leaving >= -1e-5
        assert np.linalg.norm(friction) <= flat.friction * pressing + 1e-9
        assert pressing * abs(leaving) <= 1e-5
        left_out = np.linalg.norm(friction) <= 1e-9 * pressing  # where no direction of sliding is found
        if np.linalg.norm(sliding) > 1e-3 and pressing > 1e-6 and not left_out:
            against = -flat.friction * pressing * sliding / np.linalg.norm(sliding)
            np.testing.assert_allclose(friction, against, atol=1e-3 * pressing)
    np.testing.assert_allclose(solid.mass * (v - y[7:10]), total, atol=1e-12)
    turned = R @ np.array(solid.inertia).reshape(3, 3) @ R.T @ (w - y[10:])
    np.testing.assert_allclose(turned, moment, atol=1e-12)
    assert energy_of(solid, impact.y) <= energy_of(solid, y) + 1e-9
    return True


def test_a_corner_in_a_groove_sticks_where_other_forces_than_the_least_hold_it() -> None:
    """The least forces leave the cone of one flat, and others with the same sum do not.

    The forces have to balance the weight and the motion, and each has to stay in its own cone.
    """
    tip = [0.0, 0.0, -0.2]
    body = Body(
        name="top",
        mass_properties=MassProperties(mass=1.0, I_B=np.diag([0.01, 0.012, 0.008])),
        vertices_B=[tip, [0.05, 0.05, 0.1], [-0.05, 0.05, 0.1], [0.0, -0.05, 0.1]],
    )
    solid = solid_of(body, groove(0.9, 0.05, slope=0.5))
    w = [1.5, 0.0, 0.0]
    q = Rotation.from_rotvec([0.3, 0.0, 0.0]).as_quat()
    p = -Rotation.from_quat(q).apply(tip)
    y = [*p, *q, *np.cross(w, p), *w]
    stuck = (Held((0, 0)), Held((1, 0)))
    pushed = pushed_by_contacts(solid, [float(each) for each in y], stuck)
    forces = np.array(pushed.forces)
    np.testing.assert_allclose(forces.sum(axis=0) - np.array([0.0, 0.0, G]), pushed.rates[7:10], atol=1e-9)
    assert abs(forces.sum(axis=0)[1]) > 0.05 * abs(forces.sum(axis=0)[2])
    for force, flat in zip(forces, solid.flats, strict=True):
        pressing = float(force @ flat.normal)
        assert np.linalg.norm(force - pressing * np.array(flat.normal)) <= flat.friction * pressing + 1e-9


def test_a_body_without_friction_rests_in_a_corner() -> None:
    """It took `HORIZON`, at a speed of 1e-13 m/s."""
    room = World(
        surfaces=(
            *groove(0.0).surfaces,
            *(
                Surface(name=name, p_WS_W=[0, y, 0], normal_W=[0, -y, 0], friction=0.0, restitution=0.0)
                for name, y in (("end", 1.0), ("other end", -1.0))
            ),
        ),
        gravity_W=[0, 0, -G],
    )
    state = BodyState(p_WB_W=[0, 0, 0.25], q_WB=[0, 0.3826834, 0, 0.9238795])
    went = toss(CUBE, state, room, horizon=5.0, max_alternatives=0)
    assert went.end == TossEnd.RESTS
    assert went.state.p_WB_W[2] == pytest.approx(0.05 * math.sqrt(2.0), abs=1e-6)


@seeds(range(20), slow=range(20, 500))
def test_short_steps_gain_no_energy_and_stay_out_of_the_flats(seed: int) -> None:
    rng = np.random.default_rng(seed)
    q = rng.normal(size=4)
    solid = solid_of(CUBE, groove(rng.uniform(0.0, 1.0), rng.uniform(0.0, 1.0), slope=rng.uniform(0.4, 1.2)))
    y = [0.0, 0.0, 0.0, *(q / np.linalg.norm(q)), *(0.3 * rng.normal(size=3)), *(3.0 * rng.normal(size=3))]
    lowest = min(height for height, _, _ in heights_and_rates(solid, y))
    y[2] -= lowest / solid.flats[0].normal[2]  # it touches
    for _ in range(20):
        went = short_step(solid, y, start=0.0, span=2e-4)
        assert energy_of(solid, went.y) <= energy_of(solid, y) + 1e-12
        assert min(height for height, _, _ in heights_and_rates(solid, went.y)) >= -2e-10
        y = went.y


def test_short_steps_converge_to_the_motion_of_a_block_that_slides() -> None:
    """On a floor with mu it goes v t - mu g t^2 / 2, and the error is half a step's."""
    floor = World(
        surfaces=(
            Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.0),
        ),
        gravity_W=[0, 0, -G],
    )
    solid = solid_of(CUBE, floor)
    state = BodyState(p_WB_W=[0, 0, 0.05], q_WB=[0, 0, 0, 1], v_WB_W=[1, 0, 0])
    off = []
    for span in (2e-3, 1e-3):
        y = numbers_of(state)
        for _ in range(round(0.1 / span)):
            went = short_step(solid, y, start=0.0, span=span)
            y = went.y
        assert {one.touch for one in went.mode} <= {(0, corner) for corner in range(8)}
        assert y[7] == pytest.approx(1.0 - 0.3 * G * 0.1, abs=1e-9)
        off.append(abs(y[0] - (0.1 - 0.5 * 0.3 * G * 0.01)))
    assert off[0] == pytest.approx(0.5 * 0.3 * G * 0.1 * 2e-3, rel=1e-3)
    assert off[1] == pytest.approx(0.5 * off[0], rel=1e-3)
