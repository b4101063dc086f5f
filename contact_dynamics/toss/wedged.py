"""Whether friction may wedge a body between flats, so that several contact modes can be consistent.

A body that touches two flats can be held by forces between the two contacts alone, as large as one likes, if
the friction cone of one contact and the reversed one of the other share a line. So it may stick or fall,
whatever the load (a rod between two walls). Some cases with weaker friction have several modes too.
"""

from __future__ import annotations

import math
from itertools import combinations
from typing import TYPE_CHECKING, Final

from contact_dynamics.numerics.vectors import cross, dot, norm, opposite

if TYPE_CHECKING:
    from contact_dynamics.toss.solid import Flat, Solid, Touch

ENOUGH: Final = 0.75
"""Cones that have this share of the angle between one normal and the other reversed are looked at. Among 3000
drawn rods at rest or moving, with two tips on two flats and frictions up to 2, all that had several modes had
more. With a share of 1, a fifth of those on a floor and a wall would be missed."""


def may_be_wedged(solid: Solid, touching: list[Touch]) -> bool:
    """Return whether friction at some two contacts on different flats is large enough to be looked at."""
    flats = [solid.flats[surface] for surface in sorted({surface for surface, _ in touching})]
    return any(_cones_may_meet(one, other) for one, other in combinations(flats, 2))


def _cones_may_meet(one: Flat, other: Flat) -> bool:
    turned = opposite(other.normal)
    between = math.atan2(norm(cross(one.normal, turned)), dot(one.normal, turned))
    friction = math.atan(one.friction) + math.atan(other.friction)
    return friction > 0.0 and friction >= ENOUGH * between
