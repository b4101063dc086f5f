# SPDX-License-Identifier: Apache-2.0
"""Exact friction for a mode in space that was found with friction pyramids.

Where contacts at rest come to slide, friction on a pyramid is up to half a sector away from the direction
against their sliding. Here each contact has one edge. Newton's method seeks its direction, such that it is
straight against the sliding that the forces cause. Where that settles in the same letters, the mode
obeys Coulomb's round cone at every contact that slides. Contacts that stick keep their pyramids, which lie
inside the round cones.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.letters import SEPARATES, STAYS, STICKS
from contact_dynamics.contact_modes.spatial.dual_simplex import Program
from contact_dynamics.tolerances import SETTLED_DIRECTION, STRICT, TRIAL_TURN

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes.spatial.options import Pyramid
    from contact_dynamics.contact_modes.spatial.pyramid_programs import Touching
    from contact_dynamics.validation import FloatArray

_MAX_STEPS: Final = 12
"""Each step solves for the forces, in 0.1 ms, once for each contact that slides. Four steps suffice where
there is a solution nearby."""

_LONGEST_STEP: Final = 0.3
"""rad. This is a little less than half a sector of the usual pyramid, which is 0.39 rad."""

_FAST: Final = 0.1
"""The share of its error that a step may leave where directions just follow the sliding. If a step leaves
more, Newton's method, which needs derivatives, takes over."""


class Sliding(NamedTuple):
    """A mode whose friction is to be turned.

    Attributes:
        touching: The n contacts.
        pyramids: Their force edges.
        letters: s, c or f for each contact.
        of_forces: (6, 3 n), the motion that unit forces cause.
        free: (6,), the motion without forces.
    """

    touching: Sequence[Touching]
    pyramids: Sequence[Pyramid]
    letters: str
    of_forces: FloatArray
    free: FloatArray


def sharpened(mode: Sliding, forces: FloatArray) -> FloatArray | None:
    """Return forces, (n, 3), with exact friction, or None if the directions do not settle with these letters.

    Args:
        mode: The mode, as it was found.
        forces: (n, 3), the forces of the mode.
    """
    turning = [i for i, one in enumerate(mode.pyramids) if mode.letters[i] == STAYS and one.frame is not None]
    angles: FloatArray = np.asarray([_against(mode.pyramids[i], forces[i]) for i in turning])
    followed = _followed(mode, turning, angles)
    return _by_newton(mode, turning, angles) if followed is None else followed


def _followed(mode: Sliding, turning: list[int], angles: FloatArray) -> FloatArray | None:
    """Turn friction against the sliding while that settles fast, as where all contacts slide one way."""
    last = math.inf
    while True:
        found = _solved(mode, turning, angles)
        if found is None:
            return None
        errors = _errors(mode, turning, angles, found)
        error = float(np.abs(errors).max())
        if error <= SETTLED_DIRECTION:
            return found
        if not error <= _FAST * last:
            return None
        angles, last = angles + errors, error


def _by_newton(mode: Sliding, turning: list[int], angles: FloatArray) -> FloatArray | None:
    """Turn friction against the sliding by Newton's method, from given angles."""
    step: FloatArray = np.zeros(len(turning))
    for _ in range(_MAX_STEPS):
        found = _solved(mode, turning, angles + step)
        if found is None:
            step = 0.5 * step  # back towards directions that gave the mode
            continue
        angles = angles + step
        errors = _errors(mode, turning, angles, found)
        if np.abs(errors).max() <= SETTLED_DIRECTION:
            return found
        slopes = _slopes(mode, turning, angles, errors)
        if slopes is None:
            return None
        step = np.asarray(np.linalg.lstsq(slopes, -errors, rcond=None)[0], dtype=float)
        step *= min(1.0, _LONGEST_STEP / max(float(np.abs(step).max()), SETTLED_DIRECTION))
    return None


def _slopes(mode: Sliding, turning: list[int], angles: FloatArray, errors: FloatArray) -> FloatArray | None:
    """Return how the errors change with the directions, (k, k), or None where the mode ends there."""
    found = np.zeros((len(turning), len(turning)))
    for k, trial in enumerate(TRIAL_TURN * np.eye(len(turning))):
        beside = _solved(mode, turning, angles + trial)
        if beside is None:
            return None
        found[:, k] = (_errors(mode, turning, angles + trial, beside) - errors) / TRIAL_TURN
    return None if np.isnan(found).any() else found


def _against(pyramid: Pyramid, force: FloatArray) -> float:
    """Return the angle in a pyramid's frame against the tangential part of a force."""
    one, two = pyramid.frame or (np.zeros(3), np.zeros(3))
    return math.atan2(-float(two @ force), -float(one @ force))


def _solved(mode: Sliding, turning: list[int], angles: FloatArray) -> FloatArray | None:
    """Return forces of a mode whose contacts have friction against given directions."""
    edges = [
        one.edges if mode.letters[i] != SEPARATES else one.edges[:0] for i, one in enumerate(mode.pyramids)
    ]
    for i, angle in zip(turning, angles.tolist(), strict=True):
        one, two = mode.pyramids[i].frame or (np.zeros(3), np.zeros(3))
        way = math.cos(angle) * one + math.sin(angle) * two
        edges[i] = (mode.touching[i].normal - mode.touching[i].friction * way)[None, :]
    return _forces(mode, edges)


def _errors(mode: Sliding, turning: list[int], angles: FloatArray, forces: FloatArray) -> FloatArray:
    """Return the angles, (k,), from given directions to the sliding, in (-pi, pi], or NaN where it stops."""
    motion = np.append(mode.free + mode.of_forces @ forces.ravel(), 1.0)
    actual = []
    for i in turning:
        x, y = np.array(mode.pyramids[i].frame) @ (mode.touching[i].point @ motion)
        actual.append(math.atan2(y, x) if math.hypot(x, y) > STRICT else math.nan)
    turned: FloatArray = (np.array(actual) - angles + math.pi) % (2.0 * math.pi) - math.pi
    return turned


def _forces(mode: Sliding, edges: list[FloatArray]) -> FloatArray | None:
    """Return forces, (n, 3), on the edges that give the letters, or None if there are none."""
    starts = np.cumsum([0, *(len(one) for one in edges)])
    spread = np.zeros((3 * len(edges), int(starts[-1])))
    for i, one in enumerate(edges):
        spread[3 * i : 3 * i + 3, starts[i] : starts[i + 1]] = one.T
    of_edges = mode.of_forces @ spread
    sizes = np.linalg.norm(of_edges, axis=0)
    sizes[sizes == 0.0] = 1.0
    zero, positive = [np.zeros((0, 7))], [np.zeros((0, 7))]
    for contact, letter in zip(mode.touching, mode.letters, strict=True):
        if letter == SEPARATES:
            positive.append((contact.normal @ contact.point)[None, :])
        elif letter == STICKS:
            zero.append(contact.point)
        else:
            zero.append((contact.normal @ contact.point)[None, :])
    leaving = np.vstack(positive)
    leaving[:, -1] -= STRICT
    rows = np.vstack([*zero, leaving])
    count = len(sizes)
    table = np.column_stack([of_edges / sizes, mode.free])
    program = Program.stated(table, rows, range(count, count + len(rows)))
    program = program.renamed(list(range(count)), len(rows) - len(leaving))
    if not program.solve():
        return None
    found: FloatArray = (spread @ (program.shares(count) / sizes)).reshape(-1, 3)
    return found
