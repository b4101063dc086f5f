# SPDX-License-Identifier: Apache-2.0
"""This file finds the applied wrenches of each mode of planar contacts (lecture 26).

The applied wrenches that can bring about a mode are a convex set, and a cone if there are no centripetal
terms. All sets together are the map of modes over applied wrenches. They overlap where the outcome is
indeterminate, and leave gaps where it is inconsistent.

The margin of a wrench in a mode is the size of the least change that takes it out of the mode's set, in the
metric |f|^2 + (moment / length)^2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from contact_dynamics.contact_modes.letters import PLANAR_LETTERS, check_modes
from contact_dynamics.contact_modes.planar.enumeration import kinematic_cells
from contact_dynamics.contact_modes.planar.problem import touching_case
from contact_dynamics.contact_modes.planar.wrench_cone import ModeWrenches
from contact_dynamics.plane.types import PlanarWrench
from contact_dynamics.records import Record

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from contact_dynamics.contact_modes.planar.enumeration import Cell
    from contact_dynamics.contact_modes.planar.problem import PlanarCase, PlanarContactProblem
    from contact_dynamics.numerics.vectors import Vector3


class WrenchHalfSpace(NamedTuple):
    """The applied wrenches with a . (f_x, f_y, moment) <= b.

    Attributes:
        a: Its units are (1, 1, 1/m). It is a unit vector if its third number is multiplied by the radius of
            gyration.
        b: N.
    """

    a: Vector3
    b: float

    def depth(self, wrench: PlanarWrench, length: float) -> float:
        """Return how far inside the wrench lies, N, in the metric of ``length``, m; < 0 is outside."""
        room = self.b - self.a[0] * wrench.f[0] - self.a[1] * wrench.f[1] - self.a[2] * wrench.moment
        return room / math.sqrt(self._square(length))

    def outward(self, length: float) -> PlanarWrench:
        """Return the change that leads out the shortest way. Its size is 1 in the metric of ``length``."""
        size = math.sqrt(self._square(length))
        return PlanarWrench(f=(self.a[0] / size, self.a[1] / size), moment=self.a[2] * length * length / size)

    def _square(self, length: float) -> float:
        return self.a[0] ** 2 + self.a[1] ** 2 + (self.a[2] * length) ** 2


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PlanarWrenchSet(Record):
    """The applied wrenches that can bring one mode about, as the closure of their set in two forms.

    Attributes:
        mode: The mode, with one letter for each contact.
        vertices: The set has all sums of an average of vertices and a positive combination of generators.
        generators: They may have any size.
        half_spaces: Their intersection is the same set. If there are none, it has every wrench.
    """

    mode: str
    vertices: tuple[PlanarWrench, ...]
    generators: tuple[PlanarWrench, ...]
    half_spaces: tuple[WrenchHalfSpace, ...]

    def depth(self, wrench: PlanarWrench, length: float) -> float:
        """Return how far inside the set a wrench lies, N, in the metric of ``length``, m.

        It is infinite if the set has every wrench. It is negative outside of the set, and then bounds the
        distance from below.
        """
        return min((side.depth(wrench, length) for side in self.half_spaces), default=math.inf)


def length_of(sets: Sequence[PlanarWrenchSet]) -> float:
    """Return the radius of gyration, m, of the body that sets were made for.

    It is the length with which the half-spaces have unit size, see `WrenchHalfSpace`. If no set is bounded in
    its torques, the length does not matter, and 1 is returned.
    """
    normals = [side.a for one in sets for side in one.half_spaces]
    a = max(normals, key=lambda row: abs(row[2]), default=(0.0, 0.0, 0.0))
    left = 1.0 - a[0] * a[0] - a[1] * a[1]
    return math.sqrt(left) / abs(a[2]) if a[2] != 0.0 and left > 0.0 else 1.0


def planar_wrench_sets(
    problem: PlanarContactProblem, *, modes: Collection[str] | None = None
) -> tuple[PlanarWrenchSet, ...]:
    """Return the applied wrenches of every kinematically possible mode, in alphabetical order.

    There are none if a contact approaches, or if none touches. The problem's own wrench plays no part.

    Args:
        problem: The contacts and the velocity.
        modes: The modes that are wanted, with one letter for each contact. If it is None, all are returned. A
            mode that is impossible under every wrench has no set.

    Raises:
        InvalidFieldError: modes that are not strings of s, l, r and f.

    Source: lecture 26, "Force dual for dynamic contact problem" and "Contact modes for wrench in tray".
    """
    check_modes(modes or (), len(problem.contacts), PLANAR_LETTERS)
    case = touching_case(problem)
    if case is None:
        return ()
    cells = sorted(kinematic_cells(case).items())
    return tuple(wrench_set_of(case, mode, cell) for mode, cell in cells if modes is None or mode in modes)


def wrench_set_of(case: PlanarCase, mode: str, cell: Cell) -> PlanarWrenchSet:
    """Return the wrenches of one mode. The problem's own wrench plays no part."""
    wrenches = ModeWrenches(case, cell)
    rho = case.rho
    vertices, generators = wrenches.generated_by()
    return PlanarWrenchSet(
        mode=mode,
        vertices=tuple(_in_units(vertex, rho) for vertex in vertices),
        generators=tuple(_in_units(generator, rho) for generator in generators),
        half_spaces=tuple(WrenchHalfSpace((a[0], a[1], a[2] / rho), b) for a, b in wrenches.half_spaces()),
    )


def _in_units(w: Vector3, rho: float) -> PlanarWrench:
    return PlanarWrench(f=(w[0], w[1]), moment=w[2] * rho)
