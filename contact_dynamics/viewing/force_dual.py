"""Draws lecture 26's construction for one mode: acceleration centres and force duals, and what they span.

`contact_dynamics.diagrams.force_dual` says what it shows. The body's outline is drawn below, so that a point
is the centre that a motion would have.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.force_dual import force_dual_of
from contact_dynamics.viewing.entities import FORCE_DUAL
from contact_dynamics.viewing.mode_map import draw_frame
from contact_dynamics.viewing.strips import strips_2d

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes import PlanarWrenchSet
    from contact_dynamics.diagrams.wrench_chart import ForceDualChart
    from contact_dynamics.plane.types import PlanarContact
    from contact_dynamics.validation import FloatArray

_POINT_SIZE: Final = -4.5  # a negative size is in points of the screen
_OUTLINE_WIDTH: Final = -1.2
_FILL: Final = 0.55  # share of the mode's colour in its region


def draw_force_dual(
    recording: rr.RecordingStream,
    one: PlanarWrenchSet,
    contacts: Sequence[PlanarContact],
    chart: ForceDualChart,
    *,
    outlines: Sequence[FloatArray] = (),
    color: palette.Color = palette.SLIDE,
    entity: str = FORCE_DUAL,
) -> None:
    """Draw the construction for one mode of a body at rest, at the recording's current time.

    Args:
        recording: to draw into.
        one: the mode's applied wrenches, of `contact_modes.wrench_sets`.
        contacts: all contacts, in the order of the mode's letters.
        chart: how much of the plane to show.
        outlines: strips, (k, 2) each, m from the centre of mass, drawn below: the body, walls.
        color: the colour of the mode's wrenches, as `color_of_modes` has it in the map.
        entity: where the picture is put.
    """
    figure = force_dual_of(one, contacts, chart, outlines=outlines)
    fill = [_FILL * a + (1.0 - _FILL) * b for a, b in zip(color, palette.BACKGROUND, strict=True)]
    pixels = np.array([palette.BACKGROUND, fill]).astype(np.uint8)[figure.inside.astype(int), :3]
    recording.log(f"{entity}/wrenches", rr.Image(pixels, color_model="RGB", draw_order=-20.0))
    strips = rr.LineStrips2D(
        strips_2d(figure.outlines), colors=palette.translucent(palette.MEASURED, 0.6), radii=_OUTLINE_WIDTH
    )
    recording.log(f"{entity}/body", strips)
    recording.log(
        f"{entity}/borders", rr.LineStrips2D(strips_2d(figure.borders), colors=color, radii=_OUTLINE_WIDTH)
    )
    for name, dots, point_color in (
        ("contact_forces", figure.contact_forces, palette.FRICTION_CONE),
        ("acceleration_centres", figure.acceleration_centres, palette.PREDICTED),
    ):
        points = rr.Points2D(
            dots.places,
            colors=palette.translucent(point_color, 1.0),
            radii=_POINT_SIZE,
            labels=dots.labels,
            show_labels=True,
        )
        recording.log(f"{entity}/{name}", points)
    draw_frame(recording, chart, entity)
