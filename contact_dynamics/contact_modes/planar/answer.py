"""Contact modes of one planar body: every mode that is consistent with mechanics (Mason, lecture 26).

Model: a rigid body in the plane that touches the fixed world with Coulomb friction, under an applied wrench.
A contact is a point of the body on a flat of the world, unless its curvatures say otherwise
(`PlanarContact`). A mode hypothesis fixes which contact equations hold; the accelerations that follow are
kept if they contradict no letter. The lecture's table decides, with its strictness: zero normal force is
allowed, `s` needs v_n > 0 or a_n > 0.

A contact's velocity within `velocity_tolerance` counts as zero, and so does an angular velocity that moves no
contact relative to the centre of mass by more than that.

Does not cover: moving surfaces, elastic contacts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from contact_dynamics.contact_modes.planar.coincident import coincident
from contact_dynamics.contact_modes.planar.enumeration import kinematic_cells
from contact_dynamics.contact_modes.planar.judgement import judge_all
from contact_dynamics.contact_modes.planar.one_contact import single_contact_modes
from contact_dynamics.contact_modes.planar.problem import contact_velocities, planar_case
from contact_dynamics.contact_modes.planar.result import (
    ModeVerdict,
    PlanarMode,
    PlanarModeAnswer,
    RefusedMode,
    verdict_on,
)
from contact_dynamics.tolerances import ACCELERATION_TOLERANCE, VELOCITY_TOLERANCE
from contact_dynamics.validation import check_not_negative

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench


def planar_contact_modes(
    body: PlanarBody,
    velocity: PlanarVelocity,
    contacts: Sequence[PlanarContact],
    wrench: PlanarWrench,
    *,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
    acceleration_tolerance: float = ACCELERATION_TOLERANCE,
) -> PlanarModeAnswer:
    """Return the verdict on a contact set, all consistent modes, and why the others are refused.

    Without contacts the one mode is the empty string, free motion.

    Args:
        body: Mass and angular inertia.
        velocity: Of the body.
        contacts: At most `problem.MOST_PLANAR_CONTACTS`; any may coincide, oppose or repeat another.
        wrench: Applied to the body besides its contact forces, gravity included.
        velocity_tolerance: m/s, >= 0. A component of a contact's velocity within it counts as zero.
        acceleration_tolerance: Relative to the applied wrench and the centripetal terms, >= 0: forces and
            accelerations whose sign a change by that part turns count as zero.

    Raises:
        InvalidFieldError: a tolerance is negative.
        TooLargeError: more than `problem.MOST_PLANAR_CONTACTS` contacts.

    Source: lecture 26, table and "Basic approach".
    """
    v_tolerance = check_not_negative("velocity_tolerance", velocity_tolerance)
    accuracy = check_not_negative("acceleration_tolerance", acceleration_tolerance)
    velocities = contact_velocities(velocity, contacts, v_tolerance)
    approaching = tuple(i for i, (_, v_n) in enumerate(velocities) if v_n < 0.0)
    modes: list[PlanarMode] = []
    refused: list[RefusedMode] = []
    a_tolerance = 0.0
    if not approaching:
        touching = [i for i, (_, v_n) in enumerate(velocities) if v_n == 0.0]
        if not touching:
            modes.append(_free_motion(body, contacts, wrench, _spin(body, velocity, contacts, v_tolerance)))
        elif len(contacts) == 1:
            modes, refused, a_tolerance = single_contact_modes(
                body,
                contacts[0],
                wrench,
                v_t=velocities[0][0],
                w=_spin(body, velocity, contacts, v_tolerance),
                accuracy=accuracy,
            )
        else:
            same = coincident(contacts, velocities, body.radius_of_gyration)
            case = planar_case(
                body,
                velocity,
                contacts if same is None else [contacts[i] for i in same.firsts],
                velocities if same is None else [velocities[i] for i in same.firsts],
                wrench,
                velocity_tolerance=v_tolerance,
            )
            modes, refused = judge_all(case, kinematic_cells(case), accuracy)
            if same is not None:
                modes = [same.consistent(mode, accuracy * case.load) for mode in modes]
                refused = [same.refused(mode) for mode in refused]
            a_tolerance = accuracy * case.load / body.mass
    found = tuple(modes)
    return PlanarModeAnswer(
        verdict=ModeVerdict.IMPACT if approaching else verdict_on(found),
        modes=found,
        refused=tuple(refused),
        approaching=approaching,
        contact_velocities=velocities,
        velocity_tolerance=v_tolerance,
        acceleration_tolerance=a_tolerance,
    )


def _spin(
    body: PlanarBody, velocity: PlanarVelocity, contacts: Sequence[PlanarContact], tolerance: float
) -> float:
    rho = body.radius_of_gyration
    if all(abs(velocity.w) * contact.reach(rho) <= tolerance for contact in contacts):
        return 0.0
    return velocity.w


def _free_motion(
    body: PlanarBody, contacts: Sequence[PlanarContact], wrench: PlanarWrench, w: float
) -> PlanarMode:
    a_x = wrench.f[0] / body.mass
    a_y = wrench.f[1] / body.mass
    alpha = wrench.moment / body.inertia
    accelerations = []
    for contact in contacts:
        n_x, n_y = contact.normal
        r_x, r_y = contact.r
        c_x = a_x - alpha * r_y - w * w * r_x
        c_y = a_y + alpha * r_x - w * w * r_y
        accelerations.append((c_x * n_y - c_y * n_x, c_x * n_x + c_y * n_y))
    return PlanarMode(
        mode="s" * len(contacts),
        acceleration=(a_x, a_y),
        angular_acceleration=alpha,
        contact_forces=((0.0, 0.0),) * len(contacts),
        contact_accelerations=tuple(accelerations),
        forces_unique=True,
        motion_unique=True,
    )
