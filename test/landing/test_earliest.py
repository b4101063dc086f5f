# SPDX-License-Identifier: Apache-2.0
"""Where free flights end: drops with known answers, bodies that touch already, dense sampling as witness."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contact_dynamics import Body, BodyState, MassProperties, Surface, World, free_motion, impact_sequence
from contact_dynamics.contact.found import find_contacts
from contact_dynamics.errors import NoContactError
from contact_dynamics.landing.earliest import next_landing
from contact_dynamics.world import box_vertices

G = 10.0
FLOOR = Surface(name="floor", p_WS_W=np.zeros(3), normal_W=[0.0, 0.0, 1.0], friction=0.5, restitution=0.5)
WALL = Surface(name="wall", p_WS_W=[2.0, 0.0, 0.0], normal_W=[-1.0, 0.0, 0.0], friction=0.1, restitution=0.9)
BOX = Body(
    name="box",
    mass_properties=MassProperties(mass=1.0, I_B=np.diag([0.02, 0.03, 0.04])),
    vertices_B=box_vertices((0.4, 0.3, 0.2)),
)
WORLD = World(bodies=(BOX,), surfaces=(FLOOR, WALL), gravity_W=[0.0, 0.0, -G])
UPRIGHT = np.array([0.0, 0.0, 0.0, 1.0])


def state(
    z: float,
    *,
    v: tuple[float, float, float] = (0.0, 0.0, 0.0),
    w: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> BodyState:
    return BodyState(p_WB_W=[0.0, 0.0, z], q_WB=UPRIGHT, v_WB_W=np.array(v), w_WB_W=np.array(w))


def test_a_level_box_lands_on_its_face() -> None:
    landing = next_landing(BOX, state(0.1 + 0.45), WORLD, horizon=1.0)
    assert landing is not None
    assert landing.seconds == pytest.approx(0.3, abs=1e-15)  # 0.45 = g t^2 / 2
    assert landing.strikes
    assert len(landing.contacts) == 4
    assert landing.contacts.surfaces == ("floor",) * 4
    np.testing.assert_allclose(landing.velocities_W, [[0.0, 0.0, -3.0]] * 4, atol=1e-14)


def test_the_surface_that_is_reached_first_counts() -> None:
    landing = next_landing(BOX, state(10.0, v=(9.0, 0.0, 0.0)), WORLD, horizon=5.0)
    assert landing is not None
    assert landing.seconds == pytest.approx(0.2, abs=1e-15)  # 1.8 m to the wall at 9 m/s
    assert set(landing.contacts.surfaces) == {"wall"}


def test_a_body_without_a_shape_is_refused_by_name() -> None:
    point = Body(name="point", mass_properties=BOX.mass_properties)
    words = r"^body 'point' must have `vertices_B` or a `shape`, got neither"
    with pytest.raises(NoContactError, match=words):
        next_landing(point, state(1.0), WORLD, horizon=1.0)
    with pytest.raises(NoContactError, match=words):
        find_contacts(point, state(1.0), WORLD)
    with pytest.raises(NoContactError, match=words):
        impact_sequence(point, state(1.0), WORLD)


def test_beyond_the_horizon_nothing_lands() -> None:
    assert next_landing(BOX, state(0.1 + 0.45), WORLD, horizon=0.29) is None


def test_a_box_at_rest_has_landed_and_does_not_strike() -> None:
    landing = next_landing(BOX, state(0.1), WORLD, horizon=1.0)
    assert landing is not None
    assert (landing.seconds, landing.strikes, len(landing.contacts)) == (0.0, False, 4)


def test_what_leaves_is_no_contact_of_a_box_that_tips() -> None:
    """Turning about y with the centre still: two corners sink, two rise."""
    landing = next_landing(BOX, state(0.1, w=(0.0, 1.0, 0.0)), WORLD, horizon=1.0)
    assert landing is not None
    assert (landing.seconds, landing.strikes) == (0.0, True)
    np.testing.assert_allclose(landing.contacts.p_WC_W[:, 0], 0.2)
    np.testing.assert_allclose(landing.velocities_W[:, 2], -0.2, atol=1e-15)


@given(spin=st.tuples(*[st.floats(-20.0, 20.0)] * 3), height=st.floats(0.5, 3.0), rise=st.floats(-3.0, 3.0))
def test_no_corner_is_below_a_surface_before_the_landing(
    spin: tuple[float, float, float], height: float, rise: float
) -> None:
    begin = state(height, v=(0.5, 0.0, rise), w=spin)
    landing = next_landing(BOX, begin, WORLD, horizon=3.0)
    assert landing is not None
    times = np.linspace(0.0, landing.seconds, 200)
    samples = free_motion(BOX.mass_properties, begin, gravity_W=WORLD.gravity_W).at(times)
    lowest = math.inf
    for i in range(len(samples)):
        at = BodyState(
            p_WB_W=samples.p_WB_W[i], q_WB=samples.q_WB[i], v_WB_W=samples.v_WB_W[i], w_WB_W=samples.w_WB_W[i]
        )
        corners = at.p_WB_W + BOX.vertices_B @ at.R_WB.T
        lowest = min(lowest, float(FLOOR.gaps(corners).min()), float(WALL.gaps(corners).min()))
    assert lowest > -1e-9  # m: grazing depth of the search and rounding of metres
    assert (
        min(abs(FLOOR.gaps(landing.contacts.p_WC_W)).min(), abs(WALL.gaps(landing.contacts.p_WC_W)).min())
        < 1e-9
    )
