# SPDX-License-Identifier: Apache-2.0
"""Whether some edge forces satisfy linear conditions, by a small dense dual simplex that can be continued.

Edge forces are >= 0, the motion is an affine function of them, and each condition demands that a combination
of the motion is zero or is not negative. A `Program` holds its basic variables as affine functions of the
other variables, which are zero. A narrower program copies that table and adds its conditions. So a few pivots
decide it, where a linear program would start from nothing. The simplex keeps an unequally weighted sum of the
edge forces as small as it can. That bounds every step, and makes ties rare.

Where two contacts or normals are nearly the same, each pivot of the table divides by their difference, which
amplifies rounding. A `CarefulProgram` first gathers all conditions that are equations. An
orthonormal basis of the space that their rows span replaces them, so that rows that agree within
`ROW_TOLERANCE` are one condition, and rows that differ by more are as well conditioned as any others. It
makes its table anew, in NumPy's longest floating-point numbers.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Final, NamedTuple, cast

import numpy as np

from contact_dynamics.contact_modes.spatial import simplex_steps
from contact_dynamics.tolerances import (
    CAREFUL_LEAST_PIVOT,
    CAREFUL_UNMET,
    FEASIBLE,
    ROW_TOLERANCE,
    SAME_MOTION,
    TABLE_ROUNDING,
    TABLE_SMALL_PIVOT,
)

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from numpy.typing import NDArray

    from contact_dynamics.validation import FloatArray

_COMPILED: Final = hasattr(simplex_steps, "SOURCE_CRC")

_DEAD: Final = -1
"""The name of a column that stays zero."""

_GOLDEN: Final = 0.6180339887498949
"""The golden ratio less one. Its multiples are spread evenly modulo 1, which gives edge forces weights
without ties."""

_MAX_STEPS: Final = 500
"""The largest number of steps of the primal simplex. After a fifth of them Bland's rule holds, which cannot
cycle. The dual simplex is doubtful after so many. Tens are common, and rounding can make it go in circles."""

_CLEAR: Final = 1e3
"""A refusal is beyond doubt only if a condition is missed by this many times its estimated rounding."""

_MAX_FORCE: Final = 1e4
"""This is a multiple of the load. A refusal is beyond doubt only if entries that count as zero could matter
only with edge forces larger than this."""


class Ends(NamedTuple):
    """The range of a weighted sum of edge forces."""

    unique: bool  # whether the sum has one value only
    low: FloatArray | None  # (K,), edge forces at which it is least; None if it has no bound
    high: FloatArray | None  # (K,), edge forces at which it is largest; None if it has no bound


class Narrowing(NamedTuple):
    """Further conditions."""

    zeroed: frozenset[int] = frozenset()  # the names of variables that are zero
    raised: Collection[int] = ()  # the names of variables that are at least ``least``
    least: float = 0.0  # the least value of the ``raised`` variables
    rows: FloatArray | None = None  # (k, d + 1), combinations of the motion and a constant
    equalities: int = 0  # how many of the rows, from the first, are zero; the others are not negative
    tag: int = _DEAD  # the name of the rows, < -1; they replace those of that tag, which they must imply


class Program:
    """A set of edge forces that satisfy some conditions. Each narrower set is a new program.

    Attributes:
        asked: The conditions that were added one after another.
        doubtful: Whether rounding may have decided that nothing satisfies the conditions.
    """

    __slots__ = ("_columns", "_fixed", "_head", "_noise", "_rows", "_table", "asked", "doubtful")

    def __init__(
        self,
        table: FloatArray,
        rows: list[int],
        columns: list[int],
        fixed: NDArray[np.float64],
        noise: float = TABLE_ROUNDING,
    ) -> None:
        """Take a table whose columns are the variables that are zero, and constants. `stated` makes one."""
        self._noise = noise  # the estimated rounding of the table's entries
        self.asked: tuple[Narrowing, ...] = ()
        self.doubtful = False
        self._table = table
        self._head = len(table) - len(fixed)  # rows before conditions: the weighted sum, then the motion
        self._rows = rows  # the name of each condition's variable, after the head
        self._columns = columns
        self._fixed = fixed  # 1.0 where the row's variable is zero; 0.0 where it is not negative

    @staticmethod
    def stated(motion: FloatArray, named: FloatArray, names: Sequence[int]) -> Program:
        """Return the program whose motion, (d, K + 1), is given for K edge forces and a constant.

        Rows ``named``, (k, d + 1), are combinations of the motion and a constant that are not negative. Edge
        forces have the names 0 to K - 1, and the rows larger ones.
        """
        count = motion.shape[1] - 1
        rows = _rows_of(named, motion)
        table = np.concatenate([_weights(count), motion, rows])
        return Program(table, list(names), list(range(count)), np.zeros(len(rows)))

    def renamed(self, columns: list[int], equalities: int) -> Program:
        """Return the program with other names of its edge forces, and with its first rows as equations."""
        fixed = self._fixed.copy()
        fixed[:equalities] = 1.0
        return Program(self._table, self._rows, columns, fixed, self._noise)

    def narrowed(self, further: Narrowing) -> Program:
        """Return a program with further conditions."""
        zeroed, raised, least, rows, equalities, tag = further
        columns, table = self._columns, self._table
        if _DEAD in columns or not zeroed.isdisjoint(columns):
            keep = [k for k, name in enumerate(columns) if name != _DEAD and name not in zeroed]
            table = table.take([*keep, len(columns)], axis=1)
            columns = [columns[k] for k in keep]
        else:
            columns, table = list(columns), table.copy()
        names, fixed = self._rows, self._fixed
        if tag in names:
            held = [k for k, name in enumerate(names) if name != tag]
            table = table.take([*range(self._head), *(k + self._head for k in held)], axis=0)
            names = [names[k] for k in held]
            fixed = fixed[held]
        else:
            names, fixed = list(names), fixed.copy()
        for name in zeroed.intersection(names):
            fixed[names.index(name)] = 1.0
        for name in raised:
            if name in names:
                table[self._head + names.index(name), -1] -= least
            else:
                table[:, -1] += least * table[:, columns.index(name)]
        if rows is not None and len(rows):
            table = np.concatenate([table, _rows_of(rows, table[1 : self._head])])
            names += [tag] * len(rows)
            added = np.zeros(len(rows))
            added[:equalities] = 1.0
            fixed = np.concatenate([fixed, added])
        found = Program(table, names, columns, fixed, self._noise)
        found.asked = (*self.asked, further)
        return found

    def allows_any(self, weights: FloatArray, constants: FloatArray, least: float) -> bool:
        """Return whether some edge forces satisfy all conditions and at least one of some further ones.

        The sum of the edge forces with weights, (k, K), and of constants, (k,), must reach ``least`` in one
        of them.
        """
        count = weights.shape[1]
        rows, columns = np.array(self._rows, dtype=int), np.array(self._columns, dtype=int)
        ours = ((rows >= 0) & (rows < count)).nonzero()[0]
        sums = weights[:, rows[ours]] @ self._table[self._head + ours]
        beside = ((columns >= 0) & (columns < count)).nonzero()[0]
        sums[:, beside] += weights[:, columns[beside]]
        sums[:, -1] += constants - least
        if sums[:, -1].max() >= 0.0:
            return True
        for row in sums:
            table = np.concatenate([self._table, row[None, :]])
            fixed = np.append(self._fixed, 0.0)
            # The trial is solved, and not narrowed again, so that nobody asks for its name.
            trial = Program(table, [*self._rows, _DEAD], list(self._columns), fixed, self._noise)
            if trial.solve():
                return True
            self.doubtful |= trial.doubtful
        return False

    @property
    def motion(self) -> FloatArray:
        """The motion, (d,), that the table's edge forces cause."""
        found: FloatArray = self._table[1 : self._head, -1]
        return found

    def solve(self, least_pivot: float = ROW_TOLERANCE) -> bool:
        """Return whether some edge forces satisfy all conditions; the table then holds them.

        Smaller entries are zero.
        """
        if len(self._fixed) == 0:
            return True
        if _COMPILED:
            self._table = np.ascontiguousarray(self._table)
            missed, largest, grown = simplex_steps.solved(
                self._table, self._fixed, self._rows, self._columns, _DEAD, least_pivot, _MAX_STEPS
            )
            self._noise *= grown
        else:
            missed, largest = self._stepped(least_pivot)
        self.doubtful = missed != 0.0 and (
            missed <= _CLEAR * self._noise
            or (missed <= _MAX_FORCE * least_pivot and missed <= _MAX_FORCE * largest)
        )
        return missed == 0.0

    def _stepped(self, least_pivot: float) -> tuple[float, float]:
        """Exchange variables with NumPy, as `simplex_steps.solved` does, whose values this returns."""
        table, fixed, head = self._table, self._fixed, self._head
        values, entries, costs = table[head:, -1], table[head:, :-1], table[0]
        equations = int(np.count_nonzero(fixed))
        for _ in range(_MAX_STEPS):
            # Equations are mostly settled first. Then the least value is missed most.
            worst = int(np.maximum(-values, values * fixed).argmax() if equations else values.argmin())
            value = float(values[worst])
            missed = max(-value, value * float(fixed[worst]))
            if missed <= FEASIBLE:
                return 0.0, 0.0
            row = entries[worst]
            helps = row if value < 0.0 else -row
            able = (helps > least_pivot).nonzero()[0]
            if able.size == 0:
                return missed, float(helps.max(initial=0.0))
            enters = int(able[(costs[able] / helps[able]).argmin()])
            equations -= fixed[worst] != 0.0
            self._pivot(worst, enters)
        return -1.0, 0.0

    def _pivot(self, leaves: int, enters: int) -> None:
        """Exchange a condition's variable and a column's, which stays zero from then on if it is fixed."""
        table = self._table
        column = table[:, enters].copy()
        pivot = column[self._head + leaves]
        if abs(pivot) < TABLE_SMALL_PIVOT:
            self._noise *= TABLE_SMALL_PIVOT / abs(float(pivot))
        row = table[self._head + leaves] / -pivot
        row[enters] = 1.0 / pivot
        table[:, enters] = 0.0
        table += column[:, None] * row
        table[self._head + leaves] = row
        name = self._rows[leaves]
        self._rows[leaves] = self._columns[enters]
        self._columns[enters] = name
        if self._fixed[leaves]:
            self._fixed[leaves] = 0.0
            self._columns[enters] = _DEAD
            table[:, enters] = 0.0

    def shares(self, count: int) -> FloatArray:
        """Return the edge forces, (count,), that the table holds."""
        found = np.zeros(count)
        for name, value in zip(self._rows, self._table[self._head :, -1], strict=True):
            if 0 <= name < count:
                found[name] = max(0.0, value)
        return found

    def ends(self, weights: FloatArray) -> Ends:
        """Return whether a sum of edge forces, with weights, (K,), has one value only, and where it ends."""
        largest = float(np.abs(weights).max(initial=0.0))
        weights = weights / largest if largest > 0.0 else weights  # so that the units of force do not matter
        work = Program(
            self._table.copy(), list(self._rows), list(self._columns), self._fixed.copy(), self._noise
        )
        work._settle_fixed()
        found = []
        for sign in (1.0, -1.0):
            if not work._minimise(sign * weights):
                return Ends(unique=False, low=None, high=None)
            found.append(work.shares(len(weights)))
        low, high = float(weights @ found[0]), float(weights @ found[1])
        return Ends(high - low <= SAME_MOTION * (1.0 + abs(low)), *found)

    def _settle_fixed(self) -> None:
        """Exchange variables that are fixed at zero for columns, as far as those columns change them."""
        for k in np.flatnonzero(self._fixed):
            row = np.abs(self._table[self._head + k, :-1])
            if row.size and row.max() > ROW_TOLERANCE:
                self._pivot(int(k), int(row.argmax()))

    def _minimise(self, weights: FloatArray) -> bool:
        """Make the weighted sum of the edge forces least, and return whether it has a least value."""
        table = self._table
        table[0] = 0.0
        for k, name in enumerate(self._rows):
            if 0 <= name < len(weights):
                table[0] += weights[name] * table[self._head + k]
        for k, name in enumerate(self._columns):
            if 0 <= name < len(weights):
                table[0, k] += weights[name]
        for step in range(_MAX_STEPS):
            gains = (table[0, :-1] < -ROW_TOLERANCE).nonzero()[0]
            if gains.size == 0:
                return True
            enters = int(gains[0] if 5 * step > _MAX_STEPS else gains[table[0, gains].argmin()])
            falls = (table[self._head :, enters] < -ROW_TOLERANCE).nonzero()[0]
            if falls.size == 0:
                return False
            steps = np.maximum(table[self._head + falls, -1], 0.0) / -table[self._head + falls, enters]
            self._pivot(int(falls[steps.argmin()]), enters)
        return True


@cache
def _weights(count: int) -> FloatArray:
    """Return the weights of edge forces, (1, count + 1), with that of the constant, which is zero."""
    weights = np.append(1.0 + 0.5 * (np.arange(1, count + 1) * _GOLDEN % 1.0), 0.0)
    weights.flags.writeable = False
    return weights[None, :]


def _rows_of(rows: FloatArray, motion: FloatArray) -> FloatArray:
    found: FloatArray = rows[:, :-1] @ motion
    found[:, -1] += rows[:, -1]
    return found


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

    Each of the rows, (m, d + 1), of about unit length, demands that its product with the motion, followed by
    1, is zero. Rows that differ by no more than the tolerance count as one.
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
