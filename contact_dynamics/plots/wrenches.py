"""Draws the map of modes and the force dual over applied wrenches.

`contact_dynamics.diagrams.wrench_chart` says how wrenches are laid out.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.diagrams import paper as colors
from contact_dynamics.diagrams.force_dual import force_dual_of
from contact_dynamics.diagrams.mode_map import (
    NO_MODE,
    OUTSIDE,
    borders_of,
    captions_of,
    mode_regions,
    names_of,
    outlines_of,
    place_of,
    way_of,
    widest_places,
)
from contact_dynamics.diagrams.wrench_chart import (
    DirectionChart,
    ForceChart,
    ForceDualChart,
    gap,
    part_centre,
    picture_size,
)
from contact_dynamics.plots.style import legend_beside

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from contact_dynamics.contact_modes import PlanarWrenchSet
    from contact_dynamics.diagrams.force_dual import Dots
    from contact_dynamics.diagrams.wrench_chart import WrenchChart
    from contact_dynamics.plane.types import PlanarContact, PlanarWrench
    from contact_dynamics.validation import FloatArray

_DIRECTIONS: Final = "direction from the middle: direction of the force; middle: pure torque; rim: pure force"
_ROWS: Final = 18  # entries of a legend in one column
_DIGITS: Final = 9  # after the point; what is smaller is rounding of forces that cancel
_NEAR: Final = 0.02  # dots nearer than this share a label, relative to a part's side
_REGION: Final = "#d9e8f5"  # the blue of a mode's wrenches, light enough for dots and lines on it


def draw_mode_map(
    axes: Axes,
    sets: Sequence[PlanarWrenchSet],
    chart: WrenchChart,
    *,
    applied: PlanarWrench | None = None,
    change: PlanarWrench | None = None,
) -> None:
    """Draw which applied wrench brings about which mode.

    Args:
        axes: The axes to draw into.
        sets: The result of `contact_modes.wrench_sets`.
        chart: How wrenches are laid out.
        applied: A wrench to mark.
        change: The least change of the wrench that brings about another mode, drawn as a path from it.
    """
    from matplotlib.collections import LineCollection
    from matplotlib.patches import Patch

    regions = mode_regions(sets, chart)
    names = names_of(regions)
    fills = _fills(regions.modes, [one.mode for one in sets])
    _show(axes, fills, regions.classes, chart)
    borders = [strip for one in sets for strip in borders_of(one, chart)]
    axes.add_collection(LineCollection(borders, colors=colors.BLACK, linewidths=0.5, gid="borders"))
    for widest in widest_places(regions, chart):
        if widest.has_room and len(regions.modes[widest.region]) == 1:
            words, fill = names[widest.region], fills[widest.region]
            color = colors.SEVERAL if fill in colors.DARK else colors.BLACK
            x, y = widest.place.tolist()
            axes.text(x, y, words, color=color, ha="center", va="center", fontsize="x-small")
    there = [region for region in np.unique(regions.classes).tolist() if region != OUTSIDE]
    entries: list[Artist] = [
        Patch(facecolor=fills[region], edgecolor=colors.BLACK, linewidth=0.5, label=names[region])
        for region in there
    ]
    marked = place_of(chart, applied)
    if applied is not None and marked is not None:
        f_x, f_y, moment = (round(number, _DIGITS) + 0.0 for number in (*applied.f, applied.moment))
        label = f"applied: ({f_x:.3g}, {f_y:.3g}) N, {moment:.3g} N m"
        (dot,) = axes.plot(*marked.T, color=colors.MARK, marker="o", linestyle="", label=label, gid="applied")
        entries.append(dot)
        for i, piece in enumerate(way_of(chart, applied, change)):
            (line,) = axes.plot(*piece.T, color=colors.MARK, linewidth=1.8, label="least way to another mode")
            entries += [line] if i == 0 else []
    _frame(axes, chart)
    axes.set_title("which applied wrench brings about which mode")
    legend_beside(axes, columns=1 + (len(entries) - 1) // _ROWS, handles=entries)


def draw_force_dual(
    axes: Axes,
    one: PlanarWrenchSet,
    contacts: Sequence[PlanarContact],
    chart: ForceDualChart,
    *,
    outlines: Sequence[FloatArray] = (),
) -> None:
    """Draw lecture 26's construction for one mode of a body at rest: centres, force duals, what they span.

    Args:
        axes: The axes to draw into.
        one: The mode's applied wrenches, of `contact_modes.wrench_sets`.
        contacts: All contacts, in the order of the mode's letters.
        chart: How much of the plane to show.
        outlines: Strips, (k, 2) each, m from the centre of mass, drawn below: the body, walls.
    """
    from matplotlib.collections import LineCollection
    from matplotlib.patches import Patch

    figure = force_dual_of(one, contacts, chart, outlines=outlines)
    _show(axes, [colors.SEVERAL, _REGION], figure.inside.astype(np.int64), chart)
    axes.add_collection(LineCollection(figure.outlines, colors=colors.GREY, linewidths=1.0, gid="outlines"))
    axes.add_collection(LineCollection(figure.borders, colors=colors.BLUE, linewidths=1.0, gid="borders"))
    entries: list[Artist] = [
        Patch(facecolor=_REGION, edgecolor=colors.BLUE, label=f"wrenches that can bring about {one.mode}"),
        axes.plot([], [], color=colors.GREY, label="the body, drawn in both halves")[0],
    ]
    for name, dots, color, label in (
        ("contact_forces", figure.contact_forces, colors.PURPLE, "-c: edge of contact's cone, negated"),
        ("acceleration_centres", figure.acceleration_centres, colors.ORANGE, "a: centre of an acceleration"),
    ):
        if not dots.labels:
            continue
        (drawn,) = axes.plot(*dots.places.T, color=color, marker="o", linestyle="", label=label, gid=name)
        entries.append(drawn)
        _name_dots(axes, dots, chart)
    _frame(axes, chart)
    axes.set_title(f"{one.mode}: acceleration centres and force duals")
    legend_beside(axes, handles=entries)


def _fills(classes: Sequence[tuple[str, ...]], modes: Sequence[str]) -> list[str]:
    """Return the colour of each class of regions."""
    every = sorted(modes)
    fills = [colors.SEVERAL] * len(classes)
    for i, consistent in enumerate(classes):
        if i == NO_MODE:
            fills[i] = colors.NONE
        elif len(consistent) == 1:
            fills[i] = colors.MODES[every.index(consistent[0]) % len(colors.MODES)]
    return fills


def _show(axes: Axes, fills: Sequence[str], classes: NDArray[np.integer], chart: WrenchChart) -> None:
    """Fill each point of the chart with the colour of its class."""
    from matplotlib.colors import to_rgb

    pixels = np.array([to_rgb(fill) for fill in fills])[classes]
    width, height = picture_size(chart)
    axes.imshow(pixels, extent=(0.0, width, height, 0.0), interpolation="nearest", zorder=0.0)


def _frame(axes: Axes, chart: WrenchChart) -> None:
    """Draw the outlines of the chart's parts, their names, and scales for lengths or forces."""
    for outline in outlines_of(chart):
        axes.plot(*outline.T, color=colors.BLACK, linewidth=0.8)
    width, height = picture_size(chart)
    around = gap(chart.resolution)
    axes.set_xlim(0.5 * around, width - 0.5 * around)
    axes.set_ylim(height - 0.5 * around, 0.5 * around)
    axes.set_frame_on(False)
    if isinstance(chart, DirectionChart):
        axes.set_xticks([part_centre(chart, part)[0] for part in range(chart.parts)])
        axes.set_xticklabels([caption.text for caption in captions_of(chart)])
        axes.set_yticks([])
        axes.tick_params(length=0.0)
        axes.set_xlabel(_DIRECTIONS)
        return
    half = 0.5 * chart.resolution
    centres = [part_centre(chart, part) for part in range(chart.parts)]
    if isinstance(chart, ForceChart):
        middle, side, names = (0.0, 0.0), chart.half_side, ("force to the right, N", "force up, N")
        texts = [f"torque {chart.moment:.3g} N m"]
    elif isinstance(chart, ForceDualChart):
        middle, side = chart.centre, chart.half_side
        names = ("right of the centre of mass, m", "above the centre of mass, m")
        texts = [caption.text for caption in captions_of(chart)]
    for (x, y), text in zip(centres, texts, strict=True):
        axes.text(x, y - 1.03 * half, text, ha="center", va="bottom", fontsize="small")
    steps = (-0.75, 0.0, 0.75)
    axes.set_xticks([x + step * half for x, _ in centres for step in steps])
    axes.set_xticklabels([f"{middle[0] + step * side:.3g}" for _ in centres for step in steps])
    axes.set_yticks([centres[0][1] - step * half for step in steps])
    axes.set_yticklabels([f"{middle[1] + step * side:.3g}" for step in steps])
    axes.set_xlabel(names[0])
    axes.set_ylabel(names[1])


def _name_dots(axes: Axes, dots: Dots, chart: WrenchChart) -> None:
    """Write the labels beside dots. Dots at one place share a label."""
    groups: list[list[int]] = []
    for i, place in enumerate(dots.places):
        near = (g for g in groups if np.linalg.norm(dots.places[g[0]] - place) < _NEAR * chart.resolution)
        group = next(near, None)
        if group is None:
            groups.append([i])
        else:
            group.append(i)
    for group in groups:
        text = ", ".join(dict.fromkeys(dots.labels[i] for i in group))
        axes.annotate(
            text,
            tuple(dots.places[group[0]].tolist()),
            (4.0, 4.0),
            textcoords="offset points",
            fontsize="small",
        )
