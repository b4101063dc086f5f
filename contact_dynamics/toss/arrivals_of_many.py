"""Where the flights of many samples end: all at once, in closed form.

A flight ends where the first corner reaches a flat. All samples step towards that together. A step is as long
as no corner can arrive earlier, since the acceleration of each is bounded along the flight (as in
`landing.acceleration_bounds`). Steps shrink to the arrival as Newton's do.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.rotations.many import matrices_of
from contact_dynamics.tolerances import SAMPLED_ARRIVAL
from contact_dynamics.tumbling.many import motions_of_many

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from contact_dynamics.numerics.arithmetic import FloatArray
    from contact_dynamics.toss.solid import Solid

_MAX_STEPS: Final = 200
"""Steps towards one arrival, after which a sample counts as one that never arrives. Ten are usual."""


class Arrivals(NamedTuple):
    """Where flights end: after these times, s, at these flats and corners, -1 for none, in these states."""

    seconds: FloatArray
    surfaces: NDArray[np.int64]
    corners: NDArray[np.int64]
    state: list[FloatArray]


def arrivals_of_many(
    solid: Solid,
    inertias: FloatArray,
    corners: FloatArray,
    gravities: FloatArray,
    state: list[FloatArray],
    *,
    longest: FloatArray,
) -> Arrivals:
    """Return where flights of n samples end.

    Args:
        solid: What samples have in common: where the flats are, and by how much corners are rounded.
        inertias: (n, 3, 3), kg m^2, body axes.
        corners: (n, k, 3), m, body axes.
        gravities: (n, 3), m/s^2.
        state: Positions, quaternions, velocities and angular velocities, a row a sample.
        longest: (n,), s, after which flights end anyway.
    """
    n = len(inertias)
    normals = np.array([flat.normal for flat in solid.flats])
    levels = np.array([flat.level for flat in solid.flats]) + solid.rounding
    reaches = np.linalg.norm(corners, axis=2)
    pulls = np.maximum(
        -(gravities @ normals.T)[:, :, None]
        + _turning(inertias, state[1], state[3])[:, None, None] * reaches[:, None, :],
        0.0,
    )
    t = np.zeros(n)
    surface, corner = np.full(n, -1, dtype=np.int64), np.full(n, -1, dtype=np.int64)
    then = [each.copy() for each in state]

    motions = motions_of_many(
        inertias,
        p_WB_W=state[0],
        q_WB=state[1],
        v_WB_W=state[2],
        w_WB_W=state[3],
        gravities_W=gravities,
    )

    def move(some: NDArray[np.intp]) -> None:
        moved = (motions.of(some) if len(some) < n else motions).at(t[some])
        for each, rows in zip(then, (moved.p_WB_W, moved.q_WB, moved.v_WB_W, moved.w_WB_W), strict=True):
            each[some] = rows

    active = np.arange(n)
    for _ in range(_MAX_STEPS):
        heights, rates = _heights(normals, levels, corners[active], [each[active] for each in then])
        # What arrives is as near as counts, and still comes nearer. Of several, the fastest strikes first.
        speeds = np.where(heights <= SAMPLED_ARRIVAL, rates, np.inf).reshape(len(active), -1)
        first = speeds.argmin(axis=1)
        arrived = speeds[np.arange(len(active)), first] < 0.0
        surface[active[arrived]], corner[active[arrived]] = np.divmod(first[arrived], corners.shape[1])
        steps = _free_for(heights, rates, pulls[active]).reshape(len(active), -1).min(axis=1)
        over = ~arrived & (t[active] >= longest[active])
        active, steps = active[~arrived & ~over], steps[~arrived & ~over]
        if len(active) == 0:
            break
        t[active] = np.minimum(t[active] + steps, longest[active])
        move(active)
    return Arrivals(t, surface, corner, then)


def _turning(inertias: FloatArray, q: FloatArray, w: FloatArray) -> FloatArray:
    """Return bounds on the accelerations of points by rotation, for each metre of distance, (n,), 1/s^2.

    Energy bounds the angular velocity by 2 T / I1. The angular acceleration is at most a share of its square,
    which is zero for a ball, and 1/sqrt(3) for any body.
    """
    w_B = np.einsum("nij,ni->nj", matrices_of(q), w)
    moments = np.linalg.eigvalsh(inertias)
    squares = np.einsum("ni,nij,nj->n", w_B, inertias, w_B) / moments[:, 0]
    apart = (moments[:, 2] - moments[:, 0]) / moments[:, 0]
    bounds: FloatArray = squares * (1.0 + np.minimum(apart, 1.0) / np.sqrt(3.0))
    return bounds


def _heights(
    normals: FloatArray, levels: FloatArray, corners: FloatArray, state: list[FloatArray]
) -> tuple[FloatArray, FloatArray]:
    """Return the heights, m, and rates, m/s, (n, s, k), of corners above flats."""
    p, q, v, w = state
    arms = corners @ matrices_of(q).transpose(0, 2, 1)
    heights = np.einsum("nkj,sj->nsk", arms + p[:, None, :], normals) - levels[None, :, None]
    rates = np.einsum("nkj,sj->nsk", v[:, None, :] + np.cross(w[:, None, :], arms), normals)
    return heights, rates


def _free_for(heights: FloatArray, rates: FloatArray, pulls: FloatArray) -> FloatArray:
    """Return for how long, s, points cannot arrive, if ``pulls`` are their largest accelerations, m/s^2."""
    allowed = np.maximum(heights, 0.0) + 0.5 * SAMPLED_ARRIVAL
    roots = np.sqrt(rates * rates + 2.0 * pulls * allowed)
    with np.errstate(divide="ignore", invalid="ignore"):
        falling = 2.0 * allowed / (roots - rates)
        rising = np.where(pulls > 0.0, (rates + roots) / pulls, np.inf)
    times: FloatArray = np.where(rates < 0.0, falling, rising)
    return times
