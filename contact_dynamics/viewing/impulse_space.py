"""Draws an impact in impulse space. `contact_dynamics.diagrams.impulse_space` says what it shows."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.diagrams.impulse_space import EVENTS, impulse_space_of, line_in_box
from contact_dynamics.viewing import palette
from contact_dynamics.viewing.entities import IMPULSE_SPACE
from contact_dynamics.viewing.strips import strips_2d
from contact_dynamics.viewing.words import room_2d, words_2d

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike

    from contact_dynamics.diagrams.impulse_space import ImpulseSpace
    from contact_dynamics.questions.impact_answer import ImpactAnswer
    from contact_dynamics.rigid_body.body import MassProperties
    from contact_dynamics.validation import FloatArray

_LINE_WIDTH: Final = -1.2  # a negative size is in points of the screen
_PATH_WIDTH: Final = -2.5
_POINT_SIZE: Final = -5.0
_BESIDE: Final = 1.35  # distance of the labels' centres from the normal, relative to the picture's height
_ROOM: Final = 2.2  # where labels end, relative to the picture's height
_APART: Final = 0.18  # least distance of labels from each other, relative to the picture's height
_AXIS_NAMES: Final = ("tangential impulse, N s", "normal impulse, N s")
_ABOVE: Final = 1.15  # where the name of the upper axis ends, relative to the picture's height
_AXIS_PLACES: Final = ((-0.62, -0.02), (0.0, 1.13))  # relative to the picture's height
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
    # Words stand beside the lines: labels of the path on its side of the normal, names on the other side.
    _draw_names(recording, entity, space)
    for (name, color), lines in zip(_NAMED, (space.sticking, space.compression), strict=False):
        strips = [part for line in lines for part in line_in_box(line, extent)]
        _strips(recording, [entity, name], strips, color)
    _strips(recording, [entity, "path"], [space.path], palette.IMPACT, width=_PATH_WIDTH)
    texts = [
        f"{EVENTS[event]}: {t:.3g}, {n:.3g}"
        for event, (t, n) in zip(space.events, space.points.tolist(), strict=True)
    ]
    shown = rr.Points2D(_on_screen(space.points), colors=palette.IMPACT, radii=_POINT_SIZE)
    recording.log([entity, "events"], shown)
    places = _label_places(space)
    leaders = list(np.stack([space.points, places], axis=1))
    _strips(recording, [entity, "leaders"], leaders, palette.translucent(palette.IMPACT, 0.5))
    words = words_2d(_on_screen(places), texts, [palette.IMPACT] * len(texts))
    recording.log([entity, "event labels"], words)
    room = np.array([[-_ROOM * extent, 0.0], [_ROOM * extent, 0.0], [0.0, _ABOVE * extent]])
    recording.log([entity, "room"], room_2d(_on_screen(room)))


def _label_places(space: ImpulseSpace) -> FloatArray:
    """Return where the labels of the events are, (m, 2), at their heights as far as that is not too near."""
    places = np.column_stack(
        [np.full(len(space.points), space.side * _BESIDE * space.extent), space.points[:, 1]]
    )
    order = np.argsort(places[:, 1], kind="stable")
    for lower, higher in pairwise(order.tolist()):
        places[higher, 1] = max(places[higher, 1], places[lower, 1] + _APART * space.extent)
    return places


def _draw_names(recording: rr.RecordingStream, entity: str, space: ImpulseSpace) -> None:
    extent = space.extent
    t = -space.side * _BESIDE * extent
    points = np.array([(t, extent * (1.0 - _APART * i)) for i in range(len(_NAMED))])
    names, colors = [name for name, _ in _NAMED], [color for _, color in _NAMED]
    recording.log([entity, "names"], words_2d(_on_screen(points), names, colors))
    places = np.array(_AXIS_PLACES) * (space.side * extent, extent)
    axes = words_2d(_on_screen(places), _AXIS_NAMES, [palette.NORMAL] * len(places))
    recording.log([entity, "axis names"], axes)


def _strips(
    recording: rr.RecordingStream,
    path: list[object],
    strips: Iterable[ArrayLike],
    color: palette.Color,
    *,
    width: float = _LINE_WIDTH,
) -> None:
    drawn = [_on_screen(np.asarray(strip)) for strip in strips]
    recording.log(path, rr.LineStrips2D(strips_2d(drawn), colors=color, radii=width))


def _on_screen(points: FloatArray) -> FloatArray:
    """Return points with the second coordinate downwards, as rerun's 2D views have it."""
    flipped: FloatArray = points.reshape(-1, 2) * (1.0, -1.0)
    return flipped
