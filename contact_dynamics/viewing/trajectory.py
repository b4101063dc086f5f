"""Where a body was predicted to be: the path of its centre of mass, outlines along it, and the pose at its end."""

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


def draw_trajectory(recording: rr.RecordingStream, body_name: str, shape: Shape, trajectory: Trajectory) -> None:
    """Draw a trajectory at the recording's current time; one without samples takes away what was drawn before."""
    path = predicted_entity(body_name)
    if len(trajectory) == 0:
        recording.log(path, rr.Clear(recursive=True))
        return
    last = len(trajectory) - 1
    samples = np.unique(np.linspace(0, last, min(last + 1, MOST_PATH_POINTS)).round().astype(int))
    strip = trajectory.p_WB_W[samples]
    recording.log(f"{path}/path", rr.LineStrips3D([strip], colors=palette.PREDICTED, radii=_PATH_WIDTH))
    times = np.linspace(trajectory.seconds[0], trajectory.seconds[-1], OUTLINES + 2)[1:-1]
    chosen = np.unique(np.abs(trajectory.seconds[:, None] - times).argmin(axis=0)) if last > 0 else np.array([], int)
    outlines = [outline(shape, trajectory.p_WB_W[i], trajectory.q_WB[i]) for i in chosen]
    recording.log(
        f"{path}/outlines",
        rr.LineStrips3D(
            np.concatenate([np.zeros((0, 2, 3)), *outlines]),
            colors=palette.translucent(palette.PREDICTED, 0.45),
            radii=_OUTLINE_WIDTH,
        ),
    )
    end = f"{path}/end"
    recording.log(end, rr.Transform3D(translation=trajectory.p_WB_W[last], quaternion=trajectory.q_WB[last]))
    if len(shape.edges_B) > 0:
        recording.log(f"{end}/edges", rr.LineStrips3D(shape.edges_B, colors=palette.PREDICTED, radii=_END_WIDTH))
    if len(shape.triangles_B) > 0:
        recording.log(f"{end}/faces", solid(shape, palette.translucent(palette.PREDICTED, 0.25)))


def outline(shape: Shape, p_WB_W: FloatArray, q_WB: FloatArray) -> FloatArray:
    """Return the edges, (k, 2, 3), m, world, of a body at a pose."""
    edges: FloatArray = p_WB_W + shape.edges_B @ rotation_matrix(q_WB).T
    return edges
