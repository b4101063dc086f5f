# SPDX-License-Identifier: Apache-2.0
"""The mode that contact forces bring about: its accelerations, its letters and the directions of sliding."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.contact_modes.letters import SEPARATES, STAYS, STICKS
from contact_dynamics.contact_modes.spatial.least_forces import least_forces, misdirection
from contact_dynamics.contact_modes.spatial.result import SpatialMode
from contact_dynamics.tolerances import MODE_STRAIGHT, SAME_MOTION, STRICT

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
) -> SpatialMode:
    """Return the mode that forces bring about.

    Args:
        case: The body with its contacts.
        touching_letters: s, c or f for each touching contact.
        own: (n, 3), the forces of the touching contacts, in the units of the motion.
        forces_unique: Whether the forces are the only ones with this mode.
        motion_unique: Whether the accelerations are the only ones with this mode.
        slowest: What begins to slide more slowly without friction sticks, relative to the largest
            acceleration.
    """
    motion, contacts, sliding, touching, _ = case
    forces = np.zeros((len(contacts), 3))
    forces[touching] = own * motion.scale
    body = motion.free + motion.of_forces @ forces.ravel()
    points = (motion.points @ body).reshape(-1, 3) + motion.turning
    across = points - np.sum(points * contacts.normals_W, axis=1)[:, None] * contacts.normals_W
    letters = [SEPARATES] * len(contacts)
    directions = np.zeros_like(points)
    for i, letter in zip(touching.tolist(), touching_letters, strict=True):
        way = sliding[i] if np.any(sliding[i]) else across[i]
        size = float(np.linalg.norm(way))
        # Without friction one letter stands for both, and the acceleration says whether the contact slides.
        smooth = letter == STAYS and contacts.frictions[i] == 0.0
        rests = smooth and not np.any(sliding[i]) and size <= slowest * motion.scale
        letters[i] = STICKS if rests else letter
        if letters[i] == STAYS:
            friction = forces[i] - float(forces[i] @ contacts.normals_W[i]) * contacts.normals_W[i]
            if size <= STRICT * motion.scale and friction.any():
                way, size = -friction, float(np.linalg.norm(friction))  # the sliding is hardly above rounding
            directions[i] = way / size if size > 0.0 else way
    return SpatialMode(
        mode="".join(letters),
        acceleration_W=body[:3],
        angular_acceleration_W=body[3:],
        contact_forces_W=forces,
        contact_accelerations_W=points,
        tangential_directions_W=directions,
        misdirection=misdirection(forces, directions, contacts.normals_W),
        forces_unique=forces_unique,
        motion_unique=motion_unique,
    )


def with_least_forces(case: SpatialCase, mode: SpatialMode) -> SpatialMode:
    """Return a mode with those of its forces that have the least sum of squares."""
    if (
        mode.forces_unique or mode.misdirection > MODE_STRAIGHT
    ):  # friction on the edges of pyramids stays there
        return mode
    acting = [i for i, letter in enumerate(mode.mode) if letter != SEPARATES]
    normals, frictions = case.contacts.normals_W[acting], case.contacts.frictions[acting]
    slides = mode.tangential_directions_W[acting]
    rays = slides.any(axis=1)
    axes = normals - frictions[:, None] * slides
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    columns = (3 * np.array(acting)[:, None] + np.arange(3)).ravel()
    effects = (case.motion.points / case.motion.lengths).T[:, columns]
    forces = mode.contact_forces_W.copy()
    forces[acting] = least_forces(effects, forces[acting], axes, np.where(rays, 0.0, frictions))
    return replace(
        mode,
        contact_forces_W=forces,
        misdirection=misdirection(forces, mode.tangential_directions_W, case.contacts.normals_W),
    )


def are_the_same(mode: SpatialMode, other: SpatialMode) -> bool:
    """Return whether two modes have the same letters and, where it is unique, the same motion."""
    if mode.mode != other.mode:
        return False
    if not (mode.motion_unique and other.motion_unique):
        return True
    one = np.concatenate([mode.acceleration_W, mode.angular_acceleration_W])
    two = np.concatenate([other.acceleration_W, other.angular_acceleration_W])
    return bool(np.abs(one - two).max() <= SAME_MOTION * (1.0 + np.abs(one).max()))
