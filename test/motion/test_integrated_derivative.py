# SPDX-License-Identifier: Apache-2.0
"""The derivative of forced motions: beside differences of brute force, the closed form, known solutions."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics import BodyState, MassProperties, free_motion
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.motion import ConstantWrench, Drag, WrenchAxes
from contact_dynamics.motion.free_derivative import state_derivatives
from contact_dynamics.motion.integrated import forced_motion
from contact_dynamics.motion.integrated_derivative import forced_state_derivatives
from oracles.forced_stepped import stepped

I_B = [[1.1, 0.1, -0.05], [0.1, 1.5, 0.2], [-0.05, 0.2, 1.9]]
BODY = MassProperties(mass=1.3, I_B=I_B)
SPHERE = MassProperties(mass=2.0, I_B=0.4 * np.eye(3))
TURN = Rotation.from_euler("xyz", [0.3, -1.1, 2.0])
GRAVITY = np.array([0.0, 0.0, -9.80665])


def state(v: object = (1.0, -0.5, 2.0), w: object = (0.9, -1.4, 0.6)) -> BodyState:
    return BodyState(p_WB_W=[0.1, 0.2, 1.5], q_WB=TURN.as_quat(), v_WB_W=v, w_WB_W=w)


def spring(_: float, sample: object) -> tuple[list[float], list[float]]:
    """A force towards the origin, and a torque that rights the body's x axis: both of the state."""
    x, y, z, w = sample.q_WB
    along = (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z))
    return [-3.0 * x for x in sample.p_WB_W], [0.7 * along[1], -0.7 * along[0], 0.0]


FORCES = {
    "world wrench": {"wrench": ConstantWrench(force=[1.0, 2.0, 3.0], torque=[0.2, -0.1, 0.3])},
    "body wrench": {
        "wrench": ConstantWrench(force=[1.0, 2.0, 3.0], torque=[0.2, -0.1, 0.3], axes=WrenchAxes.BODY)
    },
    "linear drag": {"drag": Drag(linear=0.6, linear_angular=0.4)},
    "quadratic drag": {"drag": Drag(quadratic=0.2, quadratic_angular=0.3)},
    "a function": {"wrench_of": spring},
    "all": {
        "wrench": ConstantWrench(torque=[0.2, -0.1, 0.3], axes=WrenchAxes.BODY),
        "drag": Drag(linear=0.1, quadratic=0.2, linear_angular=0.1, quadratic_angular=0.3),
        "wrench_of": spring,
    },
}


def brute_force(forces: dict, start: BodyState, change: np.ndarray, t: float) -> tuple[np.ndarray, ...]:
    """Position, attitude and velocities at a time, from a state changed, by the oracle's own integrator."""
    wrench, drag = forces.get("wrench", ConstantWrench()), forces.get("drag", Drag())

    def acting(_: float, p: np.ndarray, R: np.ndarray, v: np.ndarray, w: np.ndarray) -> tuple:
        onto = R if wrench.axes is WrenchAxes.BODY else np.eye(3)
        force = onto @ wrench.force + BODY.mass * GRAVITY
        torque = onto @ wrench.torque
        force = force - (drag.linear + drag.quadratic * np.linalg.norm(v)) * v
        torque = torque - (drag.linear_angular + drag.quadratic_angular * np.linalg.norm(w)) * w
        if "wrench_of" in forces:
            force, torque = force - 3.0 * p, torque + np.cross(R[:, 0], [0.0, 0.0, 0.7])
        return force, torque

    R = (Rotation.from_rotvec(change[3:6]) * TURN).as_matrix()
    begin = (start.p_WB_W + change[:3], R, start.v_WB_W + change[6:9], start.w_WB_W + change[9:])
    return stepped(BODY.mass, I_B, begin, acting, duration=t, steps=120)


@pytest.mark.parametrize(
    ("name", "t"),
    [
        *(pytest.param(name, 1.5, marks=() if name == "a function" else pytest.mark.slow) for name in FORCES),
        ("all", -0.6),
    ],
)
def test_differences_of_brute_force_agree(name: str, t: float) -> None:
    """Central differences of 1e-4 err by 1e-8 of the third derivative, 120 steps of the oracle by 1e-8."""
    found = forced_state_derivatives(
        forced_motion(BODY, state(), gravity_W=GRAVITY, **FORCES[name]), [0.4 * t, t]
    )[1]
    step = 1e-4
    expected = np.empty((12, 12))
    for column, change in enumerate(step * np.eye(12)):
        (p1, R1, v1, w1), (p0, R0, v0, w0) = (
            brute_force(FORCES[name], state(), sign * change, t) for sign in (1.0, -1.0)
        )
        turn = Rotation.from_matrix(R1 @ R0.T).as_rotvec()
        expected[:, column] = np.concatenate([p1 - p0, turn, v1 - v0, w1 - w0]) / (2.0 * step)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-7 * np.abs(expected).max())


@pytest.mark.parametrize("w", [(0.9, -1.4, 0.6), (1e-3, 1.2, 1e-4), (0.0, 0.0, 0.0)])
def test_without_torque_it_is_that_of_the_closed_form(w: tuple[float, float, float]) -> None:
    times = np.array([0.0, 1e-3, 0.7, -2.0, 12.0])
    start = state(w=TURN.apply(w))
    found = forced_state_derivatives(forced_motion(BODY, start), times)
    exact = state_derivatives(free_motion(BODY, start), times)
    # the motion itself is integrated to 1e-12, and near the middle axis neighbours part by some hundreds
    scale = np.abs(exact).max(axis=(1, 2))
    assert (np.abs(found - exact).max(axis=(1, 2)) < 1e-11 * scale**2).all()


def test_linear_drag_on_a_sphere() -> None:
    """A change of v fades as exp(-k t), after a way of (1 - exp(-k t)) / k. The same holds for spin."""
    motion = forced_motion(
        SPHERE, state(w=(0.0, 0.0, 0.0)), drag=Drag(linear=1.0, linear_angular=0.8), gravity_W=np.zeros(3)
    )
    for t in (0.4, 30.0, -0.4):
        found = forced_state_derivatives(motion, [t])[0]
        expected = np.eye(12)
        for place, k in ((0, 0.5), (3, 2.0)):
            expected[place : place + 3, place + 6 : place + 9] *= 0.0
            for i in range(place, place + 3):
                expected[i, i + 6] = -math.expm1(-k * t) / k
                expected[i + 6, i + 6] = math.exp(-k * t)
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())


def test_neighbours_that_fade_faster_than_the_motion_are_followed() -> None:
    """At rest the integrator takes long steps, while a neighbour's spin fades much faster."""
    rest = state(v=(0.0, 0.0, 0.0), w=(0.0, 0.0, 0.0))
    motion = forced_motion(SPHERE, rest, drag=Drag(linear_angular=40.0), gravity_W=np.zeros(3))
    found = forced_state_derivatives(motion, [0.03, 5.0])
    assert found[0, 11, 11] == pytest.approx(math.exp(-3.0), rel=1e-10)
    assert found[1, 5, 11] == pytest.approx(0.01, rel=1e-10)


def test_derivatives_of_two_stretches_multiply() -> None:
    motion = forced_motion(BODY, state(), **FORCES["all"])
    later = motion.from_state(motion.state_at(0.8))
    whole = forced_state_derivatives(motion, [2.0])[0]
    parts = forced_state_derivatives(later, [1.2])[0] @ forced_state_derivatives(motion, [0.8])[0]
    np.testing.assert_allclose(whole, parts, rtol=0.0, atol=1e-9 * np.abs(whole).max())  # of differences


def test_a_function_that_breaks_off_beside_the_motion_is_refused() -> None:
    """The function is defined at the wall itself, but not a little further."""
    motion = forced_motion(
        SPHERE,
        BodyState(p_WB_W=np.zeros(3), q_WB=[0, 0, 0, 1]),
        wrench_of=lambda _, s: ([math.nan if s.p_WB_W[0] > 0.0 else 0.0, 0.0, 0.0], [0.0] * 3),
        gravity_W=np.zeros(3),
    )
    with pytest.raises(InvalidFieldError, match=r"wrench_of must be .*, got a slope that is not finite"):
        forced_state_derivatives(motion, [1.0])
