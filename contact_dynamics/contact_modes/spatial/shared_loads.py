# SPDX-License-Identifier: Apache-2.0
"""Forces with which contacts that share a load in many ways begin to slide together, with round cones.

In a given direction of the common motion, each contact's friction has a known direction. Then the sizes of
the forces and of the motion solve a linear problem with numbers that are not negative. Its remainder depends
on the direction, which Newton's method turns until nothing remains. The sizes follow the direction in each
step (variable projection, Golub and Pereyra, The Differentiation of Pseudo-Inverses and Nonlinear Least
Squares Problems Whose Variables Separate, 1973).

A body that turns about a foot that sticks can do so in two directions only. There round cones decide whether
forces move it so (`round_cones`), and a refusal is certain.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.letters import SEPARATES, STAYS, STICKS
from contact_dynamics.contact_modes.spatial.round_cones import Held, moved_by_round_cones
from contact_dynamics.numerics.linear_spaces import seen_and_unseen
from contact_dynamics.numerics.nonnegative_least_squares import nearest_combination
from contact_dynamics.tolerances import FEASIBLE, LETTERS_REGULAR, ROW_TOLERANCE, SLOWEST_SHARED, STRICT

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from contact_dynamics.contact_modes.spatial.search import Search
    from contact_dynamics.validation import FloatArray

_MAX_STEPS: Final = 12
"""The largest number of steps from one direction. From directions that lead to a solution, some five are
enough."""

_LONGEST_STEP: Final = 0.3
"""rad. This is a little less than a sector of the usual pyramid."""

_BENT: Final = 0.1
"""rad. Directions are also tried that are turned by about this. In a mode with other letters one of the
contacts may stick, and its friction has no direction."""


def sliding_together(search: Search, letters: str, motions: Sequence[FloatArray]) -> Held:
    """Return forces with the letters, to `FEASIBLE`, or none.

    It is certain that there are none, or that no others move the body differently, if it says so. The body is
    at rest, and may slide in directions near those of the motions, (d,).
    """
    if not search.at_rest and any(one.point[:, -1].any() or one.sliding.any() for one in search.touching):
        return Held(None, certain=False)
    free_motions = _motions(search, letters)
    if len(free_motions) > 1 and not motions:
        return Held(None, certain=False)
    problem = _problem(search, letters, free_motions)
    if len(problem.motions) == 1:
        # The applied wrench has power on a motion from rest, since contact forces have none.
        power = float(problem.motions[0] @ search.mass @ search.motion[:, -1])
        signs = (1.0, -1.0) if abs(power) <= FEASIBLE else (math.copysign(1.0, power),)
        ways = [_one_way(search, letters, problem, sign) for sign in signs]
        found = next((held for held in ways if held.forces is not None), None)
        return found or Held(None, certain=all(held.certain for held in ways))
    for start in problem.directions(motions):
        for slowest in SLOWEST_SHARED:
            forces = _turned(problem, start, slowest)
            if forces is not None:
                return Held(forces, certain=False)
    return Held(None, certain=False)


def _one_way(search: Search, letters: str, problem: _Problem, sign: float) -> Held:
    """Return forces that move a body forward or backward, where it can move in one direction only."""
    axes, frictions = np.zeros((len(letters), 3)), np.zeros(len(letters))
    slowest = 1.0
    motion = np.append(sign * problem.motions[0], 0.0)
    for i, (letter, contact, pyramid) in enumerate(
        zip(letters, search.touching, search.pyramids, strict=True)
    ):
        if letter == STICKS:
            axes[i], frictions[i] = contact.normal, contact.holding
        elif letter == STAYS:
            across = np.zeros(3)
            if pyramid.frame is not None:
                way = contact.point @ motion
                speed = float(np.linalg.norm(way))
                if speed <= ROW_TOLERANCE:  # it turns about this foot too
                    return Held(None, certain=False)
                across = way / speed
                slowest = min(slowest, speed)
            axes[i] = contact.normal - contact.friction * across
    held = moved_by_round_cones(search, axes, frictions, STRICT / slowest * motion[:-1])
    if held.forces is not None:
        for size in SLOWEST_SHARED:  # faster sliding is farther from the border of the mode
            faster = moved_by_round_cones(search, axes, frictions, size / slowest * motion[:-1])
            if faster.forces is not None:
                return faster
    return held


class _Problem(NamedTuple):
    """What forces and motions with some letters consist of."""

    normals: FloatArray  # (m, 3 n), the normal forces of the contacts that begin to slide
    tangents: FloatArray  # (m, 2, 3 n), their unit frictions, times the coefficient
    others: FloatArray  # (k, 3 n), the edges of the other contacts' forces
    motions: FloatArray  # (p, d), the motions with the letters, but for the sliding
    slides: FloatArray  # (m, 2, p), the tangential accelerations that these cause
    of_forces: FloatArray  # (d, 3 n), the motion that unit forces cause
    free: FloatArray  # (d,), the motion without forces

    def directions(self, motions: Sequence[FloatArray]) -> Iterator[FloatArray]:
        """Yield unit directions near those of some motions."""
        chance = np.random.default_rng(26)
        found = [self.motions @ motion for motion in motions]
        units = [one / np.linalg.norm(one) for one in found if np.linalg.norm(one) > 0.0]
        yield from units
        for unit in units:
            yield unit + _BENT * chance.normal(size=unit.shape)


def _motions(search: Search, letters: str) -> FloatArray:
    """Return the motions, (p, d), with some letters, whatever else they do."""
    still = [
        one.point[:, :-1] if letter == STICKS else (one.normal @ one.point)[None, :-1]
        for letter, one in zip(letters, search.touching, strict=True)
        if letter != SEPARATES
    ]
    return seen_and_unseen(np.vstack([np.zeros((0, search.freedoms)), *still]))[1]


def _problem(search: Search, letters: str, free_motions: FloatArray) -> _Problem:
    size = 3 * len(letters)
    normals, tangents, others, slides = [], [], [np.zeros((0, size))], []
    for i, (letter, contact, pyramid) in enumerate(
        zip(letters, search.touching, search.pyramids, strict=True)
    ):
        if letter == SEPARATES:
            continue
        spread = np.zeros((3, size))
        spread[:, 3 * i : 3 * i + 3] = np.eye(3)
        if letter == STAYS and pyramid.frame is not None:
            frame = np.array(pyramid.frame)
            normals.append(contact.normal @ spread)
            tangents.append(contact.friction * frame @ spread)
            slides.append(frame @ contact.point[:, :-1])
        else:
            others.append(pyramid.sticking @ spread)
    return _Problem(
        normals=np.array(normals).reshape(-1, size),
        tangents=np.array(tangents).reshape(-1, 2, size),
        others=np.vstack(others),
        motions=free_motions,
        slides=np.array(slides).reshape(-1, 2, search.freedoms) @ free_motions.T,
        of_forces=search.of_forces,
        free=search.motion[:, -1],
    )


def _turned(problem: _Problem, direction: FloatArray, slowest: float) -> FloatArray | None:
    """Return forces, (n, 3), with which the body slides, not too slowly, near a direction, (p,), or None."""
    for _ in range(_MAX_STEPS):
        direction = direction / np.linalg.norm(direction)
        ways = problem.slides @ direction
        speeds = np.linalg.norm(ways, axis=1)
        if not speeds.min(initial=1.0) * slowest > STRICT:
            return None
        ways /= speeds[:, None]
        edges = np.vstack([problem.normals - np.einsum("ij,ijk->ik", ways, problem.tangents), problem.others])
        motion = problem.motions.T @ direction
        spans = np.column_stack([problem.of_forces @ edges.T, -motion])
        found = nearest_combination(spans, slowest * motion - problem.free)
        if found is None:
            return None
        shares = found[0]
        missed = problem.free - slowest * motion + spans @ shares
        if found[1] <= FEASIBLE:
            forces: FloatArray = (shares[:-1] @ edges).reshape(-1, 3)
            return forces
        turns = (
            problem.slides - ways[:, :, None] * np.einsum("ij,ijk->ik", ways, problem.slides)[:, None]
        ) / (speeds[:, None, None])
        pressing = shares[: len(ways)]
        turned = np.einsum("i,ijk,ijp->kp", pressing, problem.tangents, turns)
        slopes = -problem.of_forces @ turned - (shares[-1] + slowest) * problem.motions.T
        acting = np.asarray(np.linalg.qr(spans[:, shares > 0.0])[0])
        slopes -= acting @ (acting.T @ slopes)
        step = -np.linalg.lstsq(slopes, missed, rcond=LETTERS_REGULAR)[0]
        length = float(np.linalg.norm(step))
        direction = direction + step * min(1.0, _LONGEST_STEP / length if length > 0.0 else 1.0)
    return None
