"""Triangles bound solids: closed meshes, and the convex hull of points.

Density is uniform. Coordinates are in m, so scale a mesh in mm first. `closed_surface` and `mesh_parts` say
what makes a mesh closed and well wound. `polyhedron_integrals` has the integrals.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.errors import InvalidFieldError, UndecidedError
from contact_dynamics.numerics.convex_hull import hull_of
from contact_dynamics.rigid_body.inertia.closed_surface import closed_surface
from contact_dynamics.rigid_body.inertia.distribution import MassDistribution, inertia_of_second_moments
from contact_dynamics.rigid_body.inertia.mass_or_density import mass_of
from contact_dynamics.rigid_body.inertia.mesh_parts import check_facing
from contact_dynamics.rigid_body.inertia.polyhedron_integrals import polyhedron, signed_volumes
from contact_dynamics.tolerances import EPSILON
from contact_dynamics.validation import FloatArray, check_array, check_magnitude

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


def mesh(
    p_FV_F: ArrayLike, triangles: ArrayLike, *, mass: float | None = None, density: float | None = None
) -> MassDistribution:
    """Return the solid inside a closed triangle mesh.

    Several parts and cavities are allowed, and so are flat triangles and repeated vertices.

    Args:
        p_FV_F: (n, 3), m, vertices in F.
        triangles: (m, 3), whole numbers: three vertices each, counter-clockwise seen from outside.
        mass: kg, or None if a density is given.
        density: kg/m^3, or None if a mass is given.

    Raises:
        InvalidFieldError: the mesh is open, has edges of more than two triangles, is not wound one way, is
            inside out or flat, or has a part within a solid: the message names the edge, triangle or volume.
            Or a number is not finite, an index names no vertex, not exactly one of mass and density is given.
    """
    vertices = check_magnitude("p_FV_F", check_array("p_FV_F", p_FV_F, (None, 3)))
    surface = closed_surface(vertices, triangles)
    check_facing(vertices, surface)
    return _solid(vertices, surface.triangles, mass, density)


def convex_hull(
    p_FV_F: ArrayLike, *, mass: float | None = None, density: float | None = None
) -> MassDistribution:
    """Return the solid convex hull of points (n, 3), m, such as a body's vertices.

    Give either ``mass``, kg, or ``density``, kg/m^3.

    Raises:
        InvalidFieldError: the points lie in a plane, a number is not finite, or not exactly one of mass and
            density is given.
    """
    vertices = check_magnitude("p_FV_F", check_array("p_FV_F", p_FV_F, (None, 3)))
    flat = InvalidFieldError("p_FV_F", f"{len(vertices)} points", "four or more, not in one plane")
    if len(vertices) < 4:
        raise flat
    points = vertices - vertices.mean(axis=0)
    thickness = float(np.linalg.svd(points, compute_uv=False)[2])
    if thickness <= EPSILON * len(vertices) * float(np.abs(vertices).max()):
        raise flat
    try:
        triangles = hull_of("p_FV_F", points).simplices
    except UndecidedError:
        raise flat from None
    inward = signed_volumes(points, triangles) < 0.0  # their mean is inside
    triangles[inward] = triangles[inward][:, ::-1]
    return _solid(vertices, triangles, mass, density)


def _solid(
    vertices: FloatArray, triangles: NDArray[np.int64], mass: float | None, density: float | None
) -> MassDistribution:
    inside = polyhedron(vertices, triangles)
    total = mass_of(inside.volume, mass=mass, density=density)
    I_B = inertia_of_second_moments(total / inside.volume * inside.second)
    return MassDistribution(mass=total, p_FB_F=inside.center_F, I_B=I_B)
