"""Draws an impact in space in impulse space with all three components.

`contact_dynamics.diagrams.impulse_space_in_3d` says what it shows. The picture is drawn to the scale at which
it reaches from -1 to 1, so that the same eye suits every impact; its labels give the impulses.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.diagrams.impulse_space import EVENTS
from contact_dynamics.diagrams.impulse_space_in_3d import impulse_space_in_3d_of
from contact_dynamics.viewing import palette
from contact_dynamics.viewing.entities import IMPULSE_SPACE_IN_3D
from contact_dynamics.viewing.strips import strips_3d

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.diagrams.impulse_space_in_3d import ImpulseSpaceIn3D
    from contact_dynamics.questions.impact_answer import ImpactAnswer
    from contact_dynamics.rigid_body.body import MassProperties
    from contact_dynamics.validation import FloatArray

_LINE_WIDTH: Final = -1.2  # a negative size is in points of the screen
_CONE_WIDTH: Final = -0.6
_PATH_WIDTH: Final = -2.5
_POINT_SIZE: Final = -5.0
_CLEAR: Final = 0.15  # opacity of the compression plane
_BESIDE: Final = 1.0  # distance of the events' labels from the normal, relative to the picture's extent
_APART: Final = 0.16  # least distance of labels from each other, relative to the picture's extent
_ON_CONE: Final = 0.6  # where the cone has its name, relative to its height, on the side without labels
_AXES: Final = (
    ("along the tangential impulse, N s", (1.0, 0.0, 0.0)),
    ("across, N s", (0.0, 1.0, 0.0)),
    ("normal impulse, N s", (0.0, 0.0, 1.0)),
)


def draw_impulse_space_in_3d(
    recording: rr.RecordingStream,
    mass_properties: MassProperties | None,
    answer: ImpactAnswer,
    *,
    other: MassProperties | None = None,
    entity: str = IMPULSE_SPACE_IN_3D,
) -> None:
    """Draw the impulse path of an impact's main contact, at the recording's current time.

    Args:
        recording: To draw into.
        mass_properties: Those of the body. If they are None, sticking line and compression plane are missing.
        answer: The impact.
        other: Mass properties of the body that is struck. Without them both are missing for two bodies.
        entity: The origin of the view. The picture is put below it, since a view does not scale its origin.
    """
    space = impulse_space_in_3d_of(mass_properties, answer, other=other)
    extent, entity = space.extent, f"{entity}/contact"
    recording.log(entity, rr.Transform3D(scale=1.0 / extent))
    axes = [extent * np.array([(0.0, 0.0, 0.0), end]) for _, end in _AXES]
    _strips(recording, f"{entity}/axes", axes, palette.SURFACE_GRID)
    cone_color = palette.translucent(palette.FRICTION_CONE, 0.8)
    _strips(recording, f"{entity}/friction_cone", space.cone, cone_color, width=_CONE_WIDTH)
    sticking = [space.sticking] if len(space.sticking) > 0 else []
    _strips(recording, f"{entity}/sticking_line", sticking, palette.STICKING_LINE)
    _draw_compression(recording, f"{entity}/compression_plane", space.compression_in_view)
    path = [space.path] if len(space.path) > 1 else []
    _strips(recording, f"{entity}/path", path, palette.IMPACT, width=_PATH_WIDTH)
    dots = rr.Points3D(space.points, colors=palette.IMPACT, radii=_POINT_SIZE)
    recording.log(f"{entity}/events", dots)
    _draw_event_labels(recording, entity, space)
    _draw_names(recording, entity, space)


def _draw_compression(recording: rr.RecordingStream, path: str, corners: FloatArray) -> None:
    if len(corners) == 0:
        recording.log(path, rr.Clear(recursive=True))
        return
    border = np.vstack([corners, corners[:1]])
    _strips(recording, f"{path}/border", [border], palette.COMPRESSION_LINE)
    patch = rr.Mesh3D(
        vertex_positions=corners,
        triangle_indices=[[0, i, i + 1] for i in range(1, len(corners) - 1)],
        albedo_factor=palette.translucent(palette.COMPRESSION_LINE, _CLEAR),
    )
    recording.log(f"{path}/patch", patch)


def _draw_event_labels(recording: rr.RecordingStream, entity: str, space: ImpulseSpaceIn3D) -> None:
    """Write what happens at each dot beside the picture, at the dots' heights as far as those are apart."""
    places = space.points * (0.0, 0.0, 1.0) + (_BESIDE * space.extent, 0.0, 0.0)
    order = np.argsort(places[:, 2], kind="stable").tolist()
    for lower, higher in pairwise(order):
        places[higher, 2] = max(places[higher, 2], places[lower, 2] + _APART * space.extent)
    leaders = list(np.stack([space.points, places], axis=1))
    faint = palette.translucent(palette.IMPACT, 0.5)
    _strips(recording, f"{entity}/leaders", leaders, faint, width=_CONE_WIDTH)
    smallest = 1e-9 * space.extent  # what is below is rounding
    texts = [
        f"{EVENTS[event]}: ({', '.join(f'{x if abs(x) > smallest else 0.0:.3g}' for x in point)}) N s"
        for event, point in zip(space.events, space.points.tolist(), strict=True)
    ]
    recording.log(f"{entity}/event_labels", _words(places, texts, [palette.IMPACT] * len(texts)))


def _draw_names(recording: rr.RecordingStream, entity: str, space: ImpulseSpaceIn3D) -> None:
    named: list[tuple[str, FloatArray, palette.Color]] = [
        (name, 1.08 * space.extent * np.array(end), palette.NORMAL) for name, end in _AXES
    ]
    aside = min((strip[-1] for strip in space.cone), key=lambda end: float(end[0]))
    named.append(("friction cone", _ON_CONE * aside, palette.FRICTION_CONE))
    if len(space.sticking) > 0:
        named.append(("sticking line", space.sticking[-1], palette.STICKING_LINE))
    if len(plane := space.compression_in_view) > 0:
        named.append(("compression plane", plane[0], palette.COMPRESSION_LINE))
    texts, places, colors = zip(*named, strict=True)
    recording.log(f"{entity}/names", _words(np.array(places), texts, colors))


def _words(places: FloatArray, texts: Sequence[str], colors: Sequence[palette.Color]) -> rr.Points3D:
    readable = [palette.readable(color) for color in colors]
    return rr.Points3D(places, colors=readable, radii=0.0, labels=list(texts), show_labels=bool(texts))


def _strips(
    recording: rr.RecordingStream,
    path: str,
    strips: Sequence[FloatArray],
    color: palette.Color,
    *,
    width: float = _LINE_WIDTH,
) -> None:
    recording.log(path, rr.LineStrips3D(strips_3d(strips), colors=color, radii=width))
