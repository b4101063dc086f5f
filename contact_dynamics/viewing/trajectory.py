"""Draws where a body was predicted to be: the path of its centre of mass, outlines on it, its last pose.

If the prediction has covariances, there is an ellipsoid at each outline. It extends two deviations to each
side, and so contains the centre of mass in three of four cases. A white one is not to be relied on.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.diagrams import palette
from contact_dynamics.rotations.one import rotation_matrix
from contact_dynamics.viewing.entities import predicted_entity
from contact_dynamics.viewing.scene import solid
from contact_dynamics.viewing.strips import strips_3d

if TYPE_CHECKING:
    from contact_dynamics.diagrams.shape import Shape
    from contact_dynamics.motion.covariance import CarriedCovariance
    from contact_dynamics.tumbling import Trajectory
    from contact_dynamics.validation import FloatArray

MAX_PATH_POINTS: Final = 2000
"""If there are more samples than this, they are thinned out evenly. It is the width of a screen."""

MAX_OUTLINES: Final = 6
"""Number of outlines of the body along the path, evenly in time, besides the one at its end. A short path has
one for each length of the body."""

NEARBY: Final = 0.25
"""Relative to the size of the body: an end that is nearer to the start is not drawn, since it would only hide
the body."""

DEVIATIONS: Final = 2.0
"""Half axes of the ellipsoids of uncertainty, in standard deviations: 74 % of a normal distribution."""

DEFAULT_PREDICTIONS: Final = 4
"""The paths of this many newest predictions of a body are in view."""

_PATH_WIDTH: Final = -2.0  # a negative size is in points of the screen
_OUTLINE_WIDTH: Final = -0.8
_END_WIDTH: Final = -1.5


def draw_trajectory(
    recording: rr.RecordingStream,
    body_name: str,
    shape: Shape,
    trajectory: Trajectory,
    *,
    covariance: CarriedCovariance | None = None,
) -> None:
    """Draw a trajectory at the recording's current time. One without samples clears what was drawn before.

    ``covariance`` is the covariance of the state at the trajectory's samples, or None if it is not known.
    """
    path = predicted_entity(body_name)
    if len(trajectory) == 0:
        recording.log(path, rr.Clear(recursive=True))
        return
    last = len(trajectory) - 1
    strip = rr.LineStrips3D(strips_3d([_thinned(trajectory)]), colors=palette.PREDICTED, radii=_PATH_WIDTH)
    recording.log(f"{path}/path", strip)
    travelled = float(np.linalg.norm(np.diff(trajectory.p_WB_W, axis=0), axis=1).sum())
    count = min(MAX_OUTLINES, int(travelled / shape.size))
    times = np.linspace(trajectory.seconds[0], trajectory.seconds[-1], count + 2)[1:-1]
    chosen = np.abs(trajectory.seconds[:, None] - times).argmin(axis=0)
    outlines = [outline(shape, trajectory.p_WB_W[i], trajectory.q_WB[i]) for i in chosen]
    edges = [edge for edges in outlines for edge in edges]
    color = palette.translucent(palette.PREDICTED, 0.45)
    recording.log(f"{path}/outlines", rr.LineStrips3D(strips_3d(edges), colors=color, radii=_OUTLINE_WIDTH))
    ellipsoids = _ellipsoids(trajectory, covariance, [*chosen.tolist(), last])
    recording.log(f"{path}/uncertainty", ellipsoids or rr.Clear(recursive=False))
    p_WB_W, q_WB = trajectory.p_WB_W[last], trajectory.q_WB[last]
    moves_away = travelled > NEARBY * shape.size
    edges = list(outline(shape, p_WB_W, q_WB)) if moves_away else []
    recording.log(
        f"{path}/end", rr.LineStrips3D(strips_3d(edges), colors=palette.PREDICTED, radii=_END_WIDTH)
    )
    pose = rr.Transform3D(translation=p_WB_W, quaternion=q_WB)
    recording.log(f"{path}/newest_end", pose)
    faces = solid(shape, palette.translucent(palette.PREDICTED, 0.25))
    recording.log(f"{path}/newest_end/faces", faces if moves_away else rr.Clear(recursive=False))


def draw_earlier_path(
    recording: rr.RecordingStream, body_name: str, trajectory: Trajectory, *, place: int
) -> None:
    """Keep the path of a trajectory in view when a later one is drawn, until another takes its place."""
    path = f"{predicted_entity(body_name)}/earlier/{place}"
    color = palette.translucent(palette.PREDICTED, 0.4)
    recording.log(
        path, rr.LineStrips3D(strips_3d([_thinned(trajectory)]), colors=color, radii=0.5 * _PATH_WIDTH)
    )


def _thinned(trajectory: Trajectory) -> FloatArray:
    last = len(trajectory) - 1
    samples = np.unique(np.linspace(0, last, min(last + 1, MAX_PATH_POINTS)).round().astype(int))
    thinned: FloatArray = trajectory.p_WB_W[samples]
    return thinned


def _ellipsoids(
    trajectory: Trajectory, carried: CarriedCovariance | None, samples: list[int]
) -> rr.Ellipsoids3D | None:
    if carried is None:
        return None
    from scipy.spatial.transform import Rotation

    positions_W = carried.covariances[:, :3, :3]
    known = [i for i in samples if np.isfinite(positions_W[i]).all()]
    variances, axes_W = np.linalg.eigh(positions_W[known])
    right_handed = axes_W * np.linalg.det(axes_W)[:, None, None]
    turns = Rotation.from_matrix(right_handed).as_quat() if known else []
    return rr.Ellipsoids3D(
        centers=trajectory.p_WB_W[known],
        half_sizes=DEVIATIONS * np.sqrt(np.maximum(variances, 0.0)),
        quaternions=[rr.Quaternion(xyzw=turn) for turn in turns],
        colors=[palette.PREDICTED if carried.trusted[i] else palette.UNDECIDED for i in known],
        line_radii=_OUTLINE_WIDTH,
        fill_mode=rr.components.FillMode.MajorWireframe,
    )


def outline(shape: Shape, p_WB_W: FloatArray, q_WB: FloatArray) -> FloatArray:
    """Return the edges, (k, 2, 3), m, world, of a body at a pose."""
    edges: FloatArray = p_WB_W + shape.edges_B @ rotation_matrix(q_WB).T
    return edges
