"""Impulse space of a contact in space has all three components (Mason, lecture 27; Keller 1986).

The friction cone is round there. The impulses after which the contact does not slide form a line, and those
after which it does not approach form a plane. The path swerves in the cone until it meets the sticking line,
which it follows if friction can hold the contact. Where it meets the compression plane, compression ends.
`impulse_space` shows the same in a plane, as a projection.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.diagrams.impulse_space import (
    EVENTS,
    MARGIN,
    contact_axes,
    contact_motion,
    main_contact,
)
from contact_dynamics.impact.law import PathEvent

if TYPE_CHECKING:
    from contact_dynamics.questions.impact_answer import ImpactAnswer
    from contact_dynamics.rigid_body.body import MassProperties
    from contact_dynamics.validation import FloatArray

_RINGS: Final = 4
_ROUND: Final = 49  # points of a ring, the last one is the first
_RAYS: Final = 12


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ImpulseSpaceIn3D:
    """A contact's impulses, N s, with coordinates along two tangents and the normal.

    Attributes:
        axes_W: (3, 3), unit, right-handed: the first tangent, which is that of the picture in the plane, the
            second tangent, and the normal, world axes.
        extent: N s, how far the picture reaches.
        cone: Strips on the friction cone, (k, 3) each: rings, then rays from the tip.
        path: (k, 3), the vertices of the path.
        sticking: (2, 3), the ends of the shown part of the sticking line, or (0, 3) without any.
        compression: (4, 3), corners of the shown part of the compression plane in turn, or (0, 3).
        events: (m,), what is marked.
        points: (m, 3), where.
    """

    axes_W: FloatArray
    extent: float
    cone: tuple[FloatArray, ...]
    path: FloatArray
    sticking: FloatArray
    compression: FloatArray
    events: tuple[PathEvent, ...]
    points: FloatArray

    @property
    def compression_in_view(self) -> FloatArray:
        """Return the corners of what the picture shows of the compression plane, (k, 3), in turn.

        A steep plane leaves the picture at its top and at its bottom, where no impulse is negative.
        """
        corners = self.compression
        for side, limit in ((1.0, self.extent), (-1.0, 0.0)):  # side * height <= limit
            kept: list[FloatArray] = []
            for i, corner in enumerate(corners):
                last = corners[i - 1]
                over, last_over = side * corner[2] - limit, side * last[2] - limit
                if over * last_over < 0.0:
                    kept.append(last + last_over / (last_over - over) * (corner - last))
                if over <= 0.0:
                    kept.append(corner)
            corners = np.reshape(kept, (-1, 3))
        return corners if len(corners) > 2 else np.zeros((0, 3))


def impulse_space_in_3d_of(
    mass_properties: MassProperties | None, answer: ImpactAnswer, *, other: MassProperties | None = None
) -> ImpulseSpaceIn3D:
    """Return the picture of an impact's main contact, with the lines of its first strike.

    Args:
        mass_properties: Those of the body. Without them there is no sticking line and no compression plane.
        answer: The impact.
        other: Mass properties of the body that is struck. Without them there are none for two bodies.
    """
    impact = answer.impact
    contact = main_contact(impact)
    tangent_W, normal_W = plane_axes_W = contact_axes(answer, contact)
    axes_W = np.array([tangent_W, np.cross(normal_W, tangent_W), normal_W])
    chosen = [i for i, owner in enumerate(impact.path_contacts) if owner == contact]
    path = impact.path_W[chosen] @ axes_W.T
    extent = MARGIN * float(np.abs(path).max(initial=0.0)) or 1.0
    marked = [i for i in chosen if impact.path_events[i] in EVENTS]
    ends = [k for k, i in enumerate(marked) if impact.path_events[i] == PathEvent.RESTITUTION_ENDS]
    marked = marked[: ends[0] + 1] if ends else marked
    sticking = compression = np.zeros((0, 3))
    if mass_properties is not None and (answer.other is None or other is not None):
        motion = contact_motion(
            mass_properties, answer, contact, plane_axes_W, other=other, before=chosen[0] if chosen else 0
        )
        # From tangent, normal and out of the picture to the axes of this picture, and the other way.
        turned = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
        velocity, response = turned @ motion.velocity, turned @ motion.response @ turned.T
        sticking = _sticking_line(velocity, response, extent)
        compression = _compression_plane(velocity, response, extent)
    return ImpulseSpaceIn3D(
        axes_W=axes_W,
        extent=extent,
        cone=_cone(float(answer.contacts.frictions[contact]), extent),
        path=path,
        sticking=sticking,
        compression=compression,
        events=tuple(impact.path_events[i] for i in marked),
        points=impact.path_W[marked] @ axes_W.T,
    )


def _cone(friction: float, extent: float) -> tuple[FloatArray, ...]:
    """Return rings and rays of the cone, up to where it leaves the picture at the top or at the sides."""
    height = extent / max(1.0, friction)
    turns = np.linspace(0.0, 2.0 * math.pi, _ROUND)
    ring = np.column_stack([friction * np.cos(turns), friction * np.sin(turns), np.ones(_ROUND)])
    rings = [height * (i + 1) / _RINGS * ring for i in range(_RINGS)]
    edge = height * ring[: -1 : (_ROUND - 1) // _RAYS]
    return (*rings, *(np.array([[0.0, 0.0, 0.0], end]) for end in edge))


def _sticking_line(velocity: FloatArray, response: FloatArray, extent: float) -> FloatArray:
    """Return the ends of the part of the sticking line whose normal impulse is shown and whose sides fit.

    Both tangential velocities are zero: response[:2] @ x = -velocity[:2], solved for the tangential impulses.
    """
    start, slope = np.linalg.solve(
        response[:2, :2], np.column_stack([-velocity[:2], -response[:2, 2]])
    ).T.tolist()
    begin, end = 0.0, extent
    for at_zero, rise in zip(start, slope, strict=True):
        if rise == 0.0:
            if abs(at_zero) > extent:
                return np.zeros((0, 3))
            continue
        first, last = sorted(((-extent - at_zero) / rise, (extent - at_zero) / rise))
        begin, end = max(begin, first), min(end, last)
    if begin >= end:
        return np.zeros((0, 3))
    return np.array([[*(np.array(start) + n * np.array(slope)), n] for n in (begin, end)])


def _compression_plane(velocity: FloatArray, response: FloatArray, extent: float) -> FloatArray:
    """Return the corners of the part of the plane without approach over the inner square of the picture."""
    half = 0.5 * extent
    corners = np.array([[-half, -half], [half, -half], [half, half], [-half, half]])
    heights = -(velocity[2] + corners @ response[2, :2]) / response[2, 2]
    plane: FloatArray = np.column_stack([corners, heights])
    return plane
