# SPDX-License-Identifier: Apache-2.0
"""Every combination of letters that some contact forces bring about: a search that refuses many at once.

The search decides three things in turn:

- First it decides which contacts stay, one after another.
- Then it decides which of several frictional contacts at rest stick. The motions with given contacts sticking
  form a flat. There are few flats: for a face on a table one for each foot, and rest.
- Within a flat all other contacts slide. Their common motions are divided into few regions, which are split
  further while they are wide and may hold (`regions`). In a region, the letters of each contact are tried in
  groups that are split further and further (`options`).

A group or region asks no more than each of its parts does. If it cannot hold, none of its parts can, and all
are dropped together. So no consistent mode is missed. Each trial is a few pivots of a dual simplex
(`dual_simplex`).

For bodies at rest, power refuses many cases at once. Motions gain kinetic energy, so the applied wrench has
power >= 0 on them, and at least the power that friction takes. Friction takes the most that it can (maximum
dissipation). So any other choice of friction for a whole region must leave some power somewhere in it
(`_dissipates`). Without this the load could shift to contacts that are not decided yet, and nothing would be
refused before the last few. With many feet that would be every cell of the arrangement of all their sectors.

`PyramidPrograms` has the contacts, their pyramids and the programs, and also decides who stays for the search
of round cones (`completeness`).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.letters import SEPARATES, STAYS
from contact_dynamics.contact_modes.spatial.dual_simplex import CarefulProgram, Ends, Narrowing, Program
from contact_dynamics.contact_modes.spatial.kinematic import faces_in_space
from contact_dynamics.contact_modes.spatial.options import any_letter, pyramid_of, ways_of_sliding
from contact_dynamics.contact_modes.spatial.regions import ONE_BODY, Image, Region, flat_of, gains_in, whole
from contact_dynamics.errors import TooLargeError
from contact_dynamics.numerics.linear_spaces import seen_and_unseen
from contact_dynamics.tolerances import STRICT

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from contact_dynamics.contact_modes.spatial.options import Option, Pyramid, Touching
    from contact_dynamics.contact_modes.spatial.regions import Flat
    from contact_dynamics.validation import FloatArray

MAX_EXAMINED: Final = 30_000
"""The search is given up after this many trials of some 0.1 ms. Where the motion of a body on many feet is
not unique, hundreds of combinations of their sectors may be consistent, and the search looks for all of
them."""

MAX_EXAMINED_OF_SEVERAL: Final = 3_000
"""The same for motions with more components than those of one body. A trial takes some 0.5 ms then, and
searches that need more trials rarely end."""

AnyProgram = Program | CarefulProgram

_FLUSH: Final = 3
"""The dimension of the normal accelerations of contacts that are all on one plane."""

CONTACT_TAG: Final = -3
"""The tag of contact 0. Each further contact's tag is one less."""


class PyramidPrograms(ABC):
    """Touching contacts, and programs about their forces.

    Motions have d components, such as (a, alpha), in units in which contact points have accelerations of
    about 1.
    """

    def __init__(
        self,
        touching: list[Touching],
        *,
        of_forces: FloatArray,
        free: FloatArray,
        mass: FloatArray,
        at_rest: bool,
        facets: int,
        least: float = STRICT,
    ) -> None:
        """Take forces' motions, (d, 3 n), the motion without forces, and the mass matrix, (d, d).

        If nothing moves, the applied wrench has power >= 0. Contacts that separate do so by ``least``.
        """
        self._least = least
        self.touching = touching
        self._facets = facets
        self.pyramids: list[Pyramid] = []
        first = 0
        for contact in touching:
            self.pyramids.append(pyramid_of(contact, facets, first))
            first += len(self.pyramids[-1].every)
        self.edges = np.zeros((3 * len(touching), first))  # the contact forces that unit edge forces are
        for i, pyramid in enumerate(self.pyramids):
            last = pyramid.first + len(pyramid.every)
            self.edges[3 * i : 3 * i + 3, pyramid.first : last] = pyramid.every.T
        self.of_forces = of_forces
        self.freedoms = len(free)  # the number of components of the motion
        motion = of_forces @ self.edges
        sizes = np.linalg.norm(motion, axis=0)
        sizes[sizes == 0.0] = 1.0
        self.edges /= sizes
        self._sizes = sizes
        self.motion = np.column_stack([motion / sizes, free])
        self.examined = 0  # the number of programs solved so far
        self.staying: list[int] | None = None  # the choices of contacts that stay, as bits; None for all
        self.completed = False  # whether a search with round cones (`completeness`) has ended
        self.flats: dict[tuple[tuple[int, ...], tuple[int, ...]], Flat] = {}
        self.systems: dict[tuple[str, tuple[bool, ...]], Any] = {}  # equations of letters (`exact_letters`)
        self.most_examined = MAX_EXAMINED if self.freedoms <= ONE_BODY else MAX_EXAMINED_OF_SEVERAL
        self._first_normal = first  # the name of contact 0's normal acceleration
        self.normals = np.array([one.normal for one in touching]).reshape(-1, 3)
        self.frictions = np.array([one.friction for one in touching])
        self.holding = np.array([one.holding for one in touching])
        self.points = np.array([one.point for one in touching]).reshape(-1, 3, self.freedoms + 1)
        # (n, d + 1), the normal accelerations as functions of the motion.
        self.rising = np.array([one.normal @ one.point for one in touching]).reshape(-1, self.freedoms + 1)
        named = self.rising
        names = [first + i for i in range(len(touching))]
        self.mass = mass
        self.at_rest = at_rest
        self._power = mass @ free if at_rest and np.any(free) else None
        if self._power is not None:
            named = np.vstack([named, np.append(self._power / np.linalg.norm(self._power), 0.0)])
            names.append(first + len(touching))
        self._root: AnyProgram = Program.stated(self.motion, named, names)
        self._careful_root = CarefulProgram(self.motion, named, names)
        self.doubtful = False  # whether rounding may have hidden a mode
        self._trials = [
            any_letter(pyramid, contact.point, first + i)
            for i, (contact, pyramid) in enumerate(zip(touching, self.pyramids, strict=True))
        ]

    def motion_of(self, forces: FloatArray) -> FloatArray:
        """Return the motion, (d,), that contact forces, (n, 3), cause."""
        found: FloatArray = self.motion[:, -1] + self.of_forces @ forces.ravel()
        return found

    def decide_who_stays(self) -> None:
        """Decide which contacts stay, and for each choice that may hold all else."""
        root = self._solved(self._root)
        choices = self._choices() if self.staying is None else self.staying
        if root is None:
            return
        if choices is None:
            self._decide_next(root, self._trials, 0)
            return
        for stays in choices:
            parts = [one.parts[stays >> i & 1] for i, one in enumerate(self._trials)]
            program = self._solved(self._with_all(root, parts))
            if program is not None:
                self._decide_staying(program, parts)

    def _choices(self) -> list[int] | None:
        """Return all choices of contacts on one plane that can stay, each as bits, or None if unknown."""
        rows = self.rising[:, :-1]
        basis = seen_and_unseen(rows)[0]
        if len(basis) != _FLUSH or self.rising[:, -1].any():
            return None
        faces = faces_in_space(rows @ basis.T)
        return None if faces is None else sorted(faces)

    def _decide_next(self, program: AnyProgram, trials: list[Option], at: int) -> None:
        """Decide whether one contact after another stays."""
        if at == len(trials):
            self._decide_staying(program, trials)
            return
        for part in trials[at].parts:
            narrower = self._solved(self._narrowed(program, at, part))
            if narrower is not None:
                self._decide_next(narrower, [*trials[:at], part, *trials[at + 1 :]], at + 1)

    @abstractmethod
    def _decide_staying(self, program: AnyProgram, trials: list[Option], /) -> None:
        """Decide all modes in which the same contacts stay."""

    def _decide_flats(
        self, staying: list[int], frames: FloatArray, decide: Callable[[Flat], bool], /
    ) -> None:
        """Decide all flats of contacts that stay, except that of rest. The first one contains all motions.

        ``decide`` decides one, and returns whether some contacts that slide in it may stick instead. The
        frames, (m, 2, d), are those of the contacts that may slide.
        """
        flats = [self._flat(staying, frames, ())]
        seen = {frozenset(range(len(frames))), flats[0].stuck}
        while flats:
            flat = flats.pop()
            if not decide(flat) or len(flat.image.coordinates) <= 1:
                continue
            for i in range(len(frames)):
                further = flat if i in flat.stuck else self._flat(staying, frames, (*flat.chosen, i))
                if further.stuck not in seen:
                    seen.add(further.stuck)
                    flats.append(further)

    def _flat(self, staying: list[int], frames: FloatArray, chosen: tuple[int, ...]) -> Flat:
        """Return the flat in which chosen contacts stick, of those that stay and may slide."""
        key = tuple(staying), chosen
        if key not in self.flats:
            found = flat_of(self.rising[staying, :-1], frames, chosen)
            gains = None if self._power is None else gains_in(found.image, self._power, self.mass)
            self.flats[key] = found._replace(gains=gains, regions=tuple(whole(found.image)))
        return self.flats[key]

    def _solved(self, program: AnyProgram) -> AnyProgram | None:
        """Return a program that holds edge forces, or None.

        Where rounding may hide them, care is taken from then on.
        """
        self._count()
        if program.solve():
            return program
        if not program.doubtful:
            return None
        if isinstance(program, Program):
            return self._solved(self._careful_root.narrowed(*program.asked))
        self.doubtful = True
        return None

    def _count(self) -> None:
        self.examined += 1
        if self.examined > self.most_examined:
            raise TooLargeError(
                "contacts",
                f"{len(self.touching)} whose modes take more than {self.most_examined} trials",
                "fewer contacts, or other friction_facets",
            )

    def _with_all(self, program: AnyProgram, letters: Sequence[Option]) -> AnyProgram:
        """Return a program of which no contact is decided, with what each contact does."""
        staying = {self._first_normal + i for i, one in enumerate(letters) if one.raised is None}
        equations = [one.rows[: one.equalities] for one in letters]
        others = [one.rows[one.equalities :] for one in letters]
        return program.narrowed(
            Narrowing(
                zeroed=frozenset(staying).union(*(one.zeroed for one in letters)),
                raised=[one.raised for one in letters if one.raised is not None],
                least=self._least,
                rows=np.concatenate([self.rising[:0], *equations, *others]),
                equalities=sum(one.equalities for one in letters),
                tag=CONTACT_TAG - len(self.touching),
            )
        )

    def _narrowed(self, program: AnyProgram, at: int, letters: Option) -> AnyProgram:
        return program.narrowed(
            Narrowing(
                zeroed=letters.zeroed,
                raised=() if letters.raised is None else (letters.raised,),
                least=self._least,
                rows=letters.rows,
                equalities=letters.equalities,
                tag=CONTACT_TAG - at,
            )
        )


_REGION_TAG: Final = -2


class Found(NamedTuple):
    """A mode that some forces bring about."""

    letters: list[Option]  # the letter of each touching contact
    program: AnyProgram  # the solved program
    motion: Ends  # the range of a weighted sum of the motion's components, which shows whether it is unique


class Common(NamedTuple):
    """What the regions of one flat have in common."""

    image: Image  # the space in which the regions lie
    open_ones: list[int]  # the contacts that slide
    names: NDArray[np.intp]  # (m, K), the names of the edge forces of these contacts
    tangential: FloatArray  # (m, K, 2), the components of their edges along their frames
    gains: FloatArray | None  # (p,), the power of the applied wrench on coordinates; None if something moves
    further: list[range]  # the names of the edge forces with which each contact that slides would stick


class Search(PyramidPrograms):
    """The search for the modes of touching contacts."""

    def run(self, *, grouped: bool = False) -> list[Found]:
        """Return all modes.

        If ``grouped``, one represents those with its letters, if the motion is not unique.
        """
        self._ways: dict[tuple[int, tuple[int, int] | None], tuple[Option, ...]] = {}
        self._found: dict[tuple[tuple[str, int], ...], Found] = {}
        self._grouped = grouped
        self._goal = ""  # the letters that are sought, where all are known
        self._settled: set[str] = set()  # letters that need no further mode
        self.decide_who_stays()
        if not self._found and isinstance(self._root, Program):
            self._root = self._careful_root
            self.decide_who_stays()
        return list(self._found.values())

    def loaded(self, free: FloatArray) -> Search:
        """Return the search for the modes of the same contacts, with other motion without their forces."""
        return Search(
            self.touching,
            of_forces=self.of_forces,
            free=free,
            mass=self.mass,
            at_rest=self.at_rest,
            facets=self._facets,
        )

    def _decide_staying(self, program: AnyProgram, trials: list[Option], /) -> None:
        open_ones = [i for i, letters in enumerate(trials) if letters.parts]
        frames = np.array([trials[i].parts[0].rows for i in open_ones]).reshape(-1, 2, self.freedoms + 1)
        if len(open_ones) < 2 or np.any(frames[:, :, -1]):
            # One contact's letters are as few as regions; with centripetal terms directions are not cones.
            for i in open_ones:
                ways = ways_of_sliding(self.pyramids[i], self.touching[i].point)
                any_way = trials[i]._replace(parts=(*trials[i].parts, *ways))
                trials = [*trials[:i], any_way, *trials[i + 1 :]]
            self._decide_letters(program, trials, [0] * len(trials))
            return
        staying = [i for i, letters in enumerate(trials) if letters.letter != SEPARATES]
        frames = frames[:, :, :-1]
        at_rest = self._flat(staying, frames, tuple(range(len(open_ones))))
        if self._solved(self._within(program, at_rest)) is not None:
            self._note([letters.parts[0] if letters.parts else letters for letters in trials])

        def decide(flat: Flat) -> bool:
            decided = list(trials)
            for k in flat.stuck:
                decided[open_ones[k]] = trials[open_ones[k]].parts[0]
            return self._decide_flat(self._within(program, flat), decided, flat)

        self._decide_flats(staying, frames, decide)

    def _within(self, program: AnyProgram, flat: Flat) -> AnyProgram:
        rows = np.column_stack([flat.rows, np.zeros(len(flat.rows))])
        tag = CONTACT_TAG - len(self.touching)
        return program.narrowed(Narrowing(rows=rows, equalities=len(rows), tag=tag))

    def _decide_flat(self, program: AnyProgram, trials: list[Option], flat: Flat) -> bool:
        """Find the modes in which all contacts that are not decided slide.

        Return whether there may be modes in which some of these contacts stick, and others slide.
        """
        open_ones = [i for i, letters in enumerate(trials) if letters.parts]
        if not open_ones:
            return False
        trials = [letters._replace(letter=STAYS) if letters.parts else letters for letters in trials]
        self._goal = "".join(letters.letter for letters in trials)
        common = self._common(flat, open_ones)
        may_hold = False
        for region in flat.regions:
            may_hold |= self._decide_within(region, program, trials, common)
        self._goal = ""
        return may_hold or bool(flat.image.groups.any())  # a whole group may stick

    def _common(self, flat: Flat, open_ones: list[int]) -> Common:
        """Return what the regions of a flat have in common."""
        pyramids = [self.pyramids[i] for i in open_ones]
        names = np.array([one.first for one in pyramids])[:, None] + np.arange(len(pyramids[0].edges))
        tangential = np.array([one.tangential() for one in pyramids])
        further = [range(one.first + len(one.edges), one.first + len(one.every)) for one in pyramids]
        return Common(flat.image, open_ones, names, tangential, flat.gains, further)

    def _decide_within(
        self, region: Region, program: AnyProgram, trials: list[Option], common: Common
    ) -> bool:
        """Find the modes within a region, and return whether it may hold any, whichever contacts slide."""
        if self._goal in self._settled:
            return True
        acting = region.acting_edges(common.image, common.names.shape[1])
        silent = frozenset(common.names[~acting].tolist())
        slides = ~acting.all(axis=1)  # where it can slide in opposite directions, a contact may stick
        silent = silent.union(*(common.further[k] for k in np.flatnonzero(slides).tolist()))
        further = Narrowing(zeroed=silent, rows=region.rows(common.image), tag=_REGION_TAG)
        narrower = self._solved(program.narrowed(further))
        if narrower is None or not self._dissipates(region, narrower, common):
            return False
        halves = region.halves(common.names.shape[1])
        if halves is not None:
            near, far = (self._decide_within(half, narrower, trials, common) for half in halves)
            return near or far
        fewer = list(trials)
        for i, of_contact in zip(common.open_ones, acting, strict=True):
            ways = self._ways_of(i, of_contact)
            alone = len(ways) == 1 and not ways[0].parts
            fewer[i] = ways[0] if alone else trials[i]._replace(parts=ways)
        self._decide_letters(narrower, fewer, [0] * len(trials))
        return True

    def _dissipates(self, region: Region, program: AnyProgram, common: Common) -> bool:
        """Return whether friction may take no more power than the applied wrench has.

        Friction takes at least what the same normal forces would with any fixed share of friction. The
        remaining power is linear in the motion: if it is negative on each ray of the region, it is negative
        in all of it.
        """
        if common.gains is None:
            return True
        self.examined += 1
        weights = np.zeros((len(region.rays), self.edges.shape[1]))
        taken = region.friction(common.image, common.tangential)
        weights[:, common.names] = taken.T[:, :, None] / self._sizes[common.names]
        gains = region.rays @ common.gains
        scale = max(float(np.abs(weights).max()), float(np.abs(gains).max()))
        weights, gains = weights / scale, gains / scale
        if program.allows_any(weights, gains, -STRICT):
            return True
        if program.doubtful and isinstance(program, Program):
            careful = self._solved(self._careful_root.narrowed(*program.asked))
            if careful is None or careful.allows_any(weights, gains, -STRICT):
                return careful is not None
            program = careful
        self.doubtful |= program.doubtful
        return False

    def _ways_of(self, at: int, acting: NDArray[np.bool_]) -> tuple[Option, ...]:
        """Return the ways of sliding of a contact against neighbouring edges, made once for each range."""
        arc = None if acting.all() else (int((acting & ~np.roll(acting, 1)).argmax()), int(acting.sum()))
        if (at, arc) not in self._ways:
            self._ways[at, arc] = ways_of_sliding(self.pyramids[at], self.touching[at].point, arc)
        return self._ways[at, arc]

    def _decide_letters(self, program: AnyProgram, trials: list[Option], depths: list[int]) -> None:
        if self._goal in self._settled:
            return
        open_ones = [i for i, letters in enumerate(trials) if letters.parts]
        if not open_ones:
            self._note(trials)
            return
        at = min(open_ones, key=depths.__getitem__)
        deeper = [*depths[:at], depths[at] + 1, *depths[at + 1 :]]
        for part in trials[at].parts:
            narrower = self._solved(self._narrowed(program, at, part))
            if narrower is not None:
                self._decide_letters(narrower, [*trials[:at], part, *trials[at + 1 :]], deeper)

    def _note(self, letters: list[Option]) -> None:
        """Keep the mode, if some forces bring it about."""
        key = tuple((one.letter, one.item) for one in letters)
        if key in self._found:
            return
        solved = self._solved(self._with_all(self._root, letters))
        if solved is None:
            return
        mixture = np.random.default_rng(26).normal(size=self.freedoms)
        found = Found(letters, solved, solved.ends(mixture @ self.motion[:, :-1]))
        self._found[key] = found
        if self._grouped and not found.motion.unique:
            self._settled.add("".join(one.letter for one in letters))
