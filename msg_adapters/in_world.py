# SPDX-License-Identifier: Apache-2.0
"""Frames of states: a message must be in the expected frame, or in one that stands still in the world."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.errors import FrameMismatchError
from contact_dynamics.questions.uncertain_state import KnownState, UncertainState
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rotations.one import rotation_matrix
from msg_adapters.transforms import FramePose

if TYPE_CHECKING:
    from msg_adapters.state_adapter import SourceSettings


def check_frame(field: str, found: str, expected: str) -> None:
    """Raise `FrameMismatchError` if a message's frame is not the expected one."""
    if found != expected:
        message = f"{field} must be {expected!r}, got {found!r}"
        raise FrameMismatchError(message)


def in_world(known: KnownState, frame: str, settings: SourceSettings) -> KnownState:
    """Return a state that is given in a frame, the header's, as one in the world frame.

    Raises:
        FrameMismatchError: it is not the world frame, and no static transform leads from it to the world.
    """
    if frame == settings.world_frame:
        return known
    pose = settings.static.pose(
        frame, in_frame=settings.world_frame, stamp_ns=known.stamp_ns, field="header.frame_id"
    )
    R = rotation_matrix(pose.q)
    state = known if isinstance(known, BodyState) else known.state
    there = pose.of(FramePose(p=state.p_WB_W, q=state.q_WB))
    moved = BodyState(
        p_WB_W=there.p,
        q_WB=there.q,
        v_WB_W=R @ state.v_WB_W,
        w_WB_W=R @ state.w_WB_W,
        stamp_ns=state.stamp_ns,
    )
    if isinstance(known, BodyState):
        return moved
    turn = np.kron(np.eye(4), R)
    return UncertainState(state=moved, covariance=turn @ known.covariance @ turn.T)
