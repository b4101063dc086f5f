# SPDX-License-Identifier: Apache-2.0
"""This file remembers why letters of uncertain contacts in space were excluded, to exclude others with it.

A reason is a direction of wrenches along which all forces of some letters are positive, like the applied
wrench, while no motion of these letters needs such a wrench. It uses the motions of few contacts. So it also
holds for other letters, of contacts whose motions it does not use and whose forces are as positive. Each
reason is checked for them as it was for the letters that it was found for. A third to a half of all letters
are excluded so, without a linear program.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from contact_dynamics.tolerances import NO_MOTION, PROVEN

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.spatial.bounds import BoundedBody
    from contact_dynamics.contact_modes.spatial.uncertain_ways import UncertainWay, UncertainWays
    from contact_dynamics.validation import FloatArray


class Reason(NamedTuple):
    """Why some letters are excluded.

    Attributes:
        z: (6,), the direction.
        row: (6,), the sum of rows that are not positive on the motions, as the nominal contacts have them.
        weights: By what the errors of each contact's rows are multiplied in that sum.
        used: How many of the inequalities of each contact's way the sum needs, from the first one on.
        ways: What each contact does.
    """

    z: FloatArray
    row: FloatArray
    weights: FloatArray
    used: list[int]
    ways: tuple[UncertainWay, ...]


class Reasons:
    """All reasons that were found for one box of contacts. Sets of them are the bits of integers."""

    __slots__ = ("_allowing", "_found", "_holding", "_inertia", "_largest", "_rests", "_sizes", "_w", "_ways")

    def __init__(self, body: BoundedBody, ways: UncertainWays, *, rests: bool) -> None:
        """Take a body whose wrench has the size 1.

        Args:
            body: The body.
            ways: The motions and forces of its contacts.
            rests: Whether accelerations of at most `NO_MOTION` need not be excluded.
        """
        self._inertia = body.inertia
        self._w = body.wrench
        self._ways = ways
        self._sizes = math.sqrt(3.0) * np.array([contact.size for contact in body.contacts])
        self._rests = rests
        # The applied wrench does positive work on every motion, so that motions have no more than this size.
        self._largest = 1.0 / float(np.linalg.eigvalsh(body.inertia)[0])
        self._found: list[Reason] = []
        self._holding = [0] * 12
        self._allowing: dict[tuple[int, UncertainWay], tuple[int, int]] = {}

    def exclude(self, at: int, sign: float, ways: tuple[UncertainWay, ...]) -> bool:
        """Return whether a known reason excludes ``ways`` of all contacts.

        Args:
            at: The coordinate of the motion that is the largest.
            sign: Its sign.
            ways: What each contact does.
        """
        left = self._holding[_number(at, sign)]
        for i, way in enumerate(ways):
            if not left:
                return False
            left &= self._those_that_allow(i, way)
        return left != 0

    def add(self, reason: Reason, at: int, sign: float) -> bool:
        """Remember a reason, and return whether it excludes the ways that it was found for."""
        bit = 1 << len(self._found)
        self._found.append(reason)
        for number in self._holds(reason):
            self._holding[number] |= bit
        return self.exclude(at, sign, reason.ways)

    def _holds(self, reason: Reason) -> list[int]:
        """Return for which largest coordinates the direction and the motions contradict each other.

        On motions whose largest coordinate has the size t, the sum of rows is not positive but for the errors
        of the contacts. So the work of the wrench that a motion needs along the direction is at most -fall t.
        """
        rest = self._inertia @ reason.z - reason.row
        most = float(reason.weights @ self._sizes + abs(rest).sum())
        along = float(self._w @ reason.z)
        least, found = NO_MOTION if self._rests else 0.0, []
        for at in range(6):
            for sign in (1.0, -1.0):
                fall = float(abs(rest[at]) - sign * rest[at]) - most
                if along + fall * (least if fall > 0.0 else self._largest) > PROVEN:
                    found.append(_number(at, sign))
        return found

    def _those_that_allow(self, i: int, way: UncertainWay) -> int:
        """Return the reasons that allow a contact to do something: its motions and forces satisfy them."""
        seen, bits = self._allowing.get((i, way), (0, 0))
        if seen < len(self._found):
            new = self._found[seen:]
            directions = np.array([reason.z for reason in new])
            edges, errors = self._ways.forces(i, way)
            pushes = np.all(directions @ edges.T >= abs(directions) @ errors.T, axis=1)
            for k, reason in enumerate(new):
                if pushes[k] and way.obeys(reason.ways[i], reason.used[i]):
                    bits |= 1 << (seen + k)
            self._allowing[i, way] = len(self._found), bits
        return bits


def _number(at: int, sign: float) -> int:
    return 2 * at + (1 if math.copysign(1.0, sign) > 0.0 else 0)
