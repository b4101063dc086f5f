# SPDX-License-Identifier: Apache-2.0
"""Draws the strikes of a calibration side by side in rerun, those with the largest residuals first.

Blue grey is the body at the strike, with its measured path on both sides. Two arrows begin at its mass
centre: the velocity afterwards, blue as measured and yellow as the calibrated body and surface predict it.
Above the body are the angular velocities in the same colours. A strike that was left out has red edges, and
its label says so. The table has the residuals by number.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.shape import drawn_shape
from contact_dynamics.diagrams.world_scene import body_marks
from contact_dynamics.records import Record
from contact_dynamics.viewing.drawing import parts_of
from contact_dynamics.viewing.entities import entity
from contact_dynamics.viewing.kept_recording import APPLICATION
from contact_dynamics.viewing.side_by_side import EVENTS, MAX_DRAWN, TABLE, SideBySide

if TYPE_CHECKING:
    from pathlib import Path

    from contact_dynamics.calibration.observed import Observed
    from contact_dynamics.calibration.result import Calibration
    from contact_dynamics.measured.flights import Strike
    from contact_dynamics.validation import FloatArray

VELOCITY: Final = slice(0, 3)
SPIN: Final = slice(3, 6)

_ARROW: Final = 1.0  # length of the longest arrow, in sizes of the body
_WIDTH: Final = -1.8  # negative: points of the screen


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class DrawnStrike(Record):
    """A strike and its drawn data."""

    toss: Observed  # the events of its toss
    strike: Strike  # the strike
    measured: FloatArray  # (6,), m/s and rad/s, of the calibrated mass centre after it
    predicted: FloatArray  # (6,), the same as predicted
    # (2,), sizes of the residuals of velocity and spin, in standard deviations of noise and the law's spread
    # together.
    deviations: FloatArray
    rejected: bool  # whether it was left out


def drawn_strikes(found: Calibration) -> list[DrawnStrike]:
    """Return the strikes, first those that were left out, then by the size of their residuals."""
    outliers = {(each.recording, each.time) for each in found.outliers if each.kind.startswith("velocities")}
    strikes = [(toss, strike) for toss in found.observed for strike in toss.strikes]
    spread = np.repeat([found.spread.velocity, found.spread.spin], 3)
    sizes = found.residuals / np.hypot(found.residual_stds, spread)
    rows = []
    for k, (toss, strike) in enumerate(strikes):
        after = strike.after.state
        arm_W = after.R_WB @ (found.body.p_FB_F - toss.motion.body.p_FB_F)
        measured = np.concatenate([after.v_WB_W + np.cross(after.w_WB_W, arm_W), after.w_WB_W])
        rows.append(
            DrawnStrike(
                toss=toss,
                strike=strike,
                measured=measured,
                predicted=measured + found.residuals[k],
                deviations=np.sqrt(np.square(sizes[k]).reshape(2, 3).mean(axis=1)),
                rejected=(toss.name, strike.time) in outliers,
            )
        )
    return sorted(rows, key=lambda row: (not row.rejected, -float(row.deviations.max())))


def write_picture(path: Path, found: Calibration) -> int:
    """Draw the strikes of a calibration into a file, which is replaced. Return how many were drawn.

    Raise `OSError` if the file cannot be written.
    """
    rows = drawn_strikes(found)[:MAX_DRAWN]
    shape = drawn_shape(found.body.shape)
    places = SideBySide(count=len(rows), size=shape.size, gravity_W=found.gravity_W)
    recording = rr.RecordingStream(APPLICATION)
    recording.set_sinks(rr.FileSink(str(path)))
    recording.send_blueprint(places.blueprint("Strikes, measured and predicted", "Residuals"))
    scales = []
    for part in (VELOCITY, SPIN):
        longest = max((float(np.linalg.norm(row.measured[part])) for row in rows), default=0.0)
        scales.append(_ARROW * shape.size / longest if longest > 0.0 else 0.0)
    for number, row in enumerate(rows):
        at = entity(EVENTS, f"{number:02d} {row.toss.name}")
        at_W = _draw_body(recording, at, row, found)
        recording.log(at, rr.Transform3D(translation=places.place(number) - at_W), static=True)
        above_W, below_W = (at_W + share * shape.size * places.up_W for share in (0.6, -0.75))
        _draw_arrows(recording, f"{at}/velocity_after", row, VELOCITY, begin_W=at_W, scale=scales[0])
        _draw_arrows(recording, f"{at}/spin_after", row, SPIN, begin_W=above_W, scale=scales[1])
        text = f"{number}{' excluded' if row.rejected else ''}"
        label = rr.Points3D([below_W], labels=[text], radii=0.0, show_labels=True)
        recording.log(f"{at}/label", label, static=True)
    table = rr.TextDocument(table_of(rows), media_type=rr.MediaType.MARKDOWN)
    recording.log(TABLE, table, static=True)
    recording.disconnect()
    return len(rows)


def table_of(rows: list[DrawnStrike]) -> str:
    """Return a Markdown table with the errors of the velocities after each strike."""
    lines = [
        "| | toss | at | velocity off | sigma | spin off | sigma | |",
        "| --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for number, row in enumerate(rows):
        off = row.predicted - row.measured
        sizes = [float(np.linalg.norm(x[part])) for part in (VELOCITY, SPIN) for x in (off, row.measured)]
        lines.append(
            f"| {number} | {row.toss.name} | {row.strike.time:.3f} s | "
            f"{sizes[0]:.3f} of {sizes[1]:.2f} m/s | {row.deviations[0]:.1f} | "
            f"{sizes[2]:.2f} of {sizes[3]:.1f} rad/s | {row.deviations[1]:.1f} | "
            f"{'excluded' if row.rejected else ''} |"
        )
    return "\n".join(lines)


def _draw_body(recording: rr.RecordingStream, path: str, row: DrawnStrike, found: Calibration) -> FloatArray:
    """Draw the body and its path, and return where its mass centre is, (3,), m."""
    state = row.strike.before.state
    shape, motion = drawn_shape(found.body.shape), row.toss.motion
    at_W = state.p_WB_W + state.R_WB @ (found.body.p_FB_F - motion.body.p_FB_F)
    pose = rr.Transform3D(translation=at_W, quaternion=rr.Quaternion(xyzw=state.q_WB))
    recording.log(f"{path}/body", pose, static=True)
    marks = body_marks(shape, edges=palette.IMPACT if row.rejected else palette.MEASURED_EDGE)
    for name, part in parts_of(marks).items():
        recording.log(f"{path}/body/{name}", part, static=True)
    paths = [motion.p_WB_W[frames] for frames in (row.strike.frames_before, row.strike.frames_after)]
    trail = rr.LineStrips3D(paths, colors=palette.MEASURED, radii=_WIDTH)
    recording.log(f"{path}/path", trail, static=True)
    return at_W


def _draw_arrows(
    recording: rr.RecordingStream,
    path: str,
    row: DrawnStrike,
    part: slice,
    *,
    begin_W: FloatArray,
    scale: float,
) -> None:
    for name, velocity, color in (
        ("measured", row.measured[part], palette.MEASURED),
        ("predicted", row.predicted[part], palette.AFTER_IMPACT),
    ):
        arrow = rr.Arrows3D(origins=[begin_W], vectors=[scale * velocity], colors=color, radii=_WIDTH)
        recording.log(entity(path, name), arrow, static=True)
