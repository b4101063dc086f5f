# SPDX-License-Identifier: Apache-2.0
"""Linear programs that hold all modes with some letters and some directions of sliding.

Each asks for less than its modes do. A contact that slides in a range of directions has a force in the hull
of all friction against them, whose edges are those at both ends and the crossings of tangents in between. A
contact that sticks has a pyramid around its round cone. So if no forces satisfy the program, there is no
mode.

In a region of common motions (`regions`), the power of the applied wrench must reach what friction takes
there. Friction takes at least what the same normal forces would along any fixed direction. What that leaves
is linear in the motion: if it is negative on each ray of a region, it is negative in all of it.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

import numpy as np

from contact_dynamics.contact_modes.letters import SEPARATES, STICKS
from contact_dynamics.contact_modes.spatial.dual_simplex import CarefulProgram, Narrowing, Program
from contact_dynamics.contact_modes.spatial.options import MILDER
from contact_dynamics.numerics.linear_spaces import seen_and_unseen
from contact_dynamics.tolerances import FEASIBLE, STRICT

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from contact_dynamics.contact_modes.spatial.regions import Image, Region
    from contact_dynamics.contact_modes.spatial.search import PyramidPrograms
    from contact_dynamics.validation import FloatArray

COARSE: Final = 16
"""The number of edges of a coarse pyramid around a round cone. Its friction is too large by 2 %."""

FINE: Final = 128
"""The number of edges of a fine one. Its friction is too large by 0.03 %."""

_PIECE: Final = 0.8
"""rad. Tangents to the friction of a range of directions touch it this far apart at most."""

_QUARTER: Final = 0.5 * math.pi

Ranges: TypeAlias = dict[int, tuple[float, float]]
"""For contacts that slide, the first and the last direction, rad, in the frames of their pyramids."""


class Within(NamedTuple):
    """A region of common motions."""

    region: Region  # the region
    image: Image  # the space in which it lies
    turning: list[int]  # the contacts that slide, in the order of the image's maps
    gains: FloatArray | None  # (p,), the power of the applied wrench on coordinates; None if it moves
    implied: frozenset[int] = frozenset()  # the contacts whose ranges of directions follow from the region


class _Edges(NamedTuple):
    """Edges of contact forces, in units in which each moves the body by one."""

    edges: FloatArray  # (k, 3)
    moved: FloatArray  # (k, d), the motion that each causes
    sizes: FloatArray  # (k,), the motion that a unit normal part of each causes
    owners: NDArray[np.intp]  # (k,), the contact of each


class HoldingPrograms:
    """The programs of one search, whose strict inequalities hold by at least ``least``."""

    def __init__(self, search: PyramidPrograms, least: float) -> None:
        """Prepare the pyramids around the round cones."""
        self._search = search
        self._least = least
        n = len(search.touching)
        self._frictions, self._points, self._rising = search.frictions, search.points, search.rising
        self._holding = search.holding
        frames = np.array([np.zeros((2, 3)) if p.frame is None else p.frame for p in search.pyramids])
        self._across = frames @ self._points  # (n, 2, d + 1)
        # Each contact's only edge, or the middle of its edges, and its tangents, with what they cause.
        axes = [
            p.edges[0] if p.frame is None else of.normal
            for p, of in zip(search.pyramids, search.touching, strict=True)
        ]
        units = np.concatenate([np.array(axes)[:, None], frames], axis=1)
        of_forces = search.of_forces.reshape(search.freedoms, n, 3).transpose(1, 2, 0)  # (n, 3, d)
        self._units = np.concatenate([units, units @ of_forces], axis=2)  # (n, 3, 3 + d)
        power = search.mass @ search.motion[:, -1]
        self._constant = np.eye(1, search.freedoms + 1, search.freedoms)[0]
        self._power = np.zeros((0, search.freedoms + 1))
        if search.at_rest and power.any():
            self._power = np.append(power / np.linalg.norm(power), 0.0)[None, :]
        self._nothing = self._leaning([], np.zeros((0, 1)), np.zeros((0, 1)))
        self._around: dict[int, list[_Edges]] = {}
        self._equations: dict[str, FloatArray] = {}
        self._parts: dict[tuple[str, tuple[int, ...], int], tuple[FloatArray, FloatArray, _Edges]] = {}

    def forces(
        self, letters: str, ranges: Ranges, facets: int = COARSE, *, within: Within | None = None
    ) -> tuple[FloatArray | None, bool]:
        """Return forces, (n, 3), that satisfy what modes in a set must, or None if there are none.

        Where rounding hides that there are none, they are zero. The second value is whether that took care.
        Contacts slide in ranges of directions, and the common motion lies ``within`` a region.
        """
        turning = list(ranges)
        zero, leaving, whole = self._fixed(letters, tuple(turning), facets)
        if (
            len(zero) == self._search.freedoms
            and not zero[:, -1].any()
            and np.any(leaving[:, -1] < -FEASIBLE)
        ):
            return None, False  # a body that cannot move leaves no contact
        positive = [leaving]
        edges, moved, sizes, owners = whole
        if turning:
            ends = np.array(list(ranges.values()))
            own = self._in_ranges(turning, ends)
            edges, moved, sizes, owners = (np.concatenate(pair) for pair in zip(whole, own, strict=True))
            implied = frozenset() if within is None else within.implied
            demanded = [k for k, i in enumerate(turning) if i not in implied]
            if demanded:
                positive.append(self._conditions([turning[k] for k in demanded], ends[demanded]))
        if within is not None:
            positive.append(within.region.rows(within.image))
        table = np.column_stack([moved.T, self._search.motion[:, -1]])
        rows = np.concatenate([zero, *positive])
        names = range(len(edges), len(edges) + len(rows))
        program: Program | CarefulProgram = Program.stated(table, rows, names).renamed(
            list(range(len(edges))), len(zero)
        )
        holds = program.solve()
        careful = not holds and program.doubtful
        if careful:
            program = CarefulProgram(table, rows[:0], ()).narrowed(Narrowing(rows=rows, equalities=len(zero)))
            holds = program.solve()
            if not holds and program.doubtful:
                return np.zeros((len(letters), 3)), careful
        if not holds or not (within is None or self._has_power(program, within, owners, sizes)):
            return None, careful
        found = np.zeros((len(letters), 3))
        np.add.at(found, owners, program.shares(len(edges))[:, None] * edges)
        return found, careful

    def free_motions(self, letters: str) -> int:
        """Return the number of dimensions of the motions with some letters, without regard to forces."""
        return self._search.freedoms - len(self._rows_of(letters))

    def _rows_of(self, letters: str) -> FloatArray:
        """Return independent rows, (k, d + 1), that vanish with some letters."""
        if letters not in self._equations:
            rows = [self._power[:0]]
            for i, letter in enumerate(letters):
                if letter != SEPARATES:
                    rows.append(self._points[i] if letter == STICKS else self._rising[i][None, :])
            stacked = np.vstack(rows)
            if not stacked[:, -1].any():
                basis = seen_and_unseen(stacked[:, :-1])[0]
                stacked = np.column_stack([basis, np.zeros(len(basis))])
            self._equations[letters] = stacked
        return self._equations[letters]

    def _fixed(
        self, letters: str, turning: tuple[int, ...], facets: int
    ) -> tuple[FloatArray, FloatArray, _Edges]:
        """Return rows that vanish with letters, rows of contacts that separate, and edges of whole cones."""
        key = letters, turning, facets
        if key not in self._parts:
            leaving = [i for i, letter in enumerate(letters) if letter == SEPARATES]
            others = [i for i in range(len(letters)) if i not in leaving and i not in turning]
            whole = [self._nothing, *(self._whole(facets)[i] for i in others)]
            self._parts[key] = (
                self._rows_of(letters),
                np.concatenate([self._power, self._rising[leaving] - self._least * self._constant]),
                _Edges(*(np.concatenate(one) for one in zip(*whole, strict=True))),
            )
        return self._parts[key]

    def _whole(self, facets: int) -> list[_Edges]:
        """Return the edges of each contact's whole cone."""
        if facets not in self._around:
            # A pyramid touches the round cone between its edges: so turned, along the frame's axes, in
            # which friction often points: there, the program demands what a mode does.
            turns = np.arange(0.5, facets)[None, :] * (2.0 * math.pi / facets)
            wider = 1.0 / math.cos(math.pi / facets)
            self._around[facets] = [
                self._leaning([i], np.zeros((1, 1)), np.zeros((1, 1)))
                if pyramid.frame is None
                else self._leaning([i], np.full((1, facets), -wider * self._holding[i]), turns)
                for i, pyramid in enumerate(self._search.pyramids)
            ]
        return self._around[facets]

    def _leaning(self, contacts: list[int], leans: FloatArray, turns: FloatArray) -> _Edges:
        """Return edges that lean by some slopes, (m, k), against directions, (m, k) rad."""
        parts = np.ones((*leans.shape, 3))
        parts[..., 1], parts[..., 2] = -leans * np.cos(turns), -leans * np.sin(turns)
        both = (parts @ self._units[contacts]).reshape(-1, self._units.shape[2])
        edges, moved = both[:, :3], both[:, 3:]
        sizes = np.sqrt((moved * moved).sum(axis=1))  # so that the unit of mass does not matter
        sizes[sizes == 0.0] = 1.0
        owners = np.repeat(np.array(contacts, dtype=np.intp), leans.shape[1])
        return _Edges(edges / sizes[:, None], moved / sizes[:, None], sizes, owners)

    def _in_ranges(self, turning: list[int], ends: FloatArray) -> _Edges:
        """Return the edges of contacts that slide in ranges of directions, (m, 2) rad."""
        low, high = ends.T
        wide = high - low
        pieces = max(1, math.ceil(float(wide.max()) / _PIECE))
        half = 0.5 * wide / pieces
        shares = np.array([0.0, *(2.0 * k + 1.0 for k in range(pieces)), 2.0 * pieces])
        frictions = self._frictions[turning]
        leans = np.empty((len(turning), len(shares)))
        leans[:] = (frictions / np.cos(half))[:, None]
        leans[:, 0] = leans[:, -1] = frictions
        return self._leaning(turning, leans, low[:, None] + half[:, None] * shares)

    def _conditions(self, turning: list[int], ends: FloatArray) -> FloatArray:
        """Return the conditions of contacts that slide in ranges of directions, (3 m, d + 1)."""
        low, high = ends.T
        turns = np.column_stack([low + _QUARTER, 0.5 * (low + high), high - _QUARTER])  # (m, 3)
        ways = np.empty((len(turning), 3, 2))
        ways[..., 0], ways[..., 1] = np.cos(turns), np.sin(turns)
        rows: FloatArray = ways @ self._across[turning]
        rows[:, 1, -1] -= MILDER * self._least
        return rows.reshape(-1, rows.shape[2])

    def _has_power(
        self,
        program: Program | CarefulProgram,
        within: Within,
        owners: NDArray[np.intp],
        sizes: FloatArray,
    ) -> bool:
        """Return whether the applied wrench may have the power that friction takes in a region."""
        if within.gains is None:
            return True
        rays = within.region.rays
        along = within.image.maps @ rays.T  # (m, 2, p)
        middle = along.sum(axis=2)
        middle /= np.maximum(np.sqrt((middle * middle).sum(axis=1)), np.finfo(float).tiny)[:, None]
        friction = self._frictions[within.turning]
        per_contact = np.zeros((len(rays), len(self._search.touching)))
        per_contact[:, within.turning] = -(friction[:, None] * (middle[:, None, :] @ along)[:, 0]).T
        weights, gains = per_contact[:, owners] / sizes, rays @ within.gains
        scale = max(float(np.abs(weights).max()), float(np.abs(gains).max()))
        return program.allows_any(weights / scale, gains / scale, -STRICT) or program.doubtful
