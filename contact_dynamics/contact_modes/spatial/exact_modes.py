# SPDX-License-Identifier: Apache-2.0
"""The modes that a search of friction pyramids found, with forces that realise them, exactly where they can.

A body that stays rests to rounding. Where contacts at rest come to slide, friction on a pyramid is up to half
a sector away from the direction against their sliding. Such a mode is close to one of the round cones, if
there is one: with the same letters (`exact_letters`), with sticking and sliding exchanged, or with another
sharing of the load (`shared_loads`).

The search asks that strict inequalities hold by `STRICT`. It finds no mode if contacts begin to slide or to
separate more slowly than this, although their friction is at its limit. Then the search continues with
loads that differ a little from that of the case. A mode of such a load has the letters and nearly the forces
of one of the case, if there is one. Newton's method finds it, and the inequalities then hold by more than
rounding (`NARROWLY`). That there is no mode at all is certain only if linear programs refute all letters
(`completeness.has_none`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.letters import STAYS, STICKS
from contact_dynamics.contact_modes.spatial.exact_letters import forces_with_letters, letters_near
from contact_dynamics.contact_modes.spatial.mode_with_forces import are_the_same, mode_with_forces
from contact_dynamics.contact_modes.spatial.problem import FRICTION_FACETS, search_of
from contact_dynamics.contact_modes.spatial.round_cones import Held, held_by_round_cones, polished, sticking
from contact_dynamics.contact_modes.spatial.shared_loads import sliding_together
from contact_dynamics.errors import TooLargeError
from contact_dynamics.tolerances import (
    BEHIND_BOUNDARY,
    MODE_BETTER,
    MODE_RESTS,
    MODE_STRAIGHT,
    NARROWLY,
    ROUND_CONE_APART,
    ROW_TOLERANCE,
    STRICT,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes.result import ResponseMode
    from contact_dynamics.contact_modes.spatial.problem import SpatialCase
    from contact_dynamics.contact_modes.spatial.search import Found, Search
    from contact_dynamics.validation import FloatArray


def realised(case: SpatialCase, search: Search, found: Found) -> ResponseMode:
    """Return a mode that the search found, with accelerations and forces that realise it."""
    count = search.edges.shape[1]
    shares = found.program.shares(count)
    motion_unique, low, high = found.motion
    if not motion_unique and low is not None and high is not None:
        shares = 0.5 * (low + high)  # this is away from the borders of the mode
    mixture = np.random.default_rng(26).normal(size=len(search.edges))
    forces_unique = found.program.ends(mixture @ search.edges).unique
    own = (search.edges @ shares).reshape(-1, 3)
    letters = "".join(one.letter for one in found.letters)
    if set(letters) == {STICKS}:
        own = _rested(search, own)
    unique = motion_unique or forces_unique
    return mode_with_forces(case, letters, own, forces_unique=forces_unique, motion_unique=unique)


def as_given(case: SpatialCase, mode: ResponseMode) -> ResponseMode:
    """Return a mode of flush contacts, with forces under which the given ones rest if all of them stick."""
    given = case.given
    letters = case.of_touching(mode.mode)
    if given is None or set(letters) != {STICKS}:
        return mode
    own = mode.contact_forces_W[case.touching] / given.motion.scale
    normals = given.contacts.normals_W[case.touching]
    pressing = np.sum(own * case.contacts.normals_W[case.touching], axis=1)
    own += (pressing - np.sum(own * normals, axis=1))[:, None] * normals
    own = _rested(search_of(given, FRICTION_FACETS), own)
    return mode_with_forces(
        given, letters, own, forces_unique=mode.forces_unique, motion_unique=mode.motion_unique
    )


def _rested(search: Search, forces: FloatArray) -> FloatArray:
    """Return forces under which a body rests to rounding, near others under which it nearly does."""
    rows = sticking(search)
    motion = np.append(search.motion_of(forces), 1.0)
    if float(np.abs(rows @ motion).max()) > STRICT:  # what tells merged contacts apart was lost
        held = held_by_round_cones(search, rows)
        forces = forces if held.forces is None else held.forces

    def left(forces: FloatArray) -> float:
        """Return the size of the wrench that forces leave unbalanced."""
        return float(np.linalg.norm(search.mass @ search.motion_of(forces)))

    enough = MODE_RESTS * left(np.zeros_like(forces))
    if left(forces) <= enough:
        return forces
    better = polished(search, rows, forces)
    best = better if left(better) <= MODE_BETTER * left(forces) else forces
    for tolerance in (ROW_TOLERANCE, ROUND_CONE_APART):
        if left(best) <= enough:
            break
        # The merged conditions hold, and forces elsewhere in the cones meet all of them.
        held = held_by_round_cones(search, rows, tolerance=tolerance)
        if held.forces is not None and left(held.forces) <= MODE_BETTER * left(best):
            best = held.forces
    return best


def is_exact(mode: ResponseMode) -> bool:
    """Return whether friction opposes the sliding to rounding."""
    return mode.misdirection <= MODE_STRAIGHT


def each_once(case: SpatialCase, found: list[ResponseMode]) -> list[ResponseMode]:
    """Return the modes without those that are the same as an earlier one."""
    kept: list[ResponseMode] = []
    for mode in found:
        if not any(are_the_same(case, mode, other) for other in kept):
            kept.append(mode)
    return kept


def by_letters(case: SpatialCase, search: Search, found: list[ResponseMode]) -> list[ResponseMode]:
    """Return the modes, with exact ones in place of others, or without these if certainly none exists."""
    kept: list[ResponseMode] = []
    for mode in found:
        if is_exact(mode):
            kept.append(mode)
            continue
        letters = letters_of(mode, case, search)
        if mode.motion_unique:
            own = case.own_forces(mode.contact_forces_W)
            shared = not mode.forces_unique
            trials = [
                (trial, forces_with_letters(search, trial, own, shared=shared))
                for trial in letters_near(search, letters)
            ]
            refused = False
        else:
            others = [other for other in found if other is not mode]
            held = _shared(case, search, letters, [mode, *others])
            trials, refused = [(letters, held.forces)], held.certain
        near = [
            mode_with_forces(
                case, trial, forces, forces_unique=mode.forces_unique, motion_unique=mode.motion_unique
            )
            for trial, forces in trials
            if forces is not None
        ]
        kept += near
        if not near and not refused:
            kept.append(mode)
    return each_once(case, kept)


def _shared(case: SpatialCase, search: Search, letters: str, modes: Sequence[ResponseMode]) -> Held:
    """Return forces of contacts that share a load, or whether it is certain that there are none.

    The first mode has these letters, and friction that could not be turned.
    """
    own = case.own_forces(modes[0].contact_forces_W)
    forces = forces_with_letters(search, letters, own, shared=True)
    if forces is not None:
        return Held(forces, certain=True)
    units = case.motion.lengths / case.motion.scale
    motions = [units * case.motion.motion(one.contact_forces_W) for one in modes]
    held = sliding_together(search, letters, motions)
    if held.forces is None:
        return held
    forces = forces_with_letters(search, letters, held.forces, shared=True)
    return Held(forces, certain=forces is not None)


def letters_of(mode: ResponseMode, case: SpatialCase, search: Search) -> str:
    """Return the letters of the touching contacts, where c stands for all that stay without friction."""
    return "".join(
        STAYS if contact.friction == 0.0 and mode.mode[i] == STICKS else mode.mode[i]
        for i, contact in zip(case.touching.tolist(), search.touching, strict=True)
    )


_LOADS: Final = 3
"""Number of directions in which loads on both sides of the case's own are tried. Boundaries between modes
that lie in none of them are rare."""


class Narrow(NamedTuple):
    """A mode that holds narrowly."""

    letters: str  # s, c or f for each touching contact
    forces: FloatArray  # (n, 3), in the units of the motion
    alone: bool  # whether its forces are the only ones nearby


class Narrowly(NamedTuple):
    """What holds narrowly."""

    modes: list[Narrow]  # the modes that were found
    nearby: list[str]  # the letters of the modes of loads nearby


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
    """Return one mode for each motion: the one in which most contacts stick, if rounding lets some slide."""
    kept: list[tuple[Narrow, FloatArray]] = []
    for mode in sorted(modes, key=lambda one: -one.letters.count("f")):
        motion = search.motion_of(mode.forces)
        if all(float(np.abs(motion - other).max()) > STRICT for _, other in kept):
            kept.append((mode, motion))
    return [mode for mode, _ in kept]
