"""Draws an impact in impulse space (Mason, lecture 27): tangential impulse to the right, normal impulse up.

The path of the accumulated impulse leaves the origin, inside the friction cone. On the sticking line the
contact does not slide, and on the compression line it does not approach. The path bends where it meets the
sticking line, and compression ends where it meets the compression line.

In space the picture's plane contains the normal and the total impulse. A path that swerves is projected onto
it, and so is the sticking line, on which both tangential velocities are zero. The impulses after which the
contact does not approach form a plane, and the picture shows a cut through it. The cut is as far out of the
picture as the path is where compression ends. If compression ends more than once, each end has its own line.

If a contact strikes more than once, its whole path is drawn, with the lines and labels of its first strike.
These lines take account of what other contacts did before.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
import rerun as rr

from contact_dynamics.impact.law import PathEvent
from contact_dynamics.impact.spatial.one_contact import contact_inverse_inertia
from contact_dynamics.numerics.vectors import across
from contact_dynamics.viewing import palette
from contact_dynamics.viewing.entities import IMPULSE_SPACE
from contact_dynamics.viewing.scene import tangents

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike

    from contact_dynamics.plane.types import Vector2
    from contact_dynamics.questions.impact import ImpactAnswer
    from contact_dynamics.questions.resolved_impact import ResolvedImpact
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray

MARGIN: Final = 1.2
"""Length of cone and lines, relative to the path."""

_BELOW: Final = 0.12  # height of the picture below the origin, relative to that above it
_LINE_WIDTH: Final = -1.2  # a negative size is in points of the screen
_PATH_WIDTH: Final = -2.5
_POINT_SIZE: Final = -5.0
_LABEL_OFFSET: Final = 0.55  # distance of a label's centre from its place, relative to the picture's height
_NAMES: Final = 0.85  # distance of the names' centre from the normal, relative to the picture's height
_NAMED: Final = (
    ("sticking line", palette.STICKING_LINE),
    ("compression line", palette.COMPRESSION_LINE),
    ("friction cone", palette.translucent(palette.FRICTION_CONE, 1.0)),
)
_EVENTS: Final = {
    PathEvent.SLIDING_STOPS: "sliding stops",
    PathEvent.COMPRESSION_ENDS: "compression ends",
    PathEvent.RESTITUTION_ENDS: "restitution ends",
}


class Line(NamedTuple):
    """Impulses x with ``normal . x + offset = 0``, after which a component of a contact's velocity is zero.

    Attributes:
        normal: (2,), 1/kg, tangential, normal.
        offset: m/s.
    """

    normal: FloatArray
    offset: float


class _ContactMotion(NamedTuple):
    """The contact's velocity after an impulse x is ``velocity + response @ x`` (lecture 27, eq. 9 and 10).

    The components are along the picture's tangent, along the normal, and out of the picture.
    """

    velocity: FloatArray  # (3,), m/s, before the impact
    response: FloatArray  # (3, 3), 1/kg

    def sticking_line(self, *, in_space: bool) -> Line:
        """Return the line on which the contact does not slide. In space it is a projection."""
        velocity, response = self.velocity, self.response
        # The impulse out of the picture is eliminated. It has the size that leaves no velocity in that
        # direction.
        share = response[0, 2] / response[2, 2] if in_space else 0.0
        normal = response[0, :2] - share * response[2, :2]
        return Line(normal, float(velocity[0] - share * velocity[2]))

    def compression_line(self, *, aside: float) -> Line:
        """Return the line without approach, for impulses that are ``aside``, N s, out of the picture."""
        return Line(self.response[1, :2], float(self.velocity[1] + self.response[1, 2] * aside))


def draw_impulse_space(
    recording: rr.RecordingStream,
    mass_properties: MassProperties | None,
    answer: ImpactAnswer,
    *,
    other: MassProperties | None = None,
    entity: str = IMPULSE_SPACE,
) -> None:
    """Draw the impulse path of an impact's main contact, at the recording's current time.

    The sticking and compression lines need the mass properties of all bodies that move, and are left out
    otherwise. ``other`` are the mass properties of the body that is struck. ``entity``, a name without
    slashes, is where the picture goes.
    """
    impact = answer.impact
    contact = main_contact(impact)
    axes_W = contact_axes(answer, contact)
    chosen = [i for i, owner in enumerate(impact.path_contacts) if owner == contact]
    path = impact.path_W[chosen] @ axes_W.T
    extent = MARGIN * float(np.abs(path).max(initial=0.0)) or 1.0
    _draw_background(recording, entity, float(answer.contacts.frictions[contact]), extent)
    # Labels of the path are on its side of the normal, and the names of the lines are on the other side.
    side = -1.0 if len(path) > 0 and path[-1, 0] < 0.0 else 1.0
    _draw_names(recording, entity, -side * _NAMES * extent, extent)
    events = [(i, impact.path_events[i]) for i in chosen if impact.path_events[i] in _EVENTS]
    ends = [k for k, (_, event) in enumerate(events) if event == PathEvent.RESTITUTION_ENDS]
    events = events[: ends[0] + 1] if ends else events  # the lines belong to the first strike
    sticking: list[Line] = []
    compression: list[Line] = []
    if mass_properties is not None and (answer.other is None or other is not None):
        before = chosen[0] if chosen else 0
        motion = _contact_motion(mass_properties, answer, contact, axes_W, other=other, before=before)
        sticking = [motion.sticking_line(in_space=answer.plane is None)]
        compressed_W = [impact.path_W[i] for i, event in events if event == PathEvent.COMPRESSION_ENDS]
        aside = [float(np.cross(*axes_W) @ p_W) for p_W in compressed_W]
        compression = [motion.compression_line(aside=s) for s in aside or [0.0]]
    for (name, color), lines in zip(_NAMED, (sticking, compression), strict=False):
        _strips(
            recording, [entity, name], [part for line in lines for part in line_in_box(line, extent)], color
        )
    _strips(recording, [entity, "path"], [path], palette.IMPACT, width=_PATH_WIDTH)
    points = impact.path_W[[i for i, _ in events]] @ axes_W.T
    texts = [
        f"{_EVENTS[event]}: {t:.3g}, {n:.3g} N s"
        for (_, event), (t, n) in zip(events, points.tolist(), strict=True)
    ]
    shown = rr.Points2D(_on_screen(points), colors=palette.IMPACT, radii=_POINT_SIZE)
    recording.log([entity, "events"], shown)
    places = points + np.array([side * _LABEL_OFFSET * extent, 0.0])
    labels = rr.Points2D(_on_screen(places), colors=palette.IMPACT, radii=0.0, labels=texts, show_labels=True)
    recording.log([entity, "event labels"], labels)


def main_contact(impact: ResolvedImpact) -> int:
    """Return the contact with the largest impulse, or for strikes in time the one that strikes first."""
    if impact.strikes:
        return impact.strikes[0].contact
    return int(np.linalg.norm(impact.impulses_W, axis=1).argmax())


def contact_axes(answer: ImpactAnswer, contact: int) -> FloatArray:
    """Return the axes of the picture, tangent and normal, (2, 3), unit, world axes.

    In the plane of motion the tangent is the normal turned by -90 degrees. In space it points along the
    tangential impulse, or against the sliding if there is no tangential impulse.
    """
    normal_W = answer.contacts.normals_W[contact]
    if answer.plane is not None:
        candidates = [np.cross(normal_W, answer.plane.normal_W)]
    else:
        slip_W = answer.state.velocity_of_point(answer.contacts.p_WC_W[contact])
        candidates = [answer.impact.impulses_W[contact], -slip_W]
    for vector_W in (*candidates, tangents(normal_W)[0]):
        tangent_W = across(vector_W, normal_W)
        length = float(np.linalg.norm(tangent_W))
        if length > 1e-9 * float(np.linalg.norm(vector_W)):
            break
    return np.array([tangent_W / length, normal_W])


def line_in_box(line: Line, extent: float) -> FloatArray:
    """Return the ends of the part of a line within the picture, (1, 2, 2), or (0, 2, 2) without any."""
    nothing = np.zeros((0, 2, 2))
    squared = float(line.normal @ line.normal)
    if squared == 0.0:
        return nothing
    foot = -line.offset * line.normal / squared
    along = np.array([-line.normal[1], line.normal[0]]) / math.sqrt(squared)
    begin, end = -math.inf, math.inf
    lowest, highest = (-extent, -_BELOW * extent), (extent, extent)
    for start, slope, low, high in zip(foot.tolist(), along.tolist(), lowest, highest, strict=True):
        if slope == 0.0:
            if not low <= start <= high:
                return nothing
            continue
        first, last = sorted(((low - start) / slope, (high - start) / slope))
        begin, end = max(begin, first), min(end, last)
    if begin >= end:
        return nothing
    return np.array([[foot + begin * along, foot + end * along]])


def _contact_motion(
    mass_properties: MassProperties,
    answer: ImpactAnswer,
    contact: int,
    axes_W: FloatArray,
    *,
    other: MassProperties | None,
    before: int,
) -> _ContactMotion:
    """Return the motion of a contact after the strikes that come before a vertex of the path."""
    state, impact = answer.state, answer.impact
    p_WC_W = answer.contacts.p_WC_W[contact]
    struck_W = dict(
        zip(impact.path_contacts[:before], impact.path_W[:before], strict=True)
    )  # the last vertex of each contact
    pushes = [(answer.contacts.p_WC_W[i], impulse_W) for i, impulse_W in struck_W.items()]
    velocity_W = _velocity_of_point(mass_properties, state, p_WC_W, pushes)
    response_W = contact_inverse_inertia(mass_properties, state, p_WC_W - state.p_WB_W)
    if answer.other is not None and other is not None:
        struck = answer.other.state
        pushes = [(p_W, -impulse_W) for p_W, impulse_W in pushes]
        velocity_W = velocity_W - _velocity_of_point(other, struck, p_WC_W, pushes)
        response_W = response_W + contact_inverse_inertia(other, struck, p_WC_W - struck.p_WB_W)
    axes = np.vstack([axes_W, np.cross(*axes_W)])
    return _ContactMotion(axes @ velocity_W, axes @ response_W @ axes.T)


def _velocity_of_point(
    body: MassProperties, state: BodyState, p_WP_W: FloatArray, pushes: list[tuple[FloatArray, FloatArray]]
) -> FloatArray:
    """Return the velocity, (3,), m/s, of a body's point after impulses, N s, at places, m, world axes."""
    v_WB_W, moment_W = state.v_WB_W, np.zeros(3)
    for p_W, impulse_W in pushes:
        v_WB_W = v_WB_W + impulse_W / body.mass
        moment_W = moment_W + np.cross(p_W - state.p_WB_W, impulse_W)
    w_WB_W = state.w_WB_W + np.linalg.solve(body.inertia_in_world(state.R_WB), moment_W)
    velocity_W: FloatArray = v_WB_W + np.cross(w_WB_W, p_WP_W - state.p_WB_W)
    return velocity_W


def _draw_background(recording: rr.RecordingStream, entity: str, friction: float, extent: float) -> None:
    axes = [[(-extent, 0.0), (extent, 0.0)], [(0.0, 0.0), (0.0, extent)]]
    _strips(recording, [entity, "axes"], axes, palette.SURFACE_GRID)
    half_angle = math.atan(friction)
    rim: Vector2 = (extent * math.sin(half_angle), extent * math.cos(half_angle))
    cone = [[(-rim[0], rim[1]), (0.0, 0.0), rim]]
    _strips(recording, [entity, "friction cone"], cone, palette.translucent(palette.FRICTION_CONE, 1.0))


def _draw_names(recording: rr.RecordingStream, entity: str, t: float, extent: float) -> None:
    points = np.array([(t, extent * (1.0 - 0.13 * i)) for i in range(len(_NAMED))])
    colors = [color for _, color in _NAMED]
    labels = rr.Points2D(
        _on_screen(points), colors=colors, radii=0.0, labels=[name for name, _ in _NAMED], show_labels=True
    )
    recording.log([entity, "names"], labels)


def _strips(
    recording: rr.RecordingStream,
    path: list[object],
    strips: Iterable[ArrayLike],
    color: palette.Color,
    *,
    width: float = _LINE_WIDTH,
) -> None:
    drawn = [_on_screen(np.asarray(strip)) for strip in strips]
    recording.log(path, rr.LineStrips2D(drawn, colors=color, radii=width))


def _on_screen(points: FloatArray) -> FloatArray:
    """Return points with the second coordinate downwards, as rerun's 2D views have it."""
    flipped: FloatArray = points.reshape(-1, 2) * (1.0, -1.0)
    return flipped
