# SPDX-License-Identifier: Apache-2.0
"""Poinsot's construction of a free rotation: the energy ellipsoid rolls on the invariable plane (lecture 25).

In the space of angular velocities the ellipsoid w^T I w = 2 T is fixed in the body and the plane w . L = 2 T
is fixed in the world. They touch at w. Its trace on the ellipsoid is the polhode, which is closed. Its trace
on the plane is the herpolhode, which in general never closes.

Near the middle axis the body flips (the Dzhanibekov effect), and the time of a flip depends on the last
digits of the state. `sensitivity` and `next_flips` quantify this.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.numerics.arithmetic import ARRAYS, DOUBLES
from contact_dynamics.records import Record, Rows
from contact_dynamics.rigid_body.body import angular_momentum
from contact_dynamics.rigid_body.inertia.axes_of_inertia import axes_of_bytes
from contact_dynamics.rotations.one import rotated
from contact_dynamics.tolerances import SEPARATRIX_END, SMALLEST_COMPLEMENT
from contact_dynamics.tumbling.elliptic import average_over_period, carlson_rf
from contact_dynamics.tumbling.polhode import Regime, Rotation, Spin, Tumble, largest_rate
from contact_dynamics.validation import FloatArray, check_whole

if TYPE_CHECKING:
    from decimal import Decimal

    from contact_dynamics.tumbling.motion import FreeMotion

CONSTANT_RATE: Final = (Regime.AT_REST, Regime.SPHERICAL, Regime.PRINCIPAL_AXIS)
"""Regimes in which the angular velocity in the body is constant to rounding: the polhode is a point."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Poinsot(Record):
    """Constants of a free rotation in Poinsot's construction.

    Attributes:
        regime: Kind of rotation.
        rotational_energy: T, J.
        L_W: (3,), kg m^2/s, angular momentum, world axes: the normal of the invariable plane.
        invariable_plane_distance: rad/s, 2 T / |L|, or NaN at rest.
        polhode_period: s. It is infinite on the separatrix, and NaN if the angular velocity is constant.
        precession_per_period: Turn about L in one period, rad, or NaN without a period.
        principal_moments: (3,), kg m^2, ascending.
        principal_axes_B: (3, 3), whose columns are the principal axes in body coordinates
            (`inertia.principal_axes`).
        ellipsoid_semi_axes: (3,), rad/s, semi-axes of the energy ellipsoid along the principal axes: sqrt(2 T
            / I).
        sensitivity: Attitude error per rad of rotation and per unit of relative error of the angular
            velocity, or NaN at rest.
    """

    regime: Regime
    rotational_energy: float
    L_W: FloatArray
    invariable_plane_distance: float
    polhode_period: float
    precession_per_period: float
    principal_moments: FloatArray
    principal_axes_B: FloatArray
    ellipsoid_semi_axes: FloatArray
    sensitivity: float

    @property
    def I_B(self) -> FloatArray:
        """Return the inertia, (3, 3), kg m^2, about the centre of mass, body axes."""
        inertia: FloatArray = self.principal_axes_B * self.principal_moments @ self.principal_axes_B.T
        return inertia


def poinsot(motion: FreeMotion) -> Poinsot:
    """Return Poinsot's construction of a free motion."""
    rotation = motion.rotation
    L_W = angular_momentum(motion.body, motion.state)
    twice_energy = motion.w_along * math.hypot(*L_W.tolist())
    axes = axes_of_bytes(motion.body.I_B.tobytes())
    period = math.nan if motion.regime in CONSTANT_RATE else polhode_period(rotation)
    return Poinsot(
        regime=motion.regime,
        rotational_energy=0.5 * twice_energy,
        L_W=L_W,
        invariable_plane_distance=motion.w_along if motion.regime is not Regime.AT_REST else math.nan,
        polhode_period=period,
        precession_per_period=float(rotation.precession) * period
        if math.isfinite(period) and isinstance(rotation, Tumble)
        else math.nan,
        principal_moments=axes.moments,
        principal_axes_B=axes.R_BP,
        ellipsoid_semi_axes=semi_axes(0.5 * twice_energy, axes.moments),
        sensitivity=sensitivity(motion),
    )


def semi_axes(rotational_energy: float, principal_moments: FloatArray) -> FloatArray:
    """Return the semi-axes of the energy ellipsoid, (3,), rad/s, from T, J, and the moments, kg m^2."""
    axes: FloatArray = np.sqrt(2.0 * rotational_energy / principal_moments)
    return axes


def polhode_period(rotation: Rotation) -> float:
    """Return the time, s, until w in the body repeats. It is inf on the separatrix, NaN for a constant w."""
    if isinstance(rotation, Spin):
        return math.nan
    if rotation.m1 == 0:
        return math.inf
    return 2.0 * math.pi / (float(rotation.quarter) * abs(float(rotation.omega_p)))


def sensitivity(motion: FreeMotion) -> float:
    """Return how fast an error of the initial angular velocity becomes an error of attitude, in the long run.

    It is the error of attitude, rad, divided by the angle turned, rad, and by the relative error of the
    angular velocity, for the worst direction of that error and the worst phase. It is 1 for a steady spin and
    large near the separatrix. It is inf on the separatrix and about the middle axis itself, where errors grow
    exponentially, and NaN at rest.

    Both phases of the attitude are linear in time: nu on the polhode and P about L. Their rates depend on T
    and |L| alone. With the action J of nu, dT = nu dJ + P dL, and both rates are homogeneous in (J, L). So
    d nu / dT at constant L gives all four derivatives.
    """
    rotation = motion.rotation
    if isinstance(rotation, Spin) or motion.regime is Regime.SPHERICAL:
        return _sensitivity_of_spin(motion)
    m1 = float(rotation.m1)
    if m1 < SMALLEST_COMPLEMENT:
        return math.inf
    # In units in which I_3 and L are 1.
    unit, rate_unit = float(rotation.moments[2]), float(rotation.L) / float(rotation.moments[2])
    moments = [float(moment) / unit for moment in rotation.moments]
    gap21, gap32, gap31 = (float(gap) / unit for gap in rotation.gaps)
    P, T2, c2 = float(rotation.precession) / rate_unit, motion.w_along / rate_unit, float(rotation.c2)
    excess = c2 * gap31  # L^2 - 2 T I_1
    m_T = 2.0 * gap31 * gap21 / (excess * excess * gap32)
    K_m = average_over_period(math.sqrt(m1), 1.0, 1.0, 0.0, numbers=DOUBLES)[1] / (2.0 * m1)
    nu_T = -moments[0] / excess - K_m * m_T  # the derivative of log nu, as is the next
    nu_L = 1.0 - T2 * nu_T
    P_T = 1.0 + (P - T2) * nu_T
    P_L = P - T2 * P_T
    # d P z + (d nu / nu) (w - P z) = (dP - P d nu / nu) z + (d nu / nu) w
    along_T, along_L = P_T - P * nu_T, P_L - P * nu_L
    axes = [[float(x) for x in axis] for axis in rotation.axes_B]
    x, y, z, w = motion.state.q_WB.tolist()
    w_1, w_2, w_3 = rotated((-x, -y, -z, w), motion.state.w_WB_W.tolist())  # body axes
    aa = ab = bb = 0.0  # the matrix of the gradients over w in P of the phases' rates
    for moment, (x, y, z) in zip(moments, axes, strict=True):
        T_w = moment * (x * w_1 + y * w_2 + z * w_3) / rate_unit
        L_w = moment * T_w
        a, b = along_T * T_w + along_L * L_w, nu_T * T_w + nu_L * L_w
        aa, ab, bb = aa + a * a, ab + a * b, bb + b * b
    w2 = (largest_rate(rotation) / rate_unit) ** 2
    trace = aa + 2.0 * T2 * ab + w2 * bb
    determinant = (aa * bb - ab**2) * (w2 - T2 * T2)
    return math.sqrt(0.5 * (trace + math.sqrt(max(trace * trace - 4.0 * determinant, 0.0))))


def _sensitivity_of_spin(motion: FreeMotion) -> float:
    """Return the sensitivity of steady spin: 1, but inf about the middle axis and NaN at rest."""
    if motion.regime is Regime.AT_REST:
        return math.nan
    if motion.regime is not Regime.PRINCIPAL_AXIS:
        return 1.0
    middle_B = np.array([float(x) for x in motion.frame.axes_B[1]])
    w_B = motion.state.R_WB.T @ motion.state.w_WB_W
    return math.inf if abs(middle_B @ w_B) > 0.5 * np.linalg.norm(w_B) else 1.0


MAX_POINTS: Final = 1_000_000
"""Maximum number of points of rolling curves, which require about three seconds and 200 MB."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class RollingCurves(Rows):
    """Polhode and herpolhode, which roll on each other. They touch in row i of both at ``seconds[i]``.

    Arcs of the two curves between the same rows have equal length.

    Attributes:
        seconds: (n,), s after the state's stamp, ascending. All are 0 if the body does not rotate.
        polhode_B: (n, 3), rad/s, angular velocity in body axes.
        herpolhode_W: (n, 3), rad/s, angular velocity in world axes, in the invariable plane.
    """

    seconds: FloatArray
    polhode_B: FloatArray
    herpolhode_W: FloatArray


def rolling_curves(motion: FreeMotion, count: int) -> RollingCurves:
    """Return ``count`` points of polhode and herpolhode, with the times at which the motion passes them.

    The points go once around the polhode, over the period that contains time 0. `polhode` describes the
    result if there is no period.

    Raises:
        TooLargeError: there are more than `MAX_POINTS` points.
        InvalidFieldError: ``count`` is not a whole number >= 1, or the period is so long that double
            precision does not distinguish turns in it, as for bodies whose moments differ in the last digits.
    """
    if check_whole("count", count, 1) > MAX_POINTS:
        raise TooLargeError("count", count, f"at most {MAX_POINTS}")
    rotation = motion.rotation
    if isinstance(rotation, Spin) or motion.regime in CONSTANT_RATE:
        return RollingCurves(
            seconds=np.zeros(count),
            polhode_B=polhode(motion, count),
            herpolhode_W=np.tile(motion.state.w_WB_W, (count, 1)),
        )
    angle = _amplitudes(rotation, count)
    cos2, sin = np.square(np.cos(angle)), np.sin(angle)
    m1 = float(rotation.m1)
    u = sin * carlson_rf(cos2, cos2 + m1 * sin * sin, np.ones(count), numbers=ARRAYS)
    if m1:  # sin u is of the nearest half turn
        halves = np.rint(angle / math.pi)
        u = np.where(halves % 2.0 == 0.0, u, -u) + halves * (math.pi / float(rotation.quarter))
    seconds = (u - float(rotation.u0)) / float(rotation.omega_p)
    longest = float(np.abs(seconds).max(initial=0.0))
    if longest > motion.farthest:
        allowed = f"one within {motion.farthest:g} s, in which doubles tell turns apart"
        raise InvalidFieldError("rolling curves", f"a period of {longest:g} s", allowed)
    order = slice(None) if float(rotation.omega_p) > 0.0 else slice(None, None, -1)
    return RollingCurves(
        seconds=seconds[order],
        polhode_B=polhode(motion, count)[order],
        herpolhode_W=motion.at(seconds[order]).w_WB_W,
    )


def polhode(motion: FreeMotion, count: int) -> FloatArray:
    """Return ``count`` points of the polhode, (count, 3), rad/s, body axes, in order along it.

    The curve is closed, so the last point equals the first. The ends of the separatrix are infinitely far
    away in time. There the curve is the arc from one spin about the middle axis to the other, up to
    `SEPARATRIX_END` from each. Where the angular velocity is constant, all points are the same.
    """
    rotation = motion.rotation
    if isinstance(rotation, Spin) or motion.regime in CONSTANT_RATE:
        return np.tile(motion.state.R_WB.T @ motion.state.w_WB_W, (count, 1))
    angle = _amplitudes(rotation, count)
    cos, sin = np.cos(angle), np.sin(angle)
    a, b, c = (math.sqrt(x) for x in (rotation.a2, rotation.b2, rotation.c2))
    dn = np.sqrt(cos * cos + float(rotation.m1) * sin * sin)
    L = float(rotation.L)
    first, middle, third = (L / float(moment) for moment in rotation.moments)
    w_P = np.column_stack([a * first * cos, b * middle * sin, c * third * dn])
    points: FloatArray = w_P @ np.array([[float(x) for x in axis] for axis in rotation.axes_B])
    return points


def _amplitudes(rotation: Tumble[Decimal] | Tumble[float], count: int) -> FloatArray:
    """Return Jacobi's amplitudes of u, rad, evenly over one period of the polhode."""
    whole = math.pi if rotation.m1 else 0.5 * math.pi - SEPARATRIX_END
    return np.linspace(-whole, whole, count)
