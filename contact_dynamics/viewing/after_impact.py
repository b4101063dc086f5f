# SPDX-License-Identifier: Apache-2.0
"""Draws the velocity that a body has after an impact beside the one that was predicted.

Among the curves of the body's speed there is one of each, over the time from which the measured one is found.
In the scene an arrow beside those of the impact shows the measured velocity.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import rerun as rr

from contact_dynamics.constants import to_ns
from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.impact_scene import measured_marks
from contact_dynamics.viewing.drawing import draw_marks
from contact_dynamics.viewing.entities import SPEED, entity, impact_entity
from contact_dynamics.viewing.measured import set_time, time_column

if TYPE_CHECKING:
    from contact_dynamics.diagrams.after_impact import AfterImpact
    from contact_dynamics.diagrams.shape import Shape

PREDICTED: Final = "after impact, predicted"
MEASURED: Final = "after impact, measured"

_GAP_S: Final = 1e-3  # s after a curve, where it ends, so that nothing joins it to the next
_WIDTH: Final = 2.5


def style_after_impact(
    recording: rr.RecordingStream, body_name: str, color: palette.Color = palette.MEASURED
) -> None:
    """Set colours and names of the two curves; ``color`` is the body's own."""
    for kind, own in ((PREDICTED, palette.IMPACT), (MEASURED, palette.readable(color))):
        series = rr.SeriesLines(colors=own, names=f"{body_name} {kind}", widths=_WIDTH)
        recording.log(entity(SPEED, body_name, kind), series, static=True)


def draw_after_impact(
    recording: rr.RecordingStream,
    shape: Shape,
    found: AfterImpact,
    *,
    color: palette.Color = palette.MEASURED,
) -> None:
    """Draw what was measured after an impact at the newest of its stamps, with the curves at all of them."""
    name, end_ns = found.answer.body_name, found.stamps_ns[-1]
    stamps = time_column(found.stamps_ns)
    for kind, speeds in ((PREDICTED, found.predicted_speeds), (MEASURED, found.measured_speeds)):
        path = entity(SPEED, name, kind)
        recording.send_columns(path, indexes=[stamps], columns=rr.Scalars.columns(scalars=speeds))
        set_time(recording, end_ns + to_ns(_GAP_S))
        recording.log(path, rr.Clear(recursive=False))
    set_time(recording, end_ns)
    measured = measured_marks(found.answer, found.v_WB_W, size=shape.size, color=color)
    draw_marks(recording, measured, impact_entity(name))
