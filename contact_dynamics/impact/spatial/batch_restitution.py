"""How far many impacts have come while their normal impulses grow, as `restitution` does for one.

The operations are those of one impact in the same order, and branches are selections of lanes. So every
number is the same to the last bit.
"""

from __future__ import annotations

import math
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

from contact_dynamics.impact.law import RULES, RestitutionLaw
from contact_dynamics.impact.spatial.restitution import Progress
from contact_dynamics.impact.spatial.taylor import MAX_ITERATIONS, value, value_and_slope
from contact_dynamics.tolerances import EVENT_LOCATED

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from numpy.typing import NDArray

    from contact_dynamics.impact.spatial.taylor import SlidingSeries
    from contact_dynamics.validation import FloatArray

    Lanes = NDArray[np.intp]
    Mask = NDArray[np.bool_]


class ManyProgress:
    """The states of many impacts on their way. Element i of each array belongs to lane i."""

    def __init__(self, law: RestitutionLaw, restitution: FloatArray, v_n: FloatArray) -> None:
        count = len(v_n)
        self.rule = RULES[law]
        self.v_n = v_n.copy()  # m/s
        self.impulse = (np.zeros(count), np.zeros(count), np.zeros(count))  # N s
        self.compression = (np.zeros(count), np.zeros(count), np.zeros(count))
        self.compressing = np.ones(count, dtype=bool)
        self.over = np.zeros(count, dtype=bool)
        self._final_velocity = self.rule.final(restitution, v_n)
        self._share = self.rule.share(restitution, v_n)
        self._due = np.zeros(count)  # N s or J

    def go_straight(
        self, at: Lanes, length: FloatArray, rates: tuple[FloatArray, FloatArray], lifting: FloatArray
    ) -> FloatArray:
        """Advance lanes ``at`` by at most ``length`` of normal impulse at constant rates.

        Returns:
            The normal impulse gone, N s. It is less than ``length`` where the impact was over before.
        """
        gone = np.zeros(len(at))
        live = np.arange(len(at))
        while live.size > 0:
            lanes, rise = at[live], lifting[live]
            rest = length[live] - gone[live]
            v_n, compressing = self.v_n[lanes], self.compressing[lanes]
            turn = np.where(
                compressing,
                np.where(rise > 0.0, -v_n / rise, math.inf),
                np.where(rise < 0.0, v_n / -rise, math.inf),
            )
            end = np.where(compressing, math.inf, self._distance_to_end(lanes, rise))
            step = np.minimum(np.minimum(end, turn), rest)
            self._account(lanes, step, step * (v_n + 0.5 * rise * step))
            self._advance(lanes, (rates[0][live] * step, rates[1][live] * step, step))
            self.v_n[lanes] = v_n + rise * step
            gone[live] += step
            turns = compressing & (turn < rest)
            ends = ~compressing & (step == end)
            falls = ~compressing & ~ends & (step == turn)
            self._turn(lanes, turns=turns, ends=ends, falls=falls)
            live = live[turns | falls]
        return gone

    def go_curved(
        self,
        at: Lanes,
        series: SlidingSeries,
        begin: FloatArray,
        end: FloatArray,
        *,
        among: Lanes | None = None,
    ) -> FloatArray:
        """Advance lanes ``at`` along ``series`` from ``begin`` to ``end``, between which v_n is monotone.

        If positions ``among`` are given, only they advance, and the others keep ``begin``.

        Returns:
            The parameters reached. They are less than ``end`` where the impact was over before.
        """
        s = begin.copy()
        live = np.arange(len(at)) if among is None else among
        live = live[~self.over[at[live]]]
        while live.size > 0:
            lanes, start, stop = at[live], s[live], end[live]
            velocity = taken(series.normal_velocity, live)
            falling = value(velocity, stop) < 0.0
            compressing = self.compressing[lanes]
            target = stop.copy()
            turning = np.flatnonzero(compressing != falling)
            if turning.size > 0:
                target[turning] = crossings(
                    taken(velocity, turning), np.zeros(len(turning)), start[turning], stop[turning]
                )
            ends = np.zeros(len(live), dtype=bool)
            restoring = np.flatnonzero(~compressing)
            if restoring.size > 0:
                some = live[restoring]
                ends[restoring], target[restoring] = self._curved_finish(
                    at[some], series, some, start[restoring], target[restoring]
                )
            self._curved_step(lanes, series, live, start, target)
            self.v_n[lanes] = value(velocity, target)
            s[live] = target
            turns = compressing & ~falling
            falls = ~compressing & falling & ~ends
            self._turn(lanes, turns=turns, ends=ends, falls=falls)
            live = live[turns | falls]
        return s

    @contextmanager
    def alone(self, lane: int) -> Iterator[Progress]:
        """Lend one lane as a `Progress`, and take over how far it has come."""
        one = Progress(self.rule.law, 0.0, float(self.v_n[lane]))
        i1, i2, p = (x.item(lane) for x in self.impulse)
        c1, c2, c = (x.item(lane) for x in self.compression)
        one.impulse, one.compression = (i1, i2, p), (c1, c2, c)
        one.compressing = bool(self.compressing[lane])
        one.share, one.due = self._share.item(lane), self._due.item(lane)
        one.final_velocity = self._final_velocity.item(lane)
        yield one
        for whole, part in zip(
            (*self.impulse, *self.compression), (*one.impulse, *one.compression), strict=True
        ):
            whole[lane] = part
        self.v_n[lane], self._due[lane] = one.v_n, one.due
        self.compressing[lane], self.over[lane] = one.compressing, one.over

    def reaches(self, at: Lanes, p: FloatArray, v_n: FloatArray, work: FloatArray) -> Mask:
        """Return which lanes come to ``v_n`` after ``p`` and ``work`` before compression or impact ends."""
        due, final = self._due[at], self._final_velocity[at]
        ends = self.rule.is_done(p=p, v_n=v_n, work=work, due=due, final=final)
        reached: Mask = np.where(self.compressing[at], ~(v_n > 0.0), ~((v_n < 0.0) | ends))
        return reached

    def jump(
        self,
        at: Lanes,
        impulse: tuple[FloatArray, FloatArray, FloatArray],
        v_n: FloatArray,
        work: FloatArray,
    ) -> None:
        """Advance lanes ``at`` by ``impulse`` at once, to ``v_n``."""
        self._account(at, impulse[2], work)
        self._advance(at, impulse)
        self.v_n[at] = v_n

    def _distance_to_end(self, at: Lanes, lifting: FloatArray) -> FloatArray:
        return self.rule.distances(self.v_n[at], lifting, self._due[at], self._final_velocity[at])

    def _curved_step(
        self, at: Lanes, series: SlidingSeries, positions: Lanes, begin: FloatArray, end: FloatArray
    ) -> None:
        p, t1, t2 = (
            value(part, end) - value(part, begin)
            for part in (taken(x, positions) for x in (series.normal_impulse, series.t1, series.t2))
        )
        work = p
        if self.rule.needs_work:
            part = taken(series.normal_work, positions)
            work = value(part, end) - value(part, begin)
        self._account(at, p, work)
        self._advance(at, (t1, t2, p))

    def _curved_finish(
        self, at: Lanes, series: SlidingSeries, positions: Lanes, begin: FloatArray, end: FloatArray
    ) -> tuple[Mask, FloatArray]:
        """Return which lanes complete restitution before ``end``, and where. The others get ``end``."""
        whole = self.rule.meter(series.normal_velocity, series.normal_impulse, series.normal_work)
        meter = taken(whole, positions)
        first = value(meter, begin)
        level = self.rule.level(first, self._due[at], self._final_velocity[at])
        at_once = first >= level
        later = ~at_once & (value(meter, end) >= level)
        where = np.where(at_once, begin, end)
        some = np.flatnonzero(later)
        if some.size > 0:
            where[some] = crossings(taken(meter, some), level[some], begin[some], end[some])
        return at_once | later, where

    def _account(self, at: Lanes, p: FloatArray, work: FloatArray) -> None:
        amount = self.rule.amount(p, work)
        self._due[at] += np.where(self.compressing[at], self._share[at] * abs(amount), -amount)

    def _advance(self, at: Lanes, impulse: Iterable[FloatArray]) -> None:
        for whole, part in zip(self.impulse, impulse, strict=True):
            whole[at] += part

    def _turn(self, at: Lanes, *, turns: Mask, ends: Mask, falls: Mask) -> None:
        """End the compression of some lanes and the impact of others, and compress again where v_n falls."""
        self.v_n[at[turns | falls]] = 0.0
        ended = at[turns]
        self.compressing[ended] = False
        for whole, part in zip(self.compression, self.impulse, strict=True):
            whole[ended] = part[ended]
        self.over[at[ends]] = True
        self.compressing[at[falls]] = True


def taken(arrays: Iterable[FloatArray], lanes: Lanes | Mask) -> Any:
    """Return each array's elements at ``lanes``."""
    return [x[lanes] for x in arrays]


def crossings(series: list[FloatArray], level: FloatArray, begin: FloatArray, end: FloatArray) -> FloatArray:
    """Return where polynomials cross ``level`` between ``begin`` and ``end``. `taylor.crossing` does one."""
    low, high = begin.copy(), end.copy()
    first, last = value(series, begin), value(series, end)
    rising = last >= first
    part = np.minimum(np.maximum((level - first) / (last - first), 0.0), 1.0)
    s = np.where(last != first, begin + (end - begin) * part, end)
    result = s.copy()
    lanes = np.arange(len(s))
    for _ in range(MAX_ITERATIONS):
        total, slope = value_and_slope(series, s)
        excess = total - level
        beyond = (excess > 0.0) == rising
        high, low = np.where(beyond, s, high), np.where(beyond, low, s)
        guess = np.where(slope != 0.0, s - excess / slope, high)
        done = (abs(guess - s) <= EVENT_LOCATED * abs(guess)) & (slope != 0.0)
        inside = (low < guess) & (guess < high)
        s = np.where(done, s, np.where(inside, guess, 0.5 * (low + high)))
        result[lanes] = s
        keep = np.flatnonzero(~done)
        if keep.size == 0:
            break
        series, lanes = taken(series, keep), lanes[keep]
        level, rising, low, high, s = level[keep], rising[keep], low[keep], high[keep], s[keep]
    return result
