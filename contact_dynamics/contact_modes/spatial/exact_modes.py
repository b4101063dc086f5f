# SPDX-License-Identifier: Apache-2.0
"""Refinement of the modes of friction pyramids to modes of Coulomb's round cones.

A body whose contacts all stick is at rest to rounding. For contacts at rest that begin to slide, friction on
a pyramid differs by up to half a sector from the direction opposite to sliding. If the round cones have a
mode nearby, it has the same letters (`exact_letters`), sticking and sliding exchanged, or another
distribution of the load (`shared_loads`).

The search requires that strict inequalities hold by `STRICT`. It finds no mode if contacts with friction at
its limit begin to slide or to separate more slowly than this. The search then continues with slightly
different loads, whose modes have the letters and nearly the forces of a mode of the case, if there is one.
Newton's method finds that mode, and its inequalities hold by more than rounding (`NARROWLY`). It is certain
that there is no mode only if linear programs refute all letters (`completeness.has_none`).
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
    """Return a mode of flush contacts. If all stick, its forces hold the body at the given contacts."""
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
    """Return forces that hold a body at rest to rounding, near forces that do so approximately."""
    rows = sticking(search)
    motion = np.append(search.motion_of(forces), 1.0)
    if float(np.abs(rows @ motion).max()) > STRICT:  # the differences between merged contacts were lost
        held = held_by_round_cones(search, rows)
        forces = forces if held.forces is None else held.forces

    def left(forces: FloatArray) -> float:
        """Return the norm of the unbalanced wrench."""
        return float(np.linalg.norm(search.mass @ search.motion_of(forces)))

    enough = MODE_RESTS * left(np.zeros_like(forces))
    if left(forces) <= enough:
        return forces
    better = polished(search, rows, forces)
    best = better if left(better) <= MODE_BETTER * left(forces) else forces
    for tolerance in (ROW_TOLERANCE, ROUND_CONE_APART):
        if left(best) <= enough:
            break
        # The merged conditions are met. Other forces in the cones also meet the original ones.
        held = held_by_round_cones(search, rows, tolerance=tolerance)
        if held.forces is not None and left(held.forces) <= MODE_BETTER * left(best):
            best = held.forces
    return best


def is_exact(mode: ResponseMode) -> bool:
    """Return whether friction opposes sliding exactly, up to rounding."""
    return mode.misdirection <= MODE_STRAIGHT


def each_once(case: SpatialCase, found: list[ResponseMode]) -> list[ResponseMode]:
    """Return the modes without duplicates."""
    kept: list[ResponseMode] = []
    for mode in found:
        if not any(are_the_same(case, mode, other) for other in kept):
            kept.append(mode)
    return kept


def by_letters(case: SpatialCase, search: Search, found: list[ResponseMode]) -> list[ResponseMode]:
    """Return the modes, each replaced by exact modes nearby, or omitted if certainly none exists."""
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
    """Return the forces of contacts that share a load, or whether there are certainly none.

    The first mode has these letters, and no exact direction of friction was found for it.
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
    """Return the letters of the touching contacts, with c for contacts that stay without friction."""
    return "".join(
        STAYS if contact.holding == 0.0 and mode.mode[i] == STICKS else mode.mode[i]
        for i, contact in zip(case.touching.tolist(), search.touching, strict=True)
    )


_LOADS: Final = 3
"""Number of directions in which the load is changed, by both signs. They rarely miss the neighbouring
modes."""


class Narrow(NamedTuple):
    """A mode whose inequalities hold by `NARROWLY`, but not by `STRICT`."""

    letters: str  # s, c or f for each touching contact
    forces: FloatArray  # (n, 3), in the units of the motion
    alone: bool  # whether its forces are the only ones nearby


class Narrowly(NamedTuple):
    """The narrow modes of a case."""

    modes: list[Narrow]
    nearby: list[str]  # the letters of the modes of nearby loads


def narrowly(search: Search) -> Narrowly:
    """Return the narrow modes of a case, found from the modes of nearby loads."""
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
    """Return the modes of a case with forces near the given ones."""
    found = []
    for trial in letters_near(search, letters):
        for shared in (False, True):
            forces = forces_with_letters(search, trial, start, shared=shared, least=NARROWLY)
            if forces is not None:
                found.append(Narrow(trial, forces, alone=not shared))
                break
    return found


def _each_motion_once(search: Search, modes: list[Narrow]) -> list[Narrow]:
    """Return one mode for each motion, the one with the most sticking contacts."""
    kept: list[tuple[Narrow, FloatArray]] = []
    for mode in sorted(modes, key=lambda one: -one.letters.count("f")):
        motion = search.motion_of(mode.forces)
        if all(float(np.abs(motion - other).max()) > STRICT for _, other in kept):
            kept.append((mode, motion))
    return [mode for mode, _ in kept]
