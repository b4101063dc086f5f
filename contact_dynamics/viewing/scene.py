# SPDX-License-Identifier: Apache-2.0
"""Draws what stands still or is drawn once: surfaces as patches of ground, and the shapes of the bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.shape import convex_shape, part_above
from contact_dynamics.numerics.vectors import tangents_near_x
from contact_dynamics.viewing.entities import SCENE, SURFACES, entity, trail_entity
from contact_dynamics.viewing.strips import strips_3d

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.diagrams.shape import Shape
    from contact_dynamics.shapes.obstacle import Obstacle
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.viewing.scenery import Part
    from contact_dynamics.world import Surface

GRID_SPACING: Final = 0.1
"""m. The distance of the lines on a surface. It is ten times wider, and so on, if there would be more than
`MAX_GRID_LINES` lines."""

MAX_GRID_LINES: Final = 100

_EDGE_WIDTH: Final = -1.5  # a negative size is in points of the screen
_GRID_WIDTH: Final = -0.6
_TRAIL_WIDTH: Final = -1.5


def draw_axes(recording: rr.RecordingStream, up_W: FloatArray) -> None:
    """Tell the viewer which of the world's axes is nearest to up."""
    axis = int(np.abs(up_W).argmax())
    names = ("RIGHT_HAND_X", "RIGHT_HAND_Y", "RIGHT_HAND_Z")
    sign = "UP" if up_W[axis] > 0.0 else "DOWN"
    recording.log(SCENE, getattr(rr.ViewCoordinates, f"{names[axis]}_{sign}"), static=True)


def surface_path(name: str) -> str:
    """Return where a surface is drawn."""
    return entity(SURFACES, name)


def surface_parts(
    surface: Surface, *, center_W: FloatArray, side: float, among: Sequence[Surface] = ()
) -> dict[str, Part]:
    """Return a square of a surface with that side, m, about the point nearest to ``center_W``, (3,), m.

    It ends where it meets the surfaces that it is ``among``.
    """
    others = [other for other in among if float(np.linalg.norm(np.cross(other.normal_W, surface.normal_W)))]
    p_W = center_W - float(surface.gaps(center_W)) * surface.normal_W
    u_W, v_W = (0.5 * side * tangent for tangent in tangents_near_x(surface.normal_W))
    corners = _clipped(p_W + np.array([-u_W - v_W, u_W - v_W, u_W + v_W, v_W - u_W]), others)
    if len(corners) < 3:
        return {}
    patch = rr.Mesh3D(
        vertex_positions=corners,
        triangle_indices=[[0, i, i + 1] for i in range(1, len(corners) - 1)],
        vertex_normals=np.tile(surface.normal_W, (len(corners), 1)),
        albedo_factor=palette.SURFACE,
    )
    spacing = GRID_SPACING
    while side / spacing > MAX_GRID_LINES:
        spacing *= 10.0
    places = np.arange(-1.0, 1.0 + spacing / side, 2.0 * spacing / side)
    whole = [
        p_W + np.array([a * s - b, a * s + b]) for a, b in ((u_W, v_W), (v_W, u_W)) for s in places.tolist()
    ]
    lines = [line[:2] for line in (_clipped(line, others) for line in whole) if len(line) > 1]
    return {
        "patch": patch,
        "grid": rr.LineStrips3D(strips_3d(lines), colors=palette.SURFACE_GRID, radii=_GRID_WIDTH),
    }


def _clipped(corners_W: FloatArray, others: Sequence[Surface]) -> FloatArray:
    """Return the corners of the part of a convex polygon or line, (n, 3), m, that is above other surfaces."""
    for other in others:
        corners_W = part_above(corners_W, other.gaps(corners_W))
    return corners_W


def obstacle_parts(obstacle: Obstacle) -> dict[str, Part]:
    """Return a convex piece of the world."""
    shape = convex_shape(obstacle.vertices_W)
    return {
        "patch": solid(shape, palette.SURFACE),
        "grid": rr.LineStrips3D(strips_3d(shape.edges_B), colors=palette.SURFACE_GRID, radii=_EDGE_WIDTH),
    }


def body_parts(shape: Shape, *, color: palette.Color = palette.MEASURED, name: str = "") -> dict[str, Part]:
    """Return a body's shape, which moves with the body's pose, and its name, if one is given.

    A body without shape is a ball.
    """
    parts: dict[str, Part] = {}
    if len(shape.triangles_B) > 0:
        parts["faces"] = solid(shape, color)
    if len(shape.edges_B) > 0:
        edges = list(shape.edges_B)
        parts["edges"] = rr.LineStrips3D(strips_3d(edges), colors=palette.MEASURED_EDGE, radii=_EDGE_WIDTH)
    else:
        parts["faces"] = rr.Points3D([[0.0, 0.0, 0.0]], radii=0.5 * shape.size, colors=color)
    if name:
        parts["name"] = rr.Points3D(
            [[0.0, 0.0, 0.0]], radii=0.0, colors=palette.NORMAL, labels=[name], show_labels=True
        )
    return parts


def draw_trail_style(
    recording: rr.RecordingStream, body_name: str, color: palette.Color = palette.MEASURED
) -> None:
    """Tell the viewer how the trail of a body looks."""
    trail = rr.LineStrips3D.from_fields(colors=palette.translucent(color, 0.9), radii=_TRAIL_WIDTH)
    recording.log(trail_entity(body_name), trail, static=True)


def solid(shape: Shape, color: palette.Color) -> rr.Mesh3D:
    """Return the faces of a shape, in body axes."""
    return rr.Mesh3D(
        vertex_positions=shape.triangles_B.reshape(-1, 3),
        triangle_indices=np.arange(3 * len(shape.triangles_B)).reshape(-1, 3),
        vertex_normals=np.repeat(shape.normals_B, 3, axis=0),
        albedo_factor=color,
    )
