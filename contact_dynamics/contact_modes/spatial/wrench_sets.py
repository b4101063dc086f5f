# SPDX-License-Identifier: Apache-2.0
"""The applied wrenches of each contact mode in space: lecture 26's map of modes, in R^6.

For letters s and f, and for contacts that slide already, the wrenches of a mode are one convex polyhedron:
the inertial wrenches of its accelerations less the contact forces that its letters allow. Which way a contact
at rest begins to slide depends on the wrench. Its ways are parted by the sectors of its friction pyramid;
each sector, and each border of two, has a polyhedron of its own, and the wrenches of the mode are the union
of the sets with its letters. All sets together are the map: the outcome is indeterminate where sets of
several modes overlap, and inconsistent where none reaches.

A wrench well inside a set brings about its mode in `spatial_contact_modes`, asked for with ``sharpen=False``
and pyramids that lie alike: with as many facets, and under the wrench for which the sets were made. Pyramids
turned otherwise differ by the part 1 - cos(pi / facets) of friction at rest. On a set's boundary, which it
contains here, the strict inequalities of its letters fail. A frictionless contact that stays is `c`, whether
it slides or not.

The ways in which contacts can slide together are faces of an arrangement (`kinematic`), whose planes are
those of the borders between sectors.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact_modes.letters import SEPARATES, SPATIAL_LETTERS, STAYS, STICKS, check_modes
from contact_dynamics.contact_modes.spatial.kinematic import sliding_faces
from contact_dynamics.contact_modes.spatial.problem import MAX_EDGES, SpatialCase, search_of, spatial_case
from contact_dynamics.contact_modes.spatial.wrenches import Way, distinct, supports, wrench_generators
from contact_dynamics.errors import TooLargeError, UndecidedError
from contact_dynamics.records import Record
from contact_dynamics.tolerances import ROW_TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

    from numpy.typing import ArrayLike

    from contact_dynamics.contact_modes.spatial.options import Pyramid, Touching
    from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem
    from contact_dynamics.contact_modes.spatial.search import Search
    from contact_dynamics.contact_modes.spatial.wrenches import Way
    from contact_dynamics.validation import FloatArray

WRENCH_FACETS: Final = 4
"""The number of edges of a friction pyramid that keeps the sets few. The ways of sliding grow as its square
or cube."""

MAX_WRENCH_SETS: Final = 2000
"""The largest number of sets of one answer. Each takes a millisecond or two. A box on four feet has 200 to
350 sets with pyramids of four edges, and some 1300 with eight."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SpatialWrenchSet(Record):
    """Applied wrenches that can cause one mode with one combination of sliding directions.

    The set is closed and convex. Wrenches are force, N, then torque about the centre of mass, N m, world
    axes.

    Attributes:
        mode: One letter for each contact: s, f or c.
        sliding_from_W: (n, 3), unit. A contact that begins to slide does so in a direction between this one
            and ``sliding_to_W``, counterclockwise about its normal. Both are zero if the direction is
            arbitrary.
        sliding_to_W: (n, 3), unit, the other end of that range.
        vertices: (k, 6), N and N m. The set contains all convex combinations of the vertices plus all
            nonnegative combinations of the generators.
        generators: (k, 6), of arbitrary scale.
        half_spaces: (k, 7), half-spaces a . w <= b whose intersection is the same set, a then b. Empty if the
            set contains every wrench.
    """

    mode: str
    sliding_from_W: FloatArray
    sliding_to_W: FloatArray
    vertices: FloatArray
    generators: FloatArray
    half_spaces: FloatArray

    def depth(self, wrench_W: ArrayLike, length: float) -> float:
        """Return the depth of a wrench, (6,), inside the set, N, in the root of |f|^2 + |torque / length|^2.

        It is infinite if the set contains every wrench. It is negative outside, where its size is a lower
        bound of the distance, and zero or less if the set has no interior.
        """
        if len(self.half_spaces) == 0:
            return math.inf
        a = self.half_spaces[:, :6]
        sizes = np.linalg.norm(a * [1.0, 1.0, 1.0, length, length, length], axis=1)
        return float(((self.half_spaces[:, 6] - a @ np.asarray(wrench_W)) / sizes).min())


def spatial_wrench_sets(
    problem: SpatialContactProblem, *, modes: Collection[str] | None = None
) -> tuple[SpatialWrenchSet, ...]:
    """Return the applied wrenches of every mode and way of sliding (`plane_or_space.wrench_sets`).

    There are none where a contact approaches. Sets of one mode follow each other. The problem's own wrench
    says how the friction pyramids lie, and plays no other part. A mode that is impossible whatever the wrench
    has no set.

    Raises:
        TooLargeError: more than `MAX_WRENCH_SETS` sets, more than `spatial.problem.MAX_EDGES` edges of all
            pyramids, or too many ways of sliding (`MAX_MEETINGS`).

    Source: lecture 26, "Force dual for dynamic contact problem"; Huang, Cheng and Mason 2020 for the ways.
    """
    body, wrench, friction_facets = problem.body, problem.wrench_W, problem.friction_facets
    check_modes(modes or (), len(problem.contacts), SPATIAL_LETTERS)
    case = spatial_case(problem)
    if not isinstance(case, SpatialCase):
        return ()
    search = search_of(case, friction_facets)
    edges = sum(len(one.edges) for one in search.pyramids)
    if edges > MAX_EDGES:
        raise TooLargeError("contacts", f"{edges} edges of friction pyramids", f"at most {MAX_EDGES}")
    wanted: list[tuple[str, tuple[Way, ...]]] = []
    for ways in ways_of(search):
        mode = case.of_all(way.letter for way in ways)
        if modes is None or mode in modes:
            wanted.append((mode, ways))
        if len(wanted) > MAX_WRENCH_SETS:
            allowed = f"at most {MAX_WRENCH_SETS}: fewer contacts, or fewer friction_facets"
            raise TooLargeError("contacts", f"more than {MAX_WRENCH_SETS} sets of wrenches", allowed)
    metric = np.array([1.0, 1.0, 1.0, *[body.mean_radius_of_gyration] * 3])
    turning = wrench - case.motion.wrench  # the part of the wrench that a turning body needs
    return tuple(
        _wrench_set(case, search, ways, mode=mode, metric=metric, turning=turning)
        for mode, ways in sorted(wanted)
    )


def _wrench_set(
    case: SpatialCase,
    search: Search,
    ways: Sequence[Way],
    *,
    mode: str,
    metric: FloatArray,
    turning: FloatArray,
) -> SpatialWrenchSet:
    unit = case.motion.mass * case.motion.scale  # N; wrenches are divided by it, and torques by the length
    given = wrench_generators(case, search, ways, metric)
    positive, zero = supports(given)
    sides = np.vstack([positive, zero, -zero])
    sizes = np.linalg.norm(sides[:, :6], axis=1)
    sides = distinct(sides[sizes > ROW_TOLERANCE] / sizes[sizes > ROW_TOLERANCE, None])
    high = given.rays[:, 6] > ROW_TOLERANCE
    outward = -sides[:, :6] / metric
    ranges = np.zeros((2, len(mode), 3))
    for i, pyramid, way in zip(case.touching.tolist(), search.pyramids, ways, strict=True):
        ranges[:, i] = sliding_range(pyramid, way)
    return SpatialWrenchSet(
        mode=mode,
        sliding_from_W=ranges[0],
        sliding_to_W=ranges[1],
        vertices=given.rays[high, :6] / given.rays[high, 6:] * metric * unit + turning,
        generators=np.vstack([given.rays[~high], given.lines, -given.lines])[:, :6] * metric,
        half_spaces=np.column_stack([outward, sides[:, 6] * unit + outward @ turning]),
    )


MAX_MEETINGS: Final = 10_000
"""The largest number of sets of planes of one arrangement whose common lines are computed, in about a
second."""


def ways_of(search: Search) -> Iterator[tuple[Way, ...]]:
    """Yield all that touching contacts can do together, each with a `Way` for every contact.

    Raises:
        TooLargeError: more than `MAX_MEETINGS` sets of planes meet in lines.
        UndecidedError: rounding decides which ways of sliding there are.
    """
    touching = search.touching
    height = np.eye(1, 7, 6)
    rows = np.vstack([search.rising, height])
    rows /= np.linalg.norm(rows, axis=1)[:, None]
    cuts = [_borders(of, pyramid) for of, pyramid in zip(touching, search.pyramids, strict=True)]
    found: set[tuple[Way, ...]] = set()
    for signs_of in sliding_faces(rows, cuts, MAX_MEETINGS):
        ways = [Way(SEPARATES, -1)] * len(touching)
        for i, signs in signs_of.items():
            ways[i] = _way(signs, len(search.pyramids[i].edges))
        if tuple(ways) not in found:
            found.add(tuple(ways))
            yield tuple(ways)
    rest = tuple(Way(STAYS if one.frame is None else STICKS, -1) for one in search.pyramids)
    if rest not in found and not any(np.any(contact.point[:, -1]) for contact in touching):
        raise _undecided()  # nothing keeps a body from resting


def sliding_range(pyramid: Pyramid, way: Way) -> tuple[FloatArray, FloatArray]:
    """Return unit tangents, (3,), between which a contact slides, anticlockwise, or zeros if any way is."""
    if way.item < 0 or pyramid.frame is None:
        return np.zeros(3), np.zeros(3)
    count = len(pyramid.edges)
    first = (way.item + 1) // 2 - 0.5 if way.item % 2 == 0 else way.item // 2 + 0.5
    angles = 2.0 * math.pi / count * np.array([first, first + (way.item % 2 == 0)]) + math.pi
    one, two = pyramid.frame
    low, high = (math.cos(angle) * one + math.sin(angle) * two for angle in angles)
    return low, high


def _borders(contact: Touching, pyramid: Pyramid) -> FloatArray:
    """Return rows, (k, 7), that are positive where a contact slides anticlockwise of a border.

    Border j lies between the sectors opposite to edges j and j + 1. If their number is even, the second half
    would be the first half's rows, reversed, and is left out.
    """
    if pyramid.frame is None:
        return np.zeros((0, 7))
    count = len(pyramid.edges)
    angles = math.pi / count * (2.0 * np.arange(count if count % 2 else count // 2) + 1.0)
    quarter_on = np.column_stack([np.sin(angles), -np.cos(angles)])
    return quarter_on @ np.array(pyramid.frame) @ contact.point


def _way(signs: list[int], count: int) -> Way:
    """Return what a contact that stays does, from the side of each of its borders that it slides to."""
    if not signs:
        return Way(STAYS, -1)
    if not any(signs):
        return Way(STICKS, -1)
    if len(signs) < count:
        signs = [*signs, *(-sign for sign in signs)]
    for k, sign in enumerate(signs):
        after = signs[(k + 1) % count]
        if sign == 0 and after < 0:
            return Way(STAYS, 2 * k + 1)
        if sign > 0 and after < 0:
            return Way(STAYS, 2 * ((k + 1) % count))
    raise _undecided()


def _undecided() -> UndecidedError:
    return UndecidedError(
        "contacts and their normals must be either the same or clearly apart, got ways of sliding that "
        "rounding decides"
    )
