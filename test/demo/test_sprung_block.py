# SPDX-License-Identifier: Apache-2.0
"""The physics of the examples does what mechanics says in closed form, within what its springs give way."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact_dynamics import Body, Surface, World
from contact_dynamics.demo.sprung_block import Load, SprungBlock
from contact_dynamics.errors import NotSupportedError
from contact_dynamics.rigid_body import inertia
from contact_dynamics.shapes import box, sphere

G = 9.80665
MASS, FRICTION, SIZE = 1.0, 0.5, (0.08, 0.08, 0.2)
LOW = (0.2, 0.2, 0.08)
GROWS_S = 0.5
BLOCK = Body.of("block", inertia.box(size=SIZE, mass=MASS), shape_F=box(size=SIZE))
FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=FRICTION, restitution=0.0)
WORLD = World(bodies=(BLOCK,), surfaces=(FLOOR,))


def pushed(force: float, height: float, seconds: float) -> SprungBlock:
    """The block so many s after a push has grown to a force, in half a second, so that it does not rock."""
    block = SprungBlock.resting(BLOCK, WORLD)
    for i in range(round((GROWS_S + seconds) / 0.001)):
        now = force * min(1.0, i * 0.001 / GROWS_S)
        block.move(Load(force_x=now, force_z=-MASS * G, moment=(height - block.z) * now), 0.001)
    return block


def test_a_block_at_rest_stays_where_it_is() -> None:
    block = pushed(0.0, 0.03, 0.5)
    # It begins where its springs carry it: rounding of 0.1 m, in 5000 steps.
    assert (block.x, block.z, block.angle) == pytest.approx((0.0, 0.1 - G / 2e5, 0.0), abs=1e-12)


@pytest.mark.parametrize("share", [0.97, 1.03])
def test_it_slides_from_coulombs_friction_on(share: float) -> None:
    before, after = (pushed(share * FRICTION * MASS * G, 0.03, seconds) for seconds in (0.1, 0.3))
    if share < 1.0:
        # The springs of two feet give way by 5 N / 2e5 N/m, and as they tilt the block as much at its middle.
        assert abs(after.x) < 2e-4
        # What is left of its rocking; it slides with 0.1 m/s by now where it slides.
        assert abs(after.vx) < 1e-3
    else:
        # The rocking, as above, of 0.03 m/s.
        assert after.vx - before.vx == pytest.approx((share - 1.0) * FRICTION * G * 0.2, rel=0.03)


@pytest.mark.parametrize("share", [0.97, 1.03])
def test_it_tips_where_the_push_outweighs_its_weight_about_its_edge(share: float) -> None:
    height, lever = 0.15, 0.04
    push = share * MASS * G * lever / height
    before, after = (pushed(push, height, seconds) for seconds in (0.1, 0.102))
    if share < 1.0:
        assert abs(after.angle) < 5e-3  # the springs give way by 0.1 mm on 80 mm, and rock
        return
    about_edge = MASS * (0.08**2 + 0.2**2) / 12.0 + MASS * (lever**2 + 0.1**2)
    shrunk = lever * math.cos(after.angle) - 0.1 * math.sin(after.angle)
    expected = (push * height - MASS * G * shrunk) / about_edge
    # Over the 2 ms the angle grows by 1 %, and the edge springs.
    assert (after.spin - before.spin) / 0.002 == pytest.approx(expected, rel=0.05)


def test_on_a_slope_it_slides_as_galilei_found() -> None:
    tilt = math.radians(30.0)
    lying = Body.of("block", inertia.box(size=LOW, mass=MASS), shape_F=box(size=LOW))
    block = SprungBlock.resting(lying, WORLD)
    speeds = []
    for _ in range(2):
        block.move(Load(force_x=MASS * G * math.sin(tilt), force_z=-MASS * G * math.cos(tilt)), 0.2)
        speeds.append(block.vx)
    # The load came at once, so that it rocks: the friction wavers, and 1 % of it is left after 0.2 s.
    assert speeds[1] - speeds[0] == pytest.approx(
        G * (math.sin(tilt) - FRICTION * math.cos(tilt)) * 0.2, rel=0.01
    )


def test_its_state_is_that_of_the_body() -> None:
    block = pushed(3.5, 0.15, 0.3)
    state = block.state(7)
    assert state.stamp_ns == 7
    np.testing.assert_allclose(state.R_WB @ [0, 0, 1], [math.sin(block.angle), 0, math.cos(block.angle)])
    np.testing.assert_array_equal(state.w_WB_W, [0.0, block.spin, 0.0])


def test_what_has_no_corners_or_stands_askew_is_refused() -> None:
    ball = Body(name="ball", mass_properties=BLOCK.mass_properties, shape=sphere(radius=0.1))
    with pytest.raises(NotSupportedError, match=r"body 'ball' must have corners, got a round shape"):
        SprungBlock.resting(ball, WORLD)
    askew = Surface(name="bank", p_WS_W=[0, 0, 0], normal_W=[0, 0.6, 0.8], friction=0.5, restitution=0.0)
    with pytest.raises(NotSupportedError, match="bank"):
        SprungBlock.resting(BLOCK, World(bodies=(BLOCK,), surfaces=(askew,)))
