"""The applied wrenches that can bring about a planar mode, as the cone pos({a} + {-c_i}) of lecture 26.

Newton's law m q = w + sum of contact forces turns the accelerations q of a mode and the forces its letters
allow into applied wrenches w = m q - c: the accelerations' rays and the negated edges of the friction cones
generate a cone. A wrench in its interior brings the mode about. On its boundary the lecture's strictness
decides: forces may be zero but `s`, `l` and `r` must accelerate, so that the mode holds only where the
supporting half-space contains all accelerations of the mode on its boundary.

With centripetal terms the same is said of (wrench across the line of symmetry, m scale): see `problem`.
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


_MOST_INDEPENDENT: Final = 3  # wrenches in the plane


class HalfSpace(NamedTuple):
    """Wrenches w = (f_x, f_y, moment / rho) with a . w <= b.

    Attributes:
        a: Unit.
        b: N.
    """

    a: Vector3
    b: float


class ModeWrenches:
    """The cone of applied wrenches of one mode, and where the problem's own wrench stands in it."""

    __slots__ = ("_case", "_common", "_rays", "_reactions", "_target", "dual", "edges")

    def __init__(self, case: PlanarCase, cell: Cell, *, exact: bool = False) -> None:
        """Build the cone; its rays stand first among the rows of ``dual``, then the reactions.

        ``exact``: in decimals, even where floats tell all directions apart.
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
        """Return vertices, N, and rays whose averages and positive combinations are the mode's wrenches."""
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
        """Return the closure of the wrenches that can bring the mode about as half-spaces; empty: all can."""
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
        """Return None where the problem's wrench can bring the mode about, else by how much it cannot, N.

        The amount is the largest distance to one of the half-spaces; 0: the wrench lies on the boundary,
        where the mode's strict inequalities fail; infinite: no wrench brings the mode about.
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
        """Return the least forces (f_n along each of ``edges``), and whether forces and motion are unique.

        Only after `shortfall` has returned None.
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
        # Half of the way that the mode's mean acceleration could go keeps every strict inequality.
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
        idle = set(self._reactions.edges)  # the others act along the line of symmetry: any of them may
        for column, value in zip(used, found, strict=True):
            if column >= len(self._rays):
                edge = self._reactions.edges[column - len(self._rays)]
                shares[edge] = value / self._reactions.lengths[column - len(self._rays)]
                idle.remove(edge)
        return shares, self._uniqueness([wrench for i, wrench in enumerate(wrenches) if i not in idle])

    def _uniqueness(self, acting: list[Vector3]) -> tuple[bool, bool]:
        """Return whether forces and motion are unique, ``acting`` being the edges that can act."""
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
        """Return a and b of a . w + b for the height of the wrench w over the facet ``z``."""
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
