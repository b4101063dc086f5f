"""The map of contact modes shows which applied wrench brings about which mode (Mason, lecture 26).

Each region of a chart belongs to the modes that its wrenches bring about. In some regions several modes are
consistent (indeterminate), and in some none is (inconsistent).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.diagrams.wrench_chart import (
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
    from contact_dynamics.diagrams.wrench_chart import WrenchChart
    from contact_dynamics.plane.types import PlanarWrench
    from contact_dynamics.validation import FloatArray

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
_WAY_POINTS: Final = 100  # number of points of the way of a wrench that changes


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


class Caption(NamedTuple):
    """Words in a picture.

    Attributes:
        place: (2,), points.
        text: The words.
    """

    place: tuple[float, float]
    text: str


def names_of(regions: ModeRegions) -> list[str]:
    """Return the name of each class of regions: its modes, or that there is none."""
    return ["", "no mode", *(" or ".join(modes) for modes in regions.modes[NO_MODE + 1 :])]


def outlines_of(chart: WrenchChart) -> list[FloatArray]:
    """Return the outline of each part of a chart as a closed strip of places, (k, 2)."""
    half = 0.5 * chart.resolution
    if isinstance(chart, DirectionChart):
        angles = np.linspace(0.0, 2.0 * math.pi, 361)
        outline = half * np.column_stack([np.cos(angles), np.sin(angles)])
    else:
        outline = half * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]])
    return [np.array(part_centre(chart, part)) + outline for part in range(chart.parts)]


def captions_of(chart: WrenchChart) -> list[Caption]:
    """Return the name of each part of a chart, and its place below that part."""
    _, height = picture_size(chart)
    texts = ["torque anticlockwise", "torque clockwise"]
    if isinstance(chart, ForceChart):
        texts = [f"forces up to {chart.half_side:.3g} N, torque {chart.moment:.3g} N m"]
    below = height - 0.75 * gap(chart.resolution)
    return [Caption((part_centre(chart, part)[0], below), texts[part]) for part in range(chart.parts)]


def place_of(chart: WrenchChart, applied: PlanarWrench | None) -> FloatArray | None:
    """Return the places of a wrench, (k, 2), of which a chart may show none, or None without a wrench."""
    start = np.zeros(3) if applied is None else np.array([*applied.f, applied.moment])
    if not start.any():
        return None
    places, part = chart.place(start.reshape(1, 3))
    shown: FloatArray = places[part != HIDDEN]
    return shown


def way_of(chart: WrenchChart, applied: PlanarWrench, change: PlanarWrench | None) -> list[FloatArray]:
    """Return the strips of places, (k, 2) each, through which a wrench goes that changes by ``change``."""
    if change is None:
        return []
    steps = np.outer(np.linspace(0.0, 1.0, _WAY_POINTS), [*change.f, change.moment])
    places, part = chart.place(np.array([*applied.f, applied.moment]) + steps)
    return _shown_pieces(places, part)
