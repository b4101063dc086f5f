# SPDX-License-Identifier: Apache-2.0
"""Estimates gravity for each recording, the mass centre and the ratios of the moments from first flights.

With c = p + R d the path of the mass centre, d its offset in body axes and R as measured, c is a parabola.
This is linear in its start, its velocity, gravity g and d. All but d are projected out, recording by
recording, which leaves three residuals that depend on d alone, and g follows for any d. Only first flights
are used: vibrations after a strike would bias gravity and mass centre.

The rotation is fitted by `fit_free_motion` for inertias near the present one. The change of its residuals is
projected the same way.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from contact_dynamics.motion.free_fit import fit_free_motion
from contact_dynamics.motion.state_noise import StateNoise
from contact_dynamics.numerics.linear_spaces import triangle_of
from contact_dynamics.questions.uncertain_state import state_of
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import MassProperties
from contact_dynamics.rotations.many import matrices_of
from contact_dynamics.tolerances import SMALLEST

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.calibration.model import Model
    from contact_dynamics.calibration.observed import Observed
    from contact_dynamics.validation import FloatArray

IntArray: TypeAlias = NDArray[np.intp]  # numbers of recordings, surfaces or corners


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Gravity(Record):
    """Gravity of each recording for any mass centre: gravity + by_center @ d."""

    gravity_W: FloatArray  # (m, 3), m/s^2, for the configured mass centre, in each recording's world axes
    by_center: FloatArray  # (m, 3, 3), 1/s^2
    # (m,), m/s^2, standard deviation of a component, by the noise of positions; NaN where it is not measured
    # but taken from the configuration.
    std: FloatArray

    def of(self, center: FloatArray) -> FloatArray:
        """Return gravity, (m, 3), m/s^2, for a mass centre, (3,), m."""
        gravity: FloatArray = self.gravity_W + self.by_center @ center
        return gravity


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Straightness(Record):
    """Three residuals of each of n flights, linear in some parameters: at_zero + slopes @ x, whitened."""

    at_zero: FloatArray  # (n, 3)
    slopes: FloatArray  # (n, 3, k)
    recordings: IntArray  # (n,), numbers of the recordings


def gravity_and_center(
    observed: Sequence[Observed], *, gravity_is_free: bool
) -> tuple[Gravity, Straightness]:
    """Return gravity for each recording, and residuals in the mass centre, (3,), m, from the configured one.

    A recording without a first flight takes the mean gravity of the others, or else the configured one.
    """
    gravities = np.array([each.motion.gravity_W for each in observed])
    by_center = np.zeros((len(observed), 3, 3))
    std = np.full(len(observed), np.nan)
    rows, slopes, numbers = [], [], []
    for number, each in enumerate(observed):
        if each.first is None:
            continue
        motion = each.motion
        times = motion.times[each.first] - motion.times[each.first].mean()
        powers = np.column_stack([np.ones_like(times), times, 0.5 * times * times])
        p, R = motion.p_WB_W[each.first], matrices_of(motion.q_WB[each.first])
        if gravity_is_free:
            inverse = np.linalg.pinv(powers)
            gravities[number] = inverse[2] @ p
            by_center[number] = np.einsum("n,nij->ij", inverse[2], R)
            std[number] = motion.position_noise * float(np.linalg.norm(inverse[2]))
        else:
            p = p - powers[:, 2:] * motion.gravity_W
            powers = powers[:, :2]
        basis = np.linalg.qr(powers)[0]
        both = np.concatenate([R, p[:, :, None]], axis=2)  # (n, 3, 4)
        left = (both - np.einsum("nr,mr,mij->nij", basis, basis, both)).reshape(-1, 4)
        small = triangle_of(left)[:3] / motion.position_noise
        slopes.append(small[:, :3])
        rows.append(small[:, 3])
        numbers.append(number)
    found = Straightness(
        at_zero=np.array(rows).reshape(-1, 3),
        slopes=np.array(slopes).reshape(-1, 3, 3),
        recordings=np.array(numbers, dtype=int),
    )
    measured = np.flatnonzero(~np.isnan(std))
    if gravity_is_free and len(measured):
        lacking = np.isnan(std)
        gravities[lacking] = gravities[measured].mean(axis=0)
        by_center[lacking] = by_center[measured].mean(axis=0)
    return Gravity(gravity_W=gravities, by_center=by_center, std=std), found


def ratios_of_moments(observed: Sequence[Observed], model: Model, values: FloatArray) -> Straightness:
    """Return residuals in the logarithms of two ratios of moments, from rotations of first flights.

    They are linear near those of ``values``, (p,), all parameters.
    """
    rows, slopes, numbers = [], [], []
    near = model.near_ratios(values)
    inertias = [model.describe(values).I_B]
    for k, log in np.ndindex(2, 2):
        there = values.copy()
        there[4 + k] = near[k, log]
        inertias.append(model.describe(there).I_B)
    for number, each in enumerate(observed):
        if each.first is None:
            continue
        motion = each.motion
        states = [state_of(state) for state in motion.states(range(each.first.start, each.first.stop))]
        noise = StateNoise(position=motion.position_noise, orientation=motion.orientation_noise)
        mass = motion.body.mass_properties.mass
        misses = [
            fit_free_motion(
                MassProperties(mass=mass, I_B=I_B), states, gravity_W=motion.gravity_W, noise=noise
            ).orientation_misses_W.ravel()
            for I_B in inertias
        ]
        by_ratio = [(misses[2 * k + 2] - misses[2 * k + 1]) / max(np.ptp(near[k]), SMALLEST) for k in (0, 1)]
        at_zero = misses[0] - np.column_stack(by_ratio) @ values[4:6]
        small = triangle_of(np.column_stack([*by_ratio, at_zero])) / motion.orientation_noise
        slopes.append(small[:3, :2])
        rows.append(small[:3, 2])
        numbers.append(number)
    return Straightness(
        at_zero=np.array(rows).reshape(-1, 3),
        slopes=np.array(slopes).reshape(-1, 3, 2),
        recordings=np.array(numbers, dtype=int),
    )
