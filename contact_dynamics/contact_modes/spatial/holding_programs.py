"""Linear programs that hold all modes with some letters and some directions of sliding.

Each asks for less than its modes do. A contact that slides in a range of directions has a force in the cone
of three edges that holds all friction against them: the two at the ends, and the crossing of the tangents
there. A contact that sticks has a pyramid around its round cone. So if no forces satisfy the program, there
is no mode.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np

from contact_dynamics.contact.friction import linearised_cone
from contact_dynamics.contact_modes.letters import SEPARATES, STICKS
from contact_dynamics.contact_modes.spatial.careful_program import CarefulProgram
from contact_dynamics.contact_modes.spatial.dual_simplex import Narrowing, Program
from contact_dynamics.contact_modes.spatial.options import MILDER

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from contact_dynamics.contact_modes.spatial.search import Search
    from contact_dynamics.validation import FloatArray

_MOST_PROGRAMS: Final = 3000
"""The search for missed modes is given up after this many linear programs of 0.1 ms."""

_CARE: Final = 10
"""A program that is solved with care counts as so many."""

COARSE: Final = 16
"""The number of edges of a coarse pyramid around a round cone. Its friction is too large by 2 %."""

FINE: Final = 128
"""The number of edges of a fine one. Its friction is too large by 0.03 %."""

UNKNOWN: Final = "?"
"""The letter of a contact that is not decided yet."""

Ranges: TypeAlias = dict[int, tuple[float, float]]
"""For contacts that slide, the first and the last direction, rad, in the frames of their pyramids."""


_CONSTANT: Final = np.eye(1, 7, 6)


class TooManyError(Exception):
    """There are too many sets of letters and directions."""


class HoldingPrograms:
    """The programs of one search, whose strict inequalities hold by at least ``least``."""

    def __init__(self, search: Search, least: float) -> None:
        """Prepare the pyramids around the round cones."""
        self._search = search
        self._least = least
        self._around = {facets: _around_cones(search, facets) for facets in (COARSE, FINE)}
        self._programs = 0

    def forces(self, letters: str, ranges: Ranges, facets: int = COARSE) -> FloatArray | None:
        """Return forces, (n, 3), that satisfy what modes in a set must, or None if there are none.

        Where rounding hides that there are none, they are zero.

        Raises:
            TooManyError: too many programs were asked for.
        """
        self._programs += 1
        if self._programs > _MOST_PROGRAMS:
            raise TooManyError
        search = self._search
        edges: list[FloatArray] = []
        zero, positive = [np.zeros((0, 7))], [np.zeros((0, 7))]
        for i, (letter, contact) in enumerate(zip(letters, search.touching, strict=True)):
            normal = (contact.normal @ contact.point)[None, :]
            edges.append(self._around[facets][i])
            if letter == SEPARATES:
                edges[i] = edges[i][:0]
                positive.append(normal - self._least * _CONSTANT)
            elif letter == UNKNOWN:
                positive.append(normal)
            elif letter == STICKS:
                zero.append(contact.point)
            else:
                zero.append(normal)
                if i in ranges:
                    edges[i], rows = self._range(i, *ranges[i])
                    positive.append(rows)
        owners = np.repeat(np.arange(len(edges)), [len(one) for one in edges])
        every = np.vstack(edges)
        table = np.einsum("ijk,ik->ji", search.of_forces.reshape(6, -1, 3).transpose(1, 0, 2)[owners], every)
        sizes = np.linalg.norm(table, axis=0)
        every = every / sizes[:, None]  # so that the unit of mass does not matter
        table = np.column_stack([table / sizes, search.motion[:, -1]])
        rows = np.vstack([*zero, *positive])
        equalities = sum(len(one) for one in zero)
        names = range(len(every), len(every) + len(rows))
        program = Program.stated(table, rows, names).renamed(list(range(len(every))), equalities)
        holds = program.solve()
        if not holds and program.doubtful:
            self._programs += _CARE
            careful = CarefulProgram(table, rows[:0], ()).narrowed(
                Narrowing(rows=rows, equalities=equalities)
            )
            if careful.solve():
                return _summed(careful.shares(len(every)), every, owners, len(edges))
            return np.zeros((len(edges), 3)) if careful.doubtful else None
        return _summed(program.shares(len(every)), every, owners, len(edges)) if holds else None

    def _range(self, at: int, low: float, high: float) -> tuple[FloatArray, FloatArray]:
        """Return edges, (3, 3), of a contact that slides in a range of directions, and conditions, (3, 7)."""
        contact, frame = self._search.touching[at], np.array(self._search.pyramids[at].frame)
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        ways = np.array([(math.cos(angle), math.sin(angle)) for angle in (low, middle, high)])
        leaning = contact.friction * np.array([1.0, 1.0 / math.cos(half), 1.0])[:, None]
        inward = np.array([(-ways[0, 1], ways[0, 0]), ways[1], (ways[2, 1], -ways[2, 0])])
        rows = inward @ frame @ contact.point
        rows[1, -1] -= MILDER * self._least
        return contact.normal - leaning * (ways @ frame), rows


def _summed(shares: FloatArray, edges: FloatArray, owners: NDArray[np.intp], count: int) -> FloatArray:
    """Return the forces, (n, 3), of shares, (k,), of edges, (k, 3), of their owners."""
    forces = np.zeros((count, 3))
    np.add.at(forces, owners, shares[:, None] * edges)
    return forces


def _around_cones(search: Search, facets: int) -> list[FloatArray]:
    """Return the edges of each contact's forces, with pyramids around round cones."""
    wider = 1.0 / math.cos(math.pi / facets)
    return [
        pyramid.edges
        if pyramid.frame is None
        else linearised_cone(contact.normal, wider * contact.friction, facets)
        for contact, pyramid in zip(search.touching, search.pyramids, strict=True)
    ]
