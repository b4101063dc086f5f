# SPDX-License-Identifier: Apache-2.0
"""Bodies at rest by construction: forces drawn within round cones, and the load that they balance.

Contacts are nearly the same in some way: points and normals are off by lengths and angles drawn on their own
logarithmic scales.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

KINDS = ("box", "doubled", "in line", "one doubled", "pinched", "corner")
LEAST, MOST = -14.0, -3.0  # decimal logarithms of the offsets


class Resting(NamedTuple):
    """A body of 2 kg at rest, with its centre of mass at the origin."""

    points: np.ndarray  # (n, 3), m
    normals: np.ndarray  # (n, 3), unit
    frictions: np.ndarray  # (n,)
    wrench: np.ndarray  # (6,), applied force and torque
    offsets: tuple[float, float]  # of points, m, and normals, rad


def resting(seed: int, *, max_friction: float = 0.9) -> Resting:
    """Return a body at rest whose contacts use at most a part of their friction."""
    chance = np.random.default_rng(seed)
    points, normals = _places(KINDS[seed % len(KINDS)], chance)
    offsets = tuple(float(10.0 ** chance.uniform(LEAST, MOST)) for _ in range(2))
    points = points + offsets[0] * chance.normal(size=points.shape)
    normals = normals / np.linalg.norm(normals, axis=1)[:, None]
    normals = normals + offsets[1] * chance.normal(size=points.shape)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    frictions = chance.choice([0.2, 0.5, 1.0, 2.0], size=len(points))
    return Resting(
        points, normals, frictions, _load(chance, points, normals, max_friction * frictions), offsets
    )


def rough(seed: int) -> tuple[Resting, float]:
    """Return a body at rest with friction of 1 to 1e6, and a radius of gyration of 1 to 1e-4 m."""
    chance = np.random.default_rng(seed)
    n = int(chance.integers(1, 5))
    points = chance.normal(size=(n, 3))
    normals = np.array([0.0, 0.0, 1.0]) + (0.0, 0.5, 3.0)[seed % 3] * chance.normal(size=(n, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    frictions = 10.0 ** chance.uniform(0.0, 6.0, size=n)
    wrench = _load(chance, points, normals, np.minimum(0.9 * frictions, 3.0))
    return Resting(points, normals, frictions, wrench, (0.0, 0.0)), float(10.0 ** chance.uniform(-4.0, 0.0))


def _load(
    chance: np.random.Generator, points: np.ndarray, normals: np.ndarray, most: np.ndarray
) -> np.ndarray:
    leaning = chance.normal(size=points.shape)
    leaning -= np.sum(leaning * normals, axis=1)[:, None] * normals
    leaning /= np.linalg.norm(leaning, axis=1)[:, None]
    share = chance.uniform(0.0, 1.0, size=(len(points), 1)) * most[:, None]
    forces = chance.uniform(0.1, 2.0, size=(len(points), 1)) * (normals + share * leaning)
    return -np.concatenate([forces.sum(axis=0), np.cross(points, forces).sum(axis=0)])


def _places(kind: str, chance: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    up = np.array([0.0, 0.0, 1.0])
    if kind == "box":
        return np.array([(x, y, -0.1) for x in (-0.1, 0.1) for y in (-0.1, 0.1)]), np.tile(up, (4, 1))
    if kind == "doubled":
        return tuple(np.repeat(chance.normal(size=(2, 3)), 2, axis=0) for _ in range(2))
    if kind == "in line":
        line = chance.normal(size=3) + np.outer([-1.0, 0.2, 1.0], chance.normal(size=3))
        return line, np.tile(chance.normal(size=3), (3, 1))
    if kind == "one doubled":
        return tuple(chance.normal(size=(3, 3))[[0, 1, 2, 0]] for _ in range(2))
    if kind == "pinched":
        normal = chance.normal(size=3)
        return np.repeat(chance.normal(size=(1, 3)), 2, axis=0), np.array([normal, -normal])
    floor = [(-0.1, -0.1, -0.1), (-0.1, 0.1, -0.1), (0.1, 0.0, -0.1)]
    wall = [(-0.1, 0.0, 0.0), (-0.1, 0.05, 0.05)]
    return np.array(floor + wall), np.array([up] * 3 + [(1.0, 0.0, 0.0)] * 2)
