# SPDX-License-Identifier: Apache-2.0
"""The model error of the impact law: random changes of the velocities after strikes.

The impact acts on the body only at the contact. Most of the error is therefore an impulse at the contact
point, which changes velocity and spin together. A small remainder is independent, since the real contact
point is not exactly that of the shape. If several contacts touch, as when a face lands flush, the impulse
acts at their mean position, and one change represents all strikes of the instant.

In recorded strikes of a cube, the scatter is the same for velocity changes from 0.3 to 1.8 m/s. A strike of a
sample that is much weaker than its first one has a smaller scatter, because the full scatter would keep a
body from coming to rest.

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
"""Degrees of freedom of Student's t. Residuals of recorded strikes have heavier tails than normal ones. Of
the tosses to which the law was fitted, 90 % were inside the 90 % regions with 3, and 75 % with the normal
distribution."""

_SAME_MEDIAN: Final = 0.8881
"""Root of the ratio of the medians of the squared distance in three dimensions: chi squared's, and by t."""

BY_IMPULSE: Final = 0.9
"""Share of the variance of velocity or spin, whichever is reached first, that is due to an impulse at the
contact, from residuals of recorded strikes. Those to which the law was fitted are e^153 times as probable
with such impulses as with independent changes of velocity and spin."""

FULL: Final = 0.2
"""Velocity change of a strike, relative to that of the first one, from which on the scatter is not reduced.
For weaker strikes, it decreases in proportion."""

MAX_TURNED_BACK: Final = 100
"""Largest number of reversed approaches, after which a strike keeps the velocities of the law. Four corners
of a plate need some ten."""


class LawSpread:
    """The random velocity changes of n samples after strikes, one `Kick` each."""

    def __init__(self, uncertainty: TossUncertainty, count: int, chance: Generator) -> None:
        velocity, spin = uncertainty.velocity, uncertainty.spin
        self.is_none = velocity == spin == 0.0
        self.kicks = [Kick(velocity, spin) for _ in range(count)]
        self._chance = chance
        self._own: list[Generator] = []

    def draw(self) -> FloatArray:
        """Return random numbers for one strike of all samples, (n, 10), the argument of `Kick.changed`.

        They are drawn for all samples, so that those of one sample do not depend on the others.
        """
        count = len(self.kicks)
        normal = self._chance.standard_normal((count, 9))
        return np.column_stack([normal, self._chance.chisquare(FREEDOM, count)])

    def of_one(self, i: int) -> Kick:
        """Return the `Kick` of one sample, with its own random number generator.

        The results then do not depend on the order in which samples are simulated.
        """
        self._own = self._own or self._chance.spawn(len(self.kicks))
        self.kicks[i].chance = self._own[i]
        return self.kicks[i]


class Kick:
    """Changes the velocities of one sample after its strikes. It can be sent to another process.

    Attributes:
        chance: The sample's own random number generator, or None if the numbers are arguments.
    """

    def __init__(self, velocity: float, spin: float) -> None:
        self.velocity, self.spin = velocity, spin
        self.first = 0.0  # m/s, velocity change of the first strike
        self.chance: Generator | None = None

    def kicked(self, solid: Solid, before: Numbers, after: Numbers, touching: list[Touch]) -> Numbers:
        """Return the changed state after a strike, with numbers from ``chance`` (`changed`)."""
        if self.chance is None:
            raise AssertionError
        by_t = self.chance.chisquare(FREEDOM)
        return self.changed(solid, before, after, touching, [*self.chance.standard_normal(9).tolist(), by_t])

    def changed(
        self, solid: Solid, before: Numbers, after: Numbers, touching: list[Touch], drawn: list[float]
    ) -> Numbers:
        """Return the changed state after a strike, from those before and after it and the touching contacts.

        The first nine of the random numbers ``drawn`` are standard normal, and the last one is chi squared
        with `FREEDOM` degrees of freedom.
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
        # An impulse along the normal reverses the velocity of each corner that approaches its plane.
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
    """Return the standard deviations of velocity due to an impulse, and of the rest of velocity and spin.

    Args:
        velocity: m/s, standard deviation of each component of the velocity.
        spin: rad/s, standard deviation of each component of the spin.
        square: 1/m^2, variance of the spin's components due to an impulse with which the variance of the
            velocity's components is 1.
    """
    velocity, spin = velocity * velocity, spin * spin
    pushed = BY_IMPULSE * (min(velocity, spin / square) if square > 0.0 else velocity)
    return math.sqrt(pushed), math.sqrt(velocity - pushed), math.sqrt(max(spin - pushed * square, 0.0))
