# SPDX-License-Identifier: Apache-2.0
"""This file resolves many planar impacts, one after the other by the code of one (`routh`)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.impact.energy import ManyEnergies
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.planar.one_contact import refuse_separating
from contact_dynamics.impact.planar.routh import planar_strikes
from contact_dynamics.tolerances import VELOCITY_TOLERANCE
from contact_dynamics.validation import FloatArray, check_magnitude, check_not_negative
from contact_dynamics.validation_batches import (
    check_not_negative_rows,
    check_positive_rows,
    check_rows,
    check_share_rows,
    check_sizes,
    check_unit_rows,
    common_length,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PlanarImpacts(ManyEnergies):
    """Outcomes of N planar impacts. Row i belongs to case i; `PlanarImpact` explains the fields.

    Attributes:
        restitution_law: Law of restitution of all impacts.
        outcomes: (N,), values of ImpactOutcome.
        v: (N, 2), m/s, velocities of the centres of mass after the impacts, axes of the plane.
        w: (N,), rad/s, angular velocities after the impacts.
        impulses_C: (N, 2), N s, total impulses, contact axes.
        compressions_C: (N, 2), N s, impulses up to the end of compression, contact axes.
        velocities_before_C: (N, 2), m/s, velocities of the contacts before, contact axes.
        velocities_after_C: (N, 2), m/s, velocities of the contacts after, contact axes.
    """

    restitution_law: RestitutionLaw
    outcomes: NDArray[np.int64]
    v: FloatArray
    w: FloatArray
    impulses_C: FloatArray
    compressions_C: FloatArray
    velocities_before_C: FloatArray
    velocities_after_C: FloatArray

    def _at_contacts(self) -> tuple[list[FloatArray], ...]:
        return list(self.impulses_C.T), list(self.velocities_before_C.T), list(self.velocities_after_C.T)


def planar_impacts(
    *,
    masses: ArrayLike,
    inertias: ArrayLike,
    v: ArrayLike,
    w: ArrayLike,
    r: ArrayLike,
    normals: ArrayLike,
    frictions: ArrayLike,
    restitutions: ArrayLike,
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
) -> PlanarImpacts:
    """Return the outcomes of N planar impacts. Each is that of `planar_impact`.

    Args:
        masses: (N,) or one number, kg.
        inertias: (N,) or one number, kg m^2, about the centres of mass.
        v: (N, 2) or (2,), m/s, velocities of the centres of mass.
        w: (N,) or one number, rad/s, angular velocities.
        r: (N, 2) or (2,), m, positions of the contacts relative to the centres of mass.
        normals: (N, 2) or (2,), unit normals into the bodies.
        frictions: (N,) or one number, >= 0.
        restitutions: (N,) or one number, in [0, 1].
        restitution_law: Law of restitution, which defines the coefficient of restitution.
        velocity_tolerance: m/s, >= 0. Normal and tangential components of a contact's velocity up to it count
            as zero.

    Raises:
        SeparatingContactError: a contact's normal velocity is above the tolerance; the message names the
            first such contact.
        InvalidFieldError: a number is out of range or exceeds `LARGEST_NUMBER`, or a mass or an inertia is
            below its inverse. The message names the field and the first row.
    """
    tolerance = check_not_negative("velocity_tolerance", velocity_tolerance)
    fields = {
        "masses": check_sizes("masses", check_positive_rows("masses", masses)),
        "inertias": check_sizes("inertias", check_positive_rows("inertias", inertias)),
        "frictions": check_not_negative_rows("frictions", frictions),
        "restitutions": check_share_rows("restitutions", restitutions),
        "v": check_magnitude("v", check_rows("v", v, (2,))),
        "w": check_magnitude("w", check_rows("w", w)),
        "r": check_magnitude("r", check_rows("r", r, (2,))),
        "normals": check_unit_rows("normals", normals, 2),
    }
    count = common_length(fields)
    columns = [np.broadcast_to(column, count) for rows in fields.values() for column in np.atleast_2d(rows.T)]
    outcomes, results, separating = planar_strikes(columns, restitution_law, tolerance)
    if separating is not None:
        case, v_n = separating
        refuse_separating(v_n, tolerance, f" of case {case}")
    return PlanarImpacts(
        restitution_law=restitution_law,
        outcomes=outcomes,
        v=results[:2].T,
        w=results[2],
        impulses_C=results[3:5].T,
        compressions_C=results[5:7].T,
        velocities_before_C=results[7:9].T,
        velocities_after_C=results[9:11].T,
    )
