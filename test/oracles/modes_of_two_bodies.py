# SPDX-License-Identifier: Apache-2.0
"""Every mode of bodies with few contacts in general position: each string of letters, from many directions.

Each contact separates, sticks or slides. With the directions of sliding given, the forces of a string follow
from as many linear equations. Newton's method turns the directions until friction opposes the sliding, from
starts all around the circle of each contact.
"""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np

STARTS = (0, 48, 16, 10)  # directions around the circle, by the number of contacts that begin to slide
STEPS = 30
STEP = 1e-7  # rad, of the derivatives
LONGEST = 0.5  # rad, that a step of Newton's method may turn a direction
SETTLED = 1e-11
CLEARLY = 1e-6  # by how much inequalities must hold; draws that come closer are left out


class Bodies(NamedTuple):
    """Bodies in contact, all of which are stated in world axes."""

    masses: np.ndarray  # (k,), kg
    inertias: np.ndarray  # (k, 3, 3), kg m^2, about the centres of mass
    centres: np.ndarray  # (k, 3), m
    v: np.ndarray  # (k, 3), m/s
    w: np.ndarray  # (k, 3), rad/s
    forces: np.ndarray  # (k, 3), N
    torques: np.ndarray  # (k, 3), N m
    points: np.ndarray  # (n, 3), m
    normals: np.ndarray  # (n, 3), unit
    frictions: np.ndarray  # (n,)
    pairs: list[tuple[int, int | None]]


class Mode(NamedTuple):
    """A mode, its contact forces, (n, 3), N, and the accelerations of its contact points, (n, 3), m/s^2."""

    letters: str
    forces: np.ndarray
    points: np.ndarray


def drawn(seed: int, *, most: int = 3) -> Bodies:
    """Return two bodies with one to ``most`` contacts, which are at rest in every other draw."""
    chance = np.random.default_rng([28, seed])
    n = int(chance.integers(1, most + 1))
    normals = chance.normal(size=(n, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    choices: list[tuple[int, int | None]] = [(0, 1), (1, 0), (0, None), (1, None)]
    pairs = [choices[int(i)] for i in np.append(chance.integers(0, 2), chance.integers(0, 4, size=n - 1))]
    spread = chance.normal(size=(2, 3, 3))
    moments = 0.3 * np.einsum("kij,klj->kil", spread, spread)  # second moments of mass
    found = Bodies(
        masses=np.exp(chance.normal(size=2)),
        inertias=np.trace(moments, axis1=1, axis2=2)[:, None, None] * np.eye(3) - moments,
        centres=chance.normal(size=(2, 3)),
        v=np.zeros((2, 3)),
        w=np.zeros((2, 3)),
        forces=3.0 * chance.normal(size=(2, 3)),
        torques=3.0 * chance.normal(size=(2, 3)),
        points=chance.normal(size=(n, 3)),
        normals=normals,
        frictions=chance.choice([0.0, 0.3, 1.0, 3.0], p=[0.1, 0.3, 0.3, 0.3], size=n),
        pairs=pairs,
    )
    if seed % 2 == 0:
        return found
    # All contacts keep their distance, and the last one is at rest in every other of these draws.
    rows = np.array([normals[i] @ _relative(found, i, np.eye(12)) for i in range(n)])
    if seed % 4 == 1:
        rows = np.vstack([rows[:-1], _relative(found, n - 1, np.eye(12))])
    sizes, basis = np.linalg.svd(rows)[1:]
    free = basis[int((sizes > 1e-9).sum()) :]
    twist = (free.T @ chance.normal(size=len(free))).reshape(2, 6)
    return found._replace(v=twist[:, :3], w=twist[:, 3:])


def _relative(bodies: Bodies, i: int, twists: np.ndarray) -> np.ndarray:
    """Return velocities of contact i, (3, m), from those of the bodies, (12, m), v then w of each."""
    found = np.zeros((3, twists.shape[1]))
    for index, sign in zip(bodies.pairs[i], (1.0, -1.0), strict=True):
        if index is not None:
            own = twists[6 * index : 6 * index + 6]
            arm = bodies.points[i] - bodies.centres[index]
            found += sign * (own[:3] + np.cross(own[3:], arm[:, None], axis=0))
    return found


def accelerations(bodies: Bodies, forces: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the accelerations of the bodies, (k, 3) twice, and of the contact points, (n, 3)."""
    total, moment = bodies.forces.copy(), bodies.torques.copy()
    for i, force in enumerate(forces):
        for index, sign in zip(bodies.pairs[i], (1.0, -1.0), strict=True):
            if index is not None:
                total[index] += sign * force
                moment[index] += np.cross(bodies.points[i] - bodies.centres[index], sign * force)
    a = total / bodies.masses[:, None]
    alpha = np.array(
        [
            np.linalg.solve(one, moment[k] - np.cross(bodies.w[k], one @ bodies.w[k]))
            for k, one in enumerate(bodies.inertias)
        ]
    )
    points = np.zeros_like(bodies.points)
    for i, pair in enumerate(bodies.pairs):
        for index, sign in zip(pair, (1.0, -1.0), strict=True):
            if index is not None:
                arm = bodies.points[i] - bodies.centres[index]
                own = a[index] + np.cross(alpha[index], arm)
                points[i] += sign * (own + np.cross(bodies.w[index], np.cross(bodies.w[index], arm)))
        if pair[1] is not None:  # it turns with the second body
            points[i] -= 2.0 * np.cross(bodies.w[pair[1]], sliding(bodies)[i])
    return a, alpha, points


def sliding(bodies: Bodies) -> np.ndarray:
    """Return the velocities, (n, 3), of the contacts, none of which approaches or leaves."""
    twists = np.column_stack([bodies.v, bodies.w]).ravel()[:, None]
    return np.array([_relative(bodies, i, twists)[:, 0] for i in range(len(bodies.points))])


class Judged(NamedTuple):
    """What is known of every string of letters.

    Attributes:
        modes: All modes. A contact without friction has the letter c where it stays.
        clear: Whether all inequalities held, or failed, clearly.
        shared: Strings whose contacts share a load in several ways, which nothing is known of.
    """

    modes: list[Mode]
    clear: bool
    shared: set[str]


def all_modes(bodies: Bodies) -> Judged:
    """Return every mode."""
    n = len(bodies.points)
    free = accelerations(bodies, np.zeros((n, 3)))[2].ravel()
    response = np.column_stack(
        [accelerations(bodies, unit.reshape(n, 3))[2].ravel() - free for unit in np.eye(3 * n)]
    )
    velocities = sliding(bodies)
    rests = np.linalg.norm(velocities, axis=1) < 1e-9
    found = Judged(modes=[], clear=True, shared=set())
    options = ["sfc" if rests[i] and bodies.frictions[i] > 0.0 else "sc" for i in range(n)]
    for letters in itertools.product(*options):
        string = _String(bodies, letters, rests, velocities, response, free)
        if string.is_shared():
            found.shared.add("".join(letters))
            continue
        for forces in string.solutions():
            points = (free + response @ forces.ravel()).reshape(n, 3)
            margin = _margin(bodies, letters, forces, points, rests)
            found = found._replace(clear=found.clear and abs(margin) > CLEARLY)
            if margin > 0.0:
                found.modes.append(Mode("".join(letters), forces, points))
    return found


class _String(NamedTuple):
    """The equations of a string of letters."""

    bodies: Bodies
    letters: tuple[str, ...]
    rests: np.ndarray
    velocities: np.ndarray
    response: np.ndarray  # (3 n, 3 n), accelerations of the contact points on unit forces
    free: np.ndarray  # (3 n,), the same without forces

    @property
    def turning(self) -> list[int]:
        """Return the contacts whose direction of sliding is unknown."""
        return [
            i
            for i, letter in enumerate(self.letters)
            if letter == "c" and self.rests[i] and self.bodies.frictions[i] > 0.0
        ]

    def equations(self, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return rows that vanish, (q, 3 n), and unit forces, (m, 3 n, q), for directions, (m, k) rad."""
        rows, columns = [], []
        for i, letter in enumerate(self.letters):
            eye = np.eye(3 * len(self.letters))[3 * i : 3 * i + 3]
            if letter == "f":
                rows += list(eye)
                columns += [np.tile(one, (len(angles), 1)) for one in eye]
            elif letter == "c":
                normal = self.bodies.normals[i]
                way = np.zeros((len(angles), 3))
                if i in self.turning:
                    own, frame = angles[:, self.turning.index(i)], _frame(normal)
                    way = np.cos(own)[:, None] * frame[0] + np.sin(own)[:, None] * frame[1]
                elif not self.rests[i]:
                    way += self.velocities[i] / np.linalg.norm(self.velocities[i])
                rows.append(normal @ eye)
                columns.append((normal - self.bodies.frictions[i] * way) @ eye)
        size = (len(angles), 3 * len(self.letters), len(rows))
        return np.array(rows).reshape(-1, size[1]), np.array(columns).reshape(size[2], *size[:2]).transpose(
            1, 2, 0
        )

    def is_shared(self) -> bool:
        """Return whether there are fewer independent equations than forces."""
        rows, spans = self.equations(np.full((1, len(self.turning)), 0.4))
        sizes = np.linalg.svd(rows @ self.response @ spans[0], compute_uv=False)
        return bool(sizes.min(initial=1.0) < 1e-9)

    def under(self, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return forces, (m, n, 3), and how fast each turning contact slides across its direction, (m, k)."""
        rows, spans = self.equations(angles)
        m, n = len(angles), len(self.letters)
        matrices = rows @ self.response @ spans
        lost = np.abs(np.linalg.det(matrices)) < 1e-14 if len(rows) else np.zeros(m, dtype=bool)
        matrices[lost] = np.eye(len(rows))
        right = np.broadcast_to(-rows @ self.free, (m, len(rows)))[..., None]
        forces = (spans @ np.linalg.solve(matrices, right))[..., 0]
        points = (self.free + forces @ self.response.T).reshape(m, n, 3)
        across = np.zeros((m, len(self.turning)))
        for k, i in enumerate(self.turning):
            x, y = _frame(self.bodies.normals[i]) @ points[:, i].T
            across[:, k] = np.cos(angles[:, k]) * y - np.sin(angles[:, k]) * x
        return forces.reshape(m, n, 3), across

    def solutions(self) -> list[np.ndarray]:
        """Return the forces, (n, 3) each, that solve the equations."""
        k = len(self.turning)
        if k == 0:
            return list(self.under(np.zeros((1, 0)))[0])
        starts = 2.0 * np.pi * np.arange(STARTS[k]) / STARTS[k]
        angles = np.array(list(itertools.product(starts, repeat=k)))
        for _ in range(STEPS):
            across = self.under(angles)[1]
            turned = [self.under(angles + STEP * unit)[1] for unit in np.eye(k)]
            slopes = (np.stack(turned, axis=2) - across[..., None]) / STEP + 1e-12 * np.eye(k)
            moves = np.linalg.solve(slopes, -across[..., None])[..., 0]
            longest = np.abs(moves).max(axis=1, keepdims=True)
            angles = angles + moves * np.minimum(1.0, LONGEST / np.maximum(longest, LONGEST))
        forces, across = self.under(angles)
        sizes = 1.0 + np.abs(forces).max(axis=(1, 2))
        kept: list[np.ndarray] = []
        for one in forces[np.abs(across).max(axis=1) <= SETTLED * sizes]:
            if all(np.abs(one - other).max() > 1e-7 * (1.0 + np.abs(one).max()) for other in kept):
                kept.append(one)
        return kept


def _frame(normal: np.ndarray) -> np.ndarray:
    one = np.cross(normal, np.eye(3)[int(np.abs(normal).argmin())])
    one /= np.linalg.norm(one)
    return np.array([one, np.cross(normal, one)])


def _margin(
    bodies: Bodies, string: tuple[str, ...], forces: np.ndarray, points: np.ndarray, rests: np.ndarray
) -> float:
    """Return the least amount by which an inequality of a string holds; it is negative if one fails."""
    found = np.inf
    for i, letter in enumerate(string):
        normal = bodies.normals[i]
        pressing = float(forces[i] @ normal)
        if letter == "s":
            found = min(found, float(points[i] @ normal))
            continue
        found = min(found, pressing)
        if letter == "f":
            across = float(np.linalg.norm(forces[i] - pressing * normal))
            found = min(found, bodies.frictions[i] * pressing - across)
        elif rests[i] and bodies.frictions[i] > 0.0 and pressing > 0.0:
            friction = forces[i] - pressing * normal
            found = min(found, -float(friction @ points[i]) / float(np.linalg.norm(friction)))
    return found
