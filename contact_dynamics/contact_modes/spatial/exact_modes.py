# SPDX-License-Identifier: Apache-2.0
"""Exact modes in place of those whose friction could not be turned against the sliding.

A mode of the friction pyramids is close to one of the round cones, if there is one: with the same letters
(`exact_letters`), with sticking and sliding exchanged, or with another sharing of the load (`shared_loads`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from contact_dynamics.contact_modes.letters import STAYS, STICKS
from contact_dynamics.contact_modes.spatial.exact_letters import forces_with_letters, letters_near
from contact_dynamics.contact_modes.spatial.mode_with_forces import are_the_same, mode_with_forces
from contact_dynamics.contact_modes.spatial.round_cones import Held
from contact_dynamics.contact_modes.spatial.shared_loads import sliding_together
from contact_dynamics.tolerances import MODE_STRAIGHT

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes.result import ResponseMode
    from contact_dynamics.contact_modes.spatial.problem import SpatialCase
    from contact_dynamics.contact_modes.spatial.search import Search


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
    """Return the modes, where exact solutions replace those whose friction could not be turned.

    Those that are certain to have none are left out.
    """
    kept: list[ResponseMode] = []
    for mode in found:
        if is_exact(mode):
            kept.append(mode)
            continue
        letters = letters_of(mode, case, search)
        if mode.motion_unique:
            own = mode.contact_forces_W[case.touching] / case.motion.scale
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

    Args:
        case: The body with its contacts.
        search: The search of that case.
        letters: s, c or f for each touching contact.
        modes: The mode with these letters whose friction could not be turned, and others.
    """
    own = modes[0].contact_forces_W[case.touching] / case.motion.scale
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
