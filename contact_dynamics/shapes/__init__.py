# SPDX-License-Identifier: Apache-2.0
"""Shapes of bodies and obstacles: convex ones, and unions of them.

`convex` contains the shapes of bodies, from spheres to rounded polyhedra, with a function for each. An
`obstacle` is a convex part of the world with edges and corners. `concavity` warns of corners that are not
those of a convex body. `hull_features` contains the parts of a shape that can touch. `files` reads
bodies from URDF and SDF files and from meshes.
"""

from contact_dynamics.shapes.convex import (
    ConvexShape,
    Rim,
    box,
    box_vertices,
    capsule,
    cone,
    cylinder,
    polygon,
    polyhedron,
    rounded,
    sphere,
    union,
)
from contact_dynamics.shapes.obstacle import Obstacle
from contact_dynamics.validation_types import check_types_of

__all__ = [
    "ConvexShape",
    "Obstacle",
    "Rim",
    "box",
    "box_vertices",
    "capsule",
    "cone",
    "cylinder",
    "polygon",
    "polyhedron",
    "rounded",
    "sphere",
    "union",
]

check_types_of(globals())


def __dir__() -> list[str]:
    return __all__
