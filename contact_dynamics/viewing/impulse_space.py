"""Draws an impact in impulse space. `contact_dynamics.diagrams.impulse_space` says what it shows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.diagrams.impulse_space import EVENTS, impulse_space_of, line_in_box
from contact_dynamics.viewing import palette
from contact_dynamics.viewing.entities import IMPULSE_SPACE

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike

    from contact_dynamics.questions.impact import ImpactAnswer
    from contact_dynamics.rigid_body.body import MassProperties
    from contact_dynamics.validation import FloatArray

_LINE_WIDTH: Final = -1.2  # a negative size is in points of the screen
_PATH_WIDTH: Final = -2.5
_POINT_SIZE: Final = -5.0
_LABEL_OFFSET: Final = 0.55  # distance of a label's centre from its place, relative to the picture's height
_NAMES: Final = 0.85  # distance of the names' centre from the normal, relative to the picture's height
_NAMED: Final = (
    ("sticking line", palette.STICKING_LINE),
    ("compression line", palette.COMPRESSION_LINE),
    ("friction cone", palette.translucent(palette.FRICTION_CONE, 1.0)),
)


def draw_impulse_space(
    recording: rr.RecordingStream,
    mass_properties: MassProperties | None,
    answer: ImpactAnswer,
    *,
    other: MassProperties | None = None,
    entity: str = IMPULSE_SPACE,
) -> None:
    """Draw the impulse path of an impact's main contact, at the recording's current time.

    The sticking and compression lines need the mass properties of all bodies that move, and are left out
    otherwise. ``other`` are the mass properties of the body that is struck. ``entity``, a name without
    slashes, is where the picture goes.
    """
    space = impulse_space_of(mass_properties, answer, other=other)
    extent = space.extent
    axes = [[(-extent, 0.0), (extent, 0.0)], [(0.0, 0.0), (0.0, extent)]]
    _strips(recording, [entity, "axes"], axes, palette.SURFACE_GRID)
    cone_color = palette.translucent(palette.FRICTION_CONE, 1.0)
    _strips(recording, [entity, "friction cone"], [space.cone], cone_color)
    # Labels of the path are on its side of the normal, and the names of the lines are on the other side.
    _draw_names(recording, entity, -space.side * _NAMES * extent, extent)
    for (name, color), lines in zip(_NAMED, (space.sticking, space.compression), strict=False):
        strips = [part for line in lines for part in line_in_box(line, extent)]
        _strips(recording, [entity, name], strips, color)
    _strips(recording, [entity, "path"], [space.path], palette.IMPACT, width=_PATH_WIDTH)
    texts = [
        f"{EVENTS[event]}: {t:.3g}, {n:.3g} N s"
        for event, (t, n) in zip(space.events, space.points.tolist(), strict=True)
    ]
    shown = rr.Points2D(_on_screen(space.points), colors=palette.IMPACT, radii=_POINT_SIZE)
    recording.log([entity, "events"], shown)
    places = space.points + np.array([space.side * _LABEL_OFFSET * extent, 0.0])
    labels = rr.Points2D(_on_screen(places), colors=palette.IMPACT, radii=0.0, labels=texts, show_labels=True)
    recording.log([entity, "event labels"], labels)


def _draw_names(recording: rr.RecordingStream, entity: str, t: float, extent: float) -> None:
    points = np.array([(t, extent * (1.0 - 0.13 * i)) for i in range(len(_NAMED))])
    colors = [color for _, color in _NAMED]
    labels = rr.Points2D(
        _on_screen(points), colors=colors, radii=0.0, labels=[name for name, _ in _NAMED], show_labels=True
    )
    recording.log([entity, "names"], labels)


def _strips(
    recording: rr.RecordingStream,
    path: list[object],
    strips: Iterable[ArrayLike],
    color: palette.Color,
    *,
    width: float = _LINE_WIDTH,
) -> None:
    drawn = [_on_screen(np.asarray(strip)) for strip in strips]
    recording.log(path, rr.LineStrips2D(drawn, colors=color, radii=width))


def _on_screen(points: FloatArray) -> FloatArray:
    """Return points with the second coordinate downwards, as rerun's 2D views have it."""
    flipped: FloatArray = points.reshape(-1, 2) * (1.0, -1.0)
    return flipped
