# SPDX-License-Identifier: Apache-2.0
"""Two orthogonal radii describe a rim. Its points and their heights follow from them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from contact_dynamics.numerics.vectors import near_x

if TYPE_CHECKING:
    from contact_dynamics.rotations.one import Vector
    from contact_dynamics.shapes.convex import Rim


class Radii(NamedTuple):
    """A rim as two orthogonal radii.

    Attributes:
        center: Position of the centre, m.
        first: The first radius, as a vector, m.
        second: The second radius, m.
        reach: A distance from the origin that no point of the rim exceeds, m.
    """

    center: Vector
    first: Vector
    second: Vector
    reach: float


def radii_of(rim: Rim) -> Radii:
    """Return two orthogonal radii of a rim. The first is towards x, or towards y for a rim about x."""
    axis = np.array(rim.axis)
    first = near_x(axis)
    first *= rim.radius / math.sqrt(first @ first)
    second = np.cross(axis, first)
    reach = math.hypot(*rim.center) + rim.radius
    return Radii(rim.center, _triple(first), _triple(second), reach)


def _triple(vector: np.ndarray) -> Vector:
    x, y, z = vector.tolist()
    return (x, y, z)
