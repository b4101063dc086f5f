"""The first time at which a moving body's corners reach a plane: where the flight of lecture 25 ends.

The height of a corner has a second derivative that is bounded along the motion (`motion_bounds`): for all
time without torque, and for each step of the integrator under forces. A height and its rate thus give a time
before which the corner cannot arrive. The search goes there, and on from there; nothing is stepped over,
however short, but dips of less than `GRAZING_DEPTH`, and the crossing is then found to rounding. Under forces
this holds for the motion as it is integrated: to some 1e-12 of its lengths, see `forced_motion`.

Not covered: edges of the plane, curved surfaces, several bodies.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.motion_bounds import Bound, bounds_of
from contact_dynamics.tolerances import GRAZING_DEPTH
from contact_dynamics.tumbling.quaternions import conjugate, rotated
from contact_dynamics.validation import FloatArray, check_array, check_not_negative, check_unit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from contact_dynamics.motion_bounds import Motion
    from contact_dynamics.tumbling.quaternions import Vector

_MOST_ROOT_STEPS: Final = 100
"""Bisection alone needs 60 for the last bit; Newton's steps need four."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FirstContact:
    """A corner's arrival at a plane."""

    seconds: float  # s after the state's stamp, >= 0
    vertices: tuple[
        int, ...
    ]  # the corner that arrives, then those within `GRAZING_DEPTH` of the plane as well
    p_WC_W: FloatArray  # (3,), m, the corner that arrives, world
    v_WC_W: FloatArray  # (3,), m/s, its velocity, world axes


def first_contact(
    motion: Motion, vertices_B: ArrayLike, p_WS_W: ArrayLike, normal_W: ArrayLike, *, horizon: float
) -> FirstContact | None:
    """Return the first time in [0, horizon] at which a corner is on or below a plane and not rising, or None.

    A corner above the plane arrives so when it comes down to it. One on or below the plane at time 0 arrives
    at once if it sinks or rests; if it rises, when it comes down again.

    Args:
        motion: the flight, in closed form or integrated (`motion_of`).
        vertices_B: (k, 3), m, corners in body axes, from the centre of mass; none never arrive.
        p_WS_W: (3,), m, a point of the plane, world.
        normal_W: (3,), unit normal into the free side, world axes.
        horizon: s after the state's stamp, how far to search.

    Raises:
        InvalidFieldError: an array of another shape, a number that is not finite, a normal that is not unit,
            or horizon < 0; an integrated motion that does not get as far as the search has to go.
    """
    search = _Search(
        motion,
        check_array("vertices", vertices_B, (None, 3)),
        check_array("plane_point", p_WS_W, (3,)),
        check_unit("plane_normal", normal_W, 3),
    )
    until = check_not_negative("horizon", horizon)
    return search.run(until) if len(search.vertices_B) else None


class _Search:
    """Heights of all corners above one plane, and the way down through time."""

    def __init__(
        self, motion: Motion, vertices_B: FloatArray, p_WS_W: FloatArray, normal_W: FloatArray
    ) -> None:
        self.motion = motion
        self.vertices_B = vertices_B  # (k, 3), m
        self.normal_W: Vector = tuple(normal_W.tolist())
        self.offset = float(p_WS_W @ normal_W)  # m
        self.bound_from = bounds_of(motion, normal_W)
        self.arms = np.sqrt(np.einsum("ij,ij->i", vertices_B, vertices_B))  # (k,), m
        self.reach = float(self.arms.max(initial=0.0))  # m

    def run(self, horizon: float) -> FirstContact | None:
        now, before = 0.0, None
        while True:
            heights, rates, centre, centre_rate = self.at(now)
            down = heights <= 0.0
            if down.any():
                crossed = down & (before[1] > 0.0) if before else np.zeros_like(down)
                if before and crossed.any():
                    return self.found(*self.crossing(before[0], now, before[1], heights))
                arrived = np.flatnonzero(down & (rates <= 0.0))
                if len(arrived):
                    return self.found(now, int(arrived[heights[arrived].argmin()]))
            if now >= horizon:
                return None
            bound = self.bound_from(now)
            step = self.free_for(heights, rates, centre, centre_rate, bound)
            before = now, heights
            now = min(now + step, bound.until, horizon)

    def free_for(
        self, heights: FloatArray, rates: FloatArray, centre: float, centre_rate: float, bound: Bound
    ) -> float:
        """Return for how long, s, no corner can arrive while a bound holds."""
        step = float(_free_for(heights, rates, bound.fall + self.arms * bound.turning).min())
        if centre > self.reach:
            alone = np.array([[centre - self.reach], [centre_rate], [bound.fall]])
            step = max(step, float(_free_for(*alone)[0]))
        return step

    def at(self, seconds: float) -> tuple[FloatArray, FloatArray, float, float]:
        """Return the corners' heights (k,), m, and their rates (k,), m/s, and those of the centre of mass."""
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
        return (
            self.vertices_B @ normal_B + centre,
            self.vertices_B @ turning_B + centre_rate,
            centre,
            centre_rate,
        )

    def crossing(self, low: float, high: float, above: FloatArray, below: FloatArray) -> tuple[float, int]:
        """Return the first time between two at which a corner reaches the plane from above, and which."""
        waiting = np.flatnonzero((above > 0.0) & (below <= 0.0))
        while True:
            corner = int(waiting[below[waiting].argmin()])
            high = self.root(corner, low, high)
            below = self.at(high)[0]
            waiting = waiting[(below[waiting] < 0.0) & (waiting != corner)]
            if len(waiting) == 0:
                return high, corner

    def root(self, corner: int, low: float, high: float) -> float:
        """Return the time at which a corner reaches the plane: above it at ``low`` and not at ``high``."""
        now = high
        for _ in range(_MOST_ROOT_STEPS):
            heights, rates, _, _ = self.at(now)
            height, rate = float(heights[corner]), float(rates[corner])
            low, high = (now, high) if height > 0.0 else (low, now)
            following = now - height / rate if rate < 0.0 else low
            if not low < following < high:
                following = 0.5 * (low + high)
            if height == 0.0 or abs(following - now) <= math.ulp(now):
                break
            now = following
        return now

    def found(self, seconds: float, corner: int) -> FirstContact:
        """Gather the evidence of a contact."""
        heights = self.at(seconds)[0]
        sample = self.motion.sample(seconds)
        arm_W = rotated(sample.q_WB, self.vertices_B[corner].tolist())
        others = np.flatnonzero(np.abs(heights) <= GRAZING_DEPTH).tolist()
        return FirstContact(
            seconds=seconds,
            vertices=(corner, *(i for i in others if i != corner)),
            p_WC_W=np.add(sample.p_WB_W, arm_W),
            v_WC_W=np.add(sample.v_WB_W, np.cross(sample.w_WB_W, arm_W)),
        )


def _free_for(heights: FloatArray, rates: FloatArray, pulls: FloatArray) -> FloatArray:
    """Return for how long, (k,), s, corners pulled down at most so hard cannot arrive, but for a graze."""
    with np.errstate(divide="ignore", invalid="ignore"):  # where nothing pulls, or nothing falls
        allowed = heights + GRAZING_DEPTH
        stop = rates * rates + 2.0 * pulls * allowed
        root = np.sqrt(np.maximum(stop, 0.0))
        falling = np.where(stop >= 0.0, 2.0 * allowed / (root - rates), np.inf)
        rising = np.where(pulls > 0.0, (rates + root) / pulls, np.inf)
        # Below the plane and rising: as long as it rises, and not less than a graze takes.
        below = np.where(pulls > 0.0, np.maximum(rates, np.sqrt(2.0 * GRAZING_DEPTH * pulls)) / pulls, np.inf)
    free: FloatArray = np.where(heights > 0.0, np.where(rates < 0.0, falling, rising), below)
    return free


def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
