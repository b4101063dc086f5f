# SPDX-License-Identifier: Apache-2.0
"""This chapter has planar problems, and the way between space and a plane of motion.

`types` has a planar body, its velocity, contacts and wrench. `projection` turns a question in space into a
planar one, or says by how much it is not planar; `plane_search` finds the plane for that. `lifting` brings a
planar answer back to space, and makes a spatial problem from a planar one. `force_dual` is lecture 26's
picture of planar wrenches.
"""

from contact_dynamics.plane.lifting import planar_in_space
from contact_dynamics.plane.plane_search import best_plane
from contact_dynamics.plane.projection import (
    PlanarProblem,
    PlaneOfMotion,
    out_of_plane_speed,
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
    "out_of_plane_speed",
    "planar_in_space",
    "project_onto_plane",
]

check_types_of(globals())


def __dir__() -> list[str]:
    return __all__
