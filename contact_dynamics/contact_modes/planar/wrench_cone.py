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
from typing import TYPE_CHECKING, Final, NamedTuple

from contact_dynamics.contact_modes.planar.cone import PolyhedralCone, bits, decimal_vector
from contact_dynamics.contact_modes.planar.enumeration import Cell
from contact_dynamics.contact_modes.planar.friction_edges import friction_edges, reactions, sharp_reactions
from contact_dynamics.contact_modes.planar.problem import PlanarCase, lifted
from contact_dynamics.numerics.linear_spaces import orthonormal
from contact_dynamics.numerics.nonnegative_least_squares import (
    distance_from_cone,
    exact_combination,
    least_force,
)
from contact_dynamics.numerics.vectors import Vector3, dot, norm, normalised, opposite
from contact_dynamics.tolerances import ROW_TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence


_MOST_INDEPENDENT: Final = 3
"""No more wrenches can be independent in the plane."""


class HalfSpace(NamedTuple):
    """The wrenches w = (f_x, f_y, moment / rho) with a . w <= b.

    Attributes:
        a: A unit vector.
        b: N.
    """

    a: Vector3
    b: float


class ModeWrenches:
    """The cone of the applied wrenches of one mode, and where the problem's own wrench lies in it."""

    __slots__ = ("_case", "_common", "_rays", "_reactions", "_target", "dual", "edges")

    def __init__(self, case: PlanarCase, cell: Cell, *, exact: bool = False) -> None:
        """Build the cone. The rows of ``dual`` are the rays of the accelerations, and then the reactions.

        ``exact`` says whether to build it in decimals even if floats tell all directions apart.
        """
        lift = case.lift
        self._case = case
        self._rays = cell.rays
        self.edges = friction_edges(case.rows, cell.letters)
        self._reactions = reactions(lift, self.edges.wrenches)
        self.dual = PolyhedralCone([*cell.rays, *self._reactions.units], exact=exact, sharp=self._sharp_rows)
        self._target = lifted(lift, case.w, case.mass * lift.scale * lift.scale if lift else 0.0)
        self._common = self.dual.all_rows

    def _sharp_rows(self) -> list[Vector3]:
        rays = [decimal_vector(ray) for ray in self._rays]
        case = self._case
        return [*rays, *sharp_reactions(case.lift, case.rows, self.edges, self._reactions.edges)]

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

    def solution(self, accuracy: float) -> tuple[list[float], tuple[bool, bool]]:
        """Return the least forces, as f_n along each of ``edges``, and whether forces and motion are unique.

        Call it only if `shortfall` has returned None.
        """
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
            found, _ = exact_combination(self.dual.rows, rest)
        else:
            absent = [_three(unit) for unit in orthonormal(fixed)]
            used = bits(self._common)
            found = least_force([self.dual.rows[i] for i in used], rest, absent)
        wrenches = self.edges.wrenches
        shares = [0.0] * len(wrenches)
        # Edges that have no reaction act along the line of symmetry, and any of them may act.
        idle = set(self._reactions.edges)
        for column, value in zip(used, found, strict=True):
            if column >= len(self._rays):
                edge = self._reactions.edges[column - len(self._rays)]
                shares[edge] = value / self._reactions.lengths[column - len(self._rays)]
                idle.remove(edge)
        return shares, self._uniqueness([wrench for i, wrench in enumerate(wrenches) if i not in idle])

    def _uniqueness(self, acting: list[Vector3]) -> tuple[bool, bool]:
        """Return whether forces and motion are unique if edges with the wrenches ``acting`` can act."""
        motions = orthonormal(self._motions())
        if not motions and len(acting) > _MOST_INDEPENDENT:
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
