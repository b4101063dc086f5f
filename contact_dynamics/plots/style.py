"""All diagrams share the legend beside them, the lines through zero, and the way into a file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.diagrams.paper import AXIS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DOTS_PER_INCH: Final = 130
"""The resolution of PNG files."""


def legend_beside(axes: Axes, *, columns: int = 1, **options: Any) -> None:
    """Put the legend to the right of the diagram, where it covers nothing.

    Figures with ``layout="compressed"`` leave room for it.
    """
    axes.legend(
        loc="upper left",
        bbox_to_anchor=(1.12 if axes.name == "3d" else 1.02, 1.0),
        borderaxespad=0.0,
        frameon=False,
        fontsize="small",
        ncols=columns,
        **options,
    )


def lines_through_zero(axes: Axes) -> None:
    """Draw the axes of coordinates below everything else."""
    axes.axhline(0.0, color=AXIS, linewidth=1.0, zorder=0.5)
    axes.axvline(0.0, color=AXIS, linewidth=1.0, zorder=0.5)


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
