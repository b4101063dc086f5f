# SPDX-License-Identifier: Apache-2.0
"""This file decides whether mechanics allows a mode, and gives accelerations and forces or a reason against.

Each letter of a mode brings as many equations as unknown forces (lecture 26). For `l` and `r` this is one
equation, of the normal acceleration, and one force, along an edge of the friction cone. For `f` there are two
of each. If the equations are independent, they are solved, and the inequalities of the letters decide
(`determined`). They are not independent if more contacts stay than a body has freedoms, or if friction
cancels the response, as for Painleve's rod. Then a mode is consistent if the applied wrench lies in the cone
of the wrenches that can bring it about (`wrench_cone`), and its forces are some of many.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

from contact_dynamics.contact_modes.planar.determined import IndependentModes
from contact_dynamics.contact_modes.planar.enumeration import FIXED, RIGHT, Cell
from contact_dynamics.contact_modes.planar.problem import contact_accelerations
from contact_dynamics.contact_modes.planar.wrench_cone import ModeWrenches
from contact_dynamics.contact_modes.result import ModeVerdict, PlanarMode, Refusal, RefusedMode, verdict_on
from contact_dynamics.numerics.vectors import Vector3, combined, dot, norm, scaled
from contact_dynamics.tolerances import FORCES_ROUNDING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from contact_dynamics.contact_modes.planar.problem import PlanarCase
    from contact_dynamics.plane.types import Vector2

EVIDENCE: Final = 3.0
"""Forces are evidence if they miss what the letters say by no more than this number of tolerances."""


class Judged(NamedTuple):
    """What mechanics says about some modes, in alphabetical order."""

    consistent: list[PlanarMode]  # the modes that it allows
    refused: list[RefusedMode]  # the modes that it does not allow
    undecided: list[str]  # modes that it may allow: rounding decides whether their forces bring them about

    @property
    def verdict(self) -> ModeVerdict:
        """Return the verdict if these are all modes."""
        return ModeVerdict.UNDECIDED if self.undecided else verdict_on(self.consistent)


def judge_all(case: PlanarCase, cells: Mapping[str, Cell], accuracy: float) -> Judged:
    """Return what mechanics says about the modes ``cells``."""
    consistent: list[PlanarMode] = []
    refused: list[RefusedMode] = []
    undecided: list[str] = []
    independent = IndependentModes(case, accuracy)
    for mode, cell in sorted(cells.items()):
        forces = independent.forces(mode, cell.letters)
        outcome: PlanarMode | RefusedMode | None
        if forces is None:
            outcome = _judged(case, mode, cell, accuracy, exact=False)
            if outcome is None:  # its forces do not bring about what the letters say: they are no evidence
                outcome = _judged(case, mode, cell, accuracy, exact=True)
        elif isinstance(forces, RefusedMode):
            outcome = forces
        else:
            outcome = _shown(case, mode, cell, forces, accuracy)
        if isinstance(outcome, PlanarMode):
            consistent.append(outcome)
        elif outcome is None:
            undecided.append(mode)
        else:
            refused.append(outcome)
    return Judged(consistent, refused, undecided)


def _shown(
    case: PlanarCase, mode: str, cell: Cell, forces: list[Vector2], accuracy: float
) -> PlanarMode | RefusedMode | None:
    """Return the mode that the solution of its own equations gives.

    Forces within the tolerance of a friction cone are put into it. If they then do not bring about what the
    letters say, they are no evidence, and the mode is decided again with more digits.
    """
    inside = _in_cones(case, cell, forces)
    q = _acceleration(case, cell, inside)
    if _misses(case, cell, q) > _allowed(case, accuracy, inside) or (
        inside != forces and _contradiction(case, cell, q)
    ):
        return _judged(case, mode, cell, accuracy, exact=True)
    return _consistent(case, mode, cell, inside, q, unique=(True, True))


def _judged(
    case: PlanarCase, mode: str, cell: Cell, accuracy: float, *, exact: bool
) -> PlanarMode | RefusedMode | None:
    """Decide a mode by the cone of its wrenches. Return None if its forces do not bring it about."""
    wrenches = ModeWrenches(case, cell, exact=exact)
    shortfall = wrenches.shortfall(accuracy)
    if shortfall is not None:
        return RefusedMode(mode=mode, refusal=Refusal.NO_SOLUTION, contact=-1, amount=shortfall)
    found = wrenches.solution(accuracy)
    forces = _in_cones(case, cell, [found.forces[position] for position, _ in cell.letters])
    q = _acceleration(case, cell, forces)
    missed = 0.0
    if found.motion is not None:
        newton, q = q, _with_motion(case, q, found.motion)
        missed = case.mass * norm(combined(1.0, newton, -1.0, q))
    missed += _misses(case, cell, q)
    # Close to the boundary, the rounding of the forces may be larger than the strict inequalities.
    if _contradiction(case, cell, q) or missed > _allowed(case, accuracy, forces):
        return None
    return _consistent(case, mode, cell, forces, q, unique=(found.forces_unique, found.motion_unique))


def _allowed(case: PlanarCase, accuracy: float, forces: list[Vector2]) -> float:
    """Return by how much, N, the forces of a mode may miss what its letters say."""
    return EVIDENCE * (accuracy + FORCES_ROUNDING) * (case.load + sum(f_n for _, f_n in forces))


def _consistent(
    case: PlanarCase,
    mode: str,
    cell: Cell,
    forces: list[Vector2],
    q: Vector3,
    *,
    unique: tuple[bool, bool],
) -> PlanarMode:
    alpha = q[2] / case.rho
    accelerations = contact_accelerations(case.contacts, q[:2], alpha, case.omega)
    all_forces: list[Vector2] = [(0.0, 0.0)] * len(case.contacts)
    for (position, letter), force in zip(cell.letters, forces, strict=True):
        index = case.rows[position].contact
        all_forces[index] = force
        # The accelerations that the mode says are zero are given as zero, without rounding.
        accelerations[index] = (0.0 if letter == FIXED else accelerations[index][0], 0.0)
    forces_unique, motion_unique = unique
    return PlanarMode(
        mode=mode,
        acceleration=q[:2],
        angular_acceleration=alpha,
        contact_forces=tuple(all_forces),
        contact_accelerations=tuple(accelerations),
        forces_unique=forces_unique,
        motion_unique=motion_unique,
    )


def _in_cones(case: PlanarCase, cell: Cell, forces: list[Vector2]) -> list[Vector2]:
    """Return the forces, with those that leave their friction cones by a little moved into them."""
    inside = []
    for (position, _), (f_t, f_n) in zip(cell.letters, forces, strict=True):
        friction = case.rows[position].friction
        edge = friction * f_n
        if f_n > 0.0:
            inside.append((max(-edge, min(edge, f_t)), f_n))
        else:
            inside.append((f_t, 0.0) if friction == math.inf else (0.0, 0.0))
    return inside


def _misses(case: PlanarCase, cell: Cell, q: Vector3) -> float:
    """Return the largest acceleration, times mass, N, that the letters say is zero and ``q`` says is not."""
    x, y, z = q
    most = 0.0
    for position, letter in cell.letters:
        row = case.rows[position]
        N = row.unit_n
        most = max(most, abs(N[0] * x + N[1] * y + N[2] * z + row.b_n / row.size_n))
        if letter == FIXED:
            T = row.unit_t
            most = max(most, abs(T[0] * x + T[1] * y + T[2] * z + row.b_t / row.size_t))
    return case.mass * most


def _contradiction(case: PlanarCase, cell: Cell, q: Vector3) -> bool:
    """Return whether a contact that should separate or start to slide does not."""
    size = norm(q)
    staying = dict(cell.letters)
    if len(staying) == len(case.rows) and set(staying.values()) == {FIXED}:
        return False
    for position, row in enumerate(case.rows):
        letter = staying.get(position)
        if letter is None:
            value, length = dot(row.N, q) + row.b_n, row.size_n
        elif letter != FIXED and row.slides == 0.0:
            value, length = dot(row.T, q) + row.b_t, row.size_t
            value = value if letter == RIGHT else -value
        else:
            continue
        if value <= FORCES_ROUNDING * length * size:
            return True
    return False


def _acceleration(case: PlanarCase, cell: Cell, forces: list[Vector2]) -> Vector3:
    x, y, z = case.w
    for (position, _), (f_t, f_n) in zip(cell.letters, forces, strict=True):
        row = case.rows[position]
        x += f_n * row.N[0] + f_t * row.T[0]
        y += f_n * row.N[1] + f_t * row.T[1]
        z += f_n * row.N[2] + f_t * row.T[2]
    return (x / case.mass, y / case.mass, z / case.mass)


def _with_motion(case: PlanarCase, newton: Vector3, motion: Vector3) -> Vector3:
    """Return the acceleration that ``motion``, N, gives, and ``newton`` along a line of symmetry."""
    x, y, _ = scaled(motion, 1.0 / case.mass)
    if case.lift is None:
        return scaled(motion, 1.0 / case.mass)
    one, two = case.lift.across
    return combined(1.0, combined(x, one, y, two), dot(newton, case.lift.line), case.lift.line)
