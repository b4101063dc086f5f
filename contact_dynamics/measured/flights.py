"""This file finds stretches of a recorded toss that one free flight explains.

A flight grows frame by frame. Each new pose is compared with the prediction of the fitted last frames
(`SPAN`). The flight ends where the pose is off by more than noise and an imperfect model explain. A stretch
of at least `SPAN` counts as flight if the body falls in it: its fitted acceleration is nearer to gravity than
to zero, as for a body whose weight is carried. With white noise sigma over n frames and a time T the standard
deviation of that acceleration is sigma sqrt(720 / n) / T^2, which is 0.7 m/s^2 for the recorded brick.

Not covered: flights shorter than `SPAN`, between strikes in quick succession, and impacts that are too gentle
to show within `SPAN`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.measured.flight_fit import fit_flight
from contact_dynamics.rotations.many import rotation_vectors

if TYPE_CHECKING:
    from contact_dynamics.measured.flight_fit import FlightFit
    from contact_dynamics.measured.poses import MeasuredPoses

SPAN: Final = 0.047
"""s. Length of the shortest flight, and of the part of a longer one that predicts its next frame."""

DEVIATIONS: Final = 5.0
"""Number of standard deviations by which a coordinate may miss its prediction. Noise exceeds it once in 1.7
million frames."""

POSITION_SLACK: Final = 5e-4
"""m. Error within `SPAN` that drag, a gravity off by 2 % and a centre of mass off by a millimetre may add."""

ORIENTATION_SLACK: Final = 5e-3
"""rad. Error within `SPAN` that an inertia off by some percent may add."""


def find_flights(poses: MeasuredPoses) -> list[slice]:
    """Return the flights, as slices of frames, in the order of time."""
    shortest = max(5, round(SPAN * poses.rate) + 1)
    flights = []
    begin = 0
    while begin + shortest <= len(poses):
        end = begin + shortest
        stretch = slice(begin, end)
        if not _falls(poses, stretch) or _worst(poses, fit_flight(poses, stretch), stretch) > 1.0:
            begin += 1
            continue
        while end < len(poses):
            fit = fit_flight(poses, slice(end - shortest, end))
            if _worst(poses, fit, slice(end, end + 1)) > 1.0:
                break
            end += 1
        flights.append(slice(begin, end))
        begin = end
    return flights


def _falls(poses: MeasuredPoses, frames: slice) -> bool:
    """Return whether the acceleration along gravity is more than half of it."""
    times = poses.times[frames] - poses.times[frames.start]
    powers = np.column_stack([np.ones_like(times), times, 0.5 * times * times])
    acceleration = np.linalg.lstsq(powers, poses.p_WB_W[frames] @ poses.gravity_W, rcond=None)[0][2]
    return float(acceleration) > 0.5 * float(poses.gravity_W @ poses.gravity_W)


def _worst(poses: MeasuredPoses, fit: FlightFit, frames: slice) -> float:
    """Return the largest deviation of the frames' poses from the fit, as a fraction of what is allowed."""
    expected = fit.poses_at(poses.times[frames])
    p_std = np.hypot(poses.position_noise, expected.position_std)
    q_std = np.hypot(poses.orientation_noise, expected.orientation_std)
    p_off = np.abs(poses.p_WB_W[frames] - expected.p_WB_W).max(axis=1)
    q_off = np.abs(rotation_vectors(poses.q_WB[frames], expected.q_WB))
    p_worst = (p_off / (DEVIATIONS * p_std + POSITION_SLACK)).max()
    q_worst = (q_off / (DEVIATIONS * q_std + ORIENTATION_SLACK)).max()
    return float(max(p_worst, q_worst))
