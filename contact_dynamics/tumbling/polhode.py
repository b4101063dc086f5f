"""The constants of a torque-free rotation, from its initial angular velocity, in extended precision.

Jacobi's order of axes: the angular velocity circles axis 3, which is the major axis (largest moment) where
L^2 > 2 T I_2 and the minor one where L^2 < 2 T I_2; axis 2 is the middle one. With a, b, c > 0,

    L_1 / L = a cn u,    L_2 / L = b sn u,    L_3 / L = c dn u,    u = omega_p t + u_0,

(Whittaker, Analytical Dynamics, 69; van Zon and Schofield, J. Comput. Phys. 225, 145, 2007, eq. 13 to 18).
Differences such as L^2 - 2 T I_i are summed as I_j (I_j - I_i) w_j^2, never taken from totals, and the
complement 1 - m has a form of its own.

The attitude has two phases, both linear in time: z = pi u / 2K on the polhode, and the mean precession about
L.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import Context, Decimal, localcontext
from typing import TYPE_CHECKING, Final, TypeAlias

from contact_dynamics.tumbling.elliptic import arithmetic_geometric_mean, average_over_period, carlson_rf
from contact_dynamics.tumbling.principal_frame import EXACT, PrincipalFrame, Triple

if TYPE_CHECKING:
    from collections.abc import Sequence

Axes: TypeAlias = "tuple[Triple, Triple, Triple]"

PI: Final = Decimal("3.14159265358979323846264338327950288419716939937510582097494459")

PHASES: Final = Context(prec=42)
"""Arithmetic of the rates: a double-double's 32 digits and ten for the way there."""

CANCELLED: Final = Decimal("1e-100")
"""Relative to the terms of a sum. What is left below it is the rounding of `EXACT`: the sum is zero."""

MOTIONLESS: Final = Decimal("1e-60")
"""Squared angle between the angular velocity and the major or minor axis, below which the spin is taken as
steady. The motion left out is an angle of 1e-30 rad for ever, since spin about these axes is stable."""


@dataclass(frozen=True, slots=True)
class Spin:
    """The angular velocity is constant."""

    rate: Decimal  # rad/s, >= 0


@dataclass(frozen=True, slots=True)
class Tumble:
    """The angular velocity moves on a polhode; axes in Jacobi's order, right-handed, axis 3 on L's side."""

    moments: Triple  # kg m^2, about axes 1, 2, 3
    axes_B: Axes  # rows: unit axes 1, 2, 3 in body coordinates
    L: Decimal  # kg m^2/s, |angular momentum|
    m: Decimal  # parameter of the elliptic functions, in [0, 1]
    m1: Decimal  # 1 - m, in [0, 1]; 0 on the separatrix
    a2: Decimal  # a^2 = 1 - c^2, > 0
    b2: Decimal  # b^2
    c2: Decimal  # c^2
    omega_p: Decimal  # rad/s, du/dt, < 0 where axis 3 is the minor one
    u0: Decimal  # u at time 0
    quarter: Decimal  # pi / 2K, 0 on the separatrix
    precession: Decimal  # rad/s, mean rate about L; on the separatrix the rate in the far past and future


def tumble_or_spin(frame: PrincipalFrame, w_B: Sequence[Decimal]) -> Tumble | Spin:
    """Return the constants of the motion that begins with the angular velocity ``w_B``, rad/s, body axes."""
    with localcontext(EXACT):
        w = [_dot(axis, w_B) for axis in frame.axes_B]
        moments = frame.moments
        below = moments[0] * (moments[1] - moments[0]) * w[0] * w[0]
        above = moments[2] * (moments[2] - moments[1]) * w[2] * w[2]
        if not (below or above):
            return _spin(w)
        from_middle = above - below  # L^2 - 2 T I_2
        on_separatrix = abs(from_middle) <= CANCELLED * (above + below)
        order = (0, 1, 2) if from_middle > 0 or on_separatrix else (2, 1, 0)
        I1, I2, I3 = (moments[i] for i in order)
        axes_B = _jacobis_axes(frame, w, order)
        w1, w2, w3 = (_dot(axis, w_B) for axis in axes_B)
        # Each with the sign of I3 - I1, which cancels wherever they are used.
        d1 = I2 * (I2 - I1) * w2 * w2 + I3 * (I3 - I1) * w3 * w3  # L^2 - 2 T I_1
        d2 = Decimal(0) if on_separatrix else from_middle
        d3 = I1 * (I3 - I1) * w1 * w1 + I2 * (I3 - I2) * w2 * w2  # 2 T I_3 - L^2
        momentum = (I1 * w1, I2 * w2, I3 * w3)
        squared = _squared(momentum)
        a2 = I1 * d3 / ((I3 - I1) * squared)
        if a2 <= MOTIONLESS:
            return _spin(w)
        b2 = I2 * d3 / ((I3 - I2) * squared)
        c2 = I3 * d1 / ((I3 - I1) * squared)
        m = d3 * (I2 - I1) / (d1 * (I3 - I2))
        m1 = d2 * (I3 - I1) / (d1 * (I3 - I2))
        rate2 = d1 * (I3 - I2) / (I1 * I2 * I3)  # omega_p^2
    with localcontext(PHASES):
        L = squared.sqrt()
        omega_p = rate2.sqrt()
        sn = momentum[1] / (L * b2.sqrt())
        cn2 = momentum[0] * momentum[0] / (squared * a2)
        dn2 = momentum[2] * momentum[2] / (squared * c2)
        u0 = sn * carlson_rf(cn2, dn2, Decimal(1))
        if on_separatrix:
            quarter, precession = Decimal(0), L / I2
        else:
            kc = m1.sqrt()
            quarter = arithmetic_geometric_mean(Decimal(1), kc)
            elongation = b2 / a2
            precession = L * average_over_period(kc, elongation, 1 / I1, elongation / I2)
        return Tumble(
            moments=(I1, I2, I3),
            axes_B=axes_B,
            L=L,
            m=m,
            m1=m1,
            a2=a2,
            b2=b2,
            c2=c2,
            omega_p=omega_p if I3 > I1 else -omega_p,
            u0=u0,
            quarter=quarter,
            precession=precession,
        )


def largest_rate(rotation: Spin | Tumble) -> float:
    """Return the largest |w| of a rotation, rad/s."""
    if isinstance(rotation, Spin):
        return float(rotation.rate)
    first, middle, third = (float(rotation.L / moment) for moment in rotation.moments)
    a2, b2, c2, m1 = float(rotation.a2), float(rotation.b2), float(rotation.c2), float(rotation.m1)
    # |w|^2 is linear in sn^2 u: its extremes are at sn = 0 and at sn = 1.
    return math.sqrt(max(a2 * first**2 + c2 * third**2, b2 * middle**2 + c2 * m1 * third**2))


def _spin(w: Sequence[Decimal]) -> Spin:
    return Spin(rate=_squared(w).sqrt())


def _jacobis_axes(frame: PrincipalFrame, w: Sequence[Decimal], order: tuple[int, int, int]) -> Axes:
    """Return axes 1, 2, 3 with w1 >= 0, w3 > 0, right-handed."""
    first, third = order[0], order[2]
    x = _flipped(frame.axes_B[first]) if w[first] < 0 else frame.axes_B[first]
    z = _flipped(frame.axes_B[third]) if w[third] < 0 else frame.axes_B[third]
    y = (z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0])
    return x, y, z


def _squared(vector: Sequence[Decimal]) -> Decimal:
    return vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]


def _flipped(axis: Triple) -> Triple:
    return (-axis[0], -axis[1], -axis[2])


def _dot(axis: Triple, w_B: Sequence[Decimal]) -> Decimal:
    return axis[0] * w_B[0] + axis[1] * w_B[1] + axis[2] * w_B[2]
