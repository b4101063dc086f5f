# SPDX-License-Identifier: Apache-2.0
"""Positive sums of rays and of forces in round friction cones, and the sum that is nearest to a given wrench.

A few edges replace the cones at first. The forces that lead nearer to the target become further edges, until
none does. Then the remainder separates the target from all sums, so that no sum is nearer.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.spatial.cone import nearest_sum
from contact_dynamics.tolerances import NEAREST_GAIN, NEAREST_REACHED, ROW_TOLERANCE

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray

_MAX_ROUNDS: Final = 60
"""Rounds of further edges. Six are enough, and each adds an edge to a cone."""

_START: Final = np.array([[1.0, 0.0], [-0.5, 0.75**0.5], [-0.5, -(0.75**0.5)]])


class RoundSum(NamedTuple):
    """What is summed, in a space of k dimensions.

    Attributes:
        rays: (m, k).
        axes: (n, k), the axes of the cones.
        leans: (n, 2, k). Edges of a cone are its axis plus unit sums of its two leans.
    """

    rays: FloatArray
    axes: FloatArray
    leans: FloatArray

    def rest(self, target: FloatArray) -> FloatArray:
        """Return a target, (k,), less the sum that is nearest to it; zeros if it is a sum to rounding."""
        edges = [self.axes + self.leans[:, 0] * x + self.leans[:, 1] * y for x, y in _START]
        rays = unit_rows(self.rays)
        spans = np.vstack([rays, unit_rows(np.vstack(edges))])
        size = float(np.linalg.norm(target))
        rest, before = target, np.inf
        for _ in range(_MAX_ROUNDS if len(spans) else 0):
            shares, left = nearest_sum(spans, target)
            if left <= NEAREST_REACHED * size:
                return np.zeros_like(target)
            rest = target - shares @ spans
            if len(self.axes) == 0 or left >= before:
                break
            before = left
            along = self.leans @ rest
            sizes = np.sqrt((along * along).sum(axis=1))[:, None]
            along /= np.where(sizes > 0.0, sizes, 1.0)
            best = self.axes + (along[:, None, :] @ self.leans)[:, 0]
            best /= np.sqrt((best * best).sum(axis=1))[:, None]
            gains = best @ rest
            # No sum is nearer by more than the gain of all forces together, were they along the best edge.
            if float(gains.max()) * float(shares.sum()) <= NEAREST_GAIN * left * left:
                break
            helps = gains > 0.0
            shares[: len(rays)] = 1.0  # rays that do not act now may do so with further edges
            spans = np.concatenate([spans[shares > 0.0], best[helps]])
        return rest


def unit_rows(rows: FloatArray) -> FloatArray:
    """Return rows, (m, k), divided by their lengths, without those that vanish."""
    sizes = np.sqrt((rows * rows).sum(axis=1))
    found: FloatArray = rows[sizes > ROW_TOLERANCE] / sizes[sizes > ROW_TOLERANCE, None]
    return found
