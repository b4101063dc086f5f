# SPDX-License-Identifier: Apache-2.0
"""The applied wrenches of each mode of planar contacts, and the margins of a wrench in them (lecture 26).

The applied wrenches that can bring about a mode are a convex set, and a cone if there are no centripetal
terms. All sets together are the map of modes over applied wrenches. They overlap where the outcome is
indeterminate, and leave gaps where it is inconsistent.

The margin of a wrench in a mode is the size of the least change that takes it out of the mode's set, in the
metric |f|^2 + (moment / length)^2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

from contact_dynamics.contact_modes.letters import PLANAR_LETTERS, check_modes, margin_in_words
from contact_dynamics.contact_modes.planar.answer import planar_contact_modes
from contact_dynamics.contact_modes.planar.enumeration import kinematic_cells
from contact_dynamics.contact_modes.planar.judgement import judge_all
from contact_dynamics.contact_modes.planar.problem import accuracy_of, touching_case
from contact_dynamics.contact_modes.planar.wrench_cone import ModeWrenches
from contact_dynamics.contact_modes.result import ModeVerdict, check_length
from contact_dynamics.plane.types import PlanarWrench
from contact_dynamics.records import Record
from contact_dynamics.tolerances import BEYOND_MARGIN

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from contact_dynamics.contact_modes.planar.enumeration import Cell
    from contact_dynamics.contact_modes.planar.problem import PlanarCase, PlanarContactProblem
    from contact_dynamics.contact_modes.result import PlanarModeAnswer
    from contact_dynamics.numerics.vectors import Vector3


class WrenchHalfSpace(NamedTuple):
    """Half-space of applied wrenches with a . (f_x, f_y, moment) <= b.

    Attributes:
        a: In units (1, 1, 1/m). It is a unit vector if its third component is multiplied by the radius of
            gyration.
        b: N.
    """

    a: Vector3
    b: float

    def depth(self, wrench: PlanarWrench, length: float) -> float:
        """Return the depth of a wrench inside it, N, in the metric of ``length``, m; negative outside."""
        room = self.b - self.a[0] * wrench.f[0] - self.a[1] * wrench.f[1] - self.a[2] * wrench.moment
        return room / math.sqrt(self._square(length))

    def outward(self, length: float) -> PlanarWrench:
        """Return the change that leaves it on the shortest path, of size 1 in the metric of ``length``."""
        size = math.sqrt(self._square(length))
        return PlanarWrench(f=(self.a[0] / size, self.a[1] / size), moment=self.a[2] * length * length / size)

    def _square(self, length: float) -> float:
        return self.a[0] ** 2 + self.a[1] ** 2 + (self.a[2] * length) ** 2


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PlanarWrenchSet(Record):
    """Applied wrenches that can cause one mode, as a closed convex set in two representations.

    Attributes:
        mode: One letter for each contact.
        vertices: The set contains all convex combinations of the vertices plus all nonnegative combinations
            of the generators.
        generators: Their scale is arbitrary.
        half_spaces: Half-spaces whose intersection is the same set. Empty if the set contains every wrench.
    """

    mode: str
    vertices: tuple[PlanarWrench, ...]
    generators: tuple[PlanarWrench, ...]
    half_spaces: tuple[WrenchHalfSpace, ...]

    def depth(self, wrench: PlanarWrench, length: float) -> float:
        """Return the depth of a wrench inside the set, N, in the metric of ``length``, m.

        It is infinite if the set contains every wrench. It is negative outside the set, where its size is a
        lower bound of the distance.
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
    """Return the applied wrenches of every kinematically possible mode (`plane_or_space.wrench_sets`).

    There are none if a contact approaches, or if none touches. The problem's own wrench plays no part. A mode
    that is impossible under every wrench has no set.
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


_NO_WRENCH: Final = PlanarWrench(f=(0.0, 0.0))


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PlanarModeMargin(Record):
    """Smallest change of the applied wrench that ends a consistent mode, and the modes that follow.

    Attributes:
        mode: One letter for each contact.
        margin: N, size of the smallest change that leaves the mode: the root of |f|^2 + (moment / length)^2.
            It is infinite if no change leaves the mode.
        length: m, the length in that metric.
        change: The smallest change, or zero if no change leaves the mode.
        verdict_beyond: Verdict after a change that is larger by `BEYOND_MARGIN`, or the present verdict if
            there is no boundary. It is valid only up to the next boundary.
        modes_beyond: Consistent modes there.
    """

    mode: str
    margin: float
    length: float
    change: PlanarWrench
    verdict_beyond: ModeVerdict
    modes_beyond: tuple[str, ...]

    def in_short(self) -> str:
        """Return the mode, the change of the wrench that ends it, and the modes that follow."""
        return f"{type(self).__name__}: {margin_in_words(self.mode, self.margin, self.modes_beyond)}"


def planar_mode_margins(
    problem: PlanarContactProblem,
    answer: PlanarModeAnswer | None = None,
    *,
    margin_length: float | None = None,
) -> tuple[PlanarModeMargin, ...]:
    """Return the margin of the wrench in each of its consistent modes (`plane_or_space.mode_margins`)."""
    length = check_length(margin_length, problem.body.radius_of_gyration)
    if answer is None:
        answer = planar_contact_modes(problem)
    if answer.approaching:
        return ()
    wrench, case = problem.wrench, touching_case(problem)
    cells = kinematic_cells(case) if case is not None else {}
    present = tuple(mode.mode for mode in answer.modes)
    found = []
    for mode in present:
        margin, change, verdict, beyond = math.inf, _NO_WRENCH, answer.verdict, present
        sides = wrench_set_of(case, mode, cells[mode]).half_spaces if case is not None else ()
        if case is not None and sides:
            side = min(sides, key=lambda half_space: half_space.depth(wrench, length))
            # A consistent wrench that rounding has put outside has the margin zero.
            margin, way = max(0.0, side.depth(wrench, length)), side.outward(length)
            change = _stepped(_NO_WRENCH, margin, way)
            step = margin + BEYOND_MARGIN * max(margin, math.hypot(*wrench.f, wrench.moment / length))
            there = _stepped(wrench, step, way)
            other = case._replace(w=(*there.f, there.moment / case.rho))
            judged = judge_all(other, cells, accuracy_of(problem))
            verdict, beyond = judged.verdict, tuple(one.mode for one in judged.consistent)
        found.append(
            PlanarModeMargin(
                mode=mode,
                margin=margin,
                length=length,
                change=change,
                verdict_beyond=verdict,
                modes_beyond=beyond,
            )
        )
    return tuple(found)


def _stepped(wrench: PlanarWrench, step: float, way: PlanarWrench) -> PlanarWrench:
    return PlanarWrench(
        f=(wrench.f[0] + step * way.f[0], wrench.f[1] + step * way.f[1]),
        moment=wrench.moment + step * way.moment,
    )
