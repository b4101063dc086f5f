# SPDX-License-Identifier: Apache-2.0
"""How the contacts of a body in space can separate, stick and slide together, whatever the forces.

Rays through a contact divide its tangent plane into the sectors of its friction pyramid. They define planes
in the space of accelerations, which cut the accelerations that do not penetrate into the faces of an
arrangement. `spatial.sliding` does the same for lines in fixed directions. This file takes the pyramids of a
case, and centripetal terms.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact_modes.letters import SEPARATES, STAYS, STICKS
from contact_dynamics.contact_modes.spatial.kinematic import cone_faces
from contact_dynamics.contact_modes.spatial.sliding import open_faces
from contact_dynamics.contact_modes.spatial.wrenches import Way
from contact_dynamics.errors import TooLargeError, UndecidedError
from contact_dynamics.numerics.linear_spaces import null_space
from contact_dynamics.tolerances import ROW_TOLERANCE

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.spatial.options import Pyramid
    from contact_dynamics.contact_modes.spatial.pyramid_programs import Touching
    from contact_dynamics.contact_modes.spatial.search import Search
    from contact_dynamics.validation import FloatArray

MAX_MEETINGS: Final = 10_000
"""The largest number of sets of planes of one arrangement whose common lines are computed, in about a
second."""


def ways_of(search: Search) -> list[tuple[Way, ...]]:
    """Return all that touching contacts can do together, each with a `Way` for every contact.

    Raises:
        TooLargeError: more than `MAX_MEETINGS` sets of planes meet in lines.
        UndecidedError: rounding decides which ways of sliding there are.
    """
    touching = search.touching
    height = np.eye(1, 7, 6)
    normals = [(contact.normal @ contact.point)[None, :] for contact in touching]
    rows = np.vstack([*normals, height])
    rows /= np.linalg.norm(rows, axis=1)[:, None]
    cuts = [_borders(of, pyramid) for of, pyramid in zip(touching, search.pyramids, strict=True)]
    below = 1 << len(touching)
    found: dict[tuple[Way, ...], None] = {}
    for face in cone_faces(rows):
        if face & below:
            continue
        stay = [i for i in range(len(touching)) if face >> i & 1]
        leave = [i for i in range(len(touching) + 1) if not face >> i & 1]
        free = null_space(rows[stay])
        above, cut = rows[leave] @ free, np.vstack([np.zeros((0, 7)), *(cuts[i] for i in stay)]) @ free
        _check_size(np.vstack([above, cut]))
        for signs in open_faces(above, cut):
            ways, at = [Way(SEPARATES, -1)] * len(touching), 0
            for i in stay:
                ways[i] = _way(signs[at : at + len(cuts[i])], len(search.pyramids[i].edges))
                at += len(cuts[i])
            found[tuple(ways)] = None
    rest = tuple(Way(STAYS if one.frame is None else STICKS, -1) for one in search.pyramids)
    if rest not in found and not any(np.any(contact.point[:, -1]) for contact in touching):
        raise _undecided()  # nothing keeps a body from resting
    return list(found)


def sliding_range(pyramid: Pyramid, way: Way) -> tuple[FloatArray, FloatArray]:
    """Return the unit tangents, (3,) each, between which a contact slides, anticlockwise about its normal.

    Both are zero where it does not slide or may slide any way. They are equal where it slides in that one
    direction.
    """
    if way.item < 0 or pyramid.frame is None:
        return np.zeros(3), np.zeros(3)
    count = len(pyramid.edges)
    first = (way.item + 1) // 2 - 0.5 if way.item % 2 == 0 else way.item // 2 + 0.5
    angles = 2.0 * math.pi / count * np.array([first, first + (way.item % 2 == 0)]) + math.pi
    one, two = pyramid.frame
    low, high = (math.cos(angle) * one + math.sin(angle) * two for angle in angles)
    return low, high


def _borders(contact: Touching, pyramid: Pyramid) -> FloatArray:
    """Return rows, (k, 7), that are positive where a contact slides anticlockwise of a border.

    Each sector of sliding is opposite to an edge, and border j lies between sectors j and j + 1. If their
    number is even, the second half would be the first half's rows, reversed, and is left out. A contact whose
    direction of sliding does not matter has no rows.
    """
    if pyramid.frame is None:
        return np.zeros((0, 7))
    count = len(pyramid.edges)
    angles = math.pi / count * (2.0 * np.arange(count if count % 2 else count // 2) + 1.0)
    quarter_on = np.column_stack([np.sin(angles), -np.cos(angles)])
    return quarter_on @ np.array(pyramid.frame) @ contact.point


def _way(signs: list[int], count: int) -> Way:
    """Return what a contact that stays does, from the side of each of its borders that it slides to.

    Args:
        signs: The sides, in the order of the borders.
        count: The number of edges of its pyramid.
    """
    if not signs:
        return Way(STAYS, -1)
    if not any(signs):
        return Way(STICKS, -1)
    if len(signs) < count:
        signs = [*signs, *(-sign for sign in signs)]
    for k, sign in enumerate(signs):
        after = signs[(k + 1) % count]
        if sign == 0 and after < 0:
            return Way(STAYS, 2 * k + 1)
        if sign > 0 and after < 0:
            return Way(STAYS, 2 * ((k + 1) % count))
    raise _undecided()


def _check_size(rows: FloatArray) -> None:
    rank = int((np.linalg.svd(rows, compute_uv=False) > ROW_TOLERANCE).sum())
    meetings = math.comb(len(rows), max(rank - 1, 0))
    if meetings > MAX_MEETINGS:
        raise TooLargeError(
            "contacts",
            f"{meetings} sets of planes that part their ways of sliding",
            f"at most {MAX_MEETINGS}: fewer contacts, or fewer friction_facets",
        )


def _undecided() -> UndecidedError:
    return UndecidedError(
        "contacts and their normals must be either the same or clearly apart, got ways of sliding that "
        "rounding decides"
    )
