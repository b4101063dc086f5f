# SPDX-License-Identifier: Apache-2.0
"""Modes of a body on one to four planes by construction: a motion and forces are chosen, the load follows.

A motion is drawn under which some contacts stay, and some of these stick. It gives each contact its letter,
and the letter gives each contact a force on Coulomb's cone. The applied wrench is what the equations of
motion then leave over. So the body has this mode, whatever else it has.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

CLEARLY = 0.02  # m/s^2 and m/s: how fast what separates or slides does so at least
ROUNDING = 1e-10
MAX_GRIP = 0.95  # the part of its friction that a contact that sticks uses at most
MASS = 2.0
INERTIA = np.diag([0.3, 0.4, 0.5])  # kg m^2, world axes


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


def made(seed: int, *, most: int = 8) -> Made:
    """Return a body with one to ``most`` contacts on one to four planes. It moves in a third of the draws."""
    chance = np.random.default_rng([24, seed])
    while True:
        found = _tried(chance, moves=seed % 3 == 2, most=most)
        if found is not None:
            return found


def _tried(chance: np.random.Generator, *, moves: bool, most: int) -> Made | None:
    """Return a mode, or None if what was drawn does not fit together."""
    n = int(chance.integers(1, most + 1))
    points, normals, plane = _layout(chance, n)
    v, w = _velocity(chance, points, normals) if moves else (np.zeros(3), np.zeros(3))
    velocities = v + np.cross(w, points)
    speeds = np.linalg.norm(velocities, axis=1)
    slides = speeds > ROUNDING
    if np.any(slides & (speeds < CLEARLY)):
        return None
    centripetal = np.cross(w, np.cross(w, points))
    stays, sticks = _wanted(chance, plane, ~slides)
    motion = _motion(chance, points, normals, (stays, sticks), centripetal)
    if motion is None:
        return None
    accelerations = motion[:3] + np.cross(motion[3:], points) + centripetal
    rising = np.sum(accelerations * normals, axis=1)
    ways = accelerations - rising[:, None] * normals
    across = np.linalg.norm(ways, axis=1)
    frictions = chance.choice([0.2, 0.5, 1.0], size=4)[plane]
    letters, forces = "", np.zeros((n, 3))
    for i in range(n):
        if rising[i] > ROUNDING:
            if rising[i] < CLEARLY:
                return None
            letters += "s"
            continue
        if rising[i] < -ROUNDING:
            return None
        grip, way = 1.0, velocities[i]
        if not slides[i]:
            way = ways[i]
            if across[i] < ROUNDING:
                grip = float(chance.uniform(0.0, MAX_GRIP))
                way = np.cross(normals[i], chance.normal(size=3))
            elif across[i] < CLEARLY:
                return None
        letters += "f" if not slides[i] and across[i] < ROUNDING else "c"
        pressing = float(chance.uniform(0.1, 2.0))
        forces[i] = pressing * (normals[i] - grip * frictions[i] * way / np.linalg.norm(way))
    force = MASS * motion[:3] - forces.sum(axis=0)
    torque = INERTIA @ motion[3:] + np.cross(w, INERTIA @ w) - np.cross(points, forces).sum(axis=0)
    return Made(points, normals, frictions, v, w, np.concatenate([force, torque]), letters, motion)


def _layout(chance: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return contact points and normals, (n, 3), and the plane of each contact."""
    count = int(chance.integers(1, min(4, n) + 1))
    axes = np.vstack([np.eye(3), -np.eye(3)])
    upright = chance.random() < 0.5
    ways = chance.permutation(axes)[:count] if upright else chance.normal(size=(count, 3))
    ways = ways / np.linalg.norm(ways, axis=1)[:, None]
    plane = np.concatenate([np.arange(count), chance.integers(count, size=n - count)])
    points = chance.choice(np.linspace(-0.5, 0.5, 11), size=(n, 3)) if upright else chance.normal(size=(n, 3))
    depth = chance.uniform(0.1, 0.6, size=count)
    normals = ways[plane]
    points = points - (np.sum(points * normals, axis=1) + depth[plane])[:, None] * normals
    return points, normals, plane


def _velocity(
    chance: np.random.Generator, points: np.ndarray, normals: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return velocities under which all contacts slide or rest, one of them at rest in half of the draws."""
    rows = np.hstack([normals, np.cross(points, normals)])
    if chance.random() < 0.5:
        eye = np.eye(3)
        rows = np.vstack([rows, np.hstack([eye, np.cross(points[0], eye)])])
    free = _free(rows)
    both = free.T @ chance.normal(size=len(free))
    return both[:3], both[3:]


def _wanted(
    chance: np.random.Generator, plane: np.ndarray, rests: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return which contacts are to stay, and which of them to stick, (n,) each."""
    n = len(plane)
    kept = chance.random(size=4) < 0.8
    stays = kept[plane] if chance.random() < 0.7 else chance.random(size=n) < 0.7
    return stays, stays & rests & (chance.random(size=n) < chance.choice([0.0, 0.2, 0.5, 1.0]))


def _motion(
    chance: np.random.Generator,
    points: np.ndarray,
    normals: np.ndarray,
    wanted: tuple[np.ndarray, np.ndarray],
    centripetal: np.ndarray,
) -> np.ndarray | None:
    """Return accelerations, (6,), under which no contact approaches, or None if those drawn let one."""
    stays, sticks = wanted
    rows, known = [np.zeros((0, 6))], [np.zeros(0)]
    for i in np.flatnonzero(stays):
        demanded = np.eye(3) if sticks[i] else normals[i][None, :]
        rows.append(np.hstack([demanded, np.cross(points[i], demanded)]))
        known.append(-demanded @ centripetal[i])
    demands, sums = np.vstack(rows), np.concatenate(known)
    least = np.linalg.lstsq(demands, sums, rcond=None)[0] if len(demands) else np.zeros(6)
    if len(demands) and np.abs(demands @ least - sums).max() > ROUNDING:
        return None
    free = _free(demands)
    for _ in range(20):
        motion = least + free.T @ chance.normal(size=len(free)) * 3.0
        rising = np.sum((motion[:3] + np.cross(motion[3:], points) + centripetal) * normals, axis=1)
        if rising.min() >= -ROUNDING:
            return np.asarray(motion)
    return None


def _free(rows: np.ndarray) -> np.ndarray:
    """Return the directions, (k, 6), that all rows, (m, 6), are across."""
    if len(rows) == 0:
        return np.eye(6)
    sizes, basis = np.linalg.svd(rows)[1:]
    return np.asarray(basis[int((sizes > 1e-9).sum()) :])


def worst_violation(
    case: Made, letters: str, motion: np.ndarray, forces: np.ndarray, accelerations: np.ndarray
) -> float:
    """Return by how much a mode misses mechanics, Coulomb's law or its letters, relative to its terms.

    Args:
        case: The body.
        letters: The mode.
        motion: (6,), its accelerations.
        forces: (n, 3), its contact forces.
        accelerations: (n, 3), those of its contact points.
    """
    moment = INERTIA @ motion[3:] + np.cross(case.w, INERTIA @ case.w)
    own = np.concatenate([MASS * motion[:3], moment])
    of_forces = np.concatenate([forces.sum(axis=0), np.cross(case.points, forces).sum(axis=0)])
    size = float(np.abs([*own, *of_forces, *case.wrench]).max())
    centripetal = np.cross(case.w, np.cross(case.w, case.points))
    points = motion[:3] + np.cross(motion[3:], case.points) + centripetal
    fast = float(np.abs([*motion, *centripetal.ravel(), *(case.wrench / MASS)]).max())
    missed = [np.abs(own - of_forces - case.wrench).max() / size, np.abs(points - accelerations).max() / fast]
    velocities = case.v + np.cross(case.w, case.points)
    for i, letter in enumerate(letters):
        normal, force = case.normals[i], forces[i]
        rising, pressing = float(points[i] @ normal), float(force @ normal)
        way, friction = points[i] - rising * normal, force - pressing * normal
        most = case.frictions[i] * pressing
        missed += [-rising / fast, -pressing / size]
        if letter == "s":
            missed += [float(np.linalg.norm(force)) / size, float(rising <= 0.0)]
            continue
        missed += [abs(rising) / fast, (float(np.linalg.norm(friction)) - most) / size]
        if letter == "f":
            missed.append(float(np.linalg.norm(way)) / fast)
            continue
        if np.linalg.norm(velocities[i]) > ROUNDING:
            way = velocities[i] - velocities[i] @ normal * normal
        missed.append(float(np.linalg.norm(friction + most * way / np.linalg.norm(way))) / size)
    return max(missed)
