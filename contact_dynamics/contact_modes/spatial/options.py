# SPDX-License-Identifier: Apache-2.0
"""The conditions of each letter of one contact in space: separate, stick, or slide within a sector.

Letters are the leaves of a tree of groups. A group asks for no more than each of its letters does. So if a
group cannot hold, all its letters are refused together (`search`).

The edges of a contact's friction pyramid are numbered around it, and items of sliding with them: 2 j is the
sector of directions opposite to edge j, 2 j + 1 its border with the next sector.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact.friction import edges_in_frame
from contact_dynamics.contact_modes.letters import SEPARATES, STAYS, STICKS
from contact_dynamics.numerics.vectors import tangents_towards
from contact_dynamics.tolerances import AT_SECTORS_BORDER, STRICT

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from contact_dynamics.validation import FloatArray

MILDER: Final = 0.1
"""How much less an arc demands than its letters do, whose rows are differences of unit rows."""


class Option(NamedTuple):
    """One letter of a contact, or a group of letters."""

    letter: str  # s, f or c, also for an arc of directions; empty for a group of different letters
    item: int  # the item of sliding, or -1 where there is none or several
    zeroed: frozenset[int]  # the names of edge forces, and of a normal acceleration, that are zero
    raised: int | None  # the name of the normal acceleration where that is positive, or None
    rows: FloatArray  # (k, d + 1), whose products with the motion, followed by 1, are zero or not negative
    equalities: int  # the number of rows, from the first, whose products are zero
    parts: tuple[Option, ...]  # the smaller groups that it consists of; empty if it is a single letter


class Touching(NamedTuple):
    """A contact that neither approaches nor leaves."""

    normal: FloatArray  # (3,), unit
    friction: float  # Coulomb's mu of a contact that slides or begins to slide
    sliding: FloatArray  # (3,), m/s, its tangential velocity; zero where it is at rest
    point: FloatArray  # (3, d + 1), its acceleration as a function of the motion, which has d components
    free: FloatArray  # (3,), its acceleration without contact forces
    holding: float  # Coulomb's mu of a contact that sticks, which is not less


class Pyramid(NamedTuple):
    """The edges of a contact's force: a friction pyramid, or one edge where friction or sliding is known."""

    edges: FloatArray  # (K, 3), forces with a unit normal part
    frame: tuple[FloatArray, FloatArray] | None  # unit tangents, edge 0 leans along the first; None: one edge
    first: int  # the name of the first edge force. The names of the others follow it.
    further: FloatArray = np.zeros((0, 3))  # (L, 3), those of a contact that sticks, if it has more friction

    @property
    def every(self) -> FloatArray:
        """All edges, (K + L, 3)."""
        return np.concatenate([self.edges, self.further]) if len(self.further) > 0 else self.edges

    @property
    def sticking(self) -> FloatArray:
        """The edges of the force of a contact that sticks, or may stick."""
        return self.further if len(self.further) > 0 else self.edges

    def tangential(self) -> FloatArray:
        """Return the components of the edges along the frame, (K, 2)."""
        along: FloatArray = self.edges @ np.array(self.frame).T
        return along


def pyramid_of(contact: Touching, facets: int, first: int) -> Pyramid:
    """Return the force edges of a touching contact. The first edge opposes its motion without forces."""
    normal, friction, sliding, _, free, holding = contact
    speed = float(np.linalg.norm(sliding))
    if holding == 0.0:
        return Pyramid(normal[None, :], None, first)
    if speed > 0.0:
        return Pyramid((normal - friction * sliding / speed)[None, :], None, first)
    frame = tangents_towards(normal, -free)
    pyramid = Pyramid(edges_in_frame(normal, friction, facets, frame), frame, first)
    if holding > friction:
        pyramid = pyramid._replace(further=edges_in_frame(normal, holding, facets, frame))
    return pyramid


def any_letter(pyramid: Pyramid, point: FloatArray, normal_name: int) -> Option:
    """Return the letters s and f of one touching contact, as a group.

    `ways_of_sliding` returns the others.
    """
    own = range(pyramid.first, pyramid.first + len(pyramid.every))
    count = len(pyramid.edges)
    nothing = np.zeros((0, point.shape[1]))
    separates = Option(SEPARATES, -1, frozenset(own), normal_name, nothing, 0, ())
    zeroed = frozenset([normal_name])
    if pyramid.frame is None:
        stays = Option(STAYS, -1, zeroed, None, nothing, 0, ())
    else:
        weaker = frozenset(own[:count] if len(own) > count else ())
        sticks = Option(STICKS, -1, weaker, None, np.array(pyramid.frame) @ point, 2, ())
        stays = Option("", -1, zeroed, None, nothing, 0, (sticks,))
    return Option("", -1, frozenset(), None, nothing, 0, (separates, stays))


def ways_of_sliding(
    pyramid: Pyramid, point: FloatArray, acting: tuple[int, int] | None = None
) -> tuple[Option, ...]:
    """Return the letters of a contact that slides, in arcs of directions that together go around the circle.

    If only some neighbouring edges can oppose the sliding, ``acting`` is the first of them and their number.
    """
    count = len(pyramid.edges)
    angles = 2.0 * math.pi * np.arange(count) / count
    # The acceleration along each edge's tangential part, (K, d + 1), as functions of the motion.
    along = np.column_stack([np.cos(angles), np.sin(angles)]) @ np.array(pyramid.frame) @ point
    # Sectors and borders alternate around the circle; no arc may be wider than a third of it.
    if acting is None:
        arcs = np.array_split(np.arange(2 * count), count if count < 6 else 4)
    else:
        items = 2 * acting[0] + np.arange(2 * acting[1] - 1)
        arcs = np.array_split(items, min(len(items), math.ceil(1.5 * len(items) / count)))
    return tuple(_slides(arc.tolist(), pyramid, along) for arc in arcs)


def _slides(arc: list[int], pyramid: Pyramid, along: FloatArray) -> Option:
    """Return the letters of sliding within an arc: the edge against it has the least product with it."""
    count = len(along)
    first, last = arc[0], arc[-1]
    acting = {(item + side) // 2 % count for item in arc for side in (0, 1)}
    silent = frozenset(pyramid.first + j for j in range(len(pyramid.every)) if j not in acting)
    if len(arc) > 1:
        low, high = (first - 1) // 2, last // 2
        middle = -np.mean([along[item // 2 % count] for item in arc if item % 2 == 0], axis=0)
        middle[-1] -= MILDER * STRICT
        sides = [
            along[low % count] - along[(low + 1) % count],
            along[(high + 1) % count] - along[high % count],
        ]
        halves = (arc[: len(arc) // 2], arc[len(arc) // 2 :])
        parts = tuple(_slides(half, pyramid, along) for half in halves)
        return Option(STAYS, -1, silent, None, np.array([middle, *sides]), 0, parts)
    first %= 2 * count
    j, k = first // 2, (first + 1) // 2 % count
    sides = [along[(j - 1) % count] - along[j], along[(k + 1) % count] - along[k]]
    for side in sides:
        side[-1] -= STRICT
    if j == k:
        return Option(STAYS, first, silent, None, np.array(sides), 0, ())
    return Option(STAYS, first, silent, None, np.array([along[j] - along[k], *sides]), 1, ())


def acting_edges(directions: FloatArray, count: int) -> NDArray[np.bool_]:
    """Return which of ``count`` edges of each contact's pyramid can oppose some sliding, (m, count).

    Each contact slides along positive sums of directions, (m, 2, p), in its frame; if they can vanish, any
    may act.
    """
    starts, ranges, clear = ranges_of(directions)
    sector = 2.0 * math.pi / count
    start = (starts - math.pi) / sector + 0.5
    first = np.floor(start - AT_SECTORS_BORDER)
    more = np.floor(start + ranges / sector + AT_SECTORS_BORDER) - first
    acting: NDArray[np.bool_] = (np.arange(count) - first[:, None]) % count <= more[:, None]
    acting[~clear] = True
    return acting


def ranges_of(directions: FloatArray) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
    """Return in which range of directions each contact slides: where it begins, its width, both rad.

    The third value is false where the contact may slide in opposite directions, or stick.
    """
    x, y = directions[:, 0], directions[:, 1]
    angles = np.arctan2(y, x)
    angles.sort(axis=1)
    gaps = np.empty_like(angles)
    gaps[:, :-1] = angles[:, 1:]
    gaps[:, -1] = angles[:, 0] + 2.0 * math.pi
    gaps -= angles
    widest = gaps.argmax(axis=1)
    each = np.arange(len(angles))
    ranges = 2.0 * math.pi - gaps[each, widest]
    least = (x * x + y * y).min(axis=1)
    clear = (ranges < math.pi - AT_SECTORS_BORDER) & (least > AT_SECTORS_BORDER**2)
    return angles[each, (widest + 1) % angles.shape[1]], ranges, clear
