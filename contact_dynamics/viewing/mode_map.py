"""Draws the map of contact modes over applied wrenches (Mason, lecture 26, "wrench in tray").

Each region of the chart has the colour of the mode that its wrenches bring about, and shows that mode's
string. In white regions several modes are consistent (indeterminate). In black ones none is (inconsistent).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.mode_map import (
    NO_MODE,
    borders_of,
    captions_of,
    mode_regions,
    names_of,
    outlines_of,
    place_of,
    way_of,
    widest_places,
)
from contact_dynamics.diagrams.wrench_chart import gap, picture_size
from contact_dynamics.viewing.entities import MODE_MAP
from contact_dynamics.viewing.strips import strips_2d
from contact_dynamics.viewing.words import room_2d, words_2d

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes import PlanarWrenchSet
    from contact_dynamics.diagrams.wrench_chart import WrenchChart
    from contact_dynamics.plane.types import PlanarWrench

_BORDER_WIDTH: Final = -1.0  # a negative size is in points of the screen
_POINT_SIZE: Final = -5.0
_HOVERED_SIZE: Final = -2.0
_BELOW: Final = 0.12  # room for the names below a chart, relative to the side of its parts


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
    names = names_of(regions)
    every = sorted(one.mode for one in sets)
    colors = [palette.BACKGROUND, *(color_of_modes(modes, every) for modes in regions.modes[NO_MODE:])]
    pixels = np.array(colors, dtype=np.uint8)[regions.classes, :3]
    recording.log(f"{entity}/regions", rr.Image(pixels, color_model="RGB", draw_order=-20.0))
    borders = [strip for one in sets for strip in borders_of(one, chart)]
    strips = rr.LineStrips2D(strips_2d(borders), colors=palette.BACKGROUND, radii=_BORDER_WIDTH)
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


def color_of_modes(consistent: Sequence[str], every: Sequence[str]) -> palette.Color:
    """Return the colour of a region with these consistent modes, of ``every`` mode in alphabetical order."""
    if len(consistent) != 1:
        return palette.UNDECIDED if consistent else palette.NO_MODE
    return palette.mode_color(consistent[0], every.index(consistent[0]))


def bounds(chart: WrenchChart) -> rrb.VisualBounds2D:
    """Return the bounds of a view that shows a whole chart and a note above it."""
    width, height = picture_size(chart)
    return rrb.VisualBounds2D(x_range=(0.0, width), y_range=(-gap(chart.resolution), height))


def draw_frame(recording: rr.RecordingStream, chart: WrenchChart, entity: str, *, note: str = "") -> None:
    """Draw a chart's outline, the names of its parts below them, and a note above."""
    frames = rr.LineStrips2D(strips_2d(outlines_of(chart)), colors=palette.NORMAL, radii=_BORDER_WIDTH)
    recording.log(f"{entity}/frame", frames)
    captions = captions_of(chart)
    places, texts = [caption.place for caption in captions], [caption.text for caption in captions]
    if note:
        places.append((0.5 * picture_size(chart)[0], -gap(chart.resolution)))
        texts.append(note)
    words = words_2d(np.array(places), texts, [palette.NORMAL] * len(texts))
    recording.log(f"{entity}/captions", words)
    width, height = picture_size(chart)
    corners = np.array([(0.0, -1.6 * gap(chart.resolution)), (width, height + _BELOW * chart.resolution)])
    recording.log(f"{entity}/room", room_2d(corners))


def draw_applied(
    recording: rr.RecordingStream,
    chart: WrenchChart,
    *,
    entity: str = MODE_MAP,
    applied: PlanarWrench | None,
    change: PlanarWrench | None,
) -> None:
    """Mark a wrench on a map, with its least change that brings about another mode as a path from it."""
    shown = place_of(chart, applied)
    if applied is None or shown is None:
        recording.log(f"{entity}/applied", rr.Clear(recursive=True))
        return
    recording.log(f"{entity}/applied", rr.Points2D(shown, colors=palette.IMPACT, radii=_POINT_SIZE))
    way = way_of(chart, applied, change)
    strips = rr.LineStrips2D(strips_2d(way), colors=palette.IMPACT, radii=2.0 * _BORDER_WIDTH)
    recording.log(f"{entity}/applied/way_out", strips)
