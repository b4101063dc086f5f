# SPDX-License-Identifier: Apache-2.0
"""Velocities in the wrong axes are found from poses, and impacts, noise and jumps are not taken for them."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from contact_dynamics import BodyState
from contact_dynamics.questions.state_store import StateStore
from contact_dynamics.questions.twist_axes import TwistAxes
from contact_dynamics.rigid_body.published_frame import state_of_center_of_mass
from contact_dynamics.rotations.one import rotation_matrix

CENTER = np.array([0.02, 0.0, 0.01])
SPIN = np.array([0.0, 2.0, 0.0])
GRAVITY = np.array([0.0, 0.0, -9.8])
BOUNCE_S = 0.25


def published(t: float, *, in_world: bool, noise: NDArray[np.float64]) -> BodyState:
    """The state that such Odometry makes of a body that spins, and bounces four times a second."""
    since = t % BOUNCE_S
    v_WB_W = np.array([1.0, 0.5, 0.5 * 9.8 * BOUNCE_S]) + since * GRAVITY
    p_WB_W = np.array([t, 0.5 * t, since * 0.5 * 9.8 * (BOUNCE_S - since)])
    q_WB = np.array([0.0, np.sin(t), 0.0, np.cos(t)])
    R_WB = rotation_matrix(q_WB)
    v_WF_W, w_WF_W = v_WB_W - np.cross(SPIN, R_WB @ CENTER), SPIN
    if in_world:  # and is turned by who reads it
        v_WF_W, w_WF_W = R_WB @ v_WF_W, R_WB @ w_WF_W
    return state_of_center_of_mass(
        p_WF_W=p_WB_W - R_WB @ CENTER + noise,
        q_WF=q_WB,
        v_WF_W=v_WF_W,
        w_WF_W=w_WF_W,
        p_FB_F=CENTER,
        stamp_ns=1_000_000_000 + round(1e9 * t),
    )


def found(rate: float, *, in_world: bool, noise: float = 0.0, jump: float = 0.0) -> list[float | None]:
    """What is found in each of six looks, a second apart."""
    store, axes, rng = (
        StateStore(history=5.0, timeout=1.0),
        TwistAxes("brick", CENTER),
        np.random.default_rng(1),
    )
    results = []
    for second in range(6):
        for k in range(round(rate)):
            t = second + (k + 0.5) / rate
            moved = noise * rng.standard_normal(3) + jump * np.floor(t / 0.4)
            store.add("brick", published(t, in_world=in_world, noise=moved))
        results.append(axes.look(store))
    assert axes.look(store) is None, "nothing came"
    return results


@pytest.mark.parametrize("rate", [5.0, 30.0, 100.0, 1000.0])
def test_a_twist_in_world_axes_is_found_within_seconds(rate: float) -> None:
    results = found(rate, in_world=True, noise=1e-4)
    if rate > 5.0:  # where the body bounces between nearly all states
        assert all(speed is not None and 0.5 < speed < 5.0 for speed in results)


@pytest.mark.parametrize("rate", [5.0, 30.0, 100.0, pytest.param(1000.0, marks=pytest.mark.slow)])
@pytest.mark.parametrize(("noise", "jump"), [(0.0, 0.0), (1e-3, 0.0), (0.05, 0.0), (0.0, 0.5)])
def test_the_right_axes_are_never_called_wrong(rate: float, noise: float, jump: float) -> None:
    """Through impacts, beside noise of more than the way between two states, and where poses jump."""
    assert found(rate, in_world=False, noise=noise, jump=jump) == [None] * 6
