# SPDX-License-Identifier: Apache-2.0
"""Whether a case has modes that were not found: every set of them is found, refuted or named.

The search of the pyramids can miss a mode whose friction lies between their edges. Here linear programs hold
all modes of a set (`holding_programs`), with pyramids around the round cones. If no forces satisfy one, there
is no mode in the set. Otherwise the set is parted:

- First it is decided which contacts stay, one after another.
- Then it is decided which of several frictional contacts at rest stick. As in `search`, the motions with
  given contacts sticking form a flat.
- In a flat, the common motions are parted into regions, and where a contact may slide any way in a narrow
  region, because it may stick there too, its directions of sliding are parted.

This ends at solutions. One motion may exclude all others with the same contacts staying (`only_motion`), but
for those in which a contact sticks that has more friction then.
Otherwise Newton's method finds a solution in the set, and bounds on the derivatives around it say in which
range of directions there is no other one (`alone_within`). Where bodies can move in one direction only,
round cones decide (`shared_loads`). What is left over when ranges are narrow is undecided.
"""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.letters import SEPARATES, STAYS, STICKS
from contact_dynamics.contact_modes.spatial.dual_simplex import CarefulProgram, Program
from contact_dynamics.contact_modes.spatial.exact_letters import (
    Equations,
    alone_within,
    forces_with_letters,
    solution_near,
)
from contact_dynamics.contact_modes.spatial.holding_programs import (
    COARSE,
    FINE,
    HoldingPrograms,
    Ranges,
    Within,
)
from contact_dynamics.contact_modes.spatial.only_motion import is_only_motion
from contact_dynamics.contact_modes.spatial.regions import (
    directions,
    directions_where_all_slide,
)
from contact_dynamics.contact_modes.spatial.search import PyramidPrograms
from contact_dynamics.contact_modes.spatial.shared_loads import sliding_together
from contact_dynamics.tolerances import NARROWEST_RANGE, SAME_MOTION, SAME_SLIDING, STRICT

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from contact_dynamics.contact_modes.spatial.options import Option
    from contact_dynamics.contact_modes.spatial.regions import Flat, Region
    from contact_dynamics.contact_modes.spatial.search import AnyProgram, Search
    from contact_dynamics.validation import FloatArray

MAX_PROGRAMS: Final = 3000
"""The search for missed modes is given up after this many linear programs of 0.3 ms."""

ENOUGH_PROGRAMS: Final = 2000
"""Maximum number of programs before the pyramids are searched. Few cases take more."""

ENOUGH_PROGRAMS_OF_SEVERAL: Final = 6000
"""The same for motions with more components than those of one body, where the search of the pyramids rarely
ends."""

FEW_PROGRAMS: Final = 400
"""Maximum number of programs where another way to a verdict is left. The search is then also given up as soon
as it leaves letters undecided."""

_CARE: Final = 3
"""Number of additional programs that a `CarefulProgram` counts as."""

_MAX_TRIES: Final = 3
"""The number of regions with the same letters in whose middle a mode is sought. The second mostly has one."""

_SUSPICIOUS: Final = 2
"""A mode is sought there after Newton's method has found this many solutions that are none."""

_QUARTER: Final = 0.5 * math.pi

_TURN: Final = 2.0 * math.pi

_WIDE: Final = 0.1
"""rad. In wider ranges of directions the pyramids around round cones are coarse. Newton's method waits too,
since it would mostly find solutions elsewhere."""

_REGION: Final = 0.3
"""rad. Regions are narrower than this before directions of single contacts are parted."""


class Known(NamedTuple):
    """A mode."""

    letters: str  # s, c or f for each touching contact
    forces: FloatArray  # (n, 3), in the units of the motion
    alone: bool  # whether its motion is the only one nearby; if not, it stands for all with its letters
    forces_unique: bool = True  # whether its forces are the only ones with its motion


class Completed(NamedTuple):
    """What was missed."""

    further: tuple[Known, ...]  # modes that were not known
    undecided: tuple[str, ...]  # the letters that may have further modes
    unended: str  # the letters at which the search was given up; those that follow may have modes too


def staying_bits(letters: str) -> int:
    """Return the contacts that stay with some letters, as the bits of a number."""
    return sum(1 << i for i in _staying(letters))


class _TooManyError(Exception):
    """There are too many sets of letters and directions."""


class _NotRefutedError(Exception):
    """Linear programs do not refute a set."""


class _Alone(NamedTuple):
    """A solution of the equations of some letters."""

    angles: dict[int, float]  # the directions of sliding, rad
    equations: Equations | None  # the equations there; None where contacts share loads: they are too few
    has_letters: bool  # whether it is a mode
    within: float = -1.0  # rad: no other solution has all directions within it; negative if unknown

    def is_in(self, ranges: Ranges, slack: float) -> bool:
        """Return whether all directions are in ranges, or no further outside than some slack, rad."""
        return all(_from(low - slack, self.angles[i]) <= high + slack for i, (low, high) in ranges.items())

    def excludes(self, ranges: Ranges) -> bool:
        """Return whether no other solution has directions in these ranges."""
        return all(
            max(abs(_from(low, self.angles[i]) - end) for end in (low, high)) <= self.within
            for i, (low, high) in ranges.items()
        )


class _Set(NamedTuple):
    """Modes with some letters, in a region of common motions, with some directions of sliding."""

    letters: str  # s, c or f for each touching contact
    turning: list[int]  # the contacts that begin to slide
    flat: Flat | None  # the flat of the region; None if the motions are not parted
    region: Region | None  # the region
    ranges: Ranges  # directions of sliding that are demanded


def completed(
    search: Search,
    known: Sequence[Known],
    *,
    most: int,
    among: list[int] | None = None,
    open_ones: Sequence[str] = (),
) -> Completed:
    """Return the modes that are not known yet, and the letters that may have more.

    All known modes are exact. The search gives up after ``most`` programs. ``among`` may limit it to some
    choices of contacts that stay, and ``open_ones`` are letters that an earlier search has left undecided.
    Whether a body at rest can stick at all contacts is not decided here.
    """
    work = _Work(search, known, most=most, among=among)
    work.leave_open(open_ones)
    unended = ""
    try:
        work.decide_who_stays()
        search.completed = True
    except _TooManyError:
        unended = work.at
    search.examined += work.examined
    settled = {one.letters for one in work.further if not one.alone}
    return Completed(tuple(work.further), tuple(one for one in work.undecided if one not in settled), unended)


def has_none(search: Search) -> bool:
    """Return whether it is certain that a case has no mode, also none that holds narrowly."""
    try:
        _Work(search, (), least=0.0, refutes=True).decide_who_stays()
    except (_TooManyError, _NotRefutedError):
        return False
    return True


class _Work(PyramidPrograms):
    """The search for missed modes, with pyramids around the round cones."""

    def __init__(
        self,
        search: Search,
        known: Sequence[Known],
        *,
        least: float = STRICT,
        refutes: bool = False,
        most: int = MAX_PROGRAMS,
        among: list[int] | None = None,
    ) -> None:
        wider = 1.0 / math.cos(math.pi / COARSE)
        super().__init__(
            [
                contact
                if pyramid.frame is None
                else contact._replace(friction=wider * contact.holding, holding=wider * contact.holding)
                for contact, pyramid in zip(search.touching, search.pyramids, strict=True)
            ],
            of_forces=search.of_forces,
            free=search.motion[:, -1],
            mass=search.mass,
            at_rest=search.at_rest,
            facets=COARSE,
            least=least,
        )
        self._search, self.flats = search, search.flats
        self.staying = among
        self._refutes = refutes
        self._most = most
        self._slides_alone = False  # whether the modes with less than static friction are known
        self._grips: list[int] = []  # the contacts at rest that have more static friction
        self._open = [i for i, one in enumerate(search.pyramids) if one.frame is not None]
        self._all_stick = "".join(STICKS if one.holding > 0.0 else STAYS for one in search.touching)
        self._programs = HoldingPrograms(search, least)
        self._known = known
        self._held = {one.letters for one in known}
        self._decided = {one.letters for one in known if not one.alone}
        self._solutions: dict[str, list[_Alone]] = {}
        self._tries: Counter[str] = Counter()
        for one in known:
            if one.alone:
                self._solve(one.letters, one.forces)
        self.further: list[Known] = []
        self.undecided: list[str] = []
        self.at = STAYS * len(search.touching)  # the letters that are decided now

    def _solved(self, program: AnyProgram) -> AnyProgram | None:
        if isinstance(program, CarefulProgram):
            self.examined += _CARE
        found = super()._solved(program)
        if found is None and self.doubtful:
            self.doubtful = False
            return program  # rounding may hide that it holds
        return found

    def _count(self) -> None:
        self.examined += 1
        if self.examined > self._most:
            raise _TooManyError

    def _forces(
        self, letters: str, ranges: Ranges, facets: int, within: Within | None = None
    ) -> FloatArray | None:
        self._count()
        found, careful = self._programs.forces(letters, ranges, facets, within=within)
        self.examined += _CARE * careful
        return found

    def _decide_staying(self, program: AnyProgram, trials: list[Option], /) -> None:
        """Decide all modes in which the same contacts stay."""
        letters = "".join(one.letter or STICKS for one in trials)
        self.at = letters.replace(STICKS, STAYS)
        staying = _staying(letters)
        open_ones = [i for i in self._open if letters[i] == STICKS]
        if not open_ones:
            self._decide_without_directions(letters)
            return
        self._grips = [i for i in open_ones if self._search.holding[i] > self._search.frictions[i]]
        self._slides_alone = any(
            one.alone
            and _staying(one.letters) == staying
            and is_only_motion(self._search, one.forces, staying)
            for one in self._known
        )
        if self._slides_alone and not self._grips:
            return
        if len(open_ones) == 1 or any(self.touching[i].point[:, -1].any() for i in staying):
            stays = [STAYS if i in open_ones else letter for i, letter in enumerate(letters)]
            self._part_letters("".join(stays), open_ones)
            return
        frames = np.array([trials[i].parts[0].rows[:, :-1] for i in open_ones])
        self._decide_without_directions(letters)
        solved = isinstance(program, Program) and not program.doubtful
        # Where no contact must stick, the program has the conditions of the flat's own.
        self._decide_flats(
            staying,
            frames,
            lambda flat: self._decide_flat(flat, letters, open_ones, holds=solved and not flat.stuck),
        )

    def _part_letters(self, letters: str, open_ones: list[int]) -> None:
        """Decide which contacts stick, and then in which directions the others slide.

        Undecided ones have the c.
        """
        if not open_ones:
            turning = [i for i in self._open if letters[i] == STAYS]
            if not turning:
                self._decide_without_directions(letters)
            elif not self._is_decided(letters):
                self._decide(_Set(letters, turning, None, None, {}))
            return
        at = open_ones[0]
        for letter in (STAYS, STICKS):
            narrower = letters[:at] + letter + letters[at + 1 :]
            if self._forces(narrower, {}, COARSE) is not None:
                self._part_letters(narrower, open_ones[1:])

    def _decide_without_directions(self, letters: str) -> None:
        """Find or refute a mode in which no contact begins to slide."""
        if letters in self._held or (letters == self._all_stick and not self._refutes):
            return
        leave = set(letters) == {SEPARATES}  # without forces: the programs have decided that they do
        start: FloatArray | None = np.zeros((len(letters), 3))
        if not leave:
            start = self._forces(letters, {}, COARSE)  # it mostly refutes them, in a third of the time
            start = None if start is None else self._forces(letters, {}, FINE)
        if start is None:
            return
        if self._refutes:
            raise _NotRefutedError
        if leave:
            self._keep(Known(letters, start, alone=True))
            return
        forces = forces_with_letters(self._search, letters, start, shared=True)
        regular = solution_near(self._search, letters, start) is not None
        if forces is not None:
            near = solution_near(self._search, letters, forces, shared=True)
            alone = regular or (near is not None and near.motion_unique)
            self._keep(Known(letters, forces, alone=alone, forces_unique=regular))
        elif not regular:
            self._leave(letters)

    def _decide_flat(self, flat: Flat, letters: str, open_ones: list[int], *, holds: bool) -> bool:
        """Find or refute all modes in which all contacts slide that a flat lets slide.

        Return whether there may be modes in which some of these contacts stick, and others slide.
        """
        turning = [i for k, i in enumerate(open_ones) if k not in flat.stuck]
        own = self.at = "".join(STAYS if i in turning else letter for i, letter in enumerate(letters))
        if holds:
            self._count()
        elif self._forces(own, {}, COARSE) is None:
            return False
        if self._is_decided(own):
            return True
        if len(turning) < len(flat.image.coordinates) - 1:
            self._decide(_Set(own, turning, None, None, {}))
            return True
        may_hold = False
        for region in flat.regions:
            may_hold |= self._decide(_Set(own, turning, flat, region, {}))
        return may_hold or bool(flat.image.groups.any())  # a whole group may stick

    def _is_decided(self, letters: str) -> bool:
        """Return whether all modes with some letters are known.

        Where bodies can move in one way only, they become so.
        """
        if letters in self._decided:
            return True
        if self._slides_alone and not any(letters[i] == STICKS for i in self._grips):
            return True
        if letters in self._held:
            return False
        staying = _staying(letters)
        near = [
            self._search.motion_of(one.forces)
            for one in (*self._known, *self.further)
            if not one.alone and _staying(one.letters) == staying
        ]
        if not near and self._programs.free_motions(letters) > 1:
            return False
        return self._slides_together(letters, near)

    def _slides_together(self, letters: str, near: Sequence[FloatArray]) -> bool:
        """Return whether all modes with some letters are known, after a search near some motions, (d,)."""
        held = sliding_together(self._search, letters, near)
        if held.forces is None:
            return held.certain
        if self._refutes:
            raise _NotRefutedError
        forces = forces_with_letters(self._search, letters, held.forces, shared=True)
        solution = None if forces is None else solution_near(self._search, letters, forces, shared=True)
        if forces is None or solution is None or (solution.motion_unique and not held.certain):
            return False
        regular = solution_near(self._search, letters, forces) is not None
        self._keep(Known(letters, forces, alone=solution.motion_unique, forces_unique=regular))
        self._decided.add(letters)  # the forces that move it so form a convex set
        return True

    def _decide(self, modes: _Set) -> bool:
        """Find or refute all modes in a set. Return whether contacts that slide in it may stick instead."""
        letters, turning = modes.letters, modes.turning
        if letters in self._decided:
            return True
        if _takes_power(modes):
            self._count()
            return bool(modes.ranges)
        implied = _implied(modes)
        ranges = None if implied is None else _met(implied, modes.ranges)
        widest, width = _widest(turning, ranges or {})
        forces = None
        if ranges is not None:
            facets = COARSE if width > _WIDE else FINE
            forces = self._forces(letters, ranges, facets, _within(modes))
        if ranges is None or forces is None:
            return bool(modes.ranges)
        if self._refutes and width <= _WIDE:
            raise _NotRefutedError
        if len(ranges) == len(turning) and self._ends(modes, ranges, width, forces):
            return True
        may_hold = False
        for part in _parts(modes, ranges, widest, width):
            may_hold |= self._decide(part)
        return may_hold

    def _ends(self, modes: _Set, ranges: Ranges, width: float, forces: FloatArray) -> bool:
        """Return whether a set need not be parted further, because its solutions are known, or it is narrow.

        Each contact slides in its range of directions, of which the widest has this width, and programs allow
        the forces.
        """
        letters = modes.letters
        if self._slides_in_the_middle(modes):
            return True
        solution = self._inside(letters, ranges)
        if solution is None and width <= _WIDE:
            self._solve(letters, forces, new=True)
            solution = self._inside(letters, ranges)
        if solution is not None and solution.within > 0.0 and modes.region is None:
            for piece in _without(ranges, solution):
                self._decide(modes._replace(ranges=piece))
            return True
        if solution is not None and solution.excludes(ranges):
            return True
        if width <= SAME_SLIDING and self._is_close(letters, ranges):
            return True  # it may be the same mode
        if width <= NARROWEST_RANGE:
            self._leave(letters)
            self._decided.add(letters)
        return letters in self._decided

    def _slides_in_the_middle(self, modes: _Set) -> bool:
        """Return whether a mode is found in the middle of a region that stands for all with its letters.

        Where contacts share loads, such modes fill a range of directions. Newton's method, which starts from
        forces, then mostly finds ever other forces that hold the body at rest.
        """
        if modes.region is None or modes.flat is None or self._tries[modes.letters] == _MAX_TRIES:
            return False
        if sum(not one.has_letters for one in self._solutions.get(modes.letters, ())) < _SUSPICIOUS:
            return False
        self._tries[modes.letters] += 1
        rays = modes.region.rays
        middle = (rays / np.linalg.norm(rays, axis=1)[:, None]).sum(axis=0)
        return self._slides_together(modes.letters, [middle @ modes.flat.image.motions])

    def _inside(self, letters: str, ranges: Ranges) -> _Alone | None:
        """Return a solution whose directions are in all ranges."""
        others = self._solutions.get(letters, [])
        for k, one in enumerate(others):
            if one.is_in(ranges, 0.0):
                if one.within < 0.0 and one.equations is not None:
                    others[k] = one._replace(within=alone_within(one.equations))
                return others[k]
        return None

    def _is_close(self, letters: str, ranges: Ranges) -> bool:
        """Return whether a mode's directions are hardly outside of all ranges."""
        others = self._solutions.get(letters, [])
        return any(one.has_letters and one.is_in(ranges, SAME_SLIDING) for one in others)

    def _solve(self, letters: str, forces: FloatArray, *, new: bool = False) -> None:
        """Keep a solution near some forces, and the mode that it is if that is new."""
        solution = solution_near(self._search, letters, forces) or solution_near(
            self._search, letters, forces, shared=True
        )
        if solution is None:
            return
        if solution.equations is None and not solution.motion_unique:
            if new and solution.has_letters:
                self._keep(Known(letters, solution.forces, alone=False, forces_unique=False))
            return
        others = self._solutions.setdefault(letters, [])
        if not any(_are_the_same(solution.angles, one.angles) for one in others):
            others.append(_Alone(solution.angles, solution.equations, solution.has_letters))
            if new and solution.has_letters:
                unique = solution.equations is not None
                self._keep(Known(letters, solution.forces, alone=True, forces_unique=unique))

    def leave_open(self, letters: Sequence[str]) -> None:
        """Leave letters undecided that an earlier search has left so, unless modes have them now."""
        self.undecided += [one for one in letters if one not in self._held]
        self._decided.update(self.undecided)

    def _leave(self, letters: str) -> None:
        """Leave some letters undecided."""
        self.undecided.append(letters)
        if self._most <= FEW_PROGRAMS:
            raise _TooManyError

    def _keep(self, mode: Known) -> None:
        self.further.append(mode)
        self._held.add(mode.letters)
        if not mode.alone:
            self._decided.add(mode.letters)


def _staying(letters: str) -> list[int]:
    return [i for i, letter in enumerate(letters) if letter != SEPARATES]


def _within(modes: _Set) -> Within | None:
    """Return the region of a set, for its programs."""
    if modes.region is None or modes.flat is None:
        return None
    implied = frozenset(i for i in modes.turning if i not in modes.ranges)
    return Within(modes.region, modes.flat.image, modes.turning, modes.flat.gains, implied)


def _takes_power(modes: _Set) -> bool:
    """Return whether the applied wrench resists all motions of a set, so that none of them begins."""
    gains = None if modes.flat is None else modes.flat.gains
    if modes.region is None or gains is None:
        return False
    return bool((modes.region.rays @ gains).max() < -STRICT * np.abs(gains).max())


def _widest(turning: list[int], ranges: Ranges) -> tuple[int, float]:
    """Return the contact that may slide in the widest range of directions, and the width of that, rad."""
    widths = {i: ranges[i][1] - ranges[i][0] if i in ranges else _TURN for i in turning}
    widest = max(turning, key=widths.__getitem__)
    return widest, widths[widest]


def _implied(modes: _Set) -> Ranges | None:
    """Return the ranges of directions that follow from a set, or None if its region has no such motions."""
    region, flat = modes.region, modes.flat
    if region is None or flat is None:
        return {}
    maps = flat.image.maps
    if modes.ranges:
        rows = [
            across @ maps[k]
            for k, i in enumerate(modes.turning)
            if i in modes.ranges
            for across in _sides(*modes.ranges[i])
        ]
        rays = region.part(np.array(rows))
        if len(rays) == 0:
            return None
        found = directions_where_all_slide(maps, rays)
    else:
        found = directions(region.along(flat.image))
    return {i: one for i, one in zip(modes.turning, found, strict=True) if one is not None}


def _sides(low: float, high: float) -> FloatArray:
    """Return rows, (2, 2), that are not negative on directions between two, less than half a turn apart."""
    return np.array([[-math.sin(low), math.cos(low)], [math.sin(high), -math.cos(high)]])


def _met(implied: Ranges, demanded: Ranges) -> Ranges | None:
    """Return the ranges in which directions satisfy both, or None if there are none."""
    found = {**implied, **demanded}
    for i in demanded.keys() & implied.keys():
        low, high = demanded[i]
        start, end = implied[i]
        first = _from(low, start)  # both ranges are narrower than half a circle
        if first <= high:
            found[i] = first, min(high, first + end - start)
        elif first + end - start >= low + _TURN:
            found[i] = low, min(high, first + end - start - _TURN)
        else:
            return None
    return found


def _parts(modes: _Set, ranges: Ranges, widest: int, width: float) -> Iterator[_Set]:
    """Yield the halves of a set."""
    region = modes.region
    wide = 0.0 if region is None else region.width
    if region is not None and wide > 0.0 and (wide > _REGION or 3.0 * wide > width):
        for half in region.cut:
            yield modes._replace(region=half)
    elif widest in ranges:
        low, high = ranges[widest]
        middle = 0.5 * (low + high)
        for part in ((low, middle), (middle, high)):
            yield modes._replace(ranges={**modes.ranges, widest: part})
    else:
        for quarter in range(4):
            part = (quarter * _QUARTER, (quarter + 1) * _QUARTER)
            yield modes._replace(ranges={**modes.ranges, widest: part})


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
    return low + (angle - low) % _TURN


def _are_the_same(angles: dict[int, float], others: dict[int, float]) -> bool:
    return all(abs(math.remainder(angle - others[i], _TURN)) <= SAME_MOTION for i, angle in angles.items())
