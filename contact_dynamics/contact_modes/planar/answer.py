"""This file finds every mode of a planar body that is consistent with mechanics (Mason, lecture 26).

The model is a rigid body in the plane that touches the fixed world with Coulomb friction, under an applied
wrench. A contact is a point of the body on a flat of the world, unless its curvatures say otherwise
(`PlanarContact`). A mode says which contact equations hold. It is kept if the accelerations that follow
contradict none of its letters. The lecture's table decides, and is as strict: a normal force may be zero,
and a contact with the letter `s` needs v_n > 0 or a_n > 0.

A contact's velocity within `velocity_tolerance` counts as zero. An angular velocity counts as zero if it
moves no contact relative to the centre of mass by more than that.

Moving surfaces and elastic contacts are not covered.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from contact_dynamics.contact_modes.letters import SEPARATES
from contact_dynamics.contact_modes.planar.coincident import coincident
from contact_dynamics.contact_modes.planar.enumeration import kinematic_cells
from contact_dynamics.contact_modes.planar.judgement import judge_all
from contact_dynamics.contact_modes.planar.one_contact import single_contact_modes
from contact_dynamics.contact_modes.planar.problem import beyond_grip, planar_case
from contact_dynamics.contact_modes.planar.result import PlanarMode, PlanarModeAnswer
from contact_dynamics.contact_modes.result import ModeVerdict, RefusedMode, verdict_on
from contact_dynamics.errors import UndecidedError
from contact_dynamics.tolerances import LARGEST_GRIP

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.planar.problem import PlanarContactProblem


def planar_contact_modes(problem: PlanarContactProblem) -> PlanarModeAnswer:
    """Return the verdict on a contact set, all consistent modes, and why the others are refused.

    Without contacts the only mode is the empty string, and the body moves freely.

    Raises:
        UndecidedError: no mode is consistent with friction up to `LARGEST_GRIP`, and a contact has more.

    Source: lecture 26, table and "Basic approach".
    """
    body, contacts, wrench = problem.body, problem.contacts, problem.wrench
    accuracy = problem.acceleration_tolerance
    velocities = problem.contact_velocities()
    approaching = tuple(i for i, (_, v_n) in enumerate(velocities) if v_n < 0.0)
    modes: list[PlanarMode] = []
    refused: list[RefusedMode] = []
    a_tolerance = 0.0
    if not approaching:
        touching = [i for i, (_, v_n) in enumerate(velocities) if v_n == 0.0]
        if not touching:
            modes.append(_free_motion(problem))
        elif len(contacts) == 1:
            modes, refused, a_tolerance = single_contact_modes(
                body,
                contacts[0],
                wrench,
                v_t=velocities[0][0],
                w=_spin(problem),
                accuracy=accuracy,
            )
        else:
            same = coincident(contacts, velocities, body.radius_of_gyration)
            case = planar_case(
                problem,
                contacts if same is None else [contacts[i] for i in same.firsts],
                velocities if same is None else [velocities[i] for i in same.firsts],
            )
            modes, refused = judge_all(case, kinematic_cells(case), accuracy)
            if same is not None:
                modes = [same.consistent(mode, accuracy * case.load) for mode in modes]
                refused = [same.refused(mode) for mode in refused]
            a_tolerance = accuracy * case.load / body.mass
            if not modes and any(beyond_grip(contact, case.rho) for contact in contacts):
                raise UndecidedError(
                    "no mode is consistent with friction of at most "
                    f"{LARGEST_GRIP:g} over the arm in radii of gyration, and a contact has more"
                )
    found = tuple(modes)
    return PlanarModeAnswer(
        verdict=ModeVerdict.IMPACT if approaching else verdict_on(found),
        modes=found,
        refused=tuple(refused),
        approaching=approaching,
        contact_velocities=velocities,
        velocity_tolerance=problem.velocity_tolerance,
        acceleration_tolerance=a_tolerance,
    )


def _spin(problem: PlanarContactProblem) -> float:
    rho, w = problem.body.radius_of_gyration, problem.velocity.w
    if all(abs(w) * contact.reach(rho) <= problem.velocity_tolerance for contact in problem.contacts):
        return 0.0
    return w


def _free_motion(problem: PlanarContactProblem) -> PlanarMode:
    body, contacts, wrench, w = problem.body, problem.contacts, problem.wrench, _spin(problem)
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
        mode=SEPARATES * len(contacts),
        acceleration=(a_x, a_y),
        angular_acceleration=alpha,
        contact_forces=((0.0, 0.0),) * len(contacts),
        contact_accelerations=tuple(accelerations),
        forces_unique=True,
        motion_unique=True,
    )
