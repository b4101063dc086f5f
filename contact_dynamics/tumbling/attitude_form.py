"""From the constants of a motion to the functions of time that `theta` evaluates."""

from __future__ import annotations

import math
from decimal import Decimal, localcontext
from typing import TYPE_CHECKING, Final, TypeAlias

from contact_dynamics.tumbling.double_double import linear_phase
from contact_dynamics.tumbling.elliptic import carlson_rf
from contact_dynamics.tumbling.polhode import PHASES, PI, Spin, Tumble
from contact_dynamics.tumbling.theta import Bumps, Harmonics, OneFlip, Steady

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

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


def attitude_form(motion: Spin | Tumble) -> AttitudeForm:
    """Return the attitude about L as a function of time; its value at time 0 is up to a turn about L."""
    with localcontext(PHASES):
        if isinstance(motion, Spin):
            return Steady(psi=linear_phase(motion.rate / (2 * PI), Decimal(0)))
        if motion.m1 == 0:
            return _one_flip(motion)
        a, c, (x, y) = float(motion.a2.sqrt()), float(motion.c2.sqrt()), _zeros(motion)
        xi, eta = x * float(motion.quarter), y * float(motion.quarter)
        z_rate, z_offset = motion.omega_p * motion.quarter / PI, motion.u0 * motion.quarter / PI
        psi = linear_phase(motion.precession / (2 * PI) - z_rate / 2, -z_offset / 2)
        if 2.0 * (xi + eta) > SWITCH:
            return _harmonics(xi, eta, (a, c), linear_phase(z_rate / 2, z_offset / 2), psi)
        return _bumps(xi, eta, (a, c), linear_phase(z_rate, z_offset), psi)


def _zeros(motion: Tumble) -> tuple[float, float]:
    """Return x = sn^-1(c | 1 - m), which says where alpha and beta have their zeros, and y = K' - x."""
    below_one = motion.a2 + motion.m * motion.c2  # 1 - (1 - m) c^2
    x = motion.c2.sqrt() * carlson_rf(motion.a2, below_one, Decimal(1))
    if motion.m == 0:
        return float(x), math.inf
    sn2, dn2 = motion.a2 / below_one, motion.m / below_one
    return float(x), float(sn2.sqrt() * carlson_rf(motion.c2 * dn2, dn2, Decimal(1)))


def _harmonics(
    xi: float, eta: float, peaks: tuple[float, float], z: LinearPhase, psi: LinearPhase
) -> Harmonics:
    """Sum the theta series as far as they matter: q = exp(-2 (xi + eta)), r = exp(-xi)."""
    r, p = math.exp(-xi), math.exp(-2.0 * eta)  # p = q e^{2 xi}
    q, s = p * r * r, p * r**4  # s = q e^{-2 xi}
    A_even, A_odd, B_even, B_odd = [1.0], [0.0], [1.0], [0.0]
    for j in range(1, 100):
        sign = -1.0 if j % 2 else 1.0
        inner, outer = sign * q ** (2 * j * (j - 1)), sign * q ** (2 * j * j)
        if abs(inner) * p**j < NEGLIGIBLE:
            break
        A_even.append(outer * p**j + inner * s**j)
        A_odd.append(inner * s**j - outer * p**j)
        B_even.append(outer * s**j + inner * p**j)
        B_odd.append(outer * s**j - inner * p**j)
    a, c = peaks
    theta_2, theta_3 = [1.0], [1.0]
    while max(theta_2[-1], theta_3[-1]) > NEGLIGIBLE:
        n = len(theta_3)
        theta_2.append(q ** (n * (n + 1)))
        theta_3.append(2.0 * q ** (n * n))
    size = (
        sum(A_even) ** 2 + (r * sum(B_even)) ** 2
    )  # |A|^2 + |B'|^2 at z = 0, where C is a and D is c times it
    return Harmonics(
        z=z,
        psi=psi,
        r=r,
        A_cos=_powers_of_cosine(A_even, 1.0),
        A_sin=_powers_of_cosine(A_odd[1:], 2.0),
        B_cos=_powers_of_cosine(B_even, 1.0),
        B_sin=_powers_of_cosine(B_odd[1:], 2.0),
        C=_odd_cosines([a * size * term / sum(theta_2) for term in theta_2]),
        D=_powers_of_cosine([c * size * term / sum(theta_3) for term in theta_3], 1.0),
    )


def _bumps(xi: float, eta: float, peaks: tuple[float, float], z: LinearPhase, psi: LinearPhase) -> Bumps:
    h = 2.0 * (xi + eta)  # pi K'/K
    mu = xi / h
    steepness = math.pi**2 / h
    g = math.exp(-steepness) if steepness < STEEPEST else 0.0
    a, c = peaks
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
        C=a * size / (1.0 - 2.0 * g + g**4),
        D=c * size / (1.0 + 2.0 * g + g**4),
    )


def _one_flip(motion: Tumble) -> OneFlip:
    x, _ = _zeros(motion)
    A_angles, B_angles = _angles(x / math.pi)
    return OneFlip(
        u=linear_phase(motion.omega_p, motion.u0),
        psi=linear_phase(motion.precession / (2 * PI), Decimal(0)),
        A=(math.cos(A_angles[0]), math.sin(A_angles[0])),
        B=(math.cos(B_angles[0]), math.sin(B_angles[0])),
        C=4.0 * float(motion.a2.sqrt()),
        D=4.0 * float(motion.c2.sqrt()),
    )


def _angles(mu: float) -> tuple[list[float], list[float]]:
    """Return the phases, rad, of the three bumps to one side in A and in B'; the others' are opposite."""
    tops = [(k + 0.5) * math.pi for k in range(3)]
    return [top * (mu - 0.5) for top in tops], [top * (mu + 0.5) for top in tops]


def _each(function: Callable[[float], float], angles: Sequence[float]) -> tuple[float, float, float]:
    return function(angles[0]), function(angles[1]), function(angles[2])


def _powers_of_cosine(coefficients: Sequence[float], slope: float) -> tuple[float, ...]:
    """Turn sum c_j P_j(x) into powers of x, for Chebyshev's P_0 = 1, P_1 = slope x, P_j = 2 x P_j-1 - P_j-2.

    Slope 1 serves cos jy, slope 2 sin (j+1)y / sin y, with x = cos y. The coefficients fall fast enough for
    powers.
    """
    powers = [0.0] * len(coefficients)
    older, newer = [0.0], [1.0]
    for j, coefficient in enumerate(coefficients):
        for k, x in enumerate(newer):
            powers[k] += coefficient * x
        factor = 2.0 if j else slope
        following = [0.0, *(factor * x for x in newer)]
        if j:
            for k, x in enumerate(older):
                following[k] -= x
        older, newer = newer, following
    return tuple(powers)


def _odd_cosines(coefficients: Sequence[float]) -> tuple[float, ...]:
    """Turn sum c_n cos (2n+1)z / cos z into powers of cos 2z.

    cos (2n+1)z / cos z is 2 (cos 2nz - cos (2n-2)z + ...), and half of the last, which is 1.
    """
    cosines = [0.0] * len(coefficients)
    for n, coefficient in enumerate(coefficients):
        for k in range(n + 1):
            cosines[k] += coefficient * (-1.0) ** (n - k) * (2.0 if k else 1.0)
    return _powers_of_cosine(cosines, 1.0)
