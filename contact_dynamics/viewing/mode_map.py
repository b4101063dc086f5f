"""The map of contact modes over applied wrenches (Mason, lecture 26, "Contact modes for wrench in tray").

Each region of the chart has the colour of the mode that its wrenches bring about, and shows that mode's
string. In white regions several modes are consistent (indeterminate). In black ones none is (inconsistent).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
import rerun as rr

from contact_dynamics.viewing import palette
from contact_dynamics.viewing.entities import MODE_MAP
from contact_dynamics.viewing.wrench_chart import (
    HIDDEN,
    DirectionChart,
    ForceChart,
    gap,
    part_centre,
    picture_size,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from contact_dynamics.contact_modes import PlanarWrenchSet
    from contact_dynamics.plane.types import PlanarWrench
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.viewing.wrench_chart import WrenchChart

OUTSIDE: Final = 0
NO_MODE: Final = 1
"""Classes of the picture's points. The numbers of modes count up from here."""

LIVE_RESOLUTION: Final = 240
"""Number of points on a side. The view of the visualizer shows as many. Such a map takes about 0.1 s to draw.
"""

_NAMED_FROM: Final = 0.045
"""Relative to a part's side. A region in which no circle of this radius fits has no room for its name."""

_SEEN: Final = 5e-3  # difference of unit normals that moves a border by one point
_COARSE: Final = 4  # a step of this many points finds where a region is widest
_EDGE: Final = 1e-9  # relative: what is outside by less is on the boundary
_BORDER_WIDTH: Final = -1.0  # a negative size is in points of the screen
_POINT_SIZE: Final = -5.0
_HOVERED_SIZE: Final = -2.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ModeRegions:
    """Which modes are consistent at each point of a chart.

    Attributes:
        classes: (h, w), indices into ``modes``.
        modes: The consistent modes of each class. OUTSIDE and NO_MODE have none.
    """

    classes: NDArray[np.uint16]
    modes: tuple[tuple[str, ...], ...]


class WidestPlace(NamedTuple):
    """The place at which a region has most room for its name.

    Attributes:
        region: Its class.
        place: (2,), points.
        has_room: Whether the name fits.
    """

    region: int
    place: FloatArray
    has_room: bool


def mode_regions(sets: Sequence[PlanarWrenchSet], chart: WrenchChart) -> ModeRegions:
    """Return the regions of a chart, by the half-spaces of each mode's wrenches."""
    wrenches, shown = chart.wrenches()
    points = wrenches[shown]
    consistent = np.ones((len(sets), len(points)), dtype=bool)
    for i, one in enumerate(sets):
        for side in one.half_spaces:
            consistent[i] &= points @ np.array(side.a) <= side.b
    modes: list[tuple[str, ...]] = [(), ()]
    classes_of = []
    firsts, which = _different_columns(consistent)
    for first in firsts.tolist():
        names = tuple(one.mode for one, holds in zip(sets, consistent[:, first], strict=True) if holds)
        classes_of.append(len(modes) if names else NO_MODE)
        if names:
            modes.append(names)
    classes = np.full(shown.shape, OUTSIDE, dtype=np.uint16)
    classes[shown] = np.array(classes_of, dtype=np.uint16)[which]
    return ModeRegions(classes=classes, modes=tuple(modes))


def draw_mode_map(
    recording: rr.RecordingStream,
    sets: Sequence[PlanarWrenchSet],
    chart: WrenchChart,
    *,
    entity: str = MODE_MAP,
    applied: PlanarWrench | None = None,
    change: PlanarWrench | None = None,
) -> None:
    """Draw the map at the recording's current time.

    Args:
        recording: to draw into.
        sets: the result of `contact_modes.wrench_sets`.
        chart: how wrenches are laid out.
        entity: where the picture is put.
        applied: a wrench to mark.
        change: the least change of the wrench that brings about another mode, drawn as a path from it.
    """
    regions = mode_regions(sets, chart)
    names = ["", "no mode", *(" or ".join(modes) for modes in regions.modes[NO_MODE + 1 :])]
    every = sorted(one.mode for one in sets)
    colors = [palette.BACKGROUND, *(color_of_modes(modes, every) for modes in regions.modes[NO_MODE:])]
    pixels = np.array(colors, dtype=np.uint8)[regions.classes, :3]
    recording.log(f"{entity}/regions", rr.Image(pixels, color_model="RGB", draw_order=-20.0))
    borders = [strip for one in sets for strip in borders_of(one, chart)]
    strips = rr.LineStrips2D(borders, colors=palette.BACKGROUND, radii=_BORDER_WIDTH)
    recording.log(f"{entity}/borders", strips)
    for name, shown in (("names", True), ("small_regions", False)):
        there = [widest for widest in widest_places(regions, chart) if widest.has_room == shown]
        points = rr.Points2D(
            [widest.place for widest in there],
            colors=palette.NORMAL,
            radii=0.0 if shown else _HOVERED_SIZE,
            labels=[names[widest.region] for widest in there],
            show_labels=shown,
        )
        recording.log(f"{entity}/{name}", points)
    notes = []
    if any(len(modes) > 1 for modes in regions.modes):
        notes.append("white: several modes are consistent")
    if (regions.classes == NO_MODE).any():
        notes.append("black: none is")
    draw_frame(recording, chart, entity, note="; ".join(notes))
    draw_applied(recording, chart, entity=entity, applied=applied, change=change)


def look_alike(one: Sequence[PlanarWrenchSet], other: Sequence[PlanarWrenchSet], *, length: float) -> bool:
    """Return whether two maps over directions differ by less than can be seen; ``length`` as in the chart."""
    if [a.mode for a in one] != [b.mode for b in other]:
        return False
    for a, b in zip(one, other, strict=True):
        if len(a.half_spaces) != len(b.half_spaces):
            return False
        if not a.half_spaces:
            continue
        sides = (np.array([side.a for side in each.half_spaces]).reshape(-1, 1, 3) for each in (a, b))
        first, second = (normals * (1.0, 1.0, length) for normals in sides)
        apart = np.abs(first - second.transpose(1, 0, 2)).max(axis=2)
        if max(float(apart.min(axis=0).max()), float(apart.min(axis=1).max())) > _SEEN:
            return False
    return True


def chart_for(
    sets: Sequence[PlanarWrenchSet],
    *,
    length: float,
    applied: PlanarWrench | None,
    resolution: int = LIVE_RESOLUTION,
) -> WrenchChart:
    """Return the chart that suits: all directions for a body at rest, or else forces at the applied torque.

    Args:
        sets: the result of `contact_modes.wrench_sets`.
        length: m, the radius of gyration.
        applied: the wrench in question, if known.
        resolution: points on a side.
    """
    if all(side.b == 0.0 for one in sets for side in one.half_spaces):
        return DirectionChart(length=length, resolution=resolution)
    moment = applied.moment if applied else 0.0
    sizes = [abs(side.b) for one in sets for side in one.half_spaces]
    sizes += [2.0 * math.hypot(*applied.f)] if applied else []
    return ForceChart(moment=moment, half_side=max(sizes) or 1.0, resolution=resolution)


def color_of_modes(consistent: Sequence[str], every: Sequence[str]) -> palette.Color:
    """Return the colour of a region with these consistent modes, of ``every`` mode in alphabetical order."""
    if len(consistent) != 1:
        return palette.UNDECIDED if consistent else palette.NO_MODE
    return palette.mode_color(consistent[0], every.index(consistent[0]))


def borders_of(one: PlanarWrenchSet, chart: WrenchChart) -> list[FloatArray]:
    """Return the boundary of a mode's wrenches as strips of places, (k, 2) each."""
    normals = np.array([side.a for side in one.half_spaces]).reshape(-1, 3)
    offsets = np.array([side.b for side in one.half_spaces])
    strips = []
    for side in one.half_spaces:
        wrenches = chart.boundary(side)
        sizes = np.abs(wrenches) @ np.abs(normals.T) + np.abs(offsets)
        inside = np.all(wrenches @ normals.T - offsets <= _EDGE * sizes, axis=1)
        places, part = chart.place(wrenches)
        strips += _shown_pieces(places, np.where(inside, part, HIDDEN))
    return strips


def widest_places(regions: ModeRegions, chart: WrenchChart) -> list[WidestPlace]:
    """Return the widest place of each region on each part of the chart that it reaches."""
    from scipy.ndimage import distance_transform_edt

    coarse = regions.classes[::_COARSE, ::_COARSE]
    found = []
    for part in range(chart.parts):
        begin = round((part_centre(chart, part)[0] - 0.5 * chart.resolution) / _COARSE) - 1
        end = begin + chart.resolution // _COARSE + 2
        there = coarse[:, begin:end]
        for index in np.unique(there).tolist():
            if index == OUTSIDE:
                continue
            room = distance_transform_edt(np.pad(there == index, 1))[1:-1, 1:-1]
            row, column = np.unravel_index(int(room.argmax()), room.shape)
            found.append(
                WidestPlace(
                    region=index,
                    place=_COARSE * np.array([begin + column + 0.5, row + 0.5]),
                    has_room=bool(room[row, column] * _COARSE >= _NAMED_FROM * chart.resolution),
                )
            )
    return found


def _different_columns(table: NDArray[np.bool_]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the different columns of a table, (m, k), and for each column the index of its like, (k,)."""
    firsts, kinds = np.zeros(min(1, table.shape[1]), dtype=np.int64), np.zeros(table.shape[1], dtype=np.int64)
    for eight in np.packbits(table, axis=0):
        _, firsts, kinds = np.unique(256 * kinds + eight, return_index=True, return_inverse=True)
    return firsts, kinds


def _shown_pieces(places: FloatArray, part: NDArray[np.int64]) -> list[FloatArray]:
    """Return the pieces of a strip, (k, 2), each of which lies on one part of the chart."""
    cuts = np.flatnonzero(np.diff(part)) + 1
    pieces = zip(np.split(places, cuts), np.split(part, cuts), strict=True)
    return [piece for piece, there in pieces if len(piece) > 1 and there[0] != HIDDEN]


def draw_frame(recording: rr.RecordingStream, chart: WrenchChart, entity: str, *, note: str = "") -> None:
    """Draw a chart's outline, the names of its parts below them, and a note above."""
    width, height = picture_size(chart)
    half = 0.5 * chart.resolution
    centres = [np.array(part_centre(chart, part)) for part in range(chart.parts)]
    if isinstance(chart, DirectionChart):
        angles = np.linspace(0.0, 2.0 * math.pi, 361)
        outline = half * np.column_stack([np.cos(angles), np.sin(angles)])
    else:
        outline = half * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]])
    frames = rr.LineStrips2D(
        [centre + outline for centre in centres], colors=palette.NORMAL, radii=_BORDER_WIDTH
    )
    recording.log(f"{entity}/frame", frames)
    texts = ["torque anticlockwise", "torque clockwise"]
    if isinstance(chart, ForceChart):
        texts = [f"forces up to {chart.half_side:.3g} N, torque {chart.moment:.3g} N m"]
    places = [(centre[0], height - 0.75 * gap(chart.resolution)) for centre in centres]
    if note:
        places.append((0.5 * width, -0.3 * gap(chart.resolution)))
        texts.append(note)
    captions = rr.Points2D(places, colors=palette.NORMAL, radii=0.0, labels=texts, show_labels=True)
    recording.log(f"{entity}/captions", captions)


def draw_applied(
    recording: rr.RecordingStream,
    chart: WrenchChart,
    *,
    entity: str = MODE_MAP,
    applied: PlanarWrench | None,
    change: PlanarWrench | None,
) -> None:
    """Mark a wrench on a map, with its least change that brings about another mode as a path from it."""
    start = np.zeros(3) if applied is None else np.array([*applied.f, applied.moment])
    if not start.any():
        recording.log(f"{entity}/applied", rr.Clear(recursive=True))
        return
    places, part = chart.place(start.reshape(1, 3))
    shown = places[part != HIDDEN]
    recording.log(f"{entity}/applied", rr.Points2D(shown, colors=palette.IMPACT, radii=_POINT_SIZE))
    way: list[FloatArray] = []
    if change is not None:
        steps = np.outer(np.linspace(0.0, 1.0, 100), [*change.f, change.moment])
        places, part = chart.place(start + steps)
        way = _shown_pieces(places, part)
    strips = rr.LineStrips2D(way, colors=palette.IMPACT, radii=2.0 * _BORDER_WIDTH)
    recording.log(f"{entity}/applied/way_out", strips)
