"""How far an applied wrench is from leaving a mode in which contacts at rest begin to slide.

Each way in which they slide together has a convex cone of wrenches (`wrench_sets`), and the wrenches of the
mode are the union of these cones. The search starts in a cone that contains the wrench, and crosses
boundaries in the order of their distances. Just behind a boundary the mode either ends, or goes on in a cone
to which the whole boundary belongs. The friction pyramids keep their orientation meanwhile.

The margin is NaN where only a part of what lies behind a boundary belongs to the mode, which happens where
loads are shared in many ways. It is NaN too where more than `MAX_BEGINNING` contacts begin to slide, and for
contacts at rest of a body that turns.
"""

from __future__ import annotations

import contextlib
import copy
import heapq
import itertools
import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.letters import STAYS
from contact_dynamics.contact_modes.spatial.answer import found_by
from contact_dynamics.contact_modes.spatial.cone import nearest_sum
from contact_dynamics.contact_modes.spatial.problem import search_of
from contact_dynamics.contact_modes.spatial.wrenches import Way, distinct, supports, wrench_generators
from contact_dynamics.errors import TooLargeError
from contact_dynamics.rigid_body.body import mean_radius_of_gyration
from contact_dynamics.tolerances import ALONG_BOUNDARY, BEHIND_BOUNDARY, ON_BOUNDARY, ROW_TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Iterator

    from contact_dynamics.contact_modes.spatial.problem import SpatialCase
    from contact_dynamics.contact_modes.spatial.search import Search
    from contact_dynamics.validation import FloatArray

MAX_PROBES: Final = 64
"""So many boundaries are looked behind by a search for modes, of some 10 ms each, before the margin counts as
unknown. Most lead to a cone that is known or next to one, which takes less."""

MAX_BEGINNING: Final = 4
"""The largest number of contacts that begin to slide. More of them have too many ways to go through."""


class UnionMargin(NamedTuple):
    """How far a wrench is from leaving a mode, and where it would.

    Attributes:
        margin: N, in the metric. It is infinite where no wrench leaves the mode, and NaN where it is unknown.
        way: (6,), unit, the direction of the least change, in the metric.
        beyond: The consistent modes just behind the boundary; None if there is none, or if it is unknown.
    """

    margin: float
    way: FloatArray
    beyond: tuple[str, ...] | None


class _Cone(NamedTuple):
    """The wrenches that bring about one way of sliding."""

    ways: tuple[Way, ...]
    spans: FloatArray  # (k, 6), unit, whose positive sums they are
    sides: FloatArray  # (m, 6), unit, with which they have products >= 0

    def contains(self, spans: FloatArray) -> bool:
        """Return whether positive sums of (k, 6) unit wrenches are in the cone."""
        return float((self.sides @ spans.T).min()) >= -ON_BOUNDARY


class _Boundary(NamedTuple):
    """A side of a cone, and how far away it is."""

    distance: float  # in the margin's metric; a lower bound until the nearest point is known
    number: int  # which decides the order of equal distances
    ways: tuple[Way, ...]  # those of the cone
    outward: FloatArray  # (6,), unit
    spans: FloatArray  # (k, 6), whose positive sums make up the side
    nearest: FloatArray | None  # (6,), the point of the side that is nearest to the wrench


def union_margin(
    case: SpatialCase, search: Search, letters: str, metric: FloatArray, facets: int
) -> UnionMargin:
    """Return the distance to the nearest wrench outside a mode.

    Args:
        case: The body with its contacts.
        search: The search of that case.
        letters: Those of its touching contacts in a mode in which contacts at rest begin to slide.
        metric: (6,), m, by which a wrench is divided: ones, then the length that torques are divided by.
        facets: Edges of the friction pyramids.
    """
    beginning = begin_to_slide(search, letters)
    if case.motion.at_rest and not np.any(case.motion.turning) and beginning <= MAX_BEGINNING:
        union = _Union(case, search, letters, facets)
        # Each way of sliding counts here, and there can be more of them than the search accepts.
        with contextlib.suppress(TooLargeError):
            return _gone_through(union, case.motion.wrench / union.own / union.unit, union.own / metric)
    return UnionMargin(math.nan, np.zeros(6), None)


def begin_to_slide(search: Search, letters: str) -> int:
    """Return how many contacts at rest begin to slide with some letters."""
    return sum(
        letter == STAYS and one.frame is not None
        for letter, one in zip(letters, search.pyramids, strict=True)
    )


def _gone_through(union: _Union, wrench: FloatArray, stretch: FloatArray) -> UnionMargin:
    """Go outwards from a wrench, where ``stretch`` converts distances to the margin's metric."""
    unknown = UnionMargin(math.nan, np.zeros(6), None)
    numbers = itertools.count()
    cone = next(union.cones_at(wrench), None)
    if cone is None:
        return unknown
    heap = _boundaries(cone, wrench, stretch, numbers)
    heapq.heapify(heap)
    probes = 0
    while probes < MAX_PROBES:
        side = _next(heap, wrench, stretch)
        if side is None or side.nearest is None:
            return UnionMargin(math.inf, np.zeros(6), None)
        inner = side.spans.mean(axis=0)
        inner = inner / max(float(np.linalg.norm(inner)), ROW_TOLERANCE)
        way = ALONG_BOUNDARY * inner + BEHIND_BOUNDARY * side.outward
        behind = side.nearest + float(np.linalg.norm(wrench)) * way
        if union.is_in_known(side, behind):
            continue
        cone = union.next_to(side, behind)
        if cone is None:
            probes += 1
            holds, cone = union.searched(side, behind)
            if not holds:
                there = (side.nearest if side.distance > ROW_TOLERANCE else behind) - wrench
                there = there * stretch / float(np.linalg.norm(there * stretch))
                return UnionMargin(side.distance * union.unit, there, union.modes_at(behind))
            if cone is None:
                break
        for further in _boundaries(cone, wrench, stretch, numbers):
            heapq.heappush(heap, further)
    return unknown


class _Union:
    """The wrenches of a mode in which contacts begin to slide, under friction pyramids that stay."""

    def __init__(self, case: SpatialCase, search: Search, mode: str, facets: int) -> None:
        motion = case.motion
        gyration = mean_radius_of_gyration(motion.mass, motion.inertia)
        # Cones are stated in the body's own metric, whatever the metric of the margin.
        self.own = np.array([1.0, 1.0, 1.0, gyration, gyration, gyration])
        self.unit = motion.mass * motion.scale  # N; wrenches are divided by it, and by the metric
        self._case, self._search, self._mode, self._facets = case, search, mode, facets
        self._cones: dict[tuple[Way, ...], _Cone | None] = {}  # those that are known

    def cones_at(self, wrench: FloatArray) -> Iterator[_Cone | None]:
        """Yield the mode's cones that contain a wrench, or None for one without inner points."""
        for one in search_of(self._under(wrench), self._facets).ways_with(self._mode):
            ways = tuple(Way(of.letter, of.item) for of in one.letters)
            if "".join(of.letter for of in ways) == self._mode:
                yield self._cone(ways)

    def searched(self, side: _Boundary, behind: FloatArray) -> tuple[bool, _Cone | None]:
        """Return whether a wrench behind a boundary is in the mode, and a cone beyond it if any."""
        holds = False
        for cone in self.cones_at(behind):
            holds = True
            if cone is not None and cone.contains(side.spans):
                return True, cone
        return holds, None

    def is_in_known(self, side: _Boundary, behind: FloatArray) -> bool:
        """Return whether a cone that is known has a boundary and what lies behind it."""
        return any(
            one is not None and float((one.sides @ behind).min()) >= 0.0 and one.contains(side.spans)
            for one in self._cones.values()
        )

    def next_to(self, side: _Boundary, behind: FloatArray) -> _Cone | None:
        """Return a cone beyond a boundary, where one contact or two slide in the next sector, or None."""
        search = search_of(self._under(behind), self._facets)
        for ways in self._neighbours(side.ways):
            if ways not in self._cones and search.allows(self._mode, [of.item for of in ways]):
                cone = self._cone(ways)
                if cone is not None and cone.contains(side.spans):
                    return cone
        return None

    def _neighbours(self, ways: tuple[Way, ...]) -> Iterator[tuple[Way, ...]]:
        begins = [i for i, of in enumerate(ways) if of.item >= 0]
        for number in (1, 2):
            for chosen in itertools.combinations(begins, number):
                for steps in itertools.product((1, -1), repeat=number):
                    beside = list(ways)
                    for i, step in zip(chosen, steps, strict=True):
                        item = (ways[i].item + step) % (2 * len(self._search.pyramids[i].edges))
                        beside[i] = ways[i]._replace(item=item)
                    yield tuple(beside)

    def modes_at(self, wrench: FloatArray) -> tuple[str, ...]:
        """Return the letters of all modes that a wrench brings about."""
        case = self._under(wrench)
        found = found_by(case, search_of(case, self._facets), sharpen=True)
        return tuple(mode.mode for mode in found)

    def _under(self, wrench: FloatArray) -> SpatialCase:
        """Return the case under another wrench, with the friction pyramids that it has."""
        motion = copy.copy(self._case.motion)
        motion.wrench = wrench * self.own * self.unit
        force, torque = motion.wrench[:3], motion.wrench[3:]
        motion.free = np.concatenate([force / motion.mass, np.linalg.solve(motion.inertia, torque)])
        return self._case._replace(motion=motion)

    def _cone(self, ways: tuple[Way, ...]) -> _Cone | None:
        """Return the wrenches of a way of sliding, or None if they have no inner points."""
        if ways not in self._cones:
            generators = wrench_generators(self._case, self._search, ways, self.own)
            positive, zero = (_unit(of[:, :6]) for of in supports(generators))
            rays, lines = _unit(generators.rays[:, :6]), generators.lines[:, :6]
            spans = np.vstack([rays, lines, -lines])
            self._cones[ways] = None if len(zero) else _Cone(ways, spans, distinct(positive))
        return self._cones[ways]


def _next(heap: list[_Boundary], wrench: FloatArray, stretch: FloatArray) -> _Boundary | None:
    """Take the nearest boundary with its nearest point, or None if there are no more boundaries."""
    while heap:
        side = heapq.heappop(heap)
        if side.nearest is not None:
            return side
        nearest = nearest_sum(side.spans * stretch, wrench * stretch)[0] @ side.spans
        distance = float(np.linalg.norm((nearest - wrench) * stretch))
        heapq.heappush(heap, side._replace(distance=distance, nearest=nearest))
    return None


def _boundaries(
    cone: _Cone, wrench: FloatArray, stretch: FloatArray, numbers: itertools.count[int]
) -> list[_Boundary]:
    found = []
    for inward in cone.sides:
        tight = cone.spans[np.abs(cone.spans @ inward) <= ON_BOUNDARY]
        distance = abs(float(inward @ wrench)) / float(np.linalg.norm(inward / stretch))
        found.append(_Boundary(distance, next(numbers), cone.ways, -inward, tight, None))
    return found


def _unit(rows: FloatArray) -> FloatArray:
    sizes = np.linalg.norm(rows, axis=1)
    found: FloatArray = rows[sizes > ROW_TOLERANCE] / sizes[sizes > ROW_TOLERANCE, None]
    return found
