# SPDX-License-Identifier: Apache-2.0
"""First contacts of round bodies: closed forms, grazes, and dense sampling of their support functions."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from contact_dynamics.landing.plane_arrival import first_contact
from contact_dynamics.motion.forces import Drag
from contact_dynamics.motion.integrated import forced_motion
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.shapes.convex import ConvexShape, Rim, box, capsule, cone, cylinder, rounded, sphere
from landing.test_plane_arrival import toss

FLOOR = (0.0, 0.0, 0.0)
UP = (0.0, 0.0, 1.0)
BODY = MassProperties(mass=0.4, I_B=1e-4 * np.diag([1.0, 1.3, 1.7]))
G = 9.81

SHAPES = {
    "sphere": sphere(radius=0.06),
    "off centre": sphere(radius=0.03).moved((0.03, -0.02, 0.04)),
    "capsule": capsule(radius=0.02, length=0.1),
    "cylinder": cylinder(radius=0.05, length=0.04),
    "disc": cylinder(radius=0.06, length=0.0),
    "cone": cone(radius=0.04, height=0.08).moved((0.0, 0.01, -0.02), (0.5, 0.5, 0.5, 0.5)),
    "rounded box": rounded(box(size=(0.08, 0.04, 0.02)), radius=0.01),
    "rounded disc": rounded(cylinder(radius=0.04, length=0.0), radius=0.01),
}


def lowest(shape: ConvexShape, down_B: np.ndarray) -> np.ndarray:
    """The least heights over the centre of mass for directions (n, 3) that point down: support functions."""
    values = [-(down_B @ vertex) for vertex in shape.vertices]
    for rim in shape.rims:
        level = np.linalg.norm(np.cross(down_B, rim.axis), axis=1)
        values.append(-(down_B @ np.array(rim.center)) - rim.radius * level)
    return np.min(values, axis=0) - shape.rounding


finite = st.floats(-1.0, 1.0)
turns = st.tuples(finite, finite, finite, finite).filter(lambda q: np.linalg.norm(q) > 0.1)


@pytest.mark.parametrize("name", list(SHAPES))
@settings(max_examples=15)
@given(
    height=st.floats(0.11, 0.8),
    q=turns,
    rates=st.tuples(st.tuples(finite, finite, finite), st.tuples(finite, finite, finite)),
    tumbling=st.sampled_from([0.0, 1.0, 20.0, 100.0]),
)
def test_agrees_with_dense_sampling_of_the_support_function(
    name: str,
    height: float,
    q: tuple[float, ...],
    rates: tuple[tuple[float, ...], tuple[float, ...]],
    tumbling: float,
) -> None:
    v, w = rates
    q_WB = tuple(np.array(q) / np.linalg.norm(q))
    motion = toss(height, q_WB=q_WB, v=v, w=tuple(tumbling * np.array(w)))
    found = first_contact(motion, SHAPES[name], FLOOR, UP, horizon=1.0)
    assert found is not None
    times = np.linspace(0.0, found.seconds, 2000)
    trajectory = motion.at(times)
    down_B = Rotation.from_quat(trajectory.q_WB).apply((0.0, 0.0, -1.0), inverse=True)
    heights = lowest(SHAPES[name], down_B) + trajectory.p_WB_W[:, 2]
    assert heights[:-1].min() > -1e-9  # the grazing depth
    assert heights[-1] == pytest.approx(0.0, abs=1e-13)
    state = motion.state_at(found.seconds)
    assert abs(found.p_WC_W[2]) < 1e-13
    assert found.v_WC_W == pytest.approx(state.velocity_of_point(found.p_WC_W), abs=1e-12)
    assert found.v_WC_W[2] <= 1e-5
    # the point is one of the body: its support in its own direction is not beyond the shape's
    arm_B = state.R_WB.T @ (found.p_WC_W - state.p_WB_W)
    for direction in np.vstack([np.eye(3), -np.eye(3)]):
        assert arm_B @ direction <= -lowest(SHAPES[name], direction[None])[0] + 1e-12


def test_a_capsule_that_lies_level_lands_with_both_ends() -> None:
    level = (0.0, math.sqrt(0.5), 0.0, math.sqrt(0.5))
    found = first_contact(toss(1.02, q_WB=level), SHAPES["capsule"], FLOOR, UP, horizon=1.0)
    assert found is not None
    assert found.seconds == pytest.approx(math.sqrt(2.0 / G), rel=1e-14)
    assert sorted(found.vertices) == [0, 1]


def test_a_cylinder_lands_flat_on_its_base() -> None:
    found = first_contact(toss(1.02), SHAPES["cylinder"], FLOOR, UP, horizon=1.0)
    assert found is not None
    assert found.seconds == pytest.approx(math.sqrt(2.0 / G), rel=1e-14)
    assert found.vertices == (0,)


@pytest.mark.parametrize("w", [0.3, 30.0, 300.0])
@pytest.mark.parametrize("depth", [2e-9, 1e-7, 1e-3])
def test_no_graze_of_a_turning_disc_is_missed(w: float, depth: float) -> None:
    """Weightless, flat at first, about a diameter: its lowest point is R sin(w t) below the centre."""
    radius = 0.06
    motion = toss(radius - depth, w=(w, 0.0, 0.0), gravity=0.0)
    found = first_contact(motion, SHAPES["disc"], FLOOR, UP, horizon=4.0 / w)
    assert found is not None
    assert found.seconds == pytest.approx(math.asin(1.0 - depth / radius) / w, abs=1e-8 / w)
    clear = toss(radius + depth, w=(w, 0.0, 0.0), gravity=0.0)
    assert first_contact(clear, SHAPES["disc"], FLOOR, UP, horizon=4.0 / w) is None


def test_a_wheel_that_spins_close_above_the_plane_never_arrives() -> None:
    """Its lowest material point changes all the time, its height does not."""
    upright = (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))
    motion = toss(0.06 + 1e-3, q_WB=upright, w=(0.0, 50.0, 0.0), gravity=0.0)
    assert first_contact(motion, SHAPES["disc"], FLOOR, UP, horizon=0.2) is None


def test_a_disc_on_the_plane_that_is_thrown_up_comes_down_again() -> None:
    motion = toss(0.0, v=(0.0, 0.0, 2.0), w=(20.0, 0.0, 3.0))
    found = first_contact(motion, SHAPES["disc"], FLOOR, UP, horizon=1.0)
    assert found is not None
    assert 2.0 * 2.0 / G - 0.06 < found.seconds < 2.0 * 2.0 / G


def test_a_round_body_under_drag() -> None:
    state = BodyState(
        p_WB_W=(0.0, 0.0, 0.5), q_WB=(0.0, 0.0, 0.0, 1.0), v_WB_W=(0.0, 0.0, 1.0), w_WB_W=(9.0, 2.0, 3.0)
    )
    shape = SHAPES["cylinder"]
    motion = forced_motion(BODY, state, gravity_W=(0.0, 0.0, -G), drag=Drag(linear=0.2, linear_angular=1e-4))
    found = first_contact(motion, shape, FLOOR, UP, horizon=2.0)
    assert found is not None
    trajectory = motion.at(np.linspace(0.0, found.seconds, 2000))
    down_B = Rotation.from_quat(trajectory.q_WB).apply((0.0, 0.0, -1.0), inverse=True)
    heights = lowest(shape, down_B) + trajectory.p_WB_W[:, 2]
    assert heights[:-1].min() > 0.0
    assert heights[-1] == pytest.approx(0.0, abs=1e-12)


def test_a_rim_is_the_limit_of_many_corners() -> None:
    angles = np.linspace(0.0, 2.0 * math.pi, 3000, endpoint=False)
    ring = 0.05 * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))])
    motion = toss(0.6, q_WB=(0.1, 0.7, -0.1, 0.7), v=(0.0, 0.3, 1.0), w=(7.0, 11.0, -4.0))
    rim = ConvexShape(rims=(Rim((0.0, 0.0, 0.0), UP, 0.05),))
    smooth = first_contact(motion, rim, FLOOR, UP, horizon=1.0)
    corners = first_contact(motion, ring, FLOOR, UP, horizon=1.0)
    assert smooth is not None
    assert corners is not None
    # The polygon's sagitta is R (1 - cos(pi / 3000)) = 3e-8 m, at more than 1 m/s.
    assert 0.0 <= corners.seconds - smooth.seconds < 3e-8
