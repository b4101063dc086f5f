"""Directions in which contacts that stay can move together along their surfaces, and simplices of them.

The tangential accelerations of all contacts that stay lie in a space of few dimensions: two for one contact,
three for a body flush on a face however many contacts that has, never above six. A region is a simplicial
cone there, the positive sums of as many rays as there are dimensions. Across a region each contact slides
within an angle, so that only few edges of its pyramid can act: where the whole region can be refused, no
sector of any contact in it need be tried.
"""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.spatial_letters import MILDER, STRICT, acting_edges
from contact_dynamics.tolerances import ROW_TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Iterator

    from contact_dynamics.contact_modes.spatial_letters import Pyramid
    from contact_dynamics.validation import FloatArray

_NARROW: Final = 0.8
"""Cosine between any two rays above which a region is not split further: 37 degrees, a sector or so."""


class Image(NamedTuple):
    """The tangential accelerations of some contacts under the motions in which others stay as well."""

    coordinates: FloatArray  # (p, 6), of a motion
    maps: FloatArray  # (m, 2, p), from coordinates to the contacts' accelerations in their pyramids' frames


class Region(NamedTuple):
    """The positive sums of some rays."""

    rays: FloatArray  # (p, p), one a row
    height: FloatArray  # (p,), a combination of coordinates that is positive in the region

    def rows(self, image: Image) -> FloatArray:
        """Return the conditions on the motion, (p + 1, 7): within the region, and not without sliding."""
        inside = np.vstack([np.linalg.inv(self.rays.T), self.height])
        inside /= np.linalg.norm(inside, axis=1)[:, None]
        found = np.column_stack([inside @ image.coordinates, np.zeros(len(inside))])
        found[-1, -1] = -MILDER * STRICT
        return found

    def halves(self) -> tuple[Region, Region] | None:
        """Return the region cut across its widest edge; None: it is narrow."""
        if len(self.rays) == 1:
            return None
        unit = self.rays / np.linalg.norm(self.rays, axis=1)[:, None]
        cosines = unit @ unit.T
        one, other = divmod(int(cosines.argmin()), len(unit))
        if cosines[one, other] > _NARROW:
            return None
        near, far = self.rays.copy(), self.rays.copy()
        near[other] = far[one] = 0.5 * (self.rays[one] + self.rays[other])
        return Region(near, self.height), Region(far, self.height)

    def silent_edges(self, image: Image, pyramids: list[Pyramid]) -> frozenset[int]:
        """Return the names of the edges that oppose no sliding in the region."""
        silent: list[int] = []
        for directions, pyramid in zip((image.maps @ self.rays.T).tolist(), pyramids, strict=True):
            count = len(pyramid.edges)
            acting = acting_edges(list(zip(*directions, strict=True)), count)
            if acting is not None:
                silent += [pyramid.first + j for j in range(count) if j not in acting]
        return frozenset(silent)


def image_of(normals: FloatArray, frames: FloatArray) -> Image:
    """Return the space of common tangential accelerations.

    Args:
        normals: (k, 6), normal accelerations of the contacts that stay, as functions of the motion.
        frames: (m, 2, 6), tangential ones, of those whose sliding is asked for.
    """
    free = _row_space(normals)[1]
    along = frames.reshape(-1, 6) @ free.T
    basis = _row_space(along)[0]
    return Image(basis @ free, (along @ basis.T).reshape(len(frames), 2, -1))


def whole(dimensions: int) -> Iterator[Region]:
    """Yield regions that together cover every direction; none where there is no dimension."""
    for signs in itertools.product((1.0, -1.0), repeat=dimensions) if dimensions else ():
        yield Region(np.diag(signs), np.array(signs) / math.sqrt(dimensions))


def _row_space(rows: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return orthonormal bases of what the rows see and of what they do not."""
    sizes, basis = np.linalg.svd(rows)[1:]
    seen = int((sizes > ROW_TOLERANCE * max(1.0, sizes.max(initial=0.0))).sum())
    return basis[:seen], basis[seen:]
