# SPDX-License-Identifier: Apache-2.0
"""Planar problems, and the conversion between space and a plane of motion.

`types` contains a planar body, its velocity, contacts and wrench, which lecture 26's force dual represents.
`projection` converts a spatial problem to a planar one, or returns the deviation from the plane;
`plane_search` finds that plane. `lifting` converts a planar answer back to space, and makes a spatial problem
from a planar one.
"""

from contact_dynamics.plane.lifting import planar_in_space
from contact_dynamics.plane.plane_search import best_plane
from contact_dynamics.plane.projection import (
    PlanarProblem,
    PlaneOfMotion,
    project_onto_plane,
)
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from contact_dynamics.validation_types import check_types_of

__all__ = [
    "PlanarBody",
    "PlanarContact",
    "PlanarProblem",
    "PlanarVelocity",
    "PlanarWrench",
    "PlaneOfMotion",
    "best_plane",
    "planar_in_space",
    "project_onto_plane",
]

check_types_of(globals())


def __dir__() -> list[str]:
    return __all__
