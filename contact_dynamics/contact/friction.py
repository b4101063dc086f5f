# SPDX-License-Identifier: Apache-2.0
"""Coulomb's friction in space is a cone of forces. This file gives it flat sides.

Model: the contact force obeys f_n >= 0 and |f_t| <= mu f_n. The round cone is replaced by a pyramid inside
it, with a stated number of edges.
"""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.numerics.vectors import tangents_towards
from contact_dynamics.tolerances import LARGEST_NUMBER
from contact_dynamics.validation import FloatArray, check_array, check_not_negative, check_unit, check_whole

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


MAX_FACETS: Final = 1000
"""Largest number of edges of a friction pyramid. It leaves out 5e-6 of friction, and more edges only take
memory."""


def check_facets(facets: int) -> int:
    """Return the number of a friction pyramid's edges, or raise `InvalidFieldError`."""
    return check_whole("friction_facets", facets, 3, MAX_FACETS)


def linearised_cone(
    normal: ArrayLike, friction: float, facets: int, *, towards: ArrayLike | None = None
) -> FloatArray:
    """Return the edges, (facets, 3), of a pyramid inside the round friction cone about a unit normal, (3,).

    Each edge is the normal plus friction times a unit tangent. The tangents are evenly spaced, so the pyramid
    allows at least cos(pi / facets) of the cone's tangential force in every direction. If ``towards``, (3,),
    is given, the tangent of the first edge points towards it.

    Raises:
        InvalidFieldError: ``facets`` is not a whole number from 3 to `MAX_FACETS`, the normal is not a unit
            vector, the friction is negative, or a number is not finite.
    """
    unit = check_unit("normal", normal, 3)
    lean = None if towards is None else check_array("towards", towards, (3,))
    if lean is not None and (largest := float(np.abs(lean).max())) > LARGEST_NUMBER:
        lean = lean / largest
    number = check_whole("facets", facets, 3, MAX_FACETS)
    return edges_in_frame(
        unit, check_not_negative("friction", friction), number, tangents_towards(unit, lean)
    )


def edges_in_frame(
    normal: FloatArray, friction: float, facets: int, tangents: tuple[FloatArray, FloatArray]
) -> FloatArray:
    """Return the edges, (facets, 3), of `linearised_cone`, the first along the first tangent."""
    cosines, sines = _circle(facets)
    edges: FloatArray = normal + friction * (cosines * tangents[0] + sines * tangents[1])
    return edges


@cache
def _circle(facets: int) -> tuple[FloatArray, FloatArray]:
    """Return cosines and sines, (facets, 1) each, of directions that are evenly spread."""
    angles = 2.0 * math.pi * np.arange(facets)[:, None] / facets
    cosines, sines = np.cos(angles), np.sin(angles)
    for one in (cosines, sines):
        one.flags.writeable = False
    return cosines, sines
