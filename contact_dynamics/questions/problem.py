"""Whether a question is about a plane of motion or about space, and the problem in its plane."""

from __future__ import annotations

from typing import TYPE_CHECKING

from contact_dynamics.plane.projection import PlanarProblem, PlaneOfMotion, best_plane, project_onto_plane
from contact_dynamics.records import NamedInt

if TYPE_CHECKING:
    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray


class Problem(NamedInt):
    """What a question about contacts is solved in; the numbers are those of the services."""

    AUTOMATIC = 0
    """Whichever suits; the answer says which. An impact is then solved in space, which contains the plane."""
    PLANAR = 1
    """A plane of motion through the centre of mass; what leaves it is refused."""
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
    """Return a problem in a plane of motion; None: in the plane that fits best.

    Raises:
        OutOfPlaneError: something leaves the plane by too much, as `project` and `best_plane`.
    """
    if plane is None:
        plane = best_plane(
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
