# SPDX-License-Identifier: Apache-2.0
"""The law's own spread: by how much velocities after strikes differ from what the law of impact says.

A body is pushed at the contact alone, whatever the law says. So what the law is off by is an impulse through
the contact, for the most part, and changes of velocity and spin belong together. A small rest does not: the
contact is not quite where the shape has it. If several contacts touch, as under a face that lands flush, the
impulse is through their middle, and one spread is that of all strikes of the instant together.

Recorded strikes of a cube have one spread, whether they change the velocity by 0.3 or by 1.8 m/s. A strike
of a sample that is much weaker than its first one has a smaller spread. Otherwise a body that comes to rest
would be shaken by it.

`law_spread.pxd` gives the C types with which this file compiles.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.numerics.vectors import AXES
from contact_dynamics.toss import vectors as vec
from contact_dynamics.toss.solid import pose_of

if TYPE_CHECKING:
    from numpy.random import Generator

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

MAX_TURNED_BACK: Final = 100
"""Approaches that are turned back, after which a strike keeps the velocities of the law. Four corners of a
plate need some ten."""


class LawSpread:
    """What changes the velocities of n samples after strikes: one `Kick` each."""

    def __init__(self, uncertainty: TossUncertainty, count: int, chance: Generator) -> None:
        velocity, spin = uncertainty.velocity, uncertainty.spin
        self.is_none = velocity == spin == 0.0
        self.kicks = [Kick(velocity, spin) for _ in range(count)]
        self._chance = chance
        self._own: list[Generator] = []

    def draw(self) -> FloatArray:
        """Return numbers for one more strike of all samples, (n, 10), as `Kick.changed` takes them.

        They are drawn for all, so that a sample's do not depend on what others do.
        """
        count = len(self.kicks)
        normal = self._chance.standard_normal((count, 9))
        return np.column_stack([normal, self._chance.chisquare(FREEDOM, count)])

    def of_one(self, i: int) -> Kick:
        """Return what changes the velocities of one sample from now on.

        Each sample has numbers of its own then, so that it does not matter which one goes on first.
        """
        self._own = self._own or self._chance.spawn(len(self.kicks))
        self.kicks[i].chance = self._own[i]
        return self.kicks[i]


class Kick:
    """Changes the velocities of one sample after its strikes. It can be handed to another process.

    Attributes:
        chance: Where its numbers are drawn from, if they are its own.
    """

    def __init__(self, velocity: float, spin: float) -> None:
        self.velocity, self.spin = velocity, spin
        self.first = 0.0  # m/s, by how much the first strike changed the velocity
        self.chance: Generator | None = None

    def kicked(self, solid: Solid, before: Numbers, after: Numbers, touching: list[Touch]) -> Numbers:
        """Return the changed state after a strike, with numbers of the sample's own (`changed`)."""
        if self.chance is None:
            raise AssertionError
        by_t = self.chance.chisquare(FREEDOM)
        return self.changed(solid, before, after, touching, [*self.chance.standard_normal(9).tolist(), by_t])

    def changed(
        self, solid: Solid, before: Numbers, after: Numbers, touching: list[Touch], drawn: list[float]
    ) -> Numbers:
        """Return the changed state after a strike, for those before and after it and all that touches.

        Of the numbers that are drawn, nine are normal, and the last one is chi squared's with `FREEDOM`.
        """
        jump = vec.norm((after[7] - before[7], after[8] - before[8], after[9] - before[9]))
        self.first = self.first or jump
        size = min(jump / (FULL * self.first), 1.0) if self.first > 0.0 else 1.0
        a, b, c, d, e, f, g, h, i, by_t = drawn
        size *= _SAME_MEDIAN * math.sqrt(FREEDOM / by_t)
        pose, mass, share = pose_of(solid, after), solid.mass, 1.0 / len(touching)
        arm = (0.0, 0.0, 0.0)
        for surface, corner in touching:
            arm = vec.plus(arm, share, pose.arm(surface, corner))
        square = 0.0
        for axis in AXES:
            turn = vec.times(pose.inverse, vec.cross(arm, axis))
            square += vec.dot(turn, turn)
        pushed, velocity, spin = _parts(self.velocity, self.spin, mass * mass * square / 3.0)
        pushed, velocity, spin = size * pushed, size * velocity, size * spin
        a, b, c = pushed * a, pushed * b, pushed * c
        turn = vec.times(pose.inverse, vec.cross(arm, (mass * a, mass * b, mass * c)))
        v = (after[7] + (a + velocity * d), after[8] + (b + velocity * e), after[9] + (c + velocity * f))
        w = (
            after[10] + (turn[0] + spin * g),
            after[11] + (turn[1] + spin * h),
            after[12] + (turn[2] + spin * i),
        )
        # No corner goes on into its flat: an impulse along the normal turns it back.
        n = (0.0, 0.0, 0.0)
        for _ in range(MAX_TURNED_BACK):
            least = 0.0
            for surface, corner in touching:
                each, normal = pose.arm(surface, corner), solid.flats[surface].normal
                rate = vec.dot(v, normal) + vec.dot(vec.cross(w, each), normal)
                if rate < least:
                    least, arm, n = rate, each, normal
            if least == 0.0:
                return [*after[:7], v[0], v[1], v[2], w[0], w[1], w[2]]
            moment = vec.cross(arm, n)
            turn = vec.times(pose.inverse, moment)
            back = -2.0 * least / (1.0 / mass + vec.dot(moment, turn))
            v, w = vec.plus(v, back / mass, n), vec.plus(w, back, turn)
        return after


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
