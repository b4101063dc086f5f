"""What the letters of one contact in space ask for: separate, stick, or slide within which sector.

Unknowns are the edge forces of all contacts' friction pyramids. Letters come in groups, a tree whose leaves
are letters and whose groups ask for no more than each of their letters does, so that a group which cannot
hold ends the trial of all its letters (`spatial_dynamics`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray


class Trial(NamedTuple):
    """A letter of one contact, or several together; rows act on the edge forces and end in a constant."""

    letter: str  # c also for an arc of sliding directions; empty: several
    silent: list[int]  # edge forces that are zero
    zero: FloatArray  # (k, K + 1)
    positive: FloatArray  # (k, K + 1), strictly where it is a letter
    parts: list[Trial]  # the letters that it stands for, in groups; empty where it is a letter


def any_letter(tangential: FloatArray, own: list[int], normal: FloatArray, point: FloatArray) -> Trial:
    """Return all letters of one touching contact, with ``tangential`` the edges' parts along the surface."""
    nothing = np.zeros((0, len(normal)))
    separates = Trial("s", own, nothing, normal[None, :], [])
    if len(own) == 1:
        stays = Trial("c", [], normal[None, :], nothing, [])
    else:
        along = (tangential / np.linalg.norm(tangential, axis=1)[:, None]) @ point
        sticks = Trial("f", [], np.vstack([normal, _across(tangential, point)]), nothing, [])
        # Sectors and borders alternate around the circle; no arc may be wider than a third of it.
        arcs = np.array_split(np.arange(2 * len(own)), len(own) if len(own) < 6 else 4)
        slides = [_slides(arc.tolist(), own, normal, along) for arc in arcs]
        stays = Trial("", [], normal[None, :], nothing, [sticks, *slides])
    return Trial("", [], nothing, normal[None, :], [separates, stays])


def _slides(arc: list[int], own: list[int], normal: FloatArray, along: FloatArray) -> Trial:
    """Return the letters of sliding within an arc: 2 j is the sector of edge j, 2 j + 1 its far border.

    The edge that opposes the sliding most has the least product with it, alone or with its neighbour.
    """
    count = len(own)
    first, last = arc[0], arc[-1]
    acting = {(item + side) // 2 % count for item in arc for side in (0, 1)}
    silent = [edge for j, edge in enumerate(own) if j not in acting]
    if len(arc) > 1:
        low, high = (first - 1) // 2, last // 2
        middle = -np.mean([along[item // 2] for item in arc if item % 2 == 0], axis=0)
        sides = [
            along[low % count] - along[(low + 1) % count],
            along[(high + 1) % count] - along[high % count],
        ]
        parts = [_slides(half, own, normal, along) for half in (arc[: len(arc) // 2], arc[len(arc) // 2 :])]
        return Trial("c", silent, normal[None, :], np.array([middle, *sides]), parts)
    j, k = first // 2, (first + 1) // 2 % count
    sides = [along[(j - 1) % count] - along[j], along[(k + 1) % count] - along[k]]
    zero = normal[None, :] if j == k else np.array([normal, along[j] - along[k]])
    return Trial("c", silent, zero, np.array(sides), [])


def _across(tangential: FloatArray, point: FloatArray) -> FloatArray:
    """Return the contact's acceleration along two orthonormal tangents, (2, K + 1)."""
    tangents: FloatArray = np.linalg.svd(tangential)[2][:2]
    return tangents @ point
