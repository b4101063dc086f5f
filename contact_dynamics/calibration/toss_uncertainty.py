# SPDX-License-Identifier: Apache-2.0
"""The uncertainty of calibrated parameters, in the form that sampled tosses take."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.toss import TossUncertainty

if TYPE_CHECKING:
    from contact_dynamics.calibration.result import Calibration


def toss_uncertainty(found: Calibration) -> TossUncertainty:
    """Return the covariance of the parameters of a toss, and the spreads, from a calibration.

    Parameters that were not free, or not determined, count as exact. The friction of sustained contact has
    the standard deviation from slide to slide, and is exact on surfaces without observed slides. Gravity, if
    free, has the scatter from toss to toss.
    """
    names = [
        *(f"friction.{surface.name}" for surface in found.surfaces),
        *(f"restitution.{surface.name}" for surface in found.surfaces),
        *(f"center_of_mass.{axis}" for axis in "xyz"),
        "inertia",
    ]
    at = {estimate.name: k for k, estimate in enumerate(found.estimates)}
    covariance = np.zeros((len(names), len(names)))
    known = [i for i, name in enumerate(names) if name in at]
    columns = [at[names[i]] for i in known]
    # The inertia's factor becomes a relative change of the calibrated inertia.
    units = [
        found.estimates[k].value if names[i] == "inertia" else 1.0
        for i, k in zip(known, columns, strict=True)
    ]
    covariance[np.ix_(known, known)] = found.covariance[np.ix_(columns, columns)] / np.outer(units, units)
    if found.gravity is not None and found.gravity.count > 1:
        whole = np.zeros((len(names) + 3, len(names) + 3))
        whole[: len(names), : len(names)] = covariance
        whole[len(names) :, len(names) :] = found.gravity.covariance_W
        covariance = whole
    spread = found.spread
    return TossUncertainty(
        covariance=covariance,
        velocity=spread.velocity,
        spin=spread.spin,
        height=spread.strike_height,
        lasting_factors=[surface.lasting_factor for surface in found.surfaces],
        lasting_factor_stds=_lasting_stds(found),
    )


def _lasting_stds(found: Calibration) -> list[float]:
    """Return standard deviations of the friction of sustained contact, relative to that of strikes."""
    stds = [0.0] * len(found.surfaces)
    seen = {each.surface: each for each in found.lasting_frictions}
    for k, surface in enumerate(found.surfaces):
        each = seen.get(surface.name)
        if each is not None and surface.friction > 0.0:
            stds[k] = math.hypot(each.scatter, each.std) / surface.friction
    return stds
