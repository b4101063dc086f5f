# SPDX-License-Identifier: Apache-2.0
"""Diagrams as plain data: marks (lines, points, arrows, faces, labels, ellipsoids, regions) between axes.

A diagram is computed once. `viewing.drawing` draws it in rerun and `plots.drawing` with Matplotlib, and
neither computes geometry. Places are rows with two or three coordinates, the second or third upwards.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass, replace
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from contact_dynamics.diagrams.palette import Paint
    from contact_dynamics.validation import FloatArray

Strips: TypeAlias = Sequence["FloatArray"]
Triangles: TypeAlias = "NDArray[np.int64]"

NO_PLACES: Final = np.zeros((0, 2))


@dataclass(frozen=True, slots=True, eq=False)
class Mark:
    """The base of all marks."""

    name: str  # the name of the mark: an entity in rerun, an id in SVG
    paint: Paint  # the colour, in the viewer and on paper
    _: KW_ONLY
    opacity: float = 1.0  # its opacity, 0 to 1. On paper, only faces are translucent.
    legend: str = ""  # what the mark means, for the legend, or an empty string
    is_obvious: bool = False  # whether the viewer's legend leaves it out, since its form says what it is
    on_paper: bool = True  # whether Matplotlib draws it
    in_viewer: bool = True  # whether rerun draws it


@dataclass(frozen=True, slots=True, eq=False)
class Lines(Mark):
    """Line strips."""

    strips: Strips  # (k, d) each
    _: KW_ONLY
    width: float = 1.2  # points of the screen or of paper
    dash: str = "-"  # the style, as Matplotlib writes it. The viewer draws solid lines.


@dataclass(frozen=True, slots=True, eq=False)
class Points(Mark):
    """Points with a label each."""

    places: FloatArray  # (n, d)
    _: KW_ONLY
    paints: Sequence[Paint] = ()  # their colours in the viewer, (n,), if each has its own
    size: float = 8.0  # the diameter, in points of the screen or of paper
    # The radius in the units of the diagram, which replaces the size in the viewer if it is not 0.
    radius: float = 0.0
    marker: str = "o"  # the form, as Matplotlib writes it
    hollow: bool = False  # whether paper shows through
    labels: Sequence[str] = ()  # (n,), or none
    # Whether all labels are shown. Otherwise, the viewer shows the one under the mouse.
    label_all: bool = False
    # Whether the viewer writes the legend beside the diagram, with a line to the first point.
    is_noted: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Arrows(Mark):
    """Arrows with a label each."""

    origins: FloatArray  # (n, d)
    vectors: FloatArray  # (n, d)
    _: KW_ONLY
    paints: Sequence[Paint] = ()  # their colours in the viewer, (n,), if each has its own
    width: float = 2.0  # points of the screen or of paper
    # The radius in the units of the diagram, which replaces the width in the viewer if it is not 0.
    radius: float = 0.0
    labels: Sequence[str] = ()  # (n,), or none
    # Whether all labels are shown. Otherwise, the viewer shows the one under the mouse.
    label_all: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Faces(Mark):
    """Triangles. The viewer draws them in three dimensions only."""

    corners: FloatArray  # (n, d)
    _: KW_ONLY
    # (m, 3), indices into the corners. By default, the corners are those of a convex polygon.
    triangles: Triangles | None = None
    normals: FloatArray | None = None  # (n, d), unit, or none

    @property
    def fan(self) -> Triangles:
        """The triangles, (m, 3)."""
        if self.triangles is not None:
            return self.triangles
        return np.array([[0, i, i + 1] for i in range(1, len(self.corners) - 1)], dtype=np.int64).reshape(
            -1, 3
        )


@dataclass(frozen=True, slots=True, eq=False)
class Labels(Mark):
    """Words at places."""

    places: FloatArray  # (n, d), of the middle of each
    texts: Sequence[str]  # (n,)
    _: KW_ONLY
    paints: Sequence[Paint] = ()  # their colours in the viewer, (n,), if each has its own


@dataclass(frozen=True, slots=True, eq=False)
class Ellipsoids(Mark):
    """Ellipsoids of uncertainty, in three dimensions."""

    centers: FloatArray  # (n, 3)
    covariances: FloatArray  # (n, 3, 3)
    _: KW_ONLY
    deviations: FloatArray | float = 1.0  # the half axes in standard deviations, a number or (n,)


@dataclass(frozen=True, slots=True, eq=False)
class Regions(Mark):
    """Regions of a flat diagram, as a picture of one pixel for each unit, whose rows go down from the top."""

    classes: NDArray[np.integer]  # (h, w), indices into the paints
    _: KW_ONLY
    paints: Sequence[Paint]  # the colour of each class
    legends: Sequence[str]  # what each class means, for the legend on paper, or an empty string


class Axis(NamedTuple):
    """An axis."""

    name: str  # the quantity with its unit
    low: float  # where it begins
    high: float  # where it ends
    ticks: tuple[tuple[float, str], ...] | None = None  # where it has which words, or None for round numbers


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Diagram:
    """A diagram with two or three axes."""

    marks: Sequence[Mark]  # what it shows. Later marks cover earlier ones.
    axes: tuple[Axis, ...]  # its axes: to the right and up; or to the right, back and up
    title: str = ""  # its title
    is_equal: bool = True  # whether all axes have one scale


def mapped(mark: Mark, matrix: FloatArray) -> Mark:
    """Return a mark whose places, (n, d), a matrix, (e, d), has turned or projected.

    Ellipsoids and regions stay as they are.
    """
    match mark:
        case Lines():
            return replace(mark, strips=[strip @ matrix.T for strip in mark.strips])
        case Points() | Labels():
            return replace(mark, places=mark.places @ matrix.T)
        case Arrows():
            return replace(mark, origins=mark.origins @ matrix.T, vectors=mark.vectors @ matrix.T)
        case Faces():
            return replace(mark, corners=mark.corners @ matrix.T)
    return mark


def near_one_another(places: FloatArray, *, within: float) -> list[list[int]]:
    """Return the indices of places, (n, d), grouped by those near the first one of their group."""
    groups: list[list[int]] = []
    for i, place in enumerate(places):
        near = (group for group in groups if np.linalg.norm(places[group[0]] - place) <= within)
        group = next(near, None)
        if group is None:
            groups.append([i])
        else:
            group.append(i)
    return groups
