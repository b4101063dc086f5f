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
    """The base of all marks.

    Attributes:
        name: The name of the mark: an entity in rerun, an id in SVG.
        paint: The colour, in the viewer and on paper.
        opacity: Its opacity, 0 to 1. On paper, only faces are translucent.
        legend: What the mark means, for the legend, or an empty string.
        is_obvious: Whether the viewer's legend leaves it out, since its form says what it is.
        on_paper: Whether Matplotlib draws it.
        in_viewer: Whether rerun draws it.
    """

    name: str
    paint: Paint
    _: KW_ONLY
    opacity: float = 1.0
    legend: str = ""
    is_obvious: bool = False
    on_paper: bool = True
    in_viewer: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class Lines(Mark):
    """Line strips.

    Attributes:
        strips: (k, d) each.
        width: Points of the screen or of paper.
        dash: The style, as Matplotlib writes it. The viewer draws solid lines.
    """

    strips: Strips
    _: KW_ONLY
    width: float = 1.2
    dash: str = "-"


@dataclass(frozen=True, slots=True, eq=False)
class Points(Mark):
    """Points with a label each.

    Attributes:
        places: (n, d).
        paints: Their colours in the viewer, (n,), if each has its own.
        size: The diameter, in points of the screen or of paper.
        radius: The radius in the units of the diagram, which replaces the size in the viewer if it is not 0.
        marker: The form, as Matplotlib writes it.
        hollow: Whether paper shows through.
        labels: (n,), or none.
        label_all: Whether all labels are shown. Otherwise, the viewer shows the one under the mouse.
        is_noted: Whether the viewer writes the legend beside the diagram, with a line to the first point.
    """

    places: FloatArray
    _: KW_ONLY
    paints: Sequence[Paint] = ()
    size: float = 8.0
    radius: float = 0.0
    marker: str = "o"
    hollow: bool = False
    labels: Sequence[str] = ()
    label_all: bool = False
    is_noted: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Arrows(Mark):
    """Arrows with a label each.

    Attributes:
        origins: (n, d).
        vectors: (n, d).
        paints: Their colours in the viewer, (n,), if each has its own.
        width: Points of the screen or of paper.
        radius: The radius in the units of the diagram, which replaces the width in the viewer if it is not 0.
        labels: (n,), or none.
        label_all: Whether all labels are shown. Otherwise, the viewer shows the one under the mouse.
    """

    origins: FloatArray
    vectors: FloatArray
    _: KW_ONLY
    paints: Sequence[Paint] = ()
    width: float = 2.0
    radius: float = 0.0
    labels: Sequence[str] = ()
    label_all: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Faces(Mark):
    """Triangles. The viewer draws them in three dimensions only.

    Attributes:
        corners: (n, d).
        triangles: (m, 3), indices into the corners. By default, the corners are those of a convex polygon.
        normals: (n, d), unit, or none.
    """

    corners: FloatArray
    _: KW_ONLY
    triangles: Triangles | None = None
    normals: FloatArray | None = None

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
    """Words at places.

    Attributes:
        places: (n, d), of the middle of each.
        texts: (n,).
        paints: Their colours in the viewer, (n,), if each has its own.
    """

    places: FloatArray
    texts: Sequence[str]
    _: KW_ONLY
    paints: Sequence[Paint] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Ellipsoids(Mark):
    """Ellipsoids of uncertainty, in three dimensions.

    Attributes:
        centers: (n, 3).
        covariances: (n, 3, 3).
        deviations: The half axes in standard deviations, a number or (n,).
    """

    centers: FloatArray
    covariances: FloatArray
    _: KW_ONLY
    deviations: FloatArray | float = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Regions(Mark):
    """Regions of a flat diagram, as a picture of one pixel for each unit, whose rows go down from the top.

    Attributes:
        classes: (h, w), indices into the paints.
        paints: The colour of each class.
        legends: What each class means, for the legend on paper, or an empty string.
    """

    classes: NDArray[np.integer]
    _: KW_ONLY
    paints: Sequence[Paint]
    legends: Sequence[str]


class Axis(NamedTuple):
    """An axis.

    Attributes:
        name: The quantity with its unit.
        low: Where it begins.
        high: Where it ends.
        ticks: Where it has which words, or None for round numbers.
    """

    name: str
    low: float
    high: float
    ticks: tuple[tuple[float, str], ...] | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Diagram:
    """A diagram with two or three axes.

    Attributes:
        marks: What it shows. Later marks cover earlier ones.
        axes: Its axes: to the right and up; or to the right, back and up.
        title: Its title.
        is_equal: Whether all axes have one scale.
    """

    marks: Sequence[Mark]
    axes: tuple[Axis, ...]
    title: str = ""
    is_equal: bool = True


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
