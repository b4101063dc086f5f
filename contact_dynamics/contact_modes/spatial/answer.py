"""The contact modes of a body in space that are consistent with mechanics, with directions of sliding.

The model is that of the plane (lecture 26), with Coulomb's round cone. A contact that moves already slides in
a known direction, so that its friction is known exactly. For a contact at rest, a pyramid with a stated
number of edges stands for the cone. Its first edge opposes the tangential acceleration that the contact would
have without any contact force. On the pyramid, friction does the most it can against the sliding. A contact
that slides within the sector opposite to an edge has its force on that edge. A contact that slides along the
border of two sectors has its force on the side between their edges.

The letters are s (separates), f (sticks) and c (stays and slides); the sector or border belongs to the mode.
The search finds all modes of the pyramids (`search`). Then friction is turned exactly against the sliding
(`exact_friction`, `exact_letters`), and finer pyramids are tried where that has no solution. One contact at
rest is solved exactly (`one_contact`), and round cones decide whether all contacts can stick (`round_cones`).
A contact without friction has the letter c, whether it slides or not.

`spatial.margins` says how far the applied wrench is from other modes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.letters import STAYS, STICKS
from contact_dynamics.contact_modes.result import ModeVerdict, verdict_on
from contact_dynamics.contact_modes.spatial.exact_friction import Sliding, sharpened
from contact_dynamics.contact_modes.spatial.exact_letters import forces_with_letters, letters_near
from contact_dynamics.contact_modes.spatial.least_forces import least_forces
from contact_dynamics.contact_modes.spatial.mode_with_forces import are_the_same, mode_with_forces
from contact_dynamics.contact_modes.spatial.one_contact import modes_of_one
from contact_dynamics.contact_modes.spatial.problem import SpatialCase, search_of, spatial_case
from contact_dynamics.contact_modes.spatial.result import SpatialMode, SpatialModeAnswer
from contact_dynamics.contact_modes.spatial.round_cones import (
    held_by_round_cones,
    polished,
    rests_in_one_way,
    sticking,
)
from contact_dynamics.errors import TooLargeError
from contact_dynamics.tolerances import (
    MODE_BETTER,
    MODE_OBLIQUE,
    MODE_RESTS,
    MODE_STRAIGHT,
    STRICT,
)

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem
    from contact_dynamics.contact_modes.spatial.search import Found, Search
    from contact_dynamics.validation import FloatArray


_MOST_SOUGHT_TWICE: Final = 4
"""The modes of no more contacts than these are sought with finer pyramids too."""

_FINER: Final = 4
"""How many times as many edges the finer pyramids have."""

_MOST_FACETS: Final = 128
"""How many edges the finest pyramid has that is searched. Pyramids are made finer where friction could not be
turned against the sliding."""

_DOUBT: Final = "rounding decides whether some modes are consistent: contacts or normals are nearly the same"

_AT_REST: Final = "whether all contacts can stick together hangs on rounding"

_TURNED: Final = (
    "friction could not be turned against the sliding of {}, which holds with friction pyramids, and may not "
    "with Coulomb's round cones"
)


class Evidence(NamedTuple):
    """The modes of a case, and what could not be decided about them.

    Attributes:
        modes: Each mode, with what the search of the pyramids found, or None if another way found the mode.
        undecided: What could not be decided, and why. It is empty where everything was decided.
        undecided_modes: The letters of modes that hold with friction pyramids, and may not with round cones.
    """

    modes: list[tuple[SpatialMode, Found | None]]
    undecided: str
    undecided_modes: tuple[str, ...] = ()


def spatial_contact_modes(problem: SpatialContactProblem) -> SpatialModeAnswer:
    """Return the verdict on a contact set in space and all consistent modes.

    Raises:
        TooLargeError: more contacts touch than `spatial.problem.MOST_DYNAMIC_CONTACTS`. Or the search takes
            more trials than `search.MOST_EXAMINED`, which happens where hundreds of sectors are consistent
            and ``sharpen`` is false.
    """
    case = spatial_case(problem)
    found = Evidence([], "")
    examined = 0
    approaching: tuple[int, ...] = ()
    if isinstance(case, SpatialCase):
        search = search_of(case, problem.friction_facets)
        if problem.sharpen:
            found = evidenced(case, search, facets=problem.friction_facets)
        else:
            found = Evidence(found_by(case, search, sharpen=False), _DOUBT if search.doubtful else "")
        examined = search.examined
    else:
        approaching = case
    verdict = ModeVerdict.UNDECIDED if found.undecided else verdict_on(found.modes)
    return SpatialModeAnswer(
        verdict=ModeVerdict.IMPACT if approaching else verdict,
        modes=tuple(mode for mode, _ in found.modes),
        approaching=approaching,
        velocity_tolerance=problem.velocity_tolerance,
        friction_facets=problem.friction_facets,
        examined=examined,
        undecided=found.undecided,
        undecided_modes=found.undecided_modes,
    )


def evidenced(case: SpatialCase, search: Search, *, facets: int) -> Evidence:
    """Return all modes of a case, with Coulomb's round cones.

    Args:
        case: The body with its contacts.
        search: The search of that case.
        facets: The number of edges of its pyramids.
    """
    found = _sought(case, search, facets)
    exact = [pair for pair in found.modes if _is_exact(pair[0])]
    others = tuple(dict.fromkeys(mode.mode for mode, _ in found.modes if not _is_exact(mode)))
    turned = _TURNED.format(", ".join(others)) if others else ""
    return Evidence(exact, found.undecided or turned, others)


def _sought(case: SpatialCase, search: Search, facets: int) -> Evidence:
    """Return the modes of a case, also those whose friction could not be turned."""
    kept = found_by(case, search, sharpen=True)
    undecided = _DOUBT if search.doubtful else ""
    slides = bool(np.any(case.sliding[case.touching]))
    if not slides and len(case.touching) == 1 and search.touching[0].friction > 0.0:
        return Evidence(_of_one_contact(case, search, kept), "")
    refined = _refined(case, search, Evidence(kept, undecided), facets)
    if slides:
        return refined
    if 2 <= len(search.touching) <= _MOST_SOUGHT_TWICE and _are_oblique(search):
        refined = _with_those_between(case, refined, facets)
    return _with_rest(case, search, refined)


def _are_oblique(search: Search) -> bool:
    normals = np.array([one.normal for one in search.touching])
    return bool(np.abs(normals - normals[0]).max() > MODE_OBLIQUE)


def _with_those_between(case: SpatialCase, found: Evidence, facets: int) -> Evidence:
    """Return the modes that were found, and those that need friction between the edges of the pyramids."""
    finer = search_of(case, min(_FINER * facets, _MOST_FACETS))
    try:
        further = _by_letters(case, finer, found_by(case, finer, sharpen=True))
    except TooLargeError:
        return found
    exact = [(mode, None) for mode, _ in further if mode.motion_unique and _is_exact(mode)]
    return found._replace(modes=_each_once([*found.modes, *exact]))


def found_by(case: SpatialCase, search: Search, *, sharpen: bool) -> list[tuple[SpatialMode, Found | None]]:
    """Return the modes of a case with friction pyramids.

    If friction is sharpened, each mode is returned once. Two modes are the same if their letters and their
    motions are. Where the motion with some letters is not unique, all modes with these letters are the same.
    """
    every = search.run(grouped=sharpen)
    found: list[tuple[SpatialMode, Found | None]] = [
        (_evidence(case, search, one, sharpen=sharpen), one) for one in every
    ]
    if not sharpen:
        return found
    return _each_once(sorted(found, key=lambda pair: pair[0].motion_unique))


def _is_exact(mode: SpatialMode) -> bool:
    return mode.misdirection <= MODE_STRAIGHT


def _refined(case: SpatialCase, search: Search, found: Evidence, facets: int) -> Evidence:
    """Return the modes, where modes of finer pyramids replace those whose friction could not be turned."""
    modes = _by_letters(case, search, found.modes)
    while not all(_is_exact(mode) for mode, _ in modes):
        facets *= 2
        exact = [pair for pair in modes if _is_exact(pair[0])]
        others = [mode for mode, _ in modes if not _is_exact(mode)]
        if facets > _MOST_FACETS or not all(mode.motion_unique for mode in others):
            break
        finer = search_of(case, facets)
        try:
            further = found_by(case, finer, sharpen=True)
        except TooLargeError:
            break
        further = [(mode, None) for mode, _ in _by_letters(case, finer, further)]
        modes = _each_once([*exact, *further])
        if finer.doubtful:
            return Evidence(modes, _DOUBT)
    return Evidence(modes, found.undecided)


def _by_letters(
    case: SpatialCase, search: Search, found: list[tuple[SpatialMode, Found | None]]
) -> list[tuple[SpatialMode, Found | None]]:
    """Return the modes, where exact solutions replace those whose friction could not be turned."""
    kept: list[tuple[SpatialMode, Found | None]] = []
    for mode, one in found:
        near: list[tuple[SpatialMode, Found | None]] = []
        if not _is_exact(mode):
            own = mode.contact_forces_W[case.touching] / case.motion.scale
            letters = _letters_of(mode, case, search)
            forces_unique, motion_unique = mode.forces_unique, mode.motion_unique
            for trial in letters_near(search, letters) if motion_unique else (letters,):
                forces = forces_with_letters(search, trial, own, shared=not forces_unique)
                if forces is not None:
                    found_so = one if trial == letters and not motion_unique else None
                    exact = mode_with_forces(
                        case, trial, forces, forces_unique=forces_unique, motion_unique=motion_unique
                    )
                    near.append((exact, found_so))
        kept += near or [(mode, one)]
    return _each_once(kept)


def _letters_of(mode: SpatialMode, case: SpatialCase, search: Search) -> str:
    """Return the letters of the touching contacts, where c stands for all that stay without friction."""
    return "".join(
        STAYS if contact.friction == 0.0 and mode.mode[i] == STICKS else mode.mode[i]
        for i, contact in zip(case.touching.tolist(), search.touching, strict=True)
    )


def _of_one_contact(
    case: SpatialCase, search: Search, found: list[tuple[SpatialMode, Found | None]]
) -> list[tuple[SpatialMode, Found | None]]:
    """Return all modes of one contact at rest. A mode that the search found exactly stays as it is."""
    (contact,) = search.touching
    G = (
        case.motion.points[3 * case.touching[0] :][:3]
        @ case.motion.of_forces[:, 3 * case.touching[0] :][:, :3]
    )
    b = case.motion.points_free[case.touching[0]] / case.motion.scale
    exact = modes_of_one(G, b, contact.normal, contact.friction)
    kept: list[tuple[SpatialMode, Found | None]] = []
    for one in exact:
        mode = mode_with_forces(case, one.letter, one.force[None, :], forces_unique=True, motion_unique=True)
        alike = [
            pair for pair in found if pair[0].misdirection <= MODE_STRAIGHT and are_the_same(mode, pair[0])
        ]
        kept.append(alike[0] if alike else (mode, None))
    order = [mode for mode, _ in found]
    return sorted(kept, key=lambda pair: order.index(pair[0]) if pair[1] is not None else len(order))


def _all_stick(case: SpatialCase, search: Search, mode: SpatialMode) -> bool:
    return all(
        mode.mode[i] == STICKS or (contact.friction == 0.0 and mode.mode[i] == STAYS)
        for i, contact in zip(case.touching.tolist(), search.touching, strict=True)
    )


def _with_rest(case: SpatialCase, search: Search, found: Evidence) -> Evidence:
    """Return the modes, with the one in which all contacts stick if forces in the round cones allow it."""
    letters = "".join(STICKS if one.friction > 0.0 else STAYS for one in search.touching)
    undecided = found.undecided
    still = [pair for pair in found.modes if _all_stick(case, search, pair[0])]
    if len(still) > 1:  # the forces that hold a body form a convex set, and are one mode
        found = found._replace(modes=[pair for pair in found.modes if pair not in still[1:]])
    if not still:
        rows = sticking(search)
        held = held_by_round_cones(search, rows)
        if held.forces is not None:
            unique = rests_in_one_way(search, rows)
            own = polished(search, rows, held.forces)
            mode = mode_with_forces(
                case, letters, own, forces_unique=unique.forces, motion_unique=unique.motion
            )
            return Evidence([*found.modes, (mode, None)], undecided)
        if not held.certain:
            undecided = _AT_REST
    return Evidence(found.modes, undecided)


def _evidence(case: SpatialCase, search: Search, found: Found, *, sharpen: bool) -> SpatialMode:
    """Return a mode that the search found, with accelerations and forces that realise it."""
    count = search.edges.shape[1]
    shares = found.program.shares(count)
    motion_unique, low, high = found.motion
    if not motion_unique and low is not None and high is not None:
        shares = 0.5 * (low + high)  # this is away from the borders of the mode
    mixture = np.random.default_rng(26).normal(size=len(search.edges))
    forces_unique = found.program.ends(mixture @ search.edges).unique
    own, acting = (search.edges @ shares).reshape(-1, 3), search.acting(found)
    if sharpen and motion_unique:
        own, acting = _sharpened(search, found, own, acting)
    if not forces_unique:
        own = least_forces(search.of_forces, own, acting)
    letters = "".join(one.letter for one in found.letters)
    if set(letters) == {STICKS}:
        own = _rested(search, own)
    unique = motion_unique or forces_unique
    return mode_with_forces(case, letters, own, forces_unique=forces_unique, motion_unique=unique)


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

    before = left(forces)
    if before <= MODE_RESTS * left(np.zeros_like(forces)):
        return forces
    better = polished(search, rows, forces)
    return better if left(better) <= MODE_BETTER * before else forces


def _sharpened(
    search: Search, found: Found, forces: FloatArray, acting: list[FloatArray]
) -> tuple[FloatArray, list[FloatArray]]:
    """Return forces with friction exactly against the sliding, and the edges that may act.

    Where friction could not be turned, they are those that were given.
    """
    letters = "".join(one.letter for one in found.letters)
    if all(one.item < 0 for one in found.letters):
        return forces, acting
    mode = Sliding(search.touching, search.pyramids, letters, search.of_forces, search.motion[:, -1])
    exact = sharpened(mode, forces)
    return (forces, acting) if exact is None else (exact.forces, exact.edges)


def _each_once(
    found: list[tuple[SpatialMode, Found | None]],
) -> list[tuple[SpatialMode, Found | None]]:
    kept: list[tuple[SpatialMode, Found | None]] = []
    for mode, one in found:
        if not any(are_the_same(mode, other) for other, _ in kept):
            kept.append((mode, one))
    return kept
