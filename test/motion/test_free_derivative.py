# SPDX-License-Identifier: Apache-2.0
"""The derivative of free motions: beside differences of the closed form, composed, and by its symmetries."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics.motion.free_derivative import state_derivatives
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.tumbling import FreeMotion, free_motion
from oracles.tumbling_draws import draw
from tumbling.known_motions import MOTIONS, motion_of

BOUNDED = sorted(set(MOTIONS) - {"about the middle axis", "separatrix", "its other branch"})
TIMES = np.array([0.0, 1e-4, 0.3, 2.0, 11.0, -7.0])


def moved(motion: FreeMotion, change: np.ndarray) -> FreeMotion:
    """The motion from a state changed by position, rotation vector, velocity, angular velocity."""
    state = motion.state
    other = BodyState(
        p_WB_W=state.p_WB_W + change[:3],
        q_WB=(Rotation.from_rotvec(change[3:6]) * Rotation.from_quat(state.q_WB)).as_quat(),
        v_WB_W=state.v_WB_W + change[6:9],
        w_WB_W=state.w_WB_W + change[9:],
    )
    return free_motion(motion.body, other, gravity_W=motion.gravity_W)


def difference(motion: FreeMotion, change: np.ndarray, times: np.ndarray) -> np.ndarray:
    """What a change of the initial state changes later, (n, 12)."""
    one, other = motion.at(times), moved(motion, change).at(times)
    turn = (Rotation.from_quat(other.q_WB) * Rotation.from_quat(one.q_WB).inv()).as_rotvec()
    return np.hstack([other.p_WB_W - one.p_WB_W, turn, other.v_WB_W - one.v_WB_W, other.w_WB_W - one.w_WB_W])


def by_differences(motion: FreeMotion, times: np.ndarray, step: float) -> np.ndarray:
    """Central differences of fourth order."""
    columns = []
    for axis in step * np.eye(12):
        near = difference(motion, axis, times) - difference(motion, -axis, times)
        far = difference(motion, 2.0 * axis, times) - difference(motion, -2.0 * axis, times)
        columns.append((8.0 * near - far) / (12.0 * step))
    return np.stack(columns, axis=-1)


def relative(found: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """The largest error in each matrix beside its largest entry."""
    return np.abs(found - expected).max(axis=(-2, -1)) / np.abs(expected).max(axis=(-2, -1))


@pytest.mark.parametrize("name", sorted(MOTIONS))
def test_differences_of_the_closed_form_agree(name: str) -> None:
    """Steps h leave 1e-15 / h of rounding, and h^4 times how curved the flow is: the better of two counts."""
    motion = motion_of(name)
    found = state_derivatives(motion, TIMES)
    errors = relative(found, by_differences(motion, TIMES, 1e-4))
    finer = relative(found, by_differences(motion, TIMES, 1e-5))
    # Thin rods amplify rounding by their slenderness; what grows exponentially is as curved as it has grown.
    growing = name not in BOUNDED
    assert np.minimum(errors, finer).max() < (5e-8 if growing else 1e-9 if name == "a rod" else 1e-10)
    slenderness = np.linalg.cond(motion.body.I_B)
    np.testing.assert_allclose(found[0], np.eye(12), rtol=0.0, atol=1e-14 + 1e-15 * slenderness)


@pytest.mark.parametrize("name", BOUNDED)
@pytest.mark.parametrize("t", [0.7, -30.0, 100.0])
def test_derivatives_of_two_stretches_multiply(name: str, t: float) -> None:
    motion = motion_of(name)
    halfway = free_motion(motion.body, motion.state_at(0.4 * t), gravity_W=motion.gravity_W)
    whole = state_derivatives(motion, [t])[0]
    parts = state_derivatives(halfway, [t - 0.4 * t])[0] @ state_derivatives(motion, [0.4 * t])[0]
    # The state halfway is rounded, and near the middle axis its last digit is felt.
    assert relative(whole, parts) < (
        1e-7 if name in {"a rod", "near the middle axis", "nearer to it"} else 1e-12
    )


@pytest.mark.parametrize("name", BOUNDED)
def test_symmetries_at_any_time(name: str) -> None:
    """Turning the world, starting later, and moving faster change the future in known ways."""
    motion = motion_of(name)
    times = np.array([-1e3, 0.5, 60.0, 1e5])
    J = state_derivatives(motion, times)
    then, w = motion.at(times), motion.state.w_WB_W
    turn = np.array([0.3, -0.4, 0.5])
    start = np.concatenate([np.zeros(3), turn, np.zeros(3), np.cross(turn, w)])
    expected = np.hstack([np.tile(turn, (4, 1)), np.cross(turn, then.w_WB_W)])
    scale = np.abs(J).max()
    rows = np.r_[3:6, 9:12]
    # A thousand turns and a thin rod multiply rounding by their number and its slenderness.
    tolerance = 1e-9 if name == "a rod" else 1e-11
    np.testing.assert_allclose((J @ start)[:, rows], expected, rtol=0.0, atol=tolerance * scale)
    faster = (J @ np.concatenate([np.zeros(9), w]))[:, rows]
    inertia = motion.body.I_B
    R = Rotation.from_quat(then.q_WB).as_matrix()
    w_B = np.einsum("nji,nj->ni", R, then.w_WB_W)
    spin_up = np.einsum("nij,nj->ni", R, -np.linalg.solve(inertia, np.cross(w_B, w_B @ inertia).T).T)
    expected = np.hstack([times[:, None] * then.w_WB_W, then.w_WB_W + times[:, None] * spin_up])
    np.testing.assert_allclose(faster, expected, rtol=0.0, atol=tolerance * scale)


def test_what_is_given_near_every_singular_end_is_right(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pieces of other lengths round otherwise: what they agree on is right, and the rest is NaN."""
    rng, count, finite = np.random.default_rng(7), 0, 0
    rows = np.r_[3:6, 9:12]
    for _ in range(60):
        drawn = draw(rng)
        if np.linalg.cond(drawn.I_B) > 1e3:
            continue  # thinner rods: less is claimed
        count += 1
        state = BodyState(p_WB_W=np.zeros(3), q_WB=drawn.q_WB, w_WB_W=drawn.w_WB_W)
        motion = free_motion(MassProperties(mass=1.0, I_B=drawn.I_B), state)
        speed = np.linalg.norm(drawn.w_WB_W)
        units = np.repeat([1.0, speed], [9, 3])  # angular velocities beside the body's own
        answers = []
        for piece in (0.5, 0.27):
            monkeypatch.setattr("contact_dynamics.motion.free_derivative.PIECE", piece)
            J = state_derivatives(motion, np.array([0.3, -2.0, 20.0, 500.0]) / speed)
            answers.append((J / units[:, None] * units)[:, rows[:, None], rows])
        given = np.isfinite(answers).all(axis=(0, 2, 3))
        finite += given.sum()
        assert (relative(answers[0][given], answers[1][given]) < 1e-2).all(), drawn
    assert count > 40
    assert finite > 0.8 * 4 * count


def test_the_cost_does_not_grow_with_time() -> None:
    """A year on: neighbours part as the time does, by the same rates."""
    motion = motion_of("about the major axis")
    far, farther = state_derivatives(motion, [1e6, 3e7])
    assert 20.0 < np.abs(farther).max() / np.abs(far).max() < 40.0


def test_slow_and_fast_meet() -> None:
    """Either side of the switch to the slow form."""
    body = MassProperties(mass=1.0, I_B=np.diag([1.0, 1.4, 1.9]))
    state = BodyState(p_WB_W=np.zeros(3), q_WB=[0, 0, 0, 1], w_WB_W=[0.003, -0.005, 0.008])
    motion = free_motion(body, state)
    speed = math.sqrt(0.003**2 + 0.005**2 + 0.008**2)
    t = np.array([0.5, 1.0]) * 0.99e-2 / speed
    slow = state_derivatives(motion, t)
    fast = state_derivatives(motion, [*t, 100.0 * t[1]])[:2]
    np.testing.assert_allclose(slow, fast, rtol=0.0, atol=1e-12)


def test_what_no_double_holds_is_nan() -> None:
    for name in ("about the middle axis", "separatrix"):
        J = state_derivatives(motion_of(name), [1.0, 1e5])
        assert np.isfinite(J[0]).all()
        assert np.isnan(J[1][3:6, 3:6]).all()
