# SPDX-License-Identifier: Apache-2.0
"""Modes that hold so narrowly that the search refuses them, as where contacts have only just begun to slide.

The search asks that strict inequalities hold by `STRICT`. If contacts begin to slide or to separate more
slowly than this, and their friction is used up all the same, it finds no mode. Then the search goes on with
loads that differ a little from that of the case. A mode of such a load has the letters and nearly the forces
of one of the case, if there is one. Newton's method finds it, and the inequalities then hold by more than
rounding (`NARROWLY`).

That there is no mode at all is certain only if linear programs refute all letters (`completeness.has_none`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.spatial.exact_letters import forces_with_letters, letters_near
from contact_dynamics.errors import TooLargeError
from contact_dynamics.tolerances import BEHIND_BOUNDARY, NARROWLY, STRICT

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.spatial.search import Search
    from contact_dynamics.validation import FloatArray

_LOADS: Final = 3
"""Loads to both sides of the case's own are tried in so many directions. Boundaries between modes that lie in
none of them are rare."""


class Narrow(NamedTuple):
    """A mode that holds narrowly.

    Attributes:
        letters: s, c or f for each touching contact.
        forces: (n, 3), in the units of the motion.
        alone: Whether its forces are the only ones nearby.
    """

    letters: str
    forces: FloatArray
    alone: bool


class Narrowly(NamedTuple):
    """What holds narrowly.

    Attributes:
        modes: The modes that were found.
        nearby: The letters of the modes of loads nearby.
    """

    modes: list[Narrow]
    nearby: list[str]


def narrowly(search: Search) -> Narrowly:
    """Return the modes that hold narrowly, near those of loads nearby."""
    chance = np.random.default_rng(26)
    free = search.motion[:, -1]
    modes: list[Narrow] = []
    nearby: dict[str, None] = {}
    for _ in range(_LOADS):
        way = chance.normal(size=search.freedoms)
        way *= BEHIND_BOUNDARY / float(np.linalg.norm(way))
        for beside in (search.loaded(free + way), search.loaded(free - way)):
            try:
                found = beside.run(grouped=True)
            except TooLargeError:
                continue
            for one in found:
                letters = "".join(letter.letter for letter in one.letters)
                nearby.setdefault(letters)
                start = (beside.edges @ one.program.shares(beside.edges.shape[1])).reshape(-1, 3)
                modes += _near(search, letters, start)
        if modes:
            break
    return Narrowly(_each_motion_once(search, modes), list(nearby))


def _near(search: Search, letters: str, start: FloatArray) -> list[Narrow]:
    """Return the modes of a case whose forces are near to given ones."""
    found = []
    for trial in letters_near(search, letters):
        for shared in (False, True):
            forces = forces_with_letters(search, trial, start, shared=shared, least=NARROWLY)
            if forces is not None:
                found.append(Narrow(trial, forces, alone=not shared))
                break
    return found


def _each_motion_once(search: Search, modes: list[Narrow]) -> list[Narrow]:
    """Return one mode for each motion, the one in which most contacts stick if there are several.

    A contact may stick to within rounding, and slide by hardly more than that.
    """
    kept: list[tuple[Narrow, FloatArray]] = []
    for mode in sorted(modes, key=lambda one: -one.letters.count("f")):
        motion = search.motion[:, -1] + search.of_forces @ mode.forces.ravel()
        if all(float(np.abs(motion - other).max()) > STRICT for _, other in kept):
            kept.append((mode, motion))
    return [mode for mode, _ in kept]
