# SPDX-License-Identifier: Apache-2.0
"""The map of contact modes assigns modes to applied wrenches (Mason, lecture 26).

Each region of a chart belongs to the modes that its wrenches bring about. In some regions several modes are
consistent (indeterminate), and in some none is (inconsistent).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.diagrams import palette, paper
from contact_dynamics.diagrams.marks import NO_PLACES, Axis, Diagram, Labels, Lines, Points, Regions
from contact_dynamics.diagrams.palette import Paint
from contact_dynamics.diagrams.wrench_chart import (
    HIDDEN,
    DirectionChart,
    ForceChart,
    ForceDualChart,
    gap,
    part_centre,
    picture_size,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from contact_dynamics.contact_modes import PlanarWrenchSet
    from contact_dynamics.diagrams.marks import Mark
    from contact_dynamics.diagrams.wrench_chart import WrenchChart
    from contact_dynamics.plane.types import PlanarWrench
    from contact_dynamics.validation import FloatArray

OUTSIDE: Final = 0
NO_MODE: Final = 1  # classes of the picture's points; the numbers of modes count up from here

LIVE_RESOLUTION: Final = 240
"""Number of points on a side. The view of the visualizer shows as many. Such a map takes about 0.1 s to draw.
"""

_NAMED_FROM: Final = 0.045
"""Relative to a part's side. A region in which no circle of this radius fits has no room for its name."""

_NAME: Final = (0.07, 0.19)
"""Width of a letter and height of a name in the viewer, relative to a part's side. Paper has more room."""

_SEEN: Final = 5e-3  # difference of unit normals that moves a border by one point
_COARSE: Final = 4  # a step of this many points finds where a region is widest
_EDGE: Final = 1e-9  # relative: what is outside by less is on the boundary
_WAY_POINTS: Final = 100  # number of points of the way of a wrench that changes
_DIGITS: Final = 9  # after the point; what is smaller is rounding of forces that cancel
_DIRECTIONS: Final = "angle: direction of the force; middle: pure torque"

_WAY: Final = ";\nline: smallest change\nto another mode"

_LINE: Final = Paint(palette.NORMAL, paper.BLACK)
_GROUND: Final = Paint(palette.BACKGROUND, paper.SEVERAL)
_BORDER: Final = Paint(palette.BACKGROUND, paper.BLACK)
_NONE: Final = Paint(palette.NO_MODE, paper.NONE)
_APPLIED: Final = Paint(palette.IMPACT, paper.MARK)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ModeRegions:
    """Which modes are consistent at each point of a chart."""

    classes: NDArray[np.uint16]  # (h, w), indices into ``modes``
    modes: tuple[tuple[str, ...], ...]  # the consistent modes of each class. OUTSIDE and NO_MODE have none.


@dataclass(frozen=True, slots=True, eq=False)
class WidestPlace:
    """The place at which a region has most room for its name."""

    region: int  # its class
    place: FloatArray  # (2,), points
    room: float  # radius of the largest circle that fits, relative to a part's side


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

    The radius of gyration is ``length``, m, and the chart has ``resolution`` points on a side.
    """
    if all(side.b == 0.0 for one in sets for side in one.half_spaces):
        return DirectionChart(length=length, resolution=resolution)
    moment = applied.moment if applied else 0.0
    sizes = [abs(side.b) for one in sets for side in one.half_spaces]
    sizes += [2.0 * math.hypot(*applied.f)] if applied else []
    return ForceChart(moment=moment, half_side=max(sizes) or 1.0, resolution=resolution)


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
                    place=_COARSE * np.array([begin + column + 0.5, -row - 0.5]),
                    room=float(room[row, column]) * _COARSE / chart.resolution,
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


def mode_map(
    sets: Sequence[PlanarWrenchSet],
    chart: WrenchChart,
    *,
    applied: PlanarWrench | None = None,
    change: PlanarWrench | None = None,
) -> Diagram:
    """Return the map. Each region has the colour of the mode that its wrenches bring about.

    Args:
        sets: The result of `contact_modes.wrench_sets`.
        chart: How wrenches are laid out.
        applied: A wrench to mark.
        change: The least change of the wrench that brings about another mode, drawn as a path from it.
    """
    regions = mode_regions(sets, chart)
    names = ["", "no mode", *(" or ".join(modes) for modes in regions.modes[NO_MODE + 1 :])]
    every = sorted(one.mode for one in sets)
    paints = [_GROUND, *(paint_of_modes(modes, every) for modes in regions.modes[NO_MODE:])]
    there = np.unique(regions.classes).tolist()
    marks: list[Mark] = [
        Regions(
            "regions",
            _LINE,
            regions.classes,
            paints=paints,
            legends=[name if i in there else "" for i, name in enumerate(names)],
        ),
        Lines("borders", _BORDER, [s for one in sets for s in borders_of(one, chart)], width=0.6),
    ]
    widest = widest_places(regions, chart)
    named = [one for one in widest if one.room >= _NAMED_FROM]
    alone = [one for one in named if len(regions.modes[one.region]) == 1]
    dark = [one for one in alone if paints[one.region].paper in paper.DARK]
    readable = _apart(named, names, chart)
    small = [one for one in widest if one not in readable]

    def texts(some: Sequence[WidestPlace]) -> tuple[FloatArray, list[str]]:
        return np.reshape([one.place for one in some], (-1, 2)), [names[one.region] for one in some]

    on_dark = Paint(palette.NORMAL, paper.SEVERAL)
    marks += [
        Labels("names", _LINE, *texts(readable), on_paper=False),
        Labels("names_on_light", _LINE, *texts([one for one in alone if one not in dark]), in_viewer=False),
        Labels("names_on_dark", on_dark, *texts(dark), in_viewer=False),
    ]
    places, labels = texts(small)
    marks.append(Points("small_regions", _LINE, places, size=3.0, labels=labels, on_paper=False))
    title = "contact modes by applied wrench"
    title += "; white: several" * any(len(modes) > 1 for modes in regions.modes)
    title += "; black: none" * (NO_MODE in there)
    frame, axes = chart_frame(chart)
    return Diagram(marks=[*marks, *frame, *applied_marks(chart, applied, change)], axes=axes, title=title)


def _apart(places: list[WidestPlace], names: Sequence[str], chart: WrenchChart) -> list[WidestPlace]:
    """Return the places whose names cover none of a wider region in the viewer."""
    chosen: list[WidestPlace] = []
    for one in sorted(places, key=lambda each: -each.room):
        for other in chosen:
            across, up = np.abs(one.place - other.place) / chart.resolution
            letters = 0.5 * (len(names[one.region]) + len(names[other.region]))
            if across < letters * _NAME[0] and up < _NAME[1]:
                break
        else:
            chosen.append(one)
    return chosen


def paint_of_modes(consistent: Sequence[str], every: Sequence[str]) -> Paint:
    """Return the colour of a region with these consistent modes, of ``every`` mode in alphabetical order."""
    if len(consistent) != 1:
        return Paint(palette.UNDECIDED, paper.SEVERAL) if consistent else _NONE
    index = every.index(consistent[0])
    return Paint(palette.mode_color(consistent[0], index), paper.MODES[index % len(paper.MODES)])


def applied_marks(
    chart: WrenchChart, applied: PlanarWrench | None, change: PlanarWrench | None
) -> list[Mark]:
    """Return the mark of a wrench, which a chart may not show, and its way to another mode."""
    places = way = None
    if applied is not None and any((*applied.f, applied.moment)):
        start = np.array([*applied.f, applied.moment])
        found, part = chart.place(start[None])
        places = found[part != HIDDEN]
        if change is not None:
            steps = np.outer(np.linspace(0.0, 1.0, _WAY_POINTS), [*change.f, change.moment])
            way = _shown_pieces(*chart.place(start + steps))
    numbers = (0.0,) * 3 if applied is None else (*applied.f, applied.moment)
    f_x, f_y, moment = (round(number, _DIGITS) + 0.0 for number in numbers)
    return [
        Lines("applied/way_out", _APPLIED, way or [], width=2.2),
        Points(
            "applied",
            _APPLIED,
            NO_PLACES if places is None else places,
            legend=f"applied: ({f_x:.3g}, {f_y:.3g}) N,\n{moment:.3g} N m" + (_WAY if way else ""),
            is_noted=True,
        ),
    ]


def chart_frame(chart: WrenchChart) -> tuple[list[Mark], tuple[Axis, ...]]:
    """Return the outlines of a chart's parts with their names, and its axes."""
    width, height = picture_size(chart)
    half, margin = 0.5 * chart.resolution, 0.5 * gap(chart.resolution)
    centres = [part_centre(chart, part) for part in range(chart.parts)]
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]])
    texts = ["torque anticlockwise", "torque clockwise"]
    middle, side, names = (0.0, 0.0), 1.0, (_DIRECTIONS, "")
    if isinstance(chart, DirectionChart):
        angles = np.linspace(0.0, 2.0 * math.pi, 361)
        corners = np.column_stack([np.cos(angles), np.sin(angles)])
    elif isinstance(chart, ForceChart):
        side, names = chart.half_side, ("force to the right, N", "force up, N")
        texts = [f"torque {chart.moment:.3g} N m"]
    elif isinstance(chart, ForceDualChart):
        middle, side = chart.centre, chart.half_side
        names = ("right of the centre of mass, m", "above the centre of mass, m")
    across, upward = (
        tuple((x, text) for (x, _), text in zip(centres, texts, strict=False)),
        tuple[tuple[float, str], ...](),
    )
    captions: list[Mark] = []
    if not isinstance(chart, DirectionChart):
        steps = (-0.75, 0.0, 0.75)
        words = [(step * half, f"{middle[0] + step * side:.3g}") for step in steps]
        across = tuple((x + place, text) for x, _ in centres for place, text in words)
        upward = tuple((centres[0][1] + step * half, f"{middle[1] + step * side:.3g}") for step in steps)
        above = np.array(centres) + np.array([0.0, half + 0.4 * margin])
        captions = [Labels("captions", _LINE, above, texts)]
    outlines = [np.array(centre) + half * corners for centre in centres]
    return [Lines("outline", _LINE, outlines), *captions], (
        Axis(names[0], margin, width - margin, across),
        Axis(names[1], margin - height, -margin, upward),
    )
