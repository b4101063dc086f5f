# SPDX-License-Identifier: Apache-2.0
"""The verdicts that occur if planar contacts are known only to some uncertainty.

The true contacts are somewhere in the box of a `ContactUncertainty`. There are proofs only for bodies at
rest: that a mode is consistent everywhere in the box (`holds_for_all`), and that no other is anywhere. Each
contact's errors are independent of the others', and the body's mass and the applied wrench are known.

With an angle of at most theta between a normal and the true one, the true normal is n cos(phi) + n' sin(phi)
with |phi| <= theta, where n' is n turned by 90 degrees. A point that is off by d changes the moment of a unit
force by at most |d|.

A motion q and contact forces that bring about a mode satisfy linear inequalities. Each inequality is relaxed
by the bounds of the contacts' errors, so that the true q and forces satisfy it for every contact set in the
box. The errors of rows are multiplied by |q|, which is linear in each octant of q. If the relaxed
inequalities have no solution in any octant, no contact set in the box has the mode.

Letters are chosen contact after contact. As soon as the letters of the first contacts have no solution, no
letters of the others can have one.

Two facts hold for every body at rest. Contact forces do no positive work on its acceleration, because
friction pushes against the sliding and normal forces act only where contacts stay. So the applied wrench
does, w . q >= m |q|^2, and the acceleration is at most |w| / m.
"""

from __future__ import annotations

import itertools
import math
import random
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact.uncertainty import EXACT_CONTACTS
from contact_dynamics.contact_modes.letters import (
    PLANAR_LETTERS,
    SEPARATES,
    SLIDES_LEFT,
    SLIDES_RIGHT,
    STICKS,
)
from contact_dynamics.contact_modes.planar.answer import planar_contact_modes
from contact_dynamics.contact_modes.planar.problem import contact_rows
from contact_dynamics.contact_modes.planar.statics import planar_statics
from contact_dynamics.contact_modes.result import BodyStatics, ModeVerdict
from contact_dynamics.contact_modes.uncertain import BoundedBody, BoundedContact, Boxes, holds_for_all
from contact_dynamics.tolerances import NO_MOTION, SUM_ROUNDING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from contact_dynamics.contact.uncertainty import ContactUncertainty
    from contact_dynamics.contact_modes.planar.problem import PlanarContactProblem
    from contact_dynamics.contact_modes.result import PlanarModeAnswer
    from contact_dynamics.plane.types import PlanarContact
    from contact_dynamics.validation import FloatArray

SAMPLES: Final = 64
"""Contact sets that are tried if there is no proof. Half of them are at corners of the box."""

MAX_PROGRAMS: Final = 3000
"""Linear programs after which a proof is given up. A box on four feet takes some hundred."""

_STEP: Final = 1.5
"""Each size of a margin is at most this factor from the next."""

_STEPS: Final = 48
"""Sizes below the largest, which so reach down to 3.5e-9 of it."""

_LARGEST_EDGE: Final = 1e4
"""Largest wrench of a force whose normal part is 1. Linear programs cannot tell larger ones apart."""


def planar_boxes(problem: PlanarContactProblem, answer: PlanarModeAnswer) -> Boxes[PlanarModeAnswer]:
    """Return what is known of the answers in boxes around the contacts of a problem."""
    return Boxes(
        answer,
        is_certain=partial(is_certain, problem, answer),
        sampled=partial(sampled, problem),
        radius_of_gyration=problem.body.radius_of_gyration,
        frictions=[contact.holding_friction for contact in problem.contacts],
        step=_STEP,
        steps=_STEPS,
    )


def is_certain(problem: PlanarContactProblem, answer: PlanarModeAnswer, box: ContactUncertainty) -> bool:
    """Return whether it is proven that the verdict of ``answer`` holds everywhere in a box."""
    at_rest = all(velocity == (0.0, 0.0) for velocity in answer.contact_velocities)
    if not at_rest or not problem.contacts:
        return not problem.contacts
    if answer.verdict == ModeVerdict.INDETERMINATE:
        holding = (mode for mode in answer.modes if holds_everywhere(problem, mode.mode, box))
        return next(holding, None) is not None and next(holding, None) is not None
    if answer.verdict == ModeVerdict.UNIQUE:
        (one,) = answer.modes
        return holds_everywhere(problem, one.mode, box) and no_other_mode(problem, one.mode, box)
    return False


def sampled(problem: PlanarContactProblem, box: ContactUncertainty) -> Iterator[PlanarModeAnswer]:
    """Yield the answers for some contact sets in a box. The same box always gives the same sets."""
    chance = random.Random(0)  # noqa: S311 - a sample, no secret
    box_of_each = box.of_each(len(problem.contacts))
    for index in range(SAMPLES):
        contacts = [
            _moved(contact, of, chance, corner=index % 2 == 0)
            for contact, of in zip(problem.contacts, box_of_each, strict=True)
        ]
        yield planar_contact_modes(replace(problem, contacts=contacts, uncertainty=EXACT_CONTACTS))


def _moved(
    contact: PlanarContact, box: tuple[float, float, float], chance: random.Random, *, corner: bool
) -> PlanarContact:
    def error(size: float) -> float:
        return size * (chance.choice([-1.0, 1.0]) if corner else chance.uniform(-1.0, 1.0))

    points, normals, frictions = box
    turn, way, step = error(normals), chance.uniform(-math.pi, math.pi), abs(error(points))
    slip = error(frictions)
    (x, y), (n_x, n_y) = contact.r, contact.normal
    c, s = math.cos(turn), math.sin(turn)
    friction, static = max(0.0, contact.friction + slip), contact.static_friction
    return replace(
        contact,
        r=(x + step * math.cos(way), y + step * math.sin(way)),
        normal=(c * n_x - s * n_y, s * n_x + c * n_y),
        friction=friction,
        static_friction=None if static is None else max(friction, static + slip),
    )


def bounded_body(problem: PlanarContactProblem, box: ContactUncertainty) -> BoundedBody:
    """Return the body of a problem with contacts anywhere in a box, in the coordinates of `problem`."""
    rho, wrench = problem.body.radius_of_gyration, problem.wrench
    found = []
    for contact, of in zip(problem.contacts, box.of_each(len(problem.contacts)), strict=True):
        points, normals, frictions = of
        rows = np.array(contact_rows(contact, rho))
        sine, less = math.sin(normals), 1.0 - math.cos(normals)
        # Turning the normal by 90 degrees makes the tangent of it, and the other way round.
        moved = np.array([0.0, 0.0, points / rho])
        rounding = SUM_ROUNDING * (abs(rows[0]) + abs(rows[1]))
        errors = sine * abs(rows[::-1]) + less * abs(rows) + moved + rounding
        found.append(BoundedContact.of(rows, errors, contact.friction, contact.holding_friction, frictions))
    return BoundedBody(found, np.eye(3), np.array([*wrench.f, wrench.moment / rho]))


def holds_everywhere(problem: PlanarContactProblem, mode: str, box: ContactUncertainty) -> bool:
    """Return whether it is proven that a consistent mode is consistent everywhere in a box."""
    body = bounded_body(problem, box)
    least = [one.min_holding for one in body.contacts]

    def statics() -> BodyStatics:
        pairs = zip(problem.contacts, least, strict=True)
        slippery = [replace(contact, friction=friction, static_friction=None) for contact, friction in pairs]
        return planar_statics(replace(problem, contacts=slippery))

    def edges() -> tuple[FloatArray, FloatArray]:
        parts = [_edges(one, friction, -friction) for one, friction in zip(body.contacts, least, strict=True)]
        wrenches, errors = (np.vstack(of) for of in zip(*parts, strict=True))
        return wrenches, np.linalg.norm(errors, axis=1)

    return holds_for_all(body, mode, statics=statics, edges=edges)


class _GivenUpError(Exception):
    """The proof takes too many linear programs."""


def no_other_mode(problem: PlanarContactProblem, mode: str, box: ContactUncertainty) -> bool:
    """Return whether it is proven that no mode but ``mode`` occurs anywhere in a box."""
    contacts, _, w = bounded_body(problem, box)
    size = float(np.linalg.norm(w))
    if size == 0.0:
        return set(mode) == {STICKS}
    if any(abs(_edges(one, one.max_holding)[0]).max() > _LARGEST_EDGE for one in contacts):
        return False
    proof = _Proof(contacts, w / size, mode)
    try:
        return all(proof.excludes(np.array(signs), "") for signs in itertools.product((-1.0, 1.0), repeat=3))
    except _GivenUpError:
        return False


class _Proof:
    """A search for letters that the relaxed inequalities allow. Its unit is the applied wrench."""

    __slots__ = ("_allowed", "_contacts", "_left", "_w")

    def __init__(self, contacts: list[BoundedContact], w: FloatArray, allowed: str) -> None:
        self._contacts = contacts
        self._w = w
        self._allowed = allowed
        self._left = MAX_PROGRAMS

    def excludes(self, signs: FloatArray, letters: str) -> bool:
        """Return whether no mode but the allowed one begins with ``letters`` in an octant of motions."""
        if letters == self._allowed or not self._possible(signs, letters):
            return True
        if len(letters) == len(self._contacts):
            return False
        return all(self.excludes(signs, letters + letter) for letter in PLANAR_LETTERS)

    def _possible(self, signs: FloatArray, letters: str) -> bool:
        """Return whether the relaxed inequalities have a solution that moves, or rests in another mode."""
        from scipy.optimize import linprog

        if self._left == 0:
            raise _GivenUpError
        self._left -= 1
        lines = [-self._w * signs]
        wrenches: list[tuple[FloatArray, FloatArray]] = [(np.zeros((0, 3)), np.zeros((0, 3)))]
        for i, contact in enumerate(self._contacts):
            letter = letters[i] if i < len(letters) else ""
            lines += _lines(contact, letter, signs)
            if letter != SEPARATES:
                wrenches.append(_edges_of(contact, letter))
        rows, errors = (np.vstack(parts) for parts in zip(*wrenches, strict=True))
        lengths = np.linalg.norm(rows, axis=1)[:, None]
        rows, errors = rows / lengths, errors / lengths
        motions = np.vstack(lines)
        balance = np.vstack(
            [
                np.hstack([np.diag(signs), -(rows + errors).T]),
                np.hstack([-np.diag(signs), (rows - errors).T]),
            ]
        )
        found = linprog(
            np.concatenate([-np.ones(3), np.zeros(len(rows))]),
            A_ub=np.vstack([np.hstack([motions, np.zeros((len(motions), len(rows)))]), balance]),
            b_ub=np.concatenate([np.zeros(len(motions)), self._w, -self._w]),
            bounds=[(0.0, 1.0)] * 3 + [(0.0, None)] * len(rows),
            method="highs",
        )
        if found.status == _INFEASIBLE:
            return False
        rests = set(self._allowed) == {STICKS}
        return not (rests and found.status == _SOLVED and -found.fun <= NO_MOTION)


_SOLVED: Final = 0
"""SciPy's status of a linear program that was solved."""

_INFEASIBLE: Final = 2
"""SciPy's status of a linear program without solution."""


def _lines(contact: BoundedContact, letter: str, signs: FloatArray) -> list[FloatArray]:
    """Return rows, relaxed by their bounds, whose products with |q| are <= 0 for a letter's motions q."""
    (normal, tangent), (off_normal, off_tangent) = contact.rows, contact.errors
    found = [-normal * signs - off_normal]
    if letter not in {SEPARATES, ""}:
        found.append(normal * signs - off_normal)
    if letter in {SLIDES_LEFT, STICKS}:
        found.append(tangent * signs - off_tangent)
    if letter in {SLIDES_RIGHT, STICKS}:
        found.append(-tangent * signs - off_tangent)
    return found


def _edges_of(contact: BoundedContact, letter: str) -> tuple[FloatArray, FloatArray]:
    """Return the edges of all forces that a letter allows, and their errors."""
    least, most = contact.min_friction, contact.max_friction
    if letter == SLIDES_LEFT:
        return _edges(contact, least, most)
    if letter == SLIDES_RIGHT:
        return _edges(contact, -least, -most)
    return _edges(contact, -contact.max_holding, contact.max_holding)


def _edges(contact: BoundedContact, *slopes: float) -> tuple[FloatArray, FloatArray]:
    """Return the wrenches, (k, 3), of forces with f_n = 1 and f_t = each of ``slopes``, and their errors."""
    factors = np.array(slopes)[:, None]
    (normal, tangent), (off_normal, off_tangent) = contact.rows, contact.errors
    return normal + factors * tangent, off_normal + abs(factors) * off_tangent
