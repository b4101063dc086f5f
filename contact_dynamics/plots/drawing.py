# SPDX-License-Identifier: Apache-2.0
"""Draws diagrams and their marks with Matplotlib, and writes figures into files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.diagrams.marks import Arrows, Faces, Labels, Lines, Points, Regions, mapped
from contact_dynamics.diagrams.paper import AXIS, BLACK

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from contact_dynamics.diagrams.marks import Diagram, Mark
    from contact_dynamics.validation import FloatArray

DOTS_PER_INCH: Final = 130  # the resolution of PNG files
_ROOM: Final = 8.0  # points between the numbers of an axis in three dimensions and its name
_TICKS: Final = 4  # numbers on each axis there, few enough not to cover each other
_ROWS: Final = 18  # entries of a legend in one column
_LIGHTER: Final = 0.8  # widths on paper, relative to those in the viewer


def draw_diagram(axes: Any, diagram: Diagram, *, title: str | None = None) -> None:
    """Draw a diagram.

    Args:
        axes: The axes to draw into. In three dimensions, ``figure.add_subplot(projection="3d")`` makes them.
        diagram: The diagram.
        title: Its title, which is the diagram's own by default.
    """
    in_space = len(diagram.axes) == 3
    names = "xyz"[: len(diagram.axes)]
    if not in_space:
        for name, line in zip(names, (axes.axvline, axes.axhline), strict=True):
            axis = diagram.axes["xy".index(name)]
            if diagram.is_equal and axis.ticks is None and axis.low < 0.0 < axis.high:
                line(0.0, color=AXIS, linewidth=1.0, zorder=0.5)
    draw_marks(axes, diagram.marks)
    for name, axis in zip(names, diagram.axes, strict=True):
        getattr(axes, f"set_{name}lim")(axis.low, axis.high)
        getattr(axes, f"set_{name}label")(axis.name, **({"labelpad": _ROOM} if in_space else {}))
        if axis.ticks is not None:
            getattr(axes, f"set_{name}ticks")(
                [x for x, _ in axis.ticks], labels=[text for _, text in axis.ticks]
            )
    if any(axis.ticks is not None for axis in diagram.axes):  # a picture with a frame of its own
        axes.set_frame_on(False)
        axes.tick_params(length=0.0)
    if in_space:
        axes.locator_params(nbins=_TICKS)
        axes.view_init(elev=20.0, azim=-60.0)
    if diagram.is_equal:
        axes.set_aspect("equal")
    else:
        axes.grid(visible=True, color=AXIS, linewidth=0.6)
    axes.set_title(diagram.title if title is None else title)
    _legend_beside(axes)


def draw_seen(axes: Axes, marks: Sequence[Mark], *, across: str, up: str) -> None:
    """Draw marks in space, m, seen along one of the world's axes: two others go to the right and up."""
    matrix = np.eye(3)[["xyz".index(across), "xyz".index(up)]]
    draw_marks(axes, [mapped(mark, matrix) for mark in marks])
    axes.set_xlabel(f"{across}, m")
    axes.set_ylabel(f"{up}, m")
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_axisbelow(True)
    axes.grid(visible=True, color=AXIS, linewidth=0.6)
    _legend_beside(axes)


def _legend_beside(axes: Axes) -> None:
    """Put the legend to the right of the diagram, where it covers nothing.

    Figures with ``layout="compressed"`` leave room for it.
    """
    entries = len(axes.get_legend_handles_labels()[0])
    axes.legend(
        loc="upper left",
        bbox_to_anchor=(1.12 if axes.name == "3d" else 1.02, 1.0),
        borderaxespad=0.0,
        frameon=False,
        fontsize="small",
        ncols=1 + (entries - 1) // _ROWS,
    )


def save_figure(figure: Figure, path: Path | str) -> None:
    """Write a figure into a file, in the format that its name ends with.

    Words stay words in SVG, so that they can be searched and read aloud, and the same figure gives the same
    file.
    """
    from matplotlib import rc_context

    path = Path(path)
    options = {"metadata": {"Date": None}} if path.suffix == ".svg" else {"dpi": DOTS_PER_INCH}
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": path.name}):
        figure.savefig(path, **options)


def draw_marks(axes: Any, marks: Sequence[Mark]) -> None:
    """Draw marks, later ones above earlier ones."""
    for i, mark in enumerate(marks):
        if mark.on_paper:
            common = {"zorder": 1.0 + i / len(marks), "gid": mark.name, "label": mark.legend or None}
            _draw(axes, mark, common)


def _draw(axes: Any, mark: Mark, common: dict[str, Any]) -> None:  # noqa: C901  one case for each kind
    color, options = mark.paint.paper, dict[str, Any]()
    match mark:
        case Lines() if len(mark.strips) > 0:
            axes.plot(
                *_joined(mark.strips).T,
                color=color,
                linewidth=_LIGHTER * mark.width,
                linestyle=mark.dash,
                **common,
            )
        case Points() if len(mark.places) > 0:
            axes.plot(
                *mark.places.T,
                color=color,
                linestyle="",
                marker=mark.marker,
                markersize=mark.size,
                markerfacecolor="white" if mark.hollow else color,
                markeredgecolor=color if mark.hollow else BLACK,
                markeredgewidth=1.0 if mark.hollow else 0.6,
                **common,
            )
        case Arrows() if len(mark.origins) > 0:
            options = {"arrow_length_ratio": 0.08, "linewidth": 1.8}
            if mark.origins.shape[1] == 2:
                options = {"angles": "xy", "scale_units": "xy", "scale": 1.0, "width": 0.004 * mark.width}
            axes.quiver(*mark.origins.T, *mark.vectors.T, color=color, **options, **common)
        case Faces() if len(mark.fan) > 0:
            options = {"color": color, "alpha": mark.opacity, "linewidth": 0.0}
            if mark.corners.shape[1] == 3:
                axes.plot_trisurf(*mark.corners.T, triangles=mark.fan, shade=False, **options, **common)
                return
            from matplotlib.collections import PolyCollection

            polygons = [mark.corners] if mark.triangles is None else list(mark.corners[mark.fan])
            axes.add_collection(PolyCollection(polygons, **options, **common))
        case Regions():
            from matplotlib.colors import to_rgb
            from matplotlib.patches import Rectangle

            pixels = np.array([to_rgb(paint.paper) for paint in mark.paints])[mark.classes]
            height, width = mark.classes.shape
            axes.imshow(pixels, extent=(0.0, width, -height, 0.0), interpolation="nearest", zorder=0.0)
            for paint, legend in zip(mark.paints, mark.legends, strict=True):
                if legend:
                    entry = Rectangle(
                        (0, 0), 0, 0, facecolor=paint.paper, edgecolor=BLACK, linewidth=0.5, label=legend
                    )
                    axes.add_patch(entry)
        case Labels():
            for place, text in zip(mark.places.tolist(), mark.texts, strict=True):
                axes.text(*place, text, color=color, ha="center", va="center", fontsize="small", zorder=4.0)


def _joined(strips: Sequence[FloatArray]) -> FloatArray:
    """Return strips as one, (k, d), with gaps."""
    gap = np.full((1, strips[0].shape[1]), np.nan)
    joined: FloatArray = np.vstack([part for strip in strips for part in (strip, gap)][:-1])
    return joined
