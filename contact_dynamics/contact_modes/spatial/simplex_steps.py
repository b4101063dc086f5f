# SPDX-License-Identifier: Apache-2.0
"""The steps of `dual_simplex` in loops over the numbers of a table, which are fast where they are compiled.

Elsewhere `dual_simplex` takes the same steps with NumPy, because such loops take many times as long in plain
Python. Both give the same bits. `simplex_steps.pxd` gives the C types with which this file compiles.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from contact_dynamics.tolerances import FEASIBLE, TABLE_SMALL_PIVOT

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray


def solved(  # noqa: PLR0917
    table: FloatArray,
    fixed: FloatArray,
    rows: list[int],
    columns: list[int],
    dead: int,
    least_pivot: float,
    most: int,
) -> tuple[float, float, float]:
    """Exchange variables until all conditions hold, or one cannot hold, as `Program.solve` does.

    Return by how much that one is missed and the largest entry that helps, or zeros if all conditions hold,
    and the factor by which rounding grew. If the steps do not end, what is missed is negative.

    Args:
        table: (h + m, n + 1), the table, whose first rows are no conditions.
        fixed: (m,), as `Program` has it.
        rows: The names of the m conditions' variables.
        columns: The names of the n columns' variables.
        dead: The name of a column that stays zero.
        least_pivot: Entries of the table that are no larger count as zero.
        most: The number of steps.
    """
    n, head = table.shape[1] - 1, table.shape[0] - fixed.shape[0]
    grown = 1.0
    for _ in range(most):
        worst = _most_missed(table, fixed)
        at = head + worst
        value = table[at, n]
        missed = max(-value, value * fixed[worst])
        if missed <= FEASIBLE:
            return 0.0, 0.0, grown
        sign = 1.0 if value < 0.0 else -1.0
        enters = _entering(table, at, sign, least_pivot)
        if enters == n:
            return missed, _largest(table, at, sign), grown
        size = float(abs(table[at, enters]))
        if size < TABLE_SMALL_PIVOT:
            grown *= TABLE_SMALL_PIVOT / size
        _exchange(table, at, enters)
        name = rows[worst]
        rows[worst] = columns[enters]
        columns[enters] = name
        if fixed[worst] != 0.0:
            fixed[worst] = 0.0
            columns[enters] = dead
            for i in range(table.shape[0]):
                table[i, enters] = 0.0
    return -1.0, 0.0, grown


def _most_missed(table: FloatArray, fixed: FloatArray) -> int:
    """Return the condition that is missed most."""
    n, head = table.shape[1] - 1, table.shape[0] - fixed.shape[0]
    worst, missed = 0, -1.0
    for i in range(fixed.shape[0]):
        value = table[head + i, n]
        short = max(-value, value * fixed[i])
        if short > missed:
            worst, missed = i, short
    return worst


def _entering(table: FloatArray, at: int, sign: float, least_pivot: float) -> int:
    """Return the column that helps a row at the least cost, or the number of columns if none helps it."""
    n: int = table.shape[1] - 1
    enters, least = n, 0.0
    for j in range(n):
        helps = sign * table[at, j]
        if helps > least_pivot:
            ratio = table[0, j] / helps
            if enters == n or ratio < least:
                enters, least = j, ratio
    return enters


def _largest(table: FloatArray, at: int, sign: float) -> float:
    """Return the largest entry that helps a row, or zero if none does."""
    largest = 0.0
    for j in range(table.shape[1] - 1):
        largest = max(largest, float(sign * table[at, j]))
    return largest


def _exchange(table: FloatArray, at: int, enters: int) -> None:
    """Solve a row of the table for a column's variable, and put that in all other rows."""
    pivot = table[at, enters]
    for j in range(table.shape[1]):
        table[at, j] /= -pivot
    table[at, enters] = 1.0 / pivot
    for i in range(table.shape[0]):
        if i != at:
            share = table[i, enters]
            table[i, enters] = 0.0
            for j in range(table.shape[1]):
                table[i, j] += share * table[at, j]
