"""Whether a case has modes that were not found: every combination of letters is found, refuted or named.

The search of the pyramids can miss a mode whose friction lies between their edges. Here a linear program
holds all modes of a set of letters and directions (`holding_programs`). If no forces satisfy it, there is no
mode in the set. Otherwise the set is parted, first by letters and then by directions.

This ends at solutions. Newton's method finds a solution in the set, and bounds on the derivatives around it
say in which range of directions there is no other one (`only_solution`). Outside of that range the parting
goes on. Where bodies can move in one direction only, round cones decide (`shared_loads`). What is left over
when ranges are narrow is undecided.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

from contact_dynamics.contact_modes.letters import SEPARATES, STAYS, STICKS
from contact_dynamics.contact_modes.spatial.exact_letters import (
    forces_with_letters,
    solution_near,
)
from contact_dynamics.contact_modes.spatial.holding_programs import (
    COARSE,
    FINE,
    UNKNOWN,
    HoldingPrograms,
    Ranges,
    TooManyError,
)
from contact_dynamics.contact_modes.spatial.only_solution import Equations, alone_within
from contact_dynamics.contact_modes.spatial.shared_loads import sliding_together
from contact_dynamics.tolerances import NARROWEST_RANGE, SAME_MOTION, SAME_SLIDING, STRICT

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from contact_dynamics.contact_modes.spatial.search import Search
    from contact_dynamics.validation import FloatArray

_QUARTER: Final = 0.5 * math.pi

_WIDE: Final = 0.1
"""rad. In wider ranges of directions the pyramids around round cones are coarse. Newton's method waits too,
since it would mostly find solutions elsewhere."""


class Known(NamedTuple):
    """A mode.

    Attributes:
        letters: s, c or f for each touching contact.
        forces: (n, 3), in the units of the motion.
        alone: Whether its motion is the only one with these letters nearby. If it is not, one mode stands for
            all with these letters.
    """

    letters: str
    forces: FloatArray
    alone: bool


class Completed(NamedTuple):
    """What was missed.

    Attributes:
        further: Modes that were not known.
        undecided: The letters that may have further modes.
        ended: Whether the search came to its end. If it did not, other letters may have modes too.
    """

    further: tuple[Known, ...]
    undecided: tuple[str, ...]
    ended: bool


class _Alone(NamedTuple):
    """A solution of the equations of some letters.

    Attributes:
        angles: The directions of sliding, rad.
        equations: The equations there.
        has_letters: Whether it is a mode.
        within: rad. No other solution has all directions within this of these. It is negative if unknown.
    """

    angles: dict[int, float]
    equations: Equations
    has_letters: bool
    within: float = -1.0

    def is_in(self, ranges: Ranges, slack: float) -> bool:
        """Return whether all directions are in ranges, or no further outside than some slack, rad."""
        return all(_from(low - slack, self.angles[i]) <= high + slack for i, (low, high) in ranges.items())


def completed(search: Search, known: Sequence[Known]) -> Completed:
    """Return the modes that are not known yet, and the letters that may have more.

    Whether all contacts can stick together is not asked here.

    Args:
        search: The case.
        known: The modes that were found, all exact.
    """
    work = _Work(search, known)
    ended = True
    try:
        work.part(UNKNOWN * len(search.touching))
    except TooManyError:
        ended = False
    return Completed(tuple(work.further), tuple(work.undecided), ended)


def has_none(search: Search) -> bool:
    """Return whether it is certain that a case has no mode, also none that holds narrowly."""
    try:
        return _Work(search, (), least=0.0).refutes(UNKNOWN * len(search.touching))
    except TooManyError:
        return False


class _Work:
    """The search for missed modes."""

    def __init__(self, search: Search, known: Sequence[Known], *, least: float = STRICT) -> None:
        self._search = search
        self._open = [i for i, one in enumerate(search.pyramids) if one.frame is not None]
        self._at_rest = "".join(STAYS if one.frame is None else STICKS for one in search.pyramids)
        self._forces = HoldingPrograms(search, least).forces
        self._held = {one.letters for one in known}
        self._decided = {one.letters for one in known if not one.alone}
        self._solutions: dict[str, list[_Alone]] = {}
        for one in known:
            if one.alone:
                self._solve(one.letters, one.forces)
        self.further: list[Known] = []
        self.undecided: list[str] = []

    def refutes(self, letters: str) -> bool:
        """Return whether linear programs refute a set, parted by letters and then by directions."""
        if self._forces(letters, {}) is None:
            return True
        at = letters.find(UNKNOWN)
        if at >= 0:
            own = (SEPARATES, STAYS, STICKS) if at in self._open else (SEPARATES, STAYS)
            return all(self.refutes(letters[:at] + letter + letters[at + 1 :]) for letter in own)
        turning = [i for i in self._open if letters[i] == STAYS]
        if not turning:
            return self._forces(letters, {}, FINE) is None
        return self._refutes_directions(letters, dict.fromkeys(turning, (0.0, 2.0 * math.pi)))

    def _refutes_directions(self, letters: str, ranges: Ranges) -> bool:
        """Return whether linear programs refute letters with some ranges of directions."""
        widest = max(ranges, key=lambda i: ranges[i][1] - ranges[i][0])
        low, high = ranges[widest]
        narrow = {i: own for i, own in ranges.items() if own[1] - own[0] <= _QUARTER}
        if self._forces(letters, narrow, COARSE if high - low > _WIDE else FINE) is None:
            return True
        middle = 0.5 * (low + high)
        return high - low > _WIDE and all(
            self._refutes_directions(letters, {**ranges, widest: half})
            for half in ((low, middle), (middle, high))
        )

    def part(self, letters: str) -> None:
        """Part a set by letters, and then by directions."""
        if letters in self._decided or letters == self._at_rest or self._forces(letters, {}) is None:
            return
        at = letters.find(UNKNOWN)
        turning = [i for i in self._open if letters[i] == STAYS]
        if at >= 0:
            for letter in (SEPARATES, STAYS, STICKS) if at in self._open else (SEPARATES, STAYS):
                self.part(letters[:at] + letter + letters[at + 1 :])
        elif not turning:
            self._decide_without_directions(letters)
        elif not self._is_decided_one_way(letters):
            self._part_directions(letters, {}, turning)

    def _decide_without_directions(self, letters: str) -> None:
        """Find or refute a mode in which no contact begins to slide."""
        if letters in self._held or set(letters) == {SEPARATES}:
            return
        start = self._forces(letters, {}, FINE)
        if start is None:
            return
        forces = forces_with_letters(self._search, letters, start, shared=True)
        regular = solution_near(self._search, letters, start) is not None
        if forces is not None:
            self._keep(Known(letters, forces, alone=regular))
        elif not regular:
            self.undecided.append(letters)

    def _is_decided_one_way(self, letters: str) -> bool:
        """Find or refute a mode of a body that can move in one direction only, and return whether it was."""
        if STICKS not in letters or letters in self._held:
            return False
        held = sliding_together(self._search, letters, [])
        if held.forces is None:
            return held.certain
        forces = forces_with_letters(self._search, letters, held.forces, shared=True)
        if forces is not None:
            self._keep(Known(letters, forces, alone=False))
        return forces is not None

    def _part_directions(self, letters: str, ranges: Ranges, turning: list[int]) -> None:
        """Part the directions of contacts into quarters of the circle."""
        if len(ranges) == len(turning):
            self._decide(letters, ranges)
            return
        at = turning[len(ranges)]
        for quarter in range(4):
            narrower = {**ranges, at: (quarter * _QUARTER, (quarter + 1) * _QUARTER)}
            if len(narrower) == len(turning) or self._forces(letters, narrower) is not None:
                self._part_directions(letters, narrower, turning)

    def _decide(self, letters: str, ranges: Ranges) -> None:
        """Find or refute all modes with some letters in some ranges of directions."""
        if letters in self._decided:
            return
        widest = max(ranges, key=lambda i: ranges[i][1] - ranges[i][0])
        low, high = ranges[widest]
        forces = self._forces(letters, ranges, COARSE if high - low > _WIDE else FINE)
        if forces is None:
            return
        solution = self._inside(letters, ranges)
        if solution is None and high - low <= _WIDE:
            self._solve(letters, forces, new=True)
            solution = self._inside(letters, ranges)
        if solution is not None and solution.within > 0.0:
            for piece in _without(ranges, solution):
                self._decide(letters, piece)
        elif high - low <= SAME_SLIDING and self._is_close(letters, ranges):
            return  # it may be the same mode
        elif high - low > NARROWEST_RANGE:
            middle = 0.5 * (low + high)
            self._decide(letters, {**ranges, widest: (low, middle)})
            self._decide(letters, {**ranges, widest: (middle, high)})
        else:
            self.undecided.append(letters)
            self._decided.add(letters)

    def _inside(self, letters: str, ranges: Ranges) -> _Alone | None:
        """Return a solution whose directions are in all ranges."""
        others = self._solutions.get(letters, [])
        for k, one in enumerate(others):
            if one.is_in(ranges, 0.0):
                if one.within < 0.0:
                    others[k] = one._replace(within=alone_within(one.equations))
                return others[k]
        return None

    def _is_close(self, letters: str, ranges: Ranges) -> bool:
        """Return whether a mode's directions are hardly outside of all ranges."""
        others = self._solutions.get(letters, [])
        return any(one.has_letters and one.is_in(ranges, SAME_SLIDING) for one in others)

    def _solve(self, letters: str, forces: FloatArray, *, new: bool = False) -> None:
        """Keep a solution near some forces, and the mode that it is if that is new."""
        solution = solution_near(self._search, letters, forces)
        if solution is None:
            return
        others = self._solutions.setdefault(letters, [])
        if not any(_are_the_same(solution.angles, one.angles) for one in others):
            others.append(_Alone(solution.angles, solution.equations, solution.has_letters))
            if new and solution.has_letters:
                self._keep(Known(letters, solution.forces, alone=True))

    def _keep(self, mode: Known) -> None:
        self.further.append(mode)
        self._held.add(mode.letters)
        if not mode.alone:
            self._decided.add(mode.letters)


def _without(ranges: Ranges, solution: _Alone) -> Iterator[Ranges]:
    """Yield pieces that together with the range in which a solution is alone make up the ranges."""
    left = dict(ranges)
    for i, (low, high) in ranges.items():
        angle = _from(low, solution.angles[i])
        near = max(low, angle - solution.within), min(high, angle + solution.within)
        if near[0] > low:
            yield {**left, i: (low, near[0])}
        if near[1] < high:
            yield {**left, i: (near[1], high)}
        left[i] = near


def _from(low: float, angle: float) -> float:
    """Return an angle plus full turns, from ``low`` on."""
    return low + (angle - low) % (2.0 * math.pi)


def _are_the_same(angles: dict[int, float], others: dict[int, float]) -> bool:
    return all(
        abs(math.remainder(angle - others[i], 2.0 * math.pi)) <= SAME_MOTION for i, angle in angles.items()
    )
