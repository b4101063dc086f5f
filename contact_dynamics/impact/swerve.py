"""The impulse path of one contact in space, from the first touch to the end of restitution.

Phases: sliding that swerves (`series`), or slides straight where its direction is invariant; after a stop,
sticking or leaving in the one admissible direction, both straight (`sliding`). The straight ones are closed
forms: a central or spherical impact, a planar impact embedded in space, and every impact after its stop.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from contact_dynamics.impact.law import ImpactOutcome, PathEvent, RestitutionLaw
from contact_dynamics.impact.progress import Impulse, Progress
from contact_dynamics.impact.series import SlidingSeries
from contact_dynamics.impact.sliding import SlidingLaw
from contact_dynamics.impact.stopping import Stop, stop_ahead

STRAIGHT: Final = 1e-12
"""Dimensionless, of the sliding law's scale. A direction that turns more slowly is invariant: what turns it
is the rounding of contact axes and inertia, some 1e-15, which an unstable direction would amplify."""

UNCOUPLED: Final = 1e-15
"""Dimensionless, of the tangential inverse inertia. A slower turn is the rounding of a coupling that is zero,
as of a sphere's, whose scale is rounding too."""

STOPPED: Final = 1e-13
"""Dimensionless, of the first sliding speed. The error in impulse from going the rest of the way straight is
below this part of the impulse that stops the contact."""

_MOST_STRETCHES: Final = 2000


class SpatialPath(NamedTuple):
    """An impulse path in contact axes: the two principal tangents, then the normal."""

    outcome: ImpactOutcome  # what the contact did
    jams: bool  # whether sliding drove the contact into compression at first
    vertices: list[tuple[PathEvent, Impulse]]  # N s
    compression: Impulse  # N s, at the end of compression
    impulse: Impulse  # N s, total
    u: tuple[float, float]  # m/s, sliding velocity afterwards
    v_n: float  # m/s, normal velocity afterwards


def trace(
    sliding: SlidingLaw, u: tuple[float, float], v_n: float, *, restitution: float, law: RestitutionLaw
) -> SpatialPath:
    """Return the path of a contact that starts with ``u``, tangential, and ``v_n`` <= 0, normal, m/s.

    An exact 0 means a contact that does not slide or does not approach; tolerances are the caller's.
    """
    u1, u2 = u
    speed = math.hypot(u1, u2)
    jams = speed > 0.0 and sliding.lifting(u1 / speed, u2 / speed) < 0.0
    progress = Progress(law, restitution, v_n)
    if v_n == 0.0 and not jams:
        none = progress.impulse
        return SpatialPath(ImpactOutcome.NO_IMPULSE, jams, progress.path, none, none, u, 0.0)
    if speed > 0.0:
        u = _slide(sliding, u, progress)
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
    elif speeding == 0.0:
        outcome = (
            ImpactOutcome.STICKS_IN_COMPRESSION if in_compression else ImpactOutcome.STICKS_IN_RESTITUTION
        )
    else:
        outcome = (
            ImpactOutcome.REVERSES_IN_COMPRESSION if in_compression else ImpactOutcome.REVERSES_IN_RESTITUTION
        )
    return _path(outcome, progress, u, jams=jams)


def _path(outcome: ImpactOutcome, progress: Progress, u: tuple[float, float], *, jams: bool) -> SpatialPath:
    return SpatialPath(outcome, jams, progress.path, progress.compression, progress.impulse, u, progress.v_n)


def _slide(sliding: SlidingLaw, u: tuple[float, float], progress: Progress) -> tuple[float, float]:
    """Follow sliding until it stops or the impact is over; return the sliding velocity there, m/s."""
    slowest = STOPPED * math.hypot(*u)
    still = max(STRAIGHT * sliding.scale, UNCOUPLED * (sliding.l1 + sliding.l2))
    with_work = progress.law == RestitutionLaw.ENERGETIC
    for stretch in range(_MOST_STRETCHES):
        speed = math.hypot(*u)
        d1, d2 = u[0] / speed, u[1] / speed
        speeding, lifting = sliding.speeding(d1, d2), sliding.lifting(d1, d2)
        straight = abs(sliding.turning(d1, d2)) <= still
        if straight and (stretch == 0 or sliding.attraction(d1, d2) < 0.0):
            return _slide_straight(sliding, (d1, d2), speed, progress)
        if speeding < 0.0:
            if speed <= slowest:
                return _slide_straight(sliding, (d1, d2), speed, progress)
            stop = stop_ahead(sliding, *u, with_work=with_work)
            if stop is not None and _jump(sliding, u, stop, lifting, progress):
                return (0.0, 0.0)
        series = SlidingSeries(sliding, u, progress.v_n, with_work=with_work)
        u = _slide_along(series, progress, lifting)
        if progress.over:
            return u
        progress.sample()
    raise AssertionError  # each stretch turns or slows the sliding by a fixed part


def _jump(
    sliding: SlidingLaw, u: tuple[float, float], stop: Stop, lifting: float, progress: Progress
) -> bool:
    """Go to the stop ahead at once, if neither compression nor the impact ends before it."""
    if (lifting < 0.0) != (sliding.lifting(*stop.d) < 0.0):
        return False
    p = stop.p
    i1, i2 = -(u[0] + sliding.k1 * p) / sliding.l1, -(u[1] + sliding.k2 * p) / sliding.l2
    v_n = progress.v_n + sliding.kn * p + sliding.k1 * i1 + sliding.k2 * i2
    work = 0.5 * (i1 * u[0] + i2 * u[1] + p * (progress.v_n + v_n)) + stop.dissipated
    return progress.jump((i1, i2, p), v_n, work)


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
    """Advance along one stretch, split where v_n turns."""
    end = series.length
    rate = [c * (n + 1) for n, c in enumerate(series.normal_velocity[1:])]
    s = 0.0
    if (series.value(rate, end) < 0.0) != (lifting < 0.0):
        s = progress.go_curved(series, 0.0, series.crossing(rate, 0.0, 0.0, end))
    if not progress.over:
        s = progress.go_curved(series, s, end)
    return (series.value(series.u1, s), series.value(series.u2, s))
