# SPDX-License-Identifier: Apache-2.0
"""The constants of a torque-free rotation, and its regime, from the initial angular velocity.

Jacobi's order of axes: the angular velocity circles axis 3, which is the major axis (largest moment) where
L^2 > 2 T I_2 and the minor one where L^2 < 2 T I_2; axis 2 is the middle one. With a, b, c > 0,

    L_1 / L = a cn u,    L_2 / L = b sn u,    L_3 / L = c dn u,    u = omega_p t + u_0,

(Whittaker, Analytical Dynamics, 69; van Zon and Schofield, J. Comput. Phys. 225, 145, 2007, eq. 13 to 18).
To avoid cancellation, differences such as L^2 - 2 T I_i are sums of I_j (I_j - I_i) w_j^2, and the complement
1 - m has a formula of its own.

The attitude has two phases, both linear in time: z = pi u / 2K on the polhode, and the mean precession about
L.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, TypeAlias

from contact_dynamics.numerics.arithmetic import Scalar, within
from contact_dynamics.records import NamedInt
from contact_dynamics.tolerances import EQUAL_MOMENTS_TOLERANCE, MOTIONLESS, STEADY_AXIS_TOLERANCE
from contact_dynamics.tumbling.elliptic import average_over_period, carlson_rf

if TYPE_CHECKING:
    from collections.abc import Sequence
    from decimal import Decimal

    from contact_dynamics.numerics.arithmetic import Arithmetic
    from contact_dynamics.rigid_body.inertia.axes_of_inertia import PrincipalFrame


@dataclass(frozen=True, slots=True)
class Spin(Generic[Scalar]):
    """The angular velocity is constant."""

    rate: Scalar  # rad/s, >= 0


@dataclass(frozen=True, slots=True)
class Tumble(Generic[Scalar]):
    """The angular velocity moves on a polhode, in Jacobi's axes, right-handed, axis 3 on L's side."""

    moments: tuple[Scalar, Scalar, Scalar]  # kg m^2, about axes 1, 2, 3
    gaps: tuple[Scalar, Scalar, Scalar]  # kg m^2, I_2 - I_1, I_3 - I_2, I_3 - I_1; > 0 about the major axis
    axes_B: tuple[tuple[Scalar, Scalar, Scalar], ...]  # unit axes 1, 2, 3 in body coordinates, as 3 rows
    L: Scalar  # magnitude of the angular momentum, kg m^2/s
    m: Scalar  # parameter of the elliptic functions, in [0, 1]
    m1: Scalar  # 1 - m, in [0, 1], 0 on the separatrix
    a2: Scalar  # the square of a, 1 - c^2, > 0
    b2: Scalar  # the square of b
    c2: Scalar  # the square of c
    omega_p: Scalar  # du/dt, rad/s, < 0 where axis 3 is the minor one
    u0: Scalar  # the value of u at time 0
    quarter: Scalar  # pi / 2K, 0 on the separatrix
    precession: Scalar  # mean rate about L, rad/s; on the separatrix that in the far past and future


Rotation: TypeAlias = "Spin[Decimal] | Tumble[Decimal] | Spin[float] | Tumble[float]"


def tumble_or_spin(
    frame: PrincipalFrame[Scalar], w_B: Sequence[Scalar], numbers: Arithmetic[Scalar]
) -> Tumble[Scalar] | Spin[Scalar]:
    """Return the constants of a rotation that begins with the angular velocity ``w_B``, rad/s, body axes."""
    zero, one = numbers.number(0.0), numbers.number(1.0)
    with within(numbers.sums):
        w = [_dot(axis, w_B) for axis in frame.axes_B]
        low, high, both = frame.gaps
        below = frame.moments[0] * low * w[0] * w[0]
        above = frame.moments[2] * high * w[2] * w[2]
        if not (below or above):
            return Spin(rate=numbers.sqrt(_squared(w)))
        from_middle = above - below  # L^2 - 2 T I_2
        on_separatrix = abs(from_middle) <= numbers.cancelled * (above + below)
        about_major = from_middle > 0 or on_separatrix
        first, third = (0, 2) if about_major else (2, 0)
        I1, I2, I3 = frame.moments[first], frame.moments[1], frame.moments[third]
        # It has the sign of I3 - I1, as d1 to d3 do. The sign cancels wherever they are used.
        gap21, gap32, gap31 = (low, high, both) if about_major else (-high, -low, -both)
        axes_B = _jacobis_axes(frame, w, first, third)
        w1, w2, w3 = (_dot(axis, w_B) for axis in axes_B)
        d1 = I2 * gap21 * w2 * w2 + I3 * gap31 * w3 * w3  # L^2 - 2 T I_1
        d2 = zero if on_separatrix else from_middle
        d3 = I1 * gap31 * w1 * w1 + I2 * gap32 * w2 * w2  # 2 T I_3 - L^2
        momentum = (I1 * w1, I2 * w2, I3 * w3)
        squared = _squared(momentum)
        a2 = I1 * d3 / (gap31 * squared)
        if a2 <= MOTIONLESS:
            return Spin(rate=numbers.sqrt(_squared(w)))
        b2 = I2 * d3 / (gap32 * squared)
        c2 = I3 * d1 / (gap31 * squared)
        m = d3 * gap21 / (d1 * gap32)
        m1 = d2 * gap31 / (d1 * gap32)
        rate2 = (d1 / I1) * (gap32 / I2) / I3  # omega_p^2
    with within(numbers.rates):
        L = numbers.sqrt(squared)
        omega_p = numbers.sqrt(rate2)
        sn = momentum[1] / (L * numbers.sqrt(b2))
        cn2 = momentum[0] * momentum[0] / (squared * a2)
        dn2 = momentum[2] * momentum[2] / (squared * c2)
        u0 = sn * carlson_rf(cn2, dn2, one, numbers=numbers)
        if m1 == 0:
            quarter, precession = zero, L / I2
        else:
            elongation = b2 / a2
            quarter, average = average_over_period(
                numbers.sqrt(m1), elongation, one / I1, elongation / I2, numbers=numbers
            )
            precession = L * average
        return Tumble(
            moments=(I1, I2, I3),
            gaps=(gap21, gap32, gap31),
            axes_B=axes_B,
            L=L,
            m=m,
            m1=m1,
            a2=a2,
            b2=b2,
            c2=c2,
            omega_p=omega_p if about_major else -omega_p,
            u0=u0,
            quarter=quarter,
            precession=precession,
        )


def largest_rate(rotation: Rotation) -> float:
    """Return the largest |w| of a rotation, rad/s."""
    if isinstance(rotation, Spin):
        return float(rotation.rate)
    L = float(rotation.L)
    first, middle, third = (L / float(moment) for moment in rotation.moments)
    a2, b2, c2, m1 = float(rotation.a2), float(rotation.b2), float(rotation.c2), float(rotation.m1)
    # |w|^2 is linear in sn^2 u: its extremes are at sn = 0 and at sn = 1.
    return math.sqrt(max(a2 * first**2 + c2 * third**2, b2 * middle**2 + c2 * m1 * third**2))


def _jacobis_axes(
    frame: PrincipalFrame[Scalar], w: Sequence[Scalar], first: int, third: int
) -> tuple[tuple[Scalar, Scalar, Scalar], ...]:
    """Return axes 1, 2, 3 with w1 >= 0, w3 > 0, right-handed."""
    x = _flipped(frame.axes_B[first]) if w[first] < 0 else frame.axes_B[first]
    z = _flipped(frame.axes_B[third]) if w[third] < 0 else frame.axes_B[third]
    y = (z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0])
    return x, y, z


def _squared(vector: Sequence[Scalar]) -> Scalar:
    return vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]


def _flipped(axis: tuple[Scalar, Scalar, Scalar]) -> tuple[Scalar, Scalar, Scalar]:
    return (-axis[0], -axis[1], -axis[2])


def _dot(axis: tuple[Scalar, Scalar, Scalar], w_B: Sequence[Scalar]) -> Scalar:
    return axis[0] * w_B[0] + axis[1] * w_B[1] + axis[2] * w_B[2]


class Regime(NamedInt):
    """Kind of rotation, as a label. The formulas do not use it, and are also valid between the regimes."""

    UNKNOWN = 0  # a torque acts: Poinsot's picture does not apply
    AT_REST = 1  # no rotation
    SPHERICAL = 2  # three equal moments: the angular velocity is constant
    PRINCIPAL_AXIS = 3  # about a principal axis, or within rounding of the major or minor one: it is constant
    AXISYMMETRIC = 4  # two equal moments: steady precession
    ABOUT_MINOR_AXIS = 5  # the polhode encircles the axis of the smallest moment
    ABOUT_MAJOR_AXIS = 6  # the polhode encircles the axis of the largest moment
    SEPARATRIX = 7  # between the two: one flip, and an infinite period


def regime_of(frame: PrincipalFrame[Decimal], rotation: Rotation) -> Regime:
    """Return the name of a rotation. Moments within `EQUAL_MOMENTS_TOLERANCE` count as equal."""
    if isinstance(rotation, Spin) and rotation.rate == 0:
        return Regime.AT_REST
    small, middle, large = frame.moments
    equal = large * EQUAL_MOMENTS_TOLERANCE
    if large - small <= equal:
        return Regime.SPHERICAL
    if middle - small <= equal or large - middle <= equal:
        return Regime.AXISYMMETRIC
    if isinstance(rotation, Spin) or rotation.a2 <= STEADY_AXIS_TOLERANCE:
        return Regime.PRINCIPAL_AXIS
    if rotation.m1 == 0:
        return Regime.SEPARATRIX
    return Regime.ABOUT_MAJOR_AXIS if rotation.omega_p > 0 else Regime.ABOUT_MINOR_AXIS
