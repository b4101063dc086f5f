# SPDX-License-Identifier: Apache-2.0
"""First contacts under torque and drag: closed forms, brute-force steps, dense sampling, and no force."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.landing import next_landing
from contact_dynamics.landing.acceleration_bounds import bounds_of
from contact_dynamics.landing.plane_arrival import first_contact
from contact_dynamics.motion.forces import ConstantWrench, Drag, WrenchAxes
from contact_dynamics.motion.integrated import ForcedMotion, forced_motion
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.tumbling import free_motion
from contact_dynamics.world import Body, Surface, World
from oracles.forced_stepped import stepped

CUBE_B = 0.05 * np.array(list(itertools.product([-1.0, 1.0], repeat=3)))
BODY = MassProperties(mass=0.4, I_B=1e-4 * np.diag([1.0, 1.3, 1.7]))
FLOOR = (0.0, 0.0, 0.0)
UP = (0.0, 0.0, 1.0)
DOWN_W = np.array([0.0, 0.0, -9.81])


def start(
    height: float,
    *,
    q_WB: tuple[float, ...] = (0.0, 0.0, 0.0, 1.0),
    v: tuple[float, ...] = (0.0, 0.0, 0.0),
    w: tuple[float, ...] = (0.0, 0.0, 0.0),
) -> BodyState:
    return BodyState(p_WB_W=(0.0, 0.0, height), q_WB=q_WB, v_WB_W=v, w_WB_W=w)


finite = st.floats(-1.0, 1.0)
turns = st.tuples(finite, finite, finite, finite).filter(lambda q: np.linalg.norm(q) > 0.1)
vectors = st.tuples(finite, finite, finite)


@settings(max_examples=20)
@given(height=st.floats(0.1, 1.0), q=turns, v=vectors, w=vectors, tumbling=st.sampled_from([1.0, 10.0, 40.0]))
def test_at_zero_torque_it_is_the_closed_form(
    height: float, q: tuple[float, ...], v: tuple[float, ...], w: tuple[float, ...], tumbling: float
) -> None:
    state = start(height, q_WB=tuple(np.array(q) / np.linalg.norm(q)), v=v, w=tuple(tumbling * np.array(w)))
    exact = first_contact(free_motion(BODY, state, gravity_W=DOWN_W), CUBE_B, FLOOR, UP, horizon=0.4)
    found = first_contact(forced_motion(BODY, state, gravity_W=DOWN_W), CUBE_B, FLOOR, UP, horizon=0.4)
    assert (found is None) == (exact is None)
    if found is None or exact is None:
        return
    # Attitudes agree within 1e-10 rad (`forced_motion`), so heights within 1e-11 m; what grazes takes longer.
    speed = max(abs(exact.v_WC_W[2]), 1e-4)
    assert found.seconds == pytest.approx(exact.seconds, abs=1e-11 / speed)
    assert found.v_WC_W == pytest.approx(exact.v_WC_W, abs=1e-8 / speed)


@settings(max_examples=15)
@given(
    height=st.floats(0.0867, 0.8),
    q=turns,
    rates=st.tuples(vectors, vectors),
    torque=st.tuples(vectors, st.sampled_from([1e-4, 1e-2, 0.3])),
    quadratic=st.sampled_from([0.0, 0.05, 2.0]),
)
def test_agrees_with_dense_sampling(
    height: float,
    q: tuple[float, ...],
    rates: tuple[tuple[float, ...], tuple[float, ...]],
    torque: tuple[tuple[float, ...], float],
    quadratic: float,
) -> None:
    v, w = rates
    state = start(height, q_WB=tuple(np.array(q) / np.linalg.norm(q)), v=v, w=tuple(10.0 * np.array(w)))
    motion = forced_motion(
        BODY,
        state,
        gravity_W=DOWN_W,
        wrench=ConstantWrench(
            force=(0.5, 0.0, 0.2), torque=tuple(torque[1] * np.array(torque[0])), axes=WrenchAxes.BODY
        ),
        drag=Drag(linear=0.01, quadratic=quadratic, quadratic_angular=1e-6),
    )
    found = first_contact(motion, CUBE_B, FLOOR, UP, horizon=0.3)
    times = np.linspace(0.0, 0.3 if found is None else found.seconds, 1000)
    trajectory = motion.at(times)
    up_B = Rotation.from_quat(trajectory.q_WB).apply(UP, inverse=True)
    heights = up_B @ CUBE_B.T + trajectory.p_WB_W[:, 2:]
    assert heights[:-1].min() > -1e-9  # the grazing depth
    if found is not None:
        assert heights[-1].min() == pytest.approx(0.0, abs=1e-12)
        assert abs(found.p_WC_W[2]) < 1e-12


@pytest.mark.parametrize("depth", [1e-7, 1e-3])
def test_no_graze_is_missed_while_a_torque_spins_up(depth: float) -> None:
    """Weightless, about x from rest: an edge is lowest at pi / 4, at the time sqrt(2 angle I / N)."""
    half_diagonal = 0.05 * math.sqrt(2.0)
    torque = ConstantWrench(torque=(0.02, 0.0, 0.0))
    none = np.zeros(3)
    motion = forced_motion(BODY, start(half_diagonal - depth), gravity_W=none, wrench=torque)
    found = first_contact(motion, CUBE_B, FLOOR, UP, horizon=0.5)
    angle = math.pi / 4.0 - math.acos(1.0 - depth / half_diagonal)
    assert found is not None
    assert found.seconds == pytest.approx(math.sqrt(2.0 * angle * 1e-4 / 0.02), abs=1e-10)
    clear = forced_motion(BODY, start(half_diagonal + depth), gravity_W=none, wrench=torque)
    assert first_contact(clear, CUBE_B, FLOOR, UP, horizon=0.5) is None


def test_a_user_s_wrench_beside_brute_force_steps() -> None:
    state = start(0.4, q_WB=(0.5, 0.5, -0.5, 0.5), v=(0.3, 0.0, 1.0), w=(5.0, -8.0, 3.0))

    def wind(t: float, v: np.ndarray) -> np.ndarray:
        return np.array([0.4 * math.sin(9.0 * t), -0.2 * v[1], 0.5 * math.cos(7.0 * t)])

    motion = forced_motion(
        BODY,
        state,
        gravity_W=DOWN_W,
        wrench_of=lambda t, at: (wind(t, np.array(at.v_WB_W)).tolist(), (3e-3, -2e-3 * t, 1e-3)),
    )
    found = first_contact(motion, CUBE_B, FLOOR, UP, horizon=2.0)
    assert found is not None
    p, R, _, _ = stepped(
        BODY.mass,
        BODY.I_B,
        (state.p_WB_W, state.R_WB, state.v_WB_W, state.w_WB_W),
        lambda t, _p, _R, v, _w: (BODY.mass * DOWN_W + wind(t, v), np.array([3e-3, -2e-3 * t, 1e-3])),
        duration=found.seconds,
        steps=1000,
    )
    lowest = p + R @ CUBE_B[found.vertices[0]]
    assert (p + CUBE_B @ R.T)[:, 2].argmin() == found.vertices[0]
    assert lowest[2] == pytest.approx(0.0, abs=1e-9)  # Runge-Kutta's error at 0.5 ms and 20 rad/s
    assert found.p_WC_W == pytest.approx(lowest, abs=1e-9)


def test_bounds_hold_along_their_steps() -> None:
    """Accelerations of a point by differences of its sampled velocity, beside the bound of each step."""
    motion = forced_motion(
        BODY,
        start(1.0, v=(3.0, 0.0, 2.0), w=(20.0, 3.0, -5.0)),
        gravity_W=DOWN_W,
        wrench=ConstantWrench(torque=(0.02, 0.01, 0.0), axes=WrenchAxes.BODY),
        drag=Drag(quadratic=0.1, quadratic_angular=1e-6),
    )
    normal = np.array([0.6, 0.0, 0.8])
    bound_from = bounds_of(motion, normal)
    now, tightest = 0.0, 0.0
    while now < 0.1:
        bound = bound_from(now)
        times = np.linspace(now, bound.until, 12)[1:-1]
        h = 1e-3 * (bound.until - now)
        for corner in CUBE_B:
            pulls = []
            for t in times.tolist():
                rates = [
                    float(normal @ s.velocity_of_point(s.p_WB_W + s.R_WB @ corner))
                    for s in (motion.state_at(t - h), motion.state_at(t + h))
                ]
                pulls.append((rates[0] - rates[1]) / (2.0 * h))
            allowed = bound.fall + bound.turning * float(np.linalg.norm(corner))
            assert max(pulls) < allowed * (1.0 + 1e-6)
            tightest = max(tightest, max(pulls) / allowed)
        now = bound.until
    assert tightest > 0.3  # of use: not larger than it need be by much


def test_a_motion_that_grows_without_bounds_is_refused_only_where_the_search_gets_there() -> None:
    def driven(v: float) -> ForcedMotion:
        return forced_motion(
            BODY,
            start(0.2, v=(0.0, 0.0, v)),
            gravity_W=DOWN_W,
            wrench_of=lambda _, now: ((0.0, 0.0, now.v_WB_W[2] ** 2), (0.0, 0.0, 0.0)),
        )

    assert first_contact(driven(0.0), CUBE_B, FLOOR, UP, horizon=100.0) is not None
    with pytest.raises(InvalidFieldError, match="seconds"):
        first_contact(driven(50.0), CUBE_B, FLOOR, UP, horizon=1.0)


def test_falling_against_linear_drag() -> None:
    """Height z_0 - v_e (t - tau (1 - exp(-t / tau))) with tau = m / c and v_e = g tau."""
    drag = Drag(linear=0.8)
    tau = BODY.mass / drag.linear
    motion = forced_motion(BODY, start(3.05), gravity_W=DOWN_W, drag=drag)
    found = first_contact(motion, CUBE_B, FLOOR, UP, horizon=5.0)
    expected = brentq(
        lambda t: 3.0 - 9.81 * tau * (t + tau * math.expm1(-t / tau)), 0.1, 5.0, xtol=1e-15, rtol=1e-14
    )
    assert found is not None
    assert found.seconds == pytest.approx(expected, rel=1e-12)
    assert found.v_WC_W[2] == pytest.approx(9.81 * tau * math.expm1(-expected / tau), rel=1e-12)
    assert sorted(found.vertices) == [0, 2, 4, 6]


def test_a_motion_from_another_state_is_an_error() -> None:
    """It would land, and not the body in the stated state."""
    floor = Surface(name="floor", p_WS_W=np.zeros(3), normal_W=np.array(UP), friction=0.5, restitution=0.5)
    cube = Body(name="cube", mass_properties=BODY, vertices_B=CUBE_B)
    motion = forced_motion(BODY, start(0.6), drag=Drag(linear=0.3))
    with pytest.raises(InvalidFieldError, match="motion must be one that begins in the given state"):
        next_landing(cube, start(0.7), World(surfaces=(floor,)), motion=motion)
