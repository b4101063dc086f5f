# SPDX-License-Identifier: Apache-2.0
"""Converts the constants of a motion to the functions of time that `theta` evaluates.

Phases grow linearly with time, and are computed modulo one without loss of digits over any number of turns.
Rate and offset are double-doubles (unevaluated sums of two doubles, 32 digits). The product of rate and time
is computed together with its rounding error (Dekker 1971), and whole turns are subtracted before rounding.
The error of the remainder is therefore about 1e-32 of the number of turns, plus its last bit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import Decimal
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.numerics.arithmetic import DOUBLES, Number, Scalar, within
from contact_dynamics.tolerances import NEGLIGIBLE_TERM
from contact_dynamics.tumbling.elliptic import carlson_rf
from contact_dynamics.tumbling.polhode import Spin, Tumble
from contact_dynamics.tumbling.theta import Bumps, Harmonics, OneFlip, Steady

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import ModuleType

    from contact_dynamics.numerics.arithmetic import Arithmetic
    from contact_dynamics.tumbling.theta import Three, Values
    from contact_dynamics.validation import FloatArray


@dataclass(frozen=True, slots=True, repr=False)
class AttitudeForm:
    """The attitude about L as a function of time."""

    series: Steady | Harmonics | Bumps | OneFlip  # the theta functions, in the form that suits this rotation
    z: LinearPhase  # the phase on the polhode, in the series' unit
    psi: LinearPhase  # the phase of the precession about L, in half turns

    def point(self, seconds: float) -> Values:
        """Return what `theta` says at a time, s."""
        return self.series.values(math, *self.z.fraction(seconds), self.psi.fraction(seconds)[0])

    def cayley_klein(self, seconds: float) -> tuple[complex, complex, float, float]:
        """Return alpha and i beta of the attitude of P in L, of common norm 1, and L_1 / L and L_3 / L."""
        A_re, A_im, B_re, B_im, C, D, tangent = self.point(seconds)
        norm2 = A_re * A_re + A_im * A_im + B_re * B_re + B_im * B_im
        scale = 1.0 / math.sqrt(norm2 * (1.0 + tangent * tangent))
        factor = complex(scale, scale * tangent)
        return factor * complex(A_re, A_im), factor * complex(B_re, B_im), C / norm2, D / norm2

    def momenta(self, seconds: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return L / |L| in P at times (n,), s: three arrays (n,)."""
        A_re, A_im, B_re, B_im, C, D, _ = self.points(seconds)
        norm2 = A_re * A_re + A_im * A_im + B_re * B_re + B_im * B_im
        return C / norm2, 2.0 * (A_re * B_im - A_im * B_re) / norm2, D / norm2

    def points(self, seconds: FloatArray) -> Values:
        """Return what `theta` says at times (n,), s."""
        return self.series.values(np, *self.z.fractions(seconds), self.psi.fractions(seconds)[0])


SWITCH: Final = 1.0
"""Value of pi K'/K below which theta functions are summed as bumps. There both forms reach the last bit with
nine terms or fewer. Well above it, more bumps would be needed, and well below it, the terms of the series
would cancel."""


def attitude_form(rotation: Tumble[Scalar] | Spin[Scalar], numbers: Arithmetic[Scalar]) -> AttitudeForm:
    """Return the attitude about L as a function of time. Its value at time 0 is up to a turn about L."""
    pi, zero = numbers.pi, numbers.number(0.0)
    with within(numbers.rates):
        if isinstance(rotation, Spin):
            psi = linear_phase(rotation.rate / (2 * pi), zero)
            return AttitudeForm(Steady(), linear_phase(zero, zero), psi)
        x, y = _zeros(rotation)
        peaks = math.sqrt(rotation.a2), math.sqrt(rotation.c2)
        if rotation.m1 == 0:
            psi = linear_phase(rotation.precession / (2 * pi), zero)
            return AttitudeForm(one_flip(x, peaks), linear_phase(rotation.omega_p, rotation.u0), psi)
        z_rate, z_offset = rotation.omega_p * rotation.quarter / pi, rotation.u0 * rotation.quarter / pi
        psi = linear_phase(rotation.precession / (2 * pi) - z_rate / 2, -z_offset / 2)
        xi, eta = x * float(rotation.quarter), y * float(rotation.quarter)
        if 2.0 * (xi + eta) > SWITCH:
            return AttitudeForm(harmonics(xi, eta, peaks), linear_phase(z_rate / 2, z_offset / 2), psi)
        return AttitudeForm(bumps(xi, eta, peaks), linear_phase(z_rate, z_offset), psi)


def _zeros(rotation: Tumble[Scalar]) -> tuple[float, float]:
    a2, c2, m = float(rotation.a2), float(rotation.c2), float(rotation.m)
    if m == 0.0:
        return math.sqrt(c2) * carlson_rf(a2, a2, 1.0, numbers=DOUBLES), math.inf
    return zeros(a2, c2, m, DOUBLES)


def zeros(a2: Number, c2: Number, m: Number, numbers: Arithmetic[Number]) -> tuple[Number, Number]:
    """Return x = sn^-1(c | 1 - m), where alpha and beta have their zeros, and y = K' - x, for m > 0."""
    below_one = a2 + m * c2  # 1 - (1 - m) c^2
    sn2, dn2 = a2 / below_one, m / below_one
    x = numbers.sqrt(c2) * carlson_rf(a2, below_one, numbers.number(1.0), numbers=numbers)
    return x, numbers.sqrt(sn2) * carlson_rf(c2 * dn2, dn2, numbers.number(1.0), numbers=numbers)


def harmonics(xi: Any, eta: Any, peaks: tuple[Any, Any], *, functions: ModuleType = math) -> Harmonics:
    """Sum the theta series up to their last term that matters: q = exp(-2 (xi + eta)), r = exp(-xi).

    All may be arrays (n,), with NumPy for ``functions``. ``peaks`` are a and c.
    """
    r, p = functions.exp(-xi), functions.exp(-2.0 * eta)  # p = q e^{2 xi}
    q, s = p * r * r, p * (r * r) * (r * r)  # s = q e^{-2 xi}
    largest_p, largest_q = (p, q) if functions is math else (float(p.max()), float(q.max()))
    A_even, A_odd, B_even, B_odd = [1.0], [0.0], [1.0], [0.0]
    inner, sign, q_2j, p_j, s_j = 1.0, 1.0, 1.0, 1.0, 1.0
    for j in range(1, MAX_TERMS):
        if largest_q ** (2 * j * (j - 1)) * largest_p**j < NEGLIGIBLE_TERM:
            break
        sign, q_2j, p_j, s_j = -sign, q_2j * (q * q), p_j * p, s_j * s
        outer = inner * q_2j  # q^(2 j^2), as inner is q^(2 j (j-1))
        A_even.append(sign * (outer * p_j + inner * s_j))
        A_odd.append(sign * (inner * s_j - outer * p_j))
        B_even.append(sign * (outer * s_j + inner * p_j))
        B_odd.append(sign * (outer * s_j - inner * p_j))
        inner = outer * q_2j
    theta_2, theta_3, square, power = [1.0], [1.0], 1.0, 1.0
    for n in range(1, MAX_TERMS):
        if largest_q ** (n * n) < NEGLIGIBLE_TERM:
            break
        square = square * power * (power * q)  # q^(n^2)
        power = power * q
        theta_2.append(square * power)
        theta_3.append(2.0 * square)
    # At z = 0, where C = a (|A|^2 + |B'|^2) and D = c times the same.
    size = sum(A_even) ** 2 + (r * sum(B_even)) ** 2
    C, D = peaks[0] * size / sum(theta_2), peaks[1] * size / sum(theta_3)
    return Harmonics(
        r=r,
        A_cos=_powers_of_cosine(A_even, COSINES),
        A_sin=_powers_of_cosine(A_odd, SINES)[:-1],
        B_cos=_powers_of_cosine(B_even, COSINES),
        B_sin=_powers_of_cosine(B_odd, SINES)[:-1],
        C=_powers_of_cosine([C * term for term in theta_2], ODD_COSINES),
        D=_powers_of_cosine([D * term for term in theta_3], COSINES),
    )


def bumps(xi: Any, eta: Any, peaks: tuple[Any, Any], *, functions: ModuleType = math) -> Bumps:
    """Weigh the six nearest bumps. All arguments may be arrays (n,), with NumPy for ``functions``."""
    h = 2.0 * (xi + eta)  # pi K'/K
    mu = xi / h
    steepness = math.pi**2 / h
    g = functions.exp(-steepness)
    A_cos, A_sin, B_cos, B_sin = _bump_phases(mu, functions)
    weights = (2.0, 2.0 * g, 2.0 * g**3)  # the values of the pairs of bumps in the middle of a flip
    A_0 = sum(weight * cos for weight, cos in zip(weights, A_cos, strict=True))
    B_0 = sum(weight * cos for weight, cos in zip(weights, B_cos, strict=True))
    size = A_0**2 + B_0**2
    return Bumps(
        steepness=steepness,
        drift=0.5 - mu,
        g=g,
        A_cos=A_cos,
        A_sin=A_sin,
        B_cos=B_cos,
        B_sin=B_sin,
        C=peaks[0] * size / (1.0 - 2.0 * g + g**4),
        D=peaks[1] * size / (1.0 + 2.0 * g + g**4),
    )


def one_flip(x: float, peaks: tuple[float, float]) -> OneFlip:
    """Weigh the two bumps of the separatrix, where K' = pi / 2."""
    A_cos, A_sin, B_cos, B_sin = _bump_phases(x / math.pi, math)
    return OneFlip(A=(A_cos[0], A_sin[0]), B=(B_cos[0], B_sin[0]), C=4.0 * peaks[0], D=4.0 * peaks[1])


def _bump_phases(mu: Any, functions: ModuleType) -> tuple[Three, Three, Three, Three]:
    """Return cos, sin of the phases of three bumps to one side, in A and in B'. The others are opposite."""
    tops = [(k + 0.5) * math.pi for k in range(3)]
    A, B = [top * (mu - 0.5) for top in tops], [top * (mu + 0.5) for top in tops]
    return (
        (functions.cos(A[0]), functions.cos(A[1]), functions.cos(A[2])),
        (functions.sin(A[0]), functions.sin(A[1]), functions.sin(A[2])),
        (functions.cos(B[0]), functions.cos(B[1]), functions.cos(B[2])),
        (functions.sin(B[0]), functions.sin(B[1]), functions.sin(B[2])),
    )


def _powers_of_cosine(coefficients: Sequence[Any], table: Sequence[Sequence[float]]) -> tuple[Any, ...]:
    """Turn a sum over j of coefficient j and row j of ``table``, powers of x, into powers of x.

    The coefficients fall fast enough for powers to be as good as a recurrence.
    """
    powers: list[Any] = [0.0] * len(coefficients)
    for coefficient, row in zip(coefficients, table, strict=False):
        for k, x in enumerate(row):
            powers[k] = powers[k] + coefficient * x
    return tuple(powers)


def _chebyshev(first: Sequence[float], second: Sequence[float]) -> tuple[tuple[float, ...], ...]:
    """Return powers of x of P_0, P_1 and P_j = 2 x P_j-1 - P_j-2."""
    rows = [tuple(first), tuple(second)]
    for _ in range(MAX_TERMS - 2):
        older, newer = (*rows[-2], *(0.0,) * 2), (0.0, *rows[-1])
        rows.append(tuple(2.0 * x - y for x, y in zip(newer, older, strict=False)))
    return tuple(rows)


MAX_TERMS: Final = 10
"""At the switch, exp(-n^2) is negligible from n = 7 on."""

COSINES: Final = _chebyshev((1.0,), (0.0, 1.0))
"""cos 2jz in powers of cos 2z."""

SINES: Final = ((), *_chebyshev((1.0,), (0.0, 2.0)))
"""sin 2jz / sin 2z in powers of cos 2z."""

ODD_COSINES: Final = _chebyshev((1.0,), (-1.0, 2.0))
"""cos (2j+1)z / cos z in powers of cos 2z."""


_SPLITTER: Final = 134217729.0
"""2^27 + 1: splits a double into two halves of 26 bits, whose products are exact."""


@dataclass(frozen=True, slots=True, repr=False)
class LinearPhase:
    """The phase ``rate * t + offset``, in turns."""

    rate: float  # leading part of the rate, turns/s
    rate_rest: float  # what ``rate`` leaves of the rate, turns/s
    rate_upper: float  # upper half of the bits of ``rate``, turns/s
    rate_lower: float  # lower half of the bits of ``rate``, turns/s
    offset: float  # leading part of the offset, turns
    offset_rest: float  # what ``offset`` leaves of the offset, turns

    def fraction(self, seconds: float) -> tuple[float, float]:
        """Return the phase at a time, s, as its fraction in [-1/2, 1/2] and its whole turns."""
        product = self.rate * seconds
        scaled = _SPLITTER * seconds
        upper = scaled - (scaled - seconds)
        lower = seconds - upper
        error = ((self.rate_upper * upper - product) + self.rate_upper * lower + self.rate_lower * upper) + (
            self.rate_lower * lower
        )
        turns = float(round(product))
        rest = product - turns
        total = rest + self.offset
        back = total - rest
        error += (rest - (total - back)) + (self.offset - back)
        more = float(round(total))
        return (total - more) + (error + (self.rate_rest * seconds + self.offset_rest)), turns + more

    def fractions(self, seconds: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return `fraction` for times (n,), s, as arrays (n,) of fractions and of whole turns."""
        product = self.rate * seconds
        upper = _SPLITTER * seconds
        upper -= upper - seconds
        lower = seconds - upper
        error = self.rate_upper * upper
        error -= product
        error += self.rate_upper * lower
        error += self.rate_lower * upper
        error += self.rate_lower * lower
        turns = np.rint(product)
        product -= turns
        total = product + self.offset
        back = total - product
        error += product - (total - back)
        error += self.offset - back
        error += self.rate_rest * seconds + self.offset_rest
        more = np.rint(total)
        total -= more
        total += error
        turns += more
        return total, turns


def linear_phase(rate: Decimal | float, offset: Decimal | float) -> LinearPhase:
    """Return the phase with the given rate, turns/s, and offset, turns, each rounded to 32 digits."""
    high, low = _split(rate)
    scaled = _SPLITTER * high
    upper = scaled - (scaled - high)
    offset_high, offset_low = _split(offset)
    return LinearPhase(
        rate=high,
        rate_rest=low,
        rate_upper=upper,
        rate_lower=high - upper,
        offset=offset_high,
        offset_rest=offset_low,
    )


def _split(number: Decimal | float) -> tuple[float, float]:
    high = float(number)
    return high, float(number - Decimal(high)) if isinstance(number, Decimal) else 0.0
