"""This file follows many contacts' impulse paths at once, as `path`, `stop` and `restitution` do for one.

Each contact is a lane. All lanes that still slide take their next stretch together. Lanes drop out when they
have stopped or their impact is over. Within a stretch, branches become selections of lanes. The arithmetic is
that of the single path in the same order, partly by the same lines (`taylor`, `sliding_law`, `stop`). So
every number is the same to the last bit. Vertices of the paths are not kept.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.impact.law import ImpactOutcome, RestitutionLaw
from contact_dynamics.impact.spatial.batch_restitution import ManyProgress, crossings, taken
from contact_dynamics.impact.spatial.path import MAX_STRETCHES, at_stop, slide
from contact_dynamics.impact.spatial.sliding_law import ESCAPE_ROUNDS, SlidingLaw
from contact_dynamics.impact.spatial.stop import (
    FARTHEST,
    ROUNDS,
    TERMS,
    Stop,
    expansions,
    next_coefficient,
    slow_stop,
    turns_slowly,
)
from contact_dynamics.impact.spatial.taylor import SlidingSeries, value
from contact_dynamics.tolerances import AT_THE_STOP, ESCAPE_ARRIVED, LAST_TERM, STOPPED

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from contact_dynamics.validation import FloatArray

    Lanes = NDArray[np.intp]

FEW: Final = 32
"""When no more lanes than this are left, each is followed as a single path, because calling NumPy for so few
costs more than it saves."""


class SpatialPaths(NamedTuple):
    """Many impulse paths, in contact axes. Element i of each array belongs to contact i.

    Attributes:
        outcomes: Values of ImpactOutcome.
        compression: N s, impulses at the end of compression.
        impulse: N s, total impulses.
        u: m/s, sliding velocities afterwards.
        v_n: m/s, normal velocities afterwards.
    """

    outcomes: NDArray[np.int64]
    compression: tuple[FloatArray, FloatArray, FloatArray]
    impulse: tuple[FloatArray, FloatArray, FloatArray]
    u: tuple[FloatArray, FloatArray]
    v_n: FloatArray


def trace_all(
    sliding: SlidingLaw,
    u: tuple[FloatArray, FloatArray],
    v_n: FloatArray,
    *,
    restitution: FloatArray,
    law: RestitutionLaw,
) -> SpatialPaths:
    """Return the paths of contacts that start with ``u``, tangential, and ``v_n`` <= 0, normal, m/s.

    The results are those of `path.trace` for each.
    """
    speed = np.sqrt(u[0] * u[0] + u[1] * u[1])
    slides = speed > 0.0
    jams = slides & (sliding.lifting(u[0] / speed, u[1] / speed) < 0.0)
    strikes = (v_n < 0.0) | jams
    progress = ManyProgress(law, restitution, v_n)
    slide = _Slide(sliding, u, progress)
    slide.run(np.flatnonzero(slides & strikes))

    stopped = np.flatnonzero(strikes & ~progress.over)
    in_compression = progress.compressing.copy()
    stopped_law = taken_law(sliding, stopped)
    i1, i2, lifting, speeding = _after_stop(stopped_law)
    gone = progress.go_straight(stopped, np.full(len(stopped), math.inf), (i1, i2), lifting)
    held = speeding == 0.0
    slide.u1[stopped] = np.where(held, 0.0, (stopped_law.k1 + stopped_law.l1 * i1) * gone)
    slide.u2[stopped] = np.where(held, 0.0, (stopped_law.k2 + stopped_law.l2 * i2) * gone)

    outcomes = np.full(len(speed), ImpactOutcome.SLIDES, dtype=np.int64)
    outcomes[stopped] = np.where(
        in_compression[stopped],
        np.where(held, ImpactOutcome.STICKS_IN_COMPRESSION, ImpactOutcome.REVERSES_IN_COMPRESSION),
        np.where(held, ImpactOutcome.STICKS_IN_RESTITUTION, ImpactOutcome.REVERSES_IN_RESTITUTION),
    )
    rested = ~slides[stopped]
    outcomes[stopped[rested & held]] = ImpactOutcome.STICKS_THROUGHOUT
    outcomes[stopped[rested & ~held]] = ImpactOutcome.SLIDES
    outcomes[~strikes] = ImpactOutcome.NO_IMPULSE
    return SpatialPaths(outcomes, progress.compression, progress.impulse, (slide.u1, slide.u2), progress.v_n)


def taken_law(sliding: SlidingLaw, lanes: Lanes) -> SlidingLaw:
    """Return the law of some lanes."""
    return SlidingLaw(*taken(sliding, lanes))


class _Slide:
    """Many contacts that slide. This is the loop of `path.slide` for many."""

    def __init__(self, sliding: SlidingLaw, u: tuple[FloatArray, FloatArray], progress: ManyProgress) -> None:
        self.sliding = sliding
        self.u1, self.u2 = u[0].copy(), u[1].copy()
        self.progress = progress
        self.with_work = progress.rule.needs_work

    def run(self, lanes: Lanes) -> None:
        """Follow ``lanes`` until each stops, with u = 0, or its impact is over."""
        self.first_speed = np.sqrt(self.u1 * self.u1 + self.u2 * self.u2)
        self.ends_before = np.full(len(self.u1), -1)
        slowest = STOPPED * self.first_speed
        whole = self.sliding
        for stretch in range(MAX_STRETCHES):
            if lanes.size <= FEW:
                for lane in lanes.tolist():
                    self._alone(lane, started=stretch > 0)
                return
            law, u1, u2 = taken_law(whole, lanes), self.u1[lanes], self.u2[lanes]
            speed = np.sqrt(u1 * u1 + u2 * u2)
            d1, d2 = u1 / speed, u2 / speed
            speeding, lifting = law.speeding(d1, d2), law.lifting(d1, d2)
            kept = law.keeps(d1, d2, started=stretch > 0)
            on = np.flatnonzero(kept)
            self._straight(lanes[on], taken_law(law, on).settled(d1[on], d2[on]), speed[on])
            slow = ~kept & (speeding < 0.0) & (speed <= slowest[lanes])
            on = np.flatnonzero(slow)
            self._straight(lanes[on], (d1[on], d2[on]), speed[on])
            straight = kept | slow
            smooth = ~straight & (law.mu == 0.0)
            self._without_friction(lanes[smooth])
            goes_on = ~(straight | smooth)
            open_ended = self.progress.compressing[lanes] != self.ends_before[lanes]
            slowing = np.flatnonzero(goes_on & (speeding < 0.0) & open_ended)
            goes_on[slowing[self._jump(lanes[slowing], lifting[slowing])]] = False
            swerving = np.flatnonzero(goes_on)
            lanes = lanes[swerving]
            self._stretch(lanes, lifting[swerving])
            lanes = lanes[~self.progress.over[lanes]]
        raise AssertionError  # each stretch turns or slows the sliding by a fixed part

    def _without_friction(self, lanes: Lanes) -> None:
        """Take lanes to their ends whose sliding changes along a line."""
        law, none = taken_law(self.sliding, lanes), np.zeros(len(lanes))
        p = self.progress.go_straight(lanes, np.full(len(lanes), math.inf), (none, none), law.kn)
        self.u1[lanes] += law.k1 * p
        self.u2[lanes] += law.k2 * p

    def _alone(self, lane: int, *, started: bool) -> None:
        """Follow one lane to its end."""
        u = (float(self.u1[lane]), float(self.u2[lane]))
        with self.progress.alone(lane) as progress:
            self.u1[lane], self.u2[lane] = slide(
                SlidingLaw(*(float(x[lane]) for x in self.sliding)),
                u,
                progress,
                first_speed=float(self.first_speed[lane]),
                started=started,
                ends_before=None if self.ends_before[lane] < 0 else bool(self.ends_before[lane]),
            )

    def _straight(self, lanes: Lanes, d: tuple[FloatArray, FloatArray], speed: FloatArray) -> None:
        """Take lanes straight on, at most to the stop."""
        law = taken_law(self.sliding, lanes)
        mu, speeding, lifting = law.mu, law.speeding(*d), law.lifting(*d)
        length = np.where(speeding < 0.0, speed / -speeding, math.inf)
        gone = self.progress.go_straight(lanes, length, (-mu * d[0], -mu * d[1]), lifting)
        final = np.where(self.progress.over[lanes], speed + speeding * gone, 0.0)
        self.u1[lanes], self.u2[lanes] = d[0] * final, d[1] * final

    def _jump(self, lanes: Lanes, lifting: FloatArray) -> Lanes:
        """Take lanes to the stop ahead if nothing ends before it. Return the positions that have jumped."""
        law = taken_law(self.sliding, lanes)
        found, stop = _stops_ahead(
            law, (self.u1[lanes], self.u2[lanes]), self.first_speed[lanes], with_work=self.with_work
        )
        law, at = taken_law(law, found), lanes[found]
        same_sign = (lifting[found] < 0.0) == (law.lifting(stop.d1, stop.d2) < 0.0)
        impulse, v_n, work = at_stop(law, (self.u1[at], self.u2[at]), self.progress.v_n[at], stop)
        reaches = self.progress.reaches(at, impulse[2], v_n, work)
        beyond = at[same_sign & ~reaches]
        self.ends_before[beyond] = self.progress.compressing[beyond]
        jumps = same_sign & reaches
        self.progress.jump(at[jumps], taken(impulse, jumps), v_n[jumps], work[jumps])
        self.u1[at[jumps]] = self.u2[at[jumps]] = 0.0
        jumped: Lanes = found[jumps]
        return jumped

    def _stretch(self, lanes: Lanes, lifting: FloatArray) -> None:
        """Advance each lane along one stretch, in two parts if v_n turns from falling to rising or back."""
        if lanes.size == 0:
            return
        series = SlidingSeries(
            taken_law(self.sliding, lanes),
            (self.u1[lanes], self.u2[lanes]),
            self.progress.v_n[lanes],
            with_work=self.with_work,
        )
        end = series.length
        s = np.zeros(len(lanes))
        turns = np.flatnonzero((value(series.lifting, end) < 0.0) != (lifting < 0.0))
        if turns.size > 0:
            turn = np.zeros(len(lanes))
            turn[turns] = crossings(taken(series.lifting, turns), np.zeros(len(turns)), s[turns], end[turns])
            s = self.progress.go_curved(lanes, series, s, turn, among=turns)
        s = self.progress.go_curved(lanes, series, s, end)
        self.u1[lanes], self.u2[lanes] = value(series.u1, s), value(series.u2, s)


def _after_stop(sliding: SlidingLaw) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return `SlidingLaw.after_stop` for many stopped contacts."""
    i1, i2, lifting = sliding.while_held()
    speeding = np.zeros(len(sliding.mu))
    free = np.flatnonzero(~sliding.holds)
    law = taken_law(sliding, free)
    g = law.least_escape()
    moving = np.ones(len(free), dtype=bool)
    for _ in range(ESCAPE_ROUNDS):
        if not moving.any():
            break
        step = law.escape_step(g)[2]
        g = np.where(moving, g + step, g)
        moving &= ~(step <= ESCAPE_ARRIVED * g)
    d1, d2, _ = law.escape_step(g)
    length = np.sqrt(d1 * d1 + d2 * d2)
    d1, d2 = d1 / length, d2 / length
    i1[free], i2[free] = -law.mu * d1, -law.mu * d2
    lifting[free], speeding[free] = law.lifting(d1, d2), g
    return i1, i2, lifting, speeding


def _stops_ahead(
    sliding: SlidingLaw, u: tuple[FloatArray, FloatArray], first_speed: FloatArray, *, with_work: bool
) -> tuple[Lanes, Stop]:
    """Return the positions that have a stop ahead, and those stops, as `stop.stop_ahead` for one."""
    speed = np.sqrt(u[0] * u[0] + u[1] * u[1])
    d1, d2 = u[0] / speed, u[1] / speed
    slow = np.flatnonzero(turns_slowly(sliding, d1, d2, speed, first_speed))
    stop, last = slow_stop(taken_law(sliding, slow), d1[slow], d2[slow], speed[slow], with_work=with_work)
    accurate = last * speed[slow] <= LAST_TERM * np.maximum(first_speed[slow], speed[slow])
    first, first_stop = slow[accurate], taken(stop, accurate)
    other = np.ones(len(speed), dtype=bool)
    other[first] = False
    rest = np.flatnonzero(other)
    found, stop = _near_stops(taken_law(sliding, rest), (u[0][rest], u[1][rest]), with_work=with_work)
    both = [np.concatenate(pair) for pair in zip(first_stop, stop, strict=True)]
    return np.concatenate((first, rest[found])), Stop(*both)


def _near_stops(
    sliding: SlidingLaw, u: tuple[FloatArray, FloatArray], *, with_work: bool
) -> tuple[Lanes, Stop]:
    """Return the positions whose direction at the stop is near, and those stops."""
    speed = np.sqrt(u[0] * u[0] + u[1] * u[1])
    d1, d2 = u[0] / speed, u[1] / speed
    angle = np.array(list(map(math.atan2, u[1].tolist(), u[0].tolist())))
    fixed = angle.copy()
    near = np.ones(len(speed), dtype=bool)
    lanes = np.arange(len(speed))
    for _ in range(ROUNDS):
        law = taken_law(sliding, lanes)
        attraction = law.attraction(d1[lanes], d2[lanes])
        step = law.turning(d1[lanes], d2[lanes]) / attraction
        turned = fixed[lanes] - step
        good = (attraction < 0.0) & ~(abs(turned - angle[lanes]) > FARTHEST)
        near[lanes[~good]] = False
        lanes, step, turned = lanes[good], step[good], turned[good]
        fixed[lanes] = turned
        d1[lanes], d2[lanes] = list(map(math.cos, turned.tolist())), list(map(math.sin, turned.tolist()))
        lanes = lanes[~(abs(step) < AT_THE_STOP)]
        if lanes.size == 0:
            break
    near &= ~((sliding.speeding(d1, d2) >= 0.0) | (sliding.attraction(d1, d2) >= 0.0))
    lanes = np.flatnonzero(near)
    law, d1, d2 = taken_law(sliding, lanes), d1[lanes], d2[lanes]
    g, h = expansions(law, d1, d2, TERMS)
    x = (angle - fixed)[lanes]
    converged, left = _regular_solutions(g, h, x, 1.0)
    dissipation = np.full(len(lanes), math.nan)
    if with_work:
        both, dissipation = _regular_solutions(g, h, x, 2.0)
        converged &= both
    at = np.flatnonzero(converged)
    speed = speed[lanes]
    stop = Stop(speed * left, law.mu * speed * speed * dissipation, d1, d2)
    return lanes[at], Stop(*taken(stop, at))


def _regular_solutions(
    g: list[FloatArray], h: list[FloatArray], x: FloatArray, power: float
) -> tuple[NDArray[np.bool_], FloatArray]:
    """Return where the series has converged, and F(x) there, as `stop._regular_solution` for one."""
    f = [-1.0 / (power * g[0])]
    slope: list[FloatArray] = []
    total, x_n = f[0].copy(), np.ones(len(x))
    result, converged = np.full(len(x), math.nan), np.zeros(len(x), dtype=bool)
    last = np.zeros(len(x))
    for m in range(1, TERMS + 1):
        if converged.all():
            break
        f.append(next_coefficient(g, h, f, slope, power=power))
        slope.append(m * f[m])
        x_n = x_n * x
        term = f[m] * x_n
        total = total + term
        if m >= 2:
            done = (abs(term) + abs(last) <= LAST_TERM * abs(total)) & ~converged
            result[done] = total[done]
            converged |= done
        last = term
    return converged, result
