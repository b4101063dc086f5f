# SPDX-License-Identifier: Apache-2.0
"""States as a tracker publishes them, and errors of states."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from contact_dynamics.motion import StateNoise
from contact_dynamics.rigid_body.body import BodyState


def turned(state: BodyState, turn: np.ndarray, **changes: Any) -> BodyState:
    """A state that is turned by a rotation vector in the world, and changed otherwise."""
    q = (Rotation.from_rotvec(turn) * Rotation.from_quat(state.q_WB)).as_quat()
    return replace(state, q_WB=q, **changes)


def published(state: BodyState, rng: np.random.Generator, noise: StateNoise) -> BodyState:
    """The state with draws of white noise, which of parts without stated noise is 0."""
    sizes = [noise.position, noise.orientation, noise.linear_velocity, noise.angular_velocity]
    p, turn, v, w = rng.normal(size=(4, 3)) * np.array([size or 0.0 for size in sizes])[:, None]
    return turned(state, turn, p_WB_W=state.p_WB_W + p, v_WB_W=state.v_WB_W + v, w_WB_W=state.w_WB_W + w)


def error(found: BodyState, true: BodyState) -> np.ndarray:
    """The error of a state, (12,), in the order of the covariance."""
    turn = (Rotation.from_quat(true.q_WB) * Rotation.from_quat(found.q_WB).inv()).as_rotvec()
    return np.concatenate(
        [true.p_WB_W - found.p_WB_W, turn, true.v_WB_W - found.v_WB_W, true.w_WB_W - found.w_WB_W]
    )
