# SPDX-License-Identifier: Apache-2.0
"""The law's own spread: by how much velocities after strikes differ from what the law of impact says.

A body is pushed at the contact alone, whatever the law says. So what the law is off by is an impulse through
the contact, for the most part, and changes of velocity and spin belong together. A small rest does not: the
contact is not quite where the shape has it.

Recorded strikes of a cube have one spread, whether they change the velocity by 0.3 or by 1.8 m/s. A strike
of a sample that is much weaker than its first one has a smaller spread. Otherwise a body that comes to rest
would be shaken by it.

`law_spread.pxd` gives the C types with which this file compiles.
"""

from __future__ import annotations

import math
from math import dist
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.numerics.vectors import AXES
from contact_dynamics.toss import vectors as vec
from contact_dynamics.toss.solid import pose_of

if TYPE_CHECKING:
    from numpy.random import Generator
    from numpy.typing import NDArray

    from contact_dynamics.toss.solid import Numbers, Solid, Touch
    from contact_dynamics.toss.uncertainty import TossUncertainty
    from contact_dynamics.validation import FloatArray


FREEDOM: Final = 3.0
"""Degrees of freedom of Student's t. Residuals of recorded strikes have heavier tails than normal ones. Among
the tosses that the law was fitted to, nine tenths were in the regions of nine tenths with 3, and three
quarters with normal numbers."""

_SAME_MEDIAN: Final = 0.8881
"""Root of the ratio of the medians of the squared distance in three dimensions: chi squared's, and by t."""

BY_IMPULSE: Final = 0.9
"""Share of a variance that an impulse through the contact has: that of velocity or that of spin, whichever it
reaches first. The residuals of recorded strikes have it so. Those to which the law was fitted are e^153 times
as probable with such impulses as with changes of velocity and spin that do not belong together."""

FULL: Final = 0.2
"""A strike that changes the velocity by this share of what the first one did has the full spread, and so have
stronger ones. Weaker ones have it in proportion."""


class LawSpread:
    """Draws changes of velocities after strikes, for n samples."""

    def __init__(self, uncertainty: TossUncertainty, count: int, chance: Generator) -> None:
        self._velocity, self._spin, self._chance = uncertainty.velocity, uncertainty.spin, chance
        self._first = np.zeros(count)  # m/s, by how much the first strike changed the velocity
        self._own: list[Generator] = []
        self.is_none = self._velocity == self._spin == 0.0

    def changes(self, which: NDArray[np.intp], jumps: FloatArray, turning: FloatArray) -> FloatArray:
        """Return changes of velocities, (m, 6), m/s and rad/s, of some samples after one more strike.

        Args:
            which: (m,), the samples.
            jumps: (m,), m/s, by how much the strike changed their velocities.
            turning: (m, 3, 3), 1/m, by how much an impulse at the contact changes the spin, for each m/s by
                which it changes the velocity.
        """
        first = self._first[which]
        self._first[which] = first = np.where(first > 0.0, first, jumps)
        shares = np.minimum(np.divide(jumps, FULL * first, out=np.ones(len(jumps)), where=first > 0.0), 1.0)
        # Numbers are drawn for all samples, so that a sample's do not depend on what others do.
        count = len(self._first)
        drawn = self._chance.standard_normal((count, 9))[which]
        sizes = shares * (_SAME_MEDIAN * np.sqrt(FREEDOM / self._chance.chisquare(FREEDOM, count)))[which]
        squares = np.einsum("nij,nij->n", turning, turning) / 3.0
        parts = np.array([_parts(self._velocity, self._spin, square) for square in squares.tolist()])
        drawn *= np.repeat(parts.reshape(-1, 3) * sizes[:, None], 3, axis=1)
        drawn[:, 3:6] += drawn[:, :3]
        drawn[:, 6:] += np.einsum("nij,nj->ni", turning, drawn[:, :3])
        changes: FloatArray = drawn[:, 3:]
        return changes

    def of_one(self, i: int) -> KickOfOne:
        """Return what changes the velocities of one sample after a strike of a single contact.

        Each sample has numbers of its own, so that it does not matter which one goes on first.
        """
        self._own = self._own or self._chance.spawn(len(self._first))
        return KickOfOne(self._velocity, self._spin, float(self._first[i]), self._own[i])


class KickOfOne:
    """Changes the velocities of one sample after its strikes. It can be handed to another process."""

    def __init__(self, velocity: float, spin: float, first: float, chance: Generator) -> None:
        self.velocity, self.spin, self.chance = velocity, spin, chance
        self.first = first  # m/s, by how much the first strike changed the velocity

    def kicked(self, solid: Solid, before: Numbers, after: Numbers, touch: Touch) -> Numbers:
        """Return the changed state after a strike, for those before and after it and the contact."""
        jump = dist(after[7:10], before[7:10])
        self.first = self.first or jump
        size = min(jump / (FULL * self.first), 1.0) if self.first > 0.0 else 1.0
        size *= _SAME_MEDIAN * math.sqrt(FREEDOM / self.chance.chisquare(FREEDOM))
        surface, corner = touch
        pose, flat, mass = pose_of(solid, after), solid.flats[surface], solid.mass
        arm, n = pose.arm(surface, corner), flat.normal
        square = 0.0
        for axis in AXES:
            turn = vec.times(pose.inverse, vec.cross(arm, axis))
            square += vec.dot(turn, turn)
        pushed, velocity, spin = _parts(self.velocity, self.spin, mass * mass * square / 3.0)
        pushed, velocity, spin = size * pushed, size * velocity, size * spin
        a, b, c, d, e, f, g, h, i = self.chance.standard_normal(9).tolist()
        a, b, c = pushed * a, pushed * b, pushed * c
        turn = vec.times(pose.inverse, vec.cross(arm, (mass * a, mass * b, mass * c)))
        v = (after[7] + (a + velocity * d), after[8] + (b + velocity * e), after[9] + (c + velocity * f))
        w = (
            after[10] + (turn[0] + spin * g),
            after[11] + (turn[1] + spin * h),
            after[12] + (turn[2] + spin * i),
        )
        # The corner does not go on into the flat: an impulse along the normal turns it back.
        rebound = vec.dot(v, n) + vec.dot(vec.cross(w, arm), n)
        turn = vec.times(pose.inverse, vec.cross(arm, n))
        back = max(-2.0 * rebound, 0.0) / (1.0 / mass + vec.dot(vec.cross(arm, n), turn))
        x = back / mass
        return [
            *after[:7],
            v[0] + x * n[0],
            v[1] + x * n[1],
            v[2] + x * n[2],
            w[0] + back * turn[0],
            w[1] + back * turn[1],
            w[2] + back * turn[2],
        ]


def _parts(velocity: float, spin: float, square: float) -> tuple[float, float, float]:
    """Return standard deviations: of velocities by an impulse, and of what is left of both.

    Args:
        velocity: m/s, that of each component of a velocity.
        spin: rad/s, that of each component of a spin.
        square: 1/m^2, the variance of a spin's components by an impulse that changes those of the velocity
            by 1.
    """
    velocity, spin = velocity * velocity, spin * spin
    pushed = BY_IMPULSE * (min(velocity, spin / square) if square > 0.0 else velocity)
    return math.sqrt(pushed), math.sqrt(velocity - pushed), math.sqrt(max(spin - pushed * square, 0.0))
