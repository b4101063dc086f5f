# SPDX-License-Identifier: Apache-2.0
"""This file proves that a planar mode of a body at rest is consistent for all contacts in a box.

If the equations of the mode are independent, their solution is enclosed: the inverse of the nominal matrix
bounds how far the solution of any matrix in the box is from the nominal one. All inequalities of the letters
must hold for the whole enclosure.

A body that is held by more forces than it has freedoms stays if the true cone of wrenches that contact forces
balance contains the applied wrench. Around it there is a ball of wrenches that the nominal cone contains,
with the least friction of the box. The corners of an octahedron around the ball are balanced by forces that
are known, and errors of the contacts move each corner by no more than these forces times the errors. A convex
set that comes as near as this to every point of a ball contains the ball without a shell of that thickness.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact_modes.letters import SEPARATES, SLIDES_LEFT, STICKS
from contact_dynamics.contact_modes.planar.bounds import Bounded, BoundedContact, bounded_contacts, stacked
from contact_dynamics.contact_modes.planar.statics import planar_statics
from contact_dynamics.contact_modes.result import Certainty
from contact_dynamics.errors import UndecidedError

if TYPE_CHECKING:
    from contact_dynamics.contact.uncertainty import ContactUncertainty
    from contact_dynamics.contact_modes.planar.problem import PlanarContactProblem
    from contact_dynamics.contact_modes.planar.result import PlanarMode
    from contact_dynamics.validation import FloatArray

_MAX_EQUATIONS: Final = 3
"""A planar body has three freedoms."""

_INSIDE: Final = 0.99
"""Share of the largest ball whose wrenches are balanced, so that rounding does not put them outside."""

_BALL_OF_ALL: Final = 4.0
"""Radius of the ball, in sizes of the applied wrench, if contact forces balance every wrench."""


def holds_everywhere(problem: PlanarContactProblem, mode: PlanarMode, box: ContactUncertainty) -> bool:
    """Return whether it is proven that a consistent mode is consistent everywhere in a box."""
    contacts = bounded_contacts(problem, box)
    equations = sum({SEPARATES: 0, STICKS: 2}.get(letter, 1) for letter in mode.mode)
    if equations <= _MAX_EQUATIONS:
        return _solves_everywhere(problem, mode.mode, contacts)
    return set(mode.mode) == {STICKS} and _rests_everywhere(problem, box, contacts)


def applied_wrench(problem: PlanarContactProblem) -> FloatArray:
    """Return the applied wrench, (3,), N, with its moment divided by the radius of gyration."""
    wrench = problem.wrench
    return np.array([*wrench.f, wrench.moment / problem.body.radius_of_gyration])


def _solves_everywhere(problem: PlanarContactProblem, mode: str, contacts: list[BoundedContact]) -> bool:
    w = applied_wrench(problem)
    rows, wrenches = [], []
    for letter, contact in zip(mode, contacts, strict=True):
        if letter == STICKS:
            rows += [contact.normal, contact.tangent]
            wrenches += [contact.normal, contact.tangent]
        elif letter != SEPARATES:
            middle = 0.5 * (contact.min_friction + contact.max_friction)
            edge = contact.edges(middle if letter == SLIDES_LEFT else -middle)
            spread = 0.5 * (contact.max_friction - contact.min_friction)
            largest = abs(contact.tangent.rows) + contact.tangent.errors
            rows.append(contact.normal)
            wrenches.append(Bounded(edge.rows, edge.errors + spread * largest))
    R, U = stacked(rows), stacked(wrenches)
    A = R.rows @ U.rows.T
    errors = R.errors @ abs(U.rows).T + (abs(R.rows) + R.errors) @ U.errors.T
    try:
        inverse = np.linalg.inv(A)
    except np.linalg.LinAlgError:
        return False
    x = -inverse @ (R.rows @ w)
    spread_of = abs(inverse) @ errors
    if spread_of.size and spread_of.sum(axis=1).max() >= 1.0:
        return False
    missed = abs(inverse) @ (errors @ abs(x) + R.errors @ abs(w))
    off = np.asarray(np.linalg.solve(np.eye(len(x)) - spread_of, missed), dtype=np.float64)
    q = Bounded((w + x @ U.rows)[None], ((abs(x) + off) @ U.errors + off @ abs(U.rows))[None])
    return _obeys(mode, contacts, x, off, q)


def _obeys(mode: str, contacts: list[BoundedContact], x: FloatArray, off: FloatArray, q: Bounded) -> bool:
    """Return whether forces ``x`` +- ``off`` and the motion ``q`` satisfy all inequalities of the letters."""
    at = 0
    for letter, contact in zip(mode, contacts, strict=True):
        if letter == SEPARATES:
            if _least(contact.normal, q) <= 0.0:
                return False
            continue
        least = x[at] - off[at]
        if least < 0.0:
            return False
        if letter == STICKS:
            if abs(x[at + 1]) + off[at + 1] > contact.min_friction * least:
                return False
            at += 2
            continue
        tangent = contact.tangent
        along = Bounded(-tangent.rows if letter == SLIDES_LEFT else tangent.rows, tangent.errors)
        if _least(along, q) <= 0.0:
            return False
        at += 1
    return True


def _least(row: Bounded, q: Bounded) -> float:
    """Return the least product of a row and a motion that are both bounded."""
    off = abs(row.rows) @ q.errors.T + row.errors @ (abs(q.rows) + q.errors).T
    return float((row.rows @ q.rows.T - off)[0, 0])


def _rests_everywhere(
    problem: PlanarContactProblem, box: ContactUncertainty, contacts: list[BoundedContact]
) -> bool:
    from scipy.optimize import linprog

    slippery = [
        replace(contact, friction=bounded.min_friction)
        for contact, bounded in zip(problem.contacts, contacts, strict=True)
    ]
    try:
        held = planar_statics(replace(problem, contacts=slippery))
    except UndecidedError:
        return False
    if held.equilibrium == Certainty.NO or held.stable_disturbance == 0.0:
        return box.is_exact and held.equilibrium != Certainty.NO
    w = applied_wrench(problem)
    radius = _INSIDE * held.stable_disturbance
    if math.isinf(radius):
        radius = _BALL_OF_ALL * (float(np.linalg.norm(w)) or 1.0)
    edges = stacked([contact.edges(contact.min_friction, -contact.min_friction) for contact in contacts])
    for corner in radius * np.vstack([np.eye(3), -np.eye(3)]):
        found = linprog(edges.sizes, A_eq=edges.rows.T, b_eq=-(w + corner), method="highs")
        if found.x is None or found.fun > radius / math.sqrt(3.0):
            return False
    return True
