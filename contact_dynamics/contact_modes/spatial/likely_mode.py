# SPDX-License-Identifier: Apache-2.0
"""The most likely mode, which is that of slightly compliant contacts.

The normal force of a compliant contact is proportional to its penetrating acceleration. Friction is
proportional to the sliding acceleration with the same stiffness, up to Coulomb's limit. The number of
equations is that of the components of the motion, however many contacts there are. Newton's method solves
them for increasing stiffness. Contacts that still move separate or slide, and forces with these letters are
then made exact (`exact_letters`). This finds at most one mode.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.letters import SEPARATES, STAYS, STICKS
from contact_dynamics.contact_modes.spatial.completeness import Known
from contact_dynamics.contact_modes.spatial.exact_letters import solution_near
from contact_dynamics.contact_modes.spatial.round_cones import summed_by_round_cones
from contact_dynamics.tolerances import COMPLIANT_SETTLED, GIVES_WAY, STRICT

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from contact_dynamics.contact_modes.spatial.exact_letters import Solution
    from contact_dynamics.contact_modes.spatial.search import Search
    from contact_dynamics.validation import FloatArray

_STIFFNESSES: Final = (1.0, 1e1, 1e2, 1e3, 1e4, 1e6)
"""Force of a contact per unit penetrating acceleration, relative to the mass of the body."""

_MAX_STEPS: Final = 30
"""Maximum number of Newton steps for each stiffness. Two are enough on average, and about 25 if many feet are
at their friction limits."""

_SHORTEST_STEP: Final = 0.02
"""Fraction of a Newton step below which it is accepted without improvement."""

_ENOUGH: Final = 0.1
"""Fraction of the predicted improvement that a longer step must achieve."""


@np.errstate(over="ignore", invalid="ignore")  # a contact may be extremely far away
def likely_mode(search: Search) -> Known | None:
    """Return the most likely mode of touching contacts, or None if there is none with its letters."""
    try:
        body, now = _settled(search)
    except np.linalg.LinAlgError:  # a stiffness at which friction and pressing cancel
        return None
    others: list[tuple[str, Solution]] = []
    for gives_way in (GIVES_WAY, 0.0):
        letters = body.letters(now, gives_way)
        if set(letters) <= {SEPARATES}:
            free = body.response(search.motion[:, -1], 0.0)  # an unconverged motion is arbitrary
            if free.rising.min(initial=1.0) > STRICT:
                return Known(letters, np.zeros_like(now.forces), alone=True)
            continue
        solution = solution_near(search, letters, now.forces)
        solution = solution or solution_near(search, letters, now.forces, shared=True)
        if solution is not None and solution.has_letters:
            return _known(letters, solution)
        if solution is not None and set(letters) != {STICKS}:  # round cones decide on that anyway
            others.append((letters, solution))
    for letters, other in others:
        within = _in_round_cones(search, letters, other)
        if within is not None and within.has_letters:
            return _known(letters, within)
    return None


def _known(letters: str, solution: Solution) -> Known:
    unique = solution.equations is not None
    return Known(letters, solution.forces, alone=solution.motion_unique, forces_unique=unique)


def _in_round_cones(search: Search, letters: str, solution: Solution) -> Solution | None:
    """Return a solution with the same motion and forces in the round cones, or None.

    Compliant contacts may assign more friction to a foot than its cone allows, although others could carry
    it.
    """
    acting = [i for i, letter in enumerate(letters) if letter != SEPARATES]
    caused = search.of_forces @ solution.forces.ravel()
    motion = np.append(search.motion[:, -1] + caused, 1.0)
    axes, leans = np.zeros((len(acting), 3)), np.zeros(len(acting))
    for k, i in enumerate(acting):
        contact, pyramid = search.touching[i], search.pyramids[i]
        axes[k] = pyramid.edges[0] if pyramid.frame is None else contact.normal
        if letters[i] == STICKS:
            leans[k] = contact.friction
        elif pyramid.frame is not None:
            way = contact.point @ motion
            speed = float(np.linalg.norm(way))
            axes[k] = contact.normal - contact.friction * way / (speed if speed > 0.0 else 1.0)
    columns = (3 * np.array(acting)[:, None] + np.arange(3)).ravel()
    held = summed_by_round_cones(
        search.mass @ search.of_forces[:, columns], search.mass @ caused, axes, leans
    )
    if held.forces is None:
        return None
    forces = np.zeros_like(solution.forces)
    forces[acting] = held.forces
    return solution_near(search, letters, forces, shared=True)


class _Response(NamedTuple):
    """The response of compliant contacts to a motion."""

    missed: FloatArray  # (d,), residual force and torque of the equations of motion
    forces: FloatArray  # (n, 3), on the body
    rising: FloatArray  # (n,), the normal accelerations
    speeds: FloatArray  # (n,), the tangential ones
    ways: FloatArray  # (n, 3), unit, the directions against which friction acts
    grips: NDArray[np.bool_]  # (n,), whether friction is below its limit


class _Compliant:
    """The equations of motion of a body on compliant contacts."""

    def __init__(self, search: Search) -> None:
        self.mass, self._wrench = search.mass, search.mass @ search.motion[:, -1]
        points = search.points.reshape(-1, search.freedoms + 1)
        self._points, self._constant = np.ascontiguousarray(points[:, :-1]), points[:, -1]
        self._normals, self._frictions = search.normals, search.frictions
        self._rests = np.array([one.frame is not None for one in search.pyramids], dtype=bool)
        sliding = np.array([one.sliding for one in search.touching]).reshape(-1, 3)
        self._sliding = _directions(sliding, np.sqrt((sliding * sliding).sum(axis=1)))
        self._along = self._normals[:, :, None] * self._normals[:, None, :]

    def response(self, motion: FloatArray, stiffness: float) -> _Response:
        """Return the response of the contacts to a motion, (d,)."""
        accelerations = (self._points @ motion + self._constant).reshape(-1, 3)
        rising = (self._normals * accelerations).sum(axis=1)
        across = accelerations - rising[:, None] * self._normals
        speeds = np.sqrt((across * across).sum(axis=1))
        ways = np.where(self._rests[:, None], _directions(across, speeds), self._sliding)
        pressing = stiffness * np.maximum(-rising, 0.0)
        limits = self._frictions * pressing
        grips = self._rests & (stiffness * speeds <= limits)
        friction = np.where(grips, stiffness * speeds, limits)
        forces = pressing[:, None] * self._normals - friction[:, None] * ways
        missed = self._wrench + self._points.T @ forces.ravel() - self.mass @ motion
        return _Response(missed, forces, rising, speeds, ways, grips)

    def step(self, now: _Response, stiffness: float) -> FloatArray:
        """Return Newton's step, (d,)."""
        presses = np.where(now.rising < 0.0, stiffness, 0.0)
        slips = np.where(now.grips, 0.0, 1.0)
        leaning = self._normals - (slips * self._frictions)[:, None] * now.ways
        limits = -self._frictions * presses * now.rising
        turning = np.where(self._rests, limits / np.where(now.speeds > 0.0, now.speeds, math.inf), 0.0)
        holding = np.where(now.grips, presses, turning)
        rates = presses[:, None, None] * leaning[:, :, None] * self._normals[:, None, :]
        turns = slips[:, None, None] * now.ways[:, :, None] * now.ways[:, None, :]
        rates += holding[:, None, None] * (np.eye(3) - self._along - turns)
        of_motion = rates @ self._points.reshape(len(rates), 3, -1)
        slopes = self.mass + self._points.T @ of_motion.reshape(self._points.shape)
        found: FloatArray = np.linalg.solve(slopes, now.missed)
        return found

    def letters(self, now: _Response, gives_way: float) -> str:
        """Return the letters of the contacts, which stay or stick if they move by at most ``gives_way``."""
        sticks = self._rests & (now.grips if gives_way == 0.0 else now.speeds <= gives_way)
        return "".join(np.where(now.rising > gives_way, SEPARATES, np.where(sticks, STICKS, STAYS)).tolist())


def _directions(vectors: FloatArray, sizes: FloatArray) -> FloatArray:
    found: FloatArray = vectors / np.where(sizes > 0.0, sizes, 1.0)[:, None]
    return found


def _settled(search: Search) -> tuple[_Compliant, _Response]:
    """Return a body on the stiffest contacts, and their response."""
    body, inverse = _Compliant(search), np.linalg.inv(search.mass)
    motion: FloatArray = search.motion[:, -1]
    for stiffness in _STIFFNESSES:
        stiff = stiffness * float(search.mass[0, 0])
        now = body.response(motion, stiff)
        left = float(now.missed @ inverse @ now.missed)
        for _ in range(_MAX_STEPS):
            if left <= COMPLIANT_SETTLED:
                break
            step, share = body.step(now, stiff), 1.0
            while True:
                now = body.response(motion + share * step, stiff)
                trial = float(now.missed @ inverse @ now.missed)
                if trial <= (1.0 - _ENOUGH * share) ** 2 * left or share < _SHORTEST_STEP:
                    break
                share *= 0.5
            motion, left = motion + share * step, trial
    return body, now
