# SPDX-License-Identifier: Apache-2.0
"""The contact modes of a body in space that are consistent with mechanics, with directions of sliding.

The model is that of the plane (lecture 26), with Coulomb's round cone. A contact that moves already slides in
a known direction, so that its friction is known exactly. For a contact at rest, a pyramid with a stated
number of edges stands for the cone. Its first edge opposes the tangential acceleration that the contact would
have without any contact force. On the pyramid, friction does the most it can against the sliding. A contact
that slides within the sector opposite to an edge has its force on that edge. A contact that slides along the
border of two sectors has its force on the side between their edges.

The letters are s (separates), f (sticks) and c (stays and slides); the sector or border belongs to the mode.
First the most likely mode is found (`likely_mode`). Often it is proven at once that it is alone
(`only_motion`). Otherwise all other modes are found or refuted (`completeness`). Only what this leaves
undecided takes a search for all modes of the pyramids (`search`), whose friction is then turned exactly
against the sliding (`exact_modes`). So the answer does not depend on the pyramids. One
contact at rest is solved exactly (`one_contact`), and round cones decide whether all contacts can stick
(`round_cones`).
A contact without friction has the letter c, whether it slides or not. A contact that sticks has static
friction, and one that slides or begins to slide has friction.

`spatial.margins` says how far the applied wrench is from other modes.
"""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING, Any, Final, NamedTuple, cast

import numpy as np

from contact_dynamics.contact_modes.letters import SPATIAL_LETTERS, STAYS, STICKS
from contact_dynamics.contact_modes.result import (
    SOME_MODE,
    ModeVerdict,
    ResponseMode,
    SpatialMode,
    SpatialModeAnswer,
    verdict_on,
)
from contact_dynamics.contact_modes.spatial.completeness import (
    ENOUGH_PROGRAMS,
    ENOUGH_PROGRAMS_OF_SEVERAL,
    FEW_PROGRAMS,
    MAX_PROGRAMS,
    Known,
    completed,
    has_none,
    staying_bits,
)
from contact_dynamics.contact_modes.spatial.exact_modes import (
    as_given,
    by_letters,
    each_once,
    is_exact,
    letters_of,
    narrowly,
    realised,
)
from contact_dynamics.contact_modes.spatial.likely_mode import likely_mode
from contact_dynamics.contact_modes.spatial.mode_with_forces import mode_with_forces, with_least_forces
from contact_dynamics.contact_modes.spatial.one_contact import modes_of_one
from contact_dynamics.contact_modes.spatial.only_motion import is_only_motion, rests_alone
from contact_dynamics.contact_modes.spatial.problem import (
    FRICTION_FACETS,
    SpatialCase,
    search_of,
    spatial_case,
)
from contact_dynamics.contact_modes.spatial.regions import ONE_BODY
from contact_dynamics.contact_modes.spatial.round_cones import (
    held_by_round_cones,
    hold_alone,
    polished,
    sticking,
)
from contact_dynamics.errors import TooLargeError, UndecidedError
from contact_dynamics.tolerances import (
    FEASIBLE,
    FLUSH,
    FLUSH_ROUGHLY,
    HIDDEN_BY_FORCES,
    NARROWLY,
    STRICT,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem
    from contact_dynamics.contact_modes.spatial.search import Search

_DOUBT: Final = "rounding decides whether some modes are consistent: contacts or normals are nearly the same"

_AT_REST: Final = "whether all contacts can stick together hangs on rounding"

_TURNED: Final = (
    "friction could not be turned against the sliding of {}, which holds with friction pyramids, and may not "
    "with Coulomb's round cones"
)

_MISSED: Final = "bounds on friction and sliding could not tell whether there are further modes {}"

_UNENDED: Final = (
    "the search for further modes did not end. There may be modes in which contacts stay as in {}, sticking "
    "or sliding, and others"
)

_ENDLESS: Final = "the search for further modes did not end"

_NARROW: Final = "rounding decides whether modes hold that hold under nearly the same load: {}"

_NOT_REFUTED: Final = "no mode was found, and it could not be shown that there is none"

_FREE: Final = 3
"""Components of the motion with which a contact can move in every direction."""


class Evidence(NamedTuple):
    """The modes of a case, and what could not be decided about them."""

    modes: list[ResponseMode]  # the modes
    undecided: str  # what could not be decided, and why. It is empty where everything was decided.
    undecided_modes: tuple[str, ...] = ()  # letters that hold with pyramids, and may not with round cones


def spatial_contact_modes(problem: SpatialContactProblem) -> SpatialModeAnswer:
    """Return the verdict on a contact set in space and all consistent modes.

    Raises:
        TooLargeError: more contacts touch than `spatial.problem.MAX_DYNAMIC_CONTACTS`. Or the search takes
            more trials than `search.MAX_EXAMINED`, which happens where hundreds of sectors are
            consistent and ``sharpen`` is false.
    """
    found = considered(
        partial(_case_within, problem),
        facets=FRICTION_FACETS if problem.sharpen else problem.friction_facets,
        sharpen=problem.sharpen,
    )
    return SpatialModeAnswer(
        modes=tuple(cast("list[SpatialMode]", shown_modes(found))),
        friction_facets=problem.friction_facets,
        problem=problem,
        **answer_fields(found, problem.velocity_tolerance),
    )


def _case_within(problem: SpatialContactProblem, within: float) -> SpatialCase | tuple[int, ...]:
    return spatial_case(problem, within=within)


class Considered(NamedTuple):
    """What is known of a problem none of whose contacts approaches."""

    case: SpatialCase  # the case whose modes are sought
    search: Search  # its search
    found: Evidence  # its modes
    within: float  # how far its contacts may differ from the given ones, as `SpatialModeAnswer` has it


def considered(
    case_within: Callable[[float], SpatialCase | tuple[int, ...]],
    *,
    facets: int = FRICTION_FACETS,
    sharpen: bool = True,
) -> Considered | tuple[int, ...]:
    """Return the modes of a problem, or the contacts that approach.

    Contacts that are flush but for noise are taken as flush: to within `FLUSH` always, and to within
    `FLUSH_ROUGHLY` if it is undecided otherwise. ``case_within`` gives the case whose contacts may be moved
    so far to be flush, or the contacts that approach (`problem.spatial_case`).

    Raises:
        UndecidedError: a matrix is singular but for rounding, because lengths, masses or moments differ by
            many orders of magnitude.
    """
    rough = case_within(FLUSH_ROUGHLY)
    if not isinstance(rough, SpatialCase):
        return rough
    tried: list[Considered] = []
    try:
        for case, within, hurried in _cases(case_within, rough):
            search = search_of(case, facets, from_rest=case.motion.of_body)
            found = evidence_of(case, search, sharpen=sharpen, hurried=hurried)
            tried.append(Considered(case, search, found, within))
            if not found.undecided:
                return tried[-1]
    except np.linalg.LinAlgError:
        raise UndecidedError(
            "the problem's lengths, masses or moments differ so much that rounding error prevents a decision"
        ) from None
    return tried[-1]


def _cases(
    case_within: Callable[[float], SpatialCase | tuple[int, ...]], rough: SpatialCase
) -> Iterator[tuple[SpatialCase, float, bool]]:
    """Yield the cases to consider, how far they may be from the given one, and whether to give up soon."""
    if rough.given is None:
        yield rough, 0.0, False
        return
    near = cast("SpatialCase", case_within(FLUSH))
    alike = np.array_equal(near.contacts.normals_W, rough.contacts.normals_W) and np.array_equal(
        near.contacts.p_WC_W, rough.contacts.p_WC_W
    )
    yield near, 0.0 if near.given is None else FLUSH, not alike
    if not alike:
        yield rough, FLUSH_ROUGHLY, False
    yield rough.given, 0.0, False


def evidence_of(
    case: SpatialCase,
    search: Search,
    *,
    sharpen: bool,
    beside_rest: bool = False,
    hurried: bool = False,
) -> Evidence:
    """Return the modes of a case, of Coulomb's cones if friction is sharpened, or of friction pyramids."""
    if sharpen:
        found = evidenced(case, search, beside_rest=beside_rest, hurried=hurried)
    else:
        found = Evidence(found_by(case, search, sharpen=False), _DOUBT if search.doubtful else "")
        if not (found.modes or found.undecided or search.at_rest or has_none(search)):
            found = found._replace(undecided=_NOT_REFUTED)
    if not found.modes and not found.undecided and search.at_rest:
        found = found._replace(undecided=SOME_MODE)
    return found


def shown_modes(found: Considered | tuple[int, ...]) -> list[ResponseMode]:
    """Return the modes that were found, with their least forces, at the contacts that were given."""
    if not isinstance(found, Considered):
        return []
    return [as_given(found.case, with_least_forces(found.case, mode)) for mode in found.found.modes]


def answer_fields(found: Considered | tuple[int, ...], velocity_tolerance: float) -> dict[str, Any]:
    """Return what an answer contains beside its problem and its modes."""
    fields: dict[str, Any] = {"velocity_tolerance": velocity_tolerance}
    if not isinstance(found, Considered):
        return {**fields, "verdict": ModeVerdict.IMPACT, "approaching": found, "examined": 0}
    return {
        **fields,
        "verdict": verdict_of(found.found),
        "approaching": (),
        "examined": found.search.examined,
        "undecided": found.found.undecided,
        "undecided_modes": found.found.undecided_modes,
        "flush_within": found.within,
    }


def verdict_of(found: Evidence) -> ModeVerdict:
    """Return the verdict that follows from evidence about contacts that do not approach."""
    return ModeVerdict.UNDECIDED if found.undecided else verdict_on(found.modes)


def evidenced(
    case: SpatialCase, search: Search, *, beside_rest: bool = False, hurried: bool = False
) -> Evidence:
    """Return all modes of a case, with Coulomb's round cones.

    It gives up soon if ``hurried``. If ``beside_rest``, it is enough to know if a body at rest has another
    mode than rest.
    """
    found = _sought(case, search, beside_rest=beside_rest, hurried=hurried)
    found = found._replace(modes=[_with_clear_motion(case, mode) for mode in found.modes])
    rounded = [mode.mode for mode in found.modes if _penetrates(case, mode)]
    if rounded:
        kept = [mode for mode in found.modes if not _penetrates(case, mode)]
        names = tuple(dict.fromkeys((*rounded, *found.undecided_modes)))
        found = Evidence(kept, found.undecided or _DOUBT, names)
    exact = [mode for mode in found.modes if is_exact(mode)]
    others = tuple(dict.fromkeys(mode.mode for mode in found.modes if not is_exact(mode)))
    turned = _TURNED.format(", ".join(others)) if others else ""
    letters = tuple(dict.fromkeys((*others, *found.undecided_modes)))
    if not exact and not others:
        return _narrow(case, search, found, hurried=hurried)
    exact.sort(key=lambda mode: [SPATIAL_LETTERS.index(letter) for letter in mode.mode])
    return Evidence(exact, found.undecided or turned, letters)


def _with_clear_motion(case: SpatialCase, mode: ResponseMode) -> ResponseMode:
    """Return a mode with the motion of its least forces, if others are so large that rounding hides it."""
    if _rounding(case, mode) <= HIDDEN_BY_FORCES * case.motion.scale:
        return mode
    least = with_least_forces(case, mode)
    return mode_with_forces(
        case,
        case.of_touching(mode.mode),
        case.own_forces(least.contact_forces_W),
        forces_unique=mode.forces_unique,
        motion_unique=mode.motion_unique,
    )


def _rounding(case: SpatialCase, mode: ResponseMode) -> float:
    """Return by how much rounding of forces may change the accelerations of contacts that they cause."""
    motion = case.motion
    caused = np.abs(motion.points) @ (np.abs(motion.of_forces) @ np.abs(mode.contact_forces_W).ravel())
    return FEASIBLE * float(caused.max(initial=0.0))


def _penetrates(case: SpatialCase, mode: ResponseMode) -> bool:
    """Return whether contacts penetrate by more than rounding, or rounding hides whether they do."""
    rounding = _rounding(case, mode)
    if rounding > case.motion.scale:
        return True
    rising = np.sum(mode.contact_accelerations_W * case.contacts.normals_W, axis=1)[case.touching]
    if rising.min(initial=0.0) >= -STRICT * case.motion.scale:
        return False
    return bool(
        rounding > HIDDEN_BY_FORCES * case.motion.scale
        or rising.min() < -STRICT * case.motion.scale - rounding
    )


def _narrow(case: SpatialCase, search: Search, found: Evidence, *, hurried: bool) -> Evidence:
    """Return the modes that hold so narrowly that the search found none, or what is known of them."""
    if hurried:  # noise of contacts that are nearly flush may leave no mode
        return found._replace(undecided=found.undecided or _NOT_REFUTED)
    ended = search.examined <= search.most_examined  # otherwise searches for modes nearby do not end either
    if not ended or (not (found.undecided or search.at_rest) and has_none(search)):
        return found
    near = narrowly(search)
    if near.modes:
        modes = [
            mode_with_forces(
                case, one.letters, one.forces, forces_unique=one.alone, motion_unique=True, slowest=NARROWLY
            )
            for one in near.modes
        ]
        if any(_penetrates(case, mode) for mode in modes):
            return found._replace(undecided=found.undecided or _NOT_REFUTED)
        alone = len(near.modes) == 1 and is_only_motion(search, near.modes[0].forces)
        return Evidence(modes, "") if alone or not found.undecided_modes else found._replace(modes=modes)
    if not near.nearby:
        return found._replace(undecided=found.undecided or _NOT_REFUTED)
    names = found.undecided_modes or tuple(case.of_all(letters) for letters in near.nearby)
    return Evidence([], found.undecided or _NARROW.format(", ".join(names)), names)


def _sought(case: SpatialCase, search: Search, *, beside_rest: bool, hurried: bool) -> Evidence:
    """Return the modes of a case, also those whose friction could not be turned."""
    resting = _with_rest(case, search, Evidence([], "")) if rests_alone(search) else None
    if resting is not None and resting.modes:
        return resting
    slides = bool(np.any(case.sliding[case.touching]))
    if (
        not slides
        and len(case.touching) == 1
        and search.touching[0].holding > 0.0
        and search.freedoms >= _FREE
    ):
        return Evidence(_of_one_contact(case, search), "")
    likely = likely_mode(search)
    modes = [] if likely is None else [_mode_of(case, likely)]
    enough = ENOUGH_PROGRAMS if search.freedoms <= ONE_BODY else ENOUGH_PROGRAMS_OF_SEVERAL
    most = FEW_PROGRAMS if hurried else enough
    found = _with_others(case, search, modes, beside_rest=beside_rest, most=most)
    if hurried or (found.modes and not found.undecided):
        return found
    return _searched(case, search, found, beside_rest=beside_rest)


def _searched(case: SpatialCase, search: Search, found: Evidence, *, beside_rest: bool) -> Evidence:
    """Return the modes of a case, with those that a search of the pyramids finds beside known ones."""
    known = all(one.frame is None for one in search.pyramids)
    undecided = {staying_bits(case.of_touching(letters)) for letters in found.undecided_modes}
    if search.completed and found.modes and not known:
        search.staying = sorted(undecided)  # others are decided
    try:
        kept = found_by(case, search, sharpen=True)
    except TooLargeError:
        return found._replace(undecided=found.undecided or _ENDLESS)
    if known:
        return Evidence(kept, _DOUBT if search.doubtful else "")
    every = each_once(case, [*by_letters(case, search, kept), *found.modes])
    further = each_once(case, [*found.modes, *every])[len(found.modes) :]
    if not further and (search.completed or not found.undecided):
        return found
    among = None
    if search.completed:
        among = sorted(undecided | {staying_bits(case.of_touching(mode.mode)) for mode in further})
    open_ones = [case.of_touching(letters) for letters in found.undecided_modes] if search.completed else []
    return _with_others(
        case, search, every, beside_rest=beside_rest, most=MAX_PROGRAMS, among=among, open_ones=open_ones
    )


def _with_others(
    case: SpatialCase,
    search: Search,
    modes: list[ResponseMode],
    *,
    beside_rest: bool,
    most: int,
    among: list[int] | None = None,
    open_ones: Sequence[str] = (),
) -> Evidence:
    """Return modes that were found, with all others.

    ``among`` may limit the search to some choices of contacts that stay. An earlier one has left
    ``open_ones`` undecided.
    """
    known = Evidence(modes, "")
    if _is_alone(case, search, modes):
        return Evidence([mode for mode in modes if is_exact(mode)], "")
    if not np.any(case.sliding[case.touching]):
        known = _with_rest(case, search, known)
        if beside_rest and not all(_all_stick(case, search, mode) for mode in known.modes if is_exact(mode)):
            return known
        if _is_alone(case, search, known.modes):
            return Evidence([mode for mode in known.modes if is_exact(mode)], "")
    found = _completed(case, search, known.modes, most=most, among=among, open_ones=open_ones)
    return found._replace(undecided=found.undecided or known.undecided)


def _is_alone(case: SpatialCase, search: Search, modes: list[ResponseMode]) -> bool:
    """Return whether it is proven that a mode that was found has no others beside it."""
    exact = [mode for mode in modes if is_exact(mode)]
    if len(exact) != 1 or not exact[0].motion_unique:
        return False
    return is_only_motion(search, case.own_forces(exact[0].contact_forces_W))


def _mode_of(case: SpatialCase, known: Known) -> ResponseMode:
    return mode_with_forces(
        case, known.letters, known.forces, forces_unique=known.forces_unique, motion_unique=known.alone
    )


def _completed(
    case: SpatialCase,
    search: Search,
    found: list[ResponseMode],
    *,
    most: int,
    among: list[int] | None,
    open_ones: Sequence[str],
) -> Evidence:
    """Return the modes that were found and are exact, and those that were missed."""
    exact = [mode for mode in found if is_exact(mode)]
    known = [
        Known(
            letters_of(mode, case, search),
            case.own_forces(mode.contact_forces_W),
            alone=mode.motion_unique,
        )
        for mode in exact
    ]
    missed = completed(search, known, most=most, among=among, open_ones=open_ones)
    exact += [_mode_of(case, one) for one in missed.further]
    names = [case.of_all(letters) for letters in missed.undecided]
    undecided = _MISSED.format(", ".join(names)) if names else ""
    if missed.unended:
        open_ones = case.of_all(missed.unended)
        undecided = _UNENDED.format(open_ones)
        names += [*(mode.mode for mode in found if not is_exact(mode)), open_ones]
    return Evidence(each_once(case, exact), undecided, tuple(dict.fromkeys(names)))


def found_by(case: SpatialCase, search: Search, *, sharpen: bool) -> list[ResponseMode]:
    """Return the modes of a case with friction pyramids, each once if friction is sharpened.

    Two modes are the same if their letters and their motions are. Where the motion with some letters is not
    unique, the mode represents them whose slowest contact that begins to slide is fastest: rounding limits
    the direction of very slow sliding.
    """
    found = [realised(case, search, one) for one in search.run(grouped=sharpen)]
    if not sharpen:
        return found
    return each_once(case, sorted(found, key=lambda mode: _unique_and_slow(case, mode)))


def _unique_and_slow(case: SpatialCase, mode: ResponseMode) -> tuple[bool, float]:
    """Return whether a mode's motion is unique, and if not, how slow the slowest beginning of sliding is."""
    if mode.motion_unique:
        return True, 0.0
    slides = [i for i, letter in enumerate(mode.mode) if letter == STAYS and not case.sliding[i].any()]
    points, normals = mode.contact_accelerations_W[slides], case.contacts.normals_W[slides]
    across = points - np.sum(points * normals, axis=1)[:, None] * normals
    return False, -float(np.linalg.norm(across, axis=1).min(initial=math.inf))


def _of_one_contact(case: SpatialCase, search: Search) -> list[ResponseMode]:
    """Return all modes of one contact at rest."""
    (contact,) = search.touching
    G = (
        case.motion.points[3 * case.touching[0] :][:3]
        @ case.motion.of_forces[:, 3 * case.touching[0] :][:, :3]
    )
    b = case.motion.points_free[case.touching[0]] / case.motion.scale
    return [
        mode_with_forces(case, letter, force[None, :], forces_unique=True, motion_unique=True)
        for letter, force in modes_of_one(G, b, contact.normal, contact.friction, contact.holding)
    ]


def _all_stick(case: SpatialCase, search: Search, mode: ResponseMode) -> bool:
    return all(
        mode.mode[i] == STICKS or (contact.holding == 0.0 and mode.mode[i] == STAYS)
        for i, contact in zip(case.touching.tolist(), search.touching, strict=True)
    )


def _with_rest(case: SpatialCase, search: Search, found: Evidence) -> Evidence:
    """Return the modes, with the one in which all contacts stick if forces in the round cones allow it."""
    letters = "".join(STICKS if one.holding > 0.0 else STAYS for one in search.touching)
    undecided = found.undecided
    still = [mode for mode in found.modes if _all_stick(case, search, mode)]
    if len(still) > 1:  # the forces that hold a body form a convex set, and are one mode
        found = found._replace(modes=[mode for mode in found.modes if mode not in still[1:]])
    if not still:
        rows = sticking(search)
        held = held_by_round_cones(search, rows)
        if held.forces is not None:
            own = polished(search, rows, held.forces)
            unique = hold_alone(search, own)
            mode = mode_with_forces(case, letters, own, forces_unique=unique, motion_unique=True)
            return found._replace(modes=[*found.modes, mode])
        if not held.certain:
            undecided = _AT_REST
    return found._replace(undecided=undecided)
