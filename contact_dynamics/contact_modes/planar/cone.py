# SPDX-License-Identifier: Apache-2.0
"""The faces of a polyhedral convex cone in R^3 that is given by half-spaces.

`extreme_rays` finds the rays that span it. Its faces are the whole cone, sectors between neighbouring rays,
and edges, which are rays or lines.
"""

from __future__ import annotations

from typing import Final, NamedTuple

from contact_dynamics.contact_modes.planar.exact_vectors import decimal_vector, rounded
from contact_dynamics.contact_modes.planar.extreme_rays import MANY, ExtremeRays
from contact_dynamics.numerics.vectors import Vector3, cross, dot, opposite

_ALMOST_OPPOSITE: Final = -0.9
"""Cosine. Sectors whose rays make a smaller one are given in two halves."""


class Sector(NamedTuple):
    """A two-dimensional cone between two rays that are less than 180 degrees apart.

    Attributes:
        start: The first ray, a unit vector.
        end: The last ray, a unit vector.
        tight: The bit set of the rows that vanish on the whole sector.
        halved: Whether its end lies inside a face, where a wide sector was cut in two halves. Then this is
            the first half.
    """

    start: Vector3
    end: Vector3
    tight: int
    halved: bool = False


class PolyhedralCone(ExtremeRays):
    """The cone {x : row . x >= 0 for every row}, with its faces."""

    __slots__ = ()

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
        """Return rays that contain every one-dimensional face, each with the rows that vanish on it.

        A line is given by two opposite rays, and a plane by two such lines in it.
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
        """Return two halves of a sector of almost 180 degrees, or else the sector.

        A sum of its two rays would be little more than rounding.
        """
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
