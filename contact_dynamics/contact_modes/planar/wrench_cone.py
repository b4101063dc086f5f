# SPDX-License-Identifier: Apache-2.0
"""The applied wrenches that can bring about a planar mode are the cone pos({a} + {-c_i}) of lecture 26.

Newton's law is m q = w + c, where c is the sum of contact forces. So the wrenches of a mode are w = m q - c,
for the accelerations q of the mode and the forces c that its letters allow. The rays of the accelerations and
the negated edges of the friction cones generate these wrenches. A wrench inside this cone brings the mode
about. On the boundary the strictness of the letters decides. Forces may be zero, but `s`, `l` and `r` must
accelerate. So the mode holds there only if the supporting plane contains all accelerations of the mode.

With centripetal terms, the same is true of the pair of the wrench across the line of symmetry and m scale,
see `problem`.
"""

from __future__ import annotations

import math
from decimal import Decimal
from typing import TYPE_CHECKING, Final, NamedTuple

from contact_dynamics.contact_modes.planar.cone import PolyhedralCone, bits
from contact_dynamics.contact_modes.planar.enumeration import Cell
from contact_dynamics.contact_modes.planar.exact_vectors import decimal_vector
from contact_dynamics.contact_modes.planar.friction_edges import friction_edges, reactions, sharp_reactions
from contact_dynamics.contact_modes.planar.problem import PlanarCase, lifted
from contact_dynamics.numerics.arithmetic import DECIMALS, within
from contact_dynamics.numerics.linear_spaces import orthonormal
from contact_dynamics.numerics.nonnegative_least_squares import (
    distance_from_cone,
    exact_combination,
    least_force,
)
from contact_dynamics.numerics.vectors import Vector3, combined, dot, norm, normalised, opposite, scaled
from contact_dynamics.tolerances import ROW_TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from contact_dynamics.plane.types import Vector2

_MAX_INDEPENDENT: Final = 3
"""No more wrenches can be independent in the plane."""


class HalfSpace(NamedTuple):
    """The wrenches w = (f_x, f_y, moment / rho) with a . w <= b.

    Attributes:
        a: A unit vector.
        b: N.
    """

    a: Vector3
    b: float


class Evidence(NamedTuple):
    """Forces that bring a mode about, and its motion.

    Attributes:
        forces: N, the force (f_t, f_n) at each position in the rows of the case.
        motion: N, mass times the acceleration across the line of symmetry, or None if Newton's law gives it
            accurately enough. It is a combination of the mode's rays, so that it satisfies strict
            inequalities that the rounding of the forces would hide. Its third coordinate is a height if there
            is such a line.
        forces_unique: Whether these are the only forces.
        motion_unique: Whether this is the only motion.
    """

    forces: dict[int, Vector2]
    motion: Vector3 | None
    forces_unique: bool
    motion_unique: bool


class ModeWrenches:
    """The cone of the applied wrenches of one mode, and where the problem's own wrench lies in it."""

    __slots__ = ("_case", "_common", "_rays", "_reactions", "_sharp_lengths", "_target", "dual", "edges")

    def __init__(self, case: PlanarCase, cell: Cell, *, exact: bool = False) -> None:
        """Build the cone. The rows of ``dual`` are the rays of the accelerations, and then the reactions.

        ``exact`` says whether to build it in decimals even if floats tell all directions apart.
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

    def _sharp_rows(self) -> list[Vector3]:
        rays = [decimal_vector(ray) for ray in self._rays]
        case = self._case
        sharp = sharp_reactions(case.lift, case.rows, self.edges, self._reactions.edges)
        self._sharp_lengths = [Decimal(dot(row, row)).sqrt() for row in sharp]
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
        """Return half-spaces whose intersection is the closure of the wrenches that can bring the mode about.

        There are none if every wrench can.
        """
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
            distance = distance_from_cone(self.dual.rows, self._target)
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
            shares, _ = exact_combination(self.dual.rows, rest)
            forces = self._exact_forces(shares)
            motion = scaled(inner, share)
            for ray, more in zip(self._rays, shares, strict=False):
                motion = combined(1.0, motion, float(more), ray)
        else:
            absent = [_three(unit) for unit in orthonormal(fixed)]
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

        The sums are in decimals, because the edges of contacts that never slip nearly cancel in them.
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


def _three(vector: Sequence[float]) -> Vector3:
    x, y, z = vector
    return (x, y, z)
