# SPDX-License-Identifier: Apache-2.0
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

from typing import TYPE_CHECKING, Final

from contact_dynamics.contact_modes.letters import SEPARATES
from contact_dynamics.contact_modes.planar.coincident import coincident
from contact_dynamics.contact_modes.planar.enumeration import kinematic_cells
from contact_dynamics.contact_modes.planar.judgement import Judged, judge_all
from contact_dynamics.contact_modes.planar.one_contact import single_contact_modes
from contact_dynamics.contact_modes.planar.problem import (
    accuracy_of,
    beyond_grip,
    never_slipping,
    planar_case,
)
from contact_dynamics.contact_modes.planar.result import PlanarMode, PlanarModeAnswer
from contact_dynamics.contact_modes.result import SOME_MODE, ModeVerdict, RefusedMode, verdict_on
from contact_dynamics.tolerances import LARGEST_GRIP, LARGEST_PLANAR_ARM

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.planar.enumeration import Cell
    from contact_dynamics.contact_modes.planar.problem import PlanarCase, PlanarContactProblem


_TOO_FAR: Final = (
    f"a contact is more than {LARGEST_PLANAR_ARM:g} radii of gyration away, where rounding decides"
)


def planar_contact_modes(problem: PlanarContactProblem) -> PlanarModeAnswer:
    """Return the verdict on a contact set, all consistent modes, and why the others are refused.

    Without contacts the only mode is the empty string, and the body moves freely.

    Source: lecture 26, table and "Basic approach".
    """
    body, contacts, wrench = problem.body, problem.contacts, problem.wrench
    accuracy = accuracy_of(problem)
    velocities = problem.contact_velocities()
    approaching = tuple([i for i, (_, v_n) in enumerate(velocities) if v_n < 0.0])
    modes: list[PlanarMode] = []
    refused: list[RefusedMode] = []
    undecided = ""
    undecided_modes: list[str] = []
    a_tolerance = 0.0
    if not approaching:
        if all(v_n > 0.0 for _, v_n in velocities):
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
            (modes, refused, undecided_modes), undecided = _judged(case, accuracy)
            if same is not None:
                modes = [same.consistent(mode, accuracy * case.load) for mode in modes]
                refused = [same.refused(mode) for mode in refused]
                undecided_modes = [same.letters_of_all(mode) for mode in undecided_modes]
            a_tolerance = accuracy * case.load / body.mass
    found = tuple(modes)
    verdict = ModeVerdict.UNDECIDED if undecided else verdict_on(found)
    return PlanarModeAnswer(
        verdict=ModeVerdict.IMPACT if approaching else verdict,
        modes=found,
        refused=tuple(refused),
        approaching=approaching,
        contact_velocities=velocities,
        velocity_tolerance=problem.velocity_tolerance,
        acceleration_tolerance=a_tolerance,
        undecided=undecided,
        undecided_modes=tuple(undecided_modes),
        problem=problem,
    )


def _judged(case: PlanarCase, accuracy: float) -> tuple[Judged, str]:
    """Return what mechanics says about all modes of a case, and what is undecided and why."""
    cells = kinematic_cells(case)
    if any(row.size_n > LARGEST_PLANAR_ARM or row.size_t > LARGEST_PLANAR_ARM for row in case.rows):
        return Judged([], [], sorted(cells)), _TOO_FAR
    judged = judge_all(case, cells, accuracy)
    if any(contact.friction > 1.0 and beyond_grip(contact, case.rho) for contact in case.contacts):
        return _whatever_the_grip(case, cells, accuracy, judged)
    if not judged.consistent and case.lift is None and all(row.slides == 0.0 for row in case.rows):
        return Judged([], [], sorted(cells)), SOME_MODE
    if judged.undecided:
        return judged, f"rounding decides whether forces bring about {', '.join(judged.undecided)}"
    return judged, ""


def _whatever_the_grip(
    case: PlanarCase, cells: dict[str, Cell], accuracy: float, judged: Judged
) -> tuple[Judged, str]:
    """Leave those modes undecided that are consistent only with less or only with infinite friction."""
    holding = {mode.mode for mode in judge_all(never_slipping(case), cells, accuracy).consistent}
    doubtful = {mode.mode for mode in judged.consistent}.symmetric_difference(holding).union(judged.undecided)
    if not doubtful:
        return judged, ""
    certain = Judged(
        [mode for mode in judged.consistent if mode.mode not in doubtful],
        [mode for mode in judged.refused if mode.mode not in doubtful],
        sorted(doubtful),
    )
    reason = (
        f"friction beyond {LARGEST_GRIP:g} over the arm in radii of gyration is not told apart, and it "
        f"decides about {', '.join(certain.undecided)}"
    )
    return certain, reason


def _spin(problem: PlanarContactProblem) -> float:
    w = problem.velocity.w
    if w == 0.0:
        return 0.0
    rho = problem.body.radius_of_gyration
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
