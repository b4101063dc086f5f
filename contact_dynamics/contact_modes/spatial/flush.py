# SPDX-License-Identifier: Apache-2.0
"""Contacts that are flush but for noise, made exactly flush.

Where normals, or places, are nearly the same, rounding or noise decides how contacts share a load and which
of them leave first, and proofs hang on differences that nobody can measure. So modes are sought for contacts
that lie within a small tolerance of the given ones. Normals and places are stated in axes along two of the
normals. Coordinates along one axis that agree within the tolerance, up to their signs, become one, and those
that vanish within it become zero. So normals that are nearly parallel, opposite or at right angles, and
points that are nearly in one plane, become so exactly.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.numerics.vectors import tangents_towards
from contact_dynamics.tolerances import FLUSH_ROUNDING, OUT_OF_PLANE_RATIO, SAME_DIRECTION

if TYPE_CHECKING:
    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.validation import FloatArray

_ALONG: Final = 0.9
"""A cosine. The component of a normal along an axis counts as close to 1 if it is larger."""

_MOVED: Final = 0.75
"""The share of contacts that are not flush if noise is the reason. By luck one of them may be."""


def made_flush(contacts: ContactSet, centre: FloatArray, within: float) -> ContactSet:
    """Return contacts within a tolerance of the given ones that are flush; the given ones if those are.

    Noise moves them all. Where fewer are not flush, chance made their coordinates nearly the same, and they
    stay as they are.

    Args:
        contacts: The contacts.
        centre: (3,), m, the centre of mass.
        within: rad for normals, and for places a share of the reach, by which coordinates may move.
    """
    if len(contacts) < 2:
        return contacts
    normals, arms = contacts.normals_W, contacts.p_WC_W - centre
    axes = _axes(normals)
    reach = float(np.sqrt((arms * arms).sum(axis=1).max()))
    places = (arms / (reach if reach > 0.0 else 1.0)) @ axes.T
    leaning = normals @ axes.T
    apart = np.diff(np.sort(np.abs(np.hstack([leaning, places])), axis=0), axis=0, prepend=0.0)
    if not np.any((apart > FLUSH_ROUNDING) & (apart <= within)):
        return contacts
    flush_normals, flush_places = (
        np.column_stack([_gathered(along, within) for along in of.T]) for of in (leaning, places)
    )
    # The component along an axis that a normal hardly leans from follows from the others.
    squares = np.where(np.abs(leaning) > _ALONG, 0.0, flush_normals * flush_normals)
    along = np.sqrt(np.maximum(1.0 - squares.sum(axis=1), 0.0))[:, None]
    flush_normals = np.where(np.abs(leaning) > _ALONG, np.copysign(along, leaning), flush_normals)
    flush_normals /= np.sqrt((flush_normals * flush_normals).sum(axis=1))[:, None]
    moved = np.maximum(np.abs(flush_normals - leaning), np.abs(flush_places - places)).max(axis=1)
    if not np.count_nonzero(moved > FLUSH_ROUNDING) >= _MOVED * len(contacts):
        return contacts
    return replace(contacts, p_WC_W=centre + reach * (flush_places @ axes), normals_W=flush_normals @ axes)


def _axes(normals: FloatArray) -> FloatArray:
    """Return orthonormal axes, (3, 3), the first two of them along frequent normals if there are two."""
    one = _most_frequent(normals, np.ones(len(normals), dtype=bool))
    across = normals - (normals @ one)[:, None] * one
    leaning = np.sqrt((across * across).sum(axis=1))
    apart = leaning > OUT_OF_PLANE_RATIO
    if not apart.any():
        return np.array([one, *tangents_towards(one)])
    two = _most_frequent(across / np.where(apart, leaning, 1.0)[:, None], apart)
    two = two - (two @ one) * one
    two /= np.sqrt(two @ two)
    return np.array([one, two, np.cross(one, two)])


def _most_frequent(units: FloatArray, among: np.ndarray) -> FloatArray:
    """Return the mean of the most frequent unit vector, (3,), where opposite ones count as the same."""
    cosines = units @ units.T
    alike = (np.abs(cosines) >= 1.0 - SAME_DIRECTION) & among
    first = int((alike.sum(axis=1) * among).argmax())
    found: FloatArray = (np.sign(cosines[first]) * alike[first]) @ units
    return found / np.sqrt(found @ found)


def _gathered(values: FloatArray, within: float) -> FloatArray:
    """Return values of which those that agree in size, to a tolerance, are one, and zero if they vanish."""
    sizes = np.abs(values)
    order = sizes.argsort()
    ranked = sizes[order]
    groups = np.concatenate([[0], (np.diff(ranked) > within).cumsum()])
    counts = np.bincount(groups)
    means = np.bincount(groups, weights=ranked) / counts
    least = ranked[np.concatenate([[0], counts.cumsum()[:-1]])]
    means[least <= within] = 0.0
    gathered = means[groups]
    off = np.abs(gathered - ranked) > within  # a long row of neighbours stays as it is
    if off.any():
        spoilt = np.isin(groups, groups[off])
        gathered[spoilt] = ranked[spoilt]
    found = np.empty_like(sizes)
    found[order] = gathered
    return np.copysign(found, values)
