# SPDX-License-Identifier: Apache-2.0
"""Planar contact modes by trying every string over {s, l, r, f}, in exact rational arithmetic.

Slow and obvious: the lecture's table is written down as equations and inequalities for each string, in the
plain unknowns (a_x, a_y, alpha) and one force for each edge of a friction cone, and an exact method says
whether they have a solution: Fourier and Motzkin's elimination for the motion alone, the simplex method with
Bland's rule where forces come in. A string is given up as soon as its first letters have no solution.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import gcd, inf

Row = tuple[Fraction, ...]  # coefficients, then the constant


@dataclass(frozen=True)
class ExactContact:
    r: tuple[Fraction, Fraction]
    normal: tuple[Fraction, Fraction]  # exactly unit
    friction: Fraction
    static: Fraction | None = None  # of a contact that sticks, or None if it is the same


@dataclass(frozen=True)
class ExactCase:
    mass: Fraction
    inertia: Fraction
    v: tuple[Fraction, Fraction]
    w: Fraction
    contacts: tuple[ExactContact, ...]
    force: tuple[Fraction, Fraction]
    moment: Fraction

    def contact_velocity(self, contact: ExactContact) -> tuple[Fraction, Fraction]:
        (x, y), (n_x, n_y) = contact.r, contact.normal
        c_x, c_y = self.v[0] - self.w * y, self.v[1] + self.w * x
        return c_x * n_y - c_y * n_x, c_x * n_x + c_y * n_y

    def acceleration_rows(self, contact: ExactContact) -> tuple[Row, Row]:
        """Return a_t and a_n as (per a_x, per a_y, per alpha, constant)."""
        (x, y), (n_x, n_y) = contact.r, contact.normal
        square = self.w * self.w
        along = []
        for d_x, d_y in ((n_y, -n_x), (n_x, n_y)):
            along.append((d_x, d_y, x * d_y - y * d_x, -square * (x * d_x + y * d_y)))
        return along[0], along[1]

    def forces(self, contact: ExactContact, letter: str) -> list[tuple[Fraction, Fraction]]:
        """Return the edges (f_t, f_n) of the forces that a letter allows."""
        mu, one = contact.friction, Fraction(1)
        mu = contact.static if letter == "f" and contact.static is not None else mu
        return {"s": [], "l": [(mu, one)], "r": [(-mu, one)], "f": [(mu, one), (-mu, one)]}[letter]


def letter_conditions(case: ExactCase, contact: ExactContact, letter: str) -> tuple[list, list, list] | None:
    """Return rows that are zero, rows that are > 0, in (a_x, a_y, alpha, 1), and force edges; None: never."""
    v_t, v_n = case.contact_velocity(contact)
    a_t, a_n = case.acceleration_rows(contact)
    edges = case.forces(contact, letter)
    if v_n < 0:
        return None
    if v_n > 0:
        return ([], [], []) if letter == "s" else None
    if letter == "s":
        return [], [a_n], []
    if v_t != 0:
        return ([a_n], [], edges) if letter == ("l" if v_t < 0 else "r") else None
    if letter == "f":
        return [a_n, a_t], [], edges
    faster = a_t if letter == "r" else tuple(-x for x in a_t)
    return [a_n], [faster], edges


def kinematic_modes(case: ExactCase) -> set[str]:
    """Return all strings that some acceleration realises without penetration."""
    found = set()

    def extend(prefix: str, zero: list, positive: list) -> None:
        if len(prefix) == len(case.contacts):
            found.add(prefix)
            return
        for letter in "slrf":
            conditions = letter_conditions(case, case.contacts[len(prefix)], letter)
            if conditions is None:
                continue
            more_zero, more_positive = zero + conditions[0], positive + conditions[1]
            if has_solution(more_zero, more_positive):
                extend(prefix + letter, more_zero, more_positive)

    extend("", [], [])
    return found


def consistent_modes(case: ExactCase, kinematic: set[str]) -> set[str]:
    """Return the strings among ``kinematic`` that forces and Newton's law allow."""
    return {mode for mode in kinematic if _forces_exist(case, mode)}


def uniqueness(case: ExactCase, mode: str) -> tuple[bool, bool]:
    """Return whether the forces and the motion of a consistent mode are the only ones."""
    zero, positive, wrenches, _ = _in_forces(case, mode)
    count = len(wrenches)
    each = [tuple(Fraction(int(i == j)) for j in range(count)) for i in range(count)]
    motion = [tuple(wrench[k] for wrench in wrenches) for k in range(3)]
    return (
        not any(varies(row, zero, positive) for row in each),
        not any(varies(row, zero, positive) for row in motion),
    )


def _forces_exist(case: ExactCase, mode: str) -> bool:
    zero, positive, _, _ = _in_forces(case, mode)
    return best_slack(zero, positive) > 0


def _in_forces(case: ExactCase, mode: str) -> tuple[list, list, list, tuple]:
    """Return the mode's rows in terms of its edge forces, their accelerations, and the free one."""
    zero, positive, wrenches = [], [], []
    for contact, letter in zip(case.contacts, mode, strict=True):
        rows, strict_rows, edges = letter_conditions(case, contact, letter)
        zero += rows
        positive += strict_rows
        (x, y), (n_x, n_y) = contact.r, contact.normal
        for f_t, f_n in dict.fromkeys(edges):
            f_x, f_y = f_t * n_y + f_n * n_x, -f_t * n_x + f_n * n_y
            wrenches.append((f_x / case.mass, f_y / case.mass, (x * f_y - y * f_x) / case.inertia))
    free = (case.force[0] / case.mass, case.force[1] / case.mass, case.moment / case.inertia)

    def in_forces(row: Row) -> Row:
        constant = sum(a * b for a, b in zip(row, free, strict=False)) + row[3]
        return (*(sum(a * b for a, b in zip(row, wrench, strict=False)) for wrench in wrenches), constant)

    return [in_forces(row) for row in zero], [in_forces(row) for row in positive], wrenches, free


def has_solution(zero: list[Row], positive: list[Row]) -> bool:
    """Whether some point makes all ``zero`` rows 0 and all ``positive`` rows > 0 (Fourier, Motzkin)."""
    zero = [list(row) for row in zero]
    rows = [list(row) for row in positive]
    while zero:
        equation = zero.pop()
        pivot = next((i for i, value in enumerate(equation[:-1]) if value != 0), None)
        if pivot is None:
            if equation[-1] != 0:
                return False
            continue
        for other in (*zero, *rows):
            factor = other[pivot] / equation[pivot]
            other[:] = [a - factor * b for a, b in zip(other, equation, strict=True)]
    remaining = {_whole(row) for row in rows}
    for variable in range(3):
        up = [row for row in remaining if row[variable] > 0]
        down = [row for row in remaining if row[variable] < 0]
        remaining = {row for row in remaining if row[variable] == 0}
        for one in up:
            for two in down:
                a, b = -two[variable], one[variable]
                remaining.add(_whole([a * x + b * y for x, y in zip(one, two, strict=True)]))
    return all(row[-1] > 0 for row in remaining)


def _whole(row: list) -> tuple[int, ...]:
    """Return the row scaled by a positive factor to whole numbers without a common one."""
    common = 1
    for value in row:
        common = common * value.denominator // gcd(common, value.denominator)
    whole = [int(value * common) for value in row]
    divisor = gcd(*whole)
    return tuple(value // divisor for value in whole) if divisor else tuple(whole)


def best_slack(zero: list[Row], positive: list[Row]) -> Fraction:
    """Return the largest t <= 1 for which some x >= 0 has all ``zero`` rows 0 and all ``positive`` rows >= t.

    -1: none has even t = 0.
    """
    n = len((zero or positive or [(Fraction(0),)])[0]) - 1
    equations = [[*row[:-1], Fraction(0), *_slacks(positive, None), Fraction(0), row[-1]] for row in zero]
    equations += [
        [*row[:-1], Fraction(-1), *_slacks(positive, i), Fraction(0), row[-1]]
        for i, row in enumerate(positive)
    ]
    equations.append([*[Fraction(0)] * n, Fraction(1), *_slacks(positive, None), Fraction(1), Fraction(-1)])
    objective = [Fraction(0)] * (len(equations[0]) - 1)
    objective[n] = Fraction(1)
    best = maximum(objective, equations)
    return Fraction(-1) if best is None else best


def varies(objective: Row, zero: list[Row], positive: list[Row]) -> bool:
    """Whether ``objective`` . x varies over x >= 0 with ``zero`` rows 0 and ``positive`` rows >= 0."""
    equations = [[*row[:-1], *_slacks(positive, None), row[-1]] for row in zero]
    equations += [[*row[:-1], *_slacks(positive, i), row[-1]] for i, row in enumerate(positive)]
    if not equations:
        return any(value != 0 for value in objective)
    padded = [*objective, *[Fraction(0)] * len(positive)]
    return maximum(padded, equations) != -maximum([-value for value in padded], equations)


def _slacks(positive: list[Row], own: int | None) -> list[Fraction]:
    return [Fraction(-1 if i == own else 0) for i in range(len(positive))]


def maximum(objective: list[Fraction], equations: list[list[Fraction]]) -> Fraction | float | None:
    """Return the largest objective . x over x >= 0 under ``equations``.

    Each equation says (coefficients, constant) . (x, 1) = 0.
    None: no such x; infinite: no bound. The simplex method with Bland's rule and artificial unknowns.
    """
    columns = len(objective)
    table = [[*row[:-1], -row[-1]] for row in equations]
    table = [[-value for value in row] if row[-1] < 0 else row for row in table]
    basis = []
    for i, row in enumerate(table):
        row[-1:-1] = [Fraction(int(i == j)) for j in range(len(table))]
        basis.append(columns + i)
    _simplex(table, basis, [Fraction(0)] * columns + [Fraction(-1)] * len(table), len(table) + columns)
    if any(basis[i] >= columns and table[i][-1] != 0 for i in range(len(table))):
        return None
    for i in range(len(table)):  # an artificial that stays in the basis at zero must not grow
        entering = next((j for j in range(columns) if table[i][j] != 0), None)
        if basis[i] >= columns and entering is not None:
            _pivot(table, basis, i, entering)
    padded = objective + [Fraction(0)] * len(table)
    if not _simplex(table, basis, padded, columns):
        return inf
    return sum((padded[basis[i]] * table[i][-1] for i in range(len(table))), Fraction(0))


def _simplex(table: list, basis: list[int], objective: list[Fraction], allowed: int) -> bool:
    """Improve until nothing does. Return False if there is no bound."""
    while True:
        entering = next((j for j in range(allowed) if _gain(table, basis, objective, j) > 0), None)
        if entering is None:
            return True
        ratios = [(row[-1] / row[entering], basis[i], i) for i, row in enumerate(table) if row[entering] > 0]
        if not ratios:
            return False
        _pivot(table, basis, min(ratios)[2], entering)


def _gain(table: list, basis: list[int], objective: list[Fraction], column: int) -> Fraction:
    return objective[column] - sum(
        objective[basis[i]] * row[column] for i, row in enumerate(table) if row[column] != 0
    )


def _pivot(table: list, basis: list[int], at: int, entering: int) -> None:
    scale = table[at][entering]
    table[at] = [value / scale for value in table[at]]
    for i, row in enumerate(table):
        if i != at and row[entering] != 0:
            factor = row[entering]
            table[i] = [a - factor * b for a, b in zip(row, table[at], strict=True)]
    basis[at] = entering
