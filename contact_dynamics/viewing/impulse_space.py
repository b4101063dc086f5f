"""An impact in impulse space (Mason, lecture 27): tangential impulse to the right, normal impulse up.

The path of the accumulated impulse leaves the origin, inside the friction cone. On the sticking line the contact does not
slide, on the compression line it does not approach: the path bends where it meets the first, and compression ends where it
meets the second. In space the lines are those for impulses in the plane of the picture, which is that of the normal and of
the total impulse; a path that swerves out of it is seen as its projection.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.impact.law import PathEvent
from contact_dynamics.viewing import palette
from contact_dynamics.viewing.entities import IMPULSE_SPACE
from contact_dynamics.viewing.scene import tangents

if TYPE_CHECKING:
    from contact_dynamics.rigid_body import MassProperties
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.viewing.impact import ImpactPicture

MARGIN: Final = 1.25
"""How far cone and lines go beyond the path."""

_LINE_WIDTH: Final = -1.2  # negative: points of the screen
_PATH_WIDTH: Final = -2.5
_POINT_SIZE: Final = -5.0
_EVENTS: Final = {
    PathEvent.SLIDING_STOPS: "sliding stops",
    PathEvent.COMPRESSION_ENDS: "compression ends",
    PathEvent.RESTITUTION_ENDS: "restitution ends",
}


def draw_impulse_space(
    recording: rr.RecordingStream, mass_properties: MassProperties | None, picture: ImpactPicture
) -> None:
    """Draw the impulse path of the contact with the largest impulse, at the recording's current time.

    Without mass properties the sticking and compression lines are left out.
    """
    contact = picture.main_contact
    axes_W = contact_axes(picture, contact)
    chosen = [i for i, owner in enumerate(picture.path_contacts) if owner == contact]
    path = picture.path_W[chosen] @ axes_W.T
    extent = MARGIN * float(np.abs(path).max(initial=0.0)) or 1.0
    _strips(recording, "axes", [[(-extent, 0.0), (extent, 0.0)], [(0.0, 0.0), (0.0, extent)]], palette.SURFACE_GRID)
    half_angle = math.atan(picture.contacts.frictions[contact])
    rim = extent * math.cos(half_angle), extent * math.sin(half_angle)
    _strips(recording, "cone", [[(-rim[1], rim[0]), (0.0, 0.0), (rim[1], rim[0])]], palette.translucent(palette.FRICTION_CONE, 1.0))
    _draw_lines(recording, mass_properties, picture, contact, axes_W, extent)
    _strips(recording, "path", [path], palette.IMPACT, width=_PATH_WIDTH)
    events = [(i, _EVENTS[PathEvent(picture.path_events[i])]) for i in chosen if picture.path_events[i] in _EVENTS]
    points = picture.path_W[[i for i, _ in events]] @ axes_W.T
    labels = [
        f"{text}: {t:.3g}, {n:.3g} N s" for (_, text), (t, n) in zip(events, points.tolist(), strict=True)
    ]
    recording.log(
        f"{IMPULSE_SPACE}/events",
        rr.Points2D(_on_screen(points), colors=palette.IMPACT, radii=_POINT_SIZE, labels=labels, show_labels=True),
    )


def contact_axes(picture: ImpactPicture, contact: int) -> FloatArray:
    """Return the axes of the picture, tangent and normal, (2, 3), unit, world axes.

    In the plane of motion the tangent is the normal turned by -90 degrees. In space it points to where the tangential impulse
    does, or where there is none, against which the contact slides.
    """
    normal_W = picture.contacts.normals_W[contact]
    if picture.plane_normal_W is not None:
        tangent_W = np.cross(normal_W, picture.plane_normal_W)
        return np.array([tangent_W / np.linalg.norm(tangent_W), normal_W])
    slip_W = picture.state.velocity_of_point(picture.contacts.p_WC_W[contact])
    for vector_W in (picture.impulses_W[contact], -slip_W, tangents(normal_W)[0]):
        tangent_W = vector_W - (vector_W @ normal_W) * normal_W
        length = float(np.linalg.norm(tangent_W))
        if length > 1e-9 * float(np.linalg.norm(vector_W)):
            break
    return np.array([tangent_W / length, normal_W])


def _draw_lines(
    recording: rr.RecordingStream,
    mass_properties: MassProperties | None,
    picture: ImpactPicture,
    contact: int,
    axes_W: FloatArray,
    extent: float,
) -> None:
    for i, (name, color) in enumerate((("sticking", palette.STICKING_LINE), ("compression", palette.COMPRESSION_LINE))):
        line = None
        if mass_properties is not None:
            point_W = picture.contacts.p_WC_W[contact]
            velocity = axes_W @ picture.state.velocity_of_point(point_W)
            response = axes_W @ inverse_inertia(mass_properties, picture, point_W) @ axes_W.T
            line = line_in_square(response[i], float(velocity[i]), extent)
        _strips(recording, f"{name}_line", [] if line is None else [line], color, label=f"{name} line")


def inverse_inertia(mass_properties: MassProperties, picture: ImpactPicture, point_W: FloatArray) -> FloatArray:
    """Return the change of a contact's velocity per impulse at it, (3, 3), 1/kg, world axes (lecture 27, eq. 8)."""
    x, y, z = point_W - picture.state.p_WB_W
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    inverse = np.linalg.inv(mass_properties.inertia_in_world(picture.state.R_WB))
    response: FloatArray = np.eye(3) / mass_properties.mass - cross @ inverse @ cross
    return response


def line_in_square(normal: FloatArray, offset: float, extent: float) -> FloatArray | None:
    """Return the two ends, (2, 2), of the part of the line ``normal . x + offset = 0`` with |x|, |y| <= ``extent``."""
    squared = float(normal @ normal)
    if squared == 0.0:
        return None
    foot = -offset * normal / squared
    along = np.array([-normal[1], normal[0]]) / math.sqrt(squared)
    low, high = -math.inf, math.inf
    for start, slope in zip(foot.tolist(), along.tolist(), strict=True):
        if slope == 0.0:
            if abs(start) > extent:
                return None
            continue
        a, b = sorted(((-extent - start) / slope, (extent - start) / slope))
        low, high = max(low, a), min(high, b)
    if low >= high:
        return None
    return np.array([foot + low * along, foot + high * along])


def _strips(
    recording: rr.RecordingStream,
    name: str,
    strips: object,
    color: palette.Color,
    *,
    width: float = _LINE_WIDTH,
    label: str = "",
) -> None:
    drawn = [_on_screen(np.asarray(strip)) for strip in strips]
    recording.log(
        f"{IMPULSE_SPACE}/{name}",
        rr.LineStrips2D(drawn, colors=color, radii=width, labels=[label] * len(drawn) if label else None),
    )


def _on_screen(points: FloatArray) -> FloatArray:
    """Return points with the second coordinate downwards, as rerun's 2D views have it."""
    flipped: FloatArray = points.reshape(-1, 2) * (1.0, -1.0)
    return flipped
