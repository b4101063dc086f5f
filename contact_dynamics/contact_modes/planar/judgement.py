"""This file decides whether mechanics allows a mode, and gives accelerations and forces or a reason against.

Each letter of a mode brings as many equations as unknown forces (lecture 26). For `l` and `r` this is one
equation, of the normal acceleration, and one force, along an edge of the friction cone. For `f` there are two
of each. If the equations are independent, they are solved, and the inequalities of the letters decide
(`determined`). They are not independent if more contacts stay than a body has freedoms, or if friction
cancels the response, as for Painleve's rod. Then a mode is consistent if the applied wrench lies in the cone
of the wrenches that can bring it about (`wrench_cone`), and its forces are some of many.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from contact_dynamics.contact_modes.planar.determined import IndependentModes
from contact_dynamics.contact_modes.planar.enumeration import FIXED, RIGHT, Cell
from contact_dynamics.contact_modes.planar.result import PlanarMode
from contact_dynamics.contact_modes.planar.wrench_cone import ModeWrenches
from contact_dynamics.contact_modes.result import Refusal, RefusedMode
from contact_dynamics.numerics.vectors import Vector3, dot, norm
from contact_dynamics.tolerances import FORCES_ROUNDING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from contact_dynamics.contact_modes.planar.problem import PlanarCase
    from contact_dynamics.plane.types import Vector2

_EVIDENCE: Final = 3.0
"""Forces are evidence if they miss what the letters say by no more than this number of tolerances."""


def judge_all(
    case: PlanarCase, cells: Mapping[str, Cell], accuracy: float
) -> tuple[list[PlanarMode], list[RefusedMode]]:
    """Return the consistent and the refused modes among ``cells``, in alphabetical order."""
    consistent: list[PlanarMode] = []
    refused: list[RefusedMode] = []
    independent = IndependentModes(case, accuracy)
    for mode, cell in sorted(cells.items()):
        forces = independent.forces(mode, cell.letters)
        outcome: PlanarMode | RefusedMode
        if forces is None:
            outcome = _from_cone(case, mode, cell, accuracy)
        elif isinstance(forces, RefusedMode):
            outcome = forces
        elif _misses(case, cell, forces) > _allowed(case, accuracy, forces):
            outcome = _judged(case, mode, cell, accuracy, exact=True)[0]
        else:
            outcome = _consistent(case, mode, cell, forces, unique=(True, True))
        if isinstance(outcome, PlanarMode):
            consistent.append(outcome)
        else:
            refused.append(outcome)
    return consistent, refused


def _from_cone(case: PlanarCase, mode: str, cell: Cell, accuracy: float) -> PlanarMode | RefusedMode:
    """Decide a mode whose equations are not independent by the cone of its wrenches.

    If the forces do not bring about what the letters say, they are no evidence. Then the mode is decided
    again with more digits.
    """
    outcome, certain = _judged(case, mode, cell, accuracy, exact=False)
    return outcome if certain else _judged(case, mode, cell, accuracy, exact=True)[0]


def _judged(
    case: PlanarCase, mode: str, cell: Cell, accuracy: float, *, exact: bool
) -> tuple[PlanarMode | RefusedMode, bool]:
    """Return the decision on a mode, and whether it is certain."""
    wrenches = ModeWrenches(case, cell, exact=exact)
    shortfall = wrenches.shortfall(accuracy)
    if shortfall is not None:
        return RefusedMode(mode=mode, refusal=Refusal.NO_SOLUTION, contact=-1, amount=shortfall), True
    shares, unique = wrenches.solution(accuracy)
    sums = dict.fromkeys(wrenches.edges.positions, (0.0, 0.0))
    for position, slope, share in zip(wrenches.edges.positions, wrenches.edges.slopes, shares, strict=True):
        f_t, f_n = sums[position]
        sums[position] = (f_t + slope * share, f_n + share)
    forces = [sums[position] for position, _ in cell.letters]
    allowed = _EVIDENCE * (accuracy + FORCES_ROUNDING) * (case.load + sum(shares))
    # Close to the boundary, the rounding of the forces may be larger than the strict inequalities.
    lost = _contradiction(case, cell, forces)
    if lost is not None:
        contact, amount = lost
        refused = RefusedMode(mode=mode, refusal=Refusal.WRONG_MOTION, contact=contact, amount=amount)
        return refused, wrenches.dual.exact
    certain = wrenches.dual.exact or _misses(case, cell, forces) <= allowed
    return _consistent(case, mode, cell, forces, unique=unique), certain


def _allowed(case: PlanarCase, accuracy: float, forces: list[Vector2]) -> float:
    """Return by how much, N, the forces of a mode may miss what its letters say."""
    return _EVIDENCE * (accuracy + FORCES_ROUNDING) * (case.load + sum(f_n for _, f_n in forces))


def _consistent(
    case: PlanarCase,
    mode: str,
    cell: Cell,
    forces: list[Vector2],
    *,
    unique: tuple[bool, bool],
) -> PlanarMode:
    q = _acceleration(case, cell, forces)
    alpha = q[2] / case.rho
    square = case.omega * case.omega
    accelerations: list[Vector2] = []
    a_x, a_y, _ = q
    for contact in case.contacts:
        n_x, n_y = contact.normal
        r_x, r_y = contact.r
        c_x = a_x - alpha * r_y - square * r_x
        c_y = a_y + alpha * r_x - square * r_y
        accelerations.append((c_x * n_y - c_y * n_x, c_x * n_x + c_y * n_y))
    all_forces: list[Vector2] = [(0.0, 0.0)] * len(case.contacts)
    for (position, letter), (f_t, f_n) in zip(cell.letters, forces, strict=True):
        row = case.rows[position]
        index = row.contact
        edge = row.friction * f_n
        if f_n > 0.0:  # the force is moved by its rounding, so that it does not leave the friction cone
            all_forces[index] = (max(-edge, min(edge, f_t)), f_n)
        # The accelerations that the mode says are zero are given as zero, without rounding.
        accelerations[index] = (0.0 if letter == FIXED else accelerations[index][0], 0.0)
    forces_unique, motion_unique = unique
    return PlanarMode(
        mode=mode,
        acceleration=(a_x, a_y),
        angular_acceleration=alpha,
        contact_forces=tuple(all_forces),
        contact_accelerations=tuple(accelerations),
        forces_unique=forces_unique,
        motion_unique=motion_unique,
    )


def _misses(case: PlanarCase, cell: Cell, forces: list[Vector2]) -> float:
    """Return the largest acceleration, times mass, N, that the letters say is zero and the forces do not."""
    q = _acceleration(case, cell, forces)
    most = 0.0
    for position, letter in cell.letters:
        row = case.rows[position]
        most = max(most, case.mass * abs(dot(row.unit_n, q) + row.b_n / row.size_n))
        if letter == FIXED:
            most = max(most, case.mass * abs(dot(row.unit_t, q) + row.b_t / row.size_t))
    return most


def _contradiction(case: PlanarCase, cell: Cell, forces: list[Vector2]) -> tuple[int, float] | None:
    """Return the first contact that should separate or start to slide but does not, and its acceleration.

    Returns None if all contacts move as their letters say.
    """
    q = _acceleration(case, cell, forces)
    size = norm(q)
    staying = dict(cell.letters)
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
            return row.contact, value
    return None


def _acceleration(case: PlanarCase, cell: Cell, forces: list[Vector2]) -> Vector3:
    x, y, z = case.w
    for (position, _), (f_t, f_n) in zip(cell.letters, forces, strict=True):
        row = case.rows[position]
        x += f_n * row.N[0] + f_t * row.T[0]
        y += f_n * row.N[1] + f_t * row.T[1]
        z += f_n * row.N[2] + f_t * row.T[2]
    return (x / case.mass, y / case.mass, z / case.mass)
