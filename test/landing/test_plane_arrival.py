# SPDX-License-Identifier: Apache-2.0
"""The first contact of a tossed body: beside dense sampling, at grazes, and in every way to begin."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.landing.plane_arrival import first_contact
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.tolerances import GRAZING_DEPTH
from contact_dynamics.tumbling import FreeMotion, free_motion

CUBE_B = 0.05 * np.array(list(itertools.product([-1.0, 1.0], repeat=3)))
FLOOR = (0.0, 0.0, 0.0)
UP = (0.0, 0.0, 1.0)
UPRIGHT = (0.0, 0.0, 0.0, 1.0)


def toss(
    height: float,
    *,
    q_WB: tuple[float, ...] = UPRIGHT,
    v: tuple[float, ...] = (0.0, 0.0, 0.0),
    w: tuple[float, ...] = (0.0, 0.0, 0.0),
    moments: tuple[float, float, float] = (1.0, 1.3, 1.7),
    gravity: float = -9.81,
) -> FreeMotion:
    body = MassProperties(mass=0.4, I_B=1e-4 * np.diag(moments))
    state = BodyState(p_WB_W=(0.0, 0.0, height), q_WB=q_WB, v_WB_W=v, w_WB_W=w)
    return free_motion(body, state, gravity_W=(0.0, 0.0, gravity))


finite = st.floats(-1.0, 1.0)


@given(
    height=st.floats(0.0867, 1.5),  # all corners above the floor
    direction=st.tuples(finite, finite, finite, finite).filter(lambda q: np.linalg.norm(q) > 0.1),
    v=st.tuples(finite, finite, finite),
    w=st.tuples(finite, finite, finite),
    tumbling=st.sampled_from([0.0, 1.0, 20.0, 200.0]),
)
def test_agrees_with_dense_sampling(
    height: float, direction: tuple[float, ...], v: tuple[float, ...], w: tuple[float, ...], tumbling: float
) -> None:
    q_WB = np.array(direction) / np.linalg.norm(direction)
    motion = toss(height, q_WB=tuple(q_WB), v=tuple(2.0 * np.array(v)), w=tuple(tumbling * np.array(w)))
    times = np.linspace(0.0, 1.0, 4001)
    trajectory = motion.at(times)
    up_B = Rotation.from_quat(trajectory.q_WB).apply(UP, inverse=True)
    heights = up_B @ CUBE_B.T + trajectory.p_WB_W[:, 2:]
    found = first_contact(motion, CUBE_B, FLOOR, UP, horizon=1.0)
    if found is None:
        crossings = (heights[:-1] > 0.0) & (heights[1:] <= 0.0)
        assert not crossings.any()
        return
    earlier = times < found.seconds
    crossings = (heights[:-1] > 0.0) & (heights[1:] <= 0.0)
    assert not crossings[earlier[1:]].any()
    state = motion.state_at(found.seconds)
    corner_W = state.p_WB_W + state.R_WB @ CUBE_B[found.vertices[0]]
    assert found.p_WC_W == pytest.approx(corner_W, abs=1e-14)
    assert found.v_WC_W == pytest.approx(state.velocity_of_point(corner_W), abs=1e-12)
    assert abs(found.p_WC_W[2]) < 1e-14  # the last bits of a time of 1 s at 12 m/s
    assert found.v_WC_W[2] <= 1e-6


def test_falling_flat_arrives_with_four_corners_at_the_time_of_the_parabola() -> None:
    found = first_contact(toss(1.05), CUBE_B, FLOOR, UP, horizon=1.0)
    assert found is not None
    assert found.seconds == pytest.approx(math.sqrt(2.0 / 9.81), rel=1e-15)
    assert sorted(found.vertices) == [0, 2, 4, 6]
    assert found.v_WC_W == pytest.approx((0.0, 0.0, -math.sqrt(2.0 * 9.81)), rel=1e-14)


def test_a_ceiling_is_missed_or_reached_by_the_height_of_the_throw() -> None:
    down = (0.0, 0.0, -1.0)
    motion = toss(0.0, v=(0.0, 0.0, 3.0))
    apex = 3.0**2 / (2.0 * 9.81) + 0.05
    assert first_contact(motion, CUBE_B, (0.0, 0.0, apex + 1e-7), down, horizon=10.0) is None
    found = first_contact(motion, CUBE_B, (0.0, 0.0, apex - 1e-7), down, horizon=10.0)
    assert found is not None
    assert found.seconds == pytest.approx(3.0 / 9.81 - math.sqrt(2.0 * 1e-7 / 9.81), abs=1e-9)


@pytest.mark.parametrize("w", [0.3, 30.0, 300.0])
@pytest.mark.parametrize("depth", [1.1 * GRAZING_DEPTH, 1e-7, 1e-3])
def test_no_graze_is_missed(w: float, depth: float) -> None:
    """Weightless and spinning about x: an edge is lowest, by the half diagonal, once in a quarter turn."""
    half_diagonal = 0.05 * math.sqrt(2.0)
    motion = toss(half_diagonal - depth, w=(w, 0.0, 0.0), gravity=0.0)
    found = first_contact(motion, CUBE_B, FLOOR, UP, horizon=7.0 / w)
    assert found is not None
    expected = (math.pi / 4.0 - math.acos(1.0 - depth / half_diagonal)) / w
    assert found.seconds == pytest.approx(expected, abs=1e-9 / w)
    clear = toss(half_diagonal + depth, w=(w, 0.0, 0.0), gravity=0.0)
    assert first_contact(clear, CUBE_B, FLOOR, UP, horizon=7.0 / w) is None


def test_hovering_just_above_the_plane_ends() -> None:
    motion = toss(0.05 + 1e-10, w=(0.0, 0.0, 20.0), gravity=0.0)
    assert first_contact(motion, CUBE_B, FLOOR, UP, horizon=0.1) is None


@pytest.mark.parametrize("height", [0.05, 0.05 - 1e-7, 0.04])
def test_on_the_plane_and_rising_is_a_contact_when_it_comes_down(height: float) -> None:
    found = first_contact(toss(height, v=(0.0, 0.0, 1.0)), CUBE_B, FLOOR, UP, horizon=1.0)
    assert found is not None
    gap = height - 0.05
    assert found.seconds == pytest.approx((1.0 + math.sqrt(1.0 + 2.0 * 9.81 * gap)) / 9.81, rel=1e-13)


def test_below_the_plane_and_never_above_arrives_where_it_turns() -> None:
    found = first_contact(toss(0.0, v=(0.0, 0.0, 0.1)), CUBE_B, FLOOR, UP, horizon=1.0)
    assert found is not None
    assert found.seconds == pytest.approx(0.1 / 9.81, abs=2e-5)  # the time in which a graze goes by


def test_a_body_without_corners_is_refused() -> None:
    with pytest.raises(InvalidFieldError, match=r"^shape_B must be a shape or at least.*, got nothing"):
        first_contact(toss(1.0), np.zeros((0, 3)), FLOOR, UP, horizon=1.0)
