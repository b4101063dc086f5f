# SPDX-License-Identifier: Apache-2.0
"""Modes of stacks at rest by construction: motions and forces are chosen, and the loads follow.

At each interface the upper body sticks to the lower one, slides on it, turns about one of the contacts,
or leaves it. The motion gives each contact its letter, and the letter gives it a force on Coulomb's cone. The
applied wrenches are what the equations of motion then leave over. So the stack has this mode, whatever else
it has.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

CLEARLY = 0.02  # m/s^2: how fast a contact that slides does so at least
MAX_GRIP = 0.95  # the part of its friction that a contact that sticks uses at most


class Stack(NamedTuple):
    """Bodies on each other, the first of them on the floor, and a mode that they have. World axes."""

    masses: np.ndarray  # (k,), kg
    inertias: np.ndarray  # (k, 3, 3), kg m^2, about the centres of mass
    centres: np.ndarray  # (k, 3), m
    points: np.ndarray  # (n, 3), m
    frictions: np.ndarray  # (n,)
    pairs: list[tuple[int, int | None]]
    forces: np.ndarray  # (k, 3), N, applied
    torques: np.ndarray  # (k, 3), N m, applied
    letters: str
    accelerations: np.ndarray  # (k, 3), m/s^2, of the centres of mass


def made(seed: int, *, bodies: int = 2) -> Stack:
    """Return a stack of some bodies with one to four contacts at each interface."""
    chance = np.random.default_rng([29, seed])
    while True:
        found = _tried(chance, bodies)
        if found is not None:
            return found


def _relative_motion(
    chance: np.random.Generator, kind: str, first: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return how a body moves on the one below: the acceleration at the origin, and the angular one."""
    way, turn = np.zeros(3), np.zeros(3)
    if kind == "slides":
        way[:2], turn[2] = chance.normal(size=2), chance.choice([0.0, 2.0]) * chance.normal()
    elif kind == "turns":  # the first contact sticks
        turn[2] = 5.0 * chance.normal()
        way = -np.cross(turn, first)
    elif kind == "leaves":
        way = np.append(chance.normal(size=2), chance.uniform(0.1, 1.0))
    return way, turn


def _tried(chance: np.random.Generator, k: int) -> Stack | None:
    """Return a stack, or None if a contact slides too slowly to count as sliding."""
    points, frictions, letters, forces, pairs = [], [], "", [], []
    linear, angular = np.zeros(3), np.zeros(3)  # of the body below, and of its point at the origin
    motions = []
    for body in range(k):
        count = int(chance.integers(1, 5))
        height = 0.2 * body
        own = np.column_stack([chance.uniform(-0.2, 0.2, size=(count, 2)), np.full(count, height)])
        kind = chance.choice(["sticks", "slides", "turns", "leaves"], p=[0.35, 0.3, 0.25, 0.1])
        way, turn = _relative_motion(chance, str(kind), own[0])
        friction = float(chance.choice([0.2, 0.5, 1.0]))
        for point in own:
            moves = way + np.cross(turn, point)
            speed = float(np.linalg.norm(moves[:2]))
            if 1e-12 < speed < CLEARLY:
                return None
            points.append(point)
            frictions.append(friction)
            pairs.append((body, body - 1 if body > 0 else None))
            force = np.zeros(3)
            if kind != "leaves":
                grip = float(chance.uniform(0.0, MAX_GRIP)) if speed < CLEARLY else 1.0
                lean = chance.normal(size=2) if speed < CLEARLY else moves[:2]
                force = np.append(-grip * friction * lean / np.linalg.norm(lean), 1.0)
                force *= float(chance.uniform(0.1, 2.0))
            letters += "s" if kind == "leaves" else "f" if speed < CLEARLY else "c"
            forces.append(force)
        linear, angular = linear + way, angular + turn
        motions.append((linear, angular))
    masses = np.exp(chance.normal(size=k))
    spread = chance.normal(size=(k, 3, 3))
    moments = 0.01 * np.einsum("kij,klj->kil", spread, spread)
    inertias = np.trace(moments, axis1=1, axis2=2)[:, None, None] * np.eye(3) - moments
    centres = np.array([[0.0, 0.0, 0.2 * body + 0.1] for body in range(k)])
    accelerations = np.array([a + np.cross(alpha, c) for (a, alpha), c in zip(motions, centres, strict=True)])
    applied = masses[:, None] * accelerations
    torques = np.array([one @ alpha for one, (_, alpha) in zip(inertias, motions, strict=True)])
    for point, force, pair in zip(points, forces, pairs, strict=True):
        for index, sign in zip(pair, (1.0, -1.0), strict=True):
            if index is not None:
                applied[index] -= sign * force
                torques[index] -= np.cross(point - centres[index], sign * force)
    return Stack(
        masses,
        inertias,
        centres,
        np.array(points),
        np.array(frictions),
        pairs,
        applied,
        torques,
        letters,
        accelerations,
    )
