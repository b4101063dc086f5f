# SPDX-License-Identifier: Apache-2.0
"""The mode that contact forces bring about: its accelerations, its letters and the directions of sliding.

Many forces may bring about the same motion, as under four feet. The answer shows those of least sum of
squares. There is one such set of forces, so a symmetric problem has symmetric forces.

Forces f in a product K of round cones have to cause a wrench, A f = b. The least f is the projection of
transpose(A) y onto K, where y, with six components, minimises a convex function. Newton's method finds it (Qi
and Sun, A nonsmooth version of Newton's method, 1993).
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.contact_modes.letters import SEPARATES, STAYS, STICKS
from contact_dynamics.contact_modes.result import ResponseMode, SpatialMode
from contact_dynamics.numerics.vectors import cross_of_two
from contact_dynamics.tolerances import (
    LARGEST_NUMBER,
    LEAST_FORCE_FLAT,
    LEAST_FORCE_MET,
    LEAST_FORCE_SEEN,
    MODE_STRAIGHT,
    ON_PYRAMIDS_SIDE,
    SAME_MOTION,
    SLIDING_ROUNDED,
    STRICT,
)

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.spatial.problem import SpatialCase
    from contact_dynamics.validation import FloatArray


def mode_with_forces(
    case: SpatialCase,
    touching_letters: str,
    own: FloatArray,
    *,
    forces_unique: bool,
    motion_unique: bool,
    slowest: float = STRICT,
) -> ResponseMode:
    """Return the mode that forces, (n, 3), of the touching contacts bring about, in the units of the motion.

    A contact without friction that begins to slide more slowly than ``slowest``, relative to the largest
    acceleration, sticks.
    """
    motion, contacts, sliding, touching, _ = case
    forces = np.zeros((len(contacts), 3))
    forces[touching] = own * motion.scale
    accelerations = motion.motion(forces)
    points = motion.accelerations(accelerations)
    across = points - np.sum(points * contacts.normals_W, axis=1)[:, None] * contacts.normals_W
    pressing = np.abs([*forces, forces.sum(axis=0)]).max() / motion.mass
    rounding = SLIDING_ROUNDED * max(float(np.abs(points).max(initial=0.0)), float(pressing))
    letters = [SEPARATES] * len(contacts)
    directions = np.zeros_like(points)
    for i, letter in zip(touching.tolist(), touching_letters, strict=True):
        way = sliding[i] if np.any(sliding[i]) else across[i]
        size = float(np.linalg.norm(way))
        # Without friction one letter stands for both, and the acceleration says whether the contact slides.
        smooth = letter == STAYS and contacts.holding_frictions[i] == 0.0
        rests = smooth and not np.any(sliding[i]) and size <= slowest * motion.scale
        letters[i] = STICKS if rests else letter
        if letters[i] == STAYS:
            friction = forces[i] - float(forces[i] @ contacts.normals_W[i]) * contacts.normals_W[i]
            rubs = float(np.linalg.norm(friction))
            aside = float(np.linalg.norm(cross_of_two(friction, way)))
            begins = not np.any(sliding[i]) and friction @ way < 0.0
            rounded = begins and aside <= rounding * rubs
            if rubs > 0.0 and (rounded or size <= STRICT * motion.scale):
                way, size = -friction, rubs  # friction shows the direction better than the acceleration
            directions[i] = way / size if size > 0.0 else way
    of_contacts: dict[str, Any] = {
        "mode": "".join(letters),
        "contact_forces_W": forces,
        "contact_accelerations_W": points,
        "tangential_directions_W": directions,
        "misdirection": misdirection(forces, directions, contacts.normals_W),
        "forces_unique": forces_unique,
        "motion_unique": motion_unique,
    }
    if not motion.of_body:
        return ResponseMode(**of_contacts)
    return SpatialMode(
        acceleration_W=accelerations[:3], angular_acceleration_W=accelerations[3:], **of_contacts
    )


def with_least_forces(case: SpatialCase, mode: ResponseMode) -> ResponseMode:
    """Return a mode with those of its forces that have the least sum of squares."""
    if (
        mode.forces_unique or mode.misdirection > MODE_STRAIGHT
    ):  # friction on the edges of pyramids stays there
        return mode
    acting = [i for i, letter in enumerate(mode.mode) if letter != SEPARATES]
    normals = case.contacts.normals_W[acting]
    frictions = np.minimum(case.contacts.frictions[acting], LARGEST_NUMBER)
    holding = np.minimum(case.contacts.holding_frictions[acting], LARGEST_NUMBER)
    slides = mode.tangential_directions_W[acting]
    rays = slides.any(axis=1)
    axes = normals - frictions[:, None] * slides
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    columns = (3 * np.array(acting)[:, None] + np.arange(3)).ravel()
    effects = (case.motion.points / case.motion.lengths).T[:, columns]
    forces = mode.contact_forces_W.copy()
    forces[acting] = least_forces(effects, forces[acting], axes, np.where(rays, 0.0, holding))
    return replace(
        mode,
        contact_forces_W=forces,
        misdirection=misdirection(forces, mode.tangential_directions_W, case.contacts.normals_W),
    )


def are_the_same(case: SpatialCase, mode: ResponseMode, other: ResponseMode) -> bool:
    """Return whether two modes of a case have the same letters and, where it is unique, the same motion."""
    if mode.mode != other.mode:
        return False
    if not (mode.motion_unique and other.motion_unique):
        return True
    one, two = case.motion.motion(mode.contact_forces_W), case.motion.motion(other.contact_forces_W)
    return bool(np.abs(one - two).max() <= SAME_MOTION * (1.0 + np.abs(one).max()))


_MAX_STEPS: Final = 60
"""Newton's method takes about five steps, and some thirty where friction is at its limit at each contact."""

_MAX_HALVINGS: Final = 40


def least_forces(
    effects: FloatArray, forces: FloatArray, axes: FloatArray, frictions: FloatArray
) -> FloatArray:
    """Return the forces, (n, 3), of least sum of squares in the same cones and with the same effects.

    The effects of unit forces are (k, 3 n). The axes of the cones, (n, 3), are unit vectors, from which
    forces may lean by ``frictions``, (n,). A cone with 0 is a ray.
    """
    _, sizes, V = np.linalg.svd(effects, full_matrices=False)
    V = V[sizes > LEAST_FORCE_SEEN * sizes.max(initial=0.0)]
    aim = V @ forces.ravel()
    if not aim.any():
        return np.zeros_like(forces)
    least = _newton(V, aim, axes, frictions)
    return forces if least is None else least + 0.0  # there is no minus zero in an answer


def misdirection(forces: FloatArray, directions: FloatArray, normals: FloatArray) -> float:
    """Return the largest angle, rad, between friction and the way against sliding, if there is any."""
    largest = 0.0
    slack = ON_PYRAMIDS_SIDE * float(np.abs(forces).max(initial=0.0))
    for force, way, normal in zip(forces, directions, normals, strict=True):
        friction = force - (force @ normal) * normal
        if np.any(way) and float(np.linalg.norm(friction)) > slack:
            across = float(np.linalg.norm(cross_of_two(friction, way)))
            largest = max(largest, math.atan2(across, -float(friction @ way)))
    return largest


def _newton(V: FloatArray, aim: FloatArray, axes: FloatArray, frictions: FloatArray) -> FloatArray | None:
    """Return the projection onto the cones of some y V that V maps to the aim, or None if none is found."""
    y, size = aim, float(np.linalg.norm(aim))

    def at(y: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, float]:
        projected, slopes = _projected((y @ V).reshape(-1, 3), axes, frictions)
        return (
            projected,
            slopes,
            aim - V @ projected.ravel(),
            0.5 * float(np.sum(projected**2)) - float(aim @ y),
        )

    projected, slopes, left, height = at(y)
    for _ in range(_MAX_STEPS):
        if float(np.linalg.norm(left)) <= LEAST_FORCE_MET * size:
            return projected + (left @ V).reshape(-1, 3)
        blocks = V.reshape(len(V), -1, 3)
        curvature = np.einsum("rni,nij,snj->rs", blocks, slopes, blocks)
        # Where the function is flat along some direction, the further term leads far out along it.
        further = LEAST_FORCE_FLAT * float(np.linalg.norm(left)) / size
        step = np.linalg.solve(curvature + further * np.eye(len(curvature)), left)
        for _ in range(_MAX_HALVINGS):
            trial = at(y + step)
            # Near the end rounding hides a gain of the function, but not what is left.
            if trial[3] <= height or float(np.linalg.norm(trial[2])) < 0.5 * float(np.linalg.norm(left)):
                break
            step = 0.5 * step
        else:
            return None
        y = y + step
        projected, slopes, left, height = trial
    return None


def _projected(points: FloatArray, axes: FloatArray, frictions: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the nearest points in the cones, (n, 3), and their derivatives by the points, (n, 3, 3)."""
    along = np.sum(points * axes, axis=1)
    across = points - along[:, None] * axes
    lean = np.linalg.norm(across, axis=1)
    inside = lean <= frictions * along
    outside = ~inside & (along + frictions * lean > 0.0)
    ways = across / np.where(lean > 0.0, lean, 1.0)[:, None]
    edges = axes + frictions[:, None] * ways
    shares = (along + frictions * lean) / (1.0 + frictions**2)
    nearest = np.where(inside[:, None], points, np.where(outside[:, None], shares[:, None] * edges, 0.0))
    turning = np.eye(3) - _outer(axes) - _outer(ways)
    rates = frictions * shares / np.where(lean > 0.0, lean, 1.0)
    on_edge = _outer(edges) / (1.0 + frictions**2)[:, None, None] + rates[:, None, None] * turning
    slopes = np.where(inside[:, None, None], np.eye(3), np.where(outside[:, None, None], on_edge, 0.0))
    return nearest, slopes


def _outer(vectors: FloatArray) -> FloatArray:
    return vectors[:, :, None] * vectors[:, None, :]
