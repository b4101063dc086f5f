# SPDX-License-Identifier: Apache-2.0
"""This file chooses between a plane of motion and space, and projects a question onto its plane."""

from __future__ import annotations

from typing import TYPE_CHECKING

from contact_dynamics.plane.plane_search import project_onto_best_plane
from contact_dynamics.plane.projection import PlanarProblem, PlaneOfMotion, project_onto_plane
from contact_dynamics.records import NamedInt

if TYPE_CHECKING:
    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray


class Problem(NamedInt):
    """Whether a question about contacts is solved in a plane or in space. Messages have the same numbers."""

    AUTOMATIC = 0
    """The question is solved in whichever suits, and the answer says in which. An impact is solved in space,
    which contains the plane."""
    PLANAR = 1
    """The question is solved in a plane of motion through the centre of mass. What leaves the plane is
    refused."""
    SPATIAL = 2


def planar_problem_of(
    body: MassProperties,
    state: BodyState,
    contacts: ContactSet,
    *,
    plane: PlaneOfMotion | None,
    force_W: FloatArray,
    torque_W: FloatArray,
    speed_tolerance: float,
) -> PlanarProblem:
    """Return a problem in a plane of motion. If ``plane`` is None, the best fitting plane is found.

    Raises:
        OutOfPlaneError: something leaves the plane by too much, as in `project_onto_plane` and
            `best_plane`.
    """
    if plane is None:
        return project_onto_best_plane(
            body, state, contacts, force_W=force_W, torque_W=torque_W, speed_tolerance=speed_tolerance
        )
    return project_onto_plane(
        body,
        state,
        contacts,
        plane=plane,
        force_W=force_W,
        torque_W=torque_W,
        speed_tolerance=speed_tolerance,
    )
