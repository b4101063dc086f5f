# SPDX-License-Identifier: Apache-2.0
"""Flights that end on surfaces that move: paddles, belts and turntables."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

import contact_dynamics as cd
from contact_dynamics.errors import NotSupportedError
from contact_dynamics.landing import next_landing
from contact_dynamics.motion import Drag, forced_motion

G = 9.80665
UP = np.array([0.0, 0.0, 1.0])
BALL = cd.Body.sphere(0.02, 0.0027)
BOX = cd.Body.box((0.3, 0.2, 0.1), 1.0)
DROPPED = cd.BodyState(p_WB_W=[0, 0, 1.02], q_WB=[0, 0, 0, 1])
FLOOR = cd.Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=UP, friction=0.4, restitution=0.8)


@pytest.mark.parametrize(("u", "a"), [(1.5, 0.0), (-2.0, 0.0), (0.0, 3.0), (0.7, -5.0), (-0.5, 20.0)])
def test_a_ball_meets_a_paddle_when_a_quadratic_says(u: float, a: float) -> None:
    # The gap 1 - u t - (g + a) t^2 / 2 is zero.
    paddle = replace(FLOOR, v_WS_W=np.array([0.3, -0.1, u]), a_WS_W=np.array([0.2, 0, a]))
    landing = next_landing(BALL, DROPPED, cd.World(surfaces=(paddle,)))
    assert landing is not None
    t = 2.0 / (u + math.sqrt(u * u + 2.0 * (G + a)))
    assert landing.seconds == pytest.approx(t, rel=1e-14)
    (contact,) = landing.contacts
    assert contact.surface_velocity_W is not None
    np.testing.assert_allclose(contact.surface_velocity_W, [0.3 + 0.2 * t, -0.1, u + a * t], rtol=1e-14)
    assert contact.p_WC_W[2] == pytest.approx(u * t + 0.5 * a * t * t, abs=1e-15)
    rebound = cd.spatial_impact(BALL, landing.state, contact).state.v_WB_W[2]
    assert rebound == pytest.approx(u + a * t + 0.8 * (u + (a + G) * t), rel=1e-13)


def test_a_spinning_box_meets_the_first_of_surfaces_that_move_differently() -> None:
    # Heights of the corners above each surface at each time, by SciPy's roots of a rotation about one axis.
    state = cd.BodyState(p_WB_W=[0, 0, 0.6], q_WB=[0, 0, 0, 1], v_WB_W=[1.0, 0, 1.0], w_WB_W=[0, 3.0, 0])
    lift = replace(FLOOR, name="lift", p_WS_W=np.array([0, 0, -0.5]), v_WS_W=np.array([0, 0, 1.1]))
    wall = cd.Surface(
        name="wall",
        p_WS_W=[2.0, 0, 0],
        normal_W=[-1, 0, 0],
        friction=0.1,
        restitution=0.2,
        v_WS_W=[-4.0, 0, 1.0],
    )

    def lowest(surface: cd.Surface, t: float) -> float:
        corners = BOX.vertices_B @ Rotation.from_rotvec(state.w_WB_W * t).as_matrix().T
        points = state.p_WB_W + state.v_WB_W * t - 0.5 * G * t * t * UP + corners
        return float(((points - surface.p_WS_W - surface.v_WS_W * t) @ surface.normal_W).min())

    for surfaces in [(FLOOR, lift, wall), (lift, FLOOR), (wall,)]:
        times = np.linspace(0, 1, 2001)
        expected = min(
            brentq(lambda t, one=one: lowest(one, t), times[k - 1], times[k], xtol=1e-15)
            for one in surfaces
            if (k := next((k for k, t in enumerate(times) if lowest(one, t) < 0.0), 0))
        )
        landing = next_landing(BOX, state, cd.World(surfaces=surfaces))
        assert landing is not None
        assert landing.seconds == pytest.approx(expected, abs=1e-13)
        assert landing.strikes


def test_only_the_approach_to_the_surface_is_a_strike() -> None:
    resting = replace(DROPPED, p_WB_W=np.array([0, 0, 0.02]), v_WB_W=np.array([0, 0, 0.5]))
    world = cd.World(surfaces=(replace(FLOOR, v_WS_W=np.array([1.0, 0, 0.5])),))
    landing = next_landing(BALL, resting, world)
    assert landing is not None
    assert (landing.seconds, landing.strikes) == (0.0, False)
    faster = next_landing(BALL, replace(resting, v_WB_W=np.zeros(3)), world)
    assert faster is not None
    assert faster.strikes
    leaving = next_landing(BALL, replace(resting, v_WB_W=np.array([0, 0, 1.5])), world)
    assert leaving is not None
    assert leaving.seconds == pytest.approx(2.0 / G, rel=1e-14)


@pytest.mark.parametrize("alpha", [0.0, 0.7])
@pytest.mark.parametrize("point", [[0.0, 0.0], [1.0, -0.5]], ids=["axis", "elsewhere"])
def test_a_ball_lands_on_a_turntable_at_rim_speed(point: list[float], alpha: float) -> None:
    # The axis is at (0.4, 0.1) and rises; the turntable may be described by any of its points.
    axis, w = np.array([0.4, 0.1, 0.0]), 3.0
    p = np.array([*point, 0.0])
    turn, r = np.array([0, 0, w]), p - axis
    table = replace(
        FLOOR,
        p_WS_W=p,
        v_WS_W=np.cross(turn, r) + 0.2 * UP,
        w_WS_W=turn,
        a_WS_W=np.cross([0, 0, alpha], r) - w * w * r,
        alpha_WS_W=np.array([0, 0, alpha]),
    )
    landing = next_landing(BALL, DROPPED, cd.World(surfaces=(table,)))
    assert landing is not None
    t = 2.0 / (0.2 + math.sqrt(0.04 + 2.0 * G))
    (contact,) = landing.contacts
    assert landing.seconds == pytest.approx(t, rel=1e-14)
    rate = w + alpha * t
    expected = np.cross([0, 0, rate], contact.p_WC_W - axis) + 0.2 * UP
    np.testing.assert_allclose(contact.surface_velocity_W, expected, atol=1e-13)
    np.testing.assert_allclose(contact.surface_angular_velocity_W, [0, 0, rate], rtol=1e-15)


@pytest.mark.parametrize(
    ("motion", "message"),
    [
        ({"w_WS_W": [0.1, 0, 2]}, "must turn about its normal only"),
        ({"alpha_WS_W": [0, 1e-3, 0]}, "must turn about its normal only"),
        ({"w_WS_W": [0, 0, 2], "v_WS_W": [1, 0, 0]}, "must turn about a fixed axis"),
        ({"alpha_WS_W": [0, 0, 2], "v_WS_W": [1, 0, 0]}, "must turn about a fixed axis"),
        ({"w_WS_W": [0, 0, 2], "a_WS_W": [1, 0, 0]}, "must turn about a fixed axis"),
    ],
)
def test_surfaces_whose_later_motion_is_not_known_are_refused(
    motion: dict[str, list[float]], message: str
) -> None:
    table = replace(FLOOR, **{name: np.array(value, dtype=float) for name, value in motion.items()})
    with pytest.raises(NotSupportedError, match=f"surface 'floor' {message}"):
        next_landing(BALL, DROPPED, cd.World(surfaces=(table,)))


def test_under_forces_surfaces_may_move_in_their_own_plane_only() -> None:
    drag = forced_motion(BALL, DROPPED, drag=Drag(linear=0.01))
    belt = replace(FLOOR, v_WS_W=np.array([2.0, 0, 0]))
    landing = next_landing(BALL, DROPPED, cd.World(surfaces=(belt,)), motion=drag, horizon=1.0)
    at_rest = next_landing(BALL, DROPPED, cd.World(surfaces=(FLOOR,)), motion=drag, horizon=1.0)
    assert landing is not None
    assert at_rest is not None
    assert landing.seconds == at_rest.seconds
    paddle = cd.World(surfaces=(replace(FLOOR, v_WS_W=np.array([0, 0, 2.0])),))
    with pytest.raises(
        NotSupportedError, match="must not move along its normal where a body moves under forces"
    ):
        next_landing(BALL, DROPPED, paddle, motion=drag, horizon=1.0)


def test_a_juggled_ball_stays_on_its_orbit() -> None:
    # A paddle that strikes at u where e (v + u) + u = v returns the ball at v, each 2 v / g.
    v = 3.0
    u = v * (1.0 - 0.8) / (1.0 + 0.8)
    state = cd.BodyState(p_WB_W=[0, 0, 0.02], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, v])
    seconds = 0.0
    for _ in range(100):
        # The paddle is at height zero when the ball is: it starts u 2 v / g below.
        paddle = replace(FLOOR, p_WS_W=np.array([0, 0, -u * 2.0 * v / G]), v_WS_W=np.array([0, 0, u]))
        landing = next_landing(BALL, state, cd.World(surfaces=(paddle,)))
        assert landing is not None
        seconds += landing.seconds
        state = cd.spatial_impact(BALL, landing.state, landing.contacts[0]).state
    # Rounding of each bounce is passed on, and not amplified: the orbit is stable against heights.
    assert seconds == pytest.approx(100 * 2.0 * v / G, rel=1e-9)
    assert state.v_WB_W[2] == pytest.approx(v, rel=1e-9)


@pytest.mark.parametrize("carried", [[0.7, -0.4, 1.2], [0.0, 0.0, -0.8]])
def test_a_sequence_of_strikes_is_the_same_from_a_frame_that_moves(carried: list[float]) -> None:
    u, a = np.array(carried), np.array([0.3, 0.1, 2.0])
    wall = cd.Surface(name="wall", p_WS_W=[0.3, 0, 0], normal_W=[-1, 0, 0], friction=0.2, restitution=0.5)
    state = cd.BodyState(
        p_WB_W=[0, 0, 0.3],
        q_WB=np.array([0.1, 0.2, 0, 1.0]) / np.sqrt(1.05),
        v_WB_W=[1.5, 0, -1.0],
        w_WB_W=[1, 2, 3],
    )
    alone = cd.impact_sequence(
        BOX,
        state,
        cd.World(surfaces=(FLOOR, wall), gravity_W=[-0.3, -0.1, -G - 2.0]),
        window=0.3,
        max_strikes=8,
    )
    moving = tuple(replace(each, v_WS_W=u, a_WS_W=a) for each in (FLOOR, wall))
    found = cd.impact_sequence(
        BOX, replace(state, v_WB_W=state.v_WB_W + u), cd.World(surfaces=moving), window=0.3, max_strikes=8
    )
    assert (found.order, found.end) == (alone.order, alone.end)
    assert len(found.strikes) > 3
    # Each strike amplifies the rounding of velocities, of some 1e-16, by up to ten.
    for one, other in zip(found.strikes, alone.strikes, strict=True):
        t = other.seconds
        assert one.seconds == pytest.approx(t, abs=1e-12)
        np.testing.assert_allclose(one.p_WC_W - u * t - 0.5 * a * t * t, other.p_WC_W, atol=1e-11)
        np.testing.assert_allclose(one.state_after.v_WB_W - u - a * t, other.state_after.v_WB_W, atol=1e-9)
        np.testing.assert_allclose(one.impulse_W, other.impulse_W, atol=1e-9)
    first = found.contacts[0]
    t = found.strikes[0].seconds
    np.testing.assert_allclose(first.p_WC_W, found.strikes[0].p_WC_W, atol=1e-12)
    np.testing.assert_allclose(first.surface_velocity_W, u + a * t, atol=1e-12)
    assert found.state is found.strikes[-1].state_after
