"""The next strikes of many samples of a toss at once: flight in closed form, Routh's impact, and so on.

A flight ends where the first corner reaches a flat (`arrivals_of_many`). Then every sample has its own impact
(`impact.spatial.batch`), and the law's own spread is added to the velocities after it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.impact.spatial.batch import StrikingBodies, spatial_impacts
from contact_dynamics.records import NamedInt
from contact_dynamics.rotations.many import crosses, matrices_of
from contact_dynamics.tolerances import SAMPLED_SETTLING_HEIGHT
from contact_dynamics.toss.arrivals_of_many import arrivals_of_many

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
"""Strikes that are followed beyond those to tell of. A body that still bounces then goes on by itself."""


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


def strikes_of_many(
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
        depth: How many strikes to tell of.
        horizon: s, how far.
        further: Whether the last states are those after later strikes. Samples go on as long as
            `FEWEST_AT_ONCE` fly on after each.
    """
    n = len(samples.p_WB_W)
    state = [samples.p_WB_W.copy(), samples.q_WB.copy(), samples.v_WB_W.copy(), samples.w_WB_W.copy()]
    now = np.zeros(n)
    ends = np.full(n, SampleEnd.FOLLOWED, dtype=np.int64)
    told = ManyStrikes(
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
        found = arrivals_of_many(
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
            told.seconds[k, going], told.surfaces[k, going] = now[going], surfaces
            told.corners[k, going] = corners
            for rows, each in zip((told.p_WB_W, told.q_WB, told.v_WB_W, told.w_WB_W), state, strict=True):
                rows[k, going] = each[going]
        going = going[~slow]
    return told


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
