"""In Poinsot's picture the inertia ellipsoid of a free body rolls on the invariable plane (lecture 25).

In the space of angular velocities the ellipsoid w^T I w = 2 T turns with the body about its fixed centre, and
touches the plane at w. Its trace on the ellipsoid is the polhode, its trace on the plane the herpolhode. The
angular momentum points down here, so that the plane lies below.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.numerics.vectors import tangents_near_x

if TYPE_CHECKING:
    from contact_dynamics.tumbling.poinsot_construction import Poinsot, RollingCurves
    from contact_dynamics.validation import FloatArray

_PLANE_MARGIN: Final = 1.25  # size of the plane, relative to what lies on it
_GRID: Final = 10  # number of lines across the plane in each direction
_BELOW: Final = 0.005  # relative distance by which the plane is too low, not to hide the herpolhode
_NET_POINTS: Final = 73
_MERIDIANS: Final = 8
_PARALLELS: Final = 7


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PoinsotFigure:
    """Ellipsoid and plane in the space of angular velocities, rad/s.

    Attributes:
        axes_W: (3, 3), unit, whose rows are two axes in the plane and the one against the angular momentum,
            which points up in the picture.
        unit: The largest semi-axis.
        net_B: Meridians and parallels of the ellipsoid, (k, 3) each, body axes.
        foot_W: (3,), where the angular momentum meets the drawn plane.
        grid_W: Lines on the plane, (2, 3) each.
        corners_W: (4, 3), of the plane.
    """

    axes_W: FloatArray
    unit: float
    net_B: list[FloatArray]
    foot_W: FloatArray
    grid_W: list[FloatArray]
    corners_W: FloatArray


def poinsot_figure(picture: Poinsot, curves: RollingCurves) -> PoinsotFigure:
    """Return ellipsoid and plane of a body that rotates. There is no plane at rest."""
    unit = float(picture.ellipsoid_semi_axes.max())
    down_W = picture.L_W / np.linalg.norm(picture.L_W)
    u_W, v_W = tangents_near_x(-down_W)
    foot_W = (1.0 + _BELOW) * picture.invariable_plane_distance * down_W
    reach = float(np.linalg.norm(curves.herpolhode_W - foot_W, axis=1).max(initial=0.0))
    half = _PLANE_MARGIN * max(reach, 0.5 * unit)
    places = np.linspace(-half, half, _GRID + 1).tolist()
    return PoinsotFigure(
        axes_W=np.array([u_W, v_W, -down_W]),
        unit=unit,
        net_B=[strip @ picture.principal_axes_B.T for strip in ellipsoid_net(picture.ellipsoid_semi_axes)],
        foot_W=foot_W,
        grid_W=[
            foot_W + np.array([s * a - half * b, s * a + half * b])
            for a, b in ((u_W, v_W), (v_W, u_W))
            for s in places
        ],
        corners_W=foot_W + half * np.array([-u_W - v_W, u_W - v_W, u_W + v_W, v_W - u_W]),
    )


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
