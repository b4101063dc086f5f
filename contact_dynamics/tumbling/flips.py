# SPDX-License-Identifier: Apache-2.0
"""The times of flips of a body that spins near its middle axis (the Dzhanibekov effect), with deviations.

Lecture 25, polhodes. The body spins about its middle axis for some time, reverses that axis, continues to
spin, and reverses it again. In the middle of a flip, the angular velocity has no component along the middle
axis.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.records import Record
from contact_dynamics.rigid_body.inertia.axes_of_inertia import in_doubles
from contact_dynamics.rotations.one import cross_matrix
from contact_dynamics.tumbling.many import flips_of_many
from contact_dynamics.tumbling.polhode import Regime, Spin, Tumble
from contact_dynamics.validation import check_whole
from contact_dynamics.validation_batches import check_covariance

if TYPE_CHECKING:
    from decimal import Decimal

    from numpy.typing import ArrayLike

    from contact_dynamics.tumbling.motion import FreeMotion
    from contact_dynamics.validation import FloatArray

NEAR_MIDDLE_AXIS: Final = 0.75
"""cos^2 of 30 degrees. Between flips the middle axis must come at least this near to the angular momentum.
Spin about the other axes also has zeros of its middle component, two in each small wobble, but no flips."""

NEAR_SEPARATRIX: Final = 0.1
"""Largest 1 - m of a rotation that flips. There the body stays between flips: half a period is half as long
again as for small m. A nearly axisymmetric rod turns its middle axis over as well, but evenly."""

DRAWS: Final = 500
"""Number of pairs of opposite errors. They determine a deviation to 3 % in about a millisecond."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Flips(Record):
    """Next flips of a body.

    Attributes:
        seconds: (n,), times of the flips, s after the state's stamp, ascending. Empty if there are none.
        deviations: (n,), s, standard deviation of each time, or NaN if the state has no covariance.
    """

    seconds: FloatArray
    deviations: FloatArray


MAX_FLIPS: Final = 10_000
"""Maximum number of flips per call. Their deviations require 80 MB."""


def next_flips(motion: FreeMotion, count: int, *, covariance: ArrayLike | None = None) -> Flips:
    """Return the next ``count`` flips, or fewer: one on the separatrix, and none if the body does not flip.

    The covariance is (12, 12), of position, rotation vector (rad, world axes, applied after the attitude),
    linear and angular velocity. Flip times depend on the logarithm of the distance to the separatrix, so the
    deviations are not linearized: they are those of `DRAWS` pairs of motions, always the same pairs, around
    the given one.

    Raises:
        InvalidFieldError: the count is not a whole number from 0 to `MAX_FLIPS`, or the matrix is not a
            covariance (`validation_batches.check_covariance`).
    """
    count = check_whole("count", count, 0, MAX_FLIPS)
    if covariance is not None:
        covariance = check_covariance("covariance", covariance)
    regime, rotation = motion.regime, motion.rotation
    flips = regime in (Regime.ABOUT_MAJOR_AXIS, Regime.ABOUT_MINOR_AXIS, Regime.SEPARATRIX)
    if (
        not flips
        or isinstance(rotation, Spin)
        or float(rotation.b2) < NEAR_MIDDLE_AXIS
        or float(rotation.m1) > NEAR_SEPARATRIX
    ):
        return Flips(seconds=np.zeros(0), deviations=np.zeros(0))
    times = _flip_times(rotation, count, from_seconds=0.0)
    if covariance is None or len(times) == 0:
        return Flips(seconds=times, deviations=np.full(len(times), math.nan))
    spread = _covariance_in_body(motion, covariance)
    return Flips(seconds=times, deviations=_deviations(motion, spread, times))


def _flip_times(rotation: Tumble[Decimal] | Tumble[float], count: int, *, from_seconds: float) -> FloatArray:
    """Return the first flips at or after a time, s: u = 2 n K, for whole n."""
    first = -float(rotation.u0) / float(rotation.omega_p)
    if rotation.m1 == 0:
        return np.array([first])[: count if first >= from_seconds else 0]
    between = math.pi / (float(rotation.quarter) * abs(float(rotation.omega_p)))
    first += between * math.ceil((from_seconds - first) / between)
    return np.array([first + between * i for i in range(count)])


def _covariance_in_body(motion: FreeMotion, covariance: FloatArray) -> FloatArray:
    """Return the covariance (3, 3) of the angular velocity in body axes, on which flip times depend alone."""
    rows = np.r_[3:6, 9:12]
    turned = cross_matrix(motion.state.w_WB_W)  # by an error of the attitude
    onto_body = motion.state.R_WB.T @ np.hstack([turned, np.eye(3)])
    spread: FloatArray = onto_body @ covariance[np.ix_(rows, rows)] @ onto_body.T
    return spread


def _deviations(motion: FreeMotion, spread: FloatArray, times: FloatArray) -> FloatArray:
    """Return the deviations, (n,), s, of the flips nearest to ``times``, for angular velocities so spread."""
    frame = in_doubles(motion.frame)
    first, second = np.array(frame.axes_B[0]), np.array(frame.axes_B[1])
    R_BP = np.column_stack([first, second, np.cross(first, second)])
    variances, directions = np.linalg.eigh(spread)
    draws = np.random.default_rng(0).normal(size=(DRAWS, 3))
    steps = (draws * np.sqrt(np.maximum(variances, 0.0))) @ directions.T
    w_B = motion.state.R_WB.T @ motion.state.w_WB_W
    one, between = flips_of_many(frame.moments, np.vstack([w_B + steps, w_B - steps]) @ R_BP)
    nearest = one + between * np.rint((times[0] - one) / between)
    later = nearest[:, None] + between[:, None] * np.arange(len(times))
    deviations: FloatArray = later.std(axis=0)
    return deviations
