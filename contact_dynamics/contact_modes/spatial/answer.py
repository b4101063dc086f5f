"""The contact modes of a body in space that are consistent with mechanics, with directions of sliding.

Model: as in the plane (lecture 26), with Coulomb's round cone. A contact that moves slides in a known
direction and has its exact friction. For one at rest the cone is a pyramid with a stated number of edges, the
first of which opposes the tangential acceleration that the contact would have without any contact force. On
the pyramid friction does the most it can against the sliding: a contact that slides within the sector
opposite to an edge has its force on that edge, one that slides on a sector's border has it on the side
between two edges. Letters are s (separates), f (sticks) and c (stays and slides); the sector or border
belongs to the mode. All of them are found (`search`); then friction is turned exactly against the
sliding where that has a solution (`exact_friction`). A contact without friction is one letter, sliding or
not.

Does not cover: margins (`spatial.margins`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.contact_modes.letters import SEPARATES, STAYS, STICKS
from contact_dynamics.contact_modes.result import ModeVerdict, verdict_on
from contact_dynamics.contact_modes.spatial.exact_friction import Sliding, sharpened
from contact_dynamics.contact_modes.spatial.least_forces import least_forces, misdirection
from contact_dynamics.contact_modes.spatial.problem import SpatialCase, search_of, spatial_case
from contact_dynamics.contact_modes.spatial.result import SpatialMode, SpatialModeAnswer
from contact_dynamics.tolerances import SAME_MOTION, STRICT

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem
    from contact_dynamics.contact_modes.spatial.search import Found, Search
    from contact_dynamics.validation import FloatArray


def spatial_contact_modes(problem: SpatialContactProblem) -> SpatialModeAnswer:
    """Return the verdict on a contact set in space and all consistent modes.

    Raises:
        TooLargeError: more contacts touch than `spatial.problem.MOST_DYNAMIC_CONTACTS`; or the search takes
            more trials than `search.MOST_EXAMINED`, as for hundreds of sectors without ``sharpen``.
    """
    case = spatial_case(problem)
    modes: list[SpatialMode] = []
    examined = 0
    approaching: tuple[int, ...] = ()
    if isinstance(case, SpatialCase):
        search = search_of(case, problem.friction_facets)
        modes = [mode for mode, _ in evidenced(case, search, sharpen=problem.sharpen)]
        examined = search.examined
    else:
        approaching = case
    return SpatialModeAnswer(
        verdict=ModeVerdict.IMPACT if approaching else verdict_on(modes),
        modes=tuple(modes),
        approaching=approaching,
        velocity_tolerance=problem.velocity_tolerance,
        friction_facets=problem.friction_facets,
        examined=examined,
    )


def evidenced(case: SpatialCase, search: Search, *, sharpen: bool) -> list[tuple[SpatialMode, Found]]:
    """Return the modes of a case with what the search found of them; of twins, if sharpened, the first.

    Twins have the same letters and the same motion. Where the motion with some letters is not unique, all
    with these letters are twins of that mode.
    """
    every = search.run(grouped=sharpen)
    found = [(_evidence(case, search, one, sharpen=sharpen), one) for one in every]
    if not sharpen:
        return found
    kept: list[tuple[SpatialMode, Found]] = []
    for mode, one in sorted(found, key=lambda pair: pair[0].motion_unique):
        if not any(_are_twins(mode, other) for other, _ in kept):
            kept.append((mode, one))
    return kept


def _are_twins(mode: SpatialMode, other: SpatialMode) -> bool:
    if mode.mode != other.mode:
        return False
    if not (mode.motion_unique and other.motion_unique):
        return True
    one = np.concatenate([mode.acceleration_W, mode.angular_acceleration_W])
    two = np.concatenate([other.acceleration_W, other.angular_acceleration_W])
    return bool(np.abs(one - two).max() <= SAME_MOTION * (1.0 + np.abs(one).max()))


def _evidence(case: SpatialCase, search: Search, found: Found, *, sharpen: bool) -> SpatialMode:
    """Return a mode with accelerations and forces that realise it."""
    motion, contacts, sliding, touching = case
    count = search.edges.shape[1]
    shares = found.program.shares(count)
    motion_unique, low, high = found.motion
    if not motion_unique and low is not None and high is not None:
        shares = 0.5 * (low + high)  # away from the borders of the mode
    mixture = np.random.default_rng(26).normal(size=len(search.edges))
    forces_unique = found.program.ends(mixture @ search.edges).unique
    own, acting = (search.edges @ shares).reshape(-1, 3), search.acting(found)
    if sharpen and motion_unique:
        own, acting = _sharpened(search, found, own, acting)
    if not forces_unique:
        own = least_forces(search.of_forces, own, acting)
    forces = np.zeros((len(contacts), 3))
    forces[touching] = own * motion.scale
    body = motion.free + motion.of_forces @ forces.ravel()
    points = (motion.points @ body).reshape(-1, 3) + motion.turning
    across = points - np.sum(points * contacts.normals_W, axis=1)[:, None] * contacts.normals_W
    letters = [SEPARATES] * len(contacts)
    directions = np.zeros_like(points)
    for i, letter in zip(touching.tolist(), found.letters, strict=True):
        way = sliding[i] if np.any(sliding[i]) else across[i]
        size = float(np.linalg.norm(way))
        # Without friction one letter stands for both, and the acceleration says which it is.
        rests = letter.letter == STAYS and not np.any(sliding[i]) and size <= STRICT * motion.scale
        letters[i] = STICKS if rests else letter.letter
        if letters[i] == STAYS:
            directions[i] = way / size
    return SpatialMode(
        mode="".join(letters),
        acceleration_W=body[:3],
        angular_acceleration_W=body[3:],
        contact_forces_W=forces,
        contact_accelerations_W=points,
        tangential_directions_W=directions,
        misdirection=misdirection(forces, directions, contacts.normals_W),
        forces_unique=forces_unique,
        motion_unique=motion_unique or forces_unique,
    )


def _sharpened(
    search: Search, found: Found, forces: FloatArray, acting: list[FloatArray]
) -> tuple[FloatArray, list[FloatArray]]:
    """Return forces, and the edges that may act, with friction exactly against the sliding if that can be."""
    letters = "".join(one.letter for one in found.letters)
    if all(one.item < 0 for one in found.letters):
        return forces, acting
    mode = Sliding(search.touching, search.pyramids, letters, search.of_forces, search.motion[:, -1])
    exact = sharpened(mode, forces)
    return (forces, acting) if exact is None else (exact.forces, exact.edges)
