# SPDX-License-Identifier: Apache-2.0
"""Whether some edge forces satisfy conditions that nearly coincide.

`dual_simplex` goes on from table to table. Where two contacts or normals are nearly the same, it divides by
their difference again and again, which amplifies rounding. Here all conditions that are equations are
gathered first. Their rows have about unit length, and an orthonormal basis of the space that they span
replaces them. So rows that agree within `ROW_TOLERANCE` are one condition, and rows that differ by more are
as well conditioned as any others. Each program makes its table anew, in NumPy's longest floating-point
numbers.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np

from contact_dynamics.contact_modes.spatial.dual_simplex import Ends, Narrowing, Program
from contact_dynamics.tolerances import CAREFUL_LEAST_PIVOT, CAREFUL_UNMET, ROW_TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.validation import FloatArray


class CarefulProgram:
    """A set of edge forces that satisfy some conditions. It has the methods of `Program`."""

    __slots__ = ("_asked", "_motion", "_named", "_names", "_solved", "doubtful")

    def __init__(
        self, motion: FloatArray, named: FloatArray, names: Sequence[int], asked: tuple[Narrowing, ...] = ()
    ) -> None:
        """Take the arguments of `Program.stated`, and conditions that were added."""
        self._motion, self._named, self._names = motion, named, tuple(names)
        self._asked = asked
        self._solved: Program | None = None
        self.doubtful = False  # whether rounding may have decided, as in `Program`

    def narrowed(self, *further: Narrowing) -> CarefulProgram:
        """Return a program with further conditions."""
        return CarefulProgram(self._motion, self._named, self._names, (*self._asked, *further))

    def solve(self) -> bool:
        """Return whether some edge forces satisfy all conditions."""
        program = self._stated()
        if program is None:
            return False
        self._solved = program
        holds = program.solve(CAREFUL_LEAST_PIVOT)
        self.doubtful = program.doubtful
        return holds

    def allows_any(self, weights: FloatArray, constants: FloatArray, least: float) -> bool:
        """Return whether they allow one of some further conditions, as `Program.allows_any` does."""
        program = self._table
        holds = program.allows_any(weights, constants, least)
        self.doubtful = program.doubtful
        return holds

    def shares(self, count: int) -> FloatArray:
        """Return the edge forces, (count,), that were found."""
        return self._table.shares(count)

    def ends(self, weights: FloatArray) -> Ends:
        """Return whether a weighted sum of edge forces has one value only, as `Program.ends` does."""
        return self._table.ends(weights)

    @property
    def _table(self) -> Program:
        if self._solved is None:
            raise AssertionError("a program is solved before it is asked for its forces")
        return self._solved

    def _stated(self) -> Program | None:
        """Return the table with merged equations, or None if the equations contradict each other."""
        zeroed: set[int] = set()
        raised: dict[int, float] = {}
        tagged: dict[int, tuple[FloatArray, int]] = {}
        for further in self._asked:
            zeroed.update(further.zeroed)
            raised.update(dict.fromkeys(further.raised, further.least))
            if further.rows is not None:
                tagged[further.tag] = further.rows, further.equalities
        nothing = np.zeros((0, len(self._motion) + 1))
        zero, positive = [nothing], [nothing]
        for name, row in zip(self._names, self._named, strict=True):
            if name in zeroed:
                zero.append(row[None, :])
            else:
                lowered = row.copy()
                lowered[-1] -= raised.get(name, 0.0)
                positive.append(lowered[None, :])
        for rows, equalities in tagged.values():
            zero.append(rows[:equalities])
            positive.append(rows[equalities:])
        equations = merged(np.vstack(zero))
        if equations is None:
            return None
        count = self._motion.shape[1] - 1
        keep = [j for j in range(count) if j not in zeroed]
        motion = cast("FloatArray", self._motion[:, [*keep, count]].astype(np.longdouble))
        rows = np.vstack([equations, *positive])
        program = Program.stated(motion, rows, range(count, count + len(rows)))
        return program.renamed(keep, len(equations))


def merged(rows: FloatArray, tolerance: float = ROW_TOLERANCE) -> FloatArray | None:
    """Return equivalent equations, (k, d + 1), with orthonormal rows, or None if no motion satisfies them.

    Args:
        rows: (m, d + 1), of about unit length. Each demands that its product with the motion, followed by 1,
            is zero.
        tolerance: Rows that differ by no more count as one.
    """
    if len(rows) == 0:
        return rows
    left, sizes, basis = np.linalg.svd(rows[:, :-1], full_matrices=False)
    seen = int((sizes > tolerance * max(1.0, float(sizes.max(initial=0.0)))).sum())
    left = left[:, :seen]
    constants = left.T @ rows[:, -1]
    if np.abs(rows[:, -1] - left @ constants).max() > CAREFUL_UNMET:
        return None
    return np.column_stack([basis[:seen], constants / sizes[:seen]])
