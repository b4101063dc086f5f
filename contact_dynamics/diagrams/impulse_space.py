# SPDX-License-Identifier: Apache-2.0
"""Impulse space shows an impact (Mason, lecture 27): tangential impulse to the right, normal impulse up.

The path of the accumulated impulse leaves the origin, inside the friction cone. On the sticking line the
contact does not slide, and on the compression line it does not approach. The path bends where it meets the
sticking line, and compression ends where it meets the compression line.

In space (Keller 1986) the friction cone is round, and the impulses after which the contact does not approach
form a plane. The diagram in the plane of the normal and the total impulse is a projection: a path that
swerves is projected onto it, and so is the sticking line. The compression plane is cut as far out of the
diagram as the path is where compression ends. If compression ends more than once, each end has its own line.

If a contact strikes more than once, its whole path is drawn, with the lines and events of its first strike.
These lines take account of what other contacts did before.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact.velocities import relative_velocities
from contact_dynamics.diagrams import palette, paper
from contact_dynamics.diagrams.marks import Axis, Diagram, Faces, Lines, Points
from contact_dynamics.diagrams.palette import Paint
from contact_dynamics.diagrams.shape import part_above
from contact_dynamics.diagrams.words import outcome_in_words
from contact_dynamics.impact.law import PathEvent
from contact_dynamics.impact.spatial.one_contact import contact_inverse_inertia
from contact_dynamics.numerics.vectors import across, tangents_near_x

if TYPE_CHECKING:
    from contact_dynamics.diagrams.marks import Mark
    from contact_dynamics.impact import ResolvedImpact
    from contact_dynamics.questions.impact_question import ImpactAnswer
    from contact_dynamics.rigid_body.body import BodyState, HasMassProperties, MassProperties
    from contact_dynamics.validation import FloatArray

EVENTS: Final = {  # the events that are marked, in words and with their markers
    PathEvent.SLIDING_STOPS: ("sliding stops", "s"),
    PathEvent.COMPRESSION_ENDS: ("compression ends", "o"),
    PathEvent.RESTITUTION_ENDS: ("restitution ends", "^"),
}

_MARGIN: Final = 1.2  # height of the diagram, relative to the path
_BELOW: Final = 0.12  # height of the diagram below the origin, relative to that above it
_NARROWEST, _WIDEST = 0.5, 1.2  # half of its width, relative to its height, unless the path is wider
_DIGITS: Final = 9  # relative to the diagram: what is below is rounding
_RINGS: Final = 4  # of the round cone
_ROUND: Final = 49  # points of a ring, the last one is the first
_RAYS: Final = 12

_CONE: Final = Paint(palette.FRICTION_CONE, paper.PURPLE)
_STICKING: Final = Paint(palette.STICKING_LINE, paper.BLUE)
_COMPRESSION: Final = Paint(palette.COMPRESSION_LINE, paper.ORANGE)
_PATH: Final = Paint(palette.IMPACT, paper.BLACK)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ContactImpulse:
    """The impulse of an impact's main contact, along the two tangents and the normal of its picture.

    After an impulse x at the contact, its velocity is ``velocity + response @ x`` (lecture 27, eq. 9 and 10).
    Both are known with the mass properties of all bodies that move.
    """

    friction: float
    path: FloatArray  # (k, 3), N s, the vertices of the path
    events: list[tuple[PathEvent, FloatArray]]  # what is marked, and where, (3,), N s
    motion: tuple[FloatArray, FloatArray] | None  # velocity, (3,), m/s, before, and response, (3, 3), 1/kg
    side: float  # N s, half of the width of the diagram
    top: float  # N s, its height


def impulse_space(
    body: HasMassProperties | None, answer: ImpactAnswer, *, other: HasMassProperties | None = None
) -> Diagram:
    """Return the diagram of an impact's main contact in the plane of the normal and the total impulse.

    Args:
        body: The body, or its mass properties. If it is None, there are no sticking and compression lines.
        answer: The impact.
        other: The body that is struck, or its mass properties. Without it there are no lines for two bodies.
    """
    found = contact_impulse(body, answer, other=other)
    friction, side, top = found.friction, found.side, found.top
    low, high = np.array([-side, -_BELOW * top]), np.array([side, top])
    reach = min(top, side / friction) if friction > 0.0 else top
    cone = np.array([(-friction * reach, reach), (0.0, 0.0), (friction * reach, reach)])
    marks: list[Mark] = [
        Faces("cone", _CONE, cone, opacity=0.12),
        Lines("friction_cone", _CONE, [cone], legend=f"friction cone, μ = {friction:.3g}"),
    ]
    in_space = answer.plane is None
    if found.motion is not None:
        velocity, response = found.motion
        start, slope = _sticking_line(velocity, response, in_space=in_space)
        ends = [part_in_box(start[[0, 2]], slope[[0, 2]], low, high)]
        name = "sticking line" + (", projected" if in_space else "")
        marks += _line("sticking_line", _STICKING, "--", name, ends)
        compressed = [point[1] for event, point in found.events if event == PathEvent.COMPRESSION_ENDS]
        (v, r) = velocity[2], response[2]
        rise = np.array([1.0, -r[0] / r[2]])
        ends = [
            part_in_box(np.array([0.0, -(v + r[1] * aside) / r[2]]), rise, low, high)
            for aside in compressed or [0.0]
        ]
        name = "compression plane, cut" if in_space else "compression line"
        marks += _line("compression_line", _COMPRESSION, "-.", name, ends)
    projected = ", projected" if in_space else ""
    marks += _path_marks(found, [0, 2], legend=f"impulse so far{projected}")
    return Diagram(
        marks=marks,
        axes=(
            Axis("tangential impulse, N s", float(low[0]), side),
            Axis("normal impulse, N s", float(low[1]), top),
        ),
        title=_title(answer),
    )


def impulse_space_in_3d(
    body: HasMassProperties | None, answer: ImpactAnswer, *, other: HasMassProperties | None = None
) -> Diagram:
    """Return the diagram of an impact's main contact in all three dimensions.

    Args:
        body: The body, or its mass properties. If it is None, there is neither sticking line nor compression
            plane.
        answer: The impact.
        other: The body that is struck, or its mass properties. Without it both are missing for two bodies.
    """
    found = contact_impulse(body, answer, other=other)
    friction, side, top = found.friction, found.side, found.top
    cone = Lines(
        "friction_cone",
        _CONE,
        _round_cone(friction, min(top, side / friction) if friction > 0.0 else top),
        opacity=0.8,
        width=0.8,
        legend=f"friction cone, μ = {friction:.3g}",
    )
    marks: list[Mark] = [cone]
    low, high = np.array([-side, -side, 0.0]), np.array([side, side, top])
    if found.motion is not None:
        velocity, response = found.motion
        start, slope = _sticking_line(velocity, response, in_space=True)
        marks += _line(
            "sticking_line", _STICKING, "--", "sticking line", [part_in_box(start, slope, low, high)]
        )
        flat = side * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
        (v, r) = velocity[2], response[2]
        corners = np.column_stack([flat, -(v + flat @ r[:2]) / r[2]])
        corners = part_above(corners, corners[:, 2])
        corners = part_above(corners, top - corners[:, 2])
        if len(corners) > 2:
            plane = Faces("compression_plane", _COMPRESSION, corners, opacity=0.15)
            around = [np.vstack([corners, corners[:1]])]
            marks += [plane, *_line("compression_border", _COMPRESSION, "-.", "compression plane", around)]
    marks += _path_marks(found, [0, 1, 2], legend="impulse so far")
    names = ("along the tangential impulse, N s", "across, N s", "normal impulse, N s")
    axes = tuple(Axis(*each) for each in zip(names, low.tolist(), high.tolist(), strict=True))
    return Diagram(marks=marks, axes=axes, title=_title(answer))


def contact_impulse(
    body: HasMassProperties | None, answer: ImpactAnswer, *, other: HasMassProperties | None = None
) -> ContactImpulse:
    """Return the impulse of an impact's main contact, as the diagrams show it."""
    impact = answer.impact
    contact = main_contact(impact)
    axes_W = contact_axes(answer, contact)
    chosen = [i for i, owner in enumerate(impact.path_contacts) if owner == contact]
    path = impact.path_W[chosen] @ axes_W.T
    marked = [i for i in chosen if impact.path_events[i] in EVENTS]
    ends = [k for k, i in enumerate(marked) if impact.path_events[i] == PathEvent.RESTITUTION_ENDS]
    marked = marked[: ends[0] + 1] if ends else marked  # the lines belong to the first strike
    top = _MARGIN * float(np.abs(path).max(initial=0.0)) or 1.0
    friction = float(answer.contacts.frictions[contact])
    half_width = min(max(friction, _NARROWEST), _WIDEST) * top
    motion = None
    if body is not None and (answer.other is None or other is not None):
        velocity, response = _contact_motion(
            body.mass_properties,
            answer,
            contact,
            other=None if other is None else other.mass_properties,
            before=chosen[0] if chosen else 0,
        )
        motion = axes_W @ velocity, axes_W @ response @ axes_W.T
    return ContactImpulse(
        friction=friction,
        path=path,
        events=[(impact.path_events[i], axes_W @ impact.path_W[i]) for i in marked],
        motion=motion,
        side=max(half_width, _MARGIN * float(np.abs(path[:, :2]).max(initial=0.0))),
        top=top,
    )


def main_contact(impact: ResolvedImpact) -> int:
    """Return the contact with the largest impulse, or for strikes in time the one that strikes first."""
    if impact.strikes:
        return impact.strikes[0].contact
    return int(np.linalg.norm(impact.impulses_W, axis=1).argmax())


def contact_axes(answer: ImpactAnswer, contact: int) -> FloatArray:
    """Return the axes of the diagram, two tangents and the normal, (3, 3), unit, right-handed, world axes.

    In the plane of motion the first tangent is the normal turned by -90 degrees. In space it points along the
    tangential impulse, or against the sliding if there is no tangential impulse.
    """
    normal_W = answer.contacts.normals_W[contact]
    if answer.plane is not None:
        candidates = [np.cross(normal_W, answer.plane.normal_W)]
    else:
        slip_W = relative_velocities(answer.state, answer.contacts)[contact]
        candidates = [answer.impact.impulses_W[contact], -slip_W]
    for vector_W in (*candidates, tangents_near_x(normal_W)[0]):
        tangent_W = across(vector_W, normal_W)
        length = float(np.linalg.norm(tangent_W))
        if length > 1e-9 * float(np.linalg.norm(vector_W)):
            break
    tangent_W = tangent_W / length
    return np.array([tangent_W, np.cross(normal_W, tangent_W), normal_W])


def part_in_box(start: FloatArray, slope: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """Return the ends, (2, d), of the part of a line ``start + s slope`` in a box, or (0, d) without any."""
    begin, end = -math.inf, math.inf
    sides = (each.tolist() for each in (start, slope, low, high))
    for at_zero, rise, least, most in zip(*sides, strict=True):
        if rise == 0.0:
            if not least <= at_zero <= most:
                return np.zeros((0, len(start)))
            continue
        first, last = sorted(((least - at_zero) / rise, (most - at_zero) / rise))
        begin, end = max(begin, first), min(end, last)
    if begin >= end:
        return np.zeros((0, len(start)))
    return np.array([start + begin * slope, start + end * slope])


def _sticking_line(
    velocity: FloatArray, response: FloatArray, *, in_space: bool
) -> tuple[FloatArray, FloatArray]:
    """Return an impulse after which the contact does not slide, and how it grows with the normal impulse.

    In a plane of motion the second tangential impulse is zero, and its velocity does not matter.
    """
    n = 2 if in_space else 1
    sides = np.column_stack([-velocity[:n], -response[:n, 2]])
    solved = np.zeros((2, 2))
    solved[:n] = np.linalg.solve(response[:n, :n], sides)
    return np.append(solved[:, 0], 0.0), np.append(solved[:, 1], 1.0)


def _line(name: str, paint: Paint, dash: str, legend: str, strips: list[FloatArray]) -> list[Mark]:
    """Return the mark of lines, if any of them is in the diagram."""
    shown = [strip for strip in strips if len(strip) > 0]
    return [Lines(name, paint, shown, dash=dash, legend=legend)] if shown else []


def _path_marks(found: ContactImpulse, components: list[int], *, legend: str) -> list[Mark]:
    decimals = _DIGITS - math.floor(math.log10(found.top))
    marks: list[Mark] = []
    if len(found.path) > 0:
        path = found.path[:, components]
        marks.append(Lines("path", _PATH, [path], width=2.75, legend=legend))
    for i, (event, whole) in enumerate(found.events):
        point = whole[components]
        words, marker = EVENTS[event]
        numbers = ", ".join(f"{round(x, decimals) + 0.0:.3g}" for x in point.tolist())
        marks.append(
            Points(
                f"event_{i}",
                _PATH,
                point[None],
                marker=marker,
                hollow=True,
                legend=f"{words}:\n({numbers}) N s",
                is_noted=True,
            )
        )
    return marks


def _title(answer: ImpactAnswer) -> str:
    return f"{answer.body_name or 'a body'} {outcome_in_words(answer.impact.outcome)}"


def _round_cone(friction: float, height: float) -> list[FloatArray]:
    """Return rings and rays of the cone up to a height, N s, as strips, (k, 3) each."""
    turns = np.linspace(0.0, 2.0 * math.pi, _ROUND)
    ring = np.column_stack([friction * np.cos(turns), friction * np.sin(turns), np.ones(_ROUND)])
    rings = [height * (i + 1) / _RINGS * ring for i in range(_RINGS)]
    edge = height * ring[: -1 : (_ROUND - 1) // _RAYS]
    return [*rings, *(np.array([[0.0, 0.0, 0.0], end]) for end in edge)]


def _contact_motion(
    body: MassProperties, answer: ImpactAnswer, contact: int, *, other: MassProperties | None, before: int
) -> tuple[FloatArray, FloatArray]:
    """Return the velocity, (3,), m/s, of a contact and its response to impulses, (3, 3), 1/kg, world axes.

    The strikes before a vertex of the path, which is given by its index, are over.
    """
    state, impact = answer.state, answer.impact
    p_WC_W = answer.contacts.p_WC_W[contact]
    struck_W = dict(
        zip(impact.path_contacts[:before], impact.path_W[:before], strict=True)
    )  # the last vertex of each contact
    pushes = [(answer.contacts.p_WC_W[i], impulse_W) for i, impulse_W in struck_W.items()]
    velocity_W = _velocity_of_point(body, state, p_WC_W, pushes)
    if (surfaces_W := answer.contacts.surface_velocities_W) is not None:
        velocity_W = velocity_W - surfaces_W[contact]
    response_W = contact_inverse_inertia(body, state, p_WC_W - state.p_WB_W)
    if answer.other is not None and other is not None:
        struck = answer.other.state
        pushes = [(p_W, -impulse_W) for p_W, impulse_W in pushes]
        velocity_W = velocity_W - _velocity_of_point(other, struck, p_WC_W, pushes)
        response_W = response_W + contact_inverse_inertia(other, struck, p_WC_W - struck.p_WB_W)
    return velocity_W, response_W


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
