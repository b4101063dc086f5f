# SPDX-License-Identifier: Apache-2.0
"""In Poinsot's picture the inertia ellipsoid of a free body rolls on the invariable plane (lecture 25).

In the space of angular velocities the ellipsoid w^T I w = 2 T turns with the body about its fixed centre, and
touches the plane at w. Its trace on the ellipsoid is the polhode, its trace on the plane the herpolhode. The
angular momentum points down here, so that the plane lies below.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.diagrams import palette, paper
from contact_dynamics.diagrams.marks import Arrows, Axis, Diagram, Faces, Lines, mapped
from contact_dynamics.diagrams.palette import Paint
from contact_dynamics.numerics.vectors import tangents_near_x
from contact_dynamics.rotations.one import rotation_matrix

if TYPE_CHECKING:
    from contact_dynamics.diagrams.marks import Mark
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.tumbling.poinsot_construction import Poinsot, RollingCurves
    from contact_dynamics.validation import FloatArray

_PLANE_MARGIN: Final = 1.25  # size of the plane, relative to what lies on it
_GRID: Final = 10  # number of lines across the plane in each direction
_BELOW: Final = 0.005  # relative distance by which the plane is too low, not to hide the herpolhode
_NET_POINTS: Final = 73
_MERIDIANS: Final = 8
_PARALLELS: Final = 7

ARROW_RADIUS: Final = 0.02  # relative to the largest semi-axis
_NET: Final = Paint(palette.MEASURED, paper.GREY)
_PLANE: Final = Paint(palette.SURFACE_GRID, paper.AXIS)
_PATCH: Final = Paint(palette.SURFACE, paper.AXIS)
_POLHODE: Final = Paint(palette.POLHODE, paper.ORANGE)
_HERPOLHODE: Final = Paint(palette.HERPOLHODE, paper.BLUE)


def poinsot_axes(picture: Poinsot) -> FloatArray:
    """Return two axes in the plane and the upright one against the angular momentum, (3, 3), unit."""
    down_W = picture.L_W / np.linalg.norm(picture.L_W)
    return np.array([*tangents_near_x(-down_W), -down_W])


def poinsot_marks(picture: Poinsot, curves: RollingCurves) -> list[Mark]:
    """Return ellipsoid, plane, curves and momentum of a body that rotates. There is no plane at rest.

    Marks whose names begin with "body/" are in body axes, the others in world axes.
    """
    unit = float(picture.ellipsoid_semi_axes.max())
    u_W, v_W, up_W = poinsot_axes(picture)
    foot_W = -(1.0 + _BELOW) * picture.invariable_plane_distance * up_W
    reach = float(np.linalg.norm(curves.herpolhode_W - foot_W, axis=1).max(initial=0.0))
    half = _PLANE_MARGIN * max(reach, 0.5 * unit)
    grid_W = [
        foot_W + np.array([s * a - half * b, s * a + half * b])
        for a, b in ((u_W, v_W), (v_W, u_W))
        for s in np.linspace(-half, half, _GRID + 1).tolist()
    ]
    corners_W = foot_W + half * np.array([-u_W - v_W, u_W - v_W, u_W + v_W, v_W - u_W])
    net_B = [strip @ picture.principal_axes_B.T for strip in ellipsoid_net(picture.ellipsoid_semi_axes)]
    return [
        Lines("plane/grid", _PLANE, grid_W, width=0.8, opacity=0.27, legend="invariable plane"),
        Faces("plane/patch", _PATCH, corners_W, opacity=0.27, on_paper=False),
        Lines("body/ellipsoid", _NET, net_B, opacity=0.45, width=0.8, legend="energy ellipsoid"),
        Lines("body/polhode", _POLHODE, [curves.polhode_B], width=2.2, legend="polhode"),
        Lines("herpolhode", _HERPOLHODE, [curves.herpolhode_W], width=2.2, legend="herpolhode"),
        Arrows(
            "momentum",
            Paint(palette.NORMAL, paper.BLACK),
            np.zeros((1, 3)),
            foot_W[None],
            radius=ARROW_RADIUS * unit,
            labels=["angular momentum"],
            legend="direction of the angular momentum",
        ),
    ]


def poinsot_diagram(picture: Poinsot, curves: RollingCurves, state: BodyState) -> Diagram:
    """Return the diagram in the space of angular velocities, rad/s, with the ellipsoid at a state."""
    axes_W, R_WB = poinsot_axes(picture), rotation_matrix(state.q_WB)
    marks = [
        mapped(mark, axes_W @ R_WB if mark.name.startswith("body/") else axes_W)
        for mark in poinsot_marks(picture, curves)
    ]
    marks.append(
        Arrows(
            "angular_velocity",
            Paint(palette.AFTER_IMPACT, paper.RED),
            np.zeros((1, 3)),
            (axes_W @ state.w_WB_W)[None],
            legend="angular velocity",
        )
    )
    places = np.vstack([strip for mark in marks if isinstance(mark, Lines) for strip in mark.strips])
    names = ("in the plane, rad/s", "in the plane, rad/s", "against the momentum, rad/s")
    low, high = places.min(axis=0).tolist(), places.max(axis=0).tolist()
    axes = tuple(Axis(*each) for each in zip(names, low, high, strict=True))
    title = f"rotation: {picture.regime.name.lower().replace('_', ' ')}"
    return Diagram(marks=marks, axes=axes, title=title)


def ellipsoid_net(semi_axes: FloatArray) -> list[FloatArray]:
    """Return meridians and parallels, (k, 3) each, of an ellipsoid about the axes of coordinates."""
    around = np.linspace(0.0, 2.0 * np.pi, _NET_POINTS)
    strips = []
    for longitude in np.linspace(0.0, np.pi, _MERIDIANS, endpoint=False).tolist():
        ring = [np.cos(longitude) * np.sin(around), np.sin(longitude) * np.sin(around), np.cos(around)]
        strips.append(np.column_stack(ring) * semi_axes)
    for latitude in np.linspace(-0.5 * np.pi, 0.5 * np.pi, _PARALLELS + 2)[1:-1].tolist():
        level = np.full(_NET_POINTS, np.sin(latitude))
        ring = [np.cos(latitude) * np.cos(around), np.cos(latitude) * np.sin(around), level]
        strips.append(np.column_stack(ring) * semi_axes)
    return strips
