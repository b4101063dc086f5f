# SPDX-License-Identifier: Apache-2.0
"""A motion, and the same begun later: state(t1 + t2) is state(t2) from state(t1), also for t2 = -t1."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from contact_dynamics.rigid_body.body import BodyState, MassProperties, angular_momentum
from contact_dynamics.tumbling import FreeMotion, Precision, free_motion
from oracles.tumbling_draws import draw
from tumbling.known_motions import MOTIONS, motion_of

ROUNDING = 1.5e-15
"""Rounding of a state passed on in doubles: relative to abs(w) for angular velocity, rad for attitude."""

HOPELESS = 1e9
"""Conditioning above which the passing on in doubles says nothing about the motion."""


def begun_later(motion: FreeMotion, seconds: float) -> FreeMotion:
    return free_motion(motion.body, motion.state_at(seconds))


def angle(q: np.ndarray, p: np.ndarray) -> float:
    return float((Rotation.from_quat(q).inv() * Rotation.from_quat(p)).magnitude())


def conditioning(motion: FreeMotion, seconds: float) -> float:
    """Return how much an attitude at a time moves with the state, rad per rad or relative error, tried."""
    state = motion.state
    size, step = float(np.linalg.norm(state.w_WB_W)), 1e-13
    attitude = motion.state_at(seconds).q_WB
    worst = 0.0
    for axis in np.vstack([np.eye(3), -np.eye(3)]):
        turned = (Rotation.from_rotvec(step * axis) * Rotation.from_quat(state.q_WB)).as_quat()
        for q_WB, w_WB_W in ((state.q_WB, state.w_WB_W + step * size * axis), (turned, state.w_WB_W)):
            other = BodyState(p_WB_W=state.p_WB_W, q_WB=q_WB, v_WB_W=state.v_WB_W, w_WB_W=w_WB_W)
            worst = max(worst, angle(attitude, free_motion(motion.body, other).state_at(seconds).q_WB))
    return worst / step


def error_and_conditioning(motion: FreeMotion, first: float, second: float) -> tuple[float, float]:
    later = begun_later(motion, first)
    whole, parts = motion.state_at(first + second), later.state_at(second)
    return angle(whole.q_WB, parts.q_WB), conditioning(later, second)


@pytest.mark.parametrize("name", MOTIONS)
def test_known_motions_compose_and_reverse(name: str) -> None:
    motion = motion_of(name)
    for first, second in ((1.5, 2.25), (3.0, -3.0), (-4.0, 1.0), (64.0, 0.5)):
        error, condition = error_and_conditioning(motion, first, second)
        assert error <= 5e-15 + ROUNDING * condition


@given(
    seed=st.integers(0, 2**32 - 1),
    first=st.floats(-50.0, 50.0),
    second=st.one_of(st.none(), st.floats(-50.0, 50.0)),
)
def test_drawn_motions_compose_and_reverse(seed: int, first: float, second: float | None) -> None:
    """Times are in rad turned. Without a second time, the motion goes back to the beginning."""
    drawn = draw(np.random.default_rng(seed))
    rate = float(np.linalg.norm(drawn.w_WB_W))
    state = BodyState(p_WB_W=np.zeros(3), q_WB=drawn.q_WB, w_WB_W=drawn.w_WB_W)
    motion = free_motion(MassProperties(mass=1.0, I_B=drawn.I_B), state)
    out = _on_the_binary_grid(first / rate)
    back = -out if second is None else _on_the_binary_grid(second / rate)
    error, condition = error_and_conditioning(motion, out, back)
    assume(condition < HOPELESS)
    assert error <= 5e-15 + ROUNDING * condition


def _on_the_binary_grid(seconds: float) -> float:
    """Return a time near the given one with 26 bits, so that sums of two are exact."""
    mantissa, exponent = math.frexp(seconds)
    return math.ldexp(round(mantissa * 2**20), exponent - 20)


@pytest.mark.parametrize("name", MOTIONS)
def test_regime_has_its_name(name: str) -> None:
    assert motion_of(name).regime is MOTIONS[name][3]


@pytest.mark.parametrize("name", MOTIONS)
def test_one_time_and_many_agree(name: str) -> None:
    motion = motion_of(name)
    times = np.concatenate([np.linspace(-50.0, 50.0, 101), [1e6, -1e9]])
    trajectory = motion.at(times)
    largest_rate = _largest_rate(motion)
    for i, t in enumerate(times.tolist()):
        one = motion.sample(t)
        sign = np.sign(trajectory.q_WB[i] @ one.q_WB)
        assert trajectory.q_WB[i] == pytest.approx(sign * np.array(one.q_WB), abs=2e-15)
        assert trajectory.w_WB_W[i] == pytest.approx(one.w_WB_W, abs=1e-15 * largest_rate)
        assert trajectory.p_WB_W[i] == pytest.approx(one.p_WB_W, rel=1e-15)
        assert trajectory.v_WB_W[i] == pytest.approx(one.v_WB_W, rel=1e-15)


def _largest_rate(motion: FreeMotion) -> float:
    """Return |L| / I_min, by which an attitude's rounding appears in w = I^-1 L."""
    moments = np.linalg.eigvalsh(motion.body.I_B)
    return float(np.linalg.norm(angular_momentum(motion.body, motion.state)) / moments[0])


def test_centre_of_mass_flies_a_parabola() -> None:
    state = motion_of("sphere").state
    motion = free_motion(motion_of("sphere").body, state, gravity_W=(0.0, 1.0, -2.0))
    later = motion.state_at(3.0)
    assert later.p_WB_W.tolist() == [0.1 + 3.0, 0.2 - 1.5 + 4.5, 1.5 + 6.0 - 9.0]
    assert later.v_WB_W.tolist() == [1.0, -0.5 + 3.0, 2.0 - 6.0]
    assert later.stamp_ns == state.stamp_ns + 3_000_000_000


def test_quaternions_are_continuous_along_the_list_in_any_order() -> None:
    motion = motion_of("about the major axis")
    times = np.linspace(-40.0, 40.0, 4001)
    for order in (times, times[::-1]):
        q_WB = motion.at(order).q_WB
        assert (np.einsum("ij,ij->i", q_WB[1:], q_WB[:-1]) > 0.99).all()  # 0.02 s at 1.3 rad/s


def test_a_state_seen_before_is_answered_alike_and_no_other_is_taken_for_it() -> None:
    body = MassProperties(mass=1.0, I_B=np.diag([1.0, 1.4, 1.9]))

    def asked(w: float, **options: object) -> tuple[float, ...]:
        state = BodyState(p_WB_W=np.zeros(3), q_WB=(0, 0, 0, 1), w_WB_W=(0.3, 0.5, w))
        return free_motion(body, state, **options).sample(7.0)

    first = asked(1.2)
    assert asked(1.2) == first
    assert asked(math.nextafter(1.2, 2.0)).q_WB != first.q_WB
    assert asked(1.2, gravity_W=(0.0, 0.0, 0.0)).p_WB_W != first.p_WB_W
    assert asked(1.2, precision=Precision.DOUBLE).q_WB == pytest.approx(first.q_WB, abs=1e-14)
    assert asked(1.2) == first
