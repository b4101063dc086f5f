"""Draws what was measured: a body's pose, its trail, height and speed, for many states in one call."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import rerun as rr

from contact_dynamics.constants import seconds_since
from contact_dynamics.viewing import palette
from contact_dynamics.viewing.entities import HEIGHT, SPEED, TIMELINE, body_entity, entity, trail_entity

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.tumbling import Trajectory
    from contact_dynamics.validation import FloatArray


def style_series(recording: rr.RecordingStream, body_name: str) -> None:
    """Set colours and names of a body's curves."""
    for quantity in (HEIGHT, SPEED):
        for kind, color, width in (
            ("measured", palette.MEASURED, 4.0),
            ("predicted", palette.PREDICTED, 2.0),
        ):
            path = entity(quantity, body_name, kind)
            series = rr.SeriesLines(colors=color, names=f"{body_name} {kind}", widths=width)
            recording.log(path, series, static=True)


def draw_states(
    recording: rr.RecordingStream,
    body_name: str,
    states: Sequence[BodyState],
    *,
    before: BodyState | None,
    up_W: FloatArray,
) -> None:
    """Draw states in the order of their stamps. The trail continues from the state ``before``, if any."""
    if not states:
        return
    stamps = time_column([state.stamp_ns for state in states])
    points = np.array([state.p_WB_W for state in states])
    orientations = np.array([state.q_WB for state in states])
    poses = rr.Transform3D.columns(translation=points, quaternion=orientations)
    recording.send_columns(body_entity(body_name), indexes=[stamps], columns=poses)
    starts = np.vstack([points[:1] if before is None else before.p_WB_W, points[:-1]])
    segments = np.stack([starts, points], axis=1)
    trail = rr.LineStrips3D.columns(strips=list(segments))
    recording.send_columns(trail_entity(body_name), indexes=[stamps], columns=trail)
    speeds = np.linalg.norm([state.v_WB_W for state in states], axis=1)
    _draw_curves(recording, body_name, "measured", stamps, heights=points @ up_W, speeds=speeds)


def draw_prediction_at(
    recording: rr.RecordingStream,
    body_name: str,
    stamps_ns: Sequence[int],
    *,
    trajectory: Trajectory,
    begin_ns: int,
    up_W: FloatArray,
) -> None:
    """Draw the height and speed of a trajectory, which began at ``begin_ns``, at the stamps that it reaches.

    So the curves of measured and predicted values share their times, and many predictions make one curve,
    which has a gap where a trajectory has ended.
    """
    if len(trajectory) == 0:
        return
    seconds = seconds_since(begin_ns, stamps_ns)
    inside = (seconds >= trajectory.seconds[0]) & (seconds <= trajectory.seconds[-1])
    reached = np.array(stamps_ns, dtype=np.int64)[inside]
    if len(reached) > 0:
        heights = np.interp(seconds[inside], trajectory.seconds, trajectory.p_WB_W @ up_W)
        speeds = np.interp(seconds[inside], trajectory.seconds, np.linalg.norm(trajectory.v_WB_W, axis=1))
        _draw_curves(recording, body_name, "predicted", time_column(reached), heights=heights, speeds=speeds)
    past = np.array(stamps_ns, dtype=np.int64)[seconds > trajectory.seconds[-1]]
    if len(past) > 0:
        set_time(recording, int(past[0]))
        for quantity in (HEIGHT, SPEED):
            recording.log(entity(quantity, body_name, "predicted"), rr.Clear(recursive=False))


def time_column(stamps_ns: ArrayLike) -> rr.TimeColumn:
    """Return stamps as rerun takes them, to the nanosecond."""
    return rr.TimeColumn(TIMELINE, timestamp=np.array(stamps_ns, dtype="datetime64[ns]"))


def set_time(recording: rr.RecordingStream, stamp_ns: int) -> None:
    """Set the stamp at which everything that is logged next appears."""
    recording.set_time(TIMELINE, timestamp=np.datetime64(stamp_ns, "ns"))


def _draw_curves(
    recording: rr.RecordingStream,
    body_name: str,
    kind: str,
    stamps: rr.TimeColumn,
    *,
    heights: FloatArray,
    speeds: FloatArray,
) -> None:
    for quantity, values in ((HEIGHT, heights), (SPEED, speeds)):
        recording.send_columns(
            entity(quantity, body_name, kind), indexes=[stamps], columns=rr.Scalars.columns(scalars=values)
        )
