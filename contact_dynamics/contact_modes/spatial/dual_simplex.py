"""Whether some edge forces satisfy linear conditions: a small dense dual simplex that goes on where it was.

Edge forces are >= 0, the motion is affine in them, and conditions ask combinations of the motion to be zero
or not negative. A `Program` holds its basic variables as affine functions of the others, which are zero; a
narrower one copies that table and adds its conditions, so that a few pivots decide it instead of a linear
program from nothing. The sum of edge forces, unequally weighted, is kept least: that bounds every step, and
ties are rare.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.tolerances import (
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

_HEAD: Final = 7
"""Rows of the table before the conditions: the weighted sum of edge forces, then the motion."""

_DEAD: Final = -1
"""Name of a column that stays zero."""

_GOLDEN: Final = 0.6180339887498949
"""Its multiples are spread evenly modulo 1: weights of the edge forces without ties."""

_MOST_STEPS: Final = 500
"""Bound on the steps of the primal simplex. From a fifth of it Bland's rule holds, which cannot cycle."""


_CLEAR: Final = 1e3
"""How many times its estimated rounding a condition must be missed by for a refusal to be beyond doubt."""

_MOST_FORCE: Final = 1e4
"""Times the load: a refusal is beyond doubt if what the table takes for zero could matter only with larger
edge forces than that."""


class Ends(NamedTuple):
    """What a weighted sum of edge forces ranges over.

    Attributes:
        unique: It is one number.
        low: (K,), edge forces where it is least; None: it has no bound.
        high: (K,), and largest.
    """

    unique: bool
    low: FloatArray | None
    high: FloatArray | None


class Program:
    """Edge forces that satisfy some conditions; each narrowing is a new program."""

    __slots__ = ("_columns", "_fixed", "_noise", "_rows", "_table", "doubtful")

    def __init__(
        self,
        table: FloatArray,
        rows: list[int],
        columns: list[int],
        fixed: NDArray[np.float64],
        noise: float = TABLE_ROUNDING,
    ) -> None:
        """Take a table whose columns are the variables that are zero, and constants; see `stated`."""
        self._noise = noise  # estimated rounding of the table's entries
        self.doubtful = False  # whether rounding may have decided that nothing satisfies the conditions
        self._table = table
        self._rows = rows  # name of each condition's variable, after the head
        self._columns = columns
        self._fixed = fixed  # 1.0: the row's variable is zero; 0.0: it is not negative

    @staticmethod
    def stated(motion: FloatArray, named: FloatArray, names: Sequence[int]) -> Program:
        """Return the program of the motion, (6, K + 1), for K edge forces and a constant.

        Args:
            motion: In the units in which conditions are stated.
            named: (k, 7), combinations of motion and a constant that are not negative.
            names: The names of the rows, >= K, for `narrowed`. Edge forces have the names 0 to K - 1.
        """
        count = motion.shape[1] - 1
        weights = np.append(1.0 + 0.5 * (np.arange(1, count + 1) * _GOLDEN % 1.0), 0.0)
        rows = _rows_of(named, motion)
        table = np.vstack([weights[None, :], motion, rows])
        return Program(table, list(names), list(range(count)), np.zeros(len(rows)))

    def renamed(self, columns: list[int], equalities: int) -> Program:
        """Return the program with other names of its edge forces, and its first rows zero."""
        fixed = self._fixed.copy()
        fixed[:equalities] = 1.0
        return Program(self._table, self._rows, columns, fixed, self._noise)

    def narrowed(
        self,
        *,
        zeroed: Collection[int] = (),
        raised: Collection[int] = (),
        least: float = 0.0,
        rows: FloatArray | None = None,
        equalities: int = 0,
        tag: int = _DEAD,
    ) -> Program:
        """Return a program with further conditions.

        Args:
            zeroed: Names of variables that are zero.
            raised: Names of variables that are at least ``least``.
            least: See ``raised``.
            rows: (k, 7), combinations of motion and a constant; the first ``equalities`` of them are zero,
                the others not negative.
            equalities: See ``rows``.
            tag: < -1, of the ``rows``. Earlier ones with that tag are replaced, and must follow from these.
        """
        keep = [k for k, name in enumerate(self._columns) if name != _DEAD and name not in zeroed]
        columns = [self._columns[k] for k in keep]
        keep.append(len(self._columns))
        table = self._table.take(keep, axis=1)
        names, fixed = self._rows, self._fixed
        if tag in names:
            held = [k for k, name in enumerate(names) if name != tag]
            table = table.take([*range(_HEAD), *(k + _HEAD for k in held)], axis=0)
            names = [names[k] for k in held]
            fixed = fixed[held]
        else:
            names, fixed = list(names), fixed.copy()
        for k, name in enumerate(names):
            if name in zeroed:
                fixed[k] = 1.0
        for name in raised:
            if name in names:
                table[_HEAD + names.index(name), -1] -= least
            else:
                table[:, -1] += least * table[:, columns.index(name)]
        if rows is not None and len(rows):
            table = np.concatenate([table, _rows_of(rows, table[1:_HEAD])])
            names += [tag] * len(rows)
            added = np.zeros(len(rows))
            added[:equalities] = 1.0
            fixed = np.concatenate([fixed, added])
        return Program(table, names, columns, fixed, self._noise)

    def allows_any(self, weights: FloatArray, constants: FloatArray, least: float) -> bool:
        """Return whether some edge forces satisfy all conditions and one, any one, further condition.

        Args:
            weights: (k, K), each condition's weights of the edge forces.
            constants: (k,), added to the weighted sums, which must be at least ``least``.
            least: See ``constants``.
        """
        count = weights.shape[1]
        rows, columns = np.array(self._rows, dtype=int), np.array(self._columns, dtype=int)
        ours = ((rows >= 0) & (rows < count)).nonzero()[0]
        sums = weights[:, rows[ours]] @ self._table[_HEAD + ours]
        beside = ((columns >= 0) & (columns < count)).nonzero()[0]
        sums[:, beside] += weights[:, columns[beside]]
        sums[:, -1] += constants - least
        if sums[:, -1].max() >= 0.0:
            return True
        for row in sums:
            table = np.concatenate([self._table, row[None, :]])
            fixed = np.append(self._fixed, 0.0)
            # Only solved, not narrowed again: the name is not asked for.
            trial = Program(table, [*self._rows, _DEAD], list(self._columns), fixed, self._noise)
            if trial.solve():
                return True
            self.doubtful |= trial.doubtful
        return False

    @property
    def motion(self) -> FloatArray:
        """The motion, (6,), of the table's edge forces."""
        found: FloatArray = self._table[1:_HEAD, -1]
        return found

    def solve(self, least_pivot: float = ROW_TOLERANCE) -> bool:
        """Return whether some edge forces satisfy all conditions, and make the table theirs.

        Args:
            least_pivot: Entries of the table up to it count as zero.
        """
        table, fixed = self._table, self._fixed
        if len(fixed) == 0:
            return True
        while True:
            values = table[_HEAD:, -1]
            missed = np.maximum(-values, values * fixed)
            worst = int(missed.argmax())
            if missed[worst] <= FEASIBLE:
                return True
            row = table[_HEAD + worst, :-1]
            helps = row if values[worst] < 0.0 else -row
            able = (helps > least_pivot).nonzero()[0]
            if able.size == 0:
                least = _MOST_FORCE * float(helps.max(initial=0.0))
                self.doubtful = bool(missed[worst] <= max(least, _CLEAR * self._noise))
                return False
            enters = able[(table[0, able] / helps[able]).argmin()]
            self._pivot(worst, int(enters))

    def _pivot(self, leaves: int, enters: int) -> None:
        """Exchange a condition's variable and a column's; a column whose variable is fixed dies."""
        table = self._table
        column = table[:, enters].copy()
        pivot = column[_HEAD + leaves]
        if abs(pivot) < TABLE_SMALL_PIVOT:
            self._noise *= TABLE_SMALL_PIVOT / abs(float(pivot))
        row = table[_HEAD + leaves] / -pivot
        row[enters] = 1.0 / pivot
        table[:, enters] = 0.0
        table += column[:, None] * row
        table[_HEAD + leaves] = row
        name = self._rows[leaves]
        self._rows[leaves] = self._columns[enters]
        self._columns[enters] = name
        if self._fixed[leaves]:
            self._fixed[leaves] = 0.0
            self._columns[enters] = _DEAD
            table[:, enters] = 0.0

    def shares(self, count: int) -> FloatArray:
        """Return the edge forces, (count,), of the table."""
        found = np.zeros(count)
        for name, value in zip(self._rows, self._table[_HEAD:, -1], strict=True):
            if 0 <= name < count:
                found[name] = max(0.0, value)
        return found

    def spread(self, weights: FloatArray) -> tuple[FloatArray, FloatArray] | None:
        """Return edge forces at which their weighted sum is least and largest; None: it has no bound.

        Args:
            weights: (K,).
        """
        work = Program(
            self._table.copy(), list(self._rows), list(self._columns), self._fixed.copy(), self._noise
        )
        work._settle_fixed()
        ends = []
        for sign in (1.0, -1.0):
            if not work._minimise(sign * weights):
                return None
            ends.append(work.shares(len(weights)))
        return ends[0], ends[1]

    def ends(self, weights: FloatArray) -> Ends:
        """Return whether a weighted sum of edge forces is the same for all that are allowed, and its ends.

        Args:
            weights: (K,).
        """
        largest = float(np.abs(weights).max(initial=0.0))
        weights = weights / largest if largest > 0.0 else weights  # whatever the units of force
        found = self.spread(weights)
        if found is None:
            return Ends(unique=False, low=None, high=None)
        low, high = float(weights @ found[0]), float(weights @ found[1])
        return Ends(high - low <= SAME_MOTION * (1.0 + abs(low)), *found)

    def _settle_fixed(self) -> None:
        """Exchange what is fixed at zero for columns, as far as those move it."""
        for k in np.flatnonzero(self._fixed):
            row = np.abs(self._table[_HEAD + k, :-1])
            if row.size and row.max() > ROW_TOLERANCE:
                self._pivot(int(k), int(row.argmax()))

    def _minimise(self, weights: FloatArray) -> bool:
        """Make the weighted sum of the edge forces least; False: it has no bound."""
        table = self._table
        table[0] = 0.0
        for k, name in enumerate(self._rows):
            if 0 <= name < len(weights):
                table[0] += weights[name] * table[_HEAD + k]
        for k, name in enumerate(self._columns):
            if 0 <= name < len(weights):
                table[0, k] += weights[name]
        for step in range(_MOST_STEPS):
            gains = (table[0, :-1] < -ROW_TOLERANCE).nonzero()[0]
            if gains.size == 0:
                return True
            enters = int(gains[0] if 5 * step > _MOST_STEPS else gains[table[0, gains].argmin()])
            falls = (table[_HEAD:, enters] < -ROW_TOLERANCE).nonzero()[0]
            if falls.size == 0:
                return False
            steps = np.maximum(table[_HEAD + falls, -1], 0.0) / -table[_HEAD + falls, enters]
            self._pivot(int(falls[steps.argmin()]), enters)
        return True


def _rows_of(rows: FloatArray, motion: FloatArray) -> FloatArray:
    found: FloatArray = rows[:, :-1] @ motion
    found[:, -1] += rows[:, -1]
    return found
