"""The next strikes of many samples of a toss at once: flight in closed form, Routh's impact, and so on.

A flight ends where the first corner reaches a flat. All samples step towards that together. A step is as long
as no corner can arrive earlier, since the acceleration of each is bounded along the flight (as in
`landing.acceleration_bounds`). Steps shrink to the arrival as Newton's do. Then every sample has its own
impact (`impact.spatial.batch`), and the law's own spread is added to the velocities after it.

A single toss computes its strikes in `flight` and `strike`. This second program exists because it is about
twenty times faster for 1000 samples over two strikes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.impact.spatial.batch import StrikingBodies, spatial_impacts
from contact_dynamics.records import NamedInt
from contact_dynamics.rotations.many import crosses, matrices_of
from contact_dynamics.tolerances import SAMPLED_ARRIVAL, SAMPLED_SETTLING_HEIGHT
from contact_dynamics.tumbling.many import motions_of_many

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from contact_dynamics.impact.law import RestitutionLaw
    from contact_dynamics.numerics.arithmetic import FloatArray
    from contact_dynamics.toss.law_spread import LawSpread
    from contact_dynamics.toss.solid import Solid
    from contact_dynamics.toss.uncertainty import Samples

FEWEST_AT_ONCE: Final = 32
"""Samples below which one after the other is faster than all at once."""

MAX_FURTHER: Final = 50
"""Strikes that are followed beyond those returned. A body that still bounces then goes on by itself."""


_MAX_STEPS: Final = 200
"""Steps towards one arrival, after which a sample counts as one that never arrives. Ten are usual."""


class SampleEnd(NamedInt):
    """Why a sample has no further strike."""

    FOLLOWED = 0
    """It has as many strikes as were asked for."""
    STAYS = 1
    """A contact rebounds too little to be followed, and stays."""
    FLIES = 2
    """It meets nothing until the horizon."""
    ENDS = 3
    """It was followed to its end, and has no further strike."""


class ManyStrikes(NamedTuple):
    """The next strikes of n samples, d of each.

    Attributes:
        seconds: (d, n), s after the first state; NaN where a sample has no such strike.
        surfaces: (d, n), the flat that is struck, or -1.
        corners: (d, n), the corner that strikes, or -1.
        p_WB_W: (d, n, 3), m, the mass centre then.
        q_WB: (d, n, 4), the attitude then.
        v_WB_W: (d, n, 3), m/s, after the strike.
        w_WB_W: (d, n, 3), rad/s, after the strike.
        ends: (n,), values of `SampleEnd`.
        now: (n,), s, the time of the last state.
        last: The last states: positions, quaternions, velocities and angular velocities, a row a sample.
    """

    seconds: FloatArray
    surfaces: NDArray[np.int64]
    corners: NDArray[np.int64]
    p_WB_W: FloatArray
    q_WB: FloatArray
    v_WB_W: FloatArray
    w_WB_W: FloatArray
    ends: NDArray[np.int64]
    now: FloatArray
    last: tuple[FloatArray, FloatArray, FloatArray, FloatArray]


class _Arrivals(NamedTuple):
    """Where flights end: after these times, s, at these flats and corners, -1 for none, in these states."""

    seconds: FloatArray
    surfaces: NDArray[np.int64]
    corners: NDArray[np.int64]
    state: list[FloatArray]


def next_strikes(
    solid: Solid,
    samples: Samples,
    *,
    law: RestitutionLaw,
    spread: LawSpread,
    depth: int,
    horizon: float,
    further: bool = False,
) -> ManyStrikes:
    """Return the next ``depth`` strikes of samples, within ``horizon`` s.

    Args:
        solid: The body and the flats; corners, frictions and restitutions are those of the samples.
        samples: What differs between them.
        law: What the coefficients of restitution mean.
        spread: The law's own spread.
        depth: How many strikes to return.
        horizon: s, how far.
        further: Whether the last states are those after later strikes. Samples go on as long as
            `FEWEST_AT_ONCE` fly on after each.
    """
    n = len(samples.p_WB_W)
    state = [samples.p_WB_W.copy(), samples.q_WB.copy(), samples.v_WB_W.copy(), samples.w_WB_W.copy()]
    now = np.zeros(n)
    ends = np.full(n, SampleEnd.FOLLOWED, dtype=np.int64)
    many = ManyStrikes(
        seconds=np.full((depth, n), np.nan),
        surfaces=np.full((depth, n), -1, dtype=np.int64),
        corners=np.full((depth, n), -1, dtype=np.int64),
        p_WB_W=np.full((depth, n, 3), np.nan),
        q_WB=np.full((depth, n, 4), np.nan),
        v_WB_W=np.full((depth, n, 3), np.nan),
        w_WB_W=np.full((depth, n, 3), np.nan),
        ends=ends,
        now=now,
        last=(state[0], state[1], state[2], state[3]),
    )
    going = np.arange(n)
    for k in range(depth + (MAX_FURTHER if further else 0)):
        if len(going) < (FEWEST_AT_ONCE if k >= depth else 1):
            break
        found = _arrivals(
            solid,
            samples.inertias_B[going],
            samples.corners_B[going],
            samples.gravities_W[going],
            [each[going] for each in state],
            longest=horizon - now[going],
        )
        for each, then in zip(state, found.state, strict=True):
            each[going] = then
        now[going] += found.seconds
        arrived = found.corners >= 0
        over = going[~arrived]
        going, surfaces, corners = going[arrived], found.surfaces[arrived], found.corners[arrived]
        rebounds = _strike(
            solid, samples, going, state, surfaces=surfaces, corners=corners, law=law, spread=spread
        )
        slow = rebounds**2 <= 2.0 * SAMPLED_SETTLING_HEIGHT * float(np.linalg.norm(solid.gravity))
        if k < depth:
            ends[over] = SampleEnd.FLIES
            ends[going[slow]] = SampleEnd.STAYS
            many.seconds[k, going], many.surfaces[k, going] = now[going], surfaces
            many.corners[k, going] = corners
            for rows, each in zip((many.p_WB_W, many.q_WB, many.v_WB_W, many.w_WB_W), state, strict=True):
                rows[k, going] = each[going]
        going = going[~slow]
    return many


def _strike(
    solid: Solid,
    samples: Samples,
    which: NDArray[np.intp],
    state: list[FloatArray],
    *,
    surfaces: NDArray[np.int64],
    corners: NDArray[np.int64],
    law: RestitutionLaw,
    spread: LawSpread,
) -> FloatArray:
    """Change the velocities of some samples by their strikes, and return the rebounds of the corners, m/s."""
    normals = np.array([flat.normal for flat in solid.flats])[surfaces]
    q, inertias = state[1][which], samples.inertias_B[which]
    R = matrices_of(q)
    r = np.einsum("nij,nj->ni", R, samples.corners_B[which, corners]) - solid.rounding * normals
    impacts = spatial_impacts(
        StrikingBodies(
            masses=solid.mass,
            inertias_B=inertias,
            q_WB=q,
            v_WB_W=state[2][which],
            w_WB_W=state[3][which],
            r_W=r,
        ),
        normals_W=normals,
        frictions=samples.frictions[which, surfaces],
        restitutions=samples.restitutions[which, surfaces],
        restitution_laws=law,
        skip_separating=True,
    )
    inverses = R @ np.linalg.inv(inertias) @ R.transpose(0, 2, 1)
    turning = solid.mass * np.cross(inverses, r[:, None, :])  # rows of the inverse times the matrix of r x
    changes = spread.changes(which, np.linalg.norm(impacts.v_WB_W - state[2][which], axis=1), turning)
    v, w = impacts.v_WB_W + changes[:, :3], impacts.w_WB_W + changes[:, 3:]
    rebounds = np.einsum("ni,ni->n", normals, v + crosses(w, r))
    # A corner does not go on into the flat. Where the spread would have it so, an impulse turns it back.
    moments = crosses(r, normals)
    turns = np.einsum("nij,nj->ni", inverses, moments)
    impulses = np.maximum(-2.0 * rebounds, 0.0) / (1.0 / solid.mass + np.einsum("ni,ni->n", moments, turns))
    state[2][which] = v + (impulses / solid.mass)[:, None] * normals
    state[3][which] = w + impulses[:, None] * turns
    size: FloatArray = np.abs(rebounds)
    return size


def _arrivals(
    solid: Solid,
    inertias: FloatArray,
    corners: FloatArray,
    gravities: FloatArray,
    state: list[FloatArray],
    *,
    longest: FloatArray,
) -> _Arrivals:
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
    return _Arrivals(t, surface, corner, then)


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
