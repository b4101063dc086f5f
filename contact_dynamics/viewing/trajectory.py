"""Where a body was predicted to be: the path of its centre of mass, outlines on it, the pose at its end."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.rigid_body import rotation_matrix
from contact_dynamics.viewing import palette
from contact_dynamics.viewing.entities import predicted_entity
from contact_dynamics.viewing.scene import solid

if TYPE_CHECKING:
    from contact_dynamics.tumbling import Trajectory
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.viewing.shape import Shape

MOST_PATH_POINTS: Final = 2000
"""More samples than a screen is wide are thinned out evenly."""

OUTLINES: Final = 6
"""Outlines of the body along the path, evenly in time, besides the one at its end."""

_PATH_WIDTH: Final = -2.0  # negative: points of the screen
_OUTLINE_WIDTH: Final = -0.8
_END_WIDTH: Final = -1.5


def draw_trajectory(
    recording: rr.RecordingStream, body_name: str, shape: Shape, trajectory: Trajectory
) -> None:
    """Draw a trajectory at the recording's current time; one without samples clears what was drawn before."""
    path = predicted_entity(body_name)
    if len(trajectory) == 0:
        recording.log(path, rr.Clear(recursive=True))
        return
    last = len(trajectory) - 1
    samples = np.unique(np.linspace(0, last, min(last + 1, MOST_PATH_POINTS)).round().astype(int))
    strip = rr.LineStrips3D([trajectory.p_WB_W[samples]], colors=palette.PREDICTED, radii=_PATH_WIDTH)
    recording.log(f"{path}/path", strip)
    times = np.linspace(trajectory.seconds[0], trajectory.seconds[-1], OUTLINES + 2)[1:-1]
    chosen = np.unique(np.abs(trajectory.seconds[:, None] - times).argmin(axis=0))[:last]
    edges = [edge for i in chosen for edge in outline(shape, trajectory.p_WB_W[i], trajectory.q_WB[i])]
    color = palette.translucent(palette.PREDICTED, 0.45)
    recording.log(f"{path}/outlines", rr.LineStrips3D(edges, colors=color, radii=_OUTLINE_WIDTH))
    end = f"{path}/end"
    pose = rr.Transform3D(translation=trajectory.p_WB_W[last], quaternion=trajectory.q_WB[last])
    recording.log(end, pose)
    if len(shape.edges_B) > 0:
        strips = rr.LineStrips3D(list(shape.edges_B), colors=palette.PREDICTED, radii=_END_WIDTH)
        recording.log(f"{end}/edges", strips)
    if len(shape.triangles_B) > 0:
        recording.log(f"{end}/faces", solid(shape, palette.translucent(palette.PREDICTED, 0.25)))


def outline(shape: Shape, p_WB_W: FloatArray, q_WB: FloatArray) -> FloatArray:
    """Return the edges, (k, 2, 3), m, world, of a body at a pose."""
    edges: FloatArray = p_WB_W + shape.edges_B @ rotation_matrix(q_WB).T
    return edges
