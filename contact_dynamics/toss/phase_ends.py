"""Where a contact mode ends within a step.

It ends where a held contact no longer presses, where friction no longer holds one that sticks, or where
another corner comes down. These times are found on the interpolant.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, TypeAlias

from contact_dynamics.records import NamedInt
from contact_dynamics.tolerances import COMES_DOWN_FOUND, FORCE_END_FOUND, GRAZING_DEPTH, PHASE_LEAST_STEP
from contact_dynamics.toss.forces import Pushed, force_rounding, least_left, pushed_by_contacts
from contact_dynamics.toss.phase_step import within
from contact_dynamics.toss.solid import heights_and_rates, rows_at

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.toss.held import Held
    from contact_dynamics.toss.phase_step import PhaseStep
    from contact_dynamics.toss.solid import Flat, Numbers, Solid, Touch

_MAX_ROOT_STEPS: Final = 60

Watched: TypeAlias = "list[tuple[Flat, list[tuple[Vector3, float]]]]"
"""The corners that could come down on each flat, m, body axes, with the depths, m, that they may have."""


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


def low_corners(solid: Solid, y: Numbers, held: set[Touch]) -> dict[Touch, float]:
    """Return the corners that are on a flat or below and not held, with the depths, m, that they may have."""
    listed = heights_and_rates(solid, y)
    return {
        touch: 0.5 * GRAZING_DEPTH - min(height, 0.0)
        for height, _, touch in listed
        if height <= 0.5 * GRAZING_DEPTH and touch not in held
    }


def watched_corners(solid: Solid, held: set[Touch], low: dict[Touch, float]) -> Watched:
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


def first_end(
    solid: Solid,
    step: PhaseStep,
    mode: tuple[Held, ...],
    *,
    after: Pushed,
    trial: Numbers,
    watched: Watched,
) -> tuple[PhaseEnd, float] | None:
    """Return why and where, as a share of the step, the mode ends within a step, or None."""

    def height_at(x: float) -> float:
        return _least_height(solid, within(step, x).tolist(), watched)

    def force_at(x: float) -> float:
        pushed = pushed_by_contacts(solid, within(step, x).tolist(), mode)
        return least_left(solid, mode, pushed.forces)

    first: tuple[PhaseEnd, float] | None = None
    if _least_height(solid, trial, watched) < 0.0:
        first = PhaseEnd.COMES_DOWN, _crossing(height_at, 1.0, step.whole, COMES_DOWN_FOUND)
    if least_left(solid, mode, after.forces) < 0.0:
        x = 1.0 if first is None else first[1]
        if first is None or force_at(x) < 0.0:
            first = (
                PhaseEnd.FORCES,
                _crossing(force_at, x, step.whole, FORCE_END_FOUND * force_rounding(solid)),
            )
    return first


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
