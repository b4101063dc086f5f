"""This file follows the impulse path of one contact in space, from the first touch to the end of restitution.

The contact first slides. It swerves (`taylor`), or slides straight if its direction is invariant. After a
stop it sticks, or it leaves in the one admissible direction (`sliding_law`). Its path is straight in both
cases. Straight paths have closed forms. These are the paths of central and spherical impacts, of planar
impacts put into space, of impacts without friction, and of every impact after its stop.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from contact_dynamics.impact.law import ImpactOutcome, PathEvent, RestitutionLaw
from contact_dynamics.impact.spatial.restitution import Impulse, Progress
from contact_dynamics.impact.spatial.sliding_law import SlidingLaw
from contact_dynamics.impact.spatial.stop import Stop, stop_ahead
from contact_dynamics.impact.spatial.taylor import SlidingSeries, crossing, value
from contact_dynamics.numerics.elementwise import Number
from contact_dynamics.tolerances import STOPPED

MAX_STRETCHES: Final = 2000


class SpatialPath(NamedTuple):
    """An impulse path in contact axes, which are the two principal tangents and then the normal.

    Attributes:
        outcome: What the contact did.
        jams: Whether sliding drove the contact into compression at first.
        vertices: N s, the points of the path, each with its meaning.
        compression: N s, the impulse at the end of compression.
        impulse: N s, the total impulse.
        u: m/s, sliding velocity afterwards.
        v_n: m/s, normal velocity afterwards.
    """

    outcome: ImpactOutcome
    jams: bool
    vertices: list[tuple[PathEvent, Impulse]]
    compression: Impulse
    impulse: Impulse
    u: tuple[float, float]
    v_n: float


def trace(
    sliding: SlidingLaw, u: tuple[float, float], v_n: float, *, restitution: float, law: RestitutionLaw
) -> SpatialPath:
    """Return the path of a contact that starts with ``u``, tangential, and ``v_n`` <= 0, normal, m/s.

    A velocity of exactly 0 means that the contact does not slide, or does not approach. The caller has
    applied the tolerances.
    """
    u1, u2 = u
    speed = math.sqrt(u1 * u1 + u2 * u2)
    jams = speed > 0.0 and sliding.lifting(u1 / speed, u2 / speed) < 0.0
    progress = Progress(law, restitution, v_n)
    if v_n == 0.0 and not jams:
        none = progress.impulse
        return SpatialPath(ImpactOutcome.NO_IMPULSE, jams, progress.path, none, none, u, 0.0)
    if speed > 0.0:
        u = slide(sliding, u, progress, first_speed=speed)
        if progress.over:
            return _path(ImpactOutcome.SLIDES, progress, u, jams=jams)
        in_compression = progress.compressing
        progress.sample(PathEvent.SLIDING_STOPS)
    i1, i2, lifting, speeding = sliding.after_stop()
    gone = progress.go_straight(math.inf, (i1, i2, 1.0), lifting)
    if speeding == 0.0:
        u = (0.0, 0.0)
    else:
        u = ((sliding.k1 + sliding.l1 * i1) * gone, (sliding.k2 + sliding.l2 * i2) * gone)
    if speed == 0.0:
        outcome = ImpactOutcome.STICKS_THROUGHOUT if speeding == 0.0 else ImpactOutcome.SLIDES
    elif in_compression:
        held, reversed_ = ImpactOutcome.STICKS_IN_COMPRESSION, ImpactOutcome.REVERSES_IN_COMPRESSION
        outcome = held if speeding == 0.0 else reversed_
    else:
        held, reversed_ = ImpactOutcome.STICKS_IN_RESTITUTION, ImpactOutcome.REVERSES_IN_RESTITUTION
        outcome = held if speeding == 0.0 else reversed_
    return _path(outcome, progress, u, jams=jams)


def _path(outcome: ImpactOutcome, progress: Progress, u: tuple[float, float], *, jams: bool) -> SpatialPath:
    return SpatialPath(outcome, jams, progress.path, progress.compression, progress.impulse, u, progress.v_n)


def slide(
    sliding: SlidingLaw,
    u: tuple[float, float],
    progress: Progress,
    *,
    first_speed: float,
    started: bool = False,
    ends_before: bool | None = None,
) -> tuple[float, float]:
    """Follow sliding until it stops or the impact is over, and return the sliding velocity there, m/s.

    Args:
        sliding: The law that the sliding follows.
        u: m/s, the present sliding velocity.
        progress: How far the impact has come. This function advances it.
        first_speed: m/s, the sliding speed at the beginning of the whole path. Errors are compared with it.
        started: Whether sliding has already swerved.
        ends_before: The phase (whether it is compression) that is known to end before the stop ahead, or None
            if neither is known to.
    """
    u1, u2 = u
    slowest = STOPPED * first_speed
    with_work = progress.rule.needs_work
    for _ in range(MAX_STRETCHES):
        speed = math.sqrt(u1 * u1 + u2 * u2)
        d1, d2 = u1 / speed, u2 / speed
        speeding, lifting = sliding.speeding(d1, d2), sliding.lifting(d1, d2)
        if sliding.keeps(d1, d2, started=started):
            return _slide_straight(sliding, sliding.settled(d1, d2), speed, progress)
        if speeding < 0.0 and speed <= slowest:
            return _slide_straight(sliding, (d1, d2), speed, progress)
        if sliding.mu == 0.0:
            # Without friction u changes along a line, which misses 0.
            p = progress.go_straight(math.inf, (0.0, 0.0, 1.0), sliding.kn)
            return (u1 + sliding.k1 * p, u2 + sliding.k2 * p)
        if speeding < 0.0 and progress.compressing is not ends_before:
            stop = stop_ahead(sliding, (u1, u2), first_speed, with_work=with_work)
            # If v_n rises at both ends it rises all the way, and if it falls at both it falls all the way.
            if stop is not None and (lifting < 0.0) == (sliding.lifting(stop.d1, stop.d2) < 0.0):
                if progress.jump(*at_stop(sliding, (u1, u2), progress.v_n, stop)):
                    return (0.0, 0.0)
                ends_before = progress.compressing
        series = SlidingSeries(sliding, (u1, u2), progress.v_n, with_work=with_work)
        u1, u2 = _slide_along(series, progress, lifting)
        if progress.over:
            return (u1, u2)
        progress.sample()
        started = True
    raise AssertionError  # each stretch turns or slows the sliding by a fixed part


def at_stop(
    sliding: SlidingLaw, u: tuple[Number, Number], v_n: Number, stop: Stop
) -> tuple[tuple[Number, Number, Number], Number, Number]:
    """Return the impulse from a state to its stop, the normal velocity there, and the normal work, J."""
    p = stop.p
    i1, i2 = -(u[0] + sliding.k1 * p) / sliding.l1, -(u[1] + sliding.k2 * p) / sliding.l2
    v_stop = v_n + sliding.kn * p + sliding.k1 * i1 + sliding.k2 * i2
    work = 0.5 * (i1 * u[0] + i2 * u[1] + p * (v_n + v_stop)) + stop.dissipated
    return (i1, i2, p), v_stop, work


def _slide_straight(
    sliding: SlidingLaw, d: tuple[float, float], speed: float, progress: Progress
) -> tuple[float, float]:
    speeding = sliding.speeding(*d)
    length = speed / -speeding if speeding < 0.0 else math.inf
    rates = (-sliding.mu * d[0], -sliding.mu * d[1], 1.0)
    gone = progress.go_straight(length, rates, sliding.lifting(*d))
    final = speed + speeding * gone if progress.over else 0.0
    return (d[0] * final, d[1] * final)


def _slide_along(series: SlidingSeries, progress: Progress, lifting: float) -> tuple[float, float]:
    """Advance along one stretch, in two parts if v_n turns from falling to rising or back."""
    end = series.length
    s = 0.0
    if (value(series.lifting, end) < 0.0) != (lifting < 0.0):
        s = progress.go_curved(series, 0.0, crossing(series.lifting, 0.0, 0.0, end))
    if not progress.over:
        s = progress.go_curved(series, s, end)
    return (value(series.u1, s), value(series.u2, s))
