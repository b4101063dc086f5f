# SPDX-License-Identifier: Apache-2.0
"""A corner in a groove touches two flats. It is pressed against both, and friction makes it a joint."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from contact_dynamics import Body, BodyState, MassProperties, Surface, World, inertia
from contact_dynamics.shapes import polyhedron
from contact_dynamics.toss import TossEnd, TossEventKind, toss
from contact_dynamics.toss.forces import pushed_by_contacts
from contact_dynamics.toss.solid import Held, numbers_of, solid_of
from sweeps import seeds

G = 9.81
TIP = np.array([0.0, 0.0, -0.2])
STILL = BodyState(p_WB_W=-TIP, q_WB=[0, 0, 0, 1])
STUCK = (Held((0, 0)), Held((1, 0)))


def groove(slope: float, friction: float, *, other: float | None = None, restitution: float = 0.0) -> World:
    """Two flats through the y axis that rise to both sides, by an angle, rad."""
    sides = (("left", 1.0, friction), ("right", -1.0, friction if other is None else other))
    return World(
        surfaces=tuple(
            Surface(
                name=name,
                p_WS_W=[0, 0, 0],
                normal_W=[sign * math.sin(slope), 0, math.cos(slope)],
                friction=mu,
                restitution=restitution,
            )
            for name, sign, mu in sides
        ),
        gravity_W=[0, 0, -G],
    )


def top() -> Body:
    """A body of 1 kg on a tip, wide above."""
    return Body(
        name="top",
        mass_properties=MassProperties(mass=1.0, I_B=np.diag([0.01, 0.012, 0.008])),
        vertices_B=[TIP, [0.05, 0.05, 0.1], [-0.05, 0.05, 0.1], [0.0, -0.05, 0.1]],
    )


@pytest.mark.parametrize("friction", [1e-6, 0.01, 0.1])
@pytest.mark.parametrize("slope", [0.2, 0.8, 1.3])
def test_with_little_friction_the_forces_are_nearly_normal(slope: float, friction: float) -> None:
    """To halve the weight instead would need friction tan(slope)."""
    solid = solid_of(top(), groove(slope, friction))
    forces = np.array(pushed_by_contacts(solid, numbers_of(STILL), STUCK).forces)
    np.testing.assert_allclose(forces.sum(axis=0), [0.0, 0.0, G], atol=1e-9)
    for force, flat in zip(forces, solid.flats, strict=True):
        pressing = float(force @ flat.normal)
        assert np.linalg.norm(force - pressing * np.array(flat.normal)) <= friction * pressing + 1e-9


def test_friction_takes_what_it_can_and_the_flats_press_no_more_than_they_must() -> None:
    """Each force is on the edge of its cone, atan(mu) from the normal and 1 - 0.3 rad from the vertical."""
    solid = solid_of(top(), groove(1.0, math.tan(0.3)))
    forces = np.array(pushed_by_contacts(solid, numbers_of(STILL), STUCK).forces)
    np.testing.assert_allclose(forces[:, 2], 0.5 * G, atol=1e-9)
    np.testing.assert_allclose(forces[:, 0], np.array([1.0, -1.0]) * 0.5 * G * math.tan(0.7), atol=1e-9)


def test_flats_that_are_the_same_share_alike() -> None:
    solid = solid_of(top(), groove(0.0, 0.5))
    forces = np.array(pushed_by_contacts(solid, numbers_of(STILL), STUCK).forces)
    np.testing.assert_allclose(forces, [[0.0, 0.0, 0.5 * G]] * 2, atol=1e-9)


def test_a_tip_in_a_groove_turns_as_on_a_ball_joint() -> None:
    """An independent integration of a body that turns about a fixed point, while both contacts stick."""
    body, world = top(), groove(1.0, 0.9)
    turn = Rotation.from_rotvec([0.1, 0.2, 0.05])
    w = np.array([0.5, -0.3, 2.0])
    p = -turn.apply(TIP)
    state = BodyState(p_WB_W=p, q_WB=turn.as_quat(), v_WB_W=np.cross(w, p), w_WB_W=w)
    seconds = 0.15
    went = toss(body, state, world, horizon=seconds, max_alternatives=0)
    assert went.end == TossEnd.HORIZON
    assert [(each.kind, each.mode) for each in went.events] == [(TossEventKind.NEW_MODE, "ff")]
    about_tip = body.mass_properties.I_B + (TIP @ TIP) * np.eye(3) - np.outer(TIP, TIP)

    def rates(_: float, y: np.ndarray) -> np.ndarray:
        rotation = Rotation.from_quat(y[:4])
        torque = rotation.inv().apply(np.cross(-rotation.apply(TIP), [0.0, 0.0, -G]))
        spin = y[4:]  # in body axes
        turned = 0.5 * (Rotation.from_quat(y[:4]).as_matrix() @ spin)
        x, yy, z, q = y[:4]
        a, b, c = turned
        quaternion = [
            q * a + (b * z - c * yy),
            q * b + (c * x - a * z),
            q * c + (a * yy - b * x),
            -(a * x + b * yy + c * z),
        ]
        return np.array([*quaternion, *np.linalg.solve(about_tip, torque - np.cross(spin, about_tip @ spin))])

    start = [*turn.as_quat(), *turn.inv().apply(w)]
    known = solve_ivp(rates, (0.0, seconds), start, rtol=1e-12, atol=1e-12).y[:, -1]
    there = Rotation.from_quat(known[:4])
    off = (Rotation.from_quat(went.state.q_WB) * there.inv()).magnitude()
    # A step may be off by 1e-7 m of 0.2 m, there are some twenty, and errors of a falling top grow.
    assert off <= 1e-5
    np.testing.assert_allclose(went.state.p_WB_W, -there.apply(TIP), atol=2e-6)


@seeds(range(5), slow=range(5, 200))
def test_bodies_in_grooves_come_to_an_end_and_gain_no_energy(seed: int) -> None:
    """A toss that left a corner on both flats at once ended with a division by zero, one in forty."""
    rng = np.random.default_rng(seed)
    points = 0.1 * rng.normal(size=(4 + 4 * (seed % 2), 3))
    mass = inertia.convex_hull(points, density=500.0)
    body = Body.of("hull", mass, shape_F=polyhedron(points))
    q = rng.normal(size=4)
    state = BodyState(
        p_WB_W=[0.0, 0.0, 0.8],
        q_WB=q / np.linalg.norm(q),
        v_WB_W=0.5 * rng.normal(size=3),
        w_WB_W=5.0 * rng.normal(size=3),
    )
    world = groove(rng.uniform(0.3, 1.1), rng.uniform(0.1, 1.5), restitution=0.3 * rng.random())
    went = toss(body, state, world, horizon=1.5, max_alternatives=0)
    times = np.linspace(0.0, went.seconds, 100)
    moved = went.at(times)
    energies = []
    for p, quaternion, v, spin in zip(moved.p_WB_W, moved.q_WB, moved.v_WB_W, moved.w_WB_W, strict=True):
        rotation = Rotation.from_quat(quaternion)
        spin_B = rotation.as_matrix().T @ spin
        kinetic = 0.5 * mass.mass * float(v @ v) + 0.5 * float(spin_B @ mass.I_B @ spin_B)
        energies.append(kinetic + mass.mass * G * float(p[2]))
        corners = p + body.vertices_B @ rotation.as_matrix().T
        assert min(float(side.gaps(corners).min()) for side in world.surfaces) >= -1e-9  # type: ignore[union-attr]
    assert float(np.diff(energies).max()) <= 1e-6 * max(abs(energies[0]), 1.0)
    assert len(set(went.resting_corners)) == len(went.resting_corners)
