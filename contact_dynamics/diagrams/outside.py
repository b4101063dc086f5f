# SPDX-License-Identifier: Apache-2.0
"""This file cuts a predicted flight where a surface is in the way.

Free flight is predicted whatever is in its way, so a body that rests on a floor falls through it. Pictures
show the flight as far as the body can go.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.rotations.many import matrices_of
from contact_dynamics.tumbling import Trajectory
from contact_dynamics.world import Surface

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.diagrams.shape import Shape
    from contact_dynamics.shapes.obstacle import Obstacle

DEEP: Final = 0.1
"""Relative to the body's size: how deep in a surface it is drawn. Measured poses are in it by their noise."""


def outside(
    trajectory: Trajectory, shape: Shape, surfaces: Sequence[Surface | Obstacle]
) -> tuple[Trajectory, str]:
    """Return the part of a trajectory until the body is deep in a flat, and its name, or "" for all of it."""
    corners_B = shape.edges_B.reshape(-1, 3)
    R_WB = matrices_of(trajectory.q_WB)
    count, name = len(trajectory), ""
    for surface in surfaces:
        if not isinstance(surface, Surface) or count == 0:
            continue
        lowest = np.array(-0.5 * shape.size)  # a body without corners is drawn as a ball
        if len(corners_B) > 0:
            lowest = (surface.normal_W @ R_WB @ corners_B.T).min(axis=1)
        gaps = surface.gaps(trajectory.p_WB_W) + lowest
        deep = np.flatnonzero(gaps < min(float(gaps[0]), 0.0) - DEEP * shape.size)
        if len(deep) > 0 and deep[0] < count:
            count, name = int(deep[0]), surface.name
    return trajectory if not name else _first(trajectory, count), name


def _first(trajectory: Trajectory, count: int) -> Trajectory:
    return Trajectory(
        seconds=trajectory.seconds[:count],
        p_WB_W=trajectory.p_WB_W[:count],
        q_WB=trajectory.q_WB[:count],
        v_WB_W=trajectory.v_WB_W[:count],
        w_WB_W=trajectory.w_WB_W[:count],
    )
