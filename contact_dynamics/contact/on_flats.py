# SPDX-License-Identifier: Apache-2.0
"""This file finds where a convex body touches a plane: the extreme points, with the body's curvature there.

`found` says which points a face, a line and a rim have.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

import numpy as np

from contact_dynamics.numerics.vectors import along_least
from contact_dynamics.shapes.rim import radii_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from contact_dynamics.shapes.convex import ConvexShape
    from contact_dynamics.shapes.rim import Radii
    from contact_dynamics.validation import FloatArray

    Side: TypeAlias = tuple[float, float, FloatArray]

RIM_POINTS: Final = 8
"""Number of contacts of a rim that lies flush."""


class Touch(NamedTuple):
    """One extreme point of where a body touches, with curvatures of both sides (`contact.curvature`).

    Attributes:
        p_WC_W: (3,), m, the point in the world.
        normal_W: (3,), unit, into the body.
        body: Curvatures, 1/m, along a tangent and across it, and the tangent, (3,), unit.
    """

    p_WC_W: FloatArray
    normal_W: FloatArray
    body: Side
    surface: Side


def flat_touches(
    shape: ConvexShape,
    p_WB_W: FloatArray,
    R_WB: FloatArray,
    n_W: FloatArray,
    *,
    level: float,
    tolerance: float,
) -> Iterator[Touch]:
    """Yield where a body at a pose touches the plane n . p = ``level``, m, of a unit normal, (3,).

    Corners come first, then rims. A point touches if it is at most ``tolerance``, m, above the plane.
    """
    points = p_WB_W + shape.vertices @ R_WB.T
    tangent = along_least(n_W)
    corner = 1.0 / shape.rounding if shape.rounding > 0.0 else math.inf
    for i in np.flatnonzero(points @ n_W - level - shape.rounding <= tolerance):
        p_WC_W = points[i] - shape.rounding * n_W
        yield Touch(p_WC_W, n_W, (corner, corner, tangent), (0.0, 0.0, tangent))
    for rim in shape.rims:
        turned = _turned(radii_of(rim), p_WB_W, R_WB)
        yield from _of_rim(turned, n_W, level, rounding=shape.rounding, tolerance=tolerance)


class _RimW(NamedTuple):
    """A rim in the world."""

    center: FloatArray  # (3,), m
    first: FloatArray  # (3,), m, a radius
    second: FloatArray  # (3,), m, one across
    radius: float  # m


def _turned(radii: Radii, p_WB_W: FloatArray, R_WB: FloatArray) -> _RimW:
    first, second = R_WB @ radii.first, R_WB @ radii.second
    return _RimW(p_WB_W + R_WB @ radii.center, first, second, math.sqrt(first @ first))


def _of_rim(
    rim: _RimW, n_W: FloatArray, level: float, *, rounding: float, tolerance: float
) -> Iterator[Touch]:
    height = float(rim.center @ n_W) - level - rounding
    a_1, a_2 = float(n_W @ rim.first), float(n_W @ rim.second)
    size = math.hypot(a_1, a_2)  # m, R sin(theta)
    if height - size > tolerance:
        return
    flush = height + size <= tolerance
    corner = 1.0 / rounding if rounding > 0.0 else math.inf
    tangent = along_least(n_W)
    flat = (0.0, 0.0, tangent)
    if flush:
        turns = [2.0 * math.pi * i / RIM_POINTS for i in range(RIM_POINTS)]
        directions = [(math.cos(turn), math.sin(turn)) for turn in turns]
    else:
        directions = [(-a_1 / size, -a_2 / size)]
    for cosine, sine in directions:
        p_WC_W = rim.center + cosine * rim.first + sine * rim.second - rounding * n_W
        if flush:
            yield Touch(p_WC_W, n_W, (corner, corner, tangent), flat)
        else:
            around = (cosine * rim.second - sine * rim.first) / rim.radius  # level: along the rim
            radius = rim.radius * rim.radius / size + rounding
            yield Touch(p_WC_W, n_W, (1.0 / radius, corner, around), flat)
