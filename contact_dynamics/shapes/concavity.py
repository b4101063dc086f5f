# SPDX-License-Identifier: Apache-2.0
"""Corners given for a convex shape may be those of a concave one. Then its hull is taken, with a warning.

Convex parts instead (`convex.union`) keep the shape.

A corner of a convex body is on its hull's surface: at a corner, on an edge, or in a face that a mesh divides.
One that is clearly inside the hull shows that the body is concave. One in a face may be either: that of an
L-bracket, whose inner corners are in the end faces of its hull, or that of a divided face. If the mass fills
the hull evenly, by its centre and its inertia, it counts as the latter.

Not covered: concave bodies all of whose corners are on edges of the hull, and those whose mass is as that of
the hull. No corners show them.
"""

from __future__ import annotations

import math
import warnings
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.errors import ConcaveShapeWarning, UndecidedError, frames_to_caller
from contact_dynamics.numerics.convex_hull import Hull, hull_of
from contact_dynamics.shapes.convex import MAX_PARTS
from contact_dynamics.tolerances import FLAT_HULL, INSIDE_HULL

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from contact_dynamics.rigid_body.body import MassProperties
    from contact_dynamics.rigid_body.inertia.triangle_mesh import MeshPart
    from contact_dynamics.validation import FloatArray

_FEW: Final = 300
"""Up to this number of corners, the products of all of them are cheap."""

_SAME_CENTER: Final = 0.02
"""Share of the size. A mass that fills the hull has its centre within this of the hull's."""

_SAME_INERTIA: Final = 0.05
"""Share of the largest second moment. A mass that fills the hull has the hull's within this."""


def warn_if_concave(
    name: str,
    vertices_B: FloatArray,
    mass_properties: MassProperties | None = None,
    *,
    divided_faces: bool = True,
) -> None:
    """Warn with `ConcaveShapeWarning` if corners, (k, 3), m, of something named are those of a concave body.

    ``mass_properties`` are those of the body whose centre of mass is the origin. Without them a corner in a
    face counts as that of a divided face, unless there are no ``divided_faces``, as in lists made by hand.
    """
    found = _concave_by(vertices_B, mass_properties, divided_faces=divided_faces)
    if found:
        message = (
            f"{name}: {found}. Its convex hull is taken instead, which touches where the body does not. "
            "Give convex parts (shapes.union, or `parts` in a configuration), or the hull's corners alone"
        )
        warnings.warn(message, ConcaveShapeWarning, stacklevel=frames_to_caller())


def few_parts(name: str, parts: list[MeshPart]) -> list[MeshPart]:
    """Return the parts of a mesh, or one of all corners, with a `ConcaveShapeWarning`, of too many."""
    if len(parts) <= MAX_PARTS:
        return parts
    message = f"{name} has {len(parts)} parts, more than {MAX_PARTS}. Its convex hull is taken instead"
    warnings.warn(message, ConcaveShapeWarning, stacklevel=frames_to_caller())
    return [(np.concatenate([vertices for vertices, _ in parts]), np.zeros((0, 3), dtype=np.int64))]


def _concave_by(
    vertices_B: FloatArray, mass_properties: MassProperties | None, *, divided_faces: bool
) -> str:
    """Return what shows that a body is concave, or an empty text."""
    points = vertices_B - vertices_B.mean(axis=0) if len(vertices_B) else vertices_B
    found = None if len(points) < 4 or _all_extreme(points) else _hull_of(points)
    if found is None:
        return ""
    hull, local, axes = found
    rank, size = len(axes), float(np.linalg.norm(np.ptp(local, axis=0)))
    least = INSIDE_HULL * size
    depths, are_in_faces = _below(hull, local, least)
    inside = int(np.sum(depths > least))
    if rank == 3 and inside > 0:
        return f"{inside} of {len(points)} corners are inside their hull, by up to {depths.max():.3g} m"
    in_faces = inside if rank == 2 else int(np.sum(are_in_faces))
    text = f"{in_faces} of {len(points)} corners are in faces of their hull"
    if mass_properties is None:
        return text if in_faces > 0 and not divided_faces else ""
    center = -vertices_B.mean(axis=0) @ axes.T  # the origin is the centre of mass
    if in_faces == 0 or _fills(hull, local, center, _second_moments(mass_properties, axes)):
        return ""
    return f"{text}, which the mass does not fill evenly"


def _hull_of(points: FloatArray) -> tuple[Hull, FloatArray, FloatArray] | None:
    """Return a hull, the points in its axes, (k, n), and these, (n, 3), of a solid or a plate, or None."""
    _, spread, axes = np.linalg.svd(points, full_matrices=False)
    axes = axes[spread > FLAT_HULL * np.linalg.norm(np.ptp(points, axis=0))]
    local = points @ axes.T
    try:
        return (hull_of("vertices", local), local, axes) if len(axes) > 1 else None
    except UndecidedError:  # flat to rounding
        return None


def _all_extreme(points: FloatArray) -> bool:
    """Return whether each of a few points is the farthest in its own direction, as those of a box are."""
    if len(points) > _FEW:
        return False
    products = points @ points.T
    return bool((products.diagonal() >= products.max(axis=1)).all()) and bool(products.diagonal().all())


def _below(hull: Hull, local: FloatArray, least: float) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return how deep each point is inside the hull, (k,), and whether it is in a face and on no edge, (k,).

    Rounding may lift a point out of its face. Then it is a corner of the hull whose faces are all nearly one.
    """
    normals, offsets = hull.equations[:, :-1], hull.equations[:, -1]
    depths, smallest = np.zeros(len(local)), np.ones(len(local))  # the latter of cosines between normals
    first = np.zeros_like(local)
    for corner in hull.simplices.T:
        first[corner] = normals
    for corner in hull.simplices.T:
        np.minimum.at(smallest, corner, np.einsum("si,si->s", first[corner], normals))
    for index in np.setdiff1d(np.arange(len(local)), hull.vertices):
        gaps = normals @ local[index] + offsets  # to each face, negative inside
        depths[index] = -gaps.max()
        touching = normals[gaps > -least]
        smallest[index] = (touching @ touching[0]).min() if len(touching) else -1.0
    return depths, smallest > math.cos(INSIDE_HULL)


def _second_moments(mass_properties: MassProperties, axes: FloatArray) -> FloatArray:
    """Return the second moments about the centre of mass along axes, (n, 3), per mass, (n, n), m^2."""
    I_B = mass_properties.I_B
    moments: FloatArray = axes @ (0.5 * np.trace(I_B) * np.eye(3) - I_B) @ axes.T / mass_properties.mass
    return moments


def _fills(hull: Hull, local: FloatArray, center: FloatArray, second_moments: FloatArray) -> bool:
    """Return whether a mass is spread as one that fills the hull of points, (k, n), evenly."""
    # The hull is cut into simplices with a corner at the mean of its points, which is the origin.
    corners = local[hull.simplices]
    volumes = np.abs(np.linalg.det(corners))
    sums = corners.sum(axis=1)
    n = local.shape[1]
    total = volumes.sum()
    middle = volumes @ sums / (total * (n + 1))
    squares = np.einsum("s,ski,skj->ij", volumes, corners, corners)
    squares += np.einsum("s,si,sj->ij", volumes, sums, sums)
    even = squares / (total * (n + 1) * (n + 2)) - np.outer(middle, middle)
    size = np.linalg.norm(np.ptp(local, axis=0))
    return bool(
        np.linalg.norm(center - middle) <= _SAME_CENTER * size
        and np.abs(second_moments - even).max() <= _SAME_INERTIA * np.abs(even).max()
    )
