# SPDX-License-Identifier: Apache-2.0
"""Finds the first time at which a moving body reaches a plane, where the flight of lecture 25 ends.

The shape is convex (`shapes.convex`). Its parts that arrive are corners and rims, corners first. The heights
of a corner, of a ball's centre and of each point of a rim have second derivatives that are bounded along the
motion (`acceleration_bounds`), for all time without torque, and for each step of the integrator under forces.
So a height and its rate give a time before which the part cannot arrive (all points of a rim have one
together). The search goes to that time, and on from there. It misses no dip, however short, except dips of
less than `GRAZING_DEPTH`. It then finds the crossing to rounding. Under forces this holds for the integrated
motion, which is accurate to about 1e-12 of its lengths (`motion.integrated`).

Not covered: edges of the plane, curved surfaces, several bodies.

The points of a rim at the angle phi have heights h + a . u(phi) and rates h' + b . u(phi), with u = (cos phi,
sin phi) and a, b the heights and rates of two orthogonal radii. If no point is pulled down by more than P,
none is below -g before the first root of

    h + g + h' t - P t^2 / 2 - |a + b t|,

which is concave in t. So Newton's steps that start beyond the root come down to it. A time at which any one
point of the rim is at -g is beyond the root.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.constants import HORIZON
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.landing.acceleration_bounds import Bound, all_free_for, bounds_of, free_for
from contact_dynamics.landing.search_work import SEARCH_BEGUN, SearchWork
from contact_dynamics.records import Record
from contact_dynamics.rotations.one import conjugate, rotated
from contact_dynamics.shapes.convex import ConvexShape
from contact_dynamics.shapes.hull_features import radii_of
from contact_dynamics.tolerances import GRAZING_DEPTH, RIM_ACCURACY
from contact_dynamics.validation import (
    FloatArray,
    check_array,
    check_magnitude,
    check_not_negative,
    check_unit,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from contact_dynamics.landing.acceleration_bounds import Motion
    from contact_dynamics.rotations.one import Vector
    from contact_dynamics.tumbling.motion import Sample


_MAX_ROOT_STEPS: Final = 100
"""Largest number of steps to a root. Bisection alone needs 60 for the last bit, and Newton's steps need four.
"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FirstContact(Record):
    """Arrival of a body at a plane.

    Attributes:
        seconds: Time of the arrival, s after the state's stamp, >= 0.
        vertices: Index of the part that arrives, then the indices of other parts within `GRAZING_DEPTH`.
            Corners are counted first, then rims. If the shape has several `hulls`, they are those of one.
        p_WC_W: (3,), m, point that arrives, world.
        v_WC_W: (3,), m/s, velocity of that point, world axes.
    """

    seconds: float
    vertices: tuple[int, ...]
    p_WC_W: FloatArray
    v_WC_W: FloatArray


def first_contact(
    motion: Motion,
    shape_B: ConvexShape | ArrayLike,
    p_WS_W: ArrayLike,
    normal_W: ArrayLike,
    *,
    horizon: float = HORIZON,
    work: SearchWork | None = None,
) -> FirstContact | None:
    """Return the first time in [0, horizon] at which a body is on or below a plane and not rising, or None.

    A part above the plane arrives when it reaches the plane. A part on or below the plane at time 0 arrives
    immediately if it sinks or rests; if it rises, it arrives when it returns to the plane.

    Args:
        motion: Flight, in closed form or integrated (`motion_of`).
        shape_B: Shape in body axes, relative to the centre of mass; or the corners of a polyhedron, (k, 3),
            m; or one point of the body.
        p_WS_W: (3,), m, a point of the plane, world.
        normal_W: (3,), unit normal towards the free side, world axes.
        horizon: Look-ahead time, s after the state's stamp.
        work: Count of steps, which may be shared with other searches. By default, this search may take
            `MAX_SEARCH_STEPS` steps.

    Raises:
        TooLargeError: the search takes too many steps, because the body spins too fast, or is too large, for
            the horizon.
        InvalidFieldError: an array has a wrong shape, a number is not finite or exceeds `LARGEST_NUMBER`, the
            normal is not a unit vector, the shape has no corners or rims, the horizon is negative, or an
            integrated motion does not reach the horizon.
    """
    shape = shape_B if isinstance(shape_B, ConvexShape) else _hull(shape_B)
    point = check_magnitude("p_WS_W", check_array("p_WS_W", p_WS_W, (3,)))
    normal = check_unit("normal_W", normal_W, 3)
    if shape.is_empty:
        raise InvalidFieldError("shape_B", "nothing", "a shape or at least one corner, which can arrive")
    until, spent = check_not_negative("horizon", horizon), SearchWork() if work is None else work
    found = [Descent(motion, hull, point, normal).run(until, spent) for hull in shape.hulls]
    return min((each for each in found if each), key=lambda each: each.seconds, default=None)


def _hull(corners: ArrayLike) -> ConvexShape:
    return ConvexShape(vertices=check_magnitude("shape_B", check_array("shape_B", corners, (None, 3))))


class Above(NamedTuple):
    """The heights of a shape's parts above a plane at one time."""

    heights: FloatArray  # (k + m,), m, of corners, then of the lowest points of rims
    rates: FloatArray  # (k + m,), m/s, of these heights
    rims: list[RimAbove]
    centre: float  # m, height of the centre of mass
    centre_rate: float  # m/s, of that height
    sample: Sample  # the motion at that time


class Descent:
    """The heights of a shape's parts above one plane over time, and the search for the first contact."""

    def __init__(self, motion: Motion, shape: ConvexShape, p_WS_W: FloatArray, normal_W: FloatArray) -> None:
        self.motion = motion
        self.shape = shape
        self.rims = [radii_of(rim) for rim in shape.rims]
        self.normal_W: Vector = tuple(normal_W.tolist())
        # m. The plane is raised by the radius of the ball that rolls over the shape.
        self.offset = float(p_WS_W @ normal_W) + shape.rounding
        self.bound_from = bounds_of(motion, normal_W)
        self.arms = np.sqrt(np.einsum("ij,ij->i", shape.vertices, shape.vertices))  # (k,), m
        self.reach = max([float(self.arms.max(initial=0.0)), *(rim.reach for rim in self.rims)])  # m
        self.newest: tuple[float, Above] | None = None  # the last result of `at`, with its time

    def run(self, horizon: float, work: SearchWork) -> FirstContact | None:
        """Return the first contact within a horizon, s, or None."""
        now, before = 0.0, None
        work.spend(SEARCH_BEGUN, now)
        while True:
            work.spend(1, now)
            at = self.at(now)
            down = at.heights <= 0.0
            if down.any():
                crossed = down & (before[1] > 0.0) if before else np.zeros_like(down)
                if before and crossed.any():
                    return self.found(*self.crossing(before[0], now, before[1], at.heights))
                arrived = np.flatnonzero(down & (at.rates <= 0.0))
                if len(arrived):
                    return self.found(now, int(arrived[at.heights[arrived].argmin()]))
            if now >= horizon:
                return None
            bound = self.bound_from(now)
            before = now, at.heights
            now = min(now + self.free_for(at, bound), bound.until, horizon)

    def free_for(self, at: Above, bound: Bound) -> float:
        """Return for how long, s, no part can arrive while a bound holds."""
        corners = len(self.arms)
        pulls = bound.fall + self.arms * bound.turning
        step = all_free_for(at.heights[:corners], at.rates[:corners], pulls)
        for radii, rim in zip(self.rims, at.rims, strict=True):
            step = min(step, rim.free_for(bound.fall + radii.reach * bound.turning))
        if at.centre > self.reach:
            step = max(step, free_for(at.centre - self.reach, at.centre_rate, bound.fall))
        return step

    def at(self, seconds: float) -> Above:
        """Return the shape above the plane at one time. The newest result is remembered."""
        if self.newest is None or self.newest[0] != seconds:
            self.newest = seconds, self._at(seconds)
        return self.newest[1]

    def _at(self, seconds: float) -> Above:
        sample = self.motion.sample(seconds)
        a, b, c = self.normal_W
        x, y, z = sample.w_WB_W
        into_body = conjugate(sample.q_WB)
        normal_B = rotated(into_body, self.normal_W)
        turning_B = rotated(
            into_body, (b * z - c * y, c * x - a * z, a * y - b * x)
        )  # n . (w x r) = r . (n x w)
        centre = _dot(self.normal_W, sample.p_WB_W) - self.offset
        centre_rate = _dot(self.normal_W, sample.v_WB_W)
        heights = self.shape.vertices @ normal_B + centre
        rates = self.shape.vertices @ turning_B + centre_rate
        if not self.rims:
            return Above(heights, rates, [], centre, centre_rate, sample)
        rims = [
            RimAbove(
                centre + _dot(normal_B, rim.center),
                centre_rate + _dot(turning_B, rim.center),
                (_dot(normal_B, rim.first), _dot(normal_B, rim.second)),
                (_dot(turning_B, rim.first), _dot(turning_B, rim.second)),
            )
            for rim in self.rims
        ]
        lowest = np.array([rim.lowest()[:2] for rim in rims])
        return Above(
            np.append(heights, lowest[:, 0]),
            np.append(rates, lowest[:, 1]),
            rims,
            centre,
            centre_rate,
            sample,
        )

    def crossing(self, low: float, high: float, above: FloatArray, below: FloatArray) -> tuple[float, int]:
        """Return the first time between two at which a part comes down to the plane, and its index."""
        waiting = np.flatnonzero((above > 0.0) & (below <= 0.0))
        while True:
            part = int(waiting[below[waiting].argmin()])
            high = self.root(part, low, high)
            below = self.at(high).heights
            waiting = waiting[(below[waiting] < 0.0) & (waiting != part)]
            if len(waiting) == 0:
                return high, part

    def root(self, part: int, low: float, high: float) -> float:
        """Return when a part reaches the plane. It is above the plane at ``low`` and not at ``high``."""
        now = high
        for _ in range(_MAX_ROOT_STEPS):
            at = self.at(now)
            height, rate = float(at.heights[part]), float(at.rates[part])
            low, high = (now, high) if height > 0.0 else (low, now)
            if abs(height) <= -rate * math.ulp(now) or height == 0.0:
                break  # Newton's next step would be within rounding
            following = now - height / rate if rate < 0.0 else low
            if not low < following < high:
                following = 0.5 * (low + high)
            if abs(following - now) <= math.ulp(now):
                break
            now = following
        return now

    def found(self, seconds: float, part: int) -> FirstContact:
        """Return the contact at a time."""
        at = self.at(seconds)
        sample = at.sample
        corners = len(self.arms)
        if part < corners:
            arm_B = self.shape.vertices[part].tolist()
        else:
            rim, (_, _, (cosine, sine)) = self.rims[part - corners], at.rims[part - corners].lowest()
            ends = zip(rim.center, rim.first, rim.second, strict=True)
            arm_B = [middle + (cosine * first + sine * second) for middle, first, second in ends]
        arm = zip(rotated(sample.q_WB, arm_B), self.normal_W, strict=True)
        x, y, z = (along - self.shape.rounding * up for along, up in arm)
        a, b, c = sample.w_WB_W
        others = np.flatnonzero(np.abs(at.heights) <= GRAZING_DEPTH).tolist()
        return FirstContact(
            seconds=seconds,
            vertices=(part, *(i for i in others if i != part)),
            p_WC_W=np.add(sample.p_WB_W, (x, y, z)),
            v_WC_W=np.add(sample.v_WB_W, (b * z - c * y, c * x - a * z, a * y - b * x)),
        )


def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


_MAX_STEPS: Final = 60
"""Largest number of Newton's steps. Four are usual. Towards a nearly double root, each step halves the
distance."""


class RimAbove(NamedTuple):
    """A rim above a plane at one time."""

    height: float  # height of its centre, m
    rate: float  # rate of that height, m/s
    a: tuple[float, float]  # heights of the ends of two orthogonal radii above the centre, m
    b: tuple[float, float]  # rates of these heights, m/s

    def lowest(self) -> tuple[float, float, tuple[float, float]]:
        """Return the lowest point's height, m, its rate, m/s, and its direction (cos, sin).

        If all points have the same height, it is the one that sinks fastest.
        """
        (a_1, a_2), (b_1, b_2) = self.a, self.b
        size = math.hypot(a_1, a_2)
        if size > 0.0:
            u = (-a_1 / size, -a_2 / size)
        else:
            fastest = math.hypot(b_1, b_2)
            u = (-b_1 / fastest, -b_2 / fastest) if fastest > 0.0 else (1.0, 0.0)
        return self.height - size, self.rate + b_1 * u[0] + b_2 * u[1], u

    def free_for(self, pull: float) -> float:
        """Return for how long, s, no point can arrive that accelerates down by at most ``pull``, m/s^2."""
        pull = max(pull, 0.0)
        (a_1, a_2), (b_1, b_2) = self.a, self.b
        low, rate, _ = self.lowest()
        slowest = self.rate - math.hypot(b_1, b_2)
        if low <= 0.0:  # it rises from below the plane: it is free while all points rise, or for a graze
            return max(slowest, math.sqrt(2.0 * GRAZING_DEPTH * pull)) / pull if pull > 0.0 else math.inf
        beyond = _arrival(low + GRAZING_DEPTH, rate, pull)
        if slowest < 0.0:  # the point that sinks fastest is no higher than the rim's top
            top = self.height + math.hypot(a_1, a_2)
            beyond = min(beyond, _arrival(top + GRAZING_DEPTH, slowest, pull))
        if math.isinf(beyond):
            return beyond
        t = beyond
        for _ in range(_MAX_STEPS):
            x, y = a_1 + b_1 * t, a_2 + b_2 * t
            size = math.hypot(x, y)
            value = self.height + GRAZING_DEPTH + t * (self.rate - 0.5 * pull * t) - size
            slope = self.rate - pull * t - ((b_1 * x + b_2 * y) / size if size > 0.0 else 0.0)
            if value >= 0.0 or slope >= 0.0:
                break
            before, t = t, max(t - value / slope, 0.0)
            if before - t <= RIM_ACCURACY * before:
                break
        return t


def _arrival(height: float, rate: float, pull: float) -> float:
    """Return when a point at a height > 0 that is always pulled down arrives at zero, or inf if never."""
    root = math.sqrt(rate * rate + 2.0 * pull * height)
    if rate < 0.0:
        return 2.0 * height / (root - rate)
    return (rate + root) / pull if pull > 0.0 else math.inf
