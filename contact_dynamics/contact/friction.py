"""Coulomb's friction in space as a cone of forces with flat sides.

Model: the contact force obeys f_n >= 0 and |f_t| <= mu f_n. The round cone is replaced by a pyramid inside
it, with a stated number of edges.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.numerics.vectors import tangents_towards
from contact_dynamics.validation import check_whole

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray


MOST_FACETS: Final = 1000
"""Largest number of edges of a friction pyramid. It leaves out 5e-6 of friction, and more edges only take
memory."""


def check_facets(facets: int) -> int:
    """Return the number of a friction pyramid's edges, or raise `InvalidFieldError`."""
    return check_whole("friction_facets", facets, 3, MOST_FACETS)


def linearised_cone(
    normal: FloatArray, friction: float, facets: int, *, towards: FloatArray | None = None
) -> FloatArray:
    """Return the edges, (facets, 3), of a pyramid inside the round friction cone about a unit normal, (3,).

    Each edge is the normal plus friction times a unit tangent. The tangents are evenly spread, so the pyramid
    allows at least cos(pi / facets) of the cone's tangential force in every direction. The first edge leans
    towards ``towards``, (3,), if given.

    Raises:
        InvalidFieldError: ``facets`` is not a whole number from 3 to `MOST_FACETS`.
    """
    check_facets(facets)
    one, two = tangents_towards(normal, towards)
    angles = 2.0 * math.pi * np.arange(facets) / facets
    edges: FloatArray = normal + friction * (np.outer(np.cos(angles), one) + np.outer(np.sin(angles), two))
    return edges
