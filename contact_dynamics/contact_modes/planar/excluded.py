# SPDX-License-Identifier: Apache-2.0
"""This file proves that a planar body at rest has no other mode than one, for all contacts in a box.

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
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact_modes.letters import (
    PLANAR_LETTERS,
    SEPARATES,
    SLIDES_LEFT,
    SLIDES_RIGHT,
    STICKS,
)
from contact_dynamics.contact_modes.planar.bounds import Bounded, BoundedContact, bounded_contacts, stacked
from contact_dynamics.contact_modes.planar.everywhere import applied_wrench
from contact_dynamics.tolerances import NO_MOTION

if TYPE_CHECKING:
    from contact_dynamics.contact.uncertainty import ContactUncertainty
    from contact_dynamics.contact_modes.planar.problem import PlanarContactProblem
    from contact_dynamics.contact_modes.planar.result import PlanarMode
    from contact_dynamics.validation import FloatArray

MAX_PROGRAMS: Final = 3000
"""Linear programs after which a proof is given up. A box on four feet takes some hundred."""

_LARGEST_EDGE: Final = 1e4
"""Largest wrench of a force whose normal part is 1. Linear programs cannot tell larger ones apart."""


class _GivenUpError(Exception):
    """The proof takes too many linear programs."""


def no_other_mode(problem: PlanarContactProblem, mode: PlanarMode, box: ContactUncertainty) -> bool:
    """Return whether it is proven that no mode but ``mode`` occurs anywhere in a box."""
    contacts = bounded_contacts(problem, box)
    w = applied_wrench(problem)
    size = float(np.linalg.norm(w))
    if size == 0.0:
        return set(mode.mode) == {STICKS}
    if any(abs(one.edges(one.max_friction).rows).max() > _LARGEST_EDGE for one in contacts):
        return False
    proof = _Proof(contacts, w / size, mode.mode)
    try:
        return all(proof.excludes(np.array(signs), "") for signs in itertools.product((-1.0, 1.0), repeat=3))
    except _GivenUpError:
        return False


class _Proof:
    """A search for letters that the relaxed inequalities allow.

    Motions and forces are in units of the applied wrench, so that no coordinate of a motion is above 1.
    """

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
        """Return whether the relaxed inequalities have a solution that moves, or one at rest that is another.

        Rest is the allowed mode if all its contacts stick.
        """
        from scipy.optimize import linprog

        if self._left == 0:
            raise _GivenUpError
        self._left -= 1
        lines = [-self._w * signs]
        wrenches = []
        for i, contact in enumerate(self._contacts):
            letter = letters[i] if i < len(letters) else ""
            lines += _lines(contact, letter, signs)
            if letter != SEPARATES:
                wrenches.append(_edges(contact, letter))
        edges = stacked(wrenches)
        lengths = np.linalg.norm(edges.rows, axis=1)[:, None]
        rows, errors = edges.rows / lengths, edges.errors / lengths
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
    """Return rows whose products with |q| are not positive for the motions q that a letter allows.

    No letter stands for any.
    """
    normal, tangent = contact.normal, contact.tangent
    found = [_at_most(Bounded(-normal.rows, normal.errors), signs)]
    if letter not in {SEPARATES, ""}:
        found.append(_at_most(normal, signs))
    if letter in {SLIDES_LEFT, STICKS}:
        found.append(_at_most(tangent, signs))
    if letter in {SLIDES_RIGHT, STICKS}:
        found.append(_at_most(Bounded(-tangent.rows, tangent.errors), signs))
    return found


def _at_most(row: Bounded, signs: FloatArray) -> FloatArray:
    """Return the row of |q| that is not positive if some row within the bounds is not positive at q."""
    relaxed: FloatArray = row.rows[0] * signs - row.errors[0]
    return relaxed


def _edges(contact: BoundedContact, letter: str) -> Bounded:
    least, most = contact.min_friction, contact.max_friction
    if letter == SLIDES_LEFT:
        return contact.edges(least, most)
    if letter == SLIDES_RIGHT:
        return contact.edges(-least, -most)
    return contact.edges(-most, most)
