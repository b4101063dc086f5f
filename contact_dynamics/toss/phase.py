"""The motion of a body in one contact mode, integrated until the mode ends.

The mode says which contacts stick and which slide, and so what the accelerations are (`forces`). They are
integrated in adaptive steps (`phase_step`). The mode ends where a held contact no longer presses, where
friction no longer holds one that sticks, or where another corner comes down. These times are found on the
interpolant. The mode ends where sliding stops, too. Steps towards that end before it, because friction jumps
there, and each of them leaves a tenth of the speed at least.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

import numpy as np

from contact_dynamics.numerics.vectors import dot, norm, without
from contact_dynamics.records import NamedInt
from contact_dynamics.tolerances import (
    BEGUN_TO_SLIDE,
    COARSE_SLIDING_STOPPED,
    COMES_DOWN_FOUND,
    CREEPING_STEP,
    FORCE_END_FOUND,
    GRAZING_DEPTH,
    PHASE_ERROR,
    PHASE_LEAST_STEP,
    RESOLVED_SLIDING,
    SAMPLED_PHASE_ERROR,
    SLIDING_STOPPED,
)
from contact_dynamics.toss.forces import (
    Free,
    Pushed,
    force_rounding,
    free_accelerations,
    least_left,
    pushed_by_contacts,
)
from contact_dynamics.toss.holding import heights_held, held_in_place, out_of_flats
from contact_dynamics.toss.mode_choice import corrected
from contact_dynamics.toss.phase_step import INTERPOLANT, PhaseStep, scales_of, tried, within
from contact_dynamics.toss.solid import (
    Held,
    arm_of,
    heights_and_rates,
    kinetic_energy_of,
    pose_of,
    rows_at,
    sliding_direction,
    velocity_of,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.toss.solid import Flat, Numbers, Pose, Solid, Touch

MAX_PHASE_STEPS: Final = 20_000
"""Steps after which a phase ends unfinished. A tenth of a second of sliding or tipping takes some twenty."""

_MAX_SHORT_STEPS: Final = 60
"""Such steps after which a phase ends. Sliding that stops takes some ten."""

LARGEST_STEP: Final = 0.2
"""s. A step is no longer than this where no other corner comes down."""

SHORT_STEP: Final = 0.02
"""s. A step may be this long where another corner would come down earlier, by its present speed. One that
comes down and leaves again within it is looked for where it is lowest."""

FIRST_STEP: Final = 0.03
"""s. The first step at `SAMPLED_PHASE_ERROR`, shorter for smaller errors as the order of the steps says."""

_TOWARDS_STOP: Final = 0.9


_MAX_ROOT_STEPS: Final = 60

Watched: TypeAlias = "list[tuple[Flat, list[tuple[Vector3, float]]]]"
"""The corners that could come down on each flat, m, body axes, with the depths, m, that they may have."""

Falling: TypeAlias = "tuple[float, float, Touch]"
"""A corner that comes nearer to a flat: its height, m, and its rate, m/s, below 0."""


class PhaseEnd(NamedInt):
    """Why a phase in one contact mode ends."""

    FORCES = 0
    """A held contact no longer presses, or friction no longer holds a contact that sticks."""
    SLIDING_STOPS = 1
    """A contact stops sliding."""
    COMES_DOWN = 2
    """Another corner comes down."""
    SLOW = 3
    """The kinetic energy has fallen to the bound that was asked for."""
    TIME = 4
    """The time that was asked for is over."""
    STEPS = 5
    """The bound on the number of steps was reached."""
    CREEPS = 6
    """Steps have become too short to go on in the mode, since its forces jump."""


class Phase(NamedTuple):
    """The motion in one contact mode.

    Attributes:
        end: Why it ends.
        seconds: s, when it ends.
        y: The state then.
        steps: The steps of the integrator.
    """

    end: PhaseEnd
    seconds: float
    y: Numbers
    steps: list[PhaseStep]


def phase(
    solid: Solid,
    y: Numbers,
    mode: tuple[Held, ...],
    *,
    start: float,
    until: float,
    slow: float = 0.0,
    error: float = PHASE_ERROR,
) -> Phase:
    """Return the motion in a mode, from a state to the end of the mode.

    Args:
        solid: The body and the flats.
        y: The state.
        mode: The contacts that stick and slide.
        start: s, the time of the state.
        until: s, the time at which to end at the latest.
        slow: J, > 0. The phase ends where the kinetic energy falls below it. If it is 0, it never does.
        error: m, m/s, and radians times the body's reach: the error that a step may have.
    """
    held = {one.touch for one in mode}
    scales = scales_of(solid)
    y = out_of_flats(solid, y)
    heights = heights_held(solid, y, mode)
    y = held_in_place(solid, y, mode, heights)
    now, step, steps = start, FIRST_STEP * (error / SAMPLED_PHASE_ERROR) ** 0.2, list[PhaseStep]()
    pushed = pushed_by_contacts(solid, y, mode)
    low = _low_corners(solid, y, held)
    watched = _watched_corners(solid, held, low)
    resolved = max(SLIDING_STOPPED, min(RESOLVED_SLIDING * error, COARSE_SLIDING_STOPPED))
    before_stop, _ = _sliding(solid, y, pushed, mode, resolved=resolved)
    fast, short = kinetic_energy_of(solid, y) > slow, 0
    for _ in range(MAX_PHASE_STEPS):
        falling = [each for each in heights_and_rates(solid, y) if each[1] < 0.0 and each[2] not in held]
        step = min(step, _before_arrival(falling), until - now, before_stop)
        trial, size, stages, after = tried(solid, y, pushed, mode, span=step, scales=scales, error=error)
        short += step < CREEPING_STEP
        if short > _MAX_SHORT_STEPS:
            return Phase(PhaseEnd.CREEPS, now, y, steps)
        if size > 1.0 and step > PHASE_LEAST_STEP:
            step *= max(0.2, 0.9 * size**-0.2)
            continue
        done = PhaseStep(solid, now, step, np.array(y), stages.T @ INTERPOLANT, step)
        found = _first_end(solid, done, mode, after=after, trial=trial, watched=watched, falling=falling)
        if found is not None:
            reason, x = found
            span = x * step
            steps.append(done._replace(span=span))
            y = held_in_place(solid, within(done, x).tolist(), mode, heights)
            return Phase(reason, now + span, y, steps)
        steps.append(done)
        now += step
        y = held_in_place(solid, trial, mode, heights)
        turned = _turned(solid, y, mode)
        pushed = after if turned == mode else pushed_by_contacts(solid, y, turned)
        mode = turned
        left = before_stop
        before_stop, stopped = _sliding(solid, y, pushed, mode, resolved=resolved)
        if stopped:
            still = tuple(one._replace(slides=one.slides and one.touch not in stopped) for one in mode)
            return Phase(PhaseEnd.SLIDING_STOPS, now, held_in_place(solid, y, still, heights), steps)
        if now >= until:
            return Phase(PhaseEnd.TIME, now, y, steps)
        energy = kinetic_energy_of(solid, y)
        if fast and energy <= slow:
            return Phase(PhaseEnd.SLOW, now, y, steps)
        fast = fast or energy > slow
        if low:
            still_low = _low_corners(solid, y, held)
            low = {touch: height for touch, height in low.items() if touch in still_low}
            watched = _watched_corners(solid, held, low)
        step *= min(5.0, 0.9 * size**-0.2) if size > 0.0 else 5.0
        # Towards a stop the motion is alike at all speeds, and so are steps relative to what is left.
        step *= min(1.0, before_stop / left) if left < math.inf else 1.0
    return Phase(PhaseEnd.STEPS, now, y, steps)


def _before_arrival(falling: list[Falling]) -> float:
    """Return a step, s, in which hardly another corner comes down and leaves again."""
    return min([LARGEST_STEP, *(max(-height / rate, SHORT_STEP) for height, rate, _ in falling)])


def _sliding(
    solid: Solid, y: Numbers, pushed: Pushed, mode: tuple[Held, ...], *, resolved: float
) -> tuple[float, set[Touch]]:
    """Return the longest step, s, before which no contact stops sliding, and those that have stopped.

    Below the speed that is ``resolved``, m/s, the direction of a contact that stops turns by more in a step
    than the error of the step allows to follow. There it would slide on and on, in steps of a microsecond,
    so it has stopped if friction holds it then.
    """
    longest, stopped = math.inf, set()
    pose = pose_of(solid, y)
    for one in mode:
        if one.slides and not one.begins and solid.flats[one.touch[0]].friction > 0.0:
            speed, rate = _speed_and_rate(solid, pose, pushed, one)
            if rate < 0.0:
                longest = min(longest, _TOWARDS_STOP * speed / -rate)
                if speed <= SLIDING_STOPPED or (speed <= resolved and _friction_holds(solid, y, mode, one)):
                    stopped.add(one.touch)
    return max(longest, PHASE_LEAST_STEP), stopped


def _friction_holds(solid: Solid, y: Numbers, mode: tuple[Held, ...], one: Held) -> bool:
    """Tell whether friction holds a contact of the mode, if it sticks and the others do as the mode says."""
    still = tuple(Held(each.touch) if each == one else each for each in mode)
    force = pushed_by_contacts(solid, y, still).forces[mode.index(one)]
    flat = solid.flats[one.touch[0]]
    return norm(without(force, flat.normal)) <= flat.friction * dot(force, flat.normal)


def _turned(solid: Solid, y: Numbers, mode: tuple[Held, ...]) -> tuple[Held, ...]:
    """Return the mode with the directions in which contacts that have just begun to slide slide by now."""
    if not any(one.begins for one in mode):
        return mode
    free = free_accelerations(solid, y)
    found, _ = corrected(solid, y, tuple(Held(one.touch) if one.begins else one for one in mode), free)
    new = {} if found is None else {one.touch: one for one in found}
    turned = []
    for one in mode:
        kept = one
        if one.begins:
            velocity = velocity_of(free.pose, arm_of(solid, free.pose, one.touch))
            other = new.get(one.touch, one)
            slow = norm(velocity) < BEGUN_TO_SLIDE
            kept = other if slow and other.slides else one._replace(begins=False)
        turned.append(kept)
    return tuple(turned)


def _speed_and_rate(solid: Solid, pose: Pose, pushed: Pushed, one: Held) -> tuple[float, float]:
    """Return the sliding speed of a contact, m/s, and its rate, m/s^2."""
    arm, n = arm_of(solid, pose, one.touch), solid.flats[one.touch[0]].normal
    velocity = velocity_of(pose, arm)
    d = sliding_direction(velocity, n, one.towards)
    rates = pushed.rates
    moved = Free(pose, (rates[7], rates[8], rates[9]), (rates[10], rates[11], rates[12]))
    return dot(velocity, d), dot(moved.at(solid, one.touch, arm), d)


def _low_corners(solid: Solid, y: Numbers, held: set[Touch]) -> dict[Touch, float]:
    """Return the corners that are on a flat or below and not held, with the depths, m, that they may have."""
    listed = heights_and_rates(solid, y)
    return {
        touch: 0.5 * GRAZING_DEPTH - min(height, 0.0)
        for height, _, touch in listed
        if height <= 0.5 * GRAZING_DEPTH and touch not in held
    }


def _watched_corners(solid: Solid, held: set[Touch], low: dict[Touch, float]) -> Watched:
    """Return the corners that could come down: those that are not held."""
    return [
        (
            flat,
            [(corner, low.get((s, k), 0.0)) for k, corner in enumerate(solid.corners) if (s, k) not in held],
        )
        for s, flat in enumerate(solid.flats)
    ]


def _least_height(solid: Solid, y: Numbers, watched: Watched) -> float:
    """Return the least height, m, of a watched corner above a flat, plus the depth that it may have."""
    (a, b, c), (d, e, f), (g, h, i) = rows_at(y)
    least = math.inf
    for flat, corners in watched:
        n_x, n_y, n_z = flat.normal
        u, v, w = a * n_x + d * n_y + g * n_z, b * n_x + e * n_y + h * n_z, c * n_x + f * n_y + i * n_z
        height = y[0] * n_x + y[1] * n_y + y[2] * n_z - flat.level - solid.rounding
        for (j, k, m), depth in corners:
            least = min(least, height + u * j + v * k + w * m + depth)
    return least


def _first_end(
    solid: Solid,
    step: PhaseStep,
    mode: tuple[Held, ...],
    *,
    after: Pushed,
    trial: Numbers,
    watched: Watched,
    falling: list[Falling],
) -> tuple[PhaseEnd, float] | None:
    """Return why and where, as a share of the step, the mode ends within a step, or None.

    Corners that come down are those below a flat at the end of the step, and those of ``falling``, with their
    heights and rates at its beginning, that are below one in between.
    """

    def height_at(x: float) -> float:
        return _least_height(solid, within(step, x).tolist(), watched)

    def force_at(x: float) -> float:
        pushed = pushed_by_contacts(solid, within(step, x).tolist(), mode)
        return least_left(solid, mode, pushed.forces)

    first: tuple[PhaseEnd, float] | None = None
    dips = [x for x in _lowest(solid, trial, falling, step.whole) if height_at(x) < 0.0]
    if dips or _least_height(solid, trial, watched) < 0.0:
        x = min(dips, default=1.0)
        first = PhaseEnd.COMES_DOWN, _crossing(height_at, x, step.whole, COMES_DOWN_FOUND)
    if least_left(solid, mode, after.forces) < 0.0:
        x = 1.0 if first is None else first[1]
        if first is None or force_at(x) < 0.0:
            first = (
                PhaseEnd.FORCES,
                _crossing(force_at, x, step.whole, FORCE_END_FOUND * force_rounding(solid)),
            )
    return first


def _lowest(solid: Solid, trial: Numbers, falling: list[Falling], span: float) -> list[float]:
    """Return where corners that fall at first and rise at the end are lowest, as shares of a step, s.

    Heights and rates at both ends make a cubic. Corners that by their first rate stay above their flat are
    left out.
    """
    falling = [each for each in falling if each[0] + each[1] * span < 0.0]
    if not falling:
        return []
    ends = {touch: (height, rate) for height, rate, touch in heights_and_rates(solid, trial)}
    found = []
    for height, rate, touch in falling:
        last, rise = ends[touch]
        if rise > 0.0:
            change, first, end = last - height, rate * span, rise * span
            # The derivative is a x^2 + b x + first, which is below zero at 0 and above at 1.
            a, b = 3.0 * (first + end - 2.0 * change), 2.0 * (3.0 * change - 2.0 * first - end)
            found.append(2.0 * -first / (b + math.sqrt(max(b * b - 4.0 * a * first, 0.0))))
    return found


def _crossing(value: Callable[[float], float], bad: float, span: float, enough: float) -> float:
    """Return where in [0, ``bad``], as a share of a step, a value becomes negative: just after that.

    Just after is where the value is between -``enough`` and 0, or a time of `PHASE_LEAST_STEP` later at most.
    The root is that of the value plus half of ``enough``. It is found by inverse quadratic interpolation
    where that is safe, and by halves otherwise (Chandrupatla 1997).
    """
    half = 0.5 * enough
    a, f_a = bad, value(bad) + half
    if f_a > -half:  # it is there already, or the interpolant is off by rounding
        return bad
    b, f_b = 0.0, max(value(0.0), 0.0) + half
    share = 0.5
    for _ in range(_MAX_ROOT_STEPS):
        x = a + share * (b - a)
        f_x = value(x) + half
        if abs(f_x) < half:
            return x
        if (f_x > 0.0) == (f_a > 0.0):
            c, f_c = a, f_a
        else:
            c, f_c, b, f_b = b, f_b, a, f_a
        a, f_a = x, f_x
        least = PHASE_LEAST_STEP / (abs(b - a) * span)
        if least >= 1.0:
            break
        place, height = (a - b) / (c - b), (f_a - f_b) / (f_c - f_b)
        share = 0.5
        if height * height < place and (1.0 - height) ** 2 < 1.0 - place:
            share = f_a / (f_b - f_a) * f_c / (f_b - f_c)
            share += (c - a) / (b - a) * f_a / (f_c - f_a) * f_b / (f_c - f_b)
        share = min(max(share, 0.5 * least), 1.0 - 0.5 * least)
    return a if f_a < 0.0 else b
