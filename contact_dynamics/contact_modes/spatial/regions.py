# SPDX-License-Identifier: Apache-2.0
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

from contact_dynamics.contact_modes.spatial.options import MILDER, acting_edges, ranges_of
from contact_dynamics.numerics.linear_spaces import seen_and_unseen
from contact_dynamics.tolerances import FEASIBLE, ROW_TOLERANCE, STRICT

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from contact_dynamics.validation import FloatArray

_NARROW: Final = 0.32
"""rad. A region of at most three dimensions is not split further if the angles between all its rays are
smaller. This is two fifths of a sector of the usual pyramid. For finer pyramids it is the same part of their
sectors."""

_NARROW_OF_MORE: Final = 0.64
"""rad. The same angle where there are more dimensions, and thus many regions."""

_MOST_RAYS: Final = 24
"""The largest number of rays of a part of a region."""

ONE_BODY: Final = 6
"""The number of components of the motion of one body. Its contacts are taken as one group."""


class Image(NamedTuple):
    """The tangential accelerations of some contacts under the motions in which others stay as well.

    Contacts that move by coordinates of one group do not move by those of others, as interfaces of a stack.
    """

    coordinates: FloatArray  # (p, d), rows that give the coordinates of a motion
    motions: FloatArray  # (p, d), the motions of unit coordinates
    unseen: FloatArray  # (q, d), motions without tangential acceleration
    maps: FloatArray  # (m, 2, p), from coordinates to the contacts' accelerations in their pyramids' frames
    groups: NDArray[np.intp]  # (p,), the group of each coordinate


class Region(NamedTuple):
    """The positive sums of some rays.

    Between rays of different groups nothing but the share of each differs, so that it is not split there.
    """

    rays: FloatArray  # (p, p), one a row
    inside: FloatArray  # (p + 1, p), what is positive in it: the share of each ray, and a height
    groups: NDArray[np.intp]  # (p,), the group of each ray, as an image has it

    def rows(self, image: Image) -> FloatArray:
        """Return the conditions on the motion, (p + 1, d + 1), that it slides, within the region."""
        inside = self.inside / np.sqrt((self.inside * self.inside).sum(axis=1))[:, None]
        found = np.zeros((len(inside), image.coordinates.shape[1] + 1))
        found[:, :-1] = inside @ image.coordinates
        found[-1, -1] = -MILDER * STRICT
        return found

    def halves(self, count: int) -> tuple[Region, Region] | None:
        """Return the halves of the region, or None if it is narrow enough for pyramids of ``count`` edges."""
        narrow = min(_NARROW, 0.8 * math.pi / count) if len(self.rays) <= 3 else _NARROW_OF_MORE
        return self.cut if self.width >= narrow else None

    @property
    def width(self) -> float:
        """The widest angle, rad, between two rays."""
        return self._widest[2]

    @property
    def cut(self) -> tuple[Region, Region]:
        """The halves of the region, cut across its widest edge. It must have more rays than one."""
        one, other, _ = self._widest
        near, far = self.rays.copy(), self.rays.copy()
        near[other] = far[one] = 0.5 * (self.rays[one] + self.rays[other])
        shares, of_near, of_far = self.inside, self.inside.copy(), self.inside.copy()
        of_near[other], of_far[one] = 2.0 * shares[other], 2.0 * shares[one]
        of_near[one] -= shares[other]
        of_far[other] -= shares[one]
        return Region(near, of_near, self.groups), Region(far, of_far, self.groups)

    @property
    def _widest(self) -> tuple[int, int, float]:
        """The two rays of one group that are farthest apart, and the angle between them, rad."""
        unit = self.rays / np.sqrt((self.rays * self.rays).sum(axis=1))[:, None]
        cosines = np.where(self.groups[:, None] == self.groups, unit @ unit.T, 1.0)
        one, other = divmod(int(cosines.argmin()), len(unit))
        apart, between = unit[one] - unit[other], unit[one] + unit[other]
        return one, other, 2.0 * math.atan2(math.sqrt(apart @ apart), math.sqrt(between @ between))

    def part(self, rows: FloatArray) -> FloatArray:
        """Return unit rays, (k, p), whose sums hold what of the region some rows, (m, p), allow."""
        rays: FloatArray = self.rays / np.sqrt((self.rays * self.rays).sum(axis=1))[:, None]
        for row in rows:
            heights = rays @ row
            inside = heights >= -FEASIBLE
            if inside.all() or inside.sum() * (1 + (~inside).sum()) > _MOST_RAYS:
                continue
            near, far = np.maximum(heights[inside], 0.0)[:, None, None], heights[~inside][:, None]
            between = (near * rays[~inside] - far * rays[inside][:, None]).reshape(-1, rays.shape[1])
            between /= np.sqrt((between * between).sum(axis=1))[:, None]
            rays = np.concatenate([rays[inside], between])
        return rays

    def acting_edges(self, image: Image, count: int) -> NDArray[np.bool_]:
        """Return which of ``count`` edges, (m, count), of each contact's pyramid oppose some sliding here."""
        return acting_edges(self.along(image), count)

    def along(self, image: Image) -> FloatArray:
        """Return how each contact slides on each ray, (m, 2, p), or on those of its group together."""
        found: FloatArray = image.maps @ self.rays.T
        if self.groups.any():
            moves = image.maps.any(axis=1) @ (self.groups[:, None] == self.groups)  # with the ray's group
            found = np.where(moves[:, None], found, found.sum(axis=2)[:, :, None])
        return found

    def friction(self, image: Image, tangential: FloatArray) -> FloatArray:
        """Return the power of friction on each ray, for unit normal force at each contact, (m, p).

        Friction acts along the edge, of ``tangential`` components (m, K, 2), that most opposes sliding in the
        middle.
        """
        along = image.maps @ self.rays.T  # (m, 2, p)
        opposing = (tangential @ along.sum(axis=2)[:, :, None])[:, :, 0].argmin(axis=1)
        found: FloatArray = (tangential[np.arange(len(along)), opposing][:, None, :] @ along)[:, 0]
        return found


class Flat(NamedTuple):
    """The motions in which some contacts stick."""

    chosen: tuple[int, ...]  # the contacts that were asked to stick
    stuck: frozenset[int]  # these contacts, and all that stick with them
    rows: FloatArray  # (k, d), combinations of the motion that are zero
    image: Image  # the tangential motions of the contacts that need not stick
    gains: FloatArray | None = None  # (p,), the power of the applied wrench on coordinates; None if it moves
    regions: tuple[Region, ...] = ()  # those that together cover all directions


def flat_of(normals: FloatArray, frames: FloatArray, chosen: tuple[int, ...]) -> Flat:
    """Return the motions in which chosen contacts stick, with the rows of `image_of`."""
    sticking = frames[list(chosen)].reshape(-1, normals.shape[1])
    image = image_of(np.vstack([normals, sticking]), frames)
    moves = np.abs(image.maps).max(axis=(1, 2), initial=0.0) > ROW_TOLERANCE
    stuck = frozenset(np.flatnonzero(~moves).tolist())
    return Flat(chosen, stuck, seen_and_unseen(sticking)[0], image._replace(maps=image.maps[moves]))


def image_of(normals: FloatArray, frames: FloatArray) -> Image:
    """Return the space of common tangential accelerations, (m, 2, d), where normal ones, (k, d), vanish."""
    free = seen_and_unseen(normals)[1]
    along = frames.reshape(-1, normals.shape[1]) @ free.T
    basis, rest = seen_and_unseen(along)
    groups = _groups(along) if normals.shape[1] > ONE_BODY else np.zeros(len(frames), dtype=np.intp)
    if not groups.any():
        coordinates, maps = basis @ free, (along @ basis.T).reshape(len(frames), 2, -1)
        return Image(coordinates, coordinates, rest @ free, maps, np.zeros(len(basis), dtype=np.intp))
    bases = [seen_and_unseen(along[np.repeat(groups == one, 2)])[0] for one in range(groups.max() + 1)]
    owners = np.repeat(np.arange(len(bases)), [len(one) for one in bases])
    stacked = np.vstack(bases)
    own = np.repeat(groups, 2)[:, None] == owners
    maps = np.where(own, along @ stacked.T, 0.0).reshape(len(frames), 2, -1)
    return Image(stacked @ free, np.linalg.pinv(stacked).T @ free, rest @ free, maps, owners)


def _groups(along: FloatArray) -> NDArray[np.intp]:
    """Return the groups, (m,), of contacts that do not move independently, by a projector on all rows."""
    count = len(along) // 2
    projector = np.abs(along @ np.linalg.pinv(along, rcond=ROW_TOLERANCE))
    joined = projector.reshape(count, 2, count, 2).max(axis=(1, 3)) > ROW_TOLERANCE
    found = np.full(count, -1, dtype=np.intp)
    for i in range(count):
        if found[i] < 0:
            reached = joined[i]
            while (further := joined[reached].any(axis=0) | reached).sum() > reached.sum():
                reached = further
            found[reached] = found[i] = found.max() + 1
    return found


def directions(along: FloatArray) -> list[tuple[float, float] | None]:
    """Return the first and the last direction, rad, in which each contact slides in a region.

    It is None where a contact may slide in opposite directions, or stick. On its rays it slides ``along``,
    (m, 2, k).
    """
    starts, ranges, clear = ranges_of(along)
    return [
        (start, start + size) if own else None
        for start, size, own in zip(starts.tolist(), ranges.tolist(), clear.tolist(), strict=True)
    ]


def directions_where_all_slide(maps: FloatArray, rays: FloatArray) -> list[tuple[float, float] | None]:
    """Return what `directions` does on rays, (k, p), without the motions in which a contact sticks."""
    along = maps @ rays.T
    slides = np.sqrt((along * along).sum(axis=1)) > ROW_TOLERANCE * np.linalg.norm(rays, axis=1)
    middle = (along * slides[:, None]).sum(axis=2)
    return directions(np.where(slides[:, None], along, middle[:, :, None]))


def gains_in(image: Image, power: FloatArray, mass: FloatArray) -> FloatArray:
    """Return the power of the applied wrench on unit coordinates, (p,), from that on unit motions, (d,).

    Unseen motions have no part in it, since each motion is taken with those of them that leave it no kinetic
    energy in common with the others.
    """
    unseen = image.unseen @ mass
    rest = np.linalg.solve(unseen @ image.unseen.T, image.unseen @ power)
    gains: FloatArray = image.motions @ (power - rest @ unseen)
    return gains


def whole(image: Image) -> Iterator[Region]:
    """Yield regions that together cover every direction. There are none in a space of no dimensions."""
    dimensions = len(image.coordinates)
    for signs in itertools.product((1.0, -1.0), repeat=dimensions) if dimensions else ():
        rays = np.diag(signs)  # its own inverse
        yield Region(rays, np.concatenate([rays, [signs]]), image.groups)
