# SPDX-License-Identifier: Apache-2.0
"""The constants of a free rotation: they are computed once from body and state, and kept."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.numerics.arithmetic import DECIMALS, DOUBLES, Arithmetic, Precision, Scalar, within
from contact_dynamics.rigid_body.inertia.principal_frame import PrincipalFrame, in_doubles, principal_frame
from contact_dynamics.rotations.one import (
    Quaternion,
    conjugate,
    from_rows,
    from_z_onto,
    normalised,
    product,
)
from contact_dynamics.tolerances import LARGEST_NUMBER
from contact_dynamics.tumbling.attitude_form import AttitudeForm, attitude_form
from contact_dynamics.tumbling.polhode import Rotation, Spin, Tumble, largest_rate, tumble_or_spin
from contact_dynamics.tumbling.regime import Regime, regime_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from decimal import Decimal

MAX_TURNED: Final = 1e16
"""Angle, rad, beyond which times are refused. Neighbouring doubles are then more than a turn apart, and the
phases' double-doubles no longer hold the last bits of a turn."""

REMEMBERED: Final = 128
"""Number of rotations whose constants are kept, 3 kB each, since a state is often asked about twice."""

_IDENTITY: Final = (0.0, 0.0, 0.0, 1.0)


class Constants(NamedTuple):
    """The constants of a rotation. The fields of `FreeMotion` explain them."""

    frame: PrincipalFrame[Decimal]
    rotation: Rotation
    form: AttitudeForm
    q_WL: Quaternion
    q_PB: Quaternion
    w_along: float
    w_across: tuple[float, float]
    farthest: float
    regime: Regime


@lru_cache(maxsize=REMEMBERED)
def constants_of(inertia: bytes, attitude: bytes, rate: bytes, precision: Precision) -> Constants:
    """Return the constants of a rotation, for the doubles of I_B, q_WB and w_WB_W."""
    I_B, q_WB, w_WB_W = (np.frombuffer(data, dtype=np.float64) for data in (inertia, attitude, rate))
    frame = principal_frame(I_B)
    q, w = normalised(q_WB.tolist()), w_WB_W.tolist()
    rotation: Rotation
    if precision is Precision.DOUBLE:
        rotation, form = _rotation(in_doubles(frame), q_WB.tolist(), w, DOUBLES)
    else:
        rotation, form = _rotation(frame, q_WB.tolist(), w, DECIMALS)
    if isinstance(rotation, Spin):
        along, across = float(rotation.rate), (0.0, 0.0)
        q_WL = from_z_onto((w_WB_W / along).tolist()) if along else _IDENTITY
        q_PB = product(conjugate(q_WL), q)
    else:
        L, (I1, I2, I3) = float(rotation.L), (float(moment) for moment in rotation.moments)
        # w . L / |L| = L (l_1^2 / I_1 + l_2^2 / I_2 + l_3^2 / I_3), at u = 0
        along = L * (float(rotation.a2) / I1 + float(rotation.c2) / I3)
        across = L / I1 * (float(rotation.gaps[0]) / I2), -L / I3 * (float(rotation.gaps[1]) / I2)
        q_PB = from_rows([[float(x) for x in axis] for axis in rotation.axes_B])
        alpha, beta, _, _ = form.cayley_klein(0.0)
        q_LP = (beta.imag, -beta.real, alpha.imag, alpha.real)
        q_WL = normalised(product(q, conjugate(product(q_LP, q_PB))))
    farthest = min(MAX_TURNED / max(largest_rate(rotation), 1.0 / LARGEST_NUMBER), LARGEST_NUMBER)
    with within(DECIMALS.sums):
        regime = regime_of(frame, rotation)
    return Constants(frame, rotation, form, q_WL, q_PB, along, across, farthest, regime)


def _rotation(
    frame: PrincipalFrame[Scalar],
    q_WB: Sequence[float],
    w_WB_W: Sequence[float],
    numbers: Arithmetic[Scalar],
) -> tuple[Spin[Scalar] | Tumble[Scalar], AttitudeForm]:
    with within(numbers.sums):
        at_rest = max(map(abs, w_WB_W)) * LARGEST_NUMBER < 1.0
        w_B = [numbers.number(0.0)] * 3 if at_rest else _body_rate(q_WB, w_WB_W, numbers)
        rotation = tumble_or_spin(frame, w_B, numbers)
        return rotation, attitude_form(rotation, numbers)


def _body_rate(q_WB: Sequence[float], w_WB_W: Sequence[float], numbers: Arithmetic[Scalar]) -> list[Scalar]:
    """Return the angular velocity in body axes, rad/s: R^T w, for a quaternion that is unit to rounding."""
    x, y, z, s = (numbers.number(i) for i in q_WB)
    a, b, c = (numbers.number(i) for i in w_WB_W)
    imaginary2 = x * x + y * y + z * z
    norm2 = imaginary2 + s * s
    scale, along, across = s * s - imaginary2, 2 * (x * a + y * b + z * c), 2 * s
    return [
        (scale * a + along * x - across * (y * c - z * b)) / norm2,
        (scale * b + along * y - across * (z * a - x * c)) / norm2,
        (scale * c + along * z - across * (x * b - y * a)) / norm2,
    ]
