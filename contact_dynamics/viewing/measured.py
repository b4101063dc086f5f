# SPDX-License-Identifier: Apache-2.0
"""Draws measured states: a body's pose, its trail and its curves over time, for many states in one call.

The curves are height and speed and, if the mass properties are known, energy and angular momentum, which are
conserved in free flight, momentum and angular velocity. After an impact, the measured velocity is drawn
beside the predicted one: as curves over the time from which it is estimated, and as an arrow in the scene.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.constants import seconds_since, to_ns
from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.impact_scene import measured_marks
from contact_dynamics.diagrams.trajectory_curves import (
    angular_momenta_of,
    energies_of,
    momenta_of,
    trajectory_of,
)
from contact_dynamics.viewing.columns import pose_columns, scalar_columns, strip_columns
from contact_dynamics.viewing.drawing import draw_marks
from contact_dynamics.viewing.entities import (
    ANGULAR_MOMENTUM,
    ANGULAR_VELOCITY,
    BODIES,
    ENERGY,
    ERROR,
    HEIGHT,
    IMPACTS,
    MOMENTUM,
    SPEED,
    TIMELINE,
    TRAILS,
    entity,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import ArrayLike, NDArray

    from contact_dynamics.diagrams.after_impact import AfterImpact
    from contact_dynamics.diagrams.shape import Shape
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.tumbling import Trajectory
    from contact_dynamics.validation import FloatArray


PREDICTED: Final = "after impact, predicted"  # kinds of curves of the speed
MEASURED: Final = "after impact, measured"

OF_ONE_BODY: Final = (ENERGY, MOMENTUM, ANGULAR_MOMENTUM, ANGULAR_VELOCITY)
"""The entities of the curves of a single body, which must have mass properties."""

_MAX_ACCELERATION: Final = 20.0
"""m/s^2. It allows for impacts and gaps, so that these do not count as a displacement by hand."""

_SLACK: Final = 0.05  # m, the same for a body with inaccurate measured velocities

_GAP_S: Final = 1e-3  # s after a curve, where a gap separates it from the next

SET_BACK_S: Final = 0.5
"""s. If the stamps of a body decrease by more, its clock was set back, as by a restarted simulation. Late
states are late by less."""


def curves_of(
    trajectory: Trajectory,
    *,
    up_W: FloatArray,
    body: MassProperties | None = None,
    gravity_W: FloatArray | None = None,
) -> dict[str, FloatArray]:
    """Return the curves over a trajectory by their entities, (n,) each.

    They are the height, m, and the speed, m/s, of the centre of mass. With the mass properties of the body
    they are also its energy, J, with the potential energy in gravity, (3,), m/s^2, which is zero at the
    origin of the world, and the sizes of its momentum, kg m/s, of its angular momentum about the centre of
    mass, kg m^2/s, and of its angular velocity, rad/s.
    """
    curves = {HEIGHT: trajectory.p_WB_W @ up_W, SPEED: np.linalg.norm(trajectory.v_WB_W, axis=1)}
    if body is not None:
        gravity_W = np.zeros(3) if gravity_W is None else gravity_W
        curves[ENERGY] = energies_of(body, trajectory, gravity_W=gravity_W)[:, 3]
        curves[MOMENTUM] = np.linalg.norm(momenta_of(body, trajectory), axis=1)
        curves[ANGULAR_MOMENTUM] = np.linalg.norm(angular_momenta_of(body, trajectory), axis=1)
        curves[ANGULAR_VELOCITY] = np.linalg.norm(trajectory.w_WB_W, axis=1)
    return curves


def style_series(
    recording: rr.RecordingStream, body_name: str, color: palette.Color = palette.MEASURED
) -> None:
    """Set colours and names of a body's curves; ``color`` is the body's own."""
    error = rr.SeriesLines(colors=color, names=f"{body_name} off its prediction", widths=2.0)
    recording.log(entity(ERROR, body_name), error, static=True)
    for quantity in (HEIGHT, SPEED, *OF_ONE_BODY):
        for kind, own, width in (("measured", color, 4.0), ("predicted", palette.PREDICTED, 1.0)):
            path = entity(quantity, body_name, kind)
            series = rr.SeriesLines(colors=own, names=f"{body_name} {kind}", widths=width)
            recording.log(path, series, static=True)
    for kind, own in ((PREDICTED, palette.IMPACT), (MEASURED, palette.readable(color))):
        series = rr.SeriesLines(colors=own, names=f"{body_name} {kind}", widths=2.5)
        recording.log(entity(SPEED, body_name, kind), series, static=True)


def draw_states(
    recording: rr.RecordingStream,
    body_name: str,
    states: Sequence[BodyState],
    *,
    before: BodyState | None,
    up_W: FloatArray,
    body: MassProperties | None = None,
    gravity_W: FloatArray | None = None,
) -> None:
    """Draw states in the order of their stamps. The trail continues from the state ``before``, if any.

    It has a gap where the body was moved elsewhere, as by the reset of a simulation.

    The other arguments are those of `curves_of`.
    """
    if not states:
        return
    stamps = time_column([state.stamp_ns for state in states])
    measured = trajectory_of(states)
    points = measured.p_WB_W
    poses = pose_columns(points, measured.q_WB)
    recording.send_columns(entity(BODIES, body_name), indexes=[stamps], columns=poses)
    way = trajectory_of([before or states[0], *states])
    segments = np.stack([way.p_WB_W[:-1], points], axis=1)
    segments[_put_elsewhere(way), 0] = points[_put_elsewhere(way)]
    recording.send_columns(entity(TRAILS, body_name), indexes=[stamps], columns=strip_columns(segments))
    curves = curves_of(measured, up_W=up_W, body=body, gravity_W=gravity_W)
    _draw_curves(recording, body_name, "measured", stamps, curves)


def _put_elsewhere(way: Trajectory) -> NDArray[np.bool_]:
    """Return which states after the first cannot be reached from the previous one at measured velocities."""
    seconds, speeds = np.diff(way.seconds), np.linalg.norm(way.v_WB_W, axis=1)
    onwards = np.maximum(seconds, 0.0)  # after a clock was set back, no state can be reached
    reach = (speeds[:-1] + speeds[1:]) * onwards + _MAX_ACCELERATION * onwards**2 + _SLACK
    return np.asarray(np.linalg.norm(np.diff(way.p_WB_W, axis=0), axis=1) > reach)


def draw_curves_of_one(
    recording: rr.RecordingStream,
    body_name: str,
    states: Sequence[BodyState],
    *,
    body: MassProperties,
    gravity_W: FloatArray,
) -> None:
    """Draw the curves that only one body has at a time, of states whose other curves are already drawn."""
    if not states:
        return
    stamps = time_column([state.stamp_ns for state in states])
    curves = curves_of(trajectory_of(states), up_W=np.zeros(3), body=body, gravity_W=gravity_W)
    _draw_curves(recording, body_name, "measured", stamps, {name: curves[name] for name in OF_ONE_BODY})


def draw_prediction_at(
    recording: rr.RecordingStream,
    body_name: str,
    states: Sequence[BodyState],
    *,
    trajectory: Trajectory,
    curves: Mapping[str, FloatArray],
    begin_ns: int,
) -> int | None:
    """Draw a trajectory that began at ``begin_ns`` beside the measured states that it covers.

    Its ``curves`` of `curves_of` are drawn at the stamps of the states, with the distance of the measured
    centre of mass from it. The curves of measured and predicted values thus share their times, and many
    predictions form one curve, with a gap at the end of each trajectory. Return the stamp of the last state
    that it covers, if any.
    """
    if len(trajectory) == 0:
        return None
    stamps_ns = [state.stamp_ns for state in states]
    seconds = seconds_since(begin_ns, stamps_ns)
    inside = (seconds >= trajectory.seconds[0]) & (seconds <= trajectory.seconds[-1])
    reached = np.array(stamps_ns, dtype=np.int64)[inside]
    if len(reached) > 0:
        there = {
            quantity: np.interp(seconds[inside], trajectory.seconds, values)
            for quantity, values in curves.items()
        }
        there_stamps = time_column(reached)
        _draw_curves(recording, body_name, "predicted", there_stamps, there)
        measured_W = np.array([state.p_WB_W for state in states])[inside]
        predicted_W = [np.interp(seconds[inside], trajectory.seconds, each) for each in trajectory.p_WB_W.T]
        apart = np.linalg.norm(measured_W - np.column_stack(predicted_W), axis=1)
        recording.send_columns(
            entity(ERROR, body_name), indexes=[there_stamps], columns=scalar_columns(apart)
        )
    past = np.array(stamps_ns, dtype=np.int64)[seconds > trajectory.seconds[-1]]
    if len(past) > 0:
        set_time(recording, int(past[0]))
        for quantity in curves:
            recording.log(entity(quantity, body_name, "predicted"), rr.Clear(recursive=False))
        recording.log(entity(ERROR, body_name), rr.Clear(recursive=False))
    return int(reached[-1]) if len(reached) > 0 else None


def time_column(stamps_ns: ArrayLike) -> rr.TimeColumn:
    """Return stamps in rerun's form, to the nanosecond."""
    return rr.TimeColumn(TIMELINE, timestamp=np.array(stamps_ns, dtype="datetime64[ns]"))


def set_time(recording: rr.RecordingStream, stamp_ns: int) -> None:
    """Set the stamp of all following drawings."""
    recording.set_time(TIMELINE, timestamp=np.datetime64(stamp_ns, "ns"))


def _draw_curves(
    recording: rr.RecordingStream,
    body_name: str,
    kind: str,
    stamps: rr.TimeColumn,
    curves: Mapping[str, FloatArray],
) -> None:
    for quantity, values in curves.items():
        recording.send_columns(
            entity(quantity, body_name, kind), indexes=[stamps], columns=scalar_columns(values)
        )


def draw_after_impact(
    recording: rr.RecordingStream,
    shape: Shape,
    found: AfterImpact,
    *,
    color: palette.Color = palette.MEASURED,
) -> None:
    """Draw the measured motion after an impact at its newest stamp, with the curves at all stamps."""
    name, end_ns = found.answer.body_name, found.stamps_ns[-1]
    stamps = time_column(found.stamps_ns)
    for kind, speeds in ((PREDICTED, found.predicted_speeds), (MEASURED, found.measured_speeds)):
        path = entity(SPEED, name, kind)
        recording.send_columns(path, indexes=[stamps], columns=rr.Scalars.columns(scalars=speeds))
        set_time(recording, end_ns + to_ns(_GAP_S))
        recording.log(path, rr.Clear(recursive=False))
    set_time(recording, end_ns)
    measured = measured_marks(found.answer, found.v_WB_W, size=shape.size, color=color)
    draw_marks(recording, measured, entity(IMPACTS, name))
