# SPDX-License-Identifier: Apache-2.0
"""This file proves that a mode of a body at rest in space is consistent for all contacts in a box.

If contacts stick or separate, and the equations of those that stick are independent, their solution is
enclosed: the inverse of the nominal matrix bounds how far the solution of any matrix in the box is from the
nominal one. All inequalities of the letters must hold for the whole enclosure.

A body that is held by more forces than it has freedoms stays if the true cone of wrenches that contact forces
balance contains the applied wrench. Around it there is a ball of wrenches that the nominal cone contains,
with the least friction of the box. The corners of a cross-polytope around the ball are balanced by forces
that are known, and errors of the contacts move each corner by no more than these forces times the errors. A
convex set that comes as near as this to every point of a ball contains the ball without a shell of that
thickness.

There are no proofs about contacts that slide. They hold everywhere if all other modes are excluded
(`excluded`).
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact.friction import linearised_cone
from contact_dynamics.contact_modes.letters import SEPARATES, STICKS
from contact_dynamics.contact_modes.result import Certainty
from contact_dynamics.contact_modes.spatial.bounds import bounded_body
from contact_dynamics.contact_modes.spatial.statics import spatial_statics
from contact_dynamics.errors import TooLargeError, UndecidedError

if TYPE_CHECKING:
    from contact_dynamics.contact.uncertainty import ContactUncertainty
    from contact_dynamics.contact_modes.spatial.bounds import BoundedBody
    from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem
    from contact_dynamics.validation import FloatArray

_FREEDOMS: Final = 6
"""The freedoms of a body in space."""

_INSIDE: Final = 0.99
"""Share of the largest ball whose wrenches are balanced, so that rounding does not put them outside."""

_BALL_OF_ALL: Final = 4.0
"""Radius of the ball, in sizes of the applied wrench, if contact forces balance every wrench."""


def holds_everywhere(problem: SpatialContactProblem, mode: str, box: ContactUncertainty) -> bool:
    """Return whether it is proven that a consistent mode is consistent everywhere in a box.

    Args:
        problem: The question, of a body at rest that all contacts touch.
        mode: One letter for each contact.
        box: How far the contacts may be from those of the problem.
    """
    body = bounded_body(problem, box)
    if set(mode) <= {STICKS, SEPARATES} and 3 * mode.count(STICKS) <= _FREEDOMS:
        return _solves_everywhere(body, mode)
    return set(mode) == {STICKS} and _rests_everywhere(problem, body)


def _solves_everywhere(body: BoundedBody, mode: str) -> bool:
    sticking = [one for one, letter in zip(body.contacts, mode, strict=True) if letter == STICKS]
    empty = np.zeros((0, _FREEDOMS))
    rows = np.vstack([empty, *(one.rows for one in sticking)])
    off_rows = np.vstack([empty, *(np.tile(one.errors, (3, 1)) for one in sticking)])
    inverse_mass = np.linalg.inv(body.inertia)
    size = abs(inverse_mass)
    free = inverse_mass @ body.wrench
    off_matrix = off_rows @ size @ (abs(rows) + off_rows).T + abs(rows) @ size @ off_rows.T
    try:
        inverse = np.linalg.inv(rows @ inverse_mass @ rows.T)
    except np.linalg.LinAlgError:
        return False
    forces = -inverse @ (rows @ free)
    spread = abs(inverse) @ off_matrix
    if spread.size and spread.sum(axis=1).max() >= 1.0:
        return False
    missed = abs(inverse) @ (off_matrix @ abs(forces) + off_rows @ abs(free))
    off = np.linalg.solve(np.eye(len(forces)) - spread, missed)
    motion = free + inverse_mass @ (forces @ rows)
    off_motion = size @ ((abs(forces) + off) @ off_rows + off @ abs(rows))
    at = 0
    for one, letter in zip(body.contacts, mode, strict=True):
        if letter == SEPARATES:
            least = one.rows[0] @ motion - abs(one.rows[0]) @ off_motion
            if least - one.errors @ (abs(motion) + off_motion) <= 0.0:
                return False
            continue
        (pressing, *across), (off_pressing, *off_across) = forces[at : at + 3], off[at : at + 3]
        if math.hypot(*across) + math.hypot(*off_across) > one.min_friction * (pressing - off_pressing):
            return False
        at += 3
    return True


def _rests_everywhere(problem: SpatialContactProblem, body: BoundedBody) -> bool:
    from scipy.optimize import linprog

    least = np.array([one.min_friction for one in body.contacts])
    slippery = replace(problem, contacts=replace(problem.contacts, frictions=least))
    try:
        held = spatial_statics(slippery)
    except (UndecidedError, TooLargeError):
        return False
    if held.equilibrium == Certainty.NO or held.stable_disturbance == 0.0:
        return False
    radius = _INSIDE * held.stable_disturbance
    if math.isinf(radius):
        radius = _BALL_OF_ALL * (float(np.linalg.norm(body.wrench)) or 1.0)
    edges, costs = [], []
    for one in body.contacts:
        forces = linearised_cone(np.array([1.0, 0.0, 0.0]), one.min_friction, problem.friction_facets)
        edges.append(forces @ one.rows)
        costs.append(math.hypot(one.errors[0], one.errors[-1]) * np.linalg.norm(forces, axis=1))
    U, cost = np.vstack(edges), np.concatenate(costs)
    corners: FloatArray = radius * np.vstack([np.eye(_FREEDOMS), -np.eye(_FREEDOMS)])
    for corner in corners:
        found = linprog(cost, A_eq=U.T, b_eq=-(body.wrench + corner), method="highs")
        if found.x is None or found.fun > radius / math.sqrt(_FREEDOMS):
            return False
    return True
