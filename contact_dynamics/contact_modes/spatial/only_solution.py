# SPDX-License-Identifier: Apache-2.0
"""In which range of sliding directions the equations of some letters have one solution only.

The equations say that rows of the motion vanish. The motion is a sum of unit changes times the unknowns. Rows
and unit changes turn with the directions, and everything is linear apart from that. If directions differ
from those of a solution by at most some angle, the forces follow to within bounds, and so do the derivatives.
If no matrix within the bounds of the derivatives is singular, there is no second solution in that range
(Krawczyk, Newton-Algorithmen zur Bestimmung von Nullstellen mit Fehlerschranken, 1969).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.tolerances import ALONE_WITHIN

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray

_CONTRACTS: Final = 0.99
"""Matrices are regular where the bounds, times the inverse in the middle, have a spectral radius below 1."""

_WORST: Final = 1e8
"""The condition of the derivatives beyond which nothing is claimed."""


class Equations(NamedTuple):
    """Equations at a solution: as many as unknowns, of which each is a share of force or a direction.

    Attributes:
        unknowns: (k,). The share of a contact stands just before its direction.
        angles: The numbers of the unknowns that are directions, and of the equations that turn with them.
        rows: (k, d + 1), whose products with the motion, followed by 1, vanish.
        rows_turn: (k, d + 1), bounds on how fast the rows turn with the direction of their contact, per rad.
        changes: (d, k), the changes of the motion with the unknowns.
        changes_turn: (d, k), how fast the change with a share turns at most with the direction. For a
            direction it is the same of its contact.
        motion: (d + 1,), the motion, followed by 1.
        slopes: (k, k), the derivatives of the equations.
    """

    unknowns: FloatArray
    angles: list[int]
    rows: FloatArray
    rows_turn: FloatArray
    changes: FloatArray
    changes_turn: FloatArray
    motion: FloatArray
    slopes: FloatArray


def alone_within(equations: Equations) -> float:
    """Return an angle, rad, within which of all directions no other solution is, or 0 if none was found."""
    k = len(equations.unknowns)
    if equations.slopes.shape != (k, k):
        return 0.0
    shares = [i for i in range(k) if i not in equations.angles]
    own = equations.slopes[np.ix_(shares, shares)]
    sizes, own_sizes = np.linalg.norm(equations.slopes, axis=0), np.linalg.norm(own, axis=0)
    if not (sizes.all() and own_sizes.all()):
        return 0.0
    slopes, own = equations.slopes / sizes, own / own_sizes
    if max(np.linalg.cond(slopes), np.linalg.cond(own)) > _WORST:
        return 0.0
    inverse = np.abs(np.linalg.inv(own)) / own_sizes[:, None]
    of_all = np.abs(np.linalg.inv(slopes)) / sizes[:, None]
    return next((turn for turn in ALONE_WITHIN if _is_regular(equations, shares, inverse, of_all, turn)), 0.0)


def _is_regular(
    equations: Equations, shares: list[int], inverse: FloatArray, of_all: FloatArray, turn: float
) -> bool:
    """Return whether the derivatives are regular where directions turn by at most an angle, rad.

    Args:
        equations: The equations.
        shares: The numbers of the unknowns that are shares of force.
        inverse: The absolute values of the inverse of the derivatives with respect to the shares.
        of_all: The absolute values of the inverse of all derivatives.
        turn: The angle.
    """
    unknowns, angles, rows, rows_turn, changes, changes_turn, motion, _ = equations
    of_rows = np.abs(rows[:, :-1])
    # The equations of the shares do not turn. So the shares are bounded first.
    error = inverse @ (of_rows[shares] @ (turn * changes_turn[:, shares]))
    if not _contracts(error):
        return False
    sizes = np.abs(unknowns)
    off = np.zeros_like(unknowns)
    off[shares] = np.linalg.solve(np.eye(len(shares)) - error, error @ sizes[shares])
    of_share = [i - 1 for i in angles]
    spread = turn * changes_turn
    spread[:, angles] = changes_turn[:, angles] * (turn * sizes[of_share] + off[of_share])
    moved = np.abs(changes[:, shares]) @ off[shares]
    moved += turn * changes_turn[:, shares] @ (sizes[shares] + off[shares])
    bounds = (of_rows + turn * rows_turn[:, :-1]) @ spread + turn * rows_turn[:, :-1] @ np.abs(changes)
    for i in angles:
        bounds[i, i] += turn * float(rows_turn[i] @ np.abs(motion)) + float(rows_turn[i, :-1] @ moved)
    return _contracts(of_all @ bounds)


def _contracts(matrix: FloatArray) -> bool:
    return matrix.size == 0 or float(np.abs(np.linalg.eigvals(matrix)).max()) < _CONTRACTS
