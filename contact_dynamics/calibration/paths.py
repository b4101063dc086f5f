# SPDX-License-Identifier: Apache-2.0
"""The second way: fits whole trajectories through strikes, with the flights before and after in one fit.

Each strike has 19 unknowns of its own: time, place, attitude and both velocities just before it, and the
deviations of the velocities after it from the impact law, which are weighted by the law's spread. Residuals
are the measured poses on both sides. Attitudes follow torque-free motion in closed form. A strike's unknowns
are solved for at each set of parameters, and then projected out (Golub and Pereyra, SIAM Journal on Numerical
Analysis 1973), so that what is left depends on the parameters alone.

Velocities are never fitted to one side alone here, so the two ways fail differently if a flight is not free,
or if the poses of both sides do not agree at the strike.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.calibration.impacts import velocities_after, velocities_before
from contact_dynamics.numerics.clustered_fit import Group
from contact_dynamics.numerics.linear_spaces import triangle_of
from contact_dynamics.rotations.many import matrices_of, rotation_vectors, turned
from contact_dynamics.tolerances import DERIVATIVE_STEP, LEAST_LAW_SPIN, LEAST_LAW_VELOCITY
from contact_dynamics.tumbling.many import states_of_many

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from contact_dynamics.calibration.estimation import Fitting, Spread
    from contact_dynamics.calibration.model import Described
    from contact_dynamics.calibration.observed import Observed
    from contact_dynamics.measured.motion import MeasuredMotion
    from contact_dynamics.validation import FloatArray

OWN: Final = 19
"""Unknowns of a strike: time, place (3), attitude (3), velocities (6), and the law's error (6)."""

LAW: Final = 6  # the first residuals of a strike, which are the law's errors in standard deviations

APART: Final = 6
"""Six further numbers, by which place and attitude would jump at the strike. They are zero, and only tell
which residuals are the flights' own."""

BETWEEN: Final = 11
"""Conditions between both flights: twelve numbers of the state, less the time of the strike."""

OWN_ROUNDS: Final = 2
"""Steps that a strike's unknowns take at each set of parameters. They start where the last set left them."""


@dataclass(frozen=True, slots=True, eq=False)
class _Windows:
    """The poses on one side of n strikes, padded to m each; rows with ``used`` 0 are ignored."""

    since: FloatArray  # (n, m), s after the strike as found
    p_W: FloatArray  # (n, m, 3)
    q_WB: FloatArray  # (n, m, 4)
    used: FloatArray  # (n, m), 1 or 0


class Paths:
    """The trajectories through all strikes, with the last solution for their own unknowns."""

    def __init__(self, fitting: Fitting, observed: Sequence[Observed]) -> None:
        """Start from the flights as fitted to each side."""
        self._fitting = fitting
        self._model, self._data = fitting.model, fitting.data
        strikes = self._data.strikes
        motions = [observed[number].motion for number in strikes.recordings]
        found = [strike for each in observed for strike in each.strikes]
        self._sides = [
            _windows(
                [(motion, frames, s.time) for motion, s, frames in zip(motions, found, each, strict=True)]
            )
            for each in ([s.frames_before for s in found], [s.frames_after for s in found])
        ]
        noise = np.array([[m.position_noise, m.orientation_noise] for m in motions]).reshape(-1, 2)
        self._noise = [noise * side.factors for side in (strikes.before, strikes.after)]
        self._own: FloatArray | None = None

    def groups_at(self, x: FloatArray, spread: Spread) -> list[tuple[str, Group]]:
        """Return the residuals of all trajectories, with the strikes' own unknowns projected out.

        A strike's residuals are reduced to `BETWEEN` that depend on the parameters as all do together. What
        either flight misses by itself is left out, so that it does not hide an impact that is off.
        """
        if len(self._data.strikes) == 0:
            return []
        values = self._fitting.values(x)
        if self._own is None:
            self._own = self._first(values)
        for _ in range(OWN_ROUNDS):
            base, own = self._by_own(values, spread)
            basis, triangle = np.linalg.qr(own[:, :, :OWN])
            explained = np.einsum("nkj,nk->nj", basis, base)
            self._own[:, :OWN] -= np.linalg.solve(triangle, explained[:, :, None])[:, :, 0]
        base, own = self._by_own(values, spread)
        present = self._own[None]
        slopes = self._fitting.derivatives(x, lambda values: self._residuals(values, present, spread))[1]
        together = np.concatenate([own[:, :, :OWN], slopes, base[:, :, None]], axis=2)
        # Motions of both flights without the coupling by the impact. Another time of the strike then only
        # changes the states of both sides, so its column is left out.
        span = np.linalg.qr(own[:, LAW:, 1:])[0]
        near = np.concatenate([together[:, :LAW], span.transpose(0, 2, 1) @ together[:, LAW:]], axis=1)
        small = triangle_of(_without(near[:, :, OWN:], near[:, :, :OWN]))
        count = len(x)
        # there are as many rows as conditions, so that an observation's size is that of one residual
        rows = max(BETWEEN, small.shape[1])
        residuals, derivatives = np.zeros((len(base), rows)), np.zeros((len(base), rows, count))
        residuals[:, : small.shape[1]] = small[:, :, count]
        derivatives[:, : small.shape[1]] = small[:, :, :count]
        group = Group(residuals=residuals, derivatives=derivatives, clusters=self._data.strikes.recordings)
        return [("trajectories through impacts", group)]

    def _first(self, values: FloatArray) -> FloatArray:
        strikes = self._data.strikes
        own = np.zeros((len(strikes), OWN + APART))
        own[:, 1:4] = strikes.p_W + np.einsum("nij,j->ni", matrices_of(strikes.q_WB), values[:3])
        v, w = velocities_before(values[None], strikes, self._data.gravity)
        own[:, 7:10], own[:, 10:13] = v[0], w[0]
        return own

    def _by_own(self, values: FloatArray, spread: Spread) -> tuple[FloatArray, FloatArray]:
        """Return the residuals, (n, k), and their derivatives by the strikes' own unknowns, (n, k, 25)."""
        assert self._own is not None  # noqa: S101  for the type checker: set by the first call
        moves = DERIVATIVE_STEP * np.eye(OWN + APART + 1, OWN + APART, k=-1)
        found = self._residuals(values[None], self._own + moves[:, None], spread)
        return found[0], np.moveaxis((found[1:] - found[0]) / DERIVATIVE_STEP, 0, 2)

    def _residuals(self, values: FloatArray, own: FloatArray, spread: Spread) -> FloatArray:
        """Return computed less measured poses of both sides, and the law's errors, whitened, (v, n, k).

        ``values`` is (v, p) and ``own`` is (v, n, 25). Either may have one row for all variations.
        """
        described = [self._model.describe(row) for row in values]
        strikes = self._data.strikes
        gravity_W = np.array([self._data.gravity.of(row[:3])[strikes.recordings] for row in values])
        q = turned(np.tile(strikes.q_WB, (len(own), 1)), own[:, :, 4:7].reshape(-1, 3))
        q = q.reshape(len(own), -1, 4)
        v, w = own[:, :, 7:10], own[:, :, 10:13]
        distinct, number = _distinct(q, v, w)
        after = velocities_after(
            described,
            self._model.body.mass_properties.mass,
            q_WB=q[distinct],
            velocities_W=v[distinct],
            spins_W=w[distinct],
            corners=strikes.corners,
            surfaces=strikes.surfaces,
        )
        if len(described) == 1:
            after = after[number]
        spreads = np.repeat([max(spread.velocity, LEAST_LAW_VELOCITY), max(spread.spin, LEAST_LAW_SPIN)], 3)
        after = after + own[:, :, OWN - LAW : OWN] * spreads
        q_apart = turned(q.reshape(-1, 4), own[:, :, OWN + 3 :].reshape(-1, 3)).reshape(q.shape)
        places = (own[:, :, 1:4], own[:, :, 1:4] + own[:, :, OWN : OWN + 3])
        velocities = ((v, w), (after[:, :, :3], after[:, :, 3:]))
        parts = [own[:, :, OWN - LAW : OWN]]
        for k, attitudes in enumerate((q, q_apart)):
            parts += _poses_off(
                self._sides[k],
                self._noise[k],
                described,
                gravity_W,
                since=self._sides[k].since - own[:, :, :1],
                places=places[k],
                attitudes=attitudes,
                velocities=velocities[k],
            )
        variations = max(len(values), len(own))
        return np.concatenate([np.broadcast_to(x, (variations, *x.shape[1:])) for x in parts], axis=2)


def _distinct(*arrays: FloatArray) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return which variations, the rows of arrays, differ from the first, it among them, and their numbers.

    The second array has, for each variation, the place in the first array of the one that it equals.
    """
    differs = np.any([(x != x[0]).any(axis=tuple(range(1, x.ndim))) for x in arrays], axis=0)
    differs[0] = True
    return np.flatnonzero(differs), np.where(differs, np.cumsum(differs) - 1, 0)


def _without(columns: FloatArray, taken: FloatArray) -> FloatArray:
    """Return columns, (n, k, c), without their projection onto the columns of ``taken``, (n, k, j)."""
    basis = np.linalg.qr(taken)[0]
    left: FloatArray = columns - basis @ (basis.transpose(0, 2, 1) @ columns)
    return left


def _poses_off(
    side: _Windows,
    noise: FloatArray,
    described: Sequence[Described],
    gravity_W: FloatArray,
    *,
    since: FloatArray,
    places: FloatArray,
    attitudes: FloatArray,
    velocities: tuple[FloatArray, FloatArray],
) -> list[FloatArray]:
    """Return computed less measured positions and orientations, whitened, (v, n, 3 m) each.

    ``since`` is (v, n, m), s after the strike, and ``noise`` is (n, 2), of positions and orientations. The
    other arrays have a row for each variation and strike: gravity, the true mass centre's place, the
    attitude and both velocities there. One row may stand for all variations.
    """
    n, m = since.shape[1:]
    measured = side.q_WB.reshape(-1, 4)
    q_then = _attitudes_then(described, attitudes, velocities[1], since)
    t = since[:, :, :, None]
    c = places[:, :, None] + t * (velocities[0][:, :, None] + 0.5 * t * gravity_W[:, :, None])
    offsets = matrices_of(measured) @ np.array([d.center for d in described]).T  # (n m, 3, descriptions)
    p = c - np.moveaxis(offsets, 2, 0).reshape(-1, n, m, 3)
    used = side.used[:, :, None]
    p_off = (p - side.p_W) * used / noise[:, None, :1]
    turns = rotation_vectors(q_then.reshape(-1, 4), np.tile(measured, (len(q_then), 1)))
    q_off = turns.reshape(-1, n, m, 3) * used / noise[:, None, 1:]
    return [p_off.reshape(len(p_off), n, -1), q_off.reshape(len(q_off), n, -1)]


def _attitudes_then(
    described: Sequence[Described], q_WB: FloatArray, w_WB_W: FloatArray, since: FloatArray
) -> FloatArray:
    """Return the attitudes of free bodies, (v, n m, 4), at the times ``since``, (v, n, m)."""
    variations = max(len(q_WB), len(w_WB_W), len(since))
    q, w, t = (np.broadcast_to(x, (variations, *x.shape[1:])) for x in (q_WB, w_WB_W, since))
    if len(described) == 1:
        distinct, number = _distinct(q, w, t)
        return _flown(described[0], q[distinct], w[distinct], t[distinct])[number]
    rows = [slice(None) if variations == 1 else slice(i, i + 1) for i in range(len(described))]
    return np.concatenate([_flown(d, q[row], w[row], t[row]) for d, row in zip(described, rows, strict=True)])


def _flown(described: Described, q_WB: FloatArray, w_WB_W: FloatArray, since: FloatArray) -> FloatArray:
    v, n, m = since.shape
    still = np.zeros((v * n * m, 3))
    return states_of_many(
        described.I_B,
        p_WB_W=still,
        q_WB=np.repeat(q_WB.reshape(-1, 4), m, axis=0),
        v_WB_W=still,
        w_WB_W=np.repeat(w_WB_W.reshape(-1, 3), m, axis=0),
        seconds=since.ravel(),
    ).q_WB.reshape(v, n * m, 4)


def _windows(found: Sequence[tuple[MeasuredMotion, slice, float]]) -> _Windows:
    most = max((frames.stop - frames.start for _, frames, _ in found), default=0)
    n = len(found)
    since, p, q, used = (
        np.zeros((n, most)),
        np.zeros((n, most, 3)),
        np.zeros((n, most, 4)),
        np.zeros((n, most)),
    )
    q[:, :, 3] = 1.0
    for i, (motion, frames, time) in enumerate(found):
        count = frames.stop - frames.start
        since[i, :count] = motion.times[frames] - time
        p[i, :count], q[i, :count] = motion.p_WB_W[frames], motion.q_WB[frames]
        used[i, :count] = 1.0
    return _Windows(since, p, q, used)
