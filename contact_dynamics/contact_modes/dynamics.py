"""The mechanics of one planar contact mode: accelerations and forces that realise it, or why there are none.

Each letter of a mode brings as many equations as unknown forces (lecture 26): `l` and `r` the normal
acceleration and the force along the edge of the friction cone, `f` both accelerations and both forces. Where
these few equations are independent they are solved, and the letters' inequalities decide. Where they are not
(more contacts stay than a body has freedoms, or friction cancels the response, as for Painleve's rod), what
matters is whether the applied wrench lies in the cone of those that can bring the mode about
(`wrench_cone`), and the forces are some of many.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from contact_dynamics.contact_modes.enumeration import FIXED, LEFT, Cell, Letters
from contact_dynamics.contact_modes.result import ConsistentMode, Refusal, RefusedMode
from contact_dynamics.contact_modes.wrench_cone import ModeWrenches
from contact_dynamics.tolerances import ROW_TOLERANCE
from contact_dynamics.vector3 import Vector3, dot, norm

if TYPE_CHECKING:
    from collections.abc import Mapping

    from contact_dynamics.contact_modes.problem import ContactRow, PlanarProblem
    from contact_dynamics.planar import Vector2

_MOST_EQUATIONS: Final = 3  # that can be independent: a planar body's freedoms


def judge_all(
    problem: PlanarProblem, cells: Mapping[str, Cell], accuracy: float
) -> tuple[list[ConsistentMode], list[RefusedMode]]:
    """Return the consistent and the refused modes among ``cells``, in alphabetical order."""
    consistent: list[ConsistentMode] = []
    refused: list[RefusedMode] = []
    for mode, cell in sorted(cells.items()):
        outcome = solve_mode(problem, mode, cell, accuracy)
        if isinstance(outcome, ConsistentMode):
            consistent.append(outcome)
        else:
            refused.append(outcome)
    return consistent, refused


def solve_mode(
    problem: PlanarProblem, mode: str, cell: Cell, accuracy: float
) -> ConsistentMode | RefusedMode:
    """Return the solution of one mode, or the first reason against it."""
    forces = _independent_forces(problem, cell.letters)
    if forces is None:
        return _from_cone(problem, mode, cell, accuracy)
    return _judged(problem, mode, cell, forces, accuracy)


def _independent_forces(problem: PlanarProblem, letters: Letters) -> list[Vector2] | None:
    """Return (f_t, f_n) of each staying contact from the mode's equations; None: they are not independent."""
    if len(letters) > _MOST_EQUATIONS:
        return None
    if len(letters) == 1 and letters[0][1] != FIXED:
        return _sliding_force(problem, *letters[0])
    equations: list[tuple[Vector3, float]] = []  # unit row, its offset
    units: list[Vector3] = []  # wrench of each unknown, unit
    lengths: list[float] = []
    for position, letter in letters:
        row = problem.rows[position]
        equations.append((row.unit_n, row.b_n / row.size_n))
        if letter == FIXED:
            equations.append((row.unit_t, row.b_t / row.size_t))
            units += (row.unit_n, row.unit_t)
            lengths += (row.size_n, row.size_t)
        else:
            unknown = _edge(row, _slope(row, letter))
            length = norm(unknown)
            lengths.append(length)
            units.append((unknown[0] / length, unknown[1] / length, unknown[2] / length))
    if len(equations) > _MOST_EQUATIONS:
        return None
    matrix = [[dot(row, unit) for unit in units] for row, _ in equations]
    right = [-dot(row, problem.w) - problem.mass * offset for row, offset in equations]
    scaled = _solved(matrix, right)
    if scaled is None:
        return None
    found = iter([value / length for value, length in zip(scaled, lengths, strict=True)])
    forces: list[Vector2] = []
    for position, letter in letters:
        f_n = next(found)
        f_t = next(found) if letter == FIXED else _slope(problem.rows[position], letter) * f_n
        forces.append((f_t, f_n))
    return forces


def _sliding_force(problem: PlanarProblem, position: int, letter: int) -> list[Vector2] | None:
    """Return the same for one contact that slides, the most frequent case: one equation."""
    row = problem.rows[position]
    slope = _slope(row, letter)
    unknown = _edge(row, slope)
    gain = dot(row.unit_n, unknown)
    if abs(gain) <= ROW_TOLERANCE * norm(unknown):
        return None
    f_n = -(dot(row.unit_n, problem.w) + problem.mass * row.b_n / row.size_n) / gain
    return [(slope * f_n, f_n)]


def _judged(
    problem: PlanarProblem,
    mode: str,
    cell: Cell,
    forces: list[Vector2],
    accuracy: float,
) -> ConsistentMode | RefusedMode:
    """Keep the forces and the motion they give, unless a letter of the mode contradicts them."""
    load = problem.load
    for (position, _), (f_t, f_n) in zip(cell.letters, forces, strict=True):
        row = problem.rows[position]
        load += abs(f_n) * row.size_n + abs(f_t) * row.size_t
    tolerance = accuracy * load
    refused = _force_refusal(problem, mode, cell, forces, tolerance)
    if refused is not None:
        return refused
    q = _acceleration(problem, cell, forces)
    refused = _motion_refusal(problem, mode, cell, q, tolerance / problem.mass)
    if refused is not None:
        return refused
    return _consistent(problem, mode, cell, forces, unique=(True, True))


def _force_refusal(
    problem: PlanarProblem, mode: str, cell: Cell, forces: list[Vector2], tolerance: float
) -> RefusedMode | None:
    for (position, letter), (f_t, f_n) in zip(cell.letters, forces, strict=True):
        row = problem.rows[position]
        if f_n * row.size_n < -tolerance:
            return RefusedMode(mode=mode, refusal=Refusal.PULLS, contact=row.contact, amount=f_n)
        excess = abs(f_t) - row.friction * f_n
        if letter == FIXED and excess * row.size_t > tolerance * (1.0 + row.friction):
            return RefusedMode(mode=mode, refusal=Refusal.OUTSIDE_CONE, contact=row.contact, amount=excess)
    return None


def _motion_refusal(
    problem: PlanarProblem, mode: str, cell: Cell, q: Vector3, tolerance: float
) -> RefusedMode | None:
    staying = dict(cell.letters)
    for position, row in enumerate(problem.rows):
        letter = staying.get(position)
        if letter is None:
            a_n = dot(row.N, q) + row.b_n
            if a_n <= tolerance * row.size_n:
                reason = Refusal.PENETRATES if a_n < -tolerance * row.size_n else Refusal.WRONG_MOTION
                return RefusedMode(mode=mode, refusal=reason, contact=row.contact, amount=a_n)
        elif letter != FIXED and row.slides == 0.0:
            a_t = dot(row.T, q) + row.b_t
            if (-a_t if letter == LEFT else a_t) <= tolerance * row.size_t:
                return RefusedMode(mode=mode, refusal=Refusal.WRONG_MOTION, contact=row.contact, amount=a_t)
    return None


def _from_cone(
    problem: PlanarProblem, mode: str, cell: Cell, accuracy: float
) -> ConsistentMode | RefusedMode:
    """Decide a mode whose equations are not independent by the cone of its wrenches."""
    wrenches = ModeWrenches(problem, cell)
    shortfall = wrenches.shortfall(accuracy)
    if shortfall is not None:
        return RefusedMode(mode=mode, refusal=Refusal.NO_SOLUTION, contact=-1, amount=shortfall)
    shares, unique = wrenches.solution(accuracy)
    sums = dict.fromkeys(wrenches.edges.positions, (0.0, 0.0))
    for position, slope, share in zip(wrenches.edges.positions, wrenches.edges.slopes, shares, strict=True):
        f_t, f_n = sums[position]
        sums[position] = (f_t + slope * share, f_n + share)
    forces = [sums[position] for position, _ in cell.letters]
    return _consistent(problem, mode, cell, forces, unique=unique)


def _consistent(
    problem: PlanarProblem,
    mode: str,
    cell: Cell,
    forces: list[Vector2],
    *,
    unique: tuple[bool, bool],
) -> ConsistentMode:
    q = _acceleration(problem, cell, forces)
    alpha = q[2] / problem.rho
    square = problem.omega * problem.omega
    accelerations: list[Vector2] = []
    a_x, a_y, _ = q
    for contact in problem.contacts:
        n_x, n_y = contact.normal
        r_x, r_y = contact.r
        c_x = a_x - alpha * r_y - square * r_x
        c_y = a_y + alpha * r_x - square * r_y
        accelerations.append((c_x * n_y - c_y * n_x, c_x * n_x + c_y * n_y))
    all_forces: list[Vector2] = [(0.0, 0.0)] * len(problem.contacts)
    for (position, letter), (f_t, f_n) in zip(cell.letters, forces, strict=True):
        row = problem.rows[position]
        index = row.contact
        edge = row.friction * f_n
        if f_n > 0.0:  # rounding at the cone's apex and edges is taken out
            all_forces[index] = (max(-edge, min(edge, f_t)), f_n)
        # What the mode says is zero is zero, without rounding.
        accelerations[index] = (0.0 if letter == FIXED else accelerations[index][0], 0.0)
    forces_unique, motion_unique = unique
    return ConsistentMode(
        mode=mode,
        acceleration=(a_x, a_y),
        angular_acceleration=alpha,
        contact_forces=tuple(all_forces),
        contact_accelerations=tuple(accelerations),
        forces_unique=forces_unique,
        motion_unique=motion_unique,
    )


def _acceleration(problem: PlanarProblem, cell: Cell, forces: list[Vector2]) -> Vector3:
    x, y, z = problem.w
    for (position, _), (f_t, f_n) in zip(cell.letters, forces, strict=True):
        row = problem.rows[position]
        x += f_n * row.N[0] + f_t * row.T[0]
        y += f_n * row.N[1] + f_t * row.T[1]
        z += f_n * row.N[2] + f_t * row.T[2]
    return (x / problem.mass, y / problem.mass, z / problem.mass)


def _solved(matrix: list[list[float]], right: list[float]) -> list[float] | None:
    """Solve up to three equations with rows and columns of unit length; None: they are not independent."""
    size = len(right)
    for k in range(size):
        pivot = max(range(k, size), key=lambda i: abs(matrix[i][k]))
        if abs(matrix[pivot][k]) <= ROW_TOLERANCE:
            return None
        matrix[k], matrix[pivot] = matrix[pivot], matrix[k]
        right[k], right[pivot] = right[pivot], right[k]
        for i in range(k + 1, size):
            factor = matrix[i][k] / matrix[k][k]
            for j in range(k, size):
                matrix[i][j] -= factor * matrix[k][j]
            right[i] -= factor * right[k]
    for k in reversed(range(size)):
        for j in range(k + 1, size):
            right[k] -= matrix[k][j] * right[j]
        right[k] /= matrix[k][k]
    return right


def _edge(row: ContactRow, slope: float) -> Vector3:
    """Return the wrench of a force of unit normal part along the edge of a friction cone."""
    N, T = row.N, row.T
    return (N[0] + slope * T[0], N[1] + slope * T[1], N[2] + slope * T[2])


def _slope(row: ContactRow, letter: int) -> float:
    """Return f_t / f_n of a sliding contact: friction pushes right where it slides left."""
    return row.friction if letter == LEFT else -row.friction
