# SPDX-License-Identifier: Apache-2.0
"""How far an applied wrench in space is from leaving its contact modes, and into which ones it would.

The applied wrenches of a mode are a convex set in R^6 if no contact at rest begins to slide, or if those that
do can slide in one direction only. The margin is the distance to the nearest boundary in a stated metric, as
in the plane. Where contacts stick, the boundaries of pyramids inside their round cones (`wrenches`) come
first, which are the extreme rays of the dual cone. From the nearest of them, steps lead to boundaries of the
round cones: a wrench behind the boundary is projected on the set (`RoundSum`), which gives a boundary that is
no farther. A nearer one would have to lie outside of the pyramids.

There are also modes in which contacts at rest begin to slide in any direction. Their directions depend on the
wrench, so that the wrenches of the mode are not convex. But the ways out of the mode are known: a contact
that slides sticks, the load leaves all contacts but those on one side, or a contact that separates touches
again. The wrenches of each way out lie in a convex set, and the distance to that is exact (`RoundSum`).

No wrench nearer than all these sets leaves the mode, if the body is at rest and has no other mode. Consider
contacts that give way a little. Whatever the wrench, the motions that solve the equations then add up to one,
if those that turn back under a growing load count negative (the degree of the map from motions to wrenches).
While the wrench changes, motions of the mode can be lost only where they meet motions of another mode, and
that happens only in these sets.

Contacts on a plane can share the load in many ways, and the mode may go on where some of them end. So only
some ways of sharing are followed: the plane's corners are parted into triangles, and one triangle at a time
carries the load, as if the other corners were a little too short. No parting gives a distance that is too
large, and the largest one counts.

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
import itertools
import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, cast

import numpy as np

from contact_dynamics.contact_modes.letters import SEPARATES, STAYS, STICKS, margin_in_words
from contact_dynamics.contact_modes.result import ModeVerdict, Refusal, RefusedMode, check_length
from contact_dynamics.contact_modes.spatial.answer import evidence_of, spatial_contact_modes, verdict_of
from contact_dynamics.contact_modes.spatial.exact_modes import letters_of
from contact_dynamics.contact_modes.spatial.kinematic import cone_faces, spatial_kinematic_modes
from contact_dynamics.contact_modes.spatial.problem import (
    FRICTION_FACETS,
    MAX_EDGES,
    SpatialCase,
    search_of,
    spatial_case,
)
from contact_dynamics.contact_modes.spatial.regions import flat_of, image_of
from contact_dynamics.contact_modes.spatial.wrenches import (
    HEIGHT_WEIGHT,
    RoundSum,
    Way,
    needed_wrenches,
    supports,
    unit_rows,
    with_round_cones,
    wrench_generators,
)
from contact_dynamics.numerics.linear_spaces import row_space
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
    from collections.abc import Iterator, Sequence

    from contact_dynamics.contact_modes.result import ResponseMode, SpatialModeAnswer
    from contact_dynamics.contact_modes.spatial.problem import SpatialCase, SpatialContactProblem
    from contact_dynamics.contact_modes.spatial.search import Search
    from contact_dynamics.contact_modes.spatial.wrenches import Generators, RoundSum
    from contact_dynamics.validation import FloatArray

MAX_CORNERS: Final = 8
"""The largest number of corners of a plane that may share a load. Each of them gives one more parting, and
each parting one more triangle, of five milliseconds."""


def begin_to_slide(search: Search, letters: str) -> list[int]:
    """Return the contacts at rest that begin to slide with some letters."""
    return [
        i
        for i, (letter, one) in enumerate(zip(letters, search.pyramids, strict=True))
        if letter == STAYS and one.frame is not None
    ]


def directions_of(
    case: SpatialCase, search: Search, letters: str, directions: FloatArray
) -> dict[int, FloatArray] | None:
    """Return in which directions contacts begin to slide, or None if that depends on the wrench."""
    turning = begin_to_slide(search, letters)
    if turning:
        if not _rests(case):
            return None
        rows = [
            of.point[:, :6] if letter == STICKS else (of.normal @ of.point[:, :6])[None, :]
            for of, letter in zip(search.touching, letters, strict=True)
            if letter != SEPARATES
        ]
        frames = np.array(
            [np.array(search.pyramids[i].frame) @ search.touching[i].point[:, :6] for i in turning]
        )
        if len(image_of(np.vstack(rows), frames).coordinates) > 1:
            return None
    return {i: directions[i] for i in turning}


def least_change(
    case: SpatialCase, search: Search, letters: str, metric: FloatArray, *, alone: bool, regular: bool
) -> tuple[float, FloatArray] | str:
    """Return the least change of the wrench that may leave a mode, N, and its direction, (6,), in the metric.

    If it is unknown, return the reason. The mode is ``alone`` if there are no others, and ``regular`` if its
    motion and its forces are unique. The metric is that of `margins`.
    """
    if not _rests(case):
        return "contacts begin to slide on a body or surface that moves"
    if STICKS in letters:
        return "some contacts begin to slide while others stick"
    ways_out = _WaysOut(case, search, letters, metric)
    if not (alone or (regular and ways_out.is_determined)):
        return "other modes are not excluded, and the contacts can share the load in several ways"
    partings = ways_out.partings()
    if not partings:
        return f"the contacts on a plane have more than {MAX_CORNERS} corners"
    found, least = np.zeros(6), 0.0
    stuck = [min((ways_out.sticking(one) for one in carriers), key=_size) for carriers in partings]
    for k in sorted(range(len(partings)), key=lambda k: -_size(stuck[k])):
        nearest = stuck[k]
        for rest in ways_out.others(partings[k]):
            nearest = min(nearest, rest, key=_size)
            if _size(nearest) <= least:
                break
        if _size(nearest) > least:
            found, least = -nearest, _size(nearest)
    return (least, found / least) if least > 0.0 else "no change is proven to be too small to end the mode"


def _size(vector: FloatArray) -> float:
    return math.sqrt(vector @ vector)


def _rests(case: SpatialCase) -> bool:
    return case.motion.at_rest and not np.any(case.motion.turning) and not np.any(case.sliding[case.touching])


class _WaysOut:
    """The ways out of a mode of a body at rest, and how far its wrench is from each."""

    def __init__(self, case: SpatialCase, search: Search, letters: str, metric: FloatArray) -> None:
        self._case, self._search, self._metric = case, search, metric
        self._target = case.motion.wrench / metric
        self._staying = [i for i, letter in enumerate(letters) if letter != SEPARATES]
        self._leaving = [i for i, letter in enumerate(letters) if letter == SEPARATES]
        self._turning = begin_to_slide(search, letters)
        points = [-case.motion.points[3 * i : 3 * i + 3] / metric for i in case.touching.tolist()]
        self._axes = np.array([of.normal @ p for of, p in zip(search.touching, points, strict=True)])
        self._edges = np.array([one.edges[0] @ p for one, p in zip(search.pyramids, points, strict=True)])
        self._leans = {
            i: search.touching[i].friction * (np.array(search.pyramids[i].frame) @ points[i])
            for i in self._turning
        }
        self._frames = {
            i: np.array(search.pyramids[i].frame) @ search.touching[i].point for i in self._turning
        }
        frames = np.array([self._frames[i][:, :6] for i in self._turning])
        staying = self._search.rising[self._staying, :6]
        self._flats = {i: flat_of(staying, frames, (k,)) for k, i in enumerate(self._turning)}
        rows = unit_rows(staying)
        self._rank = len(row_space(rows))
        self._needed: dict[tuple[bytes, bytes], Generators] = {}
        every = (1 << len(self._staying)) - 1
        proper = [face for face in cone_faces(rows) if face != every]
        self._sides = [
            frozenset(self._staying[k] for k in range(len(self._staying)) if face >> k & 1)
            for face in proper
            if not any(face != other and face & other == face for other in proper)
        ]

    @property
    def is_determined(self) -> bool:
        """Whether only one set of normal forces goes with each motion and wrench."""
        return self._rank == len(self._staying)

    def partings(self) -> list[list[tuple[int, ...]]]:
        """Return partings: sets of contacts one of which carries the load at a time."""
        normals = np.array([self._search.touching[i].normal for i in self._staying])
        if self.is_determined or float(np.abs(normals - normals[0]).max()) > ROW_TOLERANCE:
            return [[tuple(self._staying)]]
        if self._rank == 1:
            return [[(self._staying[0],)]]
        if self._rank == 2:
            return [[tuple(min(side) for side in self._sides)]]
        corners = self._corners(normals[0])
        found: list[list[tuple[int, ...]]] = []
        for turn in range(2 if len(corners) == 4 else len(corners)):  # four have two diagonals
            first, *others = corners[turn:] + corners[:turn]
            found.append([(first, one, other) for one, other in itertools.pairwise(others)])
        return found

    def _corners(self, normal: FloatArray) -> list[int]:
        """Return the corners of contacts on a plane, in their order around it; none if they are too many."""
        met: dict[frozenset[int], int] = {}
        for i in self._staying:
            sides = frozenset(k for k, side in enumerate(self._sides) if i in side)
            if len(sides) > 1:
                met.setdefault(sides, i)
        places = self._case.contacts.p_WC_W[self._case.touching]
        middle = places[list(met.values())].mean(axis=0)
        one = places[next(iter(met.values()))] - middle
        other = np.cross(normal, one)
        angles = {
            i: math.atan2(other @ (places[i] - middle), one @ (places[i] - middle)) for i in met.values()
        }
        return sorted(angles, key=angles.__getitem__) if len(angles) <= MAX_CORNERS else []

    def sticking(self, carriers: tuple[int, ...]) -> FloatArray:
        """Return the wrench less the nearest one with which all contacts that carry the load stick, (6,)."""
        frames = [self._frames[i] for i in carriers if i in self._frames]
        return self._rest(frames, self._search.rising[self._leaving], carriers, {})

    def others(self, partings: Sequence[tuple[int, ...]]) -> Iterator[FloatArray]:
        """Yield the wrench less the nearest one of each other way out, (6,) each."""
        for carriers in partings:
            yield from self._one_sticks(carriers)
        carrying = {i for carriers in partings for i in carriers}
        for side in self._sides:
            yield self._rest([], self._search.rising[self._leaving], sorted(side & carrying), {})
        for k in self._leaving:
            leaving = self._search.rising[[i for i in self._leaving if i != k]]
            yield self._rest([self._search.rising[[k]]], leaving, sorted(carrying), {})

    def _one_sticks(self, carriers: tuple[int, ...]) -> Iterator[FloatArray]:
        """Yield the wrench less the nearest one with which one sticks and others slide, (6,) each."""
        slides = {i for i in carriers if i in self._frames}
        leaving = self._search.rising[self._leaving]
        seen = {frozenset(slides)}
        for i in sorted(slides):
            flat = self._flats[i]
            moving = [j for k, j in enumerate(self._turning) if k not in flat.stuck]
            stuck = frozenset(slides.difference(moving))
            if stuck in seen:
                continue
            seen.add(stuck)
            if len(flat.image.coordinates) > 1:
                yield self._rest([self._frames[i]], leaving, carriers, {})
                continue
            (along,) = np.column_stack([flat.image.coordinates, [0.0]])
            for sign in (1.0, -1.0):
                ways = unit_rows(sign * flat.image.maps[:, :, 0])
                known = {j: way for j, way in zip(moving, ways, strict=True) if j in slides}
                yield self._rest([self._frames[i]], np.vstack([leaving, sign * along]), carriers, known)

    def _rest(
        self,
        zero: list[FloatArray],
        positive: FloatArray,
        carriers: Sequence[int],
        known: dict[int, FloatArray],
    ) -> FloatArray:
        """Return the wrench less the nearest one of some motions and of forces at carriers, (6,).

        Rows ``zero``, (k, 7) each, and the normals that stay vanish on the motions, and rows ``positive``,
        (k, 7), are not negative. Carriers have any force in their cones, or slide in ``known`` directions,
        (2,).
        """
        rows = np.vstack([self._search.rising[self._staying], *zero])
        key = (rows.tobytes(), positive.tobytes())
        if key not in self._needed:
            self._needed[key] = needed_wrenches(self._case, rows, positive, self._metric)
        needed = self._needed[key]
        lines = needed.lines[:, :6]
        rays = [needed.rays[:, :6], lines, -lines]
        rays += [self._edges[[i]] for i in carriers if i not in self._frames]
        rays += [(self._axes[i] - way @ self._leans[i])[None, :] for i, way in known.items()]
        round_ones = [i for i in carriers if i in self._frames and i not in known]
        leans = np.array([self._leans[i] for i in round_ones]).reshape(-1, 2, 6)
        return RoundSum(unit_rows(np.vstack(rays)), self._axes[round_ones], leans).rest(self._target)


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
        verdict_beyond: Verdict under a change that is larger by `BEYOND_MARGIN`, relative to the margin or to
            the wrench, whichever is larger. It is valid up to the next boundary. Within 1e-6 of the boundary,
            `contact_modes` may be UNDECIDED or still return the mode, because rounding hides slow motions.
            If there is no boundary, it is the present verdict.
        modes_beyond: Letters of the consistent modes there, each listed once.
        unknown: Reason why the margin is unknown. Empty unless the margin is NaN.
    """

    mode: str
    margin: float
    length: float
    change_W: FloatArray
    verdict_beyond: ModeVerdict
    modes_beyond: tuple[str, ...]
    unknown: str = ""

    def in_short(self) -> str:
        """Return the mode, the change of the wrench that ends it, and the modes that follow."""
        words = margin_in_words(self.mode, self.margin, self.modes_beyond, self.unknown)
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
    the boundary it is not consistent. Otherwise it is NaN, and ``unknown`` is the reason.
    """
    length = check_length(margin_length, problem.body.mean_radius_of_gyration)
    if answer is None or answer.problem is not problem:
        answer = spatial_contact_modes(problem)
    if answer.approaching:
        return ()
    present = answer if problem.sharpen else spatial_contact_modes(replace(problem, sharpen=True))
    case = cast("SpatialCase", spatial_case(problem, within=answer.flush_within))
    few = np.count_nonzero(case.contacts.holding_frictions[case.touching]) * FRICTION_FACETS <= MAX_EDGES
    search = search_of(case, FRICTION_FACETS if few else _FEW_FACETS)
    metric = np.array([1.0, 1.0, 1.0, length, length, length])
    size = float(np.linalg.norm(problem.wrench_W / metric))
    margins = []
    for mode in answer.modes:
        letters = letters_of(mode, case, search)
        known = directions_of(case, search, letters, mode.tangential_directions_W[case.touching])
        verdict, beyond = present.verdict, _letters(present.modes)
        if known is not None:
            found = _nearest(case, search, letters, metric, known)
        else:
            regular = mode.forces_unique and mode.motion_unique
            alone = present.verdict == ModeVerdict.UNIQUE
            found = least_change(case, search, letters, metric, alone=alone, regular=regular)
        margin, way, unknown = (math.nan, np.zeros(6), found) if isinstance(found, str) else (*found, "")
        if math.isfinite(margin):
            step = (margin + BEYOND_MARGIN * max(margin, size)) * way * metric
            there = _under(problem, answer.flush_within, problem.wrench_W + step)
            continues = mode.mode in there[1]
            if known is None and (continues or there[0] == ModeVerdict.UNDECIDED):
                further = "the mode continues" if continues else "whether the mode continues is undecided"
                margin, unknown = (
                    math.nan,
                    f"no change below {margin:.3g} N ends the mode, and {further} there",
                )
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
                unknown=unknown,
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
) -> tuple[float, FloatArray] | str:
    """Return the distance, N, to the mode's nearest boundary and the direction to it, (6,), in the metric.

    If it is unknown, return the reason. Contacts begin to slide in the ``known`` directions, (3,), and the
    metric, (6,), m, is ones, then the length that torques are divided by.
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
        if len(sides) == 0:
            far = np.eye(6, 7)
            if any(every.rest(way).any() for way in (*far, *-far)):
                return "no boundary of its round friction cones was found"
            return math.inf, np.zeros(6)
    depth = float(sides[0] @ target)
    if depth < -ON_BOUNDARY:
        return "rounding error puts the wrench outside of the mode"
    return max(0.0, depth) * unit, -sides[0, :6]


def _of_round_cones(every: RoundSum, rays: FloatArray, sides: FloatArray, target: FloatArray) -> FloatArray:
    """Return the nearest boundary of round cones, (1, 7), that is found from sides of their pyramids, (k, 7).

    It is (0, 7) if none is found. The wrenches ``every`` have weighted heights, and their rays, (m, 7), their
    own. The nearest side comes first.
    """
    high = rays[rays[:, 6] > ROW_TOLERANCE]
    height = HEIGHT_WEIGHT if every.rays[:, 6].any() else 0.0
    least = STEP_BEHIND * float(np.linalg.norm(target[:6]))
    found, nearest = sides[:0], math.inf
    starts: list[FloatArray] = []
    for start in sides:
        if start @ target >= nearest or len(starts) == _MAX_STARTS:
            break
        if any(start[:6] @ other[:6] > _APART for other in starts):
            continue
        side, depth, step = start, math.inf, least
        for _ in range(_MAX_STEPS):
            inside = max(0.0, float(side @ target))
            behind = target.copy()
            behind[:6] -= (inside + max(inside, step)) * side[:6]
            behind[6] = height
            rest = every.rest(behind)[:6]
            size = float(np.linalg.norm(rest))
            if size == 0.0:  # the round cones reach further than their pyramids
                if nearest < math.inf or depth < math.inf:
                    break
                step *= 4.0
                continue
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
    normals = search.rising
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
