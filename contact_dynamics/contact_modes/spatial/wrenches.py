# SPDX-License-Identifier: Apache-2.0
"""The applied wrenches in space that can bring letters about.

They are the wrenches that the motions with these letters need, less the wrenches of contact forces. They are
given as positive sums of rays, plus sums of lines. Centripetal terms add a seventh coordinate, in which a
wrench has the height one. A wrench is (force, torque / length) / mass, in the units of accelerations.

The sum that is nearest to a given wrench may also have forces in round friction cones. A few edges replace
the cones at first. The forces that lead nearer to the target become further edges, until none does. Then the
remainder separates the target from all sums, so that no sum is nearer.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.letters import SEPARATES, STICKS
from contact_dynamics.contact_modes.spatial.cone import cone_of, nearest_sum
from contact_dynamics.numerics.linear_spaces import null_space
from contact_dynamics.tolerances import NEAREST_GAIN, NEAREST_REACHED, ROW_TOLERANCE, SQUEEZE_TRIED

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes.spatial.options import Pyramid, Touching
    from contact_dynamics.contact_modes.spatial.problem import SpatialCase
    from contact_dynamics.contact_modes.spatial.search import Search
    from contact_dynamics.validation import FloatArray

_ALIKE: Final = 7
"""Unit rows that agree to so many digits count as the same. Rounding reaches the eleventh digit."""

HEIGHT_WEIGHT: Final = 1e4
"""The weight of the height of a wrench, which must be met exactly, relative to its distance."""


class Way(NamedTuple):
    """What one touching contact does."""

    letter: str  # s (separates), f (sticks) or c (stays)
    item: int  # the item of sliding (`options`), or -1 if none is asked for


class Generators(NamedTuple):
    """Wrenches that bring something about, with their heights: positive sums of rays, plus sums of lines."""

    rays: FloatArray  # (k, 7), unit
    lines: FloatArray  # (m, 7), unit


class _Conditions(NamedTuple):
    """What a contact demands of the motion, and the force edges that may act."""

    zero: FloatArray  # (k, 7), rows that vanish on the motion
    positive: FloatArray  # (l, 7), rows that are not negative on it
    acting: FloatArray  # (j, 3), the edges


def wrench_generators(
    case: SpatialCase,
    search: Search,
    ways: Sequence[Way],
    metric: FloatArray,
    further: FloatArray = np.zeros((0, 7)),  # noqa: B008 (it is not changed)
) -> Generators:
    """Return the wrenches under which touching contacts can do as stated, each in its way.

    The metric, (6,), divides a wrench: ones, then a length, m. Rows ``further``, (k, 7), are not negative on
    the motion.
    """
    asked = [_conditions(*of) for of in zip(search.touching, search.pyramids, ways, strict=True)]
    needed = needed_wrenches(
        case,
        np.vstack([np.zeros((0, 7)), *(one.zero for one in asked)]),
        np.vstack([*(one.positive for one in asked), further]),
        metric,
    )
    given = [np.zeros((0, 6))]
    for i, one in zip(case.touching.tolist(), asked, strict=True):
        given.append(-(one.acting @ case.motion.points[3 * i : 3 * i + 3]) / metric)
    forces = np.vstack(given)
    rays = np.vstack([needed.rays, np.column_stack([forces, np.zeros(len(forces))])])
    return Generators(distinct(unit_rows(rays)), needed.lines)


def needed_wrenches(
    case: SpatialCase, zero: FloatArray, positive: FloatArray, metric: FloatArray
) -> Generators:
    """Return the wrenches that motions need on which rows, (k, 7), vanish or are not negative."""
    motion = case.motion
    free = null_space(unit_rows(zero))  # (7, k)
    inside = cone_of(unit_rows(np.vstack([positive, np.eye(1, 7, 6)]) @ free))

    def needed(motions: FloatArray) -> FloatArray:
        accelerations = motions @ free.T
        wrenches = accelerations[:, :6] / motion.lengths @ motion.inertia / metric / motion.mass
        return np.column_stack([wrenches, accelerations[:, 6]])

    return Generators(unit_rows(needed(inside.rays)), unit_rows(needed(inside.lines)))


def with_round_cones(
    case: SpatialCase, search: Search, generators: Generators, contacts: Sequence[int], metric: FloatArray
) -> RoundSum:
    """Return generated wrenches with those of round cones at some of the contacts, which may stick.

    A height has the weight `HEIGHT_WEIGHT`, or zero if nothing has a height but the motion that vanishes.
    """
    weights = np.append(np.ones(6), HEIGHT_WEIGHT if np.any(case.motion.turning) else 0.0)
    points = [case.motion.points[3 * case.touching[k] :][:3] / metric for k in contacts]
    axes = [-search.touching[k].normal @ point for k, point in zip(contacts, points, strict=True)]
    leans = [
        search.touching[k].holding * np.array(search.pyramids[k].frame) @ point
        for k, point in zip(contacts, points, strict=True)
    ]
    rays = np.vstack([generators.rays, generators.lines, -generators.lines])
    return RoundSum(
        rays * weights,
        np.pad(np.array(axes).reshape(-1, 6), ((0, 0), (0, 1))),
        np.pad(np.array(leans).reshape(-1, 2, 6), ((0, 0), (0, 0), (0, 1))),
    )


def supports(generators: Generators) -> tuple[FloatArray, FloatArray]:
    """Return the rows, (k, 7) each, that are not negative on generated wrenches, and those that vanish."""
    across = null_space(generators.lines)
    rows = unit_rows(generators.rays @ across)
    if len(rows) == 0:
        return np.zeros((0, 7)), across.T
    dual = cone_of(rows)
    return dual.rays @ across.T, dual.lines @ across.T


def _conditions(contact: Touching, pyramid: Pyramid, way: Way) -> _Conditions:
    nothing = np.zeros((0, 7))
    normal = (contact.normal @ contact.point)[None, :]
    if way.letter == SEPARATES:
        return _Conditions(nothing, normal, np.zeros((0, 3)))
    if way.letter == STICKS:
        return _Conditions(contact.point, nothing, pyramid.sticking)
    if pyramid.frame is None:
        return _Conditions(normal, nothing, pyramid.edges)
    if way.item < 0:
        return _Conditions(normal, nothing, pyramid.sticking)
    # The edge that opposes the sliding most has the least product with it, alone or with its neighbour.
    count = len(pyramid.edges)
    j, k = way.item // 2, (way.item + 1) // 2 % count
    angles = 2.0 * math.pi / count * np.array([j - 1, j, k, k + 1])
    before, one, other, after = (
        np.column_stack([np.cos(angles), np.sin(angles)]) @ np.array(pyramid.frame) @ contact.point
    )
    sides = np.array([before - one, after - other])
    if j == k:
        return _Conditions(normal, sides, pyramid.edges[[j]])
    return _Conditions(np.vstack([normal, one - other]), sides, pyramid.edges[[j, k]])


def distinct(rows: FloatArray) -> FloatArray:
    """Return unit rows, each once."""
    return rows[np.sort(np.unique(np.round(rows, _ALIKE), axis=0, return_index=True)[1])]


_MAX_ROUNDS: Final = 60
"""Rounds of further edges. Six are enough, and each adds an edge to a cone."""

_START: Final = np.array([[1.0, 0.0], [-0.5, 0.75**0.5], [-0.5, -(0.75**0.5)]])


class RoundSum(NamedTuple):
    """What is summed, in a space of k dimensions."""

    rays: FloatArray  # (m, k)
    axes: FloatArray  # (n, k), the axes of the cones
    leans: FloatArray  # (n, 2, k); edges of a cone are its axis plus unit sums of its two leans

    def rest(self, target: FloatArray) -> FloatArray:
        """Return a target, (k,), less the sum that is nearest to it; zeros if it is a sum to rounding."""
        edges = [self.axes + self.leans[:, 0] * x + self.leans[:, 1] * y for x, y in _START]
        rays = unit_rows(self.rays)
        spans = np.vstack([rays, unit_rows(np.vstack(edges))])
        size = float(np.linalg.norm(target))
        rest, before = target, np.inf
        for _ in range(_MAX_ROUNDS if len(spans) else 0):
            shares, left = nearest_sum(spans, target)
            if left <= NEAREST_REACHED * size:
                return np.zeros_like(target)
            rest = target - shares @ spans
            if len(self.axes) == 0 or left >= before:
                break
            before = left
            along = self.leans @ rest
            sizes = np.sqrt((along * along).sum(axis=1))[:, None]
            along /= np.where(sizes > 0.0, sizes, 1.0)
            best = self.axes + (along[:, None, :] @ self.leans)[:, 0]
            best /= np.sqrt((best * best).sum(axis=1))[:, None]
            gains = best @ rest
            # No sum is nearer by more than the gain of all forces together, were they along the best edge.
            # Where contacts press against each other, these may be far larger than those found so far.
            largest = max(float(shares.sum()), SQUEEZE_TRIED * size)
            if float(gains.max()) * largest <= NEAREST_GAIN * left * left:
                break
            helps = gains > 0.0
            shares[: len(rays)] = 1.0  # rays that do not act now may do so with further edges
            spans = np.concatenate([spans[shares > 0.0], best[helps]])
        return rest


def unit_rows(rows: FloatArray) -> FloatArray:
    """Return rows, (m, k), divided by their lengths, without those that vanish."""
    sizes = np.sqrt((rows * rows).sum(axis=1))
    found: FloatArray = rows[sizes > ROW_TOLERANCE] / sizes[sizes > ROW_TOLERANCE, None]
    return found
