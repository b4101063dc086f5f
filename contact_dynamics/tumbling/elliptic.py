"""The elliptic integrals that tumbling needs, in decimal arithmetic of any precision, without cancellation.

All take the complementary modulus k' = sqrt(1 - m) or Carlson's symmetric arguments, never the parameter m
itself: near the middle axis m is 1 to more digits than a double has, and what matters is the rest.

Precision is that of the caller's decimal context.
"""

from __future__ import annotations

from decimal import Decimal, getcontext


def arithmetic_geometric_mean(a: Decimal, b: Decimal) -> Decimal:
    """Return Gauss's mean of a >= 0 and b >= 0. The quarter period is K = pi / (2 agm(1, k'))."""
    close = Decimal(10) ** (-(getcontext().prec // 2) - 1)
    while abs(a - b) > close * a:
        a, b = (a + b) / 2, (a * b).sqrt()
    return (a + b) / 2


def average_over_period(kc: Decimal, p: Decimal, a: Decimal, b: Decimal) -> Decimal:
    """Return the average over u of (a cn^2 u + b sn^2 u) / (cn^2 u + p sn^2 u), for k' = ``kc`` > 0, p > 0.

    It is Bulirsch's complete integral cel(kc, p, a, b) / K(kc), for a, b >= 0 a sum of positive terms
    (R. Bulirsch, Numerische Mathematik 13, 305, 1969).
    """
    close = Decimal(10) ** (-(getcontext().prec // 2) - 1)
    e, m, p = kc, Decimal(1), p.sqrt()
    b /= p
    mean, other = Decimal(1), kc
    while True:
        f, g = a, e / p
        a, b, p = a + b / p, 2 * (b + f * g), p + g
        g, m = m, m + kc
        mean, other = (mean + other) / 2, (mean * other).sqrt()
        if abs(g - kc) <= close * g:
            return mean * (b + a * m) / (m * (m + p))
        kc = 2 * e.sqrt()
        e = kc * m


def carlson_rf(x: Decimal, y: Decimal, z: Decimal) -> Decimal:
    """Return Carlson's R_F(x, y, z), arguments >= 0, at most one of them 0 (Carlson 1995, DLMF 19.36.1)."""
    tolerance = Decimal(10) ** (-(getcontext().prec // 8))
    x0, y0, mean = x, y, (x + y + z) / 3
    mean0, quarters = mean, Decimal(1)
    spread = max(abs(mean - x), abs(mean - y), abs(mean - z))
    while spread * quarters > tolerance * mean:
        root_x, root_y, root_z = x.sqrt(), y.sqrt(), z.sqrt()
        step = root_x * (root_y + root_z) + root_y * root_z
        x, y, z, mean = (x + step) / 4, (y + step) / 4, (z + step) / 4, (mean + step) / 4
        quarters /= 4
    from_x = (mean0 - x0) * quarters / mean
    from_y = (mean0 - y0) * quarters / mean
    from_z = -from_x - from_y
    e2 = from_x * from_y - from_z * from_z
    e3 = from_x * from_y * from_z
    series = (
        1
        - e2 / 10
        + e3 / 14
        + e2 * e2 / 24
        - 3 * e2 * e3 / 44
        - 5 * e2**3 / 208
        + 3 * e3 * e3 / 104
        + e2 * e2 * e3 / 16
    )
    return series / mean.sqrt()
