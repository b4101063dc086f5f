# SPDX-License-Identifier: Apache-2.0
"""How far an applied wrench in space is from leaving its contact modes, and into which ones it would.

The applied wrenches of a mode are a convex set in R^6 if no contact at rest begins to slide, or if those that
do can slide in one direction only. The margin is the distance to the nearest boundary in a stated metric, as
in the plane. Where contacts stick, the boundaries of pyramids inside their round cones (`wrenches`) come
first, which are the extreme rays of the dual cone. From the nearest of them, steps lead to boundaries of the
round cones: a wrench behind the boundary is projected on the set (`RoundSum`), which gives a boundary that is
no farther. A nearer one would have to lie outside of the pyramids.

Other modes in which contacts at rest begin to slide have the margins of `margins_of_sliding`.

A mode that the wrench does not bring about has a reason. A string of letters s (separates) and c (stays,
sticking or sliding) is rejected if none of its modes is consistent. Where nothing that stays has friction to
choose, the forces that it needs are known, and so is what contradicts it: a contact pulls, or one that should
separate penetrates. Otherwise the reason is how far the applied wrench is from those under which some forces
inside the friction cones let the contacts stay and separate like that: the least change in |f|^2 + |torque /
length|^2. Which way friction acts is left open, so that no smaller change brings the string about, and a
larger one may be needed.

Where a string is consistent, this does not say why it sticks rather than slides, or slides one way rather
than another. Where loads are shared, the reason would differ from one sharing to the next.
"""

from __future__ import annotations

import copy
import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, cast

import numpy as np

from contact_dynamics.contact_modes.letters import STAYS, STICKS, margin_in_words
from contact_dynamics.contact_modes.result import ModeVerdict, Refusal, RefusedMode, check_length
from contact_dynamics.contact_modes.spatial.answer import evidence_of, spatial_contact_modes, verdict_of
from contact_dynamics.contact_modes.spatial.exact_modes import letters_of
from contact_dynamics.contact_modes.spatial.kinematic import spatial_kinematic_modes
from contact_dynamics.contact_modes.spatial.margins_of_sliding import (
    directions_of,
    least_change,
)
from contact_dynamics.contact_modes.spatial.problem import (
    FRICTION_FACETS,
    MAX_EDGES,
    SpatialCase,
    search_of,
    spatial_case,
)
from contact_dynamics.contact_modes.spatial.wrenches import (
    HEIGHT_WEIGHT,
    Way,
    supports,
    with_round_cones,
    wrench_generators,
)
from contact_dynamics.records import Record
from contact_dynamics.tolerances import (
    BEYOND_MARGIN,
    MARGIN_SETTLED,
    NO_DISTANCE,
    ON_BOUNDARY,
    ROW_TOLERANCE,
    STEP_BEHIND,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes.result import ResponseMode, SpatialModeAnswer
    from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem
    from contact_dynamics.contact_modes.spatial.search import Search
    from contact_dynamics.contact_modes.spatial.wrenches import RoundSum
    from contact_dynamics.validation import FloatArray

_FEW_FACETS: Final = 4
"""The number of edges of a pyramid where contacts are many."""

_MAX_STARTS: Final = 4
"""Boundaries of the pyramids from which steps to boundaries of the round cones start."""

_MAX_STEPS: Final = 20
"""Steps from one of them. Three are enough where the nearest boundary is not nearly a sphere about the
wrench."""

_APART: Final = 0.9
"""The cosine above which two boundaries count as neighbours, so that steps from one of them are enough."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SpatialModeMargin(Record):
    """Smallest change of the applied wrench that ends a spatial mode, and the modes that follow.

    Attributes:
        mode: One letter for each contact.
        margin: N, size of the smallest change that leaves the mode: the root of |f|^2 + |torque / length|^2.
            It is infinite if no change leaves the mode, and NaN if it is unknown (`spatial_mode_margins`).
        length: m, the length in that metric.
        change_W: (6,), the smallest change: force, N, and torque about the centre of mass, N m, world axes.
            It is zero if there is none.
        verdict_beyond: Verdict just beyond the boundary, or the present verdict if there is no boundary.
        modes_beyond: Letters of the consistent modes there, each listed once.
    """

    mode: str
    margin: float
    length: float
    change_W: FloatArray
    verdict_beyond: ModeVerdict
    modes_beyond: tuple[str, ...]

    def in_short(self) -> str:
        """Return the mode, the change of the wrench that ends it, and the modes that follow."""
        words = margin_in_words(self.mode, self.margin, self.modes_beyond)
        return f"{type(self).__name__}: {words} (change_W in N and N m)"


def spatial_mode_margins(
    problem: SpatialContactProblem,
    answer: SpatialModeAnswer | None = None,
    *,
    margin_length: float | None = None,
) -> tuple[SpatialModeMargin, ...]:
    """Return the margin of the wrench in each of its consistent modes (`plane_or_space.mode_margins`).

    They do not depend on the problem's ``friction_facets``.

    A margin is exact where no contact sticks or begins to slide. Where contacts stick, a boundary is at the
    margin, and none is nearer than it would be if friction were smaller by 1 - cos(pi / 8), or by
    1 - cos(pi / 4) if more than 16 contacts have friction. Where contacts begin to slide in directions that
    depend on the wrench, the margin is proven from both sides: no smaller change leaves the mode, and behind
    the boundary it is not consistent. Otherwise it is NaN: if the body moves already, if other contacts
    stick, if several modes are consistent and contacts share loads, if contacts on a plane have more than
    `margins_of_sliding.MAX_CORNERS` corners, or if the mode goes on behind the boundary that was found.
    """
    length = check_length(margin_length, problem.body.mean_radius_of_gyration)
    if answer is None or answer.problem is not problem:
        answer = spatial_contact_modes(problem)
    if answer.approaching:
        return ()
    present = answer if problem.sharpen else spatial_contact_modes(replace(problem, sharpen=True))
    case = cast("SpatialCase", spatial_case(problem, within=answer.flush_within))
    few = np.count_nonzero(case.contacts.frictions[case.touching]) * FRICTION_FACETS <= MAX_EDGES
    search = search_of(case, FRICTION_FACETS if few else _FEW_FACETS)
    metric = np.array([1.0, 1.0, 1.0, length, length, length])
    size = float(np.linalg.norm(problem.wrench_W / metric))
    margins = []
    for mode in answer.modes:
        letters = letters_of(mode, case, search)
        known = directions_of(case, search, letters, mode.tangential_directions_W[case.touching])
        verdict, beyond = present.verdict, _letters(present.modes)
        if known is not None:
            margin, way = _nearest(case, search, letters, metric, known)
        else:
            regular = mode.forces_unique and mode.motion_unique
            alone = present.verdict == ModeVerdict.UNIQUE
            margin, way = least_change(case, search, letters, metric, alone=alone, regular=regular)
        if math.isfinite(margin):
            step = (margin + BEYOND_MARGIN * max(margin, size)) * way * metric
            there = _under(problem, answer.flush_within, problem.wrench_W + step)
            if known is None and (there[0] == ModeVerdict.UNDECIDED or mode.mode in there[1]):
                margin = math.nan
            else:
                verdict, beyond = there
        margins.append(
            SpatialModeMargin(
                mode=mode.mode,
                margin=margin,
                length=length,
                change_W=margin * way * metric if math.isfinite(margin) else np.zeros(6),
                verdict_beyond=verdict,
                modes_beyond=beyond,
            )
        )
    return tuple(margins)


def _under(
    problem: SpatialContactProblem, within: float, wrench_W: FloatArray
) -> tuple[ModeVerdict, tuple[str, ...]]:
    """Return the verdict under another wrench, and the letters of the modes that it brings about."""
    other = replace(problem, force_W=wrench_W[:3], torque_W=wrench_W[3:], sharpen=True)
    case = cast("SpatialCase", spatial_case(other, within=within))
    found = evidence_of(case, search_of(case, FRICTION_FACETS), sharpen=True)
    return verdict_of(found), _letters(found.modes)


def _letters(modes: Sequence[ResponseMode]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(mode.mode for mode in modes))


def _nearest(
    case: SpatialCase, search: Search, letters: str, metric: FloatArray, known: dict[int, FloatArray]
) -> tuple[float, FloatArray]:
    """Return the distance, N, to the mode's nearest boundary and the direction to it, (6,), in the metric.

    The distance is NaN if the wrench is outside. Contacts begin to slide in the ``known`` directions, (3,),
    and the metric, (6,), m, is ones, then the length that torques are divided by.
    """
    search = copy.copy(search)
    search.pyramids = [
        one._replace(edges=(of.normal - of.friction * known[i])[None, :], frame=None) if i in known else one
        for i, (one, of) in enumerate(zip(search.pyramids, search.touching, strict=True))
    ]
    motion = case.motion
    unit = motion.mass * motion.scale  # N; wrenches are divided by it, and torques by the length
    along = np.array([way @ search.touching[i].point for i, way in known.items()]).reshape(-1, 7)
    generators = wrench_generators(case, search, [Way(letter, -1) for letter in letters], metric, along)
    positive, zero = supports(generators)
    zero, positive = (rows[np.linalg.norm(rows[:, :6], axis=1) > ROW_TOLERANCE] for rows in (zero, positive))
    if len(zero):
        return 0.0, zero[0, :6] / float(np.linalg.norm(zero[0, :6]))
    if len(positive) == 0:
        return math.inf, np.zeros(6)
    target = np.append(motion.wrench / metric / unit, 1.0)
    sides = positive / np.linalg.norm(positive[:, :6], axis=1)[:, None]
    sides = sides[np.argsort(sides @ target, kind="stable")]
    sticking = [k for k, letter in enumerate(letters) if letter == STICKS]
    if sticking:
        every = with_round_cones(case, search, generators, sticking, metric)
        sides = _of_round_cones(every, generators.rays, sides, target)
    depth = float(sides[0] @ target)
    if depth < -ON_BOUNDARY:
        return math.nan, np.zeros(6)
    return max(0.0, depth) * unit, -sides[0, :6]


def _of_round_cones(every: RoundSum, rays: FloatArray, sides: FloatArray, target: FloatArray) -> FloatArray:
    """Return the nearest boundary of round cones, (1, 7), that is found from sides of their pyramids, (k, 7).

    The wrenches ``every`` have weighted heights, and their rays, (m, 7), their own. The nearest side comes
    first.
    """
    high = rays[rays[:, 6] > ROW_TOLERANCE]
    height = HEIGHT_WEIGHT if every.rays[:, 6].any() else 0.0
    least = STEP_BEHIND * float(np.linalg.norm(target[:6]))
    found, nearest = sides[:1], math.inf
    starts: list[FloatArray] = []
    for start in sides:
        if start @ target >= nearest or len(starts) == _MAX_STARTS:
            break
        if any(start[:6] @ other[:6] > _APART for other in starts):
            continue
        side, depth = start, math.inf
        for _ in range(_MAX_STEPS):
            inside = max(0.0, float(side @ target))
            behind = target.copy()
            behind[:6] -= (inside + max(inside, least)) * side[:6]
            behind[6] = height
            rest = every.rest(behind)[:6]
            size = float(np.linalg.norm(rest))
            if size == 0.0:
                break
            offset = float((high[:, :6] @ rest / high[:, 6]).max(initial=-math.inf)) / size
            further = np.append(-rest / size, offset)
            if not further @ target < depth * (1.0 - MARGIN_SETTLED):
                break
            side, depth = further, float(further @ target)
        starts.append(side)
        if depth < nearest:
            found, nearest = side[None, :], depth
    return found


def spatial_refused_modes(
    problem: SpatialContactProblem, answer: SpatialModeAnswer, *, margin_length: float | None = None
) -> tuple[RefusedMode, ...]:
    """Return each contacting and separating string without a consistent mode, in alphabetical order, and why.

    Where the forces are known, the refusal is `PENETRATES` or `PULLS` of a contact. Otherwise it is
    `NO_SOLUTION`, with the distance, N, of the applied wrench from those that can bring the string about. It
    is `WRONG_MOTION` with amount 0 where forces in the friction cones could do so, but would not oppose the
    sliding that they cause. There are none where a contact approaches.
    """
    tolerance = problem.velocity_tolerance
    length = check_length(margin_length, problem.body.mean_radius_of_gyration)
    case = spatial_case(problem)
    if not isinstance(case, SpatialCase):
        return ()
    search = search_of(case, FRICTION_FACETS)
    possible = [*(mode.mode for mode in answer.modes), *answer.undecided_modes]
    consistent = {letters.replace(STICKS, STAYS) for letters in possible}
    metric = np.array([1.0, 1.0, 1.0, length, length, length])
    return tuple(
        _known(case, search, string) or _short(case, search, string, metric)
        for string in spatial_kinematic_modes(problem.state, problem.contacts, velocity_tolerance=tolerance)
        if string not in consistent
    )


def _known(case: SpatialCase, search: Search, string: str) -> RefusedMode | None:
    """Return the refusal where the forces are known, or None where they are not."""
    motion, touching = case.motion, case.touching.tolist()
    staying = [k for k, i in enumerate(touching) if string[i] == STAYS]
    if any(len(search.pyramids[k].edges) > 1 for k in staying):
        return None
    normals = np.array([one.normal @ one.point for one in search.touching]).reshape(-1, 7)
    edges = np.zeros((3 * len(touching), len(staying)))
    for column, k in enumerate(staying):
        edges[3 * k : 3 * k + 3, column] = search.pyramids[k].edges[0]
    # Normal accelerations of those that stay, for unit normal forces, and without any.
    caused = normals[:, :6] @ search.of_forces @ edges
    without = normals[:, :6] @ search.motion[:, -1] + normals[:, 6]
    forces = np.zeros(0)
    if staying:
        sizes = np.linalg.svd(caused[staying], compute_uv=False)
        if sizes[-1] <= ROW_TOLERANCE * sizes[0]:
            return None
        forces = np.linalg.solve(caused[staying], -without[staying])
        if forces.min() < 0.0:
            amount = float(forces.min()) * motion.scale
            at = touching[staying[int(forces.argmin())]]
            return RefusedMode(mode=string, refusal=Refusal.PULLS, contact=at, amount=amount)
    normal = without + caused @ forces
    separating = [k for k in range(len(touching)) if k not in staying]
    lowest = min(separating, key=lambda k: float(normal[k]), default=None)
    if lowest is None:
        return None
    amount = min(0.0, float(normal[lowest]) * motion.scale)
    return RefusedMode(mode=string, refusal=Refusal.PENETRATES, contact=touching[lowest], amount=amount)


def _short(case: SpatialCase, search: Search, string: str, metric: FloatArray) -> RefusedMode:
    """Return the refusal with the distance of the wrench from those that can bring the string about."""
    ways = [Way(string[i], -1) for i in case.touching.tolist()]
    generators = wrench_generators(case, search, ways, metric)
    unit = case.motion.mass * case.motion.scale  # N; wrenches are divided by it
    target = np.append(case.motion.wrench / metric / unit, 1.0)
    round_ones = [
        k
        for k, (way, one) in enumerate(zip(ways, search.pyramids, strict=True))
        if way.letter == STAYS and one.frame is not None
    ]
    every = with_round_cones(case, search, generators, round_ones, metric)
    target[6] = HEIGHT_WEIGHT if every.rays[:, 6].any() else 0.0
    left = float(np.linalg.norm(every.rest(target)))
    if left <= NO_DISTANCE * float(np.linalg.norm(target[:6])):
        return RefusedMode(mode=string, refusal=Refusal.WRONG_MOTION, contact=-1, amount=0.0)
    return RefusedMode(mode=string, refusal=Refusal.NO_SOLUTION, contact=-1, amount=left * unit)
