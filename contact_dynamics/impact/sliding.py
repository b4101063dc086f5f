"""How a contact in space slides under a growing normal impulse (Routh 1860; Keller 1986).

Tangential axes are the principal ones of the tangential block of the contact's inverse inertia, so that with
the normal impulse p, the tangential velocity u and friction -mu u/|u| per unit of normal impulse

    du/dp = k - mu L u/|u|,     dv_n/dp = k_n - mu k . u/|u|,     L = diag(l_1, l_2).

The sliding direction turns at the rate (its component across u)/|u|. That component is the derivative, along
the circle of directions, of E = k . d - mu/2 d.L d: so directions climb E, there are two or four directions
that stay as they are (*invariant* ones), every other maximum of E, and no path circles for ever.

A contact that has stopped stays if friction can hold it, |L^-1 k| <= mu. If not, it leaves in the one
direction d that it can keep while speeding up, (mu L + g) d = k with g > 0: the length of (mu L + g)^-1 k
falls from above 1 to 0 as g grows from 0, so there is exactly one. In that phase dv_n/dp > mu g > 0, since
the inverse inertia is positive definite.
"""

from __future__ import annotations

import math
from typing import NamedTuple


class SlidingLaw(NamedTuple):
    """Coefficients of the equations above, in 1/kg, friction included where named so."""

    l1: float  # 1/kg, first principal tangential inverse inertia, > 0
    l2: float  # 1/kg, second, > 0
    k1: float  # 1/kg, coupling of the first tangential direction with the normal
    k2: float  # 1/kg, coupling of the second
    kn: float  # 1/kg, normal inverse inertia, > 0
    mu: float  # Coulomb's coefficient, >= 0

    @property
    def holds(self) -> bool:
        """Return whether friction can hold a contact that has stopped."""
        return math.hypot(self.k1 / self.l1, self.k2 / self.l2) <= self.mu

    @property
    def scale(self) -> float:
        """Return a bound on the length of du/dp, 1/kg."""
        return math.hypot(self.k1, self.k2) + self.mu * max(self.l1, self.l2)

    def speeding(self, d1: float, d2: float) -> float:
        """Return d|u|/dp, 1/kg, in the unit direction (d1, d2)."""
        return self.k1 * d1 + self.k2 * d2 - self.mu * (self.l1 * d1 * d1 + self.l2 * d2 * d2)

    def turning(self, d1: float, d2: float) -> float:
        """Return |u| times the rate of turning, 1/kg; zero in an invariant direction."""
        return self.k2 * d1 - self.k1 * d2 + self.mu * (self.l1 - self.l2) * d1 * d2

    def attraction(self, d1: float, d2: float) -> float:
        """Return the derivative of `turning` in the angle; negative where near-by directions come closer."""
        return self.mu * (self.l1 - self.l2) * (d1 * d1 - d2 * d2) - self.k1 * d1 - self.k2 * d2

    def lifting(self, d1: float, d2: float) -> float:
        """Return dv_n/dp, 1/kg, while sliding in the unit direction (d1, d2); negative where sliding jams."""
        return self.kn - self.mu * (self.k1 * d1 + self.k2 * d2)

    def after_stop(self) -> tuple[float, float, float, float]:
        """Return what a stopped contact does: d(I_1, I_2)/dp, dv_n/dp, d|u|/dp (0 if held)."""
        if self.holds:
            i1, i2 = -self.k1 / self.l1, -self.k2 / self.l2
            return i1, i2, self.kn + self.k1 * i1 + self.k2 * i2, 0.0
        d1, d2, speeding = self.escape()
        return -self.mu * d1, -self.mu * d2, self.lifting(d1, d2), speeding

    def escape(self) -> tuple[float, float, float]:
        """Return the one direction in which a contact that is not held leaves, and d|u|/dp along it."""
        m1, m2 = self.mu * self.l1, self.mu * self.l2
        g = max(0.0, abs(self.k1) - m1, abs(self.k2) - m2)
        # Newton's method on 1/|d| - 1, concave and rising: it comes from the left and does not overshoot.
        for _ in range(60):
            d1, d2 = self.k1 / (m1 + g), self.k2 / (m2 + g)
            square = d1 * d1 + d2 * d2
            length = math.sqrt(square)
            step = (length - 1.0) * square / (d1 * d1 / (m1 + g) + d2 * d2 / (m2 + g))
            g += step
            if step <= 1e-16 * g:
                break
        d1, d2 = self.k1 / (m1 + g), self.k2 / (m2 + g)
        length = math.hypot(d1, d2)
        return d1 / length, d2 / length, g
