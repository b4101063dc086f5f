# SPDX-License-Identifier: Apache-2.0
"""Solves linear complementarity problems by Lemke's method: z >= 0 with w = M z + q >= 0 and z . w = 0.

Friction makes M unsymmetric and copositive. Lemke's method then finds a solution if some z >= 0 satisfies
w >= 0 (Cottle, Pang and Stone, The Linear Complementarity Problem, 1992, 4.4). Redundant contacts cause ties,
which a constant covering vector in general position breaks.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.tolerances import COVERED, NO_PIVOT

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray

_PIVOTS_A_ROW: Final = 50
"""Bound on the pivots per row. Solutions take one to three."""


def solve_complementarity(M: FloatArray, q: FloatArray) -> FloatArray | None:
    """Return z, (m,), with z >= 0, M z + q >= 0 and z . (M z + q) = 0, or None if the method ends on a ray.

    Args:
        M: (m, m), a copositive matrix.
        q: (m,), in the unit of M z.
    """
    m = len(q)
    if np.all(q >= 0.0):
        return np.zeros(m)
    cover = 1.0 + np.random.default_rng(26).uniform(size=m)
    # Columns: w, z, the covering variable, the right-hand side. Rows: the basic variables.
    table = np.hstack([np.eye(m), -M, -cover[:, None], q[:, None]])
    basis = list(range(m))
    solved = COVERED * float(np.abs(q).max())
    leaving_row = int((q / cover).argmin())
    entering = 2 * m
    for _ in range(_PIVOTS_A_ROW * m):
        table[leaving_row] /= table[leaving_row, entering]
        others = np.arange(m) != leaving_row
        table[others] -= np.outer(table[others, entering], table[leaving_row])
        leaving, basis[leaving_row] = basis[leaving_row], entering
        if leaving == 2 * m:
            z = np.zeros(2 * m + 1)
            z[basis] = np.maximum(table[:, -1], 0.0)
            return z[m : 2 * m]
        entering = leaving + m if leaving < m else leaving - m
        column = table[:, entering]
        rising = column > NO_PIVOT * float(np.abs(column).max())
        if not rising.any():
            return None
        ratios = np.full(m, np.inf)
        ratios[rising] = np.maximum(table[rising, -1], 0.0) / column[rising]
        leaving_row = int(ratios.argmin())
        # The problem is solved as soon as the covering variable can leave the basis.
        covering = basis.index(2 * m)
        if table[covering, -1] - ratios[leaving_row] * column[covering] <= solved:
            leaving_row = covering
    return None
