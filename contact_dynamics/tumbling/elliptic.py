# SPDX-License-Identifier: Apache-2.0
"""Computes elliptic integrals without cancellation, in doubles or in decimal arithmetic.

All functions take the complementary modulus k' = sqrt(1 - m) or Carlson's symmetric arguments instead of the
parameter m, because near the middle axis m equals 1 to more digits than a double has, and the difference
1 - m matters.

The formulas are the same for all types of numbers of `arithmetic`. Decimals have the digits of the caller's
context.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from contact_dynamics.numerics.arithmetic import Arithmetic, Number


def average_over_period(
    kc: Number, p: Number, a: Number, b: Number, *, numbers: Arithmetic[Number]
) -> tuple[Number, Number]:
    """Return pi / 2K, and the average over u of (a cn^2 u + b sn^2 u) / (cn^2 u + p sn^2 u).

    It is required that k' = ``kc`` > 0 and p > 0. For a, b >= 0 all terms are positive. The average is
    Bulirsch's complete integral cel(kc, p, a, b) / K(kc), and pi / 2K, Gauss's mean of 1 and k', comes with
    it (R. Bulirsch, Numerische Mathematik 13, 305, 1969).
    """
    sqrt = numbers.sqrt
    e, m, p = kc, numbers.number(1.0), sqrt(p)
    b, scale = b / p, numbers.number(1.0)
    while True:
        f, g = a, e / p
        a, b, p = a + b / p, 2 * (b + f * g), p + g
        g, m, scale = m, m + kc, 2 * scale
        if not numbers.any(abs(g - kc) > numbers.half_precise * g):
            mean = m / scale
            return mean, mean * (b + a * m) / (m * (m + p))
        kc = 2 * sqrt(e)
        e = kc * m


def carlson_rf(x: Number, y: Number, z: Number, *, numbers: Arithmetic[Number]) -> Number:
    """Return Carlson's R_F(x, y, z), arguments >= 0, at most one of them 0 (Carlson 1995, DLMF 19.36.1)."""
    sqrt = numbers.sqrt
    x0, y0, mean = x, y, (x + y + z) / 3
    mean0, quarters = mean, numbers.number(1.0)
    spread = numbers.largest(abs(mean - x), abs(mean - y), abs(mean - z))
    while numbers.any(spread * quarters > numbers.eighth_precise * mean):
        root_x, root_y, root_z = sqrt(x), sqrt(y), sqrt(z)
        step = root_x * (root_y + root_z) + root_y * root_z
        x, y, z, mean = (x + step) / 4, (y + step) / 4, (z + step) / 4, (mean + step) / 4
        quarters = quarters / 4
    from_x = (mean0 - x0) * quarters / mean
    from_y = (mean0 - y0) * quarters / mean
    from_z = -from_x - from_y
    e2 = from_x * from_y - from_z * from_z
    e3 = from_x * from_y * from_z
    series = 1 - e2 / 10 + e3 / 14 + e2 * (e2 / 24 - 3 * e3 / 44)
    series = series + 3 * e3 * e3 / 104 + e2 * e2 * (e3 / 16 - 5 * e2 / 208)
    return series / sqrt(mean)
