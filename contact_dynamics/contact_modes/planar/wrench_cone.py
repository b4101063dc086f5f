# SPDX-License-Identifier: Apache-2.0
"""The applied wrenches that can bring about a planar mode are the cone pos({a} + {-c_i}) of lecture 26.

Newton's law is m q = w + c, where c is the sum of contact forces. So the wrenches of a mode are w = m q - c,
for the accelerations q of the mode and the forces c that its letters allow. The rays of the accelerations and
the negated edges of the friction cones generate these wrenches. A wrench inside this cone brings the mode
about. On the boundary the strictness of the letters decides. Forces may be zero, but `s`, `l` and `r` must
accelerate. So the mode holds there only if the supporting plane contains all accelerations of the mode.

With centripetal terms, the same is true of the pair of the wrench across the line of symmetry and m scale,
see `problem`.

A few edges of friction cones are computed in plain floats and many in arrays, whichever is faster.
"""

from __future__ import annotations

import math
from decimal import Decimal
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.planar.cone import MANY, PolyhedralCone, bits, decimal_vector, root
from contact_dynamics.contact_modes.planar.enumeration import FIXED, RIGHT, Cell, Letters
from contact_dynamics.contact_modes.planar.problem import Lift, PlanarCase, lifted
from contact_dynamics.numerics.arithmetic import DECIMALS, within
from contact_dynamics.numerics.linear_spaces import orthonormal
from contact_dynamics.numerics.nonnegative_least_squares import (
    distance_of,
    exact_combination,
    least_force,
)
from contact_dynamics.numerics.vectors import (
    Vector3,
    array_of,
    combined,
    dot,
    norm,
    normalised,
    opposite,
    scaled,
)
from contact_dynamics.tolerances import ROW_TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from contact_dynamics.contact_modes.planar.problem import ContactRow
    from contact_dynamics.plane.types import Vector2
    from contact_dynamics.validation import FloatArray

_MAX_INDEPENDENT: Final = 3
"""No more wrenches can be independent in the plane."""


class HalfSpace(NamedTuple):
    """The wrenches w = (f_x, f_y, moment / rho) with a . w <= b."""

    a: Vector3  # a unit vector
    b: float  # N


class Evidence(NamedTuple):
    """Forces that bring a mode about, and its motion.

    There is no motion if Newton's law gives it accurately enough. Otherwise it is a combination of the mode's
    rays. It satisfies strict inequalities that the rounding of the forces would hide. Its third
    coordinate is a height if there is a line of symmetry.
    """

    forces: dict[int, Vector2]  # N, the force (f_t, f_n) at each position in the rows of the case
    motion: Vector3 | None  # N, mass times the acceleration across the line of symmetry
    forces_unique: bool  # whether these are the only forces
    motion_unique: bool  # whether this is the only motion


class ModeWrenches:
    """The cone of the applied wrenches of one mode, and where the problem's own wrench lies in it."""

    __slots__ = (
        "_case",
        "_combined",
        "_common",
        "_rays",
        "_reactions",
        "_sharp_lengths",
        "_target",
        "dual",
        "edges",
    )

    def __init__(self, case: PlanarCase, cell: Cell, *, exact: bool = False) -> None:
        """Build the cone, in decimals if ``exact``.

        The rows of ``dual`` are the mode's rays, and then the reactions.
        """
        lift = case.lift
        self._case = case
        self._rays = cell.rays
        self.edges = friction_edges(case.rows, cell.letters)
        self._reactions = reactions(lift, self.edges.wrenches)
        self._sharp_lengths: list[Decimal] = []
        self.dual = PolyhedralCone([*cell.rays, *self._reactions.units], exact=exact, sharp=self._sharp_rows)
        self._target = lifted(lift, case.w, case.mass * lift.scale * lift.scale if lift else 0.0)
        self._common = self.dual.all_rows
        self._combined: tuple[Vector3, tuple[list[Decimal], float]] | None = None

    def _sharp_rows(self) -> list[Vector3]:
        rays = [decimal_vector(ray) for ray in self._rays]
        case = self._case
        sharp = sharp_reactions(case.lift, case.rows, self.edges, self._reactions.edges)
        self._sharp_lengths = [Decimal(root(dot(row, row))) for row in sharp]
        return [*rays, *sharp]

    def generated_by(self) -> tuple[list[Vector3], list[Vector3]]:
        """Return vertices, N, and rays. Each wrench of the mode is an average of vertices plus some rays."""
        lift = self._case.lift
        rays = [opposite(wrench) for wrench in self.edges.wrenches]
        if lift is None:
            return [(0.0, 0.0, 0.0)], [*self._rays, *rays]
        rays += [lift.line, opposite(lift.line)]
        vertices = []
        for ray in self._rays:
            x, y, z, height = self._with_height(ray)
            if height > ROW_TOLERANCE:
                factor = self._case.mass * lift.scale / height
                vertices.append((factor * x, factor * y, factor * z))
            else:
                rays.append((x, y, z))
        return vertices, rays

    def half_spaces(self) -> list[HalfSpace]:
        """Return half-spaces whose intersection is the closure of the mode's wrenches; none if it is all."""
        facets = [*self.dual.rays]
        for line in self.dual.lineality:
            facets += [line, opposite(line)]
        found = []
        for z in facets:
            a, offset = self._unlifted(z)
            size = norm(a)
            if size > ROW_TOLERANCE:
                found.append(HalfSpace((-a[0] / size, -a[1] / size, -a[2] / size), offset / size))
        return found

    def shortfall(self, accuracy: float) -> float | None:
        """Return None if the problem's wrench can bring the mode about, or by how much it cannot, N.

        The amount is the distance to one of the half-spaces. It is 0 if the wrench lies on the boundary,
        where the strict inequalities of the mode fail. It is infinite if no wrench brings the mode about.
        """
        tolerance = accuracy * norm(self._target)
        if self.dual.exact:
            # Beyond the edge of a narrow cone a wrench is near to its facets and still far from the cone.
            distance = distance_of(self._exact_combination(self._target), self._target)
            if distance > tolerance:
                return distance
        else:
            for line in self.dual.lineality:
                height = dot(line, self._target)
                if abs(height) > tolerance:
                    return self._distance(line, height)
        lowest, facet = 0.0, None
        strict = True
        rays = (1 << len(self._rays)) - 1
        common = self.dual.all_rows
        for z, tight in zip(self.dual.rays, self.dual.tight, strict=True):
            height = dot(z, self._target)
            if height < lowest:
                lowest, facet = height, z
            if height <= tolerance:
                common &= tight
                strict = strict and tight & rays == rays
        if facet is not None and lowest < -tolerance and not self.dual.exact:
            return self._distance(facet, lowest)
        self._common = common
        return None if strict else 0.0

    def solution(self, accuracy: float) -> Evidence:
        """Return the least forces. Call it only if `shortfall` has returned None."""
        tolerance = accuracy * norm(self._target)
        target = self._target
        fixed: list[Vector3] = list(self.dual.lineality)
        largest = math.inf
        inner = _total(self._rays) if self._rays else (0.0, 0.0, 0.0)
        for z in self.dual.rays:
            height = dot(z, target)
            if height <= tolerance:
                fixed.append(z)
            elif dot(z, inner) > ROW_TOLERANCE:
                largest = min(largest, height / dot(z, inner))
        if math.isinf(largest):
            largest = norm(target)
        # Half of the largest mean acceleration of the mode is taken. Every strict inequality then holds.
        share = 0.5 * largest if self._rays else 0.0
        rest = (target[0] - share * inner[0], target[1] - share * inner[1], target[2] - share * inner[2])
        if self.dual.exact:
            used = list(range(len(self.dual.rows)))
            motion: Vector3 | None
            shares, _ = self._exact_combination(rest)
            forces = self._exact_forces(shares)
            motion = scaled(inner, share)
            for ray, more in zip(self._rays, shares, strict=False):
                motion = combined(1.0, motion, float(more), ray)
        else:
            absent = [(x, y, z) for x, y, z in orthonormal(fixed)]
            used = bits(self._common)
            motion = None
            forces = self._forces(used, least_force([self.dual.rows[i] for i in used], rest, absent))
        # Edges that have no reaction act along the line of symmetry, and any of them may act.
        idle = set(self._reactions.edges)
        for column in used:
            if column >= len(self._rays):
                idle.remove(self._reactions.edges[column - len(self._rays)])
        acting = [wrench for i, wrench in enumerate(self.edges.wrenches) if i not in idle]
        return Evidence(forces, motion, *self._uniqueness(acting))

    def _exact_combination(self, target: Vector3) -> tuple[list[Decimal], float]:
        """Return the combination of the cone's rows that is nearest to a target, and its distance.

        Both are kept.
        """
        if self._combined is None or self._combined[0] != target:
            self._combined = target, exact_combination(self.dual.rows, target)
        return self._combined[1]

    def _forces(self, used: list[int], shares: list[float]) -> dict[int, Vector2]:
        """Return (f_t, f_n) at each position from the shares of the rows ``used``."""
        sums: dict[int, Vector2] = dict.fromkeys(self.edges.positions, (0.0, 0.0))
        for column, share in zip(used, shares, strict=True):
            index = column - len(self._rays)
            if index >= 0:
                edge = self._reactions.edges[index]
                position, (t, n) = self.edges.positions[edge], self.edges.forces[edge]
                f_n = share / self._reactions.lengths[index]
                f_t, before = sums[position]
                sums[position] = (f_t + t * f_n, before + n * f_n)
        return sums

    def _exact_forces(self, shares: list[Decimal]) -> dict[int, Vector2]:
        """Return (f_t, f_n) at each position from the shares of all rows.

        In their sums, edges may nearly cancel.
        """
        tangential = dict.fromkeys(self.edges.positions, Decimal(0))
        normal = dict.fromkeys(self.edges.positions, Decimal(0))
        with within(DECIMALS.sums):
            for index, edge in enumerate(self._reactions.edges):
                position, (t, n) = self.edges.positions[edge], self.edges.forces[edge]
                size = shares[len(self._rays) + index] / self._sharp_lengths[index]
                tangential[position] += Decimal(t) * size
                normal[position] += Decimal(n) * size
        return {position: (float(tangential[position]), float(normal[position])) for position in normal}

    def _uniqueness(self, acting: list[Vector3]) -> tuple[bool, bool]:
        """Return whether forces and motion are unique if edges with the wrenches ``acting`` can act."""
        motions = orthonormal(self._motions())
        if not motions and len(acting) > _MAX_INDEPENDENT:
            return False, True
        height = () if self._case.lift is None else (0.0,)
        forces = orthonormal((*normalised(wrench), *height) for wrench in acting)
        total = len(orthonormal([*motions, *forces])) if motions else len(forces)
        return total == len(motions) + len(acting), total == len(motions) + len(forces)

    def _motions(self) -> Iterator[tuple[float, ...]]:
        for ray in self._rays:
            yield self._with_height(ray)
        if self._case.lift is not None:
            yield (*self._case.lift.line, 0.0)

    def _unlifted(self, z: Vector3) -> tuple[Vector3, float]:
        """Return a and b such that a . w + b is the height of the wrench w over the facet ``z``."""
        lift = self._case.lift
        if lift is None:
            return z, 0.0
        one, two = lift.across
        a = (
            z[0] * one[0] + z[1] * two[0],
            z[0] * one[1] + z[1] * two[1],
            z[0] * one[2] + z[1] * two[2],
        )
        return a, z[2] * self._target[2]

    def _distance(self, z: Vector3, height: float) -> float:
        a, _ = self._unlifted(z)
        size = norm(a)
        return abs(height) / size if size > ROW_TOLERANCE else math.inf

    def _with_height(self, ray: Vector3) -> tuple[float, ...]:
        lift = self._case.lift
        if lift is None:
            return ray
        one, two = lift.across
        return (*(ray[0] * x + ray[1] * y for x, y in zip(one, two, strict=True)), ray[2])


def _total(rays: Sequence[Vector3]) -> Vector3:
    return (sum(ray[0] for ray in rays), sum(ray[1] for ray in rays), sum(ray[2] for ray in rays))


_SMOOTH: Final = ((0.0, 1.0),)
"""The only edge of a contact without friction is its normal."""


class Edges(NamedTuple):
    """The edges of friction cones. The contact forces of a mode are their positive combinations."""

    positions: list[int]  # the position of each edge's contact in the rows of the case
    forces: list[Vector2]  # a force (f_t, f_n) along each edge; f_n is 1, or 0 where friction is infinite
    wrenches: list[Vector3]  # the wrench of that force


class Reactions(NamedTuple):
    """The negated wrenches of edges, in the coordinates of the cone of applied wrenches.

    If the case has a line of symmetry, only the part of a wrench across that line counts.
    """

    edges: list[int]  # the indices of the edges whose wrenches have such a part
    lengths: list[float]  # the size of that part for each of them
    units: list[Vector3]  # the negated part of each of them, as a unit vector


def friction_edges(rows: Sequence[ContactRow], letters: Letters) -> Edges:
    """Return the edges of the forces that the letters of a mode allow."""
    positions: list[int] = []
    forces: list[Vector2] = []
    known: dict[tuple[float, int], tuple[Vector2, ...]] = {}  # contacts often have the same friction
    for position, letter in letters:
        row = rows[position]
        kind = (row.holding if letter == FIXED else row.friction, letter)
        alike = known.get(kind)
        if alike is None:
            alike = known[kind] = edge_forces(*kind)
        forces += alike
        positions += (position,) * len(alike)
    if len(positions) > MANY:
        normals = array_of([rows[position].N for position in positions])
        tangents = array_of([rows[position].T for position in positions])
        f_t, f_n = np.array([*zip(*forces, strict=True)])[:, :, None]
        return Edges(positions, forces, _rows(f_n * normals + f_t * tangents))
    wrenches = []
    for position, (f_t, f_n) in zip(positions, forces, strict=True):
        N, T = rows[position].N, rows[position].T
        wrenches.append((f_n * N[0] + f_t * T[0], f_n * N[1] + f_t * T[1], f_n * N[2] + f_t * T[2]))
    return Edges(positions, forces, wrenches)


def edge_forces(friction: float, letter: int) -> tuple[Vector2, ...]:
    """Return a force (f_t, f_n) along each edge of the forces that a letter allows.

    If friction is infinite, the tangential force may have any size, also without a normal force.
    """
    if friction == 0.0:
        return _SMOOTH
    left, right = (-friction, 1.0), (friction, 1.0)
    if friction == math.inf:
        left, right = (-1.0, 0.0), (1.0, 0.0)
    if letter == FIXED:
        return (right, left, (0.0, 1.0)) if friction == math.inf else (right, left)
    return (left,) if letter == RIGHT else (right,)


def reactions(lift: Lift | None, wrenches: Sequence[Vector3]) -> Reactions:
    """Return the reactions to some wrenches. Wrenches along the line of symmetry have none."""
    if len(wrenches) > MANY:
        return _many_reactions(lift, wrenches)
    edges, lengths, units = [], [], []
    for edge, wrench in enumerate(wrenches):
        x, y, z = wrench if lift is None else lifted(lift, wrench, 0.0)
        length = math.sqrt(x * x + y * y + z * z)
        if lift is None or length > ROW_TOLERANCE * norm(wrench):
            edges.append(edge)
            lengths.append(length)
            units.append((-x / length, -y / length, -z / length))
    return Reactions(edges, lengths, units)


def sharp_reactions(
    lift: Lift | None, rows: Sequence[ContactRow], edges: Edges, acting: Sequence[int]
) -> list[Vector3]:
    """Return the reactions to the ``edges`` whose indices are ``acting``, as decimals of any length."""
    sharp = []
    for edge in acting:
        row = rows[edges.positions[edge]]
        reaction = sharp_reaction(row.N, row.T, edges.forces[edge])
        if lift is not None:
            one, two = (decimal_vector(axis) for axis in lift.across)
            reaction = (dot(reaction, one), dot(reaction, two), 0 * reaction[2])
        sharp.append(reaction)
    return sharp


def sharp_reaction(N: Vector3, T: Vector3, force: Vector2) -> Vector3:
    """Return the reaction to a force (f_t, f_n) in decimals, where large friction hides no normal part."""
    (n_x, n_y, n_z), (t_x, t_y, t_z) = decimal_vector(N), decimal_vector(T)
    f_t, f_n, _ = decimal_vector((*force, 0.0))
    return (-f_n * n_x - f_t * t_x, -f_n * n_y - f_t * t_y, -f_n * n_z - f_t * t_z)


def _many_reactions(lift: Lift | None, wrenches: Sequence[Vector3]) -> Reactions:
    rows = array_of(wrenches)
    across = rows if lift is None else np.column_stack([rows @ np.array(lift.across).T, np.zeros(len(rows))])
    lengths = _lengths(across)
    seen = np.flatnonzero(lengths > ROW_TOLERANCE * _lengths(rows))
    return Reactions(seen.tolist(), lengths[seen].tolist(), _rows(across[seen] / -lengths[seen, None]))


def _lengths(rows: FloatArray) -> FloatArray:
    lengths: FloatArray = np.sqrt(np.einsum("ij,ij->i", rows, rows))
    return lengths


def _rows(array: FloatArray) -> list[Vector3]:
    return [(x, y, z) for x, y, z in array.tolist()]
