# SPDX-License-Identifier: Apache-2.0
"""Every mode of a planar mechanism at rest: one linear program for each string of letters.

The tangent is x and the normal is z. Letters are s, f, and l or r where a contact slides to -x or +x. A
contact without friction has the letter c where it stays.
"""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np
from scipy.optimize import linprog

SLACK = 1e-6  # of the largest acceleration, by which an inequality must hold strictly


class Mechanism(NamedTuple):
    """A mechanism whose n contact points have the accelerations W f + b under contact forces f."""

    response: np.ndarray  # (2 n, 2 n), 1/kg, along x and z of each contact
    free: np.ndarray  # (2 n,), m/s^2
    frictions: np.ndarray  # (n,)


def drawn(seed: int) -> Mechanism:
    """Return a mechanism of one to six freedoms with one to three contacts."""
    chance = np.random.default_rng([5, seed])
    n, d = int(chance.integers(1, 4)), int(chance.integers(1, 7))
    J, root = chance.normal(size=(2 * n, d)), chance.normal(size=(d, d))
    inverse = np.linalg.inv(root @ root.T + 0.2 * np.eye(d))
    free = J @ (3.0 * chance.normal(size=d))
    return Mechanism(J @ inverse @ J.T, free, chance.choice([0.0, 0.3, 1.0, 3.0], size=n))


def all_modes(mechanism: Mechanism) -> set[str]:
    """Return the letters of all modes."""
    options = ["slrf" if friction > 0.0 else "sc" for friction in mechanism.frictions]
    return {"".join(one) for one in itertools.product(*options) if _is_consistent(mechanism, one)}


def _is_consistent(mechanism: Mechanism, letters: tuple[str, ...]) -> bool:
    W, b, _ = mechanism
    size = len(b)
    zero, positive, strict = [], [], []  # rows of forces, then a constant
    for i, letter in enumerate(letters):
        slides, rises = (np.append(W[k], b[k]) for k in (2 * i, 2 * i + 1))
        across, presses = np.eye(size + 1)[2 * i], np.eye(size + 1)[2 * i + 1]
        limit = mechanism.frictions[i] * presses
        if letter == "s":
            zero += [across, presses]
            strict.append(rises)
            continue
        zero.append(rises)
        positive.append(presses)
        if letter == "f":
            zero.append(slides)
            positive += [limit - across, limit + across]
        elif letter == "c":
            zero.append(across)
        else:
            way = 1.0 if letter == "r" else -1.0
            zero.append(across + way * limit)
            strict.append(way * slides)
    scale = float(np.abs(b).max())
    rows = [np.append(-row[:-1], 0.0) for row in positive] + [np.append(-row[:-1], scale) for row in strict]
    limits = [row[-1] for row in (*positive, *strict)]
    outcome = linprog(
        np.append(np.zeros(size), -1.0),
        A_eq=[np.append(row[:-1], 0.0) for row in zero],
        b_eq=[-row[-1] for row in zero],
        A_ub=rows or None,
        b_ub=limits or None,
        bounds=[*[(None, None)] * size, (0.0, 1.0)],
    )
    return outcome.status == 0 and (not strict or -outcome.fun > SLACK)
