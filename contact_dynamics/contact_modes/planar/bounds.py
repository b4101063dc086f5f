# SPDX-License-Identifier: Apache-2.0
"""If planar contacts are known only to some uncertainty, this file bounds their rows and friction edges.

Every bound holds for each coordinate alone, and for all contacts in the box at once. With an angle of at most
theta between a normal and the true one, the true normal is n cos(phi) + n' sin(phi) with |phi| <= theta,
where n' is n turned by 90 degrees. A point that is off by d changes the moment of a unit force by at most
|d|.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.planar.problem import contact_rows
from contact_dynamics.tolerances import SUM_ROUNDING

if TYPE_CHECKING:
    from contact_dynamics.contact.uncertainty import ContactUncertainty
    from contact_dynamics.contact_modes.planar.problem import PlanarContactProblem
    from contact_dynamics.plane.types import PlanarContact
    from contact_dynamics.validation import FloatArray


class Bounded(NamedTuple):
    """Rows as vectors, (k, 3), and by how much each of their coordinates may be off, (k, 3)."""

    rows: FloatArray
    errors: FloatArray

    @property
    def sizes(self) -> FloatArray:
        """Return the largest length of each row's error, (k,)."""
        sizes: FloatArray = np.linalg.norm(self.errors, axis=1)
        return sizes


class BoundedContact(NamedTuple):
    """One contact of a body at rest, in the coordinates of `problem`.

    Attributes:
        normal: The row of its normal acceleration, and the wrench of a unit normal force.
        tangent: The row of its tangential acceleration, and the wrench of a unit tangential force.
        min_friction: The smallest coefficient of friction in the box.
        max_friction: The largest coefficient of friction in the box.
    """

    normal: Bounded
    tangent: Bounded
    min_friction: float
    max_friction: float

    def edges(self, *slopes: float) -> Bounded:
        """Return the wrenches of forces with f_n = 1 and f_t = each of ``slopes``."""
        factors = np.array(slopes)[:, None]
        return Bounded(
            self.normal.rows + factors * self.tangent.rows,
            self.normal.errors + abs(factors) * self.tangent.errors,
        )


def bounded_contacts(problem: PlanarContactProblem, box: ContactUncertainty) -> list[BoundedContact]:
    """Return the contacts of a problem with bounds that hold in a box."""
    rho = problem.body.radius_of_gyration
    box_of_each = box.of_each(len(problem.contacts))
    return [_bounded(contact, *of, rho) for contact, of in zip(problem.contacts, box_of_each, strict=True)]


def stacked(parts: list[Bounded]) -> Bounded:
    """Return all rows of some parts, which may be none."""
    empty = np.zeros((0, 3))
    return Bounded(
        np.vstack([empty, *(part.rows for part in parts)]),
        np.vstack([empty, *(part.errors for part in parts)]),
    )


def _bounded(
    contact: PlanarContact, points: float, normals: float, frictions: float, rho: float
) -> BoundedContact:
    N, T = (np.array([row]) for row in contact_rows(contact, rho))
    sine, less = math.sin(normals), 1.0 - math.cos(normals)
    moved = np.array([[0.0, 0.0, points / rho]])
    # Turning the normal by 90 degrees makes the tangent of it, and the other way round.
    rounding = SUM_ROUNDING * (abs(N) + abs(T))
    return BoundedContact(
        Bounded(N, sine * abs(T) + less * abs(N) + moved + rounding),
        Bounded(T, sine * abs(N) + less * abs(T) + moved + rounding),
        max(0.0, contact.friction - frictions),
        contact.friction + frictions,
    )
