# SPDX-License-Identifier: Apache-2.0
"""Bodies that friction may wedge between two flats: they may stick or fall, and a toss tells both."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact_dynamics import Body, BodyState, MassProperties, Surface, World
from contact_dynamics.contact_modes.result import ModeVerdict
from contact_dynamics.contact_modes.spatial.answer import spatial_contact_modes
from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem
from contact_dynamics.tolerances import SLIDING_STOPPED
from contact_dynamics.toss import TossEnd, TossEventKind, UndecidedReason, toss
from contact_dynamics.toss.forces import pushed_by_contacts
from contact_dynamics.toss.mode_choice import choose_mode
from contact_dynamics.toss.solid import Held, contacts_of, numbers_of, solid_of
from sweeps import seeds

G = 9.81
LEAN = 0.2  # by how much the right tip is higher, relative to the distance of the walls


def between_walls(friction: float) -> tuple[Body, World, BodyState]:
    """A rod at rest between two walls that are 1 m apart, so that it touches both."""
    properties = MassProperties(mass=1.0, I_B=np.diag([0.02, 0.1, 0.1]))
    rod = Body(
        name="rod", mass_properties=properties, vertices_B=[[-0.5, 0.0, -0.5 * LEAN], [0.5, 0.0, 0.5 * LEAN]]
    )
    walls = [
        Surface(name=name, p_WS_W=[x, 0, 0], normal_W=[-2.0 * x, 0, 0], friction=friction, restitution=0.0)
        for name, x in (("left", -0.5), ("right", 0.5))
    ]
    still = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1])
    return rod, World(surfaces=tuple(walls), gravity_W=[0, 0, -G]), still


def test_a_rod_between_walls_is_wedged_or_falls() -> None:
    """Tips that press with N hold it if t1 - t2 = 2 LEAN N, t1 + t2 = m g, and t1 <= mu N: N >= m g / 1.2.

    Without any force it falls along the walls, which needs none. Nothing says which of them happens.
    """
    rod, world, still = between_walls(0.8)
    went = toss(rod, still, world, horizon=0.1, max_alternatives=8)
    assert (went.end, went.seconds) == (TossEnd.RESTS, 0.0)
    (point,) = went.undecided
    assert (point.reason, point.taken) == (UndecidedReason.SEVERAL_MODES, 0)
    assert len(went.alternatives) >= point.options - 1
    falls = [
        other
        for other in went.alternatives
        if np.allclose(other.state_at(0.05).v_WB_W, [0.0, 0.0, -0.05 * G], rtol=1e-9, atol=1e-12)
    ]
    assert falls
    assert falls[0].state_at(0.05).p_WB_W[2] == pytest.approx(-0.5 * G * 0.05**2, rel=1e-9)
    assert all(other.undecided[0].taken > 0 for other in went.alternatives)


def test_walls_press_as_little_as_friction_needs() -> None:
    """N = m g / (2 (mu - LEAN)), where the lower tip is about to slip: t1 = mu N."""
    rod, world, still = between_walls(0.8)
    solid, y, touching = solid_of(rod, world), numbers_of(still), [(0, 0), (1, 1)]
    forces = pushed_by_contacts(solid, y, tuple(map(Held, touching))).forces
    normal = G / (2.0 * (0.8 - LEAN))
    upper = G - 0.8 * normal
    np.testing.assert_allclose(forces, [[normal, 0, 0.8 * normal], [-normal, 0, upper]], atol=1e-12)


@pytest.mark.parametrize("moving", [False, True])
@pytest.mark.parametrize("facing", [False, True])
@seeds(range(1), slow=range(1, 20))
def test_rods_between_flats_have_the_modes_that_the_whole_enumeration_finds(
    *, seed: int, facing: bool, moving: bool
) -> None:
    """Rods with two tips on a floor and a ceiling, or on a floor and a wall, with any friction and load.

    They are at rest, or turn about the first tip, which sticks, while the second slides.
    """
    chance = np.random.default_rng(seed)
    counts = []
    for _ in range(20):
        n = np.array([0.0, 0.0, -1.0] if facing else [1.0, 0.0, 0.0])
        first = np.array([*chance.uniform(-0.6, 0.6, 2), 0.0])
        second = first + np.array([*chance.uniform(-0.6, 0.6, 2), 1.0])
        if not facing:
            second = chance.uniform(-1.0, 1.0, 3)
            second[0], second[2] = 0.0, abs(second[2])
        p = 0.5 * (first + second) + chance.uniform(-0.4, 0.4, 3)
        inertia = float(chance.uniform(0.05, 0.3)) * np.diag(chance.uniform(0.7, 1.0, 3))
        rod = Body(
            name="rod",
            mass_properties=MassProperties(mass=1.0, I_B=inertia),
            vertices_B=[first - p, second - p],
        )
        mu = chance.uniform(0.1, 2.0, 2).tolist()
        flats = [
            Surface(name=name, p_WS_W=at, normal_W=normal, friction=friction, restitution=0.0)
            for name, at, normal, friction in (
                ("floor", [0, 0, 0], [0, 0, 1], mu[0]),
                ("other", second, n, mu[1]),
            )
        ]
        w = np.zeros(3)
        if moving:
            across = np.cross(second - first, n)
            w = chance.normal(0.0, 3.0, 3)
            w -= across * (w @ across) / (across @ across)
        state = BodyState(p_WB_W=p, q_WB=[0, 0, 0, 1], v_WB_W=np.cross(w, p - first), w_WB_W=w)
        world = World(surfaces=tuple(flats), gravity_W=chance.normal(0.0, 5.0, 3))
        solid, y, touching = solid_of(rod, world), numbers_of(state), [(0, 0), (1, 1)]
        known = spatial_contact_modes(
            SpatialContactProblem(
                body=rod.mass_properties,
                state=state,
                contacts=contacts_of(solid, y, touching),
                force_W=world.gravity_W,
                velocity_tolerance=SLIDING_STOPPED,
            )
        )
        found = choose_mode(solid, y, touching, thorough=True)
        if known.verdict != ModeVerdict.UNDECIDED:
            assert len(found.modes) == len(known.modes), (mu, known.verdict)
        counts.append(len(found.modes))
    assert max(counts) > 1 or not facing or moving


def test_too_little_friction_lets_it_fall_and_nothing_is_undecided() -> None:
    """The line between the tips must be in both cones, atan(LEAN) from the normals."""
    rod, world, still = between_walls(0.9 * LEAN)
    went = toss(rod, still, world, horizon=0.05)
    assert went.undecided == ()
    assert went.state.v_WB_W[2] == pytest.approx(-0.05 * G, rel=1e-9)
    assert went.events[0].kind != TossEventKind.RESTS


@pytest.mark.parametrize("friction", [0.2, 0.5])
def test_a_box_in_a_corner_has_one_mode(friction: float) -> None:
    """It slides along a floor and a wall, with friction that cannot wedge it, to its rest."""
    size = 0.05
    box = Body(
        name="box",
        mass_properties=MassProperties(mass=1.0, I_B=(2.0 / 3.0) * size**2 * np.eye(3)),
        vertices_B=[[x, y, z] for x in (-size, size) for y in (-size, size) for z in (-size, size)],
    )
    floor, wall = (
        Surface(name=name, p_WS_W=[0, 0, 0], normal_W=normal, friction=friction, restitution=0.0)
        for name, normal in (("floor", [0, 0, 1]), ("wall", [1, 0, 0]))
    )
    world = World(surfaces=(floor, wall), gravity_W=[0, 0, -G])
    state = BodyState(p_WB_W=[size, 0, size], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0.3, 0])
    went = toss(box, state, world)
    assert (went.end, went.undecided) == (TossEnd.RESTS, ())
    assert went.state.p_WB_W[1] == pytest.approx(0.3**2 / (2.0 * friction * G), rel=1e-4)
    assert not math.isnan(went.seconds)
