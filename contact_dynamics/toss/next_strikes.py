# SPDX-License-Identifier: Apache-2.0
"""The next strikes of samples of a toss: flight, Routh's impact, and so on.

The flight of each sample is computed separately (`flight`). The impacts of all samples then form a batch
(`impact.spatial.batch`), and the spread of the impact law is added to the velocities after them. A sample
with a low rebound continues as a single toss (`to_rest`), since several corners may strike or stay.
"""

from __future__ import annotations

from array import array
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from contact_dynamics.impact.spatial.batch import StrikingBodies, spatial_impacts
from contact_dynamics.records import NamedInt
from contact_dynamics.rotations.many import crosses, matrices_of
from contact_dynamics.tolerances import SAMPLED_SETTLING_HEIGHT
from contact_dynamics.toss.flight import arrivals
from contact_dynamics.toss.solid import Solid

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from contact_dynamics.impact.law import RestitutionLaw
    from contact_dynamics.numerics.arithmetic import FloatArray
    from contact_dynamics.toss.law_spread import LawSpread
    from contact_dynamics.toss.uncertainty import Samples
    from contact_dynamics.toss.vectors import Matrix3

FEWEST_AT_ONCE: Final = 32
"""Samples below which impacts one after the other are faster than all at once."""

MAX_FURTHER: Final = 50
"""Strikes that are followed beyond those returned. A body that still bounces then goes on by itself."""


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
        solids: The body and the flats of each sample.
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
    solids: list[Solid]


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
    n, inverses = len(samples.p_WB_W), np.linalg.inv(samples.inertias_B)
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
        solids=solids_of(solid, samples, inverses),
    )
    going = np.arange(n)
    for k in range(depth + (MAX_FURTHER if further else 0)):
        if len(going) < (FEWEST_AT_ONCE if k >= depth else 1):
            break
        if len(going) == 0:
            break
        found = _arrivals(
            many.solids,
            going,
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
            solid,
            samples,
            going,
            state,
            inverses=inverses[going],
            surfaces=surfaces,
            corners=corners,
            law=law,
            spread=spread,
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
    inverses: NDArray[np.floating[Any]],
    surfaces: NDArray[np.int64],
    corners: NDArray[np.int64],
    law: RestitutionLaw,
    spread: LawSpread,
) -> FloatArray:
    """Change the velocities of some samples by their strikes, and return the rebounds of the corners, m/s."""
    normals = np.array([flat.normal for flat in solid.flats]).reshape(-1, 3)[surfaces]
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
    inverses = R @ inverses @ R.transpose(0, 2, 1)
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
    solids: list[Solid],
    which: NDArray[np.intp],
    gravities: FloatArray,
    state: list[FloatArray],
    *,
    longest: FloatArray,
) -> _Arrivals:
    """Return where flights of n samples end.

    Args:
        solids: The body and the flats of each sample.
        which: (n,), the samples that fly.
        gravities: (n, 3), m/s^2.
        state: Positions, quaternions, velocities and angular velocities, a row a sample.
        longest: (n,), s, after which flights end anyway.

    Raises:
        TooLargeError: the search for an end takes too many steps.
    """
    starts = np.hstack(state)
    after, seconds = np.empty_like(starts), np.empty(len(which))
    parts = np.empty(len(which), dtype=np.int64)
    arrivals([solids[i] for i in which.tolist()], gravities, starts, longest, after, seconds, parts)
    surfaces, corners = np.divmod(parts, solids[0].count)
    corners[surfaces < 0] = -1
    return _Arrivals(seconds, surfaces, corners, [after[:, :3], after[:, 3:7], after[:, 7:10], after[:, 10:]])


def solids_of(solid: Solid, samples: Samples, inverses_B: NDArray[np.floating[Any]]) -> list[Solid]:
    """Return the body and the flats of each sample; the inverses of their inertias are (n, 3, 3)."""
    inertias, inverses = _matrices(samples.inertias_B), _matrices(inverses_B)
    materials = np.stack(
        [samples.lasting_frictions, samples.restitutions, samples.frictions], axis=2
    ).tolist()
    return [
        Solid(
            solid.mass,
            inertias[i],
            inverses[i],
            array("d", corners.tobytes()),
            solid.indices,
            solid.rounding,
            solid.gravity,
            tuple([flat.with_frictions(*own) for flat, own in zip(solid.flats, materials[i], strict=True)]),
            solid.settling,
        )
        for i, corners in enumerate(samples.corners_B)
    ]


def _matrices(arrays: NDArray[np.floating[Any]]) -> list[Matrix3]:
    """Return arrays (n, 3, 3) row by row."""
    return [(a, b, c, d, e, f, g, h, i) for a, b, c, d, e, f, g, h, i in arrays.reshape(-1, 9).tolist()]
