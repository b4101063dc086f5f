# SPDX-License-Identifier: Apache-2.0
"""The definition of a source of published states: its messages, and their conversion to states.

Each source has a file here with its adapter. Other packages provide an adapter as an object of this kind, by
an entry point of the group `contact_dynamics.state_sources`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from contact_dynamics.questions.uncertain_state import KnownState, UncertainState
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rotations.one import rotation_matrix
from msg_adapters.transforms import FramePose, TransformTree

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray

Reader: TypeAlias = "Callable[[Any], KnownState | None]"
"""Converts a message to a state, or to None if another message must complete it."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SourceSettings:
    """What an adapter needs to know of a body and of the world.

    Attributes:
        body_name: The body's name.
        body_frame: The frame of the body, whose pose is published.
        world_frame: The frame that states are in.
        p_FB_F: (3,), m, the body's centre of mass in its frame.
        velocity_window: s, duration of the poses from which a velocity is estimated.
        static: The static transforms received so far.
    """

    body_name: str
    body_frame: str
    world_frame: str
    p_FB_F: FloatArray
    velocity_window: float
    static: TransformTree


def in_world(known: KnownState, frame: str, settings: SourceSettings) -> KnownState:
    """Return a state in the world frame, given in the header's frame.

    Raise `FrameMismatchError` if no static transform leads from that frame to the world.
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


class StateRows(NamedTuple):
    """The states of n messages."""

    stamps_ns: NDArray[np.int64]  # (n,), ns
    numbers: FloatArray  # (n, 13): position, quaternion, linear and angular velocity, as in `BodyState`
    # (n,), whether the row equals the result of the reader, which may also be a covariance or an error
    are_all: NDArray[np.bool_]


RowsReader: TypeAlias = "Callable[[SourceSettings, Any], StateRows | None]"
"""Converts the joined messages of `decode_columns` to states, or to None if they require a reader."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StateAdapter:
    """One kind of source.

    Attributes:
        type_names: The type of each topic that it takes, "package/msg/Name".
        readers: Returns a reader for each topic, in the same order. It is called once for each body.
        is_whole: Whether each message is a state by itself, whatever came before. It can then be read later,
            or never. Its first field is a header with the body's stamp.
        is_of_one_body: Whether each message is about one body, whatever that is called. Then no two bodies
            can have their states by the same topic.
        rows: Function that makes the states of many messages at once, which are whole and of one body.
    """

    type_names: tuple[str, ...]
    readers: Callable[[SourceSettings], Sequence[Reader]]
    is_whole: bool = False
    is_of_one_body: bool = False
    rows: RowsReader | None = None
