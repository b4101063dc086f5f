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

from contact_dynamics.contact_modes.planar.answer import planar_contact_modes
from contact_dynamics.contact_modes.planar.cone import PolyhedralCone
from contact_dynamics.contact_modes.planar.friction_edges import sharp_reaction
from contact_dynamics.contact_modes.planar.problem import AT_REST, contact_rows, effective_friction
from contact_dynamics.contact_modes.result import BodyStatics, Certainty, ModeVerdict
from contact_dynamics.numerics.nonnegative_least_squares import distance_from_cone
from contact_dynamics.numerics.vectors import Vector3, dot, normalised
from contact_dynamics.plane.force_dual import friction_cone
from contact_dynamics.validation import check_positive

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes.planar.problem import PlanarContactProblem
    from contact_dynamics.plane.types import PlanarContact


def planar_statics(problem: PlanarContactProblem, *, margin_length: float | None = None) -> BodyStatics:
    """Return whether and how well a body at rest stays at rest.

    Args:
        problem: The question. Its velocity plays no part.
        margin_length: m, > 0. It makes a moment comparable with a force. If it is None, it is the radius of
            gyration.

    Raises:
        InvalidFieldError: the length is not > 0.

    Source: Mason 5.5 to 6.5 and lecture 26; D. E. Whitney, J. Dyn. Sys. Meas. Control 104 (1982), jamming and
    wedging.
    """
    body, contacts, wrench = problem.body, problem.contacts, problem.wrench
    accuracy = problem.acceleration_tolerance
    length = (
        body.radius_of_gyration if margin_length is None else check_positive("margin_length", margin_length)
    )
    answer = planar_contact_modes(replace(problem, velocity=AT_REST))
    target = (wrench.f[0], wrench.f[1], wrench.moment / length)
    balance = _balance(contacts, length)
    smooth = _balance([replace(contact, friction=0.0) for contact in contacts], length)
    room = _room(balance, target, accuracy)
    equilibrium = Certainty.NO
    if room >= 0.0:
        alone = answer.verdict == ModeVerdict.UNIQUE and answer.modes[0].motion_unique
        equilibrium = Certainty.CERTAIN if alone else Certainty.POSSIBLE
    held_without = _room(smooth, target, accuracy) >= 0.0
    return BodyStatics(
        equilibrium=equilibrium,
        jammed=Certainty.NO if held_without else equilibrium,
        wedged=_press_on_each_other(balance),
        stable_disturbance=room if room >= 0.0 else math.nan,
        margin_length=length,
    )


def _balance(contacts: Sequence[PlanarContact], length: float) -> PolyhedralCone:
    """Return the dual of the cone of wrenches that contact forces can balance."""
    gripping = [replace(one, friction=effective_friction(one, length)) for one in contacts]
    pairs = [friction_cone(one) if one.friction > 0.0 else friction_cone(one)[:1] for one in gripping]
    edges = [edge for pair in pairs for edge in pair]
    reactions = [normalised((-edge.f[0], -edge.f[1], -edge.moment / length)) for edge in edges]

    def sharp() -> list[Vector3]:
        return [
            sharp_reaction(*contact_rows(one, length), slope)
            for one, pair in zip(gripping, pairs, strict=True)
            for slope in (one.friction, -one.friction)[: len(pair)]
        ]

    return PolyhedralCone(reactions, sharp=sharp)


def _room(balance: PolyhedralCone, target: Vector3, accuracy: float) -> float:
    """Return how far inside the cone dual to ``balance`` the wrench lies, N, or -1 if it is outside."""
    tolerance = accuracy * math.sqrt(dot(target, target))
    heights = [dot(facet, target) for facet in balance.rays]
    if balance.exact:
        if distance_from_cone(balance.rows, target) > tolerance:
            return -1.0
    elif any(abs(dot(line, target)) > tolerance for line in balance.lineality) or (
        heights and min(heights) < -tolerance
    ):
        return -1.0
    if balance.lineality:
        return 0.0
    return max(0.0, min(heights, default=math.inf))


def _press_on_each_other(balance: PolyhedralCone) -> bool:
    """Return whether some contact forces cancel that are not all zero.

    Some do if no half-space has all of them strictly inside.
    """
    return bool(balance.rows) and not balance.has_interior
