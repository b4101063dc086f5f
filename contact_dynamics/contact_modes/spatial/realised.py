# SPDX-License-Identifier: Apache-2.0
"""Forces that realise a mode which the search found, exactly where they can be exact.

A body that stays rests to rounding. Where contacts at rest come to slide, friction on a pyramid is up to half
a sector away from the direction against their sliding. Here each contact has one edge. Newton's method seeks
its direction, such that it is straight against the sliding that the forces cause. Where that settles in the
same letters, the mode obeys Coulomb's round cone at every contact that slides. Contacts that stick keep their
pyramids, which lie inside the round cones.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact_modes.letters import SEPARATES, STAYS, STICKS
from contact_dynamics.contact_modes.spatial.dual_simplex import Program
from contact_dynamics.contact_modes.spatial.mode_with_forces import mode_with_forces
from contact_dynamics.contact_modes.spatial.problem import FRICTION_FACETS, search_of
from contact_dynamics.contact_modes.spatial.round_cones import held_by_round_cones, polished, sticking
from contact_dynamics.tolerances import (
    MODE_BETTER,
    MODE_RESTS,
    ROUND_CONE_APART,
    ROW_TOLERANCE,
    SETTLED_DIRECTION,
    STRICT,
    TRIAL_TURN,
)

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.result import ResponseMode
    from contact_dynamics.contact_modes.spatial.options import Pyramid
    from contact_dynamics.contact_modes.spatial.problem import SpatialCase
    from contact_dynamics.contact_modes.spatial.search import Found, Search
    from contact_dynamics.validation import FloatArray


_MAX_STEPS: Final = 12
"""Each step solves for the forces, in 0.1 ms, once for each contact that slides. Four steps suffice where
there is a solution nearby."""

_LONGEST_STEP: Final = 0.3
"""rad. This is a little less than half a sector of the usual pyramid, which is 0.39 rad."""

_FAST: Final = 0.1
"""The share of its error that a step may leave where directions just follow the sliding. If a step leaves
more, Newton's method, which needs derivatives, takes over."""


def realised(case: SpatialCase, search: Search, found: Found, *, sharpen: bool) -> ResponseMode:
    """Return a mode that the search found, with accelerations and forces that realise it."""
    count = search.edges.shape[1]
    shares = found.program.shares(count)
    motion_unique, low, high = found.motion
    if not motion_unique and low is not None and high is not None:
        shares = 0.5 * (low + high)  # this is away from the borders of the mode
    mixture = np.random.default_rng(26).normal(size=len(search.edges))
    forces_unique = found.program.ends(mixture @ search.edges).unique
    own = (search.edges @ shares).reshape(-1, 3)
    letters = "".join(one.letter for one in found.letters)
    if sharpen and motion_unique and any(one.item >= 0 for one in found.letters):
        exact = _sharpened(search, letters, own)
        own = own if exact is None else exact
    if set(letters) == {STICKS}:
        own = _rested(search, own)
    unique = motion_unique or forces_unique
    return mode_with_forces(case, letters, own, forces_unique=forces_unique, motion_unique=unique)


def as_given(case: SpatialCase, mode: ResponseMode) -> ResponseMode:
    """Return a mode of flush contacts, with forces under which the given ones rest if all of them stick.

    Any other mode stays that of the flush contacts.
    """
    given = case.given
    letters = "".join(mode.mode[i] for i in case.touching.tolist())
    if given is None or set(letters) != {STICKS}:
        return mode
    own = mode.contact_forces_W[case.touching] / given.motion.scale
    normals = given.contacts.normals_W[case.touching]
    pressing = np.sum(own * case.contacts.normals_W[case.touching], axis=1)
    own += (pressing - np.sum(own * normals, axis=1))[:, None] * normals
    own = _rested(search_of(given, FRICTION_FACETS), own)
    return mode_with_forces(
        given, letters, own, forces_unique=mode.forces_unique, motion_unique=mode.motion_unique
    )


def _rested(search: Search, forces: FloatArray) -> FloatArray:
    """Return forces under which a body rests to rounding.

    The given forces do so to the tolerance within which conditions on nearly the same contacts are merged.
    """
    rows = sticking(search)
    motion = np.append(search.motion[:, -1] + search.of_forces @ forces.ravel(), 1.0)
    if float(np.abs(rows @ motion).max()) > STRICT:  # what tells merged contacts apart was lost
        held = held_by_round_cones(search, rows)
        forces = forces if held.forces is None else held.forces

    def left(forces: FloatArray) -> float:
        """Return the size of the wrench that forces leave unbalanced."""
        return float(np.linalg.norm(search.mass @ (search.motion[:, -1] + search.of_forces @ forces.ravel())))

    enough = MODE_RESTS * left(np.zeros_like(forces))
    if left(forces) <= enough:
        return forces
    better = polished(search, rows, forces)
    best = better if left(better) <= MODE_BETTER * left(forces) else forces
    for tolerance in (ROW_TOLERANCE, ROUND_CONE_APART):
        if left(best) <= enough:
            break
        # The merged conditions hold, and forces elsewhere in the cones meet all of them.
        held = held_by_round_cones(search, rows, tolerance=tolerance)
        if held.forces is not None and left(held.forces) <= MODE_BETTER * left(best):
            best = held.forces
    return best


def _sharpened(search: Search, letters: str, forces: FloatArray) -> FloatArray | None:
    """Return forces, (n, 3), with exact friction, or None if the directions do not settle with these letters.

    The given forces are those with which the search found the letters.
    """
    pyramids = search.pyramids
    turning = [i for i, one in enumerate(pyramids) if letters[i] == STAYS and one.frame is not None]
    angles: FloatArray = np.asarray([_against(pyramids[i], forces[i]) for i in turning])
    followed = _followed(search, letters, turning, angles)
    return _by_newton(search, letters, turning, angles) if followed is None else followed


def _followed(search: Search, letters: str, turning: list[int], angles: FloatArray) -> FloatArray | None:
    """Turn friction against the sliding while that settles fast, as where all contacts slide one way."""
    last = math.inf
    while True:
        found = _solved(search, letters, turning, angles)
        if found is None:
            return None
        errors = _errors(search, turning, angles, found)
        error = float(np.abs(errors).max())
        if error <= SETTLED_DIRECTION:
            return found
        if not error <= _FAST * last:
            return None
        angles, last = angles + errors, error


def _by_newton(search: Search, letters: str, turning: list[int], angles: FloatArray) -> FloatArray | None:
    """Turn friction against the sliding by Newton's method, from given angles."""
    step: FloatArray = np.zeros(len(turning))
    for _ in range(_MAX_STEPS):
        found = _solved(search, letters, turning, angles + step)
        if found is None:
            step = 0.5 * step  # back towards directions that gave the mode
            continue
        angles = angles + step
        errors = _errors(search, turning, angles, found)
        if np.abs(errors).max() <= SETTLED_DIRECTION:
            return found
        slopes = _slopes(search, letters, turning, angles, errors)
        if slopes is None:
            return None
        step = np.asarray(np.linalg.lstsq(slopes, -errors, rcond=None)[0], dtype=float)
        step *= min(1.0, _LONGEST_STEP / max(float(np.abs(step).max()), SETTLED_DIRECTION))
    return None


def _slopes(
    search: Search, letters: str, turning: list[int], angles: FloatArray, errors: FloatArray
) -> FloatArray | None:
    """Return how the errors change with the directions, (k, k), or None where the mode ends there."""
    found = np.zeros((len(turning), len(turning)))
    for k, trial in enumerate(TRIAL_TURN * np.eye(len(turning))):
        beside = _solved(search, letters, turning, angles + trial)
        if beside is None:
            return None
        found[:, k] = (_errors(search, turning, angles + trial, beside) - errors) / TRIAL_TURN
    return None if np.isnan(found).any() else found


def _against(pyramid: Pyramid, force: FloatArray) -> float:
    """Return the angle in a pyramid's frame against the tangential part of a force."""
    one, two = pyramid.frame or (np.zeros(3), np.zeros(3))
    return math.atan2(-float(two @ force), -float(one @ force))


def _solved(search: Search, letters: str, turning: list[int], angles: FloatArray) -> FloatArray | None:
    """Return forces of a mode whose contacts have friction against given directions."""
    edges = [one.edges if letters[i] != SEPARATES else one.edges[:0] for i, one in enumerate(search.pyramids)]
    for i, angle in zip(turning, angles.tolist(), strict=True):
        one, two = search.pyramids[i].frame or (np.zeros(3), np.zeros(3))
        way = math.cos(angle) * one + math.sin(angle) * two
        edges[i] = (search.touching[i].normal - search.touching[i].friction * way)[None, :]
    return _forces(search, letters, edges)


def _errors(search: Search, turning: list[int], angles: FloatArray, forces: FloatArray) -> FloatArray:
    """Return the angles, (k,), from given directions to the sliding, in (-pi, pi], or NaN where it stops."""
    motion = np.append(search.motion[:, -1] + search.of_forces @ forces.ravel(), 1.0)
    actual = []
    for i in turning:
        x, y = np.array(search.pyramids[i].frame) @ (search.touching[i].point @ motion)
        actual.append(math.atan2(y, x) if math.hypot(x, y) > STRICT else math.nan)
    turned: FloatArray = (np.array(actual) - angles + math.pi) % (2.0 * math.pi) - math.pi
    return turned


def _forces(search: Search, letters: str, edges: list[FloatArray]) -> FloatArray | None:
    """Return forces, (n, 3), on the edges that give the letters, or None if there are none."""
    starts = np.cumsum([0, *(len(one) for one in edges)])
    spread = np.zeros((3 * len(edges), int(starts[-1])))
    for i, one in enumerate(edges):
        spread[3 * i : 3 * i + 3, starts[i] : starts[i + 1]] = one.T
    of_edges = search.of_forces @ spread
    sizes = np.linalg.norm(of_edges, axis=0)
    sizes[sizes == 0.0] = 1.0
    nothing = np.zeros((0, search.freedoms + 1))
    zero, positive = [nothing], [nothing]
    for contact, letter in zip(search.touching, letters, strict=True):
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
    table = np.column_stack([of_edges / sizes, search.motion[:, -1]])
    program = Program.stated(table, rows, range(count, count + len(rows)))
    program = program.renamed(list(range(count)), len(rows) - len(leaving))
    if not program.solve():
        return None
    found: FloatArray = (spread @ (program.shares(count) / sizes)).reshape(-1, 3)
    return found
