# SPDX-License-Identifier: Apache-2.0
"""Modes in space by construction: accelerations and forces are chosen, and the load follows from them.

Contacts lean against each other. Some separate, some slide from rest, some stick. Where the body turns about
contacts that are at rest, others slide already.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

MASS = 2.0
INERTIA = np.diag([0.3, 0.4, 0.5])  # kg m^2, world axes
CLEARLY = 0.01  # m/s^2: how fast what separates or slides does so at least
ROUNDING = 1e-9
MAX_GRIP = 0.95  # the part of its friction that a contact that sticks uses at most


class Made(NamedTuple):
    """A body with its centre of mass at the origin, and a mode that it has."""

    points: np.ndarray  # (n, 3), m
    normals: np.ndarray  # (n, 3), unit
    frictions: np.ndarray  # (n,)
    v: np.ndarray  # (3,), m/s, of the centre of mass
    w: np.ndarray  # (3,), rad/s
    wrench: np.ndarray  # (6,), the applied force and torque
    letters: str
    motion: np.ndarray  # (6,), the accelerations, linear and angular


def made(seed: int) -> Made:
    """Return a body with two to four contacts, of which one at least begins to slide."""
    chance = np.random.default_rng(seed)
    while True:
        found = _tried(chance, turns=seed % 4 == 3)
        if found is not None:
            return found


def _tried(chance: np.random.Generator, *, turns: bool) -> Made | None:
    """Return a mode, or None if what was drawn does not fit together."""
    n = int(chance.integers(2, 5))
    points, normals = chance.normal(size=(n, 3)), chance.normal(size=(n, 3))
    w = chance.normal(size=3) if turns else np.zeros(3)
    centre = points[0].copy()
    resting = int(chance.integers(1, n + 1)) if turns else n
    points[:resting] = centre + np.outer(chance.normal(size=resting), w) if turns else points
    velocities = np.cross(w, points - centre)
    for i in range(resting, n):  # the normal is across the velocity
        normals[i] -= normals[i] @ velocities[i] * velocities[i] / (velocities[i] @ velocities[i])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    frictions = chance.choice([0.2, 0.5, 1.0, 2.0], size=n)
    letters = "".join(chance.choice(list("sccf"), size=n))
    letters = letters[:resting] + letters[resting:].replace("f", "c")
    if "c" not in letters[:resting]:
        return None
    centripetal = np.cross(w, np.cross(w, points))
    motion = _motion(chance, points, normals, letters, centripetal)
    accelerations = motion[:3] + np.cross(motion[3:], points) + centripetal
    rising = np.sum(accelerations * normals, axis=1)
    ways = accelerations - rising[:, None] * normals
    if not all(_fits(*one) for one in zip(letters, rising, np.linalg.norm(ways, axis=1), strict=True)):
        return None
    ways[resting:] = velocities[resting:]
    forces = np.zeros((n, 3))
    for i, letter in enumerate(letters):
        if letter == "f":
            ways[i] = np.cross(normals[i], chance.normal(size=3))
        ways[i] /= np.linalg.norm(ways[i])
        grip = float(chance.uniform(0.0, MAX_GRIP)) if letter == "f" else 1.0
        if letter != "s":
            forces[i] = chance.uniform(0.1, 2.0) * (normals[i] - grip * frictions[i] * ways[i])
    force = MASS * motion[:3] - forces.sum(axis=0)
    torque = INERTIA @ motion[3:] + np.cross(w, INERTIA @ w) - np.cross(points, forces).sum(axis=0)
    return Made(
        points=points,
        normals=normals,
        frictions=frictions,
        v=-np.cross(w, centre),
        w=w,
        wrench=np.concatenate([force, torque]),
        letters=letters,
        motion=motion,
    )


def _motion(
    chance: np.random.Generator,
    points: np.ndarray,
    normals: np.ndarray,
    letters: str,
    centripetal: np.ndarray,
) -> np.ndarray:
    """Return accelerations, (6,), with which contacts stay and stick as their letters say."""
    rows, wanted = [np.zeros((0, 6))], [np.zeros(0)]
    for point, normal, letter, own in zip(points, normals, letters, centripetal, strict=True):
        if letter != "s":
            demanded = np.eye(3) if letter == "f" else normal[None, :]
            rows.append(np.hstack([demanded, np.cross(point, demanded)]))  # d . (alpha x p) = alpha . (p x d)
            wanted.append(-demanded @ own)
    demands = np.vstack(rows)
    sizes, basis = np.linalg.svd(demands)[1:]
    free = basis[int((sizes > ROUNDING).sum()) :]
    least = np.linalg.lstsq(demands, np.concatenate(wanted), rcond=None)[0]
    return np.asarray(least + free.T @ chance.normal(size=len(free)))


def _fits(letter: str, rising: float, across: float) -> bool:
    """Return whether a contact with these accelerations away from and along the surface has its letter."""
    if letter == "s":
        return rising >= CLEARLY
    if letter == "f":
        return abs(rising) <= ROUNDING and across <= ROUNDING
    return abs(rising) <= ROUNDING and across >= CLEARLY
