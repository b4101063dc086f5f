"""The first way: the velocities after each strike, as fitted and as the law of impact predicts them.

The residuals of a strike are whitened by the covariance of both sides' velocities, of which that before is
carried through the impact, and by the law's own spread.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.calibration.impacts import velocities_after

if TYPE_CHECKING:
    from contact_dynamics.calibration.first_flights import Gravity
    from contact_dynamics.calibration.model import Model
    from contact_dynamics.calibration.strikes import Side, Strikes
    from contact_dynamics.validation import FloatArray


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
    """Return the predicted velocities after the strikes less the measured ones, (k, n, 6), m/s and rad/s.

    Args:
        model: Names the parameters.
        values: (k, p), all parameters, k times.
        strikes: The strikes.
        gravity: Gravity of each recording.
    """
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
