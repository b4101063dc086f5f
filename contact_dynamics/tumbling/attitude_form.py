"""From the constants of a motion to the functions of time that `theta` evaluates."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, TypeAlias

from contact_dynamics.tumbling.arithmetic import DOUBLES, Number, within
from contact_dynamics.tumbling.double_double import linear_phase
from contact_dynamics.tumbling.elliptic import carlson_rf
from contact_dynamics.tumbling.polhode import Spin, Tumble
from contact_dynamics.tumbling.theta import Bumps, Harmonics, OneFlip, Steady

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from contact_dynamics.tumbling.arithmetic import Arithmetic
    from contact_dynamics.tumbling.double_double import LinearPhase

AttitudeForm: TypeAlias = "Steady | Harmonics | Bumps | OneFlip"

SWITCH: Final = 1.0
"""Value of pi K'/K below which theta functions are summed as bumps. There both forms reach the last bit with
nine terms or fewer; well above it bumps would need more of them, well below it the series' terms would
cancel."""

NEGLIGIBLE: Final = 1e-18
"""Relative to the largest term of a sum: far below the last bit."""

STEEPEST: Final = 600.0
"""Exponent of the ratio of neighbouring bumps above which only two of them are above the range of doubles."""


def attitude_form(rotation: Tumble[Number] | Spin[Number], numbers: Arithmetic[Number]) -> AttitudeForm:
    """Return the attitude about L as a function of time; its value at time 0 is up to a turn about L."""
    pi = numbers.pi
    with within(numbers.rates):
        if isinstance(rotation, Spin):
            return Steady(psi=linear_phase(rotation.rate / (2 * pi), numbers.number(0.0)))
        if rotation.m1 == 0:
            return _one_flip(rotation, numbers)
        a, c = math.sqrt(rotation.a2), math.sqrt(rotation.c2)
        x, y = _zeros(rotation)
        xi, eta = x * float(rotation.quarter), y * float(rotation.quarter)
        z_rate, z_offset = rotation.omega_p * rotation.quarter / pi, rotation.u0 * rotation.quarter / pi
        psi = linear_phase(rotation.precession / (2 * pi) - z_rate / 2, -z_offset / 2)
        if 2.0 * (xi + eta) > SWITCH:
            return _harmonics(xi, eta, (a, c), linear_phase(z_rate / 2, z_offset / 2), psi)
        return _bumps(xi, eta, (a, c), linear_phase(z_rate, z_offset), psi)


def _zeros(rotation: Tumble[Number]) -> tuple[float, float]:
    """Return x = sn^-1(c | 1 - m), which says where alpha and beta have their zeros, and y = K' - x."""
    a2, c2, m = float(rotation.a2), float(rotation.c2), float(rotation.m)
    below_one = a2 + m * c2  # 1 - (1 - m) c^2
    x = math.sqrt(c2) * carlson_rf(a2, below_one, 1.0, numbers=DOUBLES)
    if m == 0.0:
        return x, math.inf
    sn2, dn2 = a2 / below_one, m / below_one
    return x, math.sqrt(sn2) * carlson_rf(c2 * dn2, dn2, 1.0, numbers=DOUBLES)


def _harmonics(
    xi: float, eta: float, peaks: tuple[float, float], z: LinearPhase, psi: LinearPhase
) -> Harmonics:
    """Sum the theta series as far as they matter: q = exp(-2 (xi + eta)), r = exp(-xi)."""
    r, p = math.exp(-xi), math.exp(-2.0 * eta)  # p = q e^{2 xi}
    q, s = p * r * r, p * r**4  # s = q e^{-2 xi}
    A_even, A_odd, B_even, B_odd = [1.0], [0.0], [1.0], [0.0]
    for j in range(1, MOST_TERMS):
        sign = -1.0 if j % 2 else 1.0
        inner, outer = sign * q ** (2 * j * (j - 1)), sign * q ** (2 * j * j)
        if abs(inner) * p**j < NEGLIGIBLE:
            break
        A_even.append(outer * p**j + inner * s**j)
        A_odd.append(inner * s**j - outer * p**j)
        B_even.append(outer * s**j + inner * p**j)
        B_odd.append(outer * s**j - inner * p**j)
    theta_2, theta_3 = [1.0], [1.0]
    for n in range(1, MOST_TERMS):
        if q ** (n * n) < NEGLIGIBLE:
            break
        theta_2.append(q ** (n * (n + 1)))
        theta_3.append(2.0 * q ** (n * n))
    # At z = 0, where C = a (|A|^2 + |B'|^2) and D = c times the same.
    size = sum(A_even) ** 2 + (r * sum(B_even)) ** 2
    C, D = peaks[0] * size / sum(theta_2), peaks[1] * size / sum(theta_3)
    return Harmonics(
        z=z,
        psi=psi,
        r=r,
        A_cos=_powers_of_cosine(A_even, COSINES),
        A_sin=_powers_of_cosine(A_odd, SINES)[:-1],
        B_cos=_powers_of_cosine(B_even, COSINES),
        B_sin=_powers_of_cosine(B_odd, SINES)[:-1],
        C=_powers_of_cosine([C * term for term in theta_2], ODD_COSINES),
        D=_powers_of_cosine([D * term for term in theta_3], COSINES),
    )


def _bumps(xi: float, eta: float, peaks: tuple[float, float], z: LinearPhase, psi: LinearPhase) -> Bumps:
    h = 2.0 * (xi + eta)  # pi K'/K
    mu = xi / h
    steepness = math.pi**2 / h
    g = math.exp(-steepness) if steepness < STEEPEST else 0.0
    A_angles, B_angles = _angles(mu)
    weights = (2.0, 2.0 * g, 2.0 * g**3)  # of the pairs of bumps, in the middle of a flip
    A_0 = sum(weight * math.cos(angle) for weight, angle in zip(weights, A_angles, strict=True))
    B_0 = sum(weight * math.cos(angle) for weight, angle in zip(weights, B_angles, strict=True))
    size = A_0**2 + B_0**2
    return Bumps(
        z=z,
        psi=psi,
        steepness=steepness,
        drift=0.5 - mu,
        g=g,
        A_cos=_each(math.cos, A_angles),
        A_sin=_each(math.sin, A_angles),
        B_cos=_each(math.cos, B_angles),
        B_sin=_each(math.sin, B_angles),
        C=peaks[0] * size / (1.0 - 2.0 * g + g**4),
        D=peaks[1] * size / (1.0 + 2.0 * g + g**4),
    )


def _one_flip(rotation: Tumble[Number], numbers: Arithmetic[Number]) -> OneFlip:
    A_angles, B_angles = _angles(_zeros(rotation)[0] / math.pi)
    return OneFlip(
        u=linear_phase(rotation.omega_p, rotation.u0),
        psi=linear_phase(rotation.precession / (2 * numbers.pi), numbers.number(0.0)),
        A=(math.cos(A_angles[0]), math.sin(A_angles[0])),
        B=(math.cos(B_angles[0]), math.sin(B_angles[0])),
        C=4.0 * math.sqrt(rotation.a2),
        D=4.0 * math.sqrt(rotation.c2),
    )


def _angles(mu: float) -> tuple[list[float], list[float]]:
    """Return the phases, rad, of the three bumps to one side in A and in B'; the others' are opposite."""
    tops = [(k + 0.5) * math.pi for k in range(3)]
    return [top * (mu - 0.5) for top in tops], [top * (mu + 0.5) for top in tops]


def _each(function: Callable[[float], float], angles: Sequence[float]) -> tuple[float, float, float]:
    return function(angles[0]), function(angles[1]), function(angles[2])


def _powers_of_cosine(coefficients: Sequence[float], table: Sequence[Sequence[float]]) -> tuple[float, ...]:
    """Turn a sum over j of coefficient j and row j of ``table``, powers of x, into powers of x.

    The coefficients fall fast enough for powers to be as good as a recurrence.
    """
    powers = [0.0] * len(coefficients)
    for coefficient, row in zip(coefficients, table, strict=False):
        for k, x in enumerate(row):
            powers[k] += coefficient * x
    return tuple(powers)


def _chebyshev(first: Sequence[float], second: Sequence[float]) -> tuple[tuple[float, ...], ...]:
    """Return powers of x of P_0, P_1 and P_j = 2 x P_j-1 - P_j-2."""
    rows = [tuple(first), tuple(second)]
    for _ in range(MOST_TERMS - 2):
        older, newer = (*rows[-2], *(0.0,) * 2), (0.0, *rows[-1])
        rows.append(tuple(2.0 * x - y for x, y in zip(newer, older, strict=False)))
    return tuple(rows)


MOST_TERMS: Final = 10
"""At the switch, exp(-n^2) is negligible from n = 7 on."""

COSINES: Final = _chebyshev((1.0,), (0.0, 1.0))
"""cos 2jz in powers of cos 2z."""

SINES: Final = ((), *_chebyshev((1.0,), (0.0, 2.0)))
"""sin 2jz / sin 2z in powers of cos 2z."""

ODD_COSINES: Final = _chebyshev((1.0,), (-1.0, 2.0))
"""cos (2j+1)z / cos z in powers of cos 2z."""
