# SPDX-License-Identifier: Apache-2.0
"""The motion of a free rigid body: torque-free rotation, and a parabola of the centre of mass (lecture 25).

Because the motion is not integrated, all times, past or future, cost the same, and the error does not grow
with the number of revolutions. The constants are computed in extended precision from the exact values of the
given doubles. The same formulas apply to bodies and motions that are degenerate (sphere, axis of symmetry,
principal axis, separatrix) or nearly so.

Frames: W is the world, B the body at its centre of mass, P the principal axes in Jacobi's order, and L the
world turned so that its z axis is along the angular momentum.

Not covered: torque, drag, gravity gradients. The result is exact to rounding for the given doubles. Near the
middle axis, it is sensitive to small changes of these doubles;
`contact_dynamics.tumbling.poinsot_construction` computes the sensitivity.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.constants import STANDARD_GRAVITY_W, ns_after
from contact_dynamics.numerics.arithmetic import DECIMALS, DOUBLES, Arithmetic, Precision, Scalar, within
from contact_dynamics.records import Record, Rows, made
from contact_dynamics.rigid_body.body import BodyState, HasMassProperties, MassProperties
from contact_dynamics.rigid_body.inertia.axes_of_inertia import PrincipalFrame, in_doubles, principal_frame
from contact_dynamics.rotations.many import make_continuous
from contact_dynamics.rotations.one import (
    Quaternion,
    conjugate,
    from_rows,
    from_z_onto,
    left_matrix,
    nearer,
    normalised,
    product,
    right_matrix,
    rotated,
)
from contact_dynamics.tolerances import LARGEST_NUMBER
from contact_dynamics.tumbling.attitude_form import AttitudeForm, attitude_form
from contact_dynamics.tumbling.polhode import (
    Regime,
    Rotation,
    Spin,
    Tumble,
    largest_rate,
    regime_of,
    tumble_or_spin,
)
from contact_dynamics.validation import FloatArray, check_array, check_magnitude, check_within

if TYPE_CHECKING:
    from collections.abc import Sequence
    from decimal import Decimal

    from numpy.typing import ArrayLike


CHUNK: Final = 8192
"""Number of samples computed at a time. Their intermediate arrays stay in the processor's cache."""

FEW: Final = 16
"""Up to this number, samples cost less one by one than NumPy's calls do."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Trajectory(Rows):
    """Motion at n times. Row i belongs to ``seconds[i]``.

    Attributes:
        seconds: (n,), s after the stamp of the initial state.
        p_WB_W: (n, 3), m, position of the centre of mass, world.
        q_WB: (n, 4), unit quaternions x, y, z, w, body to world, with continuous signs.
        v_WB_W: (n, 3), m/s, velocity of the centre of mass, world axes.
        w_WB_W: (n, 3), rad/s, angular velocity, world axes.
    """

    seconds: FloatArray
    p_WB_W: FloatArray
    q_WB: FloatArray
    v_WB_W: FloatArray
    w_WB_W: FloatArray

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.seconds)


class Sample(NamedTuple):
    """Motion at one time in plain floats: the contents of a `BodyState`, without the cost of arrays.

    Attributes:
        p_WB_W: Position of the centre of mass, world, m.
        q_WB: Unit quaternion x, y, z, w, body to world.
        v_WB_W: Velocity of the centre of mass, m/s, world axes.
        w_WB_W: Angular velocity, rad/s, world axes.
    """

    p_WB_W: tuple[float, float, float]
    q_WB: tuple[float, float, float, float]
    v_WB_W: tuple[float, float, float]
    w_WB_W: tuple[float, float, float]

    def as_state(self, begin_ns: int, seconds: float) -> BodyState:
        """Return the sample as a `BodyState`, ``seconds`` after the stamp ``begin_ns``, ns."""
        return BodyState(
            p_WB_W=np.array(self.p_WB_W),
            q_WB=np.array(self.q_WB),
            v_WB_W=np.array(self.v_WB_W),
            w_WB_W=np.array(self.w_WB_W),
            stamp_ns=ns_after(begin_ns, seconds),
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FreeMotion(Record):
    """Motion of a body without torque, made by `free_motion`.

    Attributes:
        body: Mass and angular inertia.
        state: State of the body at time 0.
        gravity_W: (3,), m/s^2, world axes.
        frame: Principal moments and axes of the body.
        rotation: Constants of the rotation.
        form: Attitude about L as a function of time.
        q_WL: Unit quaternion x, y, z, w, which transforms axes with z along L into world axes.
        q_PB: Unit quaternion x, y, z, w, which transforms body axes into principal axes.
        w_along: Component of the angular velocity along L, rad/s, constant.
        w_across: L (1/I_1 - 1/I_2) and L (1/I_3 - 1/I_2), rad/s.
        farthest: Largest distance of times from time 0, in both directions, s.
        regime: Kind of rotation.
    """

    body: MassProperties
    state: BodyState
    gravity_W: FloatArray
    frame: PrincipalFrame[Decimal] = field(repr=False)
    rotation: Rotation = field(repr=False)
    form: AttitudeForm = field(repr=False)
    q_WL: Quaternion = field(repr=False)
    q_PB: Quaternion = field(repr=False)
    w_along: float = field(repr=False)
    w_across: tuple[float, float] = field(repr=False)
    farthest: float = field(repr=False)
    regime: Regime

    def sample(self, seconds: float) -> Sample:
        """Return the motion at one time, s after the state's stamp, in plain floats, unchecked."""
        alpha, beta, l_1, l_3 = self.form.cayley_klein(seconds)
        q_LP = (beta.imag, -beta.real, alpha.imag, alpha.real)
        across = self._across(alpha, beta, l_1, l_3)
        w_W = rotated(self.q_WL, (across.real, across.imag, self.w_along))
        q_WB = product(product(self.q_WL, q_LP), self.q_PB)
        p, v, g = self.state.p_WB_W.tolist(), self.state.v_WB_W.tolist(), self.gravity_W.tolist()
        half = 0.5 * seconds
        return Sample(
            (
                p[0] + seconds * (v[0] + half * g[0]),
                p[1] + seconds * (v[1] + half * g[1]),
                p[2] + seconds * (v[2] + half * g[2]),
            ),
            q_WB,
            (v[0] + seconds * g[0], v[1] + seconds * g[1], v[2] + seconds * g[2]),
            w_W,
        )

    def _across(self, alpha: complex, beta: complex, l_1: float, l_3: float) -> complex:
        """Return w_x + i w_y of the angular velocity in L's axes, rad/s, for alpha and i beta."""
        # The sum of L l_i (1 / I_i - 1 / I_2) times axis i, with l = L / |L| in P.
        first, third = self.w_across
        return first * l_1 * (alpha * alpha - beta * beta) - 2.0 * third * l_3 * alpha * beta

    def state_at(self, seconds: float) -> BodyState:
        """Return the body's state at one time, s after the state's stamp.

        Raises:
            InvalidFieldError: the time is not finite, or the body has rotated by more than
                `constants.MAX_TURNED` by then.
        """
        check_within("seconds", seconds, -self.farthest, self.farthest)
        return self.sample(seconds).as_state(self.state.stamp_ns, seconds)

    def at(self, seconds: ArrayLike) -> Trajectory:
        """Return the motion at times (n,), s after the state's stamp, of any sign and in any order.

        Raises:
            InvalidFieldError: the times are not a flat list of finite numbers, or the body has rotated by
                more than `constants.MAX_TURNED` by the farthest of them.
        """
        times = check_magnitude("seconds", check_array("seconds", seconds, (None,)), self.farthest)
        if len(times) <= FEW:
            return self._one_by_one(times)
        q_WB, w_WB_W = self._in_chunks(times)
        make_continuous(q_WB, self.state.q_WB)
        elapsed = times[:, None]
        return Trajectory(
            seconds=times,
            p_WB_W=self.state.p_WB_W + elapsed * (self.state.v_WB_W + (0.5 * elapsed) * self.gravity_W),
            q_WB=q_WB,
            v_WB_W=self.state.v_WB_W + elapsed * self.gravity_W,
            w_WB_W=w_WB_W,
        )

    def _one_by_one(self, times: FloatArray) -> Trajectory:
        samples = [self.sample(t) for t in times.tolist()]
        x, y, z, w = self.state.q_WB.tolist()
        before = (x, y, z, w)
        turns = [before := nearer(sample.q_WB, before) for sample in samples]
        return Trajectory(
            seconds=times,
            p_WB_W=np.array([sample.p_WB_W for sample in samples]).reshape(-1, 3),
            q_WB=np.array(turns).reshape(-1, 4),
            v_WB_W=np.array([sample.v_WB_W for sample in samples]).reshape(-1, 3),
            w_WB_W=np.array([sample.w_WB_W for sample in samples]).reshape(-1, 3),
        )

    def _in_chunks(self, times: FloatArray) -> tuple[FloatArray, FloatArray]:
        q_WB, w_WB_W = np.empty((len(times), 4)), np.empty((len(times), 3))
        onto_W = left_matrix(self.q_WL) @ right_matrix(self.q_PB)
        R_LW = np.array(
            [rotated(self.q_WL, axis) for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))]
        )
        for start in range(0, len(times), CHUNK):
            chunk = slice(start, start + CHUNK)
            self._attitudes(times[chunk], onto_W.T, R_LW, q_WB[chunk], w_WB_W[chunk])
        return q_WB, w_WB_W

    def _attitudes(
        self, times: FloatArray, onto_W: FloatArray, R_LW: FloatArray, q: FloatArray, w_WB: FloatArray
    ) -> None:
        """Fill (n, 4) quaternions and (n, 3) angular velocities."""
        A_re, A_im, B_re, B_im, C, D, tangent = self.form.points(times)
        norm2 = A_re * A_re + A_im * A_im + B_re * B_re + B_im * B_im
        scale = 1.0 / np.sqrt(norm2 * (1.0 + tangent * tangent))
        tangent *= scale
        q_LP = np.empty((4, len(times)))  # alpha = w + i z; x + i y = -i (b + i c)
        x, y, z, w = q_LP
        np.subtract(A_re * scale, A_im * tangent, out=w)
        np.add(A_im * scale, A_re * tangent, out=z)
        np.add(B_im * scale, B_re * tangent, out=x)
        b = np.subtract(B_re * scale, B_im * tangent)
        np.negative(b, out=y)
        np.matmul(q_LP.T, onto_W, out=q)
        # As `_across`, in real parts.
        ww, xx, bb, zz = w * w, x * x, b * b, z * z
        first, third = self.w_across[0] * (C / norm2), (2.0 * self.w_across[1]) * (D / norm2)
        w_L = np.empty((3, len(times)))
        np.subtract(first * ((ww - zz) - (bb - xx)), third * (w * b - z * x), out=w_L[0])
        np.subtract((2.0 * first) * (w * z - b * x), third * (w * x + z * b), out=w_L[1])
        w_L[2] = self.w_along
        np.matmul(w_L.T, R_LW, out=w_WB)


def free_motion(
    body: HasMassProperties,
    state: BodyState,
    *,
    gravity_W: ArrayLike = STANDARD_GRAVITY_W,
    precision: Precision = Precision.EXTENDED,
) -> FreeMotion:
    """Return the motion of a body without torque, in uniform gravity, from its state at one time.

    Args:
        body: A `Body`, or its `MassProperties`.
        state: State of the body at time 0.
        gravity_W: (3,), m/s^2, world axes.
        precision: Precision of the constants of the motion. DOUBLE takes a third of the time, and its errors
            grow with the rotation angle. The constants of the last `constants.REMEMBERED` rotations are
            cached.

    Returns:
        The motion: ``.state_at(seconds)`` is the state at one time, s, and ``.at(seconds)`` the `Trajectory`
        at many times, in the past or future.

    Raises:
        InvalidFieldError: gravity is not three finite numbers, or a number exceeds `LARGEST_NUMBER`, beyond
            which squares overflow.

    Examples:
        >>> import contact_dynamics as cd
        >>> brick = cd.Body.box((0.15, 0.09, 0.05), mass=0.4)
        >>> thrown = cd.BodyState(p_WB_W=[0, 0, 1], q_WB=[0, 0, 0, 1], v_WB_W=[2, 0, 3], w_WB_W=[0, 9, 1])
        >>> print(cd.free_motion(brick, thrown).state_at(0.5).p_WB_W.round(3))
        [1.    0.    1.274]

    Source: lecture 25; Jacobi's solution of Euler's equations (`tumbling`).
    """
    body = body.mass_properties
    gravity = check_array("gravity_W", gravity_W, (3,))
    check_extent(state, gravity)
    constants = constants_of(body.I_B.tobytes(), state.q_WB.tobytes(), state.w_WB_W.tobytes(), precision)
    return made(FreeMotion, body, state, gravity, *constants)


def check_extent(state: BodyState, gravity_W: FloatArray) -> None:
    """Reject numbers whose powers leave the range of doubles. The error names the field."""
    numbers = {
        "p_WB_W": state.p_WB_W,
        "v_WB_W": state.v_WB_W,
        "w_WB_W": state.w_WB_W,
        "gravity_W": gravity_W,
    }
    for name, values in numbers.items():
        check_magnitude(name, values)


MAX_TURNED: Final = 1e16
"""Angle, rad, beyond which times are rejected. Neighbouring doubles are then more than a turn apart, and the
double-doubles of phases no longer contain the last bits of a turn."""

REMEMBERED: Final = 128
"""Number of rotations whose constants are cached, 3 kB each, since states are often used twice."""

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
