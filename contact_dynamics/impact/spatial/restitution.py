"""How far an impact has come while the normal impulse grows, for paths that are not known in advance.

The impact is in compression while the contact approaches, and in restitution while it leaves. Compression
collects an amount, and restitution gives a share of it back. For Poisson's law the amount is the normal
impulse, and for the energetic law it is the work of the normal impulse. Newton's law only looks at the normal
velocity. In space the sliding direction swerves, so that a contact can approach once more before its
restitution is over. Then the amount of the second compression is added to what is left of the first.

This file follows one path, with its vertices. `batch_restitution` repeats the same operations for many.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from contact_dynamics.impact.law import RULES, PathEvent, RestitutionLaw
from contact_dynamics.impact.spatial.taylor import crossing, gain, value

if TYPE_CHECKING:
    from contact_dynamics.impact.spatial.taylor import SlidingSeries

Impulse = tuple[float, float, float]  # N s: two tangential components and the normal one


class Progress:
    """The state of an impact on its way: its impulse, normal velocity and what restitution still owes."""

    def __init__(self, law: RestitutionLaw, restitution: float, v_n: float) -> None:
        self.rule = RULES[law]
        self.v_n = v_n  # m/s, <= 0 at first
        self.impulse: Impulse = (0.0, 0.0, 0.0)
        self.compression: Impulse = (0.0, 0.0, 0.0)  # at the last end of compression
        self.compressing = True
        self.over = False
        self.path: list[tuple[PathEvent, Impulse]] = [(PathEvent.START, self.impulse)]
        self.final_velocity = self.rule.final(restitution, v_n)  # m/s, Newton's end
        self.share = self.rule.share(restitution, v_n)
        self.due = 0.0  # N s or J, what restitution still owes

    def go_straight(self, length: float, rates: Impulse, lifting: float) -> float:
        """Advance by at most ``length`` of normal impulse while the impulse and v_n grow at constant rates.

        Returns:
            The normal impulse gone, N s. It is less than ``length`` if the impact was over before.
        """
        gone = 0.0
        while not self.over:
            rest = length - gone
            if self.compressing:
                turn = -self.v_n / lifting if lifting > 0.0 else math.inf
                step = min(turn, rest)
                self._straight_step(step, rates, lifting)
                gone += step
                if turn >= rest:
                    break
                self._end_compression()
            else:
                end = self._distance_to_end(lifting)
                turn = self.v_n / -lifting if lifting < 0.0 else math.inf
                step = min(end, turn, rest)
                self._straight_step(step, rates, lifting)
                gone += step
                if step == end:
                    self._finish()
                elif step == turn:
                    self._compress_again()
                else:
                    break
        return gone

    def go_curved(self, series: SlidingSeries, begin: float, end: float) -> float:
        """Advance along ``series`` from ``begin`` to ``end``, between which v_n rises or falls throughout.

        Returns:
            The parameter reached. It is less than ``end`` if the impact was over before.
        """
        s = begin
        v_n = series.normal_velocity
        while not self.over:
            v_end = value(v_n, end)
            if self.compressing:
                if v_end < 0.0:
                    return self._curved_step(series, s, end, v_end)
                s = self._curved_step(series, s, crossing(v_n, 0.0, s, end), 0.0)
                self._end_compression()
                continue
            turn, v_turn = (crossing(v_n, 0.0, s, end), 0.0) if v_end < 0.0 else (end, v_end)
            finish = self._curved_finish(series, s, turn)
            if finish is not None:
                s = self._curved_step(series, s, finish, value(v_n, finish))
                self._finish()
                break
            s = self._curved_step(series, s, turn, v_turn)
            if v_end >= 0.0:
                break
            self._compress_again()
        return s

    def jump(self, impulse: Impulse, v_n: float, work: float) -> bool:
        """Advance by ``impulse`` at once, to ``v_n``, unless compression or the impact ends on the way.

        The normal velocity must rise all the way, or fall all the way.

        Returns:
            Whether the impact has advanced.
        """
        if self.compressing:
            if v_n > 0.0:
                return False
        elif v_n < 0.0 or self._ends_within(impulse[2], v_n, work):
            return False
        self._account(impulse[2], work)
        i1, i2, p = self.impulse
        self.impulse = (i1 + impulse[0], i2 + impulse[1], p + impulse[2])
        self.v_n = v_n
        return True

    def sample(self, event: PathEvent = PathEvent.SAMPLE) -> None:
        """Add the present impulse to the path."""
        self.path.append((event, self.impulse))

    def _straight_step(self, step: float, rates: Impulse, lifting: float) -> None:
        work = step * (self.v_n + 0.5 * lifting * step)
        i1, i2, p = self.impulse
        self.impulse = (i1 + rates[0] * step, i2 + rates[1] * step, p + step)
        self._account(step, work)
        self.v_n += lifting * step

    def _distance_to_end(self, lifting: float) -> float:
        return self.rule.distance(self.v_n, lifting, self.due, self.final_velocity)

    def _ends_within(self, p: float, v_n: float, work: float) -> bool:
        return bool(self.rule.is_done(p=p, v_n=v_n, work=work, due=self.due, final=self.final_velocity))

    def _curved_step(self, series: SlidingSeries, begin: float, end: float, v_n: float) -> float:
        """Advance to ``end``, where the normal velocity is ``v_n``, and return ``end``."""
        p = gain(series.normal_impulse, begin, end)
        work = gain(series.normal_work, begin, end) if self.rule.needs_work else 0.0
        self._account(p, work)
        i1, i2, i_n = self.impulse
        self.impulse = (
            i1 + gain(series.t1, begin, end),
            i2 + gain(series.t2, begin, end),
            i_n + p,
        )
        self.v_n = v_n
        return end

    def _curved_finish(self, series: SlidingSeries, begin: float, end: float) -> float | None:
        """Return the parameter in [begin, end] at which restitution is complete, or None if it is not."""
        meter = self.rule.meter(series.normal_velocity, series.normal_impulse, series.normal_work)
        first = value(meter, begin)
        level = self.rule.level(first, self.due, self.final_velocity)
        if first >= level:
            return begin
        return crossing(meter, level, begin, end) if value(meter, end) >= level else None

    def _account(self, p: float, work: float) -> None:
        amount = self.rule.amount(p, work)
        self.due += self.share * abs(amount) if self.compressing else -amount

    def _end_compression(self) -> None:
        self.v_n = 0.0
        self.compressing = False
        self.compression = self.impulse
        self.sample(PathEvent.COMPRESSION_ENDS)

    def _compress_again(self) -> None:
        self.v_n = 0.0
        self.compressing = True

    def _finish(self) -> None:
        self.over = True
        self.sample(PathEvent.RESTITUTION_ENDS)
