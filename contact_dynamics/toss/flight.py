# SPDX-License-Identifier: Apache-2.0
"""A flight of a toss, up to its first contact.

The search is that of `landing.plane_arrival`: a corner's height, its rate and a bound on its acceleration
give a time before which it cannot arrive, and crossings are found to rounding. Meanwhile attitude and angular
velocity are Taylor series, which begin anew after a radian or two. They are as exact as the closed form in
doubles, and begin from that where nothing can arrive for many turns.

`flight.pxd` gives the C types with which this file compiles.
"""

from __future__ import annotations

import math
from array import array
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.landing.search_work import MAX_SEARCH_STEPS, SEARCH_BEGUN, SearchWork
from contact_dynamics.tolerances import GRAZING_DEPTH, NEGLIGIBLE_TERM
from contact_dynamics.toss import vectors as vec
from contact_dynamics.toss.solid import Above, properties_of, rows_of, state_of
from contact_dynamics.tumbling import Precision, free_motion

if TYPE_CHECKING:
    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.rotations.one import Quaternion
    from contact_dynamics.toss.solid import Numbers, Solid
    from contact_dynamics.toss.vectors import Matrix3

_ORDER: Final = 20
"""Order of the series. A body turns by one or two radians while they hold."""

_MANY: Final = 30.0
"""Series that are begun one after the other. Beyond them the closed form costs less."""

_MAX_ROOT_STEPS: Final = 100
_GYROSCOPIC: Final = 1.0 / math.sqrt(3.0)
_INFINITE: Final = math.inf


def _closed_form(solid: Solid, gravity: Vector3, y: Numbers, seconds: float) -> Numbers:
    """Return the state at a time, s, of a flight from another one."""
    gravity_W, body = np.array(gravity), properties_of(solid)
    motion = free_motion(body, state_of(y), gravity_W=gravity_W, precision=Precision.DOUBLE)
    sample = motion.sample(seconds)
    return [*sample.p_WB_W, *sample.q_WB, *sample.v_WB_W, *sample.w_WB_W]


class Descent:
    """The heights of corners above flats over time, and the search for the first contact."""

    def __init__(self, solid: Solid) -> None:
        self.solid, self.gravity = solid, solid.gravity
        self.start = [0.0] * 13
        self.above = Above(solid.count * len(solid.flats))  # at the time that was looked at last
        # Heights of corners at another time, m; then a share of each one's acceleration, m/s^2.
        self.before = array("d", bytes(8 * (self.above.count + solid.count)))
        self.pulls = self.before[self.above.count :]
        self.q, self.w, self.momentum = [0.0] * 84, [0.0] * 63, [0.0] * 63  # series, in body axes
        self.begin = self.end = 0.0  # s, between which they hold
        self.looked = -1.0  # s, the time that was looked at last

    def set_out(self, solid: Solid, gravity: Vector3, y: Numbers) -> None:
        """Begin with a state, and bound the accelerations of corners by their turning.

        The body may be another one with as many corners, among as many flats. Gravity is in m/s^2.
        """
        self.solid, self.gravity, self.looked = solid, gravity, -1.0
        for k in range(13):
            self.start[k] = y[k]
        w = vec.transposed_times(rows_of(y[3], y[4], y[5], y[6]), (y[10], y[11], y[12]))
        # Energy bounds the angular velocity, and the angular acceleration is at most a share of its square.
        stiffest = _row_sum(solid.inverse)
        apart = min(_row_sum(solid.inertia) * stiffest - 1.0, 1.0)
        turning = vec.dot(w, vec.times(solid.inertia, w)) * stiffest * (1.0 + _GYROSCOPIC * apart)
        for corner in range(solid.count):
            self.pulls[corner] = vec.norm(solid.corner(corner)) * turning
        self._expand(0.0, (y[3], y[4], y[5], y[6]), w)

    def fly(self, y: Numbers, pause: float, longest: float) -> float:
        """Fly from a state to the first contact with a flat, and return how long that takes, s.

        Arrivals are looked for after a ``pause``, s. The flight ends after the ``longest`` time, s, anyway.

        Raises:
            TooLargeError: the search for the end takes too many steps.
        """
        self.set_out(self.solid, self.solid.gravity, y)
        seconds = self.run(min(pause, longest), longest)
        self.look(seconds)
        return seconds

    def _expand(self, seconds: float, q: Quaternion, w: Vector3) -> None:
        """Begin the series at a time, s, with a quaternion and an angular velocity, body axes."""
        inertia, inverse = self.solid.inertia, self.solid.inverse
        x, y, z, s = q
        scale = 1.0 / math.sqrt(x * x + y * y + z * z + s * s)
        self._put_q(0, scale * x, scale * y, scale * z, scale * s)
        self._put_w(0, w, vec.times(inertia, w))
        for k in range(_ORDER):
            x = y = z = s = a = b = c = 0.0
            for i in range(k + 1):
                g, h, j = 4 * i, 3 * i, 3 * (k - i)
                u, v, t = self.w[j], self.w[j + 1], self.w[j + 2]
                a += self.momentum[h + 1] * t - self.momentum[h + 2] * v
                b += self.momentum[h + 2] * u - self.momentum[h] * t
                c += self.momentum[h] * v - self.momentum[h + 1] * u
                x += self.q[g + 3] * u + self.q[g + 1] * t - self.q[g + 2] * v
                y += self.q[g + 3] * v + self.q[g + 2] * u - self.q[g] * t
                z += self.q[g + 3] * t + self.q[g] * v - self.q[g + 1] * u
                s -= self.q[g] * u + self.q[g + 1] * v + self.q[g + 2] * t
            share = 1.0 / (k + 1.0)
            half = 0.5 * share
            self._put_q(k + 1, half * x, half * y, half * z, half * s)
            w = vec.times(inverse, (share * a, share * b, share * c))
            self._put_w(k + 1, w, vec.times(inertia, w))
        self.begin = seconds
        self.end = seconds + min(self._reach(_ORDER), self._reach(_ORDER - 1))

    def _expand_from(self, seconds: float, y: Numbers) -> None:
        """Begin the series at a time, s, with the state then."""
        rows = rows_of(y[3], y[4], y[5], y[6])
        self._expand(seconds, (y[3], y[4], y[5], y[6]), vec.transposed_times(rows, (y[10], y[11], y[12])))

    def _put_q(self, k: int, x: float, y: float, z: float, s: float) -> None:
        k *= 4
        self.q[k], self.q[k + 1], self.q[k + 2], self.q[k + 3] = x, y, z, s

    def _put_w(self, k: int, w: Vector3, momentum: Vector3) -> None:
        k *= 3
        self.w[k], self.w[k + 1], self.w[k + 2] = w[0], w[1], w[2]
        self.momentum[k], self.momentum[k + 1], self.momentum[k + 2] = momentum[0], momentum[1], momentum[2]

    def _reach(self, k: int) -> float:
        """Return for how long, s, terms are less than counts."""
        size = abs(self.q[4 * k]) + abs(self.q[4 * k + 1]) + abs(self.q[4 * k + 2]) + abs(self.q[4 * k + 3])
        rate = abs(self.w[0]) + abs(self.w[1]) + abs(self.w[2])
        if rate > 0.0:
            change = abs(self.w[3 * k]) + abs(self.w[3 * k + 1]) + abs(self.w[3 * k + 2])
            size = max(size, change / rate)
        return (NEGLIGIBLE_TERM / size) ** (1.0 / k) if size > 0.0 else _INFINITE

    def look(self, seconds: float) -> None:
        """Find heights and rates at a time."""
        if seconds == self.looked:
            return
        self.looked = seconds
        if seconds < self.begin:  # as where a corner grazes a flat just before a series begins
            self._expand_from(0.0, [self.start[k] for k in range(13)])
        if not seconds - self.begin <= _MANY * (self.end - self.begin):
            start = [self.start[k] for k in range(13)]
            self._expand_from(seconds, _closed_form(self.solid, self.gravity, start, seconds))
        while seconds > self.end:
            t = self.end - self.begin
            self._expand(self.end, self._turned(t), self._turning(t))
        self._set_state(seconds)
        self.above.take(self.solid, self.above.y)

    def _turned(self, t: float) -> Quaternion:
        """Return the quaternion of the series at a time after its beginning, s."""
        x = y = z = s = 0.0
        for i in range(_ORDER + 1):
            k = 4 * (_ORDER - i)
            x, y, z, s = (
                x * t + self.q[k],
                y * t + self.q[k + 1],
                z * t + self.q[k + 2],
                s * t + self.q[k + 3],
            )
        return (x, y, z, s)

    def _turning(self, t: float) -> Vector3:
        """Return the angular velocity of the series, rad/s, body axes, at a time after its beginning, s."""
        u = v = w = 0.0
        for i in range(_ORDER + 1):
            k = 3 * (_ORDER - i)
            u, v, w = u * t + self.w[k], v * t + self.w[k + 1], w * t + self.w[k + 2]
        return (u, v, w)

    def _set_state(self, seconds: float) -> None:
        """Find the 13 numbers at a time at which the series holds."""
        y = self.above.y  # C copies arrays that are assigned in parallel
        first = self.start
        a, b, c = self.gravity
        half = 0.5 * seconds
        y[0] = first[0] + seconds * (first[7] + half * a)
        y[1] = first[1] + seconds * (first[8] + half * b)
        y[2] = first[2] + seconds * (first[9] + half * c)
        y[7], y[8], y[9] = first[7] + seconds * a, first[8] + seconds * b, first[9] + seconds * c
        x, yy, z, s = self._turned(seconds - self.begin)
        scale = 1.0 / math.sqrt(x * x + yy * yy + z * z + s * s)
        y[3], y[4], y[5], y[6] = scale * x, scale * yy, scale * z, scale * s
        w = vec.times(rows_of(x, yy, z, s), self._turning(seconds - self.begin))
        y[10], y[11], y[12] = w[0], w[1], w[2]

    def state(self) -> Numbers:
        """Return the 13 numbers at the time that was looked at last."""
        return [self.above.y[k] for k in range(13)]

    def striking(self, near: float) -> int:
        """Return the corner nearer to a flat than this, m, that approaches fastest, or -1."""
        fastest, rate = -1, 0.0
        for k in range(self.above.count):
            if self.above.heights[k] <= near and self.above.rates[k] <= rate:
                fastest, rate = k, self.above.rates[k]
        return fastest

    def run(self, start: float, longest: float) -> float:
        """Return the time, s, of the first contact from a time on, or the longest that is searched."""
        now, steps = start, SEARCH_BEGUN
        last, found = -1.0, 0.0  # the time of the heights before, s
        while True:
            steps += 1
            if steps > MAX_SEARCH_STEPS:
                SearchWork().spend(steps, now)
            self.look(now)
            found = self._arrival(last, now)
            if found >= 0.0:
                return found
            if now >= longest:
                return longest
            for k in range(self.above.count):
                self.before[k] = self.above.heights[k]
            last = now
            now = min(now + self._free(), longest)

    def _free(self) -> float:
        """Return for how long, s, no corner can arrive."""
        solid, y = self.solid, self.above.y
        least, k = _INFINITE, 0
        p, v = (y[0], y[1], y[2]), (y[7], y[8], y[9])
        for s in range(len(solid.flats)):
            flat, first = solid.flats[s], _INFINITE
            fall = -vec.dot(flat.normal, self.gravity)  # the acceleration of the mass centre towards it
            for corner in range(solid.count):
                free = free_for(self.above.heights[k], self.above.rates[k], fall + self.pulls[corner])
                first = min(first, free)
                k += 1
            room = vec.dot(p, flat.normal) - flat.level - solid.rounding - (solid.reach - solid.rounding)
            if room > 0.0:
                first = max(first, free_for(room, vec.dot(v, flat.normal), fall))
            least = min(least, first)
        return least

    def _arrival(self, last: float, now: float) -> float:
        """Return when a corner has come down since the last look, or sinks now, s, or -1."""
        part, least = -1, 0.0
        sinks = False
        for k in range(self.above.count):
            if self.above.heights[k] <= 0.0:
                sinks = sinks or self.above.rates[k] <= 0.0
                if last >= 0.0 and self.before[k] > 0.0 and (part < 0 or self.above.heights[k] < least):
                    part, least = k, self.above.heights[k]
        if part >= 0:
            return self._crossing(part, last, now)
        return now if sinks else -1.0

    def _crossing(self, part: int, low: float, high: float) -> float:
        """Return the first time between two at which a corner comes down: a given one, or one before it."""
        while True:
            high = self._root(part, low, high)
            self.look(high)
            self.before[part] = -1.0
            part, least = -1, 0.0
            for k in range(self.above.count):
                if self.before[k] > 0.0 and self.above.heights[k] < least:
                    part, least = k, self.above.heights[k]
            if part < 0:
                return high

    def _root(self, part: int, low: float, high: float) -> float:
        """Return when a corner reaches the flat. It is above it at ``low`` and not at ``high``."""
        now = high
        for _ in range(_MAX_ROOT_STEPS):
            self.look(now)
            height, rate = self.above.heights[part], self.above.rates[part]
            if height > 0.0:
                low = now
            else:
                high = now
            following = now - height / rate if rate < 0.0 else low
            last_bit = ulp(now)
            if height == 0.0 or abs(height) <= -rate * last_bit:
                break  # Newton's next step would be within rounding
            if not low < following < high:
                following = 0.5 * (low + high)
            if abs(following - now) <= last_bit:
                break
            now = following
        return now


def free_for(height: float, rate: float, pull: float) -> float:
    """Return for how long, s, a point above a flat cannot arrive (`landing.acceleration_bounds`)."""
    if height <= 0.0:
        if pull <= 0.0:
            return _INFINITE
        return max(rate, math.sqrt(2.0 * GRAZING_DEPTH * pull)) / pull
    allowed = height + GRAZING_DEPTH
    stop = rate * rate + 2.0 * pull * allowed
    if rate < 0.0:
        return 2.0 * allowed / (math.sqrt(stop) - rate) if stop >= 0.0 else _INFINITE
    return (rate + math.sqrt(stop)) / pull if pull > 0.0 else _INFINITE


def ulp(x: float) -> float:
    """Return the distance to the next double away from zero, for x >= 0."""
    return math.nextafter(x, _INFINITE) - x


def _row_sum(matrix: Matrix3) -> float:
    """Return the largest sum of a row's magnitudes, which is at least the largest eigenvalue."""
    a, b, c, d, e, f, g, h, i = matrix
    return max(abs(a) + abs(b) + abs(c), abs(d) + abs(e) + abs(f), abs(g) + abs(h) + abs(i))
