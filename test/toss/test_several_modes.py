# SPDX-License-Identifier: Apache-2.0
"""Bodies that slide under strong friction, where several contact modes are consistent or none is."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact_dynamics import Body, BodyState, MassProperties, Surface, World
from contact_dynamics.contact_modes.spatial.answer import spatial_contact_modes
from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem
from contact_dynamics.rigid_body import kinetic_energy
from contact_dynamics.shapes import polyhedron
from contact_dynamics.tolerances import SLIDING_STOPPED
from contact_dynamics.toss import TossEventKind, UndecidedReason, toss
from contact_dynamics.toss.mode_choice import choose_mode
from contact_dynamics.toss.solid import contacts_of, numbers_of, solid_of

G = 9.81
LEAN = math.radians(75.0)
REACH = 4.0


def rod() -> Body:
    """Mason's rod, m = 1 and I = 1, whose lower tip is 4 m from the mass centre."""
    x, z = REACH * math.cos(LEAN), REACH * math.sin(LEAN)
    properties = MassProperties(mass=1.0, I_B=np.diag([1.0, 1.0, 0.5]))
    return Body(name="rod", mass_properties=properties, vertices_B=[[-x, 0.0, -z], [x, 0.0, z]])


def sliding(spin: float) -> BodyState:
    """The rod with its tip on the floor, which slides along -x at 1 m/s and does not leave it."""
    x, z = -REACH * math.cos(LEAN), -REACH * math.sin(LEAN)
    return BodyState(
        p_WB_W=[-x, 0.0, -z],
        q_WB=[0, 0, 0, 1],
        v_WB_W=[-1.0 - spin * z, 0.0, spin * x],
        w_WB_W=[0.0, spin, 0.0],
    )


def floor(friction: float) -> Surface:
    return Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=friction, restitution=0.0)


def test_a_rod_that_slides_in_painleves_region_may_slide_on_or_lift_off() -> None:
    """The tip's normal acceleration is b without force and b + a f with it: b > 0 > a allows f = 0 and -b/a.

    Friction mu f along +x, and f upwards at the tip (x, z): a = 1 + x (x - mu z), b = -g - w^2 z, m = I = 1.
    """
    spin, mu = 2.0, 0.6
    x, z = -REACH * math.cos(LEAN), -REACH * math.sin(LEAN)
    a, b = 1.0 + x * (x - mu * z), -G - spin**2 * z
    assert a < 0.0 < b
    world = World(surfaces=(floor(mu),), gravity_W=[0, 0, -G])
    went = toss(rod(), sliding(spin), world, horizon=0.02, max_alternatives=8)
    assert [(point.reason, point.options, point.taken) for point in went.undecided[:1]] == [
        (UndecidedReason.SEVERAL_MODES, 2, 0)
    ]
    # The way that goes on as before comes first.
    assert (went.events[0].kind, went.events[0].mode) == (TossEventKind.NEW_MODE, "c")
    other = went.alternatives[0]
    assert other.undecided[0].taken == 1
    assert other.events[0].kind == TossEventKind.LIFTS_OFF
    early = 1e-6
    slides, flies = (each.state_at(early).v_WB_W - sliding(spin).v_WB_W for each in (went, other))
    force = -b / a
    np.testing.assert_allclose(
        slides / early, [mu * force, 0.0, force - G], rtol=1e-3
    )  # it turns by 2e-6 rad
    np.testing.assert_allclose(flies / early, [0.0, 0.0, -G], atol=1e-3)


def test_outside_painleves_region_nothing_is_undecided() -> None:
    world = World(surfaces=(floor(0.2),), gravity_W=[0, 0, -G])
    assert toss(rod(), sliding(0.5), world, horizon=0.02).undecided == ()


def test_two_sliding_contacts_have_the_modes_that_the_whole_enumeration_finds() -> None:
    """Bodies whose two corners slide along a floor and a wall, with any friction.

    At each drawn state there are as many modes as `contact_modes` finds with all their subsets, and several
    or none are found where no contact alone is in Painlevé's region, too.
    """
    chance = np.random.default_rng(8)
    counts = []
    for _ in range(150):
        size = chance.uniform(0.5, 3.0, 2)
        angle = chance.uniform(0.2, 1.3)
        centre = chance.uniform(0.1, 0.9)
        length = float(size[0])
        down = np.array([length * math.cos(angle), 0.0, 0.0])
        up = np.array([0.0, 0.0, length * math.sin(angle)])
        p = centre * down + (1.0 - centre) * up + chance.uniform(-0.3, 0.3) * np.array([1.0, 0.0, 1.0])
        inertia = float(chance.uniform(0.005, 0.3)) * length**2
        body = Body(
            name="ladder",
            mass_properties=MassProperties(mass=1.0, I_B=np.diag([inertia, inertia, inertia])),
            vertices_B=[down - p, up - p],
        )
        mu = chance.uniform(0.0, 2.0, 2)
        wall = Surface(name="wall", p_WS_W=[0, 0, 0], normal_W=[1, 0, 0], friction=mu[1], restitution=0.0)
        world = World(surfaces=(floor(float(mu[0])), wall), gravity_W=[0, 0, -G])
        # It turns about the point above the one tip and beside the other, which slide along floor and wall.
        spin = float(chance.choice([-1.0, 1.0]) * chance.uniform(0.3, 3.0))
        v = np.cross([0.0, spin, 0.0], p - (down + up))
        state = BodyState(p_WB_W=p, q_WB=[0, 0, 0, 1], v_WB_W=v, w_WB_W=[0.0, spin, 0.0])
        solid, y, touching = solid_of(body, world), numbers_of(state), [(0, 0), (1, 1)]
        known = spatial_contact_modes(
            SpatialContactProblem(
                body=body.mass_properties,
                state=state,
                contacts=contacts_of(solid, y, touching),
                force_W=[0.0, 0.0, -G],
                velocity_tolerance=SLIDING_STOPPED,
            )
        )
        found = choose_mode(solid, y, touching)
        assert len(found.modes) == len(known.modes), (known.verdict, mu)
        counts.append(len(known.modes))
    assert {0, 1, 2} <= set(counts)


@pytest.mark.parametrize("friction", [0.1, 0.5])
def test_feet_on_one_floor_are_not_undecided(friction: float) -> None:
    """A block that slides on four feet: forces are not the only ones, and its motion is."""
    feet = [[x, y, -0.05] for x in (-0.1, 0.1) for y in (-0.06, 0.06)]
    block = Body(
        name="block",
        mass_properties=MassProperties(mass=1.0, I_B=np.diag([0.002, 0.004, 0.005])),
        vertices_B=[*feet, [0.0, 0.0, 0.05]],
    )
    state = BodyState(p_WB_W=[0, 0, 0.05], q_WB=[0, 0, 0, 1], v_WB_W=[0.5, 0.2, 0.0], w_WB_W=[0, 0, 1.0])
    world = World(surfaces=(floor(friction),), gravity_W=[0, 0, -G])
    assert toss(block, state, world).undecided == ()


def test_a_paradoxical_corner_that_friction_holds_no_longer_leaves() -> None:
    """A paradoxical corner that sticks may also begin to slide, until friction is at its limit.

    There both modes become one, and beyond there is none but separation. The body slid on for 3 ms, driven by
    friction, and gained energy.
    """
    inertia = [[5284e-6, -285e-6, -2423e-6], [-285e-6, 5546e-6, -721e-6], [-2423e-6, -721e-6, 3754e-6]]
    corners = np.array(
        [
            [0.0876, 0.0104, 0.0707],
            [-0.0072, -0.04, 0.0704],
            [-0.0859, -0.1258, -0.1753],
            [0.1633, 0.0288, 0.1785],
            [-0.0778, 0.133, -0.0737],
        ]
    )
    body = Body(
        name="hull", mass_properties=MassProperties(mass=0.9693, I_B=inertia), shape=polyhedron(corners)
    )
    q, w = np.array([0.4924, 0.1447, 0.527, 0.6774]), np.array([-9.022, 2.211, -14.158])
    q /= np.linalg.norm(q)
    arm = BodyState(p_WB_W=[0, 0, 0], q_WB=q).R_WB @ corners[2]
    state = BodyState(p_WB_W=-arm, q_WB=q, v_WB_W=-np.cross(w, arm), w_WB_W=w)
    gravity = np.array([-4.78, 4.407, -7.347])
    went = toss(body, state, World(surfaces=(floor(0.864),), gravity_W=gravity), horizon=0.02)
    assert [event.mode for event in went.events] == ["f", "f", "c", ""]
    begins, leaves = went.events[2:]
    assert (leaves.kind, begins.seconds < 0.003) == (TossEventKind.LIFTS_OFF, True)
    # It slides up to 1e-6 m/s, which is zero (`SLIDING_STOPPED`), while its acceleration grows by 4e3 m/s^3.
    assert leaves.seconds - begins.seconds < 1e-4
    moved = went.at(np.linspace(0.0, 0.02, 200))
    energies = [
        kinetic_energy(body, BodyState(p_WB_W=p, q_WB=q, v_WB_W=v, w_WB_W=w)) - 0.9693 * gravity @ p
        for p, q, v, w in zip(moved.p_WB_W, moved.q_WB, moved.v_WB_W, moved.w_WB_W, strict=True)
    ]
    # The error of a step is 1e-7 m/s at most, of velocities of 2 m/s (`test_among_flats`).
    assert np.ptp(energies) < 1e-7 * energies[0]
