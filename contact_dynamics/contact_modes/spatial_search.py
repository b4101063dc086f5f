"""Every combination of letters that some contact forces bring about: a search that refuses many at once.

First which contacts stay, one after another. Then, where several frictional contacts at rest stay, which way
they slide together: nowhere, or within one of few regions of their common motions, split while it is wide and
may hold (`spatial_regions`). Then the letters of each contact, in groups that are split further and further
(`spatial_letters`). Whatever is asked is asked of all its parts, and what cannot hold is dropped with all of
them, so that no consistent mode is missed. Each trial is a few pivots of a dual simplex (`spatial_program`).

At rest, the applied wrench must have power >= 0 on the accelerations: they gain kinetic energy, and friction
takes some. This holds for every mode and refuses much at once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.spatial_letters import (
    STRICT,
    any_letter,
    pyramid_of,
    ways_of_sliding,
    with_acting,
)
from contact_dynamics.contact_modes.spatial_program import Program
from contact_dynamics.contact_modes.spatial_regions import Image, Region, image_of, whole
from contact_dynamics.errors import TooLargeError

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.spatial_letters import Letters, Pyramid
    from contact_dynamics.validation import FloatArray

MOST_EXAMINED: Final = 30_000
"""Trials, of some 0.1 ms each, after which a search is given up: where many feet slide along the border of
two sectors of their pyramids at once, either sector is consistent for each."""

_REGION_TAG = -2
_CONTACT_TAG = -3
"""Of contact 0; each further one is one less."""


class Touching(NamedTuple):
    """A contact that neither approaches nor leaves."""

    normal: FloatArray  # (3,), unit
    friction: float  # Coulomb's mu
    sliding: FloatArray  # (3,), m/s, tangential velocity; zero: it is at rest
    point: FloatArray  # (3, 7), its acceleration as a function of the motion
    free: FloatArray  # (3,), its acceleration without contact forces


class Found(NamedTuple):
    """A mode that some forces bring about."""

    letters: list[Letters]  # of each touching contact
    program: Program  # solved


class Search:
    """The modes of touching contacts.

    Motions, (a, alpha) in units that the caller chooses so that contact points' accelerations are about 1,
    are affine functions of the edge forces.
    """

    def __init__(
        self,
        touching: list[Touching],
        *,
        of_forces: FloatArray,
        free: FloatArray,
        power: FloatArray | None,
        facets: int,
    ) -> None:
        """State the problem.

        Args:
            touching: The contacts.
            of_forces: (6, 3 n), motion for unit contact forces.
            free: (6,), motion without contact forces.
            power: (6,), of the motion, that the applied wrench has, if it must be >= 0.
            facets: Edges of a friction pyramid.
        """
        self.touching = touching
        self.pyramids: list[Pyramid] = []
        first = 0
        for contact in touching:
            self.pyramids.append(
                pyramid_of(
                    contact.normal,
                    contact.friction,
                    sliding=contact.sliding,
                    free=contact.free,
                    facets=facets,
                    first=first,
                )
            )
            first += len(self.pyramids[-1].edges)
        self.edges = np.zeros((3 * len(touching), first))  # contact forces of unit edge forces
        for i, pyramid in enumerate(self.pyramids):
            last = pyramid.first + len(pyramid.edges)
            self.edges[3 * i : 3 * i + 3, pyramid.first : last] = pyramid.edges.T
        self.of_forces = of_forces
        motion = of_forces @ self.edges
        sizes = np.linalg.norm(motion, axis=0)
        sizes[sizes == 0.0] = 1.0
        self.edges /= sizes
        self.motion = np.column_stack([motion / sizes, free])
        self.examined = 0  # programs solved so far
        self._first_normal = first  # name of contact 0's normal acceleration
        self._normals = np.array([c.normal @ c.point for c in touching]).reshape(-1, 7)
        named = self._normals
        names = [first + i for i in range(len(touching))]
        if power is not None:
            named = np.vstack([named, np.append(power, 0.0)])
            names.append(first + len(touching))
        self._root = Program.stated(self.motion, named, names)
        self._trials = [
            any_letter(pyramid, contact.point, first + i)
            for i, (contact, pyramid) in enumerate(zip(touching, self.pyramids, strict=True))
        ]
        self._ways: dict[int, tuple[Letters, ...]] = {}
        self._found: dict[tuple[tuple[str, int], ...], list[Letters]] = {}

    def run(self) -> list[Found]:
        """Return all modes."""
        if self._holds(self._root):
            self._decide_who_stays(self._root, self._trials, 0)
        found = []
        for letters in self._found.values():
            program = self._root
            for i, letter in enumerate(letters):
                program = self._narrowed(program, i, letter, staying=letter.letter != "s")
            if self._holds(program):
                found.append(Found(letters, program))
        return found

    def acting(self, found: Found) -> list[FloatArray]:
        """Return the edges of each contact's pyramid that its letter allows to act."""
        return [
            np.array([e for j, e in enumerate(p.edges) if p.first + j not in letter.zeroed]).reshape(-1, 3)
            for p, letter in zip(self.pyramids, found.letters, strict=True)
        ]

    def _holds(self, program: Program) -> bool:
        self.examined += 1
        if self.examined > MOST_EXAMINED:
            raise TooLargeError(
                "contacts",
                f"{len(self.touching)} whose modes take more than {MOST_EXAMINED} trials",
                "fewer contacts, or other friction_facets",
            )
        return program.solve()

    def _narrowed(self, program: Program, at: int, letters: Letters, *, staying: bool = False) -> Program:
        zeroed = letters.zeroed
        if staying:
            zeroed |= {self._first_normal + at}
        return program.narrowed(
            zeroed=zeroed,
            raised=letters.raised,
            least=STRICT,
            rows=letters.rows,
            equalities=letters.equalities,
            tag=_CONTACT_TAG - at,
        )

    def _decide_who_stays(self, program: Program, trials: list[Letters], at: int) -> None:
        if at == len(trials):
            self._decide_common_motion(program, trials)
            return
        for part in trials[at].parts:
            narrower = self._narrowed(program, at, part)
            if self._holds(narrower):
                self._decide_who_stays(narrower, [*trials[:at], part, *trials[at + 1 :]], at + 1)

    def _decide_common_motion(self, program: Program, trials: list[Letters]) -> None:
        open_ones = [i for i, letters in enumerate(trials) if letters.parts]
        frames = np.array([trials[i].parts[0].rows for i in open_ones]).reshape(-1, 2, 7)
        if len(open_ones) < 2 or np.any(frames[:, :, -1]):
            # One contact's letters are as few as regions; with centripetal terms directions are not cones.
            for i in open_ones:
                trials = [*trials[:i], self._with_ways(i, trials[i]), *trials[i + 1 :]]
            self._decide_letters(program, trials, [0] * len(trials))
            return
        sticking, all_stick = program, list(trials)
        for i in open_ones:
            all_stick[i] = trials[i].parts[0]
            sticking = self._narrowed(sticking, i, all_stick[i])
        if self._holds(sticking):
            self._note(all_stick)
        staying = [i for i, letters in enumerate(trials) if letters.letter != "s"]
        image = image_of(self._normals[staying, :-1], frames[:, :, :-1])
        for region in whole(len(image.coordinates)):
            self._decide_within(region, program, trials, image, open_ones)

    def _decide_within(
        self, region: Region, program: Program, trials: list[Letters], image: Image, open_ones: list[int]
    ) -> None:
        silent = region.silent_edges(image, [self.pyramids[i] for i in open_ones])
        narrower = program.narrowed(zeroed=silent, rows=region.rows(image), tag=_REGION_TAG)
        if not self._holds(narrower):
            return
        halves = region.halves()
        if halves is not None:
            for half in halves:
                self._decide_within(half, narrower, trials, image, open_ones)
            return
        fewer = list(trials)
        for i in open_ones:
            pyramid = self.pyramids[i]
            own = frozenset(range(pyramid.first, pyramid.first + len(pyramid.edges)))
            fewer[i] = with_acting(self._with_ways(i, trials[i]), silent, own)
        self._decide_letters(narrower, fewer, [0] * len(trials))

    def _with_ways(self, at: int, stays: Letters) -> Letters:
        """Return the letters of a contact that stays, with its ways of sliding."""
        if at not in self._ways:
            self._ways[at] = ways_of_sliding(self.pyramids[at], self.touching[at].point)
        return stays._replace(parts=(*stays.parts, *self._ways[at]))

    def _decide_letters(self, program: Program, trials: list[Letters], depths: list[int]) -> None:
        open_ones = [i for i, letters in enumerate(trials) if letters.parts]
        if not open_ones:
            self._note(trials)
            return
        at = min(open_ones, key=depths.__getitem__)
        deeper = [*depths[:at], depths[at] + 1, *depths[at + 1 :]]
        for part in trials[at].parts:
            narrower = self._narrowed(program, at, part)
            if self._holds(narrower):
                self._decide_letters(narrower, [*trials[:at], part, *trials[at + 1 :]], deeper)

    def _note(self, letters: list[Letters]) -> None:
        self._found.setdefault(tuple((one.letter, one.item) for one in letters), letters)
