"""A flight of a toss, in closed form, up to its first contact.

The search is that of `landing.plane_arrival`: a corner's height, its rate and a bound on its acceleration
give a time before which it cannot arrive, and crossings are found to rounding. Meanwhile the flat's normal in
body axes is a Taylor series, which begins anew from the closed form after about a radian.

`flight.pxd` gives the C types with which this file compiles.
"""

from __future__ import annotations

import math
from array import array
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from contact_dynamics.landing.acceleration_bounds import bounds_of
from contact_dynamics.landing.search_work import SEARCH_BEGUN, SearchWork
from contact_dynamics.tolerances import GRAZING_DEPTH, NEGLIGIBLE_TERM
from contact_dynamics.toss import vectors as vec
from contact_dynamics.toss.solid import pose_of, state_of
from contact_dynamics.tumbling import FreeMotion, Precision, free_motion

if TYPE_CHECKING:
    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.rigid_body.body import MassProperties
    from contact_dynamics.toss.solid import Numbers, Solid

_ORDER: Final = 20
"""Order of the series. A body turns by about a radian while they hold."""

_MAX_ROOT_STEPS: Final = 100
_INFINITE: Final = math.inf


class Flight(NamedTuple):
    """A flight.

    Attributes:
        motion: The motion, which does not end by itself.
        seconds: s, how long the flight lasts.
        after: The state at its end.
    """

    motion: FreeMotion
    seconds: float
    after: Numbers


def flight(
    solid: Solid, properties: MassProperties, y: Numbers, *, stamp_ns: int, longest: float, pause: float
) -> Flight:
    """Return the flight from a state to the first contact with a flat.

    Args:
        solid: The body and the flats.
        properties: Mass and inertia of the solid.
        y: The state at the beginning.
        stamp_ns: Its stamp.
        longest: s, after which the flight ends anyway.
        pause: s, after which arrivals are looked for.

    Raises:
        TooLargeError: the search for the end takes too many steps.
    """
    gravity, work = np.array(solid.gravity), SearchWork()
    motion = free_motion(properties, state_of(y, stamp_ns), gravity_W=gravity, precision=Precision.DOUBLE)
    first = longest
    for k, flat in enumerate(solid.flats):
        bound = bounds_of(motion, np.array(flat.normal))(0.0)
        first = Descent(solid, k, motion, bound.fall, bound.turning).run(min(pause, first), first, work)
    return Flight(motion, first, _numbers(motion, first))


def _numbers(motion: FreeMotion, seconds: float) -> Numbers:
    sample = motion.sample(seconds)
    return [*sample.p_WB_W, *sample.q_WB, *sample.v_WB_W, *sample.w_WB_W]


class Descent:
    """The heights of corners above one flat over time, and the search for the first contact."""

    def __init__(self, solid: Solid, flat: int, motion: Any, fall: float, turning: float) -> None:
        self.solid, self.motion = solid, motion
        self.normal: Vector3 = solid.flats[flat].normal
        self.level = solid.flats[flat].level + solid.rounding
        self.fall, self.turning = fall, turning
        self.farthest = solid.reach - solid.rounding
        self.begin = self.end = 0.0  # s, between which the series holds
        self.w, self.momentum = [0.0] * 63, [0.0] * 63  # rad/s, kg m^2/s, body axes: their series
        self.n = [0.0] * 63  # that of the normal, body axes
        self.high = self.rise = 0.0  # m, m/s, of the mass centre when the series begins
        self.centre = self.centre_rate = 0.0  # the same at the time that was looked at last
        # m, m/s, of corners then; heights before that
        self.heights = array("d", bytes(8 * solid.count))
        self.rates = array("d", bytes(8 * solid.count))
        self.before = array("d", bytes(8 * solid.count))

    def expand(self, seconds: float) -> None:
        """Begin the series at a time, s."""
        pose = pose_of(self.solid, _numbers(self.motion, seconds))
        inertia, inverse = self.solid.inertia, self.solid.inverse
        self.high = vec.dot(pose.position, self.normal) - self.level
        self.rise = vec.dot(pose.v, self.normal)
        w = vec.transposed_times(pose.rows, pose.w)
        self.put(0, w, vec.times(inertia, w), vec.transposed_times(pose.rows, self.normal))
        for k in range(_ORDER):
            x = y = z = a = b = c = 0.0
            for i in range(k + 1):
                h, j = 3 * i, 3 * (k - i)
                u, v, t = self.w[j], self.w[j + 1], self.w[j + 2]
                x += self.momentum[h + 1] * t - self.momentum[h + 2] * v
                y += self.momentum[h + 2] * u - self.momentum[h] * t
                z += self.momentum[h] * v - self.momentum[h + 1] * u
                a += self.n[h + 1] * t - self.n[h + 2] * v
                b += self.n[h + 2] * u - self.n[h] * t
                c += self.n[h] * v - self.n[h + 1] * u
            share = 1.0 / (k + 1.0)
            w = vec.times(inverse, (share * x, share * y, share * z))
            self.put(k + 1, w, vec.times(inertia, w), (share * a, share * b, share * c))
        self.begin = seconds
        self.end = seconds + min(self.reach(_ORDER), self.reach(_ORDER - 1))

    def put(self, k: int, w: Vector3, momentum: Vector3, n: Vector3) -> None:
        """Note a term of the series."""
        k *= 3
        self.w[k], self.w[k + 1], self.w[k + 2] = w[0], w[1], w[2]
        self.momentum[k], self.momentum[k + 1], self.momentum[k + 2] = momentum[0], momentum[1], momentum[2]
        self.n[k], self.n[k + 1], self.n[k + 2] = n[0], n[1], n[2]

    def reach(self, k: int) -> float:
        """Return for how long, s, a term is less than counts."""
        size = abs(self.n[3 * k]) + abs(self.n[3 * k + 1]) + abs(self.n[3 * k + 2])
        return (NEGLIGIBLE_TERM / size) ** (1.0 / k) if size > 0.0 else _INFINITE

    def look(self, seconds: float) -> None:
        """Find heights and rates at a time while the series holds."""
        t = seconds - self.begin
        x = y = z = u = v = w = 0.0
        for k in range(_ORDER, -1, -1):
            u, v, w = u * t + x, v * t + y, w * t + z
            x, y, z = x * t + self.n[3 * k], y * t + self.n[3 * k + 1], z * t + self.n[3 * k + 2]
        self.centre = self.high + t * (self.rise - 0.5 * t * self.fall)
        self.centre_rate = self.rise - t * self.fall
        for k in range(self.solid.count):
            corner = self.solid.corner(k)
            self.heights[k] = x * corner[0] + y * corner[1] + z * corner[2] + self.centre
            self.rates[k] = u * corner[0] + v * corner[1] + w * corner[2] + self.centre_rate

    def run(self, start: float, longest: float, work: SearchWork) -> float:
        """Return the time, s, of the first contact from a time on, or the longest that is searched."""
        solid = self.solid
        now = start
        last, found = -1.0, 0.0  # the time of the heights before, s
        work.spend(SEARCH_BEGUN, now)
        self.expand(now)
        while True:
            work.spend(1, now)
            self.look(now)
            found = self._arrival(last, now)
            if found >= 0.0:
                return found
            if now >= longest:
                return longest
            if now >= self.end:
                self.expand(now)
            step = self._free()
            far = 0.0
            if self.centre > self.farthest:
                far = free_for(self.centre - self.farthest, self.centre_rate, self.fall)
            for k in range(solid.count):
                self.before[k] = self.heights[k]
            last = now
            if far > step and now + far > self.end:  # where nothing can arrive the series need not hold
                now = min(now + far, longest)
                self.expand(now)
            else:
                now = min(now + max(step, far), self.end, longest)

    def _free(self) -> float:
        """Return for how long, s, no corner can arrive."""
        least = _INFINITE
        for k in range(self.solid.count):
            pull = self.fall + vec.norm(self.solid.corner(k)) * self.turning
            least = min(least, free_for(self.heights[k], self.rates[k], pull))
        return least

    def _arrival(self, last: float, now: float) -> float:
        """Return when a corner has come down since the last look, or sinks now, s, or -1."""
        part, least = -1, 0.0
        sinks = False
        for k in range(self.solid.count):
            if self.heights[k] <= 0.0:
                sinks = sinks or self.rates[k] <= 0.0
                if last >= 0.0 and self.before[k] > 0.0 and (part < 0 or self.heights[k] < least):
                    part, least = k, self.heights[k]
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
            for k in range(self.solid.count):
                if self.before[k] > 0.0 and self.heights[k] < least:
                    part, least = k, self.heights[k]
            if part < 0:
                return high

    def _root(self, part: int, low: float, high: float) -> float:
        """Return when a corner reaches the flat. It is above it at ``low`` and not at ``high``."""
        now = high
        for _ in range(_MAX_ROOT_STEPS):
            self.look(now)
            height, rate = self.heights[part], self.rates[part]
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
