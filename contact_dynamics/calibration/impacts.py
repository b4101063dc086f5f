# SPDX-License-Identifier: Apache-2.0
"""Predicts many strikes at once by the impact law, for one or several descriptions of body and surfaces.

They are computed in one batch: a derivative takes a dozen variations of each strike, and a strike in a large
batch takes a tenth of its time in a small one.

The first way of calibration compares the velocities after each strike, as fitted and as predicted (`jumps`).
Its residuals are whitened by the covariance of both sides' velocities, that before the strike propagated
through the impact, and by the law's own spread.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.impact.spatial.batch import StrikingBodies, spatial_impacts
from contact_dynamics.rotations.many import matrices_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.calibration.first_flights import Gravity, IntArray
    from contact_dynamics.calibration.model import Described, Model
    from contact_dynamics.calibration.strikes import Side, Strikes
    from contact_dynamics.validation import FloatArray


def velocities_after(
    described: Sequence[Described],
    mass: float,
    *,
    q_WB: FloatArray,
    velocities_W: FloatArray,
    spins_W: FloatArray,
    corners: IntArray,
    surfaces: IntArray,
) -> FloatArray:
    """Return the velocities after k variations of n strikes, (k, n, 6), m/s and rad/s.

    They are those of the true mass centre, by Poisson's law. A corner that moves away from its surface has no
    impact. ``described``, and the attitudes, (k, n, 4), and velocities, (k, n, 3), before the strikes, may
    have one row for all variations. ``corners`` and ``surfaces``, (n,), are the numbers of what strikes and
    is struck.
    """
    count = len(corners)
    variations = max(len(described), len(q_WB), len(velocities_W), len(spins_W))
    if count == 0:
        return np.zeros((variations, 0, 6))
    whole = (variations, count)
    arms = np.array([d.corners[corners] - d.center for d in described])
    normals = np.array([d.normals[surfaces] for d in described])
    rounding = np.array([d.rounding for d in described])[:, None, None]
    turns = matrices_of(q_WB.reshape(-1, 4)).reshape(-1, count, 3, 3)
    answer = spatial_impacts(
        StrikingBodies(
            masses=mass,
            inertias_B=_rows(np.array([d.I_B for d in described])[:, None], whole),
            q_WB=_rows(q_WB, whole),
            v_WB_W=_rows(velocities_W, whole),
            w_WB_W=_rows(spins_W, whole),
            r_W=_rows(np.einsum("...ij,...j->...i", turns, arms) - rounding * normals, whole),
        ),
        normals_W=_rows(normals, whole),
        frictions=_rows(np.array([d.frictions[surfaces] for d in described]), whole),
        restitutions=_rows(np.array([d.restitutions[surfaces] for d in described]), whole),
        skip_separating=True,
    )
    return np.hstack([answer.v_WB_W, answer.w_WB_W]).reshape(*whole, 6)


def _rows(values: FloatArray, whole: tuple[int, int]) -> FloatArray:
    """Return values of variations and strikes, (k or 1, n or 1, ...), as rows, (k n, ...)."""
    rows: FloatArray = np.broadcast_to(values, (*whole, *values.shape[2:])).reshape(-1, *values.shape[2:])
    return rows


def velocities_before(
    values: FloatArray, strikes: Strikes, gravity: Gravity
) -> tuple[FloatArray, FloatArray]:
    """Return the mass centres' velocities and the spins before the strikes, (k, n, 3) each, for (k, p)."""
    return _velocities(values, strikes, strikes.before, gravity)


def _velocities(
    values: FloatArray, strikes: Strikes, side: Side, gravity: Gravity
) -> tuple[FloatArray, FloatArray]:
    linear = [side.velocities(row[:3], gravity.of(row[:3])[strikes.recordings]) for row in values]
    return np.array(linear), np.array([side.spins(row[4:6]) for row in values])


def jumps(model: Model, values: FloatArray, strikes: Strikes, gravity: Gravity) -> FloatArray:
    """Return predicted less measured velocities after strikes, (k, n, 6), m/s and rad/s, at (k, p)."""
    before = _velocities(values, strikes, strikes.before, gravity)
    after = _velocities(values, strikes, strikes.after, gravity)
    return _predicted(model, values, strikes, *before) - np.concatenate(after, axis=2)


def jump_covariances(model: Model, values: FloatArray, strikes: Strikes, gravity: Gravity) -> FloatArray:
    """Return the covariances, (n, 6, 6), of `jumps` by the noise of measurement."""
    v, w = velocities_before(values[None], strikes, gravity)
    steps = np.hstack([np.repeat(strikes.before.velocity_stds[:, None], 3, axis=1), strikes.before.spin_stds])
    halves = 0.5 * np.eye(6)[:, None] * steps
    moves = np.concatenate([halves, -halves])
    there = _predicted(model, values[None], strikes, v + moves[:, :, :3], w + moves[:, :, 3:])
    through = (there[:6] - there[6:]).transpose(1, 2, 0)  # for one standard deviation
    after = np.hstack([np.repeat(strikes.after.velocity_stds[:, None], 3, axis=1), strikes.after.spin_stds])
    covariances: FloatArray = through @ through.transpose(0, 2, 1)
    covariances[:, np.arange(6), np.arange(6)] += after**2
    return covariances


def _predicted(
    model: Model, values: FloatArray, strikes: Strikes, v: FloatArray, w: FloatArray
) -> FloatArray:
    return velocities_after(
        [model.describe(row) for row in values],
        model.body.mass_properties.mass,
        q_WB=strikes.q_WB[None],
        velocities_W=v,
        spins_W=w,
        corners=strikes.corners,
        surfaces=strikes.surfaces,
    )
