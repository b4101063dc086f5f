# SPDX-License-Identifier: Apache-2.0
"""Proof that a mode of a body at rest is consistent for all contacts in a box, in the plane and in space.

If the equations of the mode are independent, their solution is enclosed: the inverse of the nominal matrix
bounds how far the solution of any matrix in the box is from the nominal one. All inequalities of the letters
must hold for the whole enclosure.

A body that is held by more forces than it has freedoms stays if the true cone of wrenches that contact forces
balance contains the applied wrench. Around it there is a ball of wrenches that the nominal cone contains,
with the least friction of the box. The corners of a cross-polytope around the ball are balanced by forces
that are known, and errors of the contacts move each corner by no more than these forces times the errors. A
convex set that comes as near as this to every point of a ball contains the ball without a shell of that
thickness.

There are no proofs about contacts in space that slide. They hold everywhere if all other modes are excluded
(`spatial.excluded`).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.letters import SEPARATES, SLIDES_LEFT, STAYS, STICKS
from contact_dynamics.contact_modes.result import BodyStatics, Certainty
from contact_dynamics.errors import TooLargeError, UndecidedError

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.validation import FloatArray

_INSIDE: Final = 0.99
"""Share of the largest ball whose wrenches are balanced, so that rounding does not put them outside."""

_BALL_OF_ALL: Final = 4.0
"""Radius of the ball, in sizes of the applied wrench, if contact forces balance every wrench."""


class BoundedContact(NamedTuple):
    """One contact of a body at rest that is known only to some uncertainty.

    Every bound holds for each coordinate alone, and for all contacts in the box at once.

    Attributes:
        rows: (c, d), the components of its acceleration along its normal and its c - 1 tangents, as functions
            of the motion. Each is also the wrench of a unit force along that axis.
        errors: (c, d), by how much each coordinate of a row may be off.
        min_friction: The smallest coefficient of friction in the box.
        max_friction: The largest coefficient of friction in the box.
    """

    rows: FloatArray
    errors: FloatArray
    min_friction: float
    max_friction: float


class BoundedBody(NamedTuple):
    """A body at rest with its contacts. Motions and wrenches have d coordinates, in one unit of length."""

    contacts: list[BoundedContact]
    inertia: FloatArray  # (d, d), the wrench that a unit motion needs
    wrench: FloatArray  # (d,), N, the applied wrench


def holds_for_all(
    body: BoundedBody,
    mode: str,
    *,
    statics: Callable[[], BodyStatics],
    edges: Callable[[], tuple[FloatArray, FloatArray]],
) -> bool:
    """Return whether it is proven that a consistent mode is consistent everywhere in a box.

    Args:
        body: The body, which all contacts touch.
        mode: One letter for each contact.
        statics: What holds the body, with the least friction of the box.
        edges: The wrenches, (k, d), of edge forces with that friction, and by how much each may be off, (k,).
    """
    equations = sum(
        {SEPARATES: 0, STICKS: len(one.rows)}.get(letter, 1)
        for letter, one in zip(mode, body.contacts, strict=True)
    )
    if equations <= len(body.wrench):
        return STAYS not in mode and _solves_for_all(body, mode)
    return set(mode) == {STICKS} and _rests_for_all(body, statics, edges)


def _solves_for_all(body: BoundedBody, mode: str) -> bool:
    R, off_R, U, off_U = _equations(body, mode)
    inverse_mass = np.linalg.inv(body.inertia)
    size = abs(inverse_mass)
    free = inverse_mass @ body.wrench
    try:
        inverse = np.linalg.inv(R @ inverse_mass @ U.T)
    except np.linalg.LinAlgError:
        return False
    forces = -inverse @ (R @ free)
    off_matrix = off_R @ size @ (abs(U) + off_U).T + abs(R) @ size @ off_U.T
    spread = abs(inverse) @ off_matrix
    if spread.size and spread.sum(axis=1).max() >= 1.0:
        return False
    missed = abs(inverse) @ (off_matrix @ abs(forces) + off_R @ abs(free))
    off = np.linalg.solve(np.eye(len(forces)) - spread, missed)
    motion = free + inverse_mass @ (forces @ U)
    off_motion = size @ ((abs(forces) + off) @ off_U + off @ abs(U))

    def rises(row: FloatArray, error: FloatArray) -> bool:
        """Return whether the product of a row and the motion is positive whatever both are."""
        return bool(row @ motion - abs(row) @ off_motion - error @ (abs(motion) + off_motion) > 0.0)

    at = 0
    for letter, one in zip(mode, body.contacts, strict=True):
        if letter == SEPARATES:
            if not rises(one.rows[0], one.errors[0]):
                return False
            continue
        count = len(one.rows) if letter == STICKS else 1
        (pressing, *across), (off_pressing, *off_across) = forces[at : at + count], off[at : at + count]
        least = pressing - off_pressing
        if least < 0.0 or math.hypot(*across) + math.hypot(*off_across) > one.min_friction * least:
            return False
        if letter != STICKS and not rises(one.rows[1] * _sense(letter), one.errors[1]):
            return False
        at += count
    return True


def _equations(body: BoundedBody, mode: str) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return rows that vanish on the motion, (k, d), wrenches of as many unknown forces, and their errors.

    The errors of either stand behind it.
    """
    found: list[tuple[FloatArray, ...]] = []
    for letter, one in zip(mode, body.contacts, strict=True):
        if letter == STICKS:
            found += zip(one.rows, one.errors, one.rows, one.errors, strict=True)
        elif letter != SEPARATES:
            (N, T), (off_N, off_T) = one.rows, one.errors
            middle = 0.5 * (one.min_friction + one.max_friction)
            spread = 0.5 * (one.max_friction - one.min_friction)
            off_edge = off_N + middle * off_T + spread * (abs(T) + off_T)
            found.append((N, off_N, N - _sense(letter) * middle * T, off_edge))
    R, off_R, U, off_U = np.array(found).reshape(-1, 4, len(body.wrench)).transpose(1, 0, 2)
    return R, off_R, U, off_U


def _sense(letter: str) -> float:
    """Return the sign of a planar contact's sliding along its tangent."""
    return -1.0 if letter == SLIDES_LEFT else 1.0


def _rests_for_all(
    body: BoundedBody,
    statics: Callable[[], BodyStatics],
    edges: Callable[[], tuple[FloatArray, FloatArray]],
) -> bool:
    from scipy.optimize import linprog

    try:
        held = statics()
    except (UndecidedError, TooLargeError):
        return False
    if held.equilibrium == Certainty.NO or held.stable_disturbance == 0.0:
        return False
    radius = _INSIDE * held.stable_disturbance
    if math.isinf(radius):
        radius = _BALL_OF_ALL * (float(np.linalg.norm(body.wrench)) or 1.0)
    freedoms = len(body.wrench)
    corners: FloatArray = radius * np.vstack([np.eye(freedoms), -np.eye(freedoms)])
    wrenches, off = edges()
    for corner in corners:
        found = linprog(off, A_eq=wrenches.T, b_eq=-(body.wrench + corner), method="highs")
        if found.x is None or found.fun > radius / math.sqrt(freedoms):
            return False
    return True
