# SPDX-License-Identifier: Apache-2.0
"""This file answers whether a planar body at rest stays at rest, and what holds it there.

The model is that of `planar_contact_modes`, with the body at rest. Equilibrium is possible if the contact
forces can cancel the applied wrench, which means that the wrench lies in the cone of negated contact
wrenches. It is certain if no other motion is consistent. Otherwise a rigid body may stay or move.

The body is jammed (after Whitney 1982) if friction alone holds it, so that without friction it would move
under the same wrench. It is wedged if the contacts can press against each other without any applied wrench.
Then the wrench does not determine how hard they press. The model does not say how the body came to be
pressed.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from contact_dynamics.contact_modes.letters import STICKS
from contact_dynamics.contact_modes.planar.answer import planar_contact_modes
from contact_dynamics.contact_modes.planar.cone import PolyhedralCone
from contact_dynamics.contact_modes.planar.enumeration import FIXED
from contact_dynamics.contact_modes.planar.judgement import EVIDENCE
from contact_dynamics.contact_modes.planar.problem import (
    AT_REST,
    accuracy_of,
    contact_rows,
    effective_friction,
)
from contact_dynamics.contact_modes.planar.wrench_cone import edge_forces, sharp_reaction
from contact_dynamics.contact_modes.result import BodyStatics, Certainty, ModeVerdict, check_length
from contact_dynamics.errors import UndecidedError
from contact_dynamics.numerics.nonnegative_least_squares import distance_of, exact_combination
from contact_dynamics.numerics.vectors import Vector3, combined, dot, normalised, opposite
from contact_dynamics.tolerances import FORCES_ROUNDING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes.planar.problem import PlanarContactProblem
    from contact_dynamics.contact_modes.result import PlanarMode, PlanarModeAnswer
    from contact_dynamics.plane.types import PlanarContact


def planar_statics(problem: PlanarContactProblem, *, margin_length: float | None = None) -> BodyStatics:
    """Return whether and how well a body at rest stays at rest (`plane_or_space.statics`).

    Source: Mason 5.5 to 6.5 and lecture 26; D. E. Whitney, J. Dyn. Sys. Meas. Control 104 (1982), jamming and
    wedging.
    """
    body, contacts, wrench = problem.body, problem.contacts, problem.wrench
    accuracy = accuracy_of(problem)
    length = check_length(margin_length, body.radius_of_gyration)
    answer = planar_contact_modes(replace(problem, velocity=AT_REST))
    target = (wrench.f[0], wrench.f[1], wrench.moment / length)
    rho = body.radius_of_gyration
    frictions = [effective_friction(contact, rho, contact.holding_friction) for contact in contacts]
    balance = _balance(contacts, frictions, length)
    smooth = _balance(contacts, [0.0] * len(contacts), length)
    equilibrium = _equilibrium(answer, problem)
    held_without = _holds(smooth, target, accuracy)
    return BodyStatics(
        equilibrium=equilibrium,
        jammed=Certainty.NO if held_without else equilibrium,
        # Contact forces can cancel if no half-space has all of them strictly inside.
        wedged=bool(balance.rows) and not balance.has_interior,
        stable_disturbance=math.nan if equilibrium == Certainty.NO else _room(balance, target),
        margin_length=length,
    )


def _balance(contacts: Sequence[PlanarContact], frictions: Sequence[float], length: float) -> PolyhedralCone:
    """Return the dual of the cone of wrenches that contact forces can balance."""
    edges = [
        (*contact_rows(contact, length), force)
        for contact, friction in zip(contacts, frictions, strict=True)
        for force in edge_forces(friction, FIXED)
    ]
    reactions = [normalised(opposite(combined(f_n, N, f_t, T))) for N, T, (f_t, f_n) in edges]
    return PolyhedralCone(reactions, sharp=lambda: [sharp_reaction(*edge) for edge in edges])


def _equilibrium(answer: PlanarModeAnswer, problem: PlanarContactProblem) -> Certainty:
    """Return whether a body stays according to its modes, which statics so never contradict."""
    resting = STICKS * len(problem.contacts)
    if resting in answer.undecided_modes:
        raise UndecidedError(f"whether the body stays is not known: {answer.undecided}")
    fixed = [mode for mode in answer.modes if mode.mode == resting]
    if not any(_stays(mode, problem) for mode in fixed):
        return Certainty.NO
    alone = answer.verdict == ModeVerdict.UNIQUE and fixed[0].motion_unique
    return Certainty.CERTAIN if alone else Certainty.POSSIBLE


def _stays(mode: PlanarMode, problem: PlanarContactProblem) -> bool:
    """Return whether a body does not accelerate in a mode. It may turn about a single place that is fixed."""
    body, wrench = problem.body, problem.wrench
    rho = body.radius_of_gyration
    load = math.hypot(*wrench.f, wrench.moment / rho)
    forces = sum(abs(f_t) + f_n for f_t, f_n in mode.contact_forces)
    size = body.mass * math.hypot(*mode.acceleration, rho * mode.angular_acceleration)
    return size <= EVIDENCE * (accuracy_of(problem) + FORCES_ROUNDING) * (load + forces)


def _holds(balance: PolyhedralCone, target: Vector3, accuracy: float) -> bool:
    """Return whether the cone dual to ``balance`` contains the wrench."""
    tolerance = accuracy * math.sqrt(dot(target, target))
    if balance.exact:
        return distance_of(exact_combination(balance.rows, target), target) <= tolerance
    outside = any(abs(dot(line, target)) > tolerance for line in balance.lineality)
    return not outside and all(dot(facet, target) >= -tolerance for facet in balance.rays)


def _room(balance: PolyhedralCone, target: Vector3) -> float:
    """Return how far inside the cone dual to ``balance`` the wrench lies, N, or 0 on its boundary."""
    if balance.lineality:
        return 0.0
    return max(0.0, min((dot(facet, target) for facet in balance.rays), default=math.inf))
