"""Impulse space shows an impact (Mason, lecture 27): tangential impulse to the right, normal impulse up.

The path of the accumulated impulse leaves the origin, inside the friction cone. On the sticking line the
contact does not slide, and on the compression line it does not approach. The path bends where it meets the
sticking line, and compression ends where it meets the compression line.

In space the picture's plane contains the normal and the total impulse. A path that swerves is projected onto
it, and so is the sticking line, on which both tangential velocities are zero. The impulses after which the
contact does not approach form a plane, and the picture shows a cut through it. The cut is as far out of the
picture as the path is where compression ends. If compression ends more than once, each end has its own line.

If a contact strikes more than once, its whole path is drawn, with the lines and events of its first strike.
These lines take account of what other contacts did before.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.impact.law import PathEvent
from contact_dynamics.impact.spatial.one_contact import contact_inverse_inertia
from contact_dynamics.numerics.vectors import across, tangents_near_x

if TYPE_CHECKING:
    from contact_dynamics.questions.impact_answer import ImpactAnswer
    from contact_dynamics.questions.resolved_impact import ResolvedImpact
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray

MARGIN: Final = 1.2
"""Length of cone and lines, relative to the path."""

BELOW: Final = 0.12
"""Height of the picture below the origin, relative to that above it."""

EVENTS: Final = {
    PathEvent.SLIDING_STOPS: "sliding stops",
    PathEvent.COMPRESSION_ENDS: "compression ends",
    PathEvent.RESTITUTION_ENDS: "restitution ends",
}
"""The events that are marked, in words."""


class Line(NamedTuple):
    """Impulses x with ``normal . x + offset = 0``, after which a component of a contact's velocity is zero.

    Attributes:
        normal: (2,), 1/kg, tangential, normal.
        offset: m/s.
    """

    normal: FloatArray
    offset: float


class ContactMotion(NamedTuple):
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ImpulseSpace:
    """The picture of a contact's impulse, with tangential and normal impulse as its coordinates, N s.

    Attributes:
        in_space: Whether path and sticking line are projections.
        axes_W: (2, 3), unit, the tangent and the normal of the picture, world axes.
        extent: N s, how far the picture reaches to the right, to the left and up.
        cone: (3, 2), the friction cone's edges, as a strip.
        path: (k, 2), the vertices of the path.
        sticking: The lines on which the contact does not slide. There are none without mass properties.
        compression: The lines on which it does not approach. There are none without mass properties.
        events: (m,), what is marked.
        points: (m, 2), where.
    """

    in_space: bool
    axes_W: FloatArray
    extent: float
    cone: FloatArray
    path: FloatArray
    sticking: tuple[Line, ...]
    compression: tuple[Line, ...]
    events: tuple[PathEvent, ...]
    points: FloatArray

    @property
    def side(self) -> float:
        """Return 1 if the path ends on the right of the normal or on it, and -1 on the left."""
        return -1.0 if len(self.path) > 0 and self.path[-1, 0] < 0.0 else 1.0


def impulse_space_of(
    mass_properties: MassProperties | None, answer: ImpactAnswer, *, other: MassProperties | None = None
) -> ImpulseSpace:
    """Return the picture of an impact's main contact.

    The sticking and compression lines need the mass properties of all bodies that move, and are left out
    otherwise. ``other`` are the mass properties of the body that is struck.
    """
    impact = answer.impact
    contact = main_contact(impact)
    axes_W = contact_axes(answer, contact)
    chosen = [i for i, owner in enumerate(impact.path_contacts) if owner == contact]
    path = impact.path_W[chosen] @ axes_W.T
    extent = MARGIN * float(np.abs(path).max(initial=0.0)) or 1.0
    half_angle = math.atan(float(answer.contacts.frictions[contact]))
    right, up = extent * math.sin(half_angle), extent * math.cos(half_angle)
    events = [(i, impact.path_events[i]) for i in chosen if impact.path_events[i] in EVENTS]
    ends = [k for k, (_, event) in enumerate(events) if event == PathEvent.RESTITUTION_ENDS]
    events = events[: ends[0] + 1] if ends else events  # the lines belong to the first strike
    sticking: tuple[Line, ...] = ()
    compression: tuple[Line, ...] = ()
    if mass_properties is not None and (answer.other is None or other is not None):
        before = chosen[0] if chosen else 0
        motion = contact_motion(mass_properties, answer, contact, axes_W, other=other, before=before)
        sticking = (motion.sticking_line(in_space=answer.plane is None),)
        compressed_W = [impact.path_W[i] for i, event in events if event == PathEvent.COMPRESSION_ENDS]
        aside = [float(np.cross(*axes_W) @ p_W) for p_W in compressed_W]
        compression = tuple(motion.compression_line(aside=s) for s in aside or [0.0])
    return ImpulseSpace(
        in_space=answer.plane is None,
        axes_W=axes_W,
        extent=extent,
        cone=np.array([(-right, up), (0.0, 0.0), (right, up)]),
        path=path,
        sticking=sticking,
        compression=compression,
        events=tuple(event for _, event in events),
        points=impact.path_W[[i for i, _ in events]] @ axes_W.T,
    )


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
    for vector_W in (*candidates, tangents_near_x(normal_W)[0]):
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
    lowest, highest = (-extent, -BELOW * extent), (extent, extent)
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


def contact_motion(
    mass_properties: MassProperties,
    answer: ImpactAnswer,
    contact: int,
    axes_W: FloatArray,
    *,
    other: MassProperties | None,
    before: int,
) -> ContactMotion:
    """Return the motion of a contact after the strikes that come before a vertex of the path.

    Args:
        mass_properties: Those of the body.
        answer: The impact.
        contact: Which contact.
        axes_W: (2, 3), unit, the tangent and the normal of the picture, world axes.
        other: Mass properties of the body that is struck.
        before: The vertex of the path, as an index.
    """
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
    return ContactMotion(axes @ velocity_W, axes @ response_W @ axes.T)


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
