"""Contact modes of one planar body: every mode that is consistent with mechanics (Mason, lecture 26).

Model: a rigid body in the plane, points of which touch flats of the fixed world with Coulomb friction, under
an applied wrench. A mode hypothesis fixes which contact equations hold; the accelerations that follow are
kept if they contradict no letter. The lecture's table decides, with its strictness: zero normal force is
allowed, `s` needs v_n > 0 or a_n > 0.

A contact's velocity within `velocity_tolerance` counts as zero, and so does an angular velocity that moves no
contact relative to the centre of mass by more than that.

Does not cover: a flat of the body on a point of the world, moving surfaces, elastic contacts.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from contact_dynamics.contact_modes.dynamics import solve_mode
from contact_dynamics.contact_modes.enumeration import kinematic_cells
from contact_dynamics.contact_modes.problem import planar_problem
from contact_dynamics.contact_modes.result import (
    ConsistentMode,
    ContactModeAnswer,
    ModeVerdict,
    RefusedMode,
    verdict_on,
)
from contact_dynamics.contact_modes.single import single_contact_modes
from contact_dynamics.errors import TooLargeError
from contact_dynamics.tolerances import ACCELERATION_TOLERANCE, VELOCITY_TOLERANCE
from contact_dynamics.validation import check_not_negative

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes.problem import PlanarProblem
    from contact_dynamics.planar import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench, Vector2

MOST_CONTACTS: Final = 1000
"""Longest list of contacts accepted: the mode strings of n contacts are about 4 n^2 letters."""


def planar_contact_modes(
    body: PlanarBody,
    velocity: PlanarVelocity,
    contacts: Sequence[PlanarContact],
    wrench: PlanarWrench,
    *,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
    acceleration_tolerance: float = ACCELERATION_TOLERANCE,
) -> ContactModeAnswer:
    """Return the verdict on a contact set, all consistent modes, and why the others are refused.

    Without contacts the one mode is the empty string, free motion.

    Args:
        body: Mass and angular inertia.
        velocity: Of the body.
        contacts: At most `MOST_CONTACTS`; any may coincide, oppose or repeat another.
        wrench: Applied to the body besides its contact forces, gravity included.
        velocity_tolerance: m/s, >= 0. A component of a contact's velocity within it counts as zero.
        acceleration_tolerance: Relative to the largest acceleration in the problem, >= 0: what counts as
            zero.

    Raises:
        InvalidFieldError: a tolerance is negative.
        TooLargeError: more than `MOST_CONTACTS` contacts.

    Source: lecture 26, table and "Basic approach".
    """
    v_tolerance = check_not_negative("velocity_tolerance", velocity_tolerance)
    accuracy = check_not_negative("acceleration_tolerance", acceleration_tolerance)
    if len(contacts) > MOST_CONTACTS:
        raise TooLargeError("contacts", f"{len(contacts)} contacts", f"at most {MOST_CONTACTS}")
    velocities = tuple(_contact_velocity(velocity, contact, v_tolerance) for contact in contacts)
    approaching = tuple(i for i, (_, v_n) in enumerate(velocities) if v_n < 0.0)
    w = _angular_velocity(velocity, contacts, v_tolerance)
    modes: list[ConsistentMode] = []
    refused: list[RefusedMode] = []
    a_tolerance = 0.0
    if not approaching:
        touching = [i for i, (_, v_n) in enumerate(velocities) if v_n == 0.0]
        if not touching:
            modes.append(_free_motion(body, contacts, wrench, w))
        elif len(contacts) == 1:
            modes, refused, a_tolerance = single_contact_modes(
                body, contacts[0], wrench, v_t=velocities[0][0], w=w, accuracy=accuracy
            )
        else:
            problem = planar_problem(
                body, velocity, contacts, velocities, wrench, velocity_tolerance=v_tolerance
            )
            modes, refused = _judge_all(problem, accuracy)
            a_tolerance = accuracy * problem.largest_acceleration
    found = tuple(modes)
    return ContactModeAnswer(
        verdict=ModeVerdict.IMPACT if approaching else verdict_on(found),
        modes=found,
        refused=tuple(refused),
        approaching=approaching,
        contact_velocities=velocities,
        velocity_tolerance=v_tolerance,
        acceleration_tolerance=a_tolerance,
    )


def _judge_all(problem: PlanarProblem, accuracy: float) -> tuple[list[ConsistentMode], list[RefusedMode]]:
    consistent: list[ConsistentMode] = []
    refused: list[RefusedMode] = []
    for mode, cell in sorted(kinematic_cells(problem).items()):
        outcome = solve_mode(problem, mode, cell, accuracy)
        if isinstance(outcome, ConsistentMode):
            consistent.append(outcome)
        else:
            refused.append(outcome)
    return consistent, refused


def _contact_velocity(velocity: PlanarVelocity, contact: PlanarContact, tolerance: float) -> Vector2:
    n_x, n_y = contact.normal
    c_x = velocity.v[0] - velocity.w * contact.r[1]
    c_y = velocity.v[1] + velocity.w * contact.r[0]
    v_t = c_x * n_y - c_y * n_x
    v_n = c_x * n_x + c_y * n_y
    return (0.0 if abs(v_t) <= tolerance else v_t, 0.0 if abs(v_n) <= tolerance else v_n)


def _angular_velocity(velocity: PlanarVelocity, contacts: Sequence[PlanarContact], tolerance: float) -> float:
    if all(abs(velocity.w) * math.hypot(*contact.r) <= tolerance for contact in contacts):
        return 0.0
    return velocity.w


def _free_motion(
    body: PlanarBody, contacts: Sequence[PlanarContact], wrench: PlanarWrench, w: float
) -> ConsistentMode:
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
    return ConsistentMode(
        mode="s" * len(contacts),
        acceleration=(a_x, a_y),
        angular_acceleration=alpha,
        contact_forces=((0.0, 0.0),) * len(contacts),
        contact_accelerations=tuple(accelerations),
        forces_unique=True,
        motion_unique=True,
    )
