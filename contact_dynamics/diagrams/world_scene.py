# SPDX-License-Identifier: Apache-2.0
"""The surfaces, as patches of ground, and the shapes of the bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.diagrams import palette, paper
from contact_dynamics.diagrams.marks import Arrows, Faces, Labels, Lines, Points
from contact_dynamics.diagrams.palette import Paint
from contact_dynamics.diagrams.shape import convex_shape, part_above, solid
from contact_dynamics.numerics.vectors import tangents_near_x

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.diagrams.marks import Mark
    from contact_dynamics.diagrams.shape import Shape
    from contact_dynamics.shapes.obstacle import Obstacle
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Surface

GRID_SPACING: Final = 0.1
"""m. The distance of the lines on a surface. It is ten times wider, and so on, if there would be more than
`MAX_GRID_LINES` lines."""

MAX_GRID_LINES: Final = 100

_OPACITY: Final = palette.SURFACE[3] / 255
_EDGE_WIDTH: Final = 1.875
_GRID_WIDTH: Final = 0.75

_ARROWS_AT: Final = (-0.4, 0.0, 0.4)  # relative to half the side
_LONGEST: Final = 0.1  # relative to the side

_PATCH: Final = Paint(palette.SURFACE, paper.AXIS)
_GRID: Final = Paint(palette.SURFACE_GRID, paper.AXIS)
_NAME: Final = Paint(palette.NORMAL, paper.BLACK)
_AT_ORIGIN: Final = (np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]))


def surface_marks(
    surface: Surface, *, center_W: FloatArray, side: float, among: Sequence[Surface] = ()
) -> list[Mark]:
    """Return a square of a surface with that side, m, about the point nearest to ``center_W``, (3,), m.

    It ends where it meets the surfaces that it is ``among``. Arrows show how a surface moves: the longest is
    a tenth of the side, whatever the speed, which their labels tell.
    """
    others = [other for other in among if float(np.linalg.norm(np.cross(other.normal_W, surface.normal_W)))]
    p_W = center_W - float(surface.gaps(center_W)) * surface.normal_W
    u_W, v_W = (0.5 * side * tangent for tangent in tangents_near_x(surface.normal_W))
    corners = _clipped(p_W + np.array([-u_W - v_W, u_W - v_W, u_W + v_W, v_W - u_W]), others)
    if len(corners) < 3:
        return []
    spacing = GRID_SPACING
    while side / spacing > MAX_GRID_LINES:
        spacing *= 10.0
    places = np.minimum(np.arange(-1.0, 1.0 + spacing / side, 2.0 * spacing / side), 1.0)
    whole = [
        p_W + np.array([a * s - b, a * s + b]) for a, b in ((u_W, v_W), (v_W, u_W)) for s in places.tolist()
    ]
    lines = [line[:2] for line in (_clipped(line, others) for line in whole) if len(line) > 1]
    normals = np.tile(surface.normal_W, (len(corners), 1))
    marks: list[Mark] = [
        Faces("patch", _PATCH, corners, normals=normals, opacity=_OPACITY),
        Lines("grid", _GRID, lines, width=_GRID_WIDTH, opacity=_OPACITY),
    ]
    if surface.moves:
        places = p_W + np.array([a * u_W + b * v_W for a in _ARROWS_AT for b in _ARROWS_AT])
        places = places[[all(float(other.gaps(place)) >= 0.0 for other in others) for place in places]]
        velocities, _ = surface.motion_at(places)
        speeds = np.linalg.norm(velocities, axis=1)
        vectors = velocities * (_LONGEST * side / max(float(speeds.max(initial=0.0)), np.finfo(float).tiny))
        labels = [f"{speed:.3g} m/s" for speed in speeds.tolist()]
        marks.append(Arrows("motion", _GRID, places, vectors, width=_EDGE_WIDTH, labels=labels))
    return marks


def _clipped(corners_W: FloatArray, others: Sequence[Surface]) -> FloatArray:
    """Return the corners of the part of a convex polygon or line, (n, 3), m, that is above other surfaces."""
    for other in others:
        corners_W = part_above(corners_W, other.gaps(corners_W))
    return corners_W


def obstacle_marks(obstacle: Obstacle) -> list[Mark]:
    """Return a convex piece of the world."""
    shape = convex_shape(obstacle.vertices_W)
    return [
        solid(shape, "patch", _PATCH, *_AT_ORIGIN, opacity=_OPACITY),
        Lines("grid", _GRID, list(shape.edges_B), width=_EDGE_WIDTH, opacity=_OPACITY),
    ]


def body_marks(
    shape: Shape,
    *,
    color: palette.Color = palette.MEASURED,
    edges: palette.Color = palette.MEASURED_EDGE,
    name: str = "",
) -> list[Mark]:
    """Return a body's shape in its own axes, and its name, if one is given. One without shape is a ball."""
    paint = Paint(color, paper.GREY)
    marks: list[Mark] = [solid(shape, "faces", paint, *_AT_ORIGIN)] if len(shape.triangles_B) else []
    if len(shape.edges_B):
        marks.append(Lines("edges", Paint(edges, paper.GREY), list(shape.edges_B), width=_EDGE_WIDTH))
    else:
        marks.append(Points("faces", paint, np.zeros((1, 3)), radius=0.5 * shape.size))
    if name:
        marks.append(Labels("name", _NAME, np.zeros((1, 3)), [name]))
    return marks
