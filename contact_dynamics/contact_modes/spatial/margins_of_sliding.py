# SPDX-License-Identifier: Apache-2.0
"""How far an applied wrench is from leaving a mode in which contacts at rest begin to slide in any direction.

Their directions depend on the wrench, so that the wrenches of the mode are not convex. But the ways out of
the mode are known: a contact that slides sticks, the load leaves all contacts but those on one side, or a
contact that separates touches again. The wrenches of each way out lie in a convex set, and the distance to
that is exact (`RoundSum`).

No wrench nearer than all these sets leaves the mode, if the body is at rest and has no other mode. Consider
contacts that give way a little. Whatever the wrench, the motions that solve the equations then add up to one,
if those that turn back under a growing load count negative (the degree of the map from motions to wrenches).
While the wrench changes, motions of the mode can be lost only where they meet motions of another mode, and
that happens only in these sets.

Contacts on a plane can share the load in many ways, and the mode may go on where some of them end. So only
some ways of sharing are followed: the plane's corners are parted into triangles, and one triangle at a time
carries the load, as if the other corners were a little too short. No parting gives a distance that is too
large, and the largest one counts.
"""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact_modes.letters import SEPARATES, STAYS, STICKS
from contact_dynamics.contact_modes.spatial.kinematic import cone_faces
from contact_dynamics.contact_modes.spatial.regions import flat_of, image_of
from contact_dynamics.contact_modes.spatial.wrenches import RoundSum, needed_wrenches, unit_rows
from contact_dynamics.numerics.linear_spaces import row_space
from contact_dynamics.tolerances import ROW_TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from contact_dynamics.contact_modes.spatial.problem import SpatialCase
    from contact_dynamics.contact_modes.spatial.search import Search
    from contact_dynamics.contact_modes.spatial.wrenches import Generators
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
) -> tuple[float, FloatArray]:
    """Return the least change of the wrench that may leave a mode, N, and its direction, (6,), in the metric.

    The change is NaN if it is unknown. The mode is ``alone`` if there are no others, and ``regular`` if its
    motion and its forces are unique. The metric is that of `margins`.
    """
    found, least = np.zeros(6), 0.0
    if _rests(case) and STICKS not in letters:
        ways_out = _WaysOut(case, search, letters, metric)
        known = alone or (regular and ways_out.is_determined)
        partings = ways_out.partings() if known else []
        stuck = [min((ways_out.sticking(one) for one in carriers), key=_size) for carriers in partings]
        for k in sorted(range(len(partings)), key=lambda k: -_size(stuck[k])):
            nearest = stuck[k]
            for rest in ways_out.others(partings[k]):
                nearest = min(nearest, rest, key=_size)
                if _size(nearest) <= least:
                    break
            if _size(nearest) > least:
                found, least = -nearest, _size(nearest)
    return (least, found / least) if least > 0.0 else (math.nan, found)


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
        self._normals = np.array([one.normal @ one.point for one in search.touching]).reshape(-1, 7)
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
        staying = self._normals[self._staying, :6]
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
        return self._rest(frames, self._normals[self._leaving], carriers, {})

    def others(self, partings: Sequence[tuple[int, ...]]) -> Iterator[FloatArray]:
        """Yield the wrench less the nearest one of each other way out, (6,) each."""
        for carriers in partings:
            yield from self._one_sticks(carriers)
        carrying = {i for carriers in partings for i in carriers}
        for side in self._sides:
            yield self._rest([], self._normals[self._leaving], sorted(side & carrying), {})
        for k in self._leaving:
            leaving = self._normals[[i for i in self._leaving if i != k]]
            yield self._rest([self._normals[[k]]], leaving, sorted(carrying), {})

    def _one_sticks(self, carriers: tuple[int, ...]) -> Iterator[FloatArray]:
        """Yield the wrench less the nearest one with which one sticks and others slide, (6,) each."""
        slides = {i for i in carriers if i in self._frames}
        leaving = self._normals[self._leaving]
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
        rows = np.vstack([self._normals[self._staying], *zero])
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
