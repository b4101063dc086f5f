# SPDX-License-Identifier: Apache-2.0
"""This file proves that a body at rest in space has no other mode than one, for all contacts in a box.

A motion and contact forces that bring about a mode satisfy linear inequalities, if each contact that slides
does so within a known arc of directions. Then its force lies in a narrow cone opposite to that arc. Each
inequality is relaxed by the bounds of the contacts' errors, so that the true motion and forces satisfy it for
every contact set in the box. The errors of rows are multiplied by the size of the motion, which is linear
where one coordinate of the motion is known to be the largest. If the relaxed inequalities have no solution
whichever coordinate that is, no contact set in the box has the mode.

Letters are chosen contact after contact, and arcs are halved until they are narrow. As soon as the letters of
the first contacts have no solution, no letters of the others can have one. Why they have none often excludes
letters of other contacts too (`reasons`).

Two facts hold for every body at rest. Contact forces do no positive work on its acceleration, because
friction pushes against the sliding and normal forces act only where contacts stay. So the applied wrench
does. And at least one mode is consistent. So the mode that is left holds everywhere in the box.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact_modes.letters import STICKS
from contact_dynamics.contact_modes.spatial.bounds import bounded_body
from contact_dynamics.contact_modes.spatial.reasons import Reason, Reasons
from contact_dynamics.contact_modes.spatial.uncertain_ways import ANY, WAYS, UncertainWay, UncertainWays
from contact_dynamics.numerics.infeasible import contradiction
from contact_dynamics.tolerances import NO_MOTION, REASON_MARGIN, REASON_ROUNDING

if TYPE_CHECKING:
    from contact_dynamics.contact.uncertainty import ContactUncertainty
    from contact_dynamics.contact_modes.spatial.bounds import BoundedBody
    from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem

MAX_PROGRAMS: Final = 3000
"""Linear programs after which a proof is given up. A box on four feet takes up to two thirds of them, and
one on three a tenth."""

_ROOT_3: Final = math.sqrt(3.0)
"""A motion has at most this many times its largest coordinate in its three translations, or rotations."""

_AXES: Final = np.eye(6)

_LARGEST_EDGE: Final = 1e4
"""Largest wrench of a force whose normal part is 1. Linear programs cannot tell larger ones apart."""

_NARROW: Final = math.pi / 24.0
"""rad. An arc of this width is not halved."""


class _GivenUpError(Exception):
    """The proof takes too many linear programs."""


def no_other_mode(problem: SpatialContactProblem, mode: str, box: ContactUncertainty) -> bool:
    """Return whether it is proven that no mode but ``mode`` occurs anywhere in a box.

    Args:
        problem: The question, of a body at rest that all contacts touch.
        mode: One letter for each contact.
        box: How far the contacts may be from those of the problem.
    """
    body = bounded_body(problem, box)
    if not np.any(body.wrench):
        return set(mode) == {STICKS}
    if any((1.0 + one.max_friction) * abs(one.rows).max() > _LARGEST_EDGE for one in body.contacts):
        return False
    proof = _Proof(body, mode)
    try:
        return all(proof.excludes(at, sign) for at in range(6) for sign in (1.0, -1.0))
    except _GivenUpError:
        return False


class _Proof:
    """A search for letters that the relaxed inequalities allow.

    Motions and forces are in units of the applied wrench.
    """

    __slots__ = ("_allowed", "_body", "_inverse", "_left", "_reasons", "_rests", "_ways")

    def __init__(self, body: BoundedBody, allowed: str) -> None:
        self._body = body._replace(
            inertia=body.inertia / body.inertia[0, 0], wrench=body.wrench / np.linalg.norm(body.wrench)
        )
        self._inverse = np.linalg.inv(self._body.inertia)
        self._allowed = allowed
        self._rests = set(allowed) == {STICKS}
        self._left = MAX_PROGRAMS
        self._ways = UncertainWays(body.contacts)
        self._reasons = Reasons(self._body, self._ways, rests=self._rests)

    def excludes(self, at: int, sign: float) -> bool:
        """Return whether no mode but the allowed one has a motion whose coordinate ``at`` is the largest."""
        return self._excludes(at, sign, (ANY,) * len(self._body.contacts))

    def _excludes(self, at: int, sign: float, ways: tuple[UncertainWay, ...]) -> bool:
        letters = "".join(way.letter for way in ways)
        if letters == self._allowed or self._reasons.exclude(at, sign, ways):
            return True
        reason = self._reason_against(at, sign, ways)
        if reason is not None and self._reasons.add(reason, at, sign):
            return True
        if len(letters) < len(ways):
            i, parts = len(letters), WAYS
        else:
            i = max(range(len(ways)), key=lambda i: ways[i].width)
            if ways[i].width <= _NARROW:
                return False
            parts = ways[i].halves
        return all(self._excludes(at, sign, (*ways[:i], part, *ways[i + 1 :])) for part in parts)

    def _reason_against(self, at: int, sign: float, ways: tuple[UncertainWay, ...]) -> Reason | None:
        """Return why the relaxed inequalities have no solution, or None if they have one.

        A solution moves. If the allowed mode rests, it moves faster than `NO_MOTION`. The variables are edge
        forces, and the errors of their sum in each direction.
        """
        if self._left == 0:
            raise _GivenUpError
        self._left -= 1
        w, contacts = self._body.wrench, self._body.contacts
        lines = [self._ways.lines(i, way) for i, way in enumerate(ways)]
        forces = [self._ways.forces(i, way) for i, way in enumerate(ways)]
        U, E = np.vstack([edges for edges, _ in forces]), np.vstack([errors for _, errors in forces])
        largest = np.zeros(6)
        largest[at] = sign
        others = np.delete(_AXES, at, axis=0)
        nominal = np.vstack([-w[None], *lines])
        off = [0.0, *(one.size for one, some in zip(contacts, lines, strict=True) for _ in some)]
        motions = np.vstack(
            [
                nominal - _ROOT_3 * np.array(off)[:, None] * largest,
                others - largest,
                -others - largest,
                -largest[None],
            ]
        )
        responses = motions @ self._inverse
        limits = np.concatenate([-responses @ w, np.zeros(6)])
        if self._rests:
            limits[len(motions) - 1] -= NO_MOTION
        rows = np.vstack(
            [
                np.hstack([responses @ U.T, responses, -responses]),
                np.hstack([-(E + REASON_MARGIN).T, _AXES, _AXES]),
            ]
        )
        multipliers = contradiction(rows, limits)
        if multipliers is None:
            return None
        multipliers /= multipliers.max()
        multipliers[multipliers < REASON_ROUNDING] = 0.0
        z = self._inverse @ (motions.T @ multipliers[: len(motions)])
        uses = np.split(multipliers[1 : len(nominal)], np.cumsum([len(some) for some in lines])[:-1])
        return Reason(
            z=z if abs(z).max() > REASON_ROUNDING else np.zeros(6),
            row=nominal.T @ multipliers[: len(nominal)],
            weights=np.array([use.sum() for use in uses]),
            used=[int(np.max(np.flatnonzero(use), initial=-1)) + 1 for use in uses],
            ways=ways,
        )
