# SPDX-License-Identifier: Apache-2.0
"""Draws diagrams and their marks in rerun, at the recording's current time.

rerun has neither axes nor legends for spatial views, so the axes with their numbers are drawn with the
diagram. The legend is a column on the left; labels of points are a column on the right, with lines to the
points, so that they do not overlap. The room for text is estimated, since the viewer does not fit a view to
text; it suits a panel that is 300 points high with its title, and is more than enough for a larger one.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np
import rerun as rr

from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.marks import Arrows, Ellipsoids, Faces, Labels, Lines, Points, Regions, mapped
from contact_dynamics.viewing.columns import strips_2d, strips_3d

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from contact_dynamics.diagrams.marks import Axis, Diagram, Mark
    from contact_dynamics.validation import FloatArray

_THICK: Final = 0.8  # radius of a line of width 1, in points of the screen
_LARGE: Final = 0.6  # radius of a point of size 1, in points of the screen
_FRAME_WIDTH: Final = 1.0
_LEADER_WIDTH: Final = 0.8
_TICKS: Final = 4  # maximum number of ticks on an axis
_NO_COLOR: Final = (0, 0, 0, 0)

_PANEL: Final = (400.0, 275.0)  # points: the width of the axes, and the height of the axes with their words
_LETTER: Final = 6.4  # points, width of a letter
_LINE: Final = 23.0  # points, line spacing
_DROP: Final = 12.0  # points from the anchor of a text down to its middle
_FURTHER: Final = 7.5  # the same, for each further line
_BELOW: Final = 2.8  # lines below the axes, with numbers and a name

EYE: Final = np.array([0.8, -1.7, 1.07])

TARGET: Final = np.array([0.0, 0.0, 0.32])
"""The place of the eye that sees a diagram in three dimensions with its words, and where it looks."""
_SPACE: Final = 115.0  # points, the height of a diagram in three dimensions
_RIGHT: Final = np.array([0.906, 0.423, 0.0])  # screen axes of the eye there


def draw_diagram(recording: rr.RecordingStream, diagram: Diagram, entity: str) -> None:
    """Draw a diagram at an entity, in place of its earlier contents."""
    recording.log(entity, rr.Clear(recursive=True))
    _draw_all(recording, diagram.marks, diagram, entity)


def draw_side_by_side(
    recording: rr.RecordingStream, diagrams: Sequence[Diagram], entity: str, *, name: str
) -> None:
    """Draw flat diagrams side by side in one view, numbered from 1, with the legend of the first."""
    recording.log(entity, rr.Clear(recursive=True))
    pages = [_page_of(diagram) for diagram in diagrams]
    point = max(sum(page.width for page in pages) / _PANEL[0], *(page.point for page in pages))
    shift = 0.0
    for i, (diagram, page) in enumerate(zip(diagrams, pages, strict=True)):
        here = f"{entity}/{name}_{i + 1}"
        draw_marks(recording, diagram.marks, here, shift=shift, point=point)
        frame = _frame_of(diagram, page._replace(point=point), has_legend=i == 0)
        draw_marks(recording, frame, f"{here}/frame", shift=shift, point=point)
        room = _LETTER * max(map(len, diagram.title.splitlines()), default=0)
        shift += max(page.width, point * room) + point * 60.0


def redraw(recording: rr.RecordingStream, diagram: Diagram, entity: str, part: str) -> None:
    """Redraw the marks of a flat diagram whose names have a prefix, with the axes and labels."""
    for cleared in (f"{entity}/{part}", f"{entity}/frame"):
        recording.log(cleared, rr.Clear(recursive=True))
    _draw_all(recording, [mark for mark in diagram.marks if mark.name.startswith(part)], diagram, entity)


def _draw_all(recording: rr.RecordingStream, marks: Sequence[Mark], diagram: Diagram, entity: str) -> None:
    """Draw marks of a diagram, with its axes and labels.

    In three dimensions, the upright axis is drawn with length 1, so that the same eye suits every diagram.
    rerun's viewer ignores a transform at the time at which the previous one is cleared.
    """
    page = _page_of(diagram)
    frame, point = _frame_of(diagram, page), page.point
    if len(diagram.axes) == 3:
        scaled, point = np.eye(3) / page.height, point / page.height
        marks, frame = ([mapped(mark, scaled) for mark in each] for each in (marks, frame))
    draw_marks(recording, marks, entity, point=point)
    draw_marks(recording, frame, f"{entity}/frame", point=point)


def draw_marks(
    recording: rr.RecordingStream,
    marks: Iterable[Mark],
    entity: str,
    *,
    shift: float = 0.0,
    point: float = 0.0,
) -> None:
    """Draw each mark at its name below ``entity``, and clear the entities of empty ones.

    In the plane, they are shifted to the right by ``shift``. The viewer writes text below its anchor; if
    ``point``, the size of a point of the screen, is given, labels are raised accordingly.
    """
    for mark in marks:
        if mark.in_viewer:
            drawn = _drawn(_lifted(mark, point), shift)
            recording.log(f"{entity}/{mark.name}", drawn or rr.Clear(recursive=False))


def parts_of(marks: Iterable[Mark]) -> dict[str, Any]:
    """Return rerun's archetypes for marks, by their names."""
    return {mark.name: drawn for mark in marks if (drawn := _drawn(mark, 0.0)) is not None}


def _lifted(mark: Mark, point: float) -> Mark:
    if not isinstance(mark, Labels) or len(mark.places) == 0:
        return mark
    lines = np.array([text.count("\n") for text in mark.texts])
    up = np.eye(mark.places.shape[1])[-1]
    return replace(mark, places=mark.places + point * np.outer(_DROP + _FURTHER * lines, up))


def _drawn(mark: Mark, shift: float) -> rr.AsComponents | None:  # noqa: PLR0911  one for each kind
    """Return rerun's archetype, or None for an empty mark."""
    color = palette.translucent(mark.paint.dark, mark.opacity)
    paints = mark.paints if isinstance(mark, Points | Arrows | Labels) else ()
    colors = [palette.translucent(paint.dark, mark.opacity) for paint in paints] or color
    match mark:
        case Lines():
            strips = [_on_screen(strip, shift) for strip in mark.strips if len(strip) > 0]
            return _strips(strips, color, -_THICK * mark.width)
        case Points() if len(mark.places) > 0:
            options: dict[str, Any] = {
                "colors": colors,
                "radii": mark.radius or -_LARGE * mark.size,
                "labels": list(mark.labels) or None,
                "show_labels": mark.label_all if mark.labels else None,
            }
            flat = mark.places.shape[1] == 2
            return (rr.Points2D if flat else rr.Points3D)(_on_screen(mark.places, shift), **options)
        case Arrows() if len(mark.origins) > 0:
            options = {
                "vectors": _on_screen(mark.vectors),
                "origins": _on_screen(mark.origins, shift),
                "colors": colors,
                "radii": mark.radius or -_THICK * mark.width,
                "labels": list(mark.labels) or None,
                "show_labels": mark.label_all if mark.labels else None,
            }
            return (rr.Arrows2D if mark.origins.shape[1] == 2 else rr.Arrows3D)(**options)
        case Faces() if len(mark.fan) > 0 and mark.corners.shape[1] == 3:
            return rr.Mesh3D(
                vertex_positions=mark.corners,
                triangle_indices=mark.fan,
                vertex_normals=mark.normals,
                albedo_factor=color,
            )
        case Labels() if len(mark.texts) > 0:
            darks = [paint.dark for paint in paints] or [mark.paint.dark] * len(mark.texts)
            return words(_on_screen(mark.places, shift), mark.texts, darks)
        case Ellipsoids() if len(mark.centers) > 0:
            from scipy.spatial.transform import Rotation

            variances, axes = np.linalg.eigh(mark.covariances)
            right_handed = axes * np.linalg.det(axes)[:, None, None]
            sizes = np.reshape(mark.deviations, (-1, 1)) * np.sqrt(np.maximum(variances, 0.0))
            turns = Rotation.from_matrix(right_handed).as_quat()
            return rr.Ellipsoids3D(
                centers=mark.centers,
                half_sizes=sizes,
                quaternions=[rr.Quaternion(xyzw=turn) for turn in turns],
                colors=color,
                line_radii=-_THICK,
                fill_mode=rr.components.FillMode.MajorWireframe,
            )
        case Regions():
            pixels = np.array([paint.dark[:3] for paint in mark.paints], dtype=np.uint8)[mark.classes]
            return rr.Image(pixels, color_model="RGB", draw_order=-20.0)
    return None


def _strips(strips: Sequence[FloatArray], color: palette.Color, radius: float) -> rr.AsComponents | None:
    if not strips:
        return None
    if strips[0].shape[1] == 2:
        return rr.LineStrips2D(strips_2d(strips), colors=color, radii=radius)
    return rr.LineStrips3D(strips_3d(strips), colors=color, radii=radius)


def words(places: FloatArray, texts: Sequence[str], colors: Sequence[palette.Color]) -> rr.AsComponents:
    """Return texts at places, (n, d), in the coordinates of rerun's views.

    In the plane they are labels of lines of zero length; the viewer would leave more room around points.
    """
    readable = [palette.readable(color) for color in colors]
    if places.shape[1] == 3:
        return rr.Points3D(places, colors=readable, radii=0.0, labels=list(texts), show_labels=True)
    strips = strips_2d([np.array([place, place]) for place in places])
    return rr.LineStrips2D(strips, colors=readable, radii=0.0, labels=list(texts), show_labels=True)


def _on_screen(places: FloatArray, shift: float = 0.0) -> FloatArray:
    """Return places in the coordinates of rerun's views: in the plane, the second coordinate points down."""
    if places.shape[1] == 3:
        return places
    flipped: FloatArray = (places + np.array([shift, 0.0])) * (1.0, -1.0)
    return flipped


class _Page(NamedTuple):
    """Screen coordinates for the labels of a diagram."""

    point: float  # one point of the screen, in the units of the diagram
    right: FloatArray  # (d,), unit, to the right on the screen
    up: FloatArray  # (d,), unit
    low: FloatArray  # (d,), the lower left corner of the area between the axes, as seen
    width: float  # to the right of this corner
    height: float  # above it

    def at(self, right: float, up: float) -> FloatArray:
        """Return the place at an offset, in points, to the right of the lower left corner and above it."""
        place: FloatArray = self.low + self.point * (right * self.right + up * self.up)
        return place

    def height_of(self, place: FloatArray) -> float:
        """Return the height of a place above the lower left corner, in points."""
        return float((place - self.low) @ self.up) / self.point


def _page_of(diagram: Diagram) -> _Page:
    axes = diagram.axes
    low, high = np.array([axis.low for axis in axes]), np.array([axis.high for axis in axes])
    if len(axes) == 2:
        width, height = (high - low).tolist()
        lines = _BELOW + 1.0 + bool(axes[1].name) + (diagram.title.count("\n") + 1 if diagram.title else 0)
        point = max(width / _PANEL[0], height / (_PANEL[1] - _LINE * lines))
        return _Page(point, np.array([1.0, 0.0]), np.array([0.0, 1.0]), low, width, height)
    half = 0.5 * float(np.abs(_RIGHT) @ (high - low))
    middle = 0.5 * (low + high) * (1.0, 1.0, 0.0) + low * (0.0, 0.0, 1.0)
    height = float(high[2] - low[2])
    corner = middle - half * _RIGHT
    return _Page(height / _SPACE, _RIGHT, np.array([0.0, 0.0, 1.0]), corner, 2.0 * half, height)


def _frame_of(diagram: Diagram, page: _Page, *, has_legend: bool = True) -> list[Mark]:
    """Return the axes with their numbers and names, the title, the legend, and the labels of points."""
    marks = _axes_of(diagram.axes, page)
    top, across = page.height / page.point, page.width / page.point
    name = diagram.axes[-1].name
    room = [page.at(0.0, top), page.at(0.0, -_BELOW * _LINE), page.at(across, -_BELOW * _LINE)]
    title = [(0.0, top + _LINE, name)] if name else []
    if diagram.title and len(diagram.axes) == 2:
        lines = diagram.title.count("\n") + 1
        title.append((0.5 * across, top + (0.5 + 0.5 * lines + len(title)) * _LINE, diagram.title))
    places = [page.at(right, up) for right, up, _ in title]
    marks.append(
        Labels("title", _WHITE, np.reshape(places, (-1, len(diagram.axes))), [text for *_, text in title])
    )
    room += [page.at(right, up + _LINE) for right, up, _ in title]
    shown = [mark for mark in diagram.marks if has_legend and mark.legend and mark.in_viewer]
    noted = [mark for mark in shown if isinstance(mark, Points) and mark.is_noted and len(mark.places) > 0]
    legend = [mark for mark in shown if not (mark.is_obvious or (isinstance(mark, Points) and mark.is_noted))]
    nearer = 0.13 * across if len(diagram.axes) == 3 else 0.0  # the upright axis is, and so farther left
    aside, up = -0.5 * _widest(legend) - 7.0 * _LETTER - 8.0 - nearer, top
    for mark in legend:
        lines = mark.legend.count("\n")
        place = page.at(aside, up - 0.4 * lines * _LINE)
        marks.append(Labels(f"legend/{mark.name}", mark.paint, place[None], [mark.legend]))
        up -= (1.0 + 0.8 * lines) * _LINE
        room += [page.at(aside - 0.5 * _widest(legend), 0.0), page.at(aside, up)]
    return [*marks, *_notes_of(noted, page, room), _room(room)]


_WHITE: Final = palette.Paint(palette.NORMAL, "")
_GREY: Final = palette.Paint(palette.SURFACE_GRID, "")


def _widest(marks: Sequence[Mark]) -> float:
    """Return the width of the widest legend, in points of the screen."""
    lines = [line for mark in marks for line in mark.legend.splitlines()]
    return _LETTER * max(map(len, lines), default=0) + 10.0


def _room(places: Sequence[FloatArray]) -> Mark:
    """Return invisible lines of zero length that reserve room for text in the view."""
    strips = [np.array([place, place]) for place in places]
    return Lines("room", palette.Paint(_NO_COLOR, ""), strips, opacity=0.0, width=0.0)


def _notes_of(noted: list[Points], page: _Page, room: list[FloatArray]) -> list[Mark]:
    """Return the labels of points on the right, each near the height of its point, without overlap."""
    noted.sort(key=lambda mark: page.height_of(mark.places[0]))
    across = page.width / page.point
    left = across + 14.0 + (0.1 * across if len(page.low) == 3 else 0.0)
    middle = left + 0.5 * _widest(noted)
    marks: list[Mark] = []
    lines = [len(mark.legend.splitlines()) for mark in noted]
    rooms = [(0.4 + 0.7 * count) * _LINE for count in lines]
    heights = [
        max(page.height_of(mark.places[0]), 0.5 * space) for mark, space in zip(noted, rooms, strict=True)
    ]
    for i in range(1, len(noted)):  # upwards, as far as needed
        heights[i] = max(heights[i], heights[i - 1] + 0.5 * (rooms[i - 1] + rooms[i]))
    above = page.height / page.point
    for i in reversed(range(len(noted))):  # and down again, to stay beside the diagram
        heights[i] = min(heights[i], above)
        above = heights[i] - 0.5 * (rooms[i] + rooms[max(i - 1, 0)])
    for mark, up in zip(noted, heights, strict=True):
        place = page.at(middle, up)
        leader = np.array([mark.places[0], page.at(left, up)])
        marks += [
            Labels(f"notes/{mark.name}", mark.paint, place[None], [mark.legend]),
            Lines(f"leaders/{mark.name}", mark.paint, [leader], opacity=0.5, width=_LEADER_WIDTH),
        ]
        room.append(page.at(2.0 * middle - left, up + _LINE))
    return marks


def _axes_of(axes: tuple[Axis, ...], page: _Page) -> list[Mark]:
    """Return the axes, with numbers and the names of those that lie flat."""
    low = np.array([axis.low for axis in axes])
    corners = [low] * 2
    if len(axes) == 3:
        corners = [low, np.array([axes[0].high, low[1], low[2]]), low]
    strips, places, texts = [], [], []
    for i, (axis, corner) in enumerate(zip(axes, corners, strict=True)):
        along = np.eye(len(axes))[i]
        if axis.ticks is None:  # others are pictures with their own frame
            strips.append(np.array([corner, corner + (axis.high - axis.low) * along]))
        # Names are below the first axis, right of one that recedes, and left of the upright one.
        side = (0.0, 1.0, -1.0)[i] if len(axes) == 3 else (0.0, -1.0)[i]
        tick = side * page.right if side else -page.up
        ticks = _round_numbers(axis.low, axis.high) if axis.ticks is None else axis.ticks
        named = [] if i == len(axes) - 1 or not axis.name else [(0.5 * (axis.low + axis.high), axis.name)]
        for number, text in (*ticks, *named):
            place = corner + (number - axis.low) * along
            beside = side * (0.5 * _LETTER * len(text) + 10.0)
            below = 0.0 if side else _DROP
            if text == axis.name:
                beside, below = (beside + 40.0, below) if side else (-0.5 * _LETTER * len(text), 1.6 * _LINE)
                beside = beside if len(axes) == 3 else 0.0
            elif axis.ticks is None:
                strips.append(np.array([place, place + 4.0 * page.point * tick]))
            places.append(place + page.point * (beside * page.right - below * page.up))
            texts.append(text)
    return [
        Lines("axes", _GREY, strips, width=_FRAME_WIDTH),
        Labels("numbers", _WHITE, np.array(places).reshape(-1, len(axes)), texts),
    ]


def _round_numbers(low: float, high: float) -> list[tuple[float, str]]:
    """Return at most `_TICKS` round numbers between two limits, with their texts."""
    rough = (high - low) / _TICKS
    power = 10.0 ** np.floor(np.log10(rough))
    step = next(power * each for each in (1.0, 2.0, 2.5, 5.0, 10.0) if power * each >= rough)
    first, last = int(np.ceil(low / step)), int(np.floor(high / step))
    return [(float(k * step), f"{k * step:.6g}") for k in range(first, last + 1)]
