# SPDX-License-Identifier: Apache-2.0
"""Heights of corners above surfaces where they should be zero: at strikes, and at rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.records import Record
from contact_dynamics.rotations.many import matrices_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.calibration.first_flights import IntArray
    from contact_dynamics.calibration.model import Described
    from contact_dynamics.calibration.observed import Observed
    from contact_dynamics.validation import FloatArray

SAME_HEIGHT: Final = 0.15
"""Share of the half size within which the lowest corners at rest count as one face or edge."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Touching(Record):
    """Corners that touch at n moments: those at rest, and those that strike.

    Attributes:
        recordings: (n,), numbers of the recordings. surfaces: (n,), of the surfaces. corners: (n,), of the
        corners. p_W: (n, 3), m, places of the configured mass centre. q_WB: (n, 4). stds: (n,), m, of a
        height by the noise of measurement.
    """

    recordings: IntArray
    surfaces: IntArray
    corners: IntArray
    p_W: FloatArray
    q_WB: FloatArray
    stds: FloatArray

    def __len__(self) -> int:
        """Return the number of moments."""
        return len(self.recordings)

    def heights(self, described: Described) -> FloatArray:
        """Return the corners' heights above their surfaces, (n,), m."""
        points = self.p_W + np.einsum("nij,nj->ni", matrices_of(self.q_WB), described.corners[self.corners])
        above = np.einsum(
            "ni,ni->n", points - described.points[self.surfaces], described.normals[self.surfaces]
        )
        heights: FloatArray = above - described.rounding
        return heights


def at_rests(observed: Sequence[Observed], described: Described, half_size: float) -> Touching:
    """Return the corners on which the bodies rest, those within `SAME_HEIGHT` of the lowest one."""
    rows = []
    for number, each in enumerate(observed):
        if each.rest is None or len(described.points) == 0:
            continue
        state, surface = each.rest.state, each.rest_surface
        points = state.p_WB_W + described.corners @ state.R_WB.T
        heights = (points - described.points[surface]) @ described.normals[surface]
        low = np.flatnonzero(heights < heights.min() + SAME_HEIGHT * half_size)
        std = np.hypot(each.rest.position_std, half_size * each.rest.orientation_std.max())
        rows += [(number, surface, int(k), state.p_WB_W, state.q_WB, std) for k in low]
    return Touching(
        recordings=np.array([row[0] for row in rows], dtype=int),
        surfaces=np.array([row[1] for row in rows], dtype=int),
        corners=np.array([row[2] for row in rows], dtype=int),
        p_W=np.array([row[3] for row in rows]).reshape(-1, 3),
        q_WB=np.array([row[4] for row in rows]).reshape(-1, 4),
        stds=np.array([row[5] for row in rows], dtype=float),
    )
