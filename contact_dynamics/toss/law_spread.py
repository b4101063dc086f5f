# SPDX-License-Identifier: Apache-2.0
"""The law's own spread: by how much velocities after strikes differ from what the law of impact says.

A body is pushed at the contact alone, whatever the law says. So what the law is off by is an impulse through
the contact, for the most part, and changes of velocity and spin belong together. A small rest does not: the
contact is not quite where the shape has it.

Recorded strikes of a cube have one spread, whether they change the velocity by 0.3 or by 1.8 m/s. A strike
of a sample that is much weaker than its first one has a smaller spread. Otherwise a body that comes to rest
would be shaken by it.
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
    from numpy.typing import NDArray

    from contact_dynamics.numerics.vectors import Vector3
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
        self._sizes = np.array([uncertainty.velocity] * 3 + [uncertainty.spin] * 3)
        self._chance = chance
        self._first = np.zeros(count)  # m/s, by how much the first strike changed the velocity
        self._own: list[Generator] = []
        self.is_none = not self._sizes.any()

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
        drawn, sizes = self._chance.standard_normal((count, 9))[which], _tails(self._chance, count)[which]
        parts = _parts(self._sizes, np.einsum("nij,nij->n", turning, turning) / 3.0)
        drawn *= np.repeat(np.array(parts).T * (sizes * shares)[:, None], 3, axis=1)
        drawn[:, 3:6] += drawn[:, :3]
        drawn[:, 6:] += np.einsum("nij,nj->ni", turning, drawn[:, :3])
        changes: FloatArray = drawn[:, 3:]
        return changes

    def of_one(self, i: int) -> KickOfOne:
        """Return what changes the velocities of one sample after a strike of a single contact.

        Each sample has numbers of its own, so that it does not matter which one goes on first.
        """
        self._own = self._own or self._chance.spawn(len(self._first))
        return KickOfOne(self._sizes, float(self._first[i]), self._own[i])


class KickOfOne:
    """Changes the velocities of one sample after its strikes. It can be handed to another process."""

    def __init__(self, sizes: FloatArray, first: float, chance: Generator) -> None:
        self._sizes, self._chance = sizes, chance
        self._first = first  # m/s, by how much the first strike changed the velocity

    def __call__(self, solid: Solid, before: Numbers, after: Numbers, touch: Touch) -> Numbers:
        """Return the changed state after a strike, for those before and after it and the contact."""
        jump = math.dist(after[7:10], before[7:10])
        first = self._first = self._first or jump
        share = min(jump / (FULL * first), 1.0) if first > 0.0 else 1.0
        size = share * float(_tails(self._chance, 1)[0])
        pose = pose_of(solid, after)
        arm, n = pose.arm(*touch), solid.flats[touch[0]].normal

        def turned(impulse: Vector3) -> Vector3:
            return vec.times(pose.inverse, vec.cross(arm, impulse))

        squares = [vec.dot(turn, turn) for turn in map(turned, AXES)]
        parts = _parts(self._sizes, np.array([solid.mass * solid.mass * sum(squares) / 3.0]))
        drawn = (size * np.repeat(np.ravel(parts), 3) * self._chance.standard_normal(9)).tolist()
        impulse = (solid.mass * drawn[0], solid.mass * drawn[1], solid.mass * drawn[2])
        turn = turned(impulse)
        v = [after[7 + k] + (drawn[k] + drawn[3 + k]) for k in range(3)]
        w = [after[10 + k] + (turn[k] + drawn[6 + k]) for k in range(3)]
        # The corner does not go on into the flat: an impulse along the normal turns it back.
        rebound = vec.dot((v[0], v[1], v[2]), n) + vec.dot(vec.cross((w[0], w[1], w[2]), arm), n)
        turn = turned(n)
        back = max(-2.0 * rebound, 0.0) / (1.0 / solid.mass + vec.dot(vec.cross(arm, n), turn))
        v = [x + back / solid.mass * each for x, each in zip(v, n, strict=True)]
        return [*after[:7], *v, *(x + back * each for x, each in zip(w, turn, strict=True))]


def _parts(sizes: FloatArray, squares: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return standard deviations: of velocities by an impulse, and of what is left of both, (m,).

    Args:
        sizes: (6,), m/s and rad/s, those of velocities and spins.
        squares: (m,), 1/m^2, the variances of a spin's components by an impulse that changes those of the
            velocity by 1.
    """
    velocity, spin = sizes[0] ** 2, sizes[3] ** 2
    most = np.full(len(squares), velocity)
    np.divide(spin, squares, out=most, where=squares > 0.0)
    pushed = BY_IMPULSE * np.minimum(velocity, most)
    return np.sqrt(pushed), np.sqrt(velocity - pushed), np.sqrt(np.maximum(spin - pushed * squares, 0.0))


def _tails(chance: Generator, count: int) -> FloatArray:
    """Return factors, (n,), that make normal numbers those of Student's t with the same median."""
    sizes: FloatArray = _SAME_MEDIAN * np.sqrt(FREEDOM / chance.chisquare(FREEDOM, count))
    return sizes
