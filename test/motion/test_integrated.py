# SPDX-License-Identifier: Apache-2.0
"""Bodies under forces: known answers, balances of momentum and energy, brute force, and the closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.motion.forces import ConstantWrench, Drag, WrenchAxes
from contact_dynamics.motion.integrated import ForcedMotion, Method, forced_motion, motion_of
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.tumbling import FreeMotion, Sample, free_motion
from oracles.forced_stepped import stepped

G = 10.0
DOWN = (0.0, 0.0, -G)
TURN = Rotation.from_euler("xyz", [0.3, -1.1, 2.0])
BODY = MassProperties(mass=1.3, I_B=[[1.1, 0.1, -0.05], [0.1, 1.5, 0.2], [-0.05, 0.2, 1.9]])
SPHERE = MassProperties(mass=2.0, I_B=0.4 * np.eye(3))


def state(v: object = (1.0, -0.5, 2.0), w: object = (0.9, -1.4, 0.6), turn: Rotation = TURN) -> BodyState:
    return BodyState(p_WB_W=[0.1, 0.2, 1.5], q_WB=turn.as_quat(), v_WB_W=v, w_WB_W=w, stamp_ns=7_000_000_000)


def angle_between(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """The angles, rad, between attitudes."""
    return (Rotation.from_quat(one) * Rotation.from_quat(other).inv()).magnitude()


# At zero torque


@pytest.mark.parametrize(
    ("moments", "w_B", "stated"),
    [
        ((1.0, 1.4, 1.9), (0.6, -0.5, 1.2), 1e-10),
        pytest.param((1.0, 1.0, 1.6), (0.3, -0.5, 1.2), 1e-10, marks=pytest.mark.slow),
        pytest.param((0.7, 0.7, 0.7), (0.3, -0.5, 1.2), 1e-10, marks=pytest.mark.slow),
        ((0.05, 1.0, 1.02), (3.0, 0.5, 0.4), 1e-9),
    ],
)
def test_without_torque_it_is_the_closed_form(
    moments: tuple[float, ...], w_B: tuple[float, ...], stated: float
) -> None:
    """Over 100 revolutions within twice what is stated: 3e-14 a step, added up quadratically."""
    body = MassProperties(mass=1.0, I_B=np.diag(moments))
    start = state(w=TURN.apply(w_B))
    times = np.linspace(0.0, 200.0 * math.pi / float(np.linalg.norm(w_B)), 51)
    found, exact = forced_motion(body, start).at(times), free_motion(body, start).at(times)
    assert angle_between(found.q_WB, exact.q_WB).max() < stated
    np.testing.assert_allclose(found.w_WB_W, exact.w_WB_W, rtol=0.0, atol=5.0 * stated)
    np.testing.assert_array_equal(found.p_WB_W, exact.p_WB_W)
    np.testing.assert_array_equal(found.v_WB_W, exact.v_WB_W)
    np.testing.assert_allclose(np.linalg.norm(found.q_WB, axis=1), 1.0, rtol=0.0, atol=1e-15)


def test_both_directions_and_any_order() -> None:
    times = np.array([0.0, 3.0, -2.0, 0.5, -0.1, 3.0])
    found, exact = forced_motion(BODY, state()).at(times), free_motion(BODY, state()).at(times)
    np.testing.assert_allclose(found.q_WB, exact.q_WB, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(found.w_WB_W, exact.w_WB_W, rtol=0.0, atol=1e-12)
    np.testing.assert_array_equal(found.w_WB_W[1], found.w_WB_W[5])


# Known answers


@pytest.mark.parametrize("t", [0.3, 5.0, -0.3])
def test_spin_about_a_principal_axis_dies_down(t: float) -> None:
    """I w' = -l w, and I w' = -q w^2."""
    inertia, w, drag = 1.9, 4.0, 0.8
    body = MassProperties(mass=1.0, I_B=np.diag([1.0, 1.4, inertia]))
    axis = TURN.apply([0.0, 0.0, 1.0])
    fading = drag * t / inertia
    known = {
        Drag(linear_angular=drag): (math.exp(-fading), -math.expm1(-fading) * inertia / drag),
        Drag(quadratic_angular=drag): (1.0 / (1.0 + fading * w), math.log1p(fading * w) * inertia / drag / w),
    }
    for law, (rate, turned) in known.items():
        found = forced_motion(body, state(w=w * axis), drag=law).state_at(t)
        np.testing.assert_allclose(found.w_WB_W, w * rate * axis, rtol=0.0, atol=1e-11)
        attitude = Rotation.from_rotvec(w * turned * axis) * TURN
        assert angle_between(found.q_WB, attitude.as_quat()) < 1e-11


@pytest.mark.parametrize("t", [0.2, 2.0, 20.0])
def test_fall_with_drag(t: float) -> None:
    m, drag = SPHERE.mass, 0.6
    start = state(v=(0.0, 0.0, 0.0))
    rate, terminal = drag / m, math.sqrt(m * G / drag)
    known = {
        Drag(linear=drag): (
            -G / rate * -math.expm1(-rate * t),
            -G / rate * (t + math.expm1(-rate * t) / rate),
        ),
        Drag(quadratic=drag): (
            -terminal * math.tanh(G * t / terminal),
            -(terminal**2) / G * math.log(math.cosh(G * t / terminal)),
        ),
    }
    for law, (v, p) in known.items():
        found = forced_motion(SPHERE, start, drag=law, gravity_W=DOWN).state_at(t)
        assert found.v_WB_W[2] == pytest.approx(v, rel=1e-12)
        assert found.p_WB_W[2] - 1.5 == pytest.approx(p, rel=1e-12)
        np.testing.assert_array_equal(found.v_WB_W[:2], 0.0)


# Laws


def spring(t: float, sample: Sample) -> tuple[list[float], list[float]]:
    """A force to the origin that swells with time, and a torque that turns the body's x axis upwards."""
    x, y, z, w = sample.q_WB
    axis = (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z))
    return [-(1.0 + t) * 0.3 * p for p in sample.p_WB_W], [-axis[1], axis[0], 0.1 * t]


WRENCHES = {
    "world": {"wrench": ConstantWrench(force=[0.4, -0.2, 0.1], torque=[0.3, 0.5, -0.4])},
    "body": {"wrench": ConstantWrench(force=[0.4, -0.2, 0.1], torque=[0.3, 0.5, -0.4], axes=WrenchAxes.BODY)},
    "drag": {"drag": Drag(linear=0.2, quadratic=0.1, linear_angular=0.3, quadratic_angular=0.15)},
    "function": {"wrench_of": spring},
    "all": {
        "wrench": ConstantWrench(force=[0.4, -0.2, 0.1], torque=[0.3, 0.5, -0.4]),
        "drag": Drag(quadratic=0.1, linear_angular=0.3),
        "wrench_of": spring,
    },
}


def wrench_at(name: str, t: float, p: object, turn: np.ndarray, rates: tuple) -> tuple:
    """The same wrenches once more, gravity aside."""
    force, torque, (v, w) = np.zeros(3), np.zeros(3), rates
    parts = WRENCHES[name]
    constant = np.array([0.4, -0.2, 0.1]), np.array([0.3, 0.5, -0.4])
    if "wrench" in parts:
        onto_W = turn if name == "body" else np.eye(3)
        force, torque = force + onto_W @ constant[0], torque + onto_W @ constant[1]
    if "drag" in parts:
        along, along2, about, about2 = (0.2, 0.1, 0.3, 0.15) if name == "drag" else (0.0, 0.1, 0.3, 0.0)
        force = force - (along + along2 * np.linalg.norm(v)) * v
        torque = torque - (about + about2 * np.linalg.norm(w)) * w
    if "wrench_of" in parts:
        force = force - (1.0 + t) * 0.3 * np.asarray(p)
        torque = torque + np.cross([0.0, 0.0, 1.0], turn[:, 0]) * [1.0, 1.0, 0.0] + [0.0, 0.0, 0.1 * t]
    return force, torque


@pytest.mark.parametrize("name", sorted(WRENCHES))
def test_brute_force_agrees(name: str) -> None:
    def wrench(t: float, p: object, R: np.ndarray, v: np.ndarray, w: np.ndarray) -> tuple:
        force, torque = wrench_at(name, t, p, R, (v, w))
        return force + BODY.mass * np.array(DOWN), torque

    start = state()
    p, R, v, w = stepped(
        BODY.mass,
        BODY.I_B,
        (start.p_WB_W, start.R_WB, start.v_WB_W, start.w_WB_W),
        wrench,
        duration=2.0,
        steps=1000,
    )
    found = forced_motion(BODY, start, gravity_W=DOWN, **WRENCHES[name]).state_at(2.0)
    # Runge and Kutta's steps of 2 ms at rates of some 2 rad/s: (4e-3)^4 is 3e-10, over 120
    np.testing.assert_allclose(found.p_WB_W, p, rtol=0.0, atol=2e-11)
    np.testing.assert_allclose(found.v_WB_W, v, rtol=0.0, atol=2e-11)
    np.testing.assert_allclose(found.R_WB, R, rtol=0.0, atol=2e-11)
    np.testing.assert_allclose(found.w_WB_W, w, rtol=0.0, atol=2e-11)


vectors = st.tuples(*[st.floats(-3.0, 3.0)] * 3)


@settings(max_examples=15)
@given(v=vectors, w=vectors, force=vectors, torque=vectors, t=st.floats(-0.5, 1.0))
def test_what_follows_follows_from_any_state_on_the_way(
    *, v: tuple, w: tuple, force: tuple, torque: tuple, t: float
) -> None:
    forces = {
        "wrench": ConstantWrench(force=force, torque=torque, axes=WrenchAxes.BODY),
        "drag": Drag(linear=0.3, quadratic_angular=0.1),
    }
    whole = forced_motion(BODY, state(v=v, w=w), **forces)
    halfway = whole.state_at(t)
    one, other = whole.state_at(t + 0.7), forced_motion(BODY, halfway, **forces).state_at(0.7)
    np.testing.assert_allclose(one.p_WB_W, other.p_WB_W, rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(one.R_WB, other.R_WB, rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(one.w_WB_W, other.w_WB_W, rtol=0.0, atol=1e-11)


def test_at_is_state_at_and_signs_are_continuous() -> None:
    motion = forced_motion(BODY, state(), **WRENCHES["all"])
    times = np.linspace(-1.0, 4.0, 101)
    rows = motion.at(times)
    assert len(rows) == 101
    assert (np.einsum("ij,ij->i", rows.q_WB[1:], rows.q_WB[:-1]) > 0.9).all()
    for i in (0, 20, 21, 100):
        one = motion.state_at(times[i])
        np.testing.assert_allclose(rows.p_WB_W[i], one.p_WB_W, rtol=0.0, atol=1e-14)
        np.testing.assert_allclose(abs(rows.q_WB[i] @ one.q_WB), 1.0, rtol=0.0, atol=1e-15)
        np.testing.assert_allclose(rows.v_WB_W[i], one.v_WB_W, rtol=0.0, atol=1e-14)
        np.testing.assert_allclose(rows.w_WB_W[i], one.w_WB_W, rtol=0.0, atol=1e-14)
    assert len(motion.at([])) == 0
    assert motion.at([]).q_WB.shape == (0, 4)


# Which method


def test_closed_form_where_nothing_turns_the_body() -> None:
    pushed = ConstantWrench(force=[0.13, 0.0, 0.26])
    motion, method = motion_of(BODY, state(), gravity_W=DOWN, wrench=pushed)
    assert method is Method.CLOSED_FORM
    assert isinstance(motion, FreeMotion)
    stepped_there = forced_motion(BODY, state(), gravity_W=DOWN, wrench=pushed).state_at(2.0)
    np.testing.assert_allclose(motion.state_at(2.0).p_WB_W, stepped_there.p_WB_W, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize(
    "forces", [*WRENCHES.values(), {"wrench": ConstantWrench(force=[1.0, 0.0, 0.0], axes=WrenchAxes.BODY)}]
)
def test_integrated_where_something_does(forces: dict) -> None:
    motion, method = motion_of(BODY, state(), **forces)
    assert method is Method.INTEGRATED
    assert isinstance(motion, ForcedMotion)


def test_forces_alone_leave_the_rotation_free() -> None:
    through_the_centre = ConstantWrench(force=[1.0, 2.0, 3.0], axes=WrenchAxes.BODY)
    motion = forced_motion(BODY, state(), wrench=through_the_centre, drag=Drag(linear=0.3, quadratic=0.1))
    assert motion.rotates_freely
    times = [-1.0, 3.0]
    found, free = motion.at(times), free_motion(BODY, state()).at(times)
    np.testing.assert_allclose(found.q_WB, free.q_WB, rtol=0.0, atol=1e-12)
    for forces in (
        {"wrench": ConstantWrench(torque=[0.0, 1e-9, 0.0])},
        {"drag": Drag(linear_angular=1e-9)},
        {"drag": Drag(quadratic_angular=1e-9)},
        {"wrench_of": lambda _, __: ([0.0] * 3, [0.0] * 3)},
    ):
        assert not forced_motion(BODY, state(), **forces).rotates_freely


# Misuse


@pytest.mark.parametrize(
    "answer", [None, ([0.0] * 3,), ([0.0] * 3, [0.0] * 2), ([0.0] * 3, [0.0, 0.0, math.nan])]
)
def test_a_function_that_returns_nonsense_is_refused(answer: object) -> None:
    with pytest.raises(InvalidFieldError, match="wrench_of"):
        forced_motion(BODY, state(), wrench_of=lambda _t, _sample: answer)


def test_nonsense_later_on_is_refused_too() -> None:
    motion = forced_motion(
        BODY, state(), wrench_of=lambda t, _: ([0.0] * 3, [0.0, 0.0, 1.0 if t < 1.0 else math.inf])
    )
    assert math.isfinite(motion.state_at(0.5).w_WB_W[2])
    with pytest.raises(InvalidFieldError, match="wrench_of: torque"):
        motion.state_at(2.0)


def test_a_past_that_grows_without_bounds_is_refused_where_it_does() -> None:
    """The speed under v' = -q/m v |v| backwards from v0 is infinite at t = -m / (q v0)."""
    motion = forced_motion(SPHERE, state(v=(4.0, 0.0, 0.0)), drag=Drag(quadratic=1.0), gravity_W=np.zeros(3))
    assert motion.state_at(-0.49).v_WB_W[0] == pytest.approx(4.0 / (1.0 - 0.98), rel=1e-9)
    with pytest.raises(InvalidFieldError, match=r"seconds must be .* -0\.5 s, got -1 s"):
        motion.at([0.0, -1.0])


def test_endless_work_is_refused() -> None:
    with pytest.raises(InvalidFieldError, match="10 steps"):
        forced_motion(BODY, state(), max_steps=10).state_at(1e9)


def test_importing_it_does_not_import_scipy() -> None:
    import subprocess
    import sys

    code = "import sys, contact_dynamics.motion.integrated; sys.exit('scipy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_wrenches_are_copies_that_nobody_changes() -> None:
    force = np.array([1.0, 2.0, 3.0])
    wrench = ConstantWrench(force=force)
    force[0] = 9.0
    assert wrench.force[0] == 1.0
    with pytest.raises(ValueError, match="read-only"):
        wrench.force[0] = 9.0
