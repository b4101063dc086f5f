# SPDX-License-Identifier: Apache-2.0
"""A flight is shown until a surface is in its way."""

from __future__ import annotations

import numpy as np
import pytest

from contact_dynamics import BodyState, MassProperties, Surface, free_motion
from contact_dynamics.diagrams.flight import DEEP, outside
from contact_dynamics.diagrams.shape import drawn_shape
from contact_dynamics.shapes import box, sphere

FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.5)
WALL = Surface(name="wall", p_WS_W=[0.5, 0, 0], normal_W=[-1, 0, 0], friction=0.3, restitution=0.5)
BODY = MassProperties(mass=1.0, I_B=np.diag([0.01, 0.01, 0.01]))
HALF = 0.05  # m, of the body's height
TIMES = np.linspace(0.0, 1.0, 1001)


@pytest.mark.parametrize("shape", [box(size=(0.1, 0.1, 0.1)), sphere(radius=HALF)], ids=["box", "ball"])
def test_a_body_at_rest_does_not_fall_through_the_floor(shape: object) -> None:
    resting = BodyState(p_WB_W=[0, 0, HALF - 1e-4], q_WB=[0, 0, 0, 1])
    drawn = drawn_shape(shape)
    shown, name = outside(free_motion(BODY, resting).at(TIMES), drawn, (WALL, FLOOR))
    assert name == "floor"
    fallen = resting.p_WB_W[2] - shown.p_WB_W[-1, 2]
    step = 9.80665 * shown.seconds[-1] * 1e-3  # m, on which it falls until the next sample
    assert 0.0 <= DEEP * drawn.size - fallen <= step + 1e-4


def test_a_flight_past_all_surfaces_is_shown_to_its_end_and_the_first_surface_in_the_way_counts() -> None:
    shape = drawn_shape(box(size=(0.1, 0.1, 0.1)))
    rises = BodyState(p_WB_W=[0, 0, 0.1], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, 9.0])
    motion = free_motion(BODY, rises).at(TIMES)
    assert outside(motion, shape, (FLOOR, WALL)) == (motion, "")
    strikes = BodyState(p_WB_W=[0, 0, 0.1], q_WB=[0, 0, 0, 1], v_WB_W=[4.0, 0, 4.0])
    shown, name = outside(free_motion(BODY, strikes).at(TIMES), shape, (FLOOR, WALL))
    assert name == "wall"
    assert shown.p_WB_W[-1, 0] < 0.5
