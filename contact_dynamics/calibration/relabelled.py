# SPDX-License-Identifier: Apache-2.0
"""Recordings that fit better with the body's axes renamed.

A cube whose markers were named anew looks the same: its corners are where they were, and each of its flights
is as free. Only its mass centre is elsewhere in the new axes. So the flights and strikes of each recording
are compared with what the estimate says for the body as it is, and for the body turned onto itself.
"""

from __future__ import annotations

from itertools import permutations, product
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.calibration.impacts import jumps
from contact_dynamics.numerics.clustered_fit import robust_costs
from contact_dynamics.tolerances import SAME_FACE

if TYPE_CHECKING:
    from contact_dynamics.calibration.estimation import Estimation, Fitting
    from contact_dynamics.validation import FloatArray

RENAMED: Final = 20.0
"""Robust sum of squares by which a recording fits better with other names. None of 360 published tosses gains
more than 16."""


def relabelled(fitting: Fitting, found: Estimation, covariances: FloatArray) -> list[int]:
    """Return the numbers of the recordings that fit better with the body's axes renamed.

    ``covariances``, (n, 6, 6), are those of the velocities after the strikes by the noise of measurement.
    """
    model, data, spread = fitting.model, fitting.data, found.spread
    turns = _symmetries(model.vertices, model.body.mass_properties.I_B, SAME_FACE * model.half_size)
    values = np.tile(found.values, (len(turns), 1))
    values[:, :3] = turns @ found.values[:3]
    costs = np.zeros((len(turns), data.clusters))
    whole = covariances + np.diag(np.repeat([spread.velocity**2, spread.spin**2], 3))
    off = np.linalg.solve(
        np.linalg.cholesky(whole), jumps(model, values, data.strikes, data.gravity)[..., None]
    )
    for cost, row, left in zip(costs, values, off[..., 0], strict=True):
        straight = (data.center.at_zero + data.center.slopes @ row[:3]) / spread.flight
        np.add.at(cost, data.strikes.recordings, robust_costs(left))
        np.add.at(cost, data.center.recordings, robust_costs(straight))
    return np.flatnonzero(costs[0] - costs.min(axis=0) > RENAMED).tolist()


def _symmetries(vertices: FloatArray, I_B: FloatArray, near: float) -> FloatArray:
    """Return the rotations among the axes, (k, 3, 3), that turn shape and inertia onto themselves.

    The first one is the identity.
    """
    found = []
    for order in permutations(range(3)):
        for signs in product((1.0, -1.0), repeat=3):
            turn = np.zeros((3, 3))
            turn[range(3), order] = signs
            apart = np.linalg.norm(vertices[:, None] @ turn.T - vertices, axis=2).min(axis=1)
            same_inertia = np.abs(turn @ I_B @ turn.T - I_B).max() < SAME_FACE * np.abs(I_B).max()
            if np.linalg.det(turn) > 0.0 and apart.max() < near and same_inertia:
                found.append(turn)
    return np.array(found)
