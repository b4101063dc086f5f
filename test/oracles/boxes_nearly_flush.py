# SPDX-License-Identifier: Apache-2.0
"""Boxes whose contacts would be flush but for noise: on feet, in slots, in stacks and as pegs in holes.

Each box is placed exactly and turned at random. Then noise of one size is added to its normals, or to its
points, or to both. The load is that of forces drawn within the friction cones, or weight and a push, or a
push along the free direction under which the box slides.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

KINDS = ("feet", "slot", "stack", "peg")
LOADS = ("held", "pushed", "sliding")
GRAVITY = 9.81  # m/s^2
MASS = 2.0  # kg


class Flush(NamedTuple):
    """A box of 2 kg with its centre of mass at the origin."""

    points: np.ndarray  # (n, 3), m
    normals: np.ndarray  # (n, 3), unit
    frictions: np.ndarray  # (n,)
    wrench: np.ndarray  # (6,), applied force and torque
    velocity: np.ndarray  # (3,), m/s; the box does not turn
    inertia: np.ndarray  # (3,), kg m^2, about the world axes
    kind: str
    load: str


def flush(seed: int, noise: float) -> Flush:
    """Return a box; its kind, load and place depend on the seed alone."""
    chance = np.random.default_rng(seed)
    kind, load = KINDS[seed % len(KINDS)], str(chance.choice(LOADS))
    half = chance.uniform(0.05, 0.3, size=3)
    points, normals, free = _places(kind, half, chance)
    turn = _turn(chance) if chance.random() < 0.5 else np.eye(3)
    points, normals, free, down = points @ turn.T, normals @ turn.T, turn @ free, turn @ [0.0, 0.0, -1.0]
    frictions = np.full(len(points), chance.choice([0.0, 0.1, 0.3, 0.5, 1.0], p=[0.1, 0.2, 0.3, 0.3, 0.1]))
    if chance.random() < 0.3:
        frictions = chance.choice([0.1, 0.3, 0.5], size=len(points))
    velocity = np.zeros(3)
    if load == "held":
        wrench = _balanced(chance, points, normals, 0.9 * frictions)
    else:
        push = chance.normal(size=3) * 10.0 ** chance.uniform(-1.0, 1.0)
        wrench = np.concatenate([MASS * GRAVITY * down + push, 0.1 * chance.normal(size=3)])
        if chance.random() < 0.3:
            wrench[3:] = 0.0
        if load == "sliding":
            velocity = free * chance.choice([-1.0, 1.0])
    which = chance.integers(3)
    points = points + (which != 0) * noise * 0.2 * chance.normal(size=points.shape)
    normals = normals + (which != 1) * noise * chance.normal(size=points.shape)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    inertia = MASS / 3.0 * np.array([half[1] ** 2 + half[2] ** 2] * 3)
    return Flush(points, normals, frictions, wrench, velocity, inertia, kind, load)


def _turn(chance: np.random.Generator) -> np.ndarray:
    found: np.ndarray = np.linalg.qr(chance.normal(size=(3, 3)))[0]
    found[:, 0] *= np.sign(np.linalg.det(found))
    return found


def _places(
    kind: str, half: np.ndarray, chance: np.random.Generator
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return points, normals and a direction in which the box can slide."""
    x, y, z = half
    floor = [(a, b, -z) for a in (-x, x) for b in (-y, y)]
    up = [(0.0, 0.0, 1.0)] * 4
    if kind == "feet":
        return np.array(floor), np.array(up), np.array([0.6, 0.8, 0.0])
    if kind == "slot":  # a floor and walls to both sides, along y
        heights = [float(chance.choice([-z, 0.0, z]))] * 2
        walls = [(side * x, b, heights[0]) for side in (-1, 1) for b in (-y, y)]
        inward = [(-side, 0.0, 0.0) for side in (-1, 1) for _ in (-y, y)]
        below = floor if chance.random() < 0.7 else [(0.0, -y, -z), (0.0, y, -z)]
        return np.array(below + walls), np.array(up[: len(below)] + inward), np.array([0.0, 1.0, 0.0])
    if kind == "stack":  # on a floor, and below something as wide
        above = [(a, b, z) for a in (-x, x) for b in (-y, y)]
        return (np.array(floor + above), np.array(up + [(0.0, 0.0, -1.0)] * 4), np.array([0.6, 0.8, 0.0]))
    count = int(chance.integers(3, 5))  # around a peg, at two heights
    angles = 2.0 * np.pi * np.arange(count) / count + chance.choice([0.0, 0.4])
    out = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(count)])
    rings = [x * out + [0.0, 0.0, height] for height in (-z, z)]
    points, normals = np.vstack(rings), np.tile(-out, (2, 1))
    if chance.random() < 0.5:  # and at the bottom
        points, normals = np.vstack([points, [[0.0, 0.0, -z]]]), np.vstack([normals, [[0.0, 0.0, 1.0]]])
    return points, normals, np.array([0.0, 0.0, 1.0])


def _balanced(
    chance: np.random.Generator, points: np.ndarray, normals: np.ndarray, most: np.ndarray
) -> np.ndarray:
    """Return the load that forces within the cones balance."""
    leaning = chance.normal(size=points.shape)
    leaning -= np.sum(leaning * normals, axis=1)[:, None] * normals
    leaning /= np.linalg.norm(leaning, axis=1)[:, None]
    share = chance.uniform(0.0, 1.0, size=(len(points), 1)) * most[:, None]
    forces = chance.uniform(0.1, 5.0, size=(len(points), 1)) * (normals + share * leaning)
    return -np.concatenate([forces.sum(axis=0), np.cross(points, forces).sum(axis=0)])
