# SPDX-License-Identifier: Apache-2.0
"""This file finds all modes that some acceleration realises without penetration (Mason, lecture 26, "5^n?").

The accelerations that do not penetrate are a polyhedral cone. A contact stays (l, r or f) only on its own
facet of that cone, and its tangential row cuts the facet in two. So a mode is a cell: a piece of a face on
which no letter changes. There are only a few times as many faces and cells as contacts. Of the 4^n strings at
most about 4 n + 2 are possible, and a walk over the faces finds them without trying the others.

With centripetal terms the polyhedron of accelerations misses the origin. It is then the section at height one
of the cone whose rows `problem.lifted` returns, and cells with height zero do not count.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

from contact_dynamics.contact_modes.letters import SEPARATES, SLIDES_LEFT, SLIDES_RIGHT, STICKS
from contact_dynamics.contact_modes.planar.cone import PolyhedralCone, Sector, bits
from contact_dynamics.contact_modes.planar.problem import PlanarCase, lifted
from contact_dynamics.numerics.vectors import Vector3, dot, normalised
from contact_dynamics.tolerances import SAME_ROWS

if TYPE_CHECKING:
    from collections.abc import Iterator

SEPARATE = ord(SEPARATES)
LEFT = ord(SLIDES_LEFT)
RIGHT = ord(SLIDES_RIGHT)
FIXED = ord(STICKS)

_SLIDING: Final = {-1.0: LEFT, 0.0: 0, 1.0: RIGHT}

Letters: TypeAlias = tuple[tuple[int, int], ...]
"""The contacts that stay. Each has its position in the rows of the case, and the code of its letter."""


class Cell(NamedTuple):
    """The accelerations of one mode, which are the positive combinations of rays."""

    letters: Letters  # the letters of the contacts that stay
    rays: list[Vector3]  # unit vectors in the cone's coordinates, some twice; none if only zero is left


class _Tangent(NamedTuple):
    """The tangential acceleration of a contact."""

    row: Vector3  # a unit vector
    letter: int  # the code of the letter of a contact that slides already, or 0 if its acceleration decides


def kinematic_cells(case: PlanarCase) -> dict[str, Cell]:
    """Return the modes that are possible for a case with a touching contact, each with its accelerations."""
    lift = case.lift
    below = 0
    if lift is None:
        normals = [row.unit_n for row in case.rows]
        tangents = [_Tangent(row.unit_t, _SLIDING[row.slides]) for row in case.rows]
    else:
        below = 1 << len(case.rows)
        normals = [normalised(lifted(lift, row.N, row.b_n)) for row in case.rows]
        normals.append((0.0, 0.0, 1.0))
        tangents = [
            _Tangent(
                normalised(lifted(lift, row.T, row.b_t)) if row.slides == 0.0 else row.T,
                _SLIDING[row.slides],
            )
            for row in case.rows
        ]
    cone = PolyhedralCone(normals)
    base = bytearray(SEPARATES.encode() * len(case.contacts))
    cells: dict[str, Cell] = {}
    if cone.has_interior:
        cells[base.decode()] = Cell((), [ray for ray, _ in cone.edges()])
    for letters, rays in _all_cells(cone, tangents, below):
        text = bytearray(base)
        for position, letter in letters:
            text[case.rows[position].contact] = letter
        mode = text.decode()
        known = cells.get(mode)
        if known is None:
            cells[mode] = Cell(letters, rays)
        else:
            known.rays.extend(rays)
    return cells


def _all_cells(
    cone: PolyhedralCone, tangents: list[_Tangent], below: int
) -> Iterator[tuple[Letters, list[Vector3]]]:
    """Yield letters and rays of every cell of every face except the interior. Some come more than once."""
    for sector in cone.sectors():
        if not sector.tight & below:
            yield from _sector_cells(sector, tangents)
    for ray, tight in cone.edges():
        if not tight & below:
            yield tuple((i, _letter(tangents[i], dot(tangents[i].row, ray))) for i in bits(tight)), [ray]
    if not below and tangents:
        yield tuple((i, tangent.letter or FIXED) for i, tangent in enumerate(tangents)), []


def _letter(tangent: _Tangent, height: float) -> int:
    if tangent.letter:
        return tangent.letter
    if height > SAME_ROWS:
        return RIGHT
    return LEFT if height < -SAME_ROWS else FIXED


class _Staying(NamedTuple):
    """A contact that stays on the whole of a sector."""

    position: int  # in the rows of the case
    start: int  # the code of its letter on the sector's first ray
    end: int  # the code of its letter on the sector's last ray
    crossing: float  # the share of the way at which the letter changes from left to right or back, or -1


def _sector_cells(sector: Sector, tangents: list[_Tangent]) -> Iterator[tuple[Letters, list[Vector3]]]:
    """Yield the pieces into which the tangential rows of the contacts that stay cut a sector."""
    staying = [_staying(position, tangents[position], sector) for position in bits(sector.tight)]
    stops = [0.0]
    places: dict[int, int] = {}  # the number of the stop at which the letter of a contact changes
    for crossing, position in sorted((one.crossing, one.position) for one in staying if one.crossing >= 0.0):
        if not places or crossing - stops[-1] > SAME_ROWS:
            stops.append(crossing)
        places[position] = len(stops) - 1
    stops.append(1.0)
    points = [_between(sector, stop) for stop in stops]
    for k in range(1, len(stops)):
        yield _letters(staying, places, k - 0.5), [points[k - 1], points[k]]
        if k < len(stops) - 1:
            yield _letters(staying, places, k), [points[k]]
    if sector.halved:
        yield tuple((one.position, one.end) for one in staying), [sector.end]


def _staying(position: int, tangent: _Tangent, sector: Sector) -> _Staying:
    at_start = dot(tangent.row, sector.start)
    at_end = dot(tangent.row, sector.end)
    start, end = _letter(tangent, at_start), _letter(tangent, at_end)
    crosses = start != end and FIXED not in {start, end}
    return _Staying(position, start, end, at_start / (at_start - at_end) if crosses else -1.0)


def _letters(staying: list[_Staying], places: dict[int, int], at: float) -> Letters:
    """Return the letters at the stop with the number ``at``, or between two stops, where it ends in a half.

    ``places`` has the number of the stop at which each letter changes that does. Numbers are compared, and
    not the shares of the way, because two stops may be nearer to each other than rays that count as one.
    """
    found = []
    for position, start, end, _ in staying:
        place = places.get(position)
        if place is None:
            letter = end if start == FIXED else start
        elif at == place:
            letter = FIXED
        else:
            letter = start if at < place else end
        found.append((position, letter))
    return tuple(found)


def _between(sector: Sector, part: float) -> Vector3:
    a, b = sector.start, sector.end
    rest = 1.0 - part
    return normalised((rest * a[0] + part * b[0], rest * a[1] + part * b[1], rest * a[2] + part * b[2]))
