# SPDX-License-Identifier: Apache-2.0
"""Proves that linear inequalities on non-negative numbers have no solution, if they have none.

The method is the dual simplex on a small dense table. By Farkas' lemma, inequalities without solution have a
non-negative combination that contradicts itself; the last table contains its multipliers in one row. The
caller checks that combination with its own bounds of rounding, so the proof does not depend on this file.

It replaces SciPy's linear programs (HiGHS), which take five times longer for tables of 35 rows, mostly to
check and convert what they are given, and whose interface for mixed integers has no multipliers.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.tolerances import INSOLUBLE

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray

_MAX_STEPS: Final = 400
"""Steps after which inequalities count as solvable. Tables of 35 rows take 15 on average."""

_GOLDEN: Final = 0.6180339887498949
"""The golden ratio less one. Its multiples are spread evenly modulo 1, which gives costs without ties."""


def contradiction(rows: FloatArray, limits: FloatArray) -> FloatArray | None:
    """Return multipliers, (m,), >= 0, that show that ``rows . x <= limits`` has no solution with x >= 0.

    The combined row is not negative, and the combined limit is negative, but for rounding. Returns None if
    the inequalities have a solution, or if it takes too many steps to find out.

    Args:
        rows: (m, n), the left sides.
        limits: (m,), the right sides.
    """
    m, n = rows.shape
    table = np.zeros((m + 1, n + 1))
    table[:m, :n] = rows
    table[:m, n] = limits
    table[m, :n] = 1.0 + 0.5 * (np.arange(1, n + 1) * _GOLDEN % 1.0)
    # Numbers below n are the variables x, and the others the slacks of the inequalities.
    columns, basic = np.arange(n), np.arange(n, n + m)
    costs = table[m, :n]
    for _ in range(_MAX_STEPS):
        r = int(table[:m, n].argmin())
        if table[r, n] >= -INSOLUBLE:
            return None
        row = table[r, :n]
        ratios = np.where(row < -INSOLUBLE, costs / np.minimum(row, -INSOLUBLE), -math.inf)
        j = int(ratios.argmax())
        if ratios[j] == -math.inf:
            multipliers = np.zeros(n + m)
            multipliers[columns] = np.maximum(row, 0.0)
            multipliers[basic[r]] = 1.0
            return multipliers[n:]
        pivot = table[r, j]
        table[r] /= pivot
        column = table[:, j].copy()
        column[r] = 0.0
        table -= column[:, None] * table[r]
        table[:, j] = -column / pivot
        table[r, j] = 1.0 / pivot
        basic[r], columns[j] = columns[j], basic[r]
    return None
