# SPDX-License-Identifier: Apache-2.0
"""Forces of given letters with Coulomb's round cones, by Newton's method, and where they are the only ones.

A contact that sticks has three unknown components of force, and its acceleration vanishes. A contact that
begins to slide has two unknowns, its normal force and the direction of its friction. Its normal acceleration
vanishes, and friction opposes the sliding. A contact that slides already has a known direction of friction,
and one unknown. So there are as many equations as unknowns. In the end the solution is checked to have the
letters, so that a mode that is found is a mode to rounding. Where contacts share loads, many forces may have
the letters. Then each step is the shortest one, and leads to forces near those from which it starts.

The equations say that rows of the motion vanish, which is a sum of unit changes times the unknowns. Rows and
unit changes turn with the directions, and everything is linear apart from that. If directions differ from
those of a solution by at most some angle, the forces follow to within bounds, and so do the derivatives. If
no matrix within the bounds of the derivatives is singular, there is no second solution in that range
(Krawczyk, Newton-Algorithmen zur Bestimmung von Nullstellen mit Fehlerschranken, 1969).
"""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.letters import SEPARATES, STAYS, STICKS
from contact_dynamics.tolerances import (
    ALONE_WITHIN,
    FEASIBLE,
    LETTERS_NO_FORCE,
    LETTERS_ON_CONE,
    LETTERS_REGULAR,
    LETTERS_SETTLED,
    SAME_MOTION,
    STRICT,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from contact_dynamics.contact_modes.spatial.search import Search
    from contact_dynamics.validation import FloatArray

_CONTRACTS: Final = 0.99
"""Matrices are regular where the bounds, times the inverse in the middle, have a spectral radius below 1."""

_WORST: Final = 1e8
"""The condition of the derivatives beyond which nothing is claimed."""


class Equations(NamedTuple):
    """Equations at a solution: as many as unknowns, of which each is a share of force or a direction."""

    unknowns: FloatArray  # (k,). The share of a contact stands just before its direction.
    angles: list[int]  # the unknowns that are directions, and the equations that turn with them
    rows: FloatArray  # (k, d + 1), whose products with the motion, followed by 1, vanish
    rows_turn: FloatArray  # (k, d + 1), bounds on how fast rows turn with their contact's direction, per rad
    changes: FloatArray  # (d, k), the changes of the motion with the unknowns
    changes_turn: FloatArray  # (d, k), how fast the change with a share turns with its contact's direction
    motion: FloatArray  # (d + 1,), the motion, followed by 1
    slopes: FloatArray  # (k, k), the derivatives of the equations


def alone_within(equations: Equations) -> float:
    """Return an angle, rad, within which of all directions no other solution is, or 0 if none was found."""
    k = len(equations.unknowns)
    if equations.slopes.shape != (k, k):
        return 0.0
    shares = [i for i in range(k) if i not in equations.angles]
    own = equations.slopes[np.ix_(shares, shares)]
    sizes, own_sizes = np.linalg.norm(equations.slopes, axis=0), np.linalg.norm(own, axis=0)
    if not (sizes.all() and own_sizes.all()):
        return 0.0
    slopes, own = equations.slopes / sizes, own / own_sizes
    if max(np.linalg.cond(slopes), np.linalg.cond(own)) > _WORST:
        return 0.0
    inverse = np.abs(np.linalg.inv(own)) / own_sizes[:, None]
    of_all = np.abs(np.linalg.inv(slopes)) / sizes[:, None]
    return next((turn for turn in ALONE_WITHIN if _is_regular(equations, shares, inverse, of_all, turn)), 0.0)


def _is_regular(
    equations: Equations, shares: list[int], inverse: FloatArray, of_all: FloatArray, turn: float
) -> bool:
    """Return whether the derivatives are regular where directions turn by at most an angle, rad.

    The inverses are the absolute values of those of the derivatives by the shares, and of all derivatives.
    """
    unknowns, angles, rows, rows_turn, changes, changes_turn, motion, _ = equations
    of_rows = np.abs(rows[:, :-1])
    # The equations of the shares do not turn. So the shares are bounded first.
    error = inverse @ (of_rows[shares] @ (turn * changes_turn[:, shares]))
    if not _contracts(error):
        return False
    sizes = np.abs(unknowns)
    off = np.zeros_like(unknowns)
    off[shares] = np.linalg.solve(np.eye(len(shares)) - error, error @ sizes[shares])
    of_share = [i - 1 for i in angles]
    spread = turn * changes_turn
    spread[:, angles] = changes_turn[:, angles] * (turn * sizes[of_share] + off[of_share])
    moved = np.abs(changes[:, shares]) @ off[shares]
    moved += turn * changes_turn[:, shares] @ (sizes[shares] + off[shares])
    bounds = (of_rows + turn * rows_turn[:, :-1]) @ spread + turn * rows_turn[:, :-1] @ np.abs(changes)
    for i in angles:
        bounds[i, i] += turn * float(rows_turn[i] @ np.abs(motion)) + float(rows_turn[i, :-1] @ moved)
    return _contracts(of_all @ bounds)


def _contracts(matrix: FloatArray) -> bool:
    return matrix.size == 0 or float(np.abs(np.linalg.eigvals(matrix)).max()) < _CONTRACTS


_MAX_STEPS: Final = 25
"""The largest number of Newton's steps. From forces that are close, some five are enough."""

_MAX_SWAPPED: Final = 5
"""The largest number of contacts that are tried sticking and sliding. Each of them doubles the number of
letters."""


def letters_near(search: Search, letters: str) -> Iterator[str]:
    """Yield letters in which the contacts that stay and have friction stick or slide in any combination."""
    stays = [letter != SEPARATES for letter in letters]
    swapped = [i for i, one in enumerate(search.pyramids) if stays[i] and one.frame is not None]
    if len(swapped) > _MAX_SWAPPED:
        yield letters
        return
    for chosen in itertools.product((STAYS, STICKS), repeat=len(swapped)):
        found = list(letters)
        for i, letter in zip(swapped, chosen, strict=True):
            found[i] = letter
        yield "".join(found)


def forces_with_letters(
    search: Search, letters: str, forces: FloatArray, *, shared: bool = False, least: float = STRICT
) -> FloatArray | None:
    """Return forces, (n, 3), of touching contacts that have the letters, or None if none were found.

    They are sought close to the given ones, in the units of the motion. If contacts may share loads in many
    ways (``shared``), contacts without force stay without it. Strict inequalities must hold by ``least``,
    relative to the largest acceleration.
    """
    system = _system(search, letters, forces if shared else None)
    unknowns = _solved(system, forces, shared=shared)
    if unknowns is None:
        return None
    found = system.forces(unknowns)
    return found if system.has_letters(found, least) else None


class Solution(NamedTuple):
    """Forces that solve the equations of some letters, which may fail their inequalities."""

    forces: FloatArray  # (n, 3), in the units of the motion
    angles: dict[int, float]  # the direction, rad, in which each contact begins to slide, in its frame
    has_letters: bool  # whether the inequalities hold, and it is a mode
    equations: Equations | None  # the equations there; None if contacts may share loads
    motion_unique: bool = True  # whether forces nearby with these letters cause the same motion


def solution_near(
    search: Search, letters: str, forces: FloatArray, *, shared: bool = False
) -> Solution | None:
    """Return the solution that Newton's method finds from some forces, (n, 3), or None if it does not settle.

    It is None too if the equations leave something open and contacts may not share loads.
    """
    system = _system(search, letters, forces if shared else None)
    unknowns = _solved(system, forces, shared=shared)
    if unknowns is None:
        return None
    found = system.forces(unknowns)
    holds = system.has_letters(found)
    if not shared:
        return Solution(found, system.angles(unknowns), holds, system.equations(unknowns))
    every, angles = _system(search, letters, None), system.sliding(found)
    start = every.start(found)
    for k, i in zip(every.turns, every.turning, strict=True):
        if not found[i].any():  # there is no friction to show the direction
            start[k] = angles[i]
    return Solution(found, angles, holds, None, every.is_motion_unique(start))


def _solved(system: _System, forces: FloatArray, *, shared: bool) -> FloatArray | None:
    """Return the unknowns with which no equation is missed, or None if the steps do not settle."""
    unknowns: FloatArray = system.start(forces)
    if len(unknowns) == 0 or not (shared or system.may_be_regular):
        return None
    for _ in range(_MAX_STEPS):
        missed, slopes = system.at(unknowns)
        sizes = _sizes(slopes)
        left, spread, right = np.linalg.svd(slopes / sizes, full_matrices=False)
        seen = spread > LETTERS_REGULAR * spread[0]
        if not (shared or seen.all()):
            return None
        step = (right[seen].T @ ((left[:, seen].T @ missed) / spread[seen])) / sizes
        unknowns -= step
        if not np.all(np.isfinite(unknowns)):
            return None
        if float(np.abs(missed).max()) <= LETTERS_SETTLED:
            return unknowns
    return None


def _sizes(slopes: FloatArray) -> FloatArray:
    """Return the lengths of columns, or 1 for those of zeros."""
    sizes: FloatArray = np.sqrt((slopes * slopes).sum(axis=0))
    sizes[sizes == 0.0] = 1.0
    return sizes


def _system(search: Search, letters: str, acting: FloatArray | None) -> _System:
    """Return the equations of letters, stated once.

    Contacts without force in ``acting``, (n, 3), have none. If it is None, all may act.
    """
    sizes = np.ones(len(letters)) if acting is None else np.sqrt((acting * acting).sum(axis=1))
    acts = tuple((sizes > LETTERS_NO_FORCE * sizes.max(initial=0.0)).tolist())
    if (letters, acts) not in search.systems:
        search.systems[letters, acts] = _System(search, letters, acts)
    found: _System = search.systems[letters, acts]
    return found


class _System:
    """The equations of some letters."""

    def __init__(self, search: Search, letters: str, acts: tuple[bool, ...]) -> None:
        """State the equations of letters, where some contacts do not act: they have no force."""
        self._search, self._letters = search, letters
        self._frames = [None if one.frame is None else np.array(one.frame) for one in search.pyramids]
        rows: list[FloatArray] = []
        units: list[tuple[int, FloatArray, FloatArray]] = []  # contact, unit force, and what it is read along
        self.turning: list[int] = []  # the contacts with unknown directions
        self.turns: list[int] = []  # which of the unknowns these are
        self._turned: list[int] = []  # the equations that turn with them
        for i, (letter, frame) in enumerate(zip(letters, self._frames, strict=True)):
            normal, point = search.touching[i].normal, search.touching[i].point
            if letter == STICKS:
                rows += list(point)
                units += [(i, axis, axis) for axis in np.eye(3)] if acts[i] else []
            elif letter != SEPARATES:
                rows.append(normal @ point)
                if acts[i] and frame is None:
                    units.append((i, search.pyramids[i].edges[0], normal))
                elif acts[i]:
                    self.turning.append(i)
                    self.turns.append(len(units) + 1)
                    self._turned.append(len(rows))
                    units += [(i, normal, normal), (i, 0.0 * normal, 0.0 * normal)]
                    rows.append(0.0 * rows[-1])
        self._rows = np.array(rows).reshape(-1, search.freedoms + 1)
        self._edges, self._along = np.zeros((2, 3 * len(letters), len(units)))
        for k, (i, unit, along) in enumerate(units):
            self._edges[3 * i : 3 * i + 3, k], self._along[3 * i : 3 * i + 3, k] = unit, along
        self._frictions = np.zeros((2, 3 * len(letters), len(self.turning)))  # along the frames
        self._slides = np.zeros((2, len(self.turning), search.freedoms + 1))  # the sliding along the frames
        for k, i in enumerate(self.turning):
            contact, own = search.touching[i], np.array(search.pyramids[i].frame)
            self._frictions[:, 3 * i : 3 * i + 3, k] = contact.friction * own
            self._slides[:, k] = own @ contact.point

    @property
    def may_be_regular(self) -> bool:
        """Whether shares of force are so few that they can all differ in the motion."""
        return len(self._edges.T) - len(self.turns) <= self._search.freedoms

    def start(self, forces: FloatArray) -> FloatArray:
        """Return the unknowns that are nearest to given forces."""
        found: FloatArray = forces.ravel() @ self._along
        x, y = np.where(
            self._frictions.any(axis=(0, 1)),
            forces.ravel() @ self._frictions,
            -self._slides @ self._motion(forces),  # there is no friction to show the direction
        )
        found[self.turns] = np.arctan2(-y, -x)
        return found

    def at(self, unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return by how much the equations are missed, (m,), and the derivatives of that, (m, k)."""
        forces, changes = self._forces_and_changes(unknowns)
        motion, rows = self._motion(forces), self._rows_at(unknowns)
        slopes = rows[:, :-1] @ (self._search.of_forces @ changes)
        along, across = self._slides @ motion
        x, y = np.cos(unknowns[self.turns]), np.sin(unknowns[self.turns])
        slopes[self._turned, self.turns] -= x * along + y * across
        return rows @ motion, slopes

    def _rows_at(self, unknowns: FloatArray) -> FloatArray:
        """Return the rows, (m, d + 1), whose products with the motion vanish."""
        x, y = np.cos(unknowns[self.turns])[:, None], np.sin(unknowns[self.turns])[:, None]
        rows = self._rows.copy()
        rows[self._turned] = x * self._slides[1] - y * self._slides[0]
        return rows

    def forces(self, unknowns: FloatArray) -> FloatArray:
        """Return the contact forces, (n, 3). Those that pull no more than by rounding are zero."""
        found = self._forces_and_changes(unknowns)[0]
        for i, (contact, force) in enumerate(zip(self._search.touching, found, strict=True)):
            if float(contact.normal @ force) < 0.0:
                moved = self._search.of_forces[:, 3 * i : 3 * i + 3] @ force
                if float(np.abs(moved).max()) <= FEASIBLE:
                    found[i] = 0.0
        return found

    def has_letters(self, forces: FloatArray, least: float = STRICT) -> bool:
        """Return whether contacts do under these forces what the letters say."""
        motion = self._motion(forces)
        for i, (letter, force) in enumerate(zip(self._letters, forces, strict=True)):
            contact = self._search.touching[i]
            point = contact.point @ motion
            pressing = float(contact.normal @ force)
            if letter == SEPARATES:
                if not contact.normal @ point > least:
                    return False
            elif not pressing >= 0.0:
                return False
            elif letter == STICKS:
                across = float(np.linalg.norm(force - pressing * contact.normal))
                if across > contact.holding * pressing * (1.0 + LETTERS_ON_CONE):
                    return False
            elif self._frames[i] is not None:
                friction = force - pressing * contact.normal
                slides = point - float(contact.normal @ point) * contact.normal
                against = -float(friction @ point) > least * float(np.linalg.norm(friction))
                rubs = contact.friction * pressing > 0.0
                if not (against if rubs else float(np.linalg.norm(slides)) > least):
                    return False
        return True

    def is_motion_unique(self, unknowns: FloatArray) -> bool:
        """Return whether unknowns nearby that solve the equations too cause the same motion."""
        slopes = self.at(unknowns)[1]
        of_unknowns = self._search.of_forces @ self._forces_and_changes(unknowns)[1]
        sizes = _sizes(slopes)
        slopes, of_unknowns = slopes / sizes, of_unknowns / sizes
        combined = np.linalg.lstsq(slopes.T, of_unknowns.T, rcond=LETTERS_REGULAR)[0]
        moved = of_unknowns - combined.T @ slopes
        return bool(np.abs(moved).max(initial=0.0) <= SAME_MOTION * np.abs(of_unknowns).max())

    def sliding(self, forces: FloatArray) -> dict[int, float]:
        """Return the direction, rad, in which forces make each contact slide that begins to."""
        motion, found = self._motion(forces), {}
        for i, (letter, frame) in enumerate(zip(self._letters, self._frames, strict=True)):
            if letter == STAYS and frame is not None:
                x, y = frame @ (self._search.touching[i].point @ motion)
                found[i] = math.atan2(y, x)
        return found

    def angles(self, unknowns: FloatArray) -> dict[int, float]:
        """Return the direction, rad, in which each contact begins to slide."""
        return dict(zip(self.turning, unknowns[self.turns].tolist(), strict=True))

    def equations(self, unknowns: FloatArray) -> Equations:
        """Return the equations at a solution, with as many unknowns."""
        forces, changes = self._forces_and_changes(unknowns)
        rows_turn = np.zeros_like(self._rows)
        rows_turn[self._turned] = np.abs(self._slides).sum(axis=0)
        changes_turn = np.zeros((self._search.freedoms, len(unknowns)))
        changes_turn[:, self.turns] = np.abs(self._search.of_forces @ self._frictions).sum(axis=0)
        changes_turn[:, np.array(self.turns, dtype=np.intp) - 1] = changes_turn[:, self.turns]
        return Equations(
            unknowns=unknowns,
            angles=self.turns,
            rows=self._rows_at(unknowns),
            rows_turn=rows_turn,
            changes=self._search.of_forces @ changes,
            changes_turn=changes_turn,
            motion=self._motion(forces),
            slopes=self.at(unknowns)[1],
        )

    def _motion(self, forces: FloatArray) -> FloatArray:
        return np.append(self._search.motion_of(forces), 1.0)

    def _forces_and_changes(self, unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the contact forces, (n, 3), and their derivatives by the unknowns, (3 n, k)."""
        x, y = np.cos(unknowns[self.turns]), np.sin(unknowns[self.turns])
        shares = np.array(self.turns, dtype=np.intp) - 1
        changes, linear = self._edges.copy(), unknowns.copy()
        changes[:, shares] -= x * self._frictions[0] + y * self._frictions[1]
        changes[:, self.turns] = unknowns[shares] * (y * self._frictions[0] - x * self._frictions[1])
        linear[self.turns] = 0.0
        return (changes @ linear).reshape(-1, 3), changes
