# SPDX-License-Identifier: Apache-2.0
"""Forces that realise a mode which the search found, exactly where they can be exact.

Friction is turned exactly against the sliding (`exact_friction`). A body that stays rests to rounding.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.contact_modes.letters import STICKS
from contact_dynamics.contact_modes.spatial.exact_friction import Sliding, sharpened
from contact_dynamics.contact_modes.spatial.mode_with_forces import mode_with_forces
from contact_dynamics.contact_modes.spatial.problem import FRICTION_FACETS, search_of
from contact_dynamics.contact_modes.spatial.round_cones import held_by_round_cones, polished, sticking
from contact_dynamics.tolerances import MODE_BETTER, MODE_RESTS, ROUND_CONE_APART, ROW_TOLERANCE, STRICT

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.spatial.problem import SpatialCase
    from contact_dynamics.contact_modes.spatial.result import SpatialMode
    from contact_dynamics.contact_modes.spatial.search import Found, Search
    from contact_dynamics.validation import FloatArray


def realised(case: SpatialCase, search: Search, found: Found, *, sharpen: bool) -> SpatialMode:
    """Return a mode that the search found, with accelerations and forces that realise it."""
    count = search.edges.shape[1]
    shares = found.program.shares(count)
    motion_unique, low, high = found.motion
    if not motion_unique and low is not None and high is not None:
        shares = 0.5 * (low + high)  # this is away from the borders of the mode
    mixture = np.random.default_rng(26).normal(size=len(search.edges))
    forces_unique = found.program.ends(mixture @ search.edges).unique
    own = (search.edges @ shares).reshape(-1, 3)
    if sharpen and motion_unique:
        own = _sharpened(search, found, own)
    letters = "".join(one.letter for one in found.letters)
    if set(letters) == {STICKS}:
        own = _rested(search, own)
    unique = motion_unique or forces_unique
    return mode_with_forces(case, letters, own, forces_unique=forces_unique, motion_unique=unique)


def as_given(case: SpatialCase, mode: SpatialMode) -> SpatialMode:
    """Return a mode of flush contacts, with forces under which the given ones rest if all of them stick.

    Any other mode stays that of the flush contacts.
    """
    given = case.given
    letters = "".join(mode.mode[i] for i in case.touching.tolist())
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
    """Return forces under which a body rests to rounding.

    The given forces do so to the tolerance within which conditions on nearly the same contacts are merged.
    """
    rows = sticking(search)
    motion = np.append(search.motion[:, -1] + search.of_forces @ forces.ravel(), 1.0)
    if float(np.abs(rows @ motion).max()) > STRICT:  # what tells merged contacts apart was lost
        held = held_by_round_cones(search, rows)
        forces = forces if held.forces is None else held.forces

    def left(forces: FloatArray) -> float:
        """Return the size of the wrench that forces leave unbalanced."""
        return float(np.linalg.norm(search.mass @ (search.motion[:, -1] + search.of_forces @ forces.ravel())))

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


def _sharpened(search: Search, found: Found, forces: FloatArray) -> FloatArray:
    """Return forces with friction exactly against the sliding, or the given ones if it cannot be turned."""
    letters = "".join(one.letter for one in found.letters)
    if all(one.item < 0 for one in found.letters):
        return forces
    mode = Sliding(search.touching, search.pyramids, letters, search.of_forces, search.motion[:, -1])
    exact = sharpened(mode, forces)
    return forces if exact is None else exact
