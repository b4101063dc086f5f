# SPDX-License-Identifier: Apache-2.0
"""One contact in space with 40 digits: the impulse path by quadrature over the sliding direction.

Let the tangential velocity be u = q (cos a, sin a). Then dq/dp = g(a) and q da/dp = h(a), so that between two
invariant directions, where h = 0, the angle a can replace the normal impulse p:

    log q = integral of g/h da,     p = integral of q/h da,     friction's work = mu integral of q^2/h da.

The first is a sum of logarithms, since g and h are polynomials in exp(i a) and exp(-i a). The others are
Gauss-Legendre sums over parts that keep away from the zeros of h. Everything else follows from momentum and
energy. No step depends on how stiff the equations are. Near an invariant direction, the rest is straight.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import mpmath
from mpmath import mp, mpf

DIGITS = 40
PART = 0.7
"""Length of a part, relative to the distance of its begin from the nearest zero of h."""
NODES = 22
"""Zeros of h are at least 1.86 half-lengths from the middle of a part: 22 nodes leave 3.43^-44 = 3e-24."""
ONE = mpf(1)
NEAR = mpf(10) ** -17
"""rad, from an invariant direction, where the rest of the sliding counts as straight."""


@dataclass
class Point:
    """Impulse along two tangents and the normal, normal velocity, work of the normal impulse."""

    i1: mpf
    i2: mpf
    p: mpf
    v_n: mpf
    work: mpf


@dataclass
class Law:
    l1: mpf
    l2: mpf
    k1: mpf
    k2: mpf
    kn: mpf
    mu: mpf

    def g(self, a: mpf) -> mpf:
        c, s = mp.cos(a), mp.sin(a)
        return self.k1 * c + self.k2 * s - self.mu * (self.l1 * c * c + self.l2 * s * s)

    def h(self, a: mpf) -> mpf:
        c, s = mp.cos(a), mp.sin(a)
        return self.k2 * c - self.k1 * s + self.mu * (self.l1 - self.l2) * c * s


Segment = Callable[[mpf], Point]
"""What has grown since the segment's begin, at a part of it between 0 and 1; v_n is not growth but value."""


def impulse(
    K: list[list[float]], u: tuple[float, float], v_n: float, *, mu: float, e: float, law: str
) -> list[mpf]:
    """Return the impulse along two tangents and the normal.

    Args:
        K: (3, 3), the contact's inverse inertia along these axes.
        u: Sliding velocity.
        v_n: Normal velocity, at most 0.
        mu: Coefficient of friction, > 0.
        e: Coefficient of restitution.
        law: "poisson", "newton" or "energetic".
    """
    with mpmath.workdps(DIGITS):
        K = [[mpf(x) for x in row] for row in K]
        turn = mp.atan2(2 * K[0][1], K[0][0] - K[1][1]) / 2
        c, s = mp.cos(turn), mp.sin(turn)
        sliding = Law(
            c * c * K[0][0] + 2 * c * s * K[0][1] + s * s * K[1][1],
            s * s * K[0][0] - 2 * c * s * K[0][1] + c * c * K[1][1],
            c * K[0][2] + s * K[1][2],
            -s * K[0][2] + c * K[1][2],
            K[2][2],
            mpf(mu),
        )
        x, y = mpf(u[0]), mpf(u[1])
        progress = _Restitution(law, mpf(e), mpf(v_n))
        i1, i2, p = _path(sliding, c * x + s * y, -s * x + c * y, progress)
        return [c * i1 - s * i2, s * i1 + c * i2, p]


class _Restitution:
    """The laws of restitution by their definitions, segment by segment, on each of which v_n is monotone."""

    def __init__(self, law: str, e: mpf, v_n: mpf) -> None:
        self.law, self.e, self.v_n, self.final = law, e, v_n, -e * v_n
        self.total = [mpf(0)] * 3
        self.due, self.compressing, self.over = mpf(0), True, False

    def follow(self, segment: Segment) -> None:
        begin = mpf(0)
        while not self.over:
            first, last = segment(begin), segment(mpf(1))
            if self.compressing:
                if last.v_n <= 0:
                    return self._take(first, last)
                begin = _root(lambda x: segment(x).v_n, begin)
                self._take(first, segment(begin))
                self.compressing = False
                continue
            end = mpf(1) if last.v_n >= 0 else _root(lambda x: -segment(x).v_n, begin)
            last = segment(end)
            if self._left(first, last) <= 0:
                end = _root(lambda x, f=first: -self._left(f, segment(x)), begin, end)
                self._take(first, segment(end))
                self.over = True
            else:
                self._take(first, last)
                if end == 1:
                    return None
                begin, self.compressing = end, True
        return None

    def _left(self, first: Point, last: Point) -> mpf:
        """What is left to give back, at ``last``."""
        if self.law == "newton":
            return self.final - last.v_n
        return self.due - self._amount(first, last)

    def _amount(self, first: Point, last: Point) -> mpf:
        return last.work - first.work if self.law == "energetic" else last.p - first.p

    def _take(self, first: Point, last: Point) -> None:
        amount = self._amount(first, last)
        share = self.e**2 if self.law == "energetic" else self.e
        self.due += share * abs(amount) if self.compressing else -amount
        for i, name in enumerate(("i1", "i2", "p")):
            self.total[i] += getattr(last, name) - getattr(first, name)
        self.v_n = last.v_n


def _path(sliding: Law, x: mpf, y: mpf, progress: _Restitution) -> list[mpf]:
    q = mp.sqrt(x * x + y * y)
    if q > 0:
        _slide(sliding, mp.atan2(y, x), q, progress)
    if not progress.over:
        _after_stop(sliding, progress)
    return progress.total


def _slide(sliding: Law, a: mpf, q: mpf, progress: _Restitution) -> None:
    zeros = _zeros_of_h(sliding)
    real = [z.real for z in zeros if abs(z.imag) < NEAR]
    if min((_apart(a, z) for z in real), default=mpf(1)) > NEAR:
        way = 1 if sliding.h(a) > 0 else -1
        target = a + way * min((way * (z - a)) % (2 * mp.pi) for z in real)
        q_at = _speed(sliding, zeros)
        stopped = NEAR * q
        while abs(target - a) > NEAR and q > stopped and not progress.over:
            # The speed changes by at most e^2 over a part, so that the sums stay good.
            part = min(PART * min(_apart(a, z) for z in zeros), 2 * abs(sliding.h(a) / sliding.g(a)))
            b = a + way * part
            progress.follow(_curved(sliding, (a, b), lambda c, a=a, q=q: q * q_at(a, c), progress.v_n))
            a, q = b, q * q_at(a, b)
        if q > stopped:
            a = target
    rate, lifting = sliding.g(a), sliding.kn - sliding.mu * (sliding.k1 * mp.cos(a) + sliding.k2 * mp.sin(a))
    rates = (-sliding.mu * mp.cos(a), -sliding.mu * mp.sin(a))
    if rate < 0:
        if not progress.over:
            progress.follow(_straight(rates, lifting, progress.v_n, q / -rate))
    else:
        _until_over(rates, lifting, progress)


def _after_stop(sliding: Law, progress: _Restitution) -> None:
    k1, k2, l1, l2, mu = sliding.k1, sliding.k2, sliding.l1, sliding.l2, sliding.mu
    i1, i2 = -k1 / l1, -k2 / l2
    if mp.sqrt(i1 * i1 + i2 * i2) > mu:

        def too_long(g: mpf) -> mpf:
            return mp.sqrt((k1 / (mu * l1 + g)) ** 2 + (k2 / (mu * l2 + g)) ** 2) - 1

        high = mp.sqrt(k1 * k1 + k2 * k2)
        g = _root(lambda x: -too_long(x * high), mpf(0)) * high
        i1, i2 = -mu * k1 / (mu * l1 + g), -mu * k2 / (mu * l2 + g)
    _until_over((i1, i2), sliding.kn + k1 * i1 + k2 * i2, progress)


def _until_over(rates: tuple[mpf, mpf], lifting: mpf, progress: _Restitution) -> None:
    length = abs(progress.v_n / lifting) + mp.sqrt(2 * abs(progress.due) / abs(lifting)) + abs(progress.due)
    length += progress.final / abs(lifting)
    while not progress.over:
        progress.follow(_straight(rates, lifting, progress.v_n, length))
        length *= 4


def _straight(rates: tuple[mpf, mpf], lifting: mpf, v_n: mpf, length: mpf) -> Segment:
    def at(x: mpf) -> Point:
        p = x * length
        return Point(rates[0] * p, rates[1] * p, p, v_n + lifting * p, p * (v_n + lifting * p / 2))

    return at


def _curved(sliding: Law, ends: tuple[mpf, mpf], speed_at: Callable[[mpf], mpf], v_n: mpf) -> Segment:
    a, b = ends
    q = speed_at(a)

    @cache
    def at(x: mpf) -> Point:
        end = a + x * (b - a)
        p = rubbed = mpf(0)
        for node, weight in _nodes():
            c = a + (end - a) * node
            speed = speed_at(c)
            p += weight * speed / sliding.h(c)
            rubbed += weight * speed * speed / sliding.h(c)
        p, rubbed = p * (end - a), rubbed * (end - a)
        speed = speed_at(end)
        u = (q * mp.cos(a), q * mp.sin(a))
        w = (speed * mp.cos(end), speed * mp.sin(end))
        i1, i2 = (w[0] - u[0] - sliding.k1 * p) / sliding.l1, (w[1] - u[1] - sliding.k2 * p) / sliding.l2
        v = v_n + sliding.kn * p + sliding.k1 * i1 + sliding.k2 * i2
        gain = (i1 * (u[0] + w[0]) + i2 * (u[1] + w[1]) + p * (v_n + v)) / 2
        return Point(i1, i2, p, v, gain + sliding.mu * rubbed)

    return at


def _zeros_of_h(sliding: Law) -> list[mpmath.mpc]:
    """Return the complex angles at which h is zero: 4 i z^2 h is a polynomial in z = exp(i a)."""
    m = sliding.mu * (sliding.l1 - sliding.l2)
    k = mpmath.mpc(sliding.k1, -sliding.k2)
    with mpmath.workdps(3 * DIGITS):
        rows = [[2 * k / m, 0, -2 * mp.conj(k) / m, 1], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]
        roots, _ = mp.eig(mp.matrix(rows))
        return [-mpmath.mpc(0, 1) * mp.log(z) for z in roots]


def _speed(sliding: Law, zeros: list[mpmath.mpc]) -> Callable[[mpf, mpf], mpf]:
    """Return the ratio of the speeds at two angles near each other, by partial fractions of g/h."""
    i = mpmath.mpc(0, 1)
    points = [mp.exp(i * a) for a in zeros]
    mean, spread = sliding.mu * (sliding.l1 + sliding.l2) / 2, sliding.mu * (sliding.l1 - sliding.l2) / 2
    k = mpmath.mpc(sliding.k1, -sliding.k2)

    def numerator(z: mpmath.mpc) -> mpmath.mpc:  # 4 i z^2 g
        return 2 * i * (-spread * z**4 + k * z**3 - 2 * mean * z**2 + mp.conj(k) * z - spread)

    lead = 2 * spread  # of 4 i z^2 h
    residues = [numerator(mpf(0)) / (i * -lead)]
    for j, z in enumerate(points):
        slope = lead
        for n, other in enumerate(points):
            slope *= z - other if n != j else 1
        residues.append(numerator(z) / (i * z * slope))
    poles = [mpf(0), *points]

    def ratio(a: mpf, b: mpf) -> mpf:
        first, last = mp.exp(i * a), mp.exp(i * b)
        total = sum(
            (c * mp.log((last - z) / (first - z)) for c, z in zip(residues, poles, strict=True)), mpf(0)
        )
        return mp.exp(total.real)

    return ratio


def _apart(a: mpf, zero: mpmath.mpc) -> mpf:
    """Return the distance of a real angle from a complex one, up to whole turns."""
    real = (a - mp.re(zero) + mp.pi) % (2 * mp.pi) - mp.pi
    return mp.sqrt(real**2 + mp.im(zero) ** 2)


@cache
def _nodes() -> list[tuple[mpf, mpf]]:
    """Return nodes and weights of Gauss and Legendre on [0, 1]."""
    with mpmath.workdps(DIGITS + 10):
        found = []
        for j in range(1, NODES + 1):
            x = mp.cos(mp.pi * (j - mpf(1) / 4) / (NODES + mpf(1) / 2))
            for _ in range(8):
                p0, p1 = mpf(1), x
                for n in range(2, NODES + 1):
                    p0, p1 = p1, ((2 * n - 1) * x * p1 - (n - 1) * p0) / n
                slope = NODES * (x * p1 - p0) / (x * x - 1)
                x -= p1 / slope
            found.append(((1 - x) / 2, 1 / ((1 - x * x) * slope**2)))
        return found


def _root(f: Callable[[mpf], mpf], low: mpf, high: mpf = ONE) -> mpf:
    """Return where a function that rises through zero on [low, high] does: regula falsi with halved ends."""
    f_low, f_high = f(low), f(high)
    if f_low >= 0:
        return low
    side = 0
    for _ in range(400):
        x = (low * f_high - high * f_low) / (f_high - f_low)
        if not low < x < high:
            return x
        y = f(x)
        if y == 0 or high - low <= mpf(10) ** -25 * abs(high):
            return x
        if y < 0:
            low, f_low = x, y
            f_high = f_high / 2 if side < 0 else f_high
            side = -1
        else:
            high, f_high = x, y
            f_low = f_low / 2 if side > 0 else f_low
            side = 1
    raise AssertionError("no root")
