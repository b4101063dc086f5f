"""This file outlines a planar body, walls and friction cones, with one mode's letters and forces.

Coordinates are in metres from the centre of mass, x to the right, y up.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.diagrams.shape import FLAT

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes import PlanarMode
    from contact_dynamics.diagrams.shape import Shape
    from contact_dynamics.plane.types import PlanarContact
    from contact_dynamics.validation import FloatArray

CONE_LENGTH: Final = 0.2
"""Length of a friction cone's edges, relative to the body's size."""

ARROW_LENGTH: Final = 0.4
"""Length of the longest arrow of a kind, relative to the body's size."""

LABEL_OFFSET: Final = 0.07
"""Distance of a label from its contact, relative to the body's size."""

_COVERED: Final = 0.13  # labels nearer than this would cover each other, relative to the body's size
_ALIGNED: Final = 0.95  # length of the mean of unit normals that are taken for those of one surface
_SHOWN: Final = 1e-6  # arrows shorter than this are left out, relative to the longest


class Arrows(NamedTuple):
    """The arrows of one kind. Those that are too short to see are left out.

    Attributes:
        contacts: (k,), the contact of each arrow, from 0.
        origins: (k, 2), m.
        vectors: (k, 2), m, as long as they are drawn.
        sizes: (k,), what each stands for, in the unit.
        unit: N or m/s².
    """

    contacts: list[int]
    origins: FloatArray
    vectors: FloatArray
    sizes: FloatArray
    unit: str


class Label(NamedTuple):
    """The label of a contact, or of several at one place.

    Attributes:
        contacts: The contacts, from 0.
        place: (2,), m.
        text: Their numbers from 1, each with its letter if there is a mode.
    """

    contacts: list[int]
    place: FloatArray
    text: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlanarScene:
    """A body and its contacts, m from the centre of mass.

    Attributes:
        outline: (k, 2), of the body, whose last point is its first.
        walls: Strips, (k, 2) each.
        points: (n, 2), the contacts.
        letters: The letter of each contact, or "?" without a mode.
        cones: Friction cones, a strip (3, 2) each.
        labels: The labels of the contacts.
        forces: The contact forces, or None without a mode.
        accelerations: The accelerations of the contacts, or None without a mode.
        size: The size that arrows and cones suit.
    """

    outline: FloatArray
    walls: tuple[FloatArray, ...]
    points: FloatArray
    letters: str
    cones: list[FloatArray]
    labels: list[Label]
    forces: Arrows | None
    accelerations: Arrows | None
    size: float


def planar_scene_of(
    outline: FloatArray,
    contacts: Sequence[PlanarContact],
    *,
    walls: Sequence[FloatArray] = (),
    mode: PlanarMode | None = None,
    size: float | None = None,
) -> PlanarScene:
    """Return a body and its contacts.

    Args:
        outline: (k, 2), m, outline of the body, whose last point is its first.
        contacts: numbered from 1.
        walls: strips, (k, 2) each, m.
        mode: the mode whose letters, contact forces and accelerations are shown, if any.
        size: m, the size that arrows and cones suit. By default it is that of the outline.
    """
    if size is None:
        size = float(np.linalg.norm(np.ptp(outline, axis=0)))
    points = np.array([contact.r for contact in contacts]).reshape(-1, 2)
    normals = np.array([contact.normal for contact in contacts]).reshape(-1, 2)
    letters = mode.mode if mode else "?" * len(contacts)
    places = points - LABEL_OFFSET * size * normals
    return PlanarScene(
        outline=outline,
        walls=tuple(walls),
        points=points,
        letters=letters,
        cones=[cone_edges(contact, length=CONE_LENGTH * size) for contact in contacts],
        labels=[
            Label(same, _place_of(same, points, normals, size), _text_of(same, letters if mode else ""))
            for same in _same_places(places, size)
        ],
        forces=_arrows(mode.contact_forces, contacts, "N", size) if mode else None,
        accelerations=_arrows(mode.contact_accelerations, contacts, "m/s²", size) if mode else None,
        size=size,
    )


def cone_edges(contact: PlanarContact, *, length: float) -> FloatArray:
    """Return a friction cone as a strip, (3, 2), m, with edges of that length, m."""
    angle = math.atan(contact.friction)
    normal, tangent = np.array(contact.normal), np.array(contact.tangent)
    upward, sideways = length * math.cos(angle) * normal, length * math.sin(angle) * tangent
    strip: FloatArray = np.array(contact.r) + np.array([upward + sideways, np.zeros(2), upward - sideways])
    return strip


def silhouette(shape: Shape, axes_B: FloatArray) -> FloatArray:
    """Return a convex shape's outline on two axes, (2, 3), unit, as a closed strip, (k, 2), m."""
    from scipy.spatial import ConvexHull

    corners = np.vstack([shape.triangles_B.reshape(-1, 3), shape.edges_B.reshape(-1, 3)]) @ axes_B.T
    if len(corners) == 0 or np.linalg.matrix_rank(corners - corners[0], tol=FLAT * shape.size) < 2:
        return corners[:2]  # a rod is a line, and so is a disc seen from the side
    hull = ConvexHull(corners).vertices
    strip: FloatArray = corners[[*hull, hull[0]]]
    return strip


def _arrows(
    pairs: Sequence[tuple[float, float]], contacts: Sequence[PlanarContact], unit: str, size: float
) -> Arrows:
    """Return arrows of vectors that are given along the tangent and the normal of each contact."""
    rows = np.array(pairs).reshape(-1, 2)
    points = np.array([contact.r for contact in contacts]).reshape(-1, 2)
    normals = np.array([contact.normal for contact in contacts]).reshape(-1, 2)
    tangents = np.array([contact.tangent for contact in contacts]).reshape(-1, 2)
    vectors = rows[:, :1] * tangents + rows[:, 1:] * normals
    lengths = np.linalg.norm(vectors, axis=1)
    longest = float(lengths.max(initial=0.0))
    chosen = lengths > _SHOWN * longest
    scale = ARROW_LENGTH * size / longest if longest > 0.0 else 0.0
    return Arrows(
        contacts=np.flatnonzero(chosen).tolist(),
        origins=points[chosen],
        vectors=vectors[chosen] * scale,
        sizes=lengths[chosen],
        unit=unit,
    )


def _text_of(contacts: list[int], letters: str) -> str:
    """Return the numbers of contacts from 1, those with the same letter together with it."""
    by_letter: dict[str, list[str]] = {}
    for i in contacts:
        by_letter.setdefault(letters[i] if letters else "", []).append(str(i + 1))
    return "; ".join(f"{', '.join(numbers)} {letter}".rstrip() for letter, numbers in by_letter.items())


def _place_of(contacts: list[int], points: FloatArray, normals: FloatArray, size: float) -> FloatArray:
    """Return the place of a label, (2,), m: behind its contact, or in the corner between two surfaces."""
    outward = -normals[contacts].sum(axis=0)
    aligned = float(np.linalg.norm(outward)) / len(contacts)
    if aligned > _ALIGNED or aligned < 1.0 - _ALIGNED:  # one surface, or two that face each other
        return np.asarray(points[contacts[0]] - LABEL_OFFSET * size * normals[contacts[0]])
    corner = points[contacts].mean(axis=0)
    return np.asarray(corner + 2.0 * LABEL_OFFSET * size * outward / np.linalg.norm(outward))


def _same_places(places: FloatArray, size: float) -> list[list[int]]:
    """Return the indices of places, (k, 2), m, grouped by those whose labels would cover each other."""
    groups: list[list[int]] = []
    for i, place in enumerate(places):
        near = (same for same in groups if np.linalg.norm(places[same[0]] - place) <= _COVERED * size)
        group = next(near, None)
        if group is None:
            groups.append([i])
        else:
            group.append(i)
    return groups
