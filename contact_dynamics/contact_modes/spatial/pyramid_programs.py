# SPDX-License-Identifier: Apache-2.0
"""Touching contacts with friction pyramids, and linear programs about the forces along their edges."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.spatial.dual_simplex import CarefulProgram, Narrowing, Program
from contact_dynamics.contact_modes.spatial.kinematic import faces_in_space
from contact_dynamics.contact_modes.spatial.options import any_letter, pyramid_of
from contact_dynamics.contact_modes.spatial.regions import ONE_BODY
from contact_dynamics.errors import TooLargeError
from contact_dynamics.numerics.linear_spaces import seen_and_unseen
from contact_dynamics.tolerances import STRICT

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes.spatial.options import Option, Pyramid
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


class Touching(NamedTuple):
    """A contact that neither approaches nor leaves."""

    normal: FloatArray  # (3,), unit
    friction: float  # Coulomb's mu
    sliding: FloatArray  # (3,), m/s, its tangential velocity; zero where it is at rest
    point: FloatArray  # (3, d + 1), its acceleration as a function of the motion, which has d components
    free: FloatArray  # (3,), its acceleration without contact forces


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
        """State the problem.

        Args:
            touching: The contacts.
            of_forces: (d, 3 n), the motion that unit contact forces cause.
            free: (d,), the motion without contact forces.
            mass: (d, d), the forces and torques that unit motion needs.
            at_rest: Whether nothing moves, so that the applied wrench has power >= 0.
            facets: The number of edges of a friction pyramid.
            least: By how much contacts that separate must do so.
        """
        self._least = least
        self.touching = touching
        self._facets = facets
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
        self.edges = np.zeros((3 * len(touching), first))  # the contact forces that unit edge forces are
        for i, pyramid in enumerate(self.pyramids):
            last = pyramid.first + len(pyramid.edges)
            self.edges[3 * i : 3 * i + 3, pyramid.first : last] = pyramid.edges.T
        self.of_forces = of_forces
        self.freedoms = len(free)  # the number of components of the motion
        motion = of_forces @ self.edges
        sizes = np.linalg.norm(motion, axis=0)
        sizes[sizes == 0.0] = 1.0
        self.edges /= sizes
        self._sizes = sizes
        self.motion = np.column_stack([motion / sizes, free])
        self.examined = 0  # the number of programs solved so far
        self.most_examined = MAX_EXAMINED if self.freedoms <= ONE_BODY else MAX_EXAMINED_OF_SEVERAL
        self._first_normal = first  # the name of contact 0's normal acceleration
        self._normals = np.array([c.normal @ c.point for c in touching]).reshape(-1, self.freedoms + 1)
        named = self._normals
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

    def decide_who_stays(self) -> None:
        """Decide which contacts stay, and for each choice that may hold all else."""
        root = self._solved(self._root)
        choices = self._choices()
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
        rows = self._normals[:, :-1]
        basis = seen_and_unseen(rows)[0]
        if len(basis) != _FLUSH or self._normals[:, -1].any():
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
                rows=np.concatenate([self._normals[:0], *equations, *others]),
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
