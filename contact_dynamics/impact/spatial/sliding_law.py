"""How a contact in space slides under a growing normal impulse (Routh 1860; Keller 1986).

Tangential axes are the principal ones of the tangential block of the contact's inverse inertia. With the
normal impulse p, the tangential velocity u, and friction -mu u/|u| per unit of normal impulse, this gives

    du/dp = k - mu L u/|u|,     dv_n/dp = k_n - mu k . u/|u|,     L = diag(l_1, l_2).

The sliding direction turns at the rate (component of du/dp across u)/|u|. That component is the derivative
of E = k . d - mu/2 d.L d along the circle of directions d. So directions climb E, and no path circles for
ever. There are two or four directions that stay as they are (*invariant* ones), and every other one is a
maximum of E.

A contact that has stopped stays if friction can hold it, |L^-1 k| <= mu. If not, it leaves in the one
direction d that it can keep while speeding up, (mu L + g) d = k with g > 0. There is exactly one, because the
length of (mu L + g)^-1 k falls from above 1 to 0 as g grows from 0. While it leaves, dv_n/dp > mu g > 0,
since the inverse inertia is positive definite.

The formulas of the law serve one case as well as many at once (`elementwise`).
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from contact_dynamics.impact.planar.routh import LARGEST_FRICTION
from contact_dynamics.numerics.elementwise import Number, larger, smaller, sqrt
from contact_dynamics.tolerances import (
    ESCAPE_ARRIVED,
    LEAST_FRICTION,
    SETTLED_TURN,
    SMALLEST,
    STRAIGHT,
    UNCOUPLED,
)

ESCAPE_ROUNDS: Final = 60
"""Bound on the iterations for the direction in which a contact leaves. They converge quadratically."""

TERMS_ROUNDING: Final = 1.0 / 16.0
"""Share of the terms that a turning is summed from which counts beside the attraction: 16 times less than
`SETTLED_TURN` are two roundings."""


def followed_friction(mu: Number) -> Number:
    """Return the coefficient with which a path is followed: none where it is too small to change anything.

    Otherwise the path would be followed to a stop that is farther away than numbers reach.
    """
    followed: Number = smaller(mu, LARGEST_FRICTION) * (mu >= LEAST_FRICTION)
    return followed


class SlidingLaw(NamedTuple):
    """Coefficients of the equations above.

    Attributes:
        l1: 1/kg, first principal tangential inverse inertia, > 0.
        l2: 1/kg, second principal tangential inverse inertia, > 0.
        k1: 1/kg, coupling of the first tangential direction with the normal.
        k2: 1/kg, coupling of the second tangential direction with the normal.
        kn: 1/kg, normal inverse inertia, > 0.
        mu: Coulomb's coefficient, >= 0.
    """

    l1: Number
    l2: Number
    k1: Number
    k2: Number
    kn: Number
    mu: Number

    @property
    def holds(self) -> Number:
        """Return whether friction can hold a contact that has stopped."""
        x, y = self.k1 / self.l1, self.k2 / self.l2
        return sqrt(x * x + y * y) <= self.mu

    @property
    def scale(self) -> Number:
        """Return a bound on the length of du/dp, 1/kg."""
        coupling = sqrt(self.k1 * self.k1 + self.k2 * self.k2)
        return coupling + self.mu * larger(self.l1, self.l2)

    def speeding(self, d1: Number, d2: Number) -> Number:
        """Return d|u|/dp, 1/kg, in the unit direction (d1, d2)."""
        return self.k1 * d1 + self.k2 * d2 - self.mu * (self.l1 * d1 * d1 + self.l2 * d2 * d2)

    def turning(self, d1: Number, d2: Number) -> Number:
        """Return |u| times the rate of turning, 1/kg. It is zero in an invariant direction."""
        return self.k2 * d1 - self.k1 * d2 + self.mu * (self.l1 - self.l2) * d1 * d2

    def attraction(self, d1: Number, d2: Number) -> Number:
        """Return the derivative of `turning` in the angle. It is negative where neighbours come closer."""
        return self.mu * (self.l1 - self.l2) * (d1 * d1 - d2 * d2) - self.k1 * d1 - self.k2 * d2

    def keeps(self, d1: Number, d2: Number, *, started: bool) -> Number:
        """Return whether sliding keeps the unit direction (d1, d2), to rounding.

        A direction that attracts its neighbours is kept once no more than rounding is left of its turning.
        One that repels them is kept within the rounding of the coefficients, and only at first: sliding that
        has swerved leaves such directions.
        """
        turning, attraction = abs(self.turning(d1, d2)), self.attraction(d1, d2)
        terms = abs(self.k2 * d1) + abs(self.k1 * d2) + self.mu * abs((self.l1 - self.l2) * d1 * d2)
        settled = (attraction < 0.0) & (turning <= SETTLED_TURN * larger(-attraction, TERMS_ROUNDING * terms))
        if started:
            return settled
        rounding = larger(STRAIGHT * self.scale, UNCOUPLED * (self.l1 + self.l2))
        return settled | ((attraction >= 0.0) & (turning <= rounding))

    def settled(self, d1: Number, d2: Number) -> tuple[Number, Number]:
        """Return the invariant direction beside a kept one that attracts, and else the direction itself.

        It is one of Newton's steps away. The rates along it are right even where they are small beside the
        rate at which neighbours come closer, as for slender bodies.
        """
        attraction = self.attraction(d1, d2)
        step = (attraction < 0.0) * self.turning(d1, d2) / (attraction - SMALLEST)
        return d1 + step * d2, d2 - step * d1

    def lifting(self, d1: Number, d2: Number) -> Number:
        """Return dv_n/dp, 1/kg, while sliding in the unit direction (d1, d2). It is negative if that jams."""
        return self.kn - self.mu * (self.k1 * d1 + self.k2 * d2)

    def while_held(self) -> tuple[Number, Number, Number]:
        """Return d(I_1, I_2)/dp and dv_n/dp of a stopped contact that friction holds."""
        i1, i2 = -self.k1 / self.l1, -self.k2 / self.l2
        return i1, i2, self.kn + self.k1 * i1 + self.k2 * i2

    def escape_step(self, g: Number) -> tuple[Number, Number, Number]:
        """Return (mu L + g)^-1 k, and the step from ``g`` that makes its length 1.

        This is Newton's method on 1/|d| - 1, which is concave and rises. So the steps come from the left and
        do not overshoot.
        """
        m1, m2 = self.mu * self.l1 + g, self.mu * self.l2 + g
        d1, d2 = self.k1 / m1, self.k2 / m2
        square = d1 * d1 + d2 * d2
        step = (sqrt(square) - 1.0) * square / (d1 * d1 / m1 + d2 * d2 / m2)
        return d1, d2, step

    def least_escape(self) -> Number:
        """Return a g, 1/kg, to begin `escape_step` with."""
        g = larger(abs(self.k1) - self.mu * self.l1, abs(self.k2) - self.mu * self.l2)
        return larger(g, 0.0)

    def after_stop(self) -> tuple[float, float, float, float]:
        """Return d(I_1, I_2)/dp, dv_n/dp and d|u|/dp of one stopped contact. If held, the last is 0."""
        if self.holds:
            return (*self.while_held(), 0.0)
        g = self.least_escape()
        for _ in range(ESCAPE_ROUNDS):
            step = self.escape_step(g)[2]
            g += step
            if step <= ESCAPE_ARRIVED * g:
                break
        d1, d2, _ = self.escape_step(g)
        length = math.sqrt(d1 * d1 + d2 * d2)
        d1, d2 = d1 / length, d2 / length
        return -self.mu * d1, -self.mu * d2, self.lifting(d1, d2), g
