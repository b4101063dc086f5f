# SPDX-License-Identifier: Apache-2.0
"""A free body's attitude to 50 digits, the textbook's way and with nothing of the package.

Landau and Lifshitz, Mechanics, 37: body rates are cn, sn, dn of time; two Euler angles follow from where L
lies in the body, the third is an incomplete elliptic integral of the third kind. So many digits leave
no cancellation to worry about, and the doubles given count as exact numbers.
"""

from __future__ import annotations

from collections.abc import Sequence

import mpmath
from mpmath import mpf

DIGITS = 80
"""Number of digits, unless more are asked for. A sum may lose 20 of them before it counts as zero."""


class ExactMotion:
    """Torque-free rotation from ``q_WB`` (x, y, z, w, of any length) and ``w_WB_W`` at time 0."""

    def __init__(
        self,
        I_B: Sequence[Sequence[float]],
        q_WB: Sequence[float],
        w_WB_W: Sequence[float],
        *,
        digits: int = DIGITS,
    ) -> None:
        self.digits = digits
        with mpmath.workdps(digits):
            self.nothing = mpf(10) ** (20 - digits)
            self.R_W0 = rotation_matrix(q_WB)
            self.w_W = mpmath.matrix([mpf(x) for x in w_WB_W])
            moments, R_BP = _principal(I_B)
            w = list(R_BP.T * (self.R_W0.T * self.w_W))
            twist = sum(abs((moments[i] - moments[j]) * w[i] * w[j]) for i, j in ((0, 1), (1, 2), (2, 0)))
            self.steady = twist <= self.nothing * sum(i * x**2 for i, x in zip(moments, w, strict=True))
            if not self.steady:
                self._begin(moments, R_BP, w)

    def _begin(self, moments: list[mpf], R_BP: mpmath.matrix, w: list[mpf]) -> None:
        order = sorted(range(3), key=lambda i: moments[i])
        middle = moments[order[1]]
        excess = [moments[j] * (moments[j] - middle) * w[j] ** 2 for j in range(3)]  # of L^2 over 2 T I_2
        if sum(excess) < 0:
            order.reverse()
        self.I = [moments[i] for i in order]
        self.R_BP = mpmath.matrix([[R_BP[i, j] for j in order] for i in range(3)])
        w = [w[i] for i in order]
        if mpmath.det(self.R_BP) < 0:
            self.R_BP, w = -self.R_BP, [-x for x in w]
        I1, I2, I3 = self.I
        L2 = sum((i * x) ** 2 for i, x in zip(self.I, w, strict=True))
        self.T2 = sum(i * x**2 for i, x in zip(self.I, w, strict=True))
        self.L = mpmath.sqrt(L2)
        # w = (a cn u, b sn u, c dn u) with u = rate t + u0
        self.a = mpmath.sqrt((L2 - self.T2 * I3) / (I1 * (I1 - I3))) * (1 if w[0] >= 0 else -1)
        self.b = mpmath.sqrt((L2 - self.T2 * I3) / (I2 * (I2 - I3)))
        self.c = mpmath.sqrt((L2 - self.T2 * I1) / (I3 * (I3 - I1))) * (1 if w[2] >= 0 else -1)
        self.rate = (I3 - I2) / I1 * self.b * self.c / self.a
        self.m = (L2 - self.T2 * I3) * (I1 - I2) / ((L2 - self.T2 * I1) * (I3 - I2))
        if abs(sum(excess)) <= self.nothing * sum(abs(x) for x in excess):
            self.m = mpf(1)
        self.n = -self.m * (I3 * self.c / (I1 * self.a)) ** 2
        self.K = mpmath.ellipk(self.m)
        angle = mpmath.atan2(w[1] / self.b, w[0] / self.a)
        self.u0 = mpmath.ellipf(angle, self.m)
        self.R_0L = self.R_BP * self._about_L(mpf(0)).T

    def rotation(self, seconds: float) -> mpmath.matrix:
        """Return the attitude at a time as a rotation matrix, body to world."""
        with mpmath.workdps(self.digits):
            t = mpf(seconds)
            if self.steady:
                return _turn(self.w_W * t) * self.R_W0
            return self.R_W0 * self.R_0L * self._about_L(t) * self.R_BP.T

    def _about_L(self, t: mpf) -> mpmath.matrix:
        """Return the attitude of the principal axes in a frame with its z axis along L, by Euler's angles."""
        I1, I2, I3 = self.I
        u = self.rate * t + self.u0
        sn, cn, dn = (mpmath.ellipfun(kind, u, m=self.m) for kind in ("sn", "cn", "dn"))
        x, y, z = I1 * self.a * cn / self.L, I2 * self.b * sn / self.L, I3 * self.c * dn / self.L
        across = mpmath.sqrt(x**2 + y**2)
        weight = self.L / I3 * (self.T2 * I3 - self.L**2) / (I1 * self.a) ** 2 / self.rate
        phi = self.L / I3 * t + weight * (self._third_kind(u) - self._third_kind(self.u0))
        node = mpmath.matrix([[y / across, -x / across, 0]])
        third = mpmath.matrix([[x * z / across, y * z / across, -across]])
        turn = _turn(mpmath.matrix([0, 0, phi]))
        return turn * mpmath.matrix([list(node), list(third), [x, y, z]])

    def _third_kind(self, u: mpf) -> mpf:
        """Return the integral of 1 / (1 - n sn^2) from 0 to u."""
        if self.m == 1:
            p = mpmath.sqrt(-self.n)
            return (u + p * mpmath.atan(p * mpmath.tanh(u))) / (1 + p * p)
        halves = mpmath.nint(u / (2 * self.K))
        rest = u - 2 * halves * self.K
        angle = mpmath.atan2(
            mpmath.ellipfun("sn", rest, m=self.m), abs(mpmath.ellipfun("cn", rest, m=self.m))
        )
        return 2 * halves * mpmath.ellippi(self.n, self.m) + mpmath.ellippi(self.n, angle, self.m)

    def errors(self, seconds: float, *answers: Sequence[float]) -> list[float]:
        """Return the angles, rad, by which quaternions (of any length) are off the attitude at a time."""
        R = self.rotation(seconds)
        with mpmath.workdps(self.digits):
            return [angle_between(R, rotation_matrix(q_WB)) for q_WB in answers]


def angle_between(one: mpmath.matrix, other: mpmath.matrix) -> float:
    """Return the angle, rad, of the rotation from one matrix to another."""
    off = one.T * other
    sine = [off[2, 1] - off[1, 2], off[0, 2] - off[2, 0], off[1, 0] - off[0, 1]]
    return float(mpmath.atan2(mpmath.norm(mpmath.matrix(sine)), off[0, 0] + off[1, 1] + off[2, 2] - 1))


def rotation_matrix(q: Sequence[float]) -> mpmath.matrix:
    """Return the rotation of a quaternion x, y, z, w of any length."""
    x, y, z, w = (mpf(i) for i in q)
    n = x * x + y * y + z * z + w * w
    return (
        mpmath.matrix(
            [
                [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
            ]
        )
        / n
    )


def _principal(I_B: Sequence[Sequence[float]]) -> tuple[list[mpf], mpmath.matrix]:
    inertia = mpmath.matrix([[(mpf(I_B[i][j]) + mpf(I_B[j][i])) / 2 for j in range(3)] for i in range(3)])
    if all(inertia[i, j] == 0 for i in range(3) for j in range(3) if i != j):
        return [inertia[i, i] for i in range(3)], mpmath.eye(3)
    moments, axes = mpmath.eigsy(inertia)
    return list(moments), axes


def _turn(rotation_vector: mpmath.matrix) -> mpmath.matrix:
    """Return Rodrigues' rotation."""
    angle = mpmath.norm(rotation_vector)
    if angle == 0:
        return mpmath.eye(3)
    x, y, z = (i / angle for i in rotation_vector)
    skew = mpmath.matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return mpmath.eye(3) + mpmath.sin(angle) * skew + (1 - mpmath.cos(angle)) * skew * skew
