# SPDX-License-Identifier: Apache-2.0
"""Polyhedral convex cones in R^3 that are given by half-spaces: their extreme rays and faces.

The double description method finds the rays (Motzkin and others 1953). The cone is cut with one half-space
after the other. Each ray keeps the set of rows (normals of half-spaces) on which it lies, as the bits of an
integer. In three dimensions the rays of a pointed cone stand in a cycle, which makes the method simple.
Half-spaces, wedges, planes, sectors, single rays and the origin are cones too. They come out right because
one tolerance decides whether a ray lies on a row, and the decision is kept as a bit and never made again.

The dual of a cone has the rows as generators, and the rays that are found here as the normals of its facets.
So the same class finds the faces of the accelerations that do not penetrate, and the facets of wrench cones.

The sets are small, so plain floats are fast: most rows change nothing, and finding this out takes three
multiplications for each ray. For many rows, arrays find those that change nothing. Floats decide what is zero
to rounding, and what clearly is not. If a number lies between the two, as for contacts that nearly coincide,
the cone is built again in decimals, with enough digits to decide every case correctly for the given rows.
The formulas at the end of this file work for both.
"""

from __future__ import annotations

import math
from decimal import Decimal
from typing import TYPE_CHECKING, Final, NamedTuple, cast

import numpy as np

from contact_dynamics.numerics.arithmetic import DECIMALS, within
from contact_dynamics.numerics.vectors import AXES, Vector3, array_of, cross, dot, opposite, tangents
from contact_dynamics.tolerances import (
    CLEAR_ROWS,
    CLEAR_ROWS_OF_MANY,
    LEAST_ROUGH_ROOT,
    ROUGH_ROWS,
    SAME_ROWS,
    SAME_SHARP_ROWS,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from contact_dynamics.validation import FloatArray

_WIDE: Final = 0.1
"""Sine. The search for rows to start with ends at the first pair that makes this angle or more."""

_HALF: Final = Decimal("0.5")

_DOUBLINGS: Final = 3
"""Steps that double the digits of floats, up to those of `DECIMALS.sums`."""

MANY: Final = 24
"""Number of rows above which arrays are faster than loops."""


class _NotClearError(Exception):
    """Floats cannot decide whether some number is zero."""


_MANY: Final = 150
"""Number of rows above which `CLEAR_ROWS_OF_MANY` is used instead of `CLEAR_ROWS`."""

_ALMOST_OPPOSITE: Final = -0.9
"""Cosine. Sectors whose rays make a smaller one are given in two halves."""


class Sector(NamedTuple):
    """A two-dimensional cone between two rays that are less than 180 degrees apart."""

    start: Vector3  # the first ray, a unit vector
    end: Vector3  # the last ray, a unit vector
    tight: int  # the bit set of the rows that vanish on the whole sector
    halved: bool = False  # whether it is the first half of a wide sector, whose end lies inside a face


class PolyhedralCone:
    """The cone {x : row . x >= 0 for every row}, with its lines, its extreme rays and its faces."""

    __slots__ = ("_clear", "_rough", "_same", "exact", "lineality", "rays", "rows", "tight")

    exact: bool
    """Whether the cone was built in decimals."""

    rows: Sequence[Vector3]
    """The rows as unit vectors. They are decimals if the cone is ``exact``."""
    lineality: list[Vector3]
    """An orthonormal basis of the lines that the cone contains."""
    rays: list[Vector3]
    """The extreme rays as unit vectors, orthogonal to the lines. Three or more stand in a cycle."""
    tight: list[int]
    """For each ray, the bit set of the rows that vanish on it."""

    def __init__(
        self,
        rows: Sequence[Vector3],
        *,
        exact: bool = False,
        sharp: Callable[[], Sequence[Vector3]] | None = None,
    ) -> None:
        """Build the cone from ``rows``. A row vanishes on a unit vector if it does within `SAME_ROWS`.

        Args:
            rows: The rows as unit vectors of floats.
            exact: Whether to build the cone in decimals even if floats could decide everything.
            sharp: A function that returns the rows as decimals of any length. Give it if the rows are known
                to more digits than floats have.
        """
        self.exact = exact
        self._same = SAME_ROWS
        self._clear = CLEAR_ROWS if len(rows) <= _MANY else CLEAR_ROWS_OF_MANY
        if not exact:
            try:
                self._build(rows)
            except _NotClearError:
                self.exact = True
        if self.exact:
            self._same = SAME_ROWS if sharp is None else SAME_SHARP_ROWS
            with within(DECIMALS.sums):
                known = [decimal_vector(row) for row in rows] if sharp is None else sharp()
                self._build([unit(row) for row in known])
                self.lineality = [rounded(line) for line in self.lineality]
                self.rays = [rounded(ray) for ray in self.rays]

    @property
    def all_rows(self) -> int:
        """Return the bit set of all rows. All of them vanish on the lines of the cone, and at the origin."""
        return (1 << len(self.rows)) - 1

    @property
    def has_interior(self) -> bool:
        """Return whether the cone is three-dimensional."""
        if len(self.lineality) + len(self.rays) < 3:
            return False
        common = self.all_rows
        for tight in self.tight:
            common &= tight
        return common == 0

    def edges(self) -> list[tuple[Vector3, int]]:
        """Return rays that contain every one-dimensional face, with the rows that vanish on each.

        Lines are two rays.
        """
        lines = [(sign, self.all_rows) for line in self.lineality for sign in (line, opposite(line))]
        if len(self.lineality) == 3:
            return []
        return lines + list(zip(self.rays, self.tight, strict=True))

    def sectors(self) -> list[Sector]:
        """Return sectors that cover every two-dimensional face. A half-plane or plane has several."""
        lines = self.lineality
        rays = self.rays
        if not lines:
            count = len(rays)
            pairs = [(i, (i + 1) % count) for i in range(count)] if count > 2 else [(0, 1)][: count // 2]
            found = []
            for i, j in pairs:
                found += self._parts(Sector(rays[i], rays[j], self.tight[i] & self.tight[j]))
            return found
        if len(lines) == 1:
            line = lines[0]
            return [
                Sector(start, ray, tight)
                for ray, tight in zip(rays, self.tight, strict=True)
                for start in (line, opposite(line))
            ]
        if len(lines) == 2:
            one, two = lines
            turn = (one, two, opposite(one), opposite(two), one)
            return [Sector(turn[i], turn[i + 1], self.all_rows) for i in range(4)]
        return []

    def _parts(self, sector: Sector) -> list[Sector]:
        """Return two halves of a sector of almost 180 degrees, whose rays nearly cancel, or the sector."""
        start, end, tight, _ = sector
        if dot(start, end) > _ALMOST_OPPOSITE or not tight:
            return [sector]
        middle = rounded(
            cross(
                self.rows[(tight & -tight).bit_length() - 1], decimal_vector(start) if self.exact else start
            )
        )
        middle = middle if dot(middle, end) > 0.0 else opposite(middle)
        return [Sector(start, middle, tight, halved=True), Sector(middle, end, tight)]

    def _build(self, rows: Sequence[Vector3]) -> None:
        self.lineality = [decimal_vector(axis) for axis in AXES] if self.exact else list(AXES)
        self.rays = []
        self.tight = []
        self.rows = rows
        self._rough: FloatArray | None = None
        first = self._begin() if len(rows) > 1 else ()
        if first and len(rows) > MANY:
            self._cut_many(first)
            return
        for index, row in enumerate(rows):
            if index not in first:
                self._cut(row, index)

    def _check_clear(self, *sizes: float) -> None:
        """Raise `_NotClearError` if floats cannot decide whether one of ``sizes``, sines, is zero."""
        if self.exact:
            return
        same, clear = self._same, self._clear
        for size in sizes:
            if same < size < clear or same < -size < clear:
                raise _NotClearError

    def _begin(self) -> tuple[int, ...]:
        """Start with two or three independent rows and return their indices, or () if all are parallel."""
        rows = self.rows
        one = rows[0]
        second, width, normal = 0, self._same, one
        for index in range(1, len(rows)):
            across = cross(one, rows[index])
            sine = root(dot(across, across))
            if sine > width:
                second, width, normal = index, sine, across
                if sine > _WIDE:
                    break
        if second == 0:
            return ()
        self._check_clear(width)
        two = rows[second]
        third, height = -1, width * type(width)(self._same)
        for index, row in enumerate(rows):
            above = dot(normal, row)
            if abs(above) > abs(height):
                third, height = index, above
                if abs(above) > width * type(width)(_WIDE):
                    break
        if third < 0:
            line = unit(normal)
            self.lineality = [line]
            self.rays = [cross(line, one), cross(two, line)]
            self.tight = [1, 1 << second]
            return (0, second)
        self._check_clear(height / width)
        three = rows[third]
        if height < 0:
            second, third, two, three = third, second, three, two
        self.lineality = []
        self.rays = [unit(cross(a, b)) for a, b in ((two, three), (three, one), (one, two))]
        self.tight = [1 << second | 1 << third, 1 << third | 1, 1 | 1 << second]
        return (0, second, third)

    def _cut_many(self, first: tuple[int, ...]) -> None:
        """Cut with all rows except the ``first``.

        The rows with the extreme coordinates come next. After them, most of the others change nothing. Where
        decimals decide, floats tell which rows do that, and those that they cannot tell come last.
        """
        matrix = array_of(self.rows)
        if self.exact:
            self._rough = array_of(self.rays)
        extreme = {*matrix.argmin(axis=0).tolist(), *matrix.argmax(axis=0).tolist()}.difference(first)
        for index in extreme:
            self._cut(self.rows[index], index)
        others = np.ones(len(matrix), dtype=bool)
        others[[*first, *extreme]] = False
        waiting = others.nonzero()[0]
        at_once = 4
        while len(waiting) > 0 and self.rays:
            rays = array_of(self.rays) if self._rough is None else self._rough
            heights = matrix[waiting] @ rays.T
            lowest = heights.min(axis=1)
            unclear = waiting[:0]
            if self.exact:
                unclear = waiting[abs(lowest) <= ROUGH_ROWS]
            else:
                self._touch(waiting, heights, lowest)
            cutting = (lowest < (-ROUGH_ROWS if self.exact else -self._same)).nonzero()[0]
            cutting = waiting[cutting[lowest[cutting].argsort()]]
            if len(cutting) == 0:
                cutting, at_once = unclear, len(unclear)
                unclear = waiting[:0]
            for index in cutting[:at_once].tolist():
                self._cut(self.rows[index], index)
            waiting = np.concatenate([cutting[at_once:], unclear])
            at_once *= 2

    def _touch(self, indices: NDArray[np.int64], heights: FloatArray, lowest: FloatArray) -> None:
        """Record the rows that touch the cone and do not cut it, and on which rays they vanish."""
        low = (lowest < self._clear).nonzero()[0]
        if len(low) == 0:
            return
        sizes = abs(heights[low])
        zero = sizes <= self._same
        if np.count_nonzero(sizes < self._clear) > np.count_nonzero(zero):
            raise _NotClearError
        touching = lowest[low] >= -self._same
        if not touching.any():
            return
        flags = np.zeros((len(self.rays), len(self.rows)), dtype=bool)
        flags[:, indices[low[touching]]] = zero[touching].T
        for ray, packed in enumerate(np.packbits(flags, axis=1, bitorder="little")):
            self.tight[ray] |= int.from_bytes(packed.tobytes(), "little")

    def _cut(self, row: Vector3, index: int) -> None:
        if self.lineality and self._cut_lineality(row, index):
            return
        heights = self._heights(row)
        if not heights:
            return
        lowest = min(heights)
        if lowest >= self._clear:
            return
        tolerance, clear = self._same, self._clear
        near = [height for height in heights if -clear < height < clear]
        if near:
            self._check_clear(*near)
        if lowest > tolerance:
            return
        bit = 1 << index
        if lowest >= -tolerance:
            for i, height in enumerate(heights):
                if height <= tolerance:
                    self.tight[i] |= bit
            return
        self._cut_rays(heights, index, touches=bool(near))

    def _heights(self, row: Vector3) -> list[float]:
        """Return how far each ray is above a row. Where decimals decide, clear heights are floats."""
        x, y, z = row
        if self._rough is None:
            return [x * ray[0] + y * ray[1] + z * ray[2] for ray in self.rays]
        rough = self._rough @ array_of([row])[0]
        heights: list[float] = rough.tolist()
        for i in (abs(rough) <= ROUGH_ROWS).nonzero()[0].tolist():
            heights[i] = dot(row, self.rays[i])
        return heights

    def _cut_lineality(self, row: Vector3, index: int) -> bool:
        """Cut with a row. Return whether one of the lines became a ray by that."""
        parts = [dot(row, line) for line in self.lineality]
        length = root(sum(part * part for part in parts))
        if length <= self._same:
            return False
        self._check_clear(length)
        ray = unit(combination(parts, self.lineality))
        self.lineality = complement(self.lineality, ray)
        rise = dot(row, ray)
        bit = 1 << index
        for i, other in enumerate(self.rays):
            drop = dot(row, other) / rise
            self.rays[i] = unit(
                (other[0] - drop * ray[0], other[1] - drop * ray[1], other[2] - drop * ray[2])
            )
            self.tight[i] |= bit
        self.rays.append(ray)
        self.tight.append(bit - 1)
        if self._rough is not None:
            self._rough = array_of(self.rays)
        return True

    def _cut_rays(self, heights: list[float], index: int, *, touches: bool) -> None:
        """Drop the rays on the wrong side of the row, and add one where an edge of the cone crosses it."""
        tolerance = self._same
        bit = 1 << index
        top = heights.index(max(heights))
        heights = heights[top:] + heights[:top]
        self.rays = rays = self.rays[top:] + self.rays[:top]
        self.tight = tight = self.tight[top:] + self.tight[:top]
        if touches:
            for i, height in enumerate(heights):
                if -tolerance <= height <= tolerance:
                    tight[i] |= bit
        below = [i for i, height in enumerate(heights) if height < -tolerance]
        first, last = below[0], below[-1]
        edges = []
        if heights[first - 1] > tolerance and first > 0:
            edges.append((first - 1, first))
        after = (last + 1) % len(heights)
        if heights[after] > tolerance and len(heights) > 2:
            edges.append((last, after))
        crossings = [self._crossing(a, b, heights, index) for a, b in edges]
        common = [tight[a] & tight[b] | bit for a, b in edges]
        if self._rough is not None:
            rough = np.concatenate([self._rough[top:], self._rough[:top]])
            between = array_of(crossings).reshape(-1, 3)
            self._rough = np.concatenate([rough[:first], between, rough[last + 1 :]])
        self.rays = rays[:first] + crossings + rays[last + 1 :]
        self.tight = tight[:first] + common + tight[last + 1 :]

    def _crossing(self, i: int, j: int, heights: list[float], index: int) -> Vector3:
        """Return the ray on which the edge between rays i and j meets the row.

        It is a combination of the two rays. In floats it is then found again from the row and a row on which
        the edge lies, since this has less rounding.
        """
        common = self.tight[i] & self.tight[j]
        a, b = self.rays[i], self.rays[j]
        one, two = abs(heights[j]), abs(heights[i])
        if self._rough is not None:
            one, two = abs(dot(self.rows[index], b)), abs(dot(self.rows[index], a))
        rough = unit((one * a[0] + two * b[0], one * a[1] + two * b[1], one * a[2] + two * b[2]))
        if self.exact:
            return rough
        if self.lineality:
            edge = self.lineality[0]
        elif common:
            edge = self.rows[(common & -common).bit_length() - 1]
        else:
            return rough
        sharp = cross(edge, self.rows[index])
        length = math.sqrt(dot(sharp, sharp))
        along = dot(sharp, rough)
        if abs(along) < 0.5 * length or length < self._clear:
            raise _NotClearError
        length = math.copysign(length, along)
        return (sharp[0] / length, sharp[1] / length, sharp[2] / length)


def bits(mask: int) -> list[int]:
    """Return the positions of the bits that are set, in order."""
    if mask.bit_count() > MANY:
        return [position for position, bit in enumerate(bin(mask)[:1:-1]) if bit == "1"]
    found = []
    while mask:
        lowest = mask & -mask
        found.append(lowest.bit_length() - 1)
        mask ^= lowest
    return found


def combination(parts: Sequence[float], vectors: Sequence[Vector3]) -> Vector3:
    """Return the sum of vectors, each times its part."""
    x = y = z = 0 * parts[0]
    for part, vector in zip(parts, vectors, strict=True):
        x += part * vector[0]
        y += part * vector[1]
        z += part * vector[2]
    return (x, y, z)


def complement(basis: list[Vector3], along: Vector3) -> list[Vector3]:
    """Return an orthonormal basis of what is orthogonal to a unit vector in the span of a basis."""
    if len(basis) == 1:
        return []
    if len(basis) == 2:
        normal = cross(basis[0], basis[1])
        return [unit(cross(normal, along))]
    x, y, z = along
    one, _ = tangents((float(x), float(y), float(z)))
    if isinstance(x, float):
        return [one, cross(along, one)]
    one = unit(cross(decimal_vector(one), along))
    return [one, cross(along, one)]


def decimal_vector(vector: Vector3) -> Vector3:
    """Return the vector in decimals. The type says floats, because the formulas here work for both."""
    x, y, z = vector
    return cast("Vector3", (Decimal(x), Decimal(y), Decimal(z)))


def rounded(vector: Vector3) -> Vector3:
    """Return the vector in floats."""
    return (float(vector[0]), float(vector[1]), float(vector[2]))


def root(square: float) -> float:
    """Return the square root of a number >= 0.

    That of decimals is found from that of floats, to one or two of the last of 120 digits. Their own function
    takes three times as long, which was half of the time of many rows.
    """
    near = math.sqrt(square)
    if not isinstance(square, Decimal):
        return near
    if not LEAST_ROUGH_ROOT < near < math.inf:
        return square.sqrt()
    found = Decimal(near)
    for _ in range(_DOUBLINGS):
        found = _HALF * (found + square / found)
    return found


def unit(vector: Vector3) -> Vector3:
    """Return the vector at unit length."""
    x, y, z = vector
    square = x * x + y * y + z * z
    size = math.sqrt(square) if type(square) is float else root(square)
    return (x / size, y / size, z / size)
