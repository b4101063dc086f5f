# SPDX-License-Identifier: Apache-2.0
"""Estimates velocities as a tracking system does, from past measured poses alone.

Model: over the last few frames each coordinate of the position, and of the rotation vector relative to the
newest orientation, is a quadratic function of time, fitted by least squares. The velocity is the slope of the
quadratic **at the newest frame**, to whose stamp the estimate belongs. This slope has no lag under constant
acceleration, such as that of gravity, whereas the slope of a straight line would lag by half a window.

The disadvantage is noise. For n frames spaced dt with white noise sigma, the standard deviation of the slope
is sigma / dt * sqrt(12 (2n - 1)(8n - 11) / (n (n^2 - 1)(n^2 - 4))), close to sigma / dt * sqrt(192 / n^3).

Not covered: a window that spans an impact averages the velocities before and after it, and such estimates are
wrong by up to the jump until the window has passed. A body that turns by half a turn within one window has no
rotation vector.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.rotations.many import rotation_vectors

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray

WINDOW: Final = 0.05
"""Length of the window, s. It averages the noise of motion capture, and is short compared with flights."""

FEWEST_FRAMES: Final = 5
"""Least number of frames. A quadratic fits three exactly, with all their noise. Five more than halve the
slope's noise."""


def frames_in_window(rate: float) -> int:
    """Return the number of frames in the estimate at ``rate`` (Hz), including the newest."""
    return max(FEWEST_FRAMES, round(rate * WINDOW))


def causal_velocities(
    times: FloatArray, p_W: FloatArray, q: FloatArray, *, frames: int
) -> tuple[FloatArray, FloatArray]:
    """Return linear and angular velocity, (n, 3) each, m/s and rad/s, world axes, of the tracked frame.

    Row k uses rows k - frames + 1 to k of ``times``, (n,), s; ``p_W``, (n, 3), m; and ``q``, (n, 4), x y z w,
    body to world. The first rows use the frames seen so far, if there are at least `FEWEST_FRAMES`. The rows
    before that are NaN.
    """
    v_W = np.full((len(times), 3), np.nan)
    w_W = np.full((len(times), 3), np.nan)
    for newest in range(FEWEST_FRAMES - 1, len(times)):
        window = slice(max(0, newest + 1 - frames), newest + 1)
        v_W[newest], w_W[newest] = newest_velocity(times[window], p_W[window], q[window])
    return v_W, w_W


def newest_velocity(times: FloatArray, p_W: FloatArray, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return linear and angular velocity, (3,) each, at the last of the frames, as `causal_velocities`."""
    return velocity_at(times[-1], times, p_W, q)


def velocity_at(
    seconds: float, times: FloatArray, p_W: FloatArray, q: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return linear and angular velocity, (3,) each, at a time, s, near the frames or among them.

    Frames are given as to `causal_velocities`, at least three of them. The effect of noise grows with
    the distance of the time from the frames.
    """
    nearest = int(np.abs(times - seconds).argmin())
    coordinates = np.column_stack([p_W - p_W[nearest], rotation_vectors(q, q[nearest])])
    slopes = np.linalg.lstsq(_powers(times, seconds), coordinates, rcond=None)[0][1]
    return slopes[:3], slopes[3:]


def slope_weights(times: FloatArray) -> FloatArray:
    """Return the weights, (n,), 1/s, with which the frames enter the velocity at the last of them."""
    weights: FloatArray = np.linalg.pinv(_powers(times, times[-1]))[1]
    return weights


def _powers(times: FloatArray, origin: float) -> FloatArray:
    since = times - origin
    return np.column_stack([np.ones_like(since), since, since * since])


def slope_noise(*, frames: int, rate: float, noise: float) -> float:
    """Return the standard deviation of one component of the estimate, in units of ``noise`` per second.

    ``noise`` is the standard deviation of one coordinate of the poses (m or rad), white from frame to frame
    at ``rate`` (Hz).
    """
    n = float(frames)
    variance = 12.0 * (2.0 * n - 1.0) * (8.0 * n - 11.0) / (n * (n * n - 1.0) * (n * n - 4.0))
    return noise * rate * math.sqrt(variance)
