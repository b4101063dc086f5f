# SPDX-License-Identifier: Apache-2.0
"""One interleaving of impacts at several contacts, increment by increment: slow and obvious.

Each contact owes e^2 of the work that compression has taken from it. Who gets the next increment is drawn.
"""

from __future__ import annotations

import numpy as np

ROUNDING = 1e-12
"""m/s. A contact that has been compressed to its end may still approach by the rounding of velocities."""


def velocity_after(
    *,
    inverse_mass: np.ndarray,
    twist: np.ndarray,
    arms: np.ndarray,
    normals: np.ndarray,
    frictions: np.ndarray,
    restitutions: np.ndarray,
    increment: float,
    weights: np.ndarray,
    rng: np.random.Generator,
) -> np.ndarray:
    """Return the twist, (6,), after increments of the normal impulse at contacts drawn with ``weights``."""
    rows = []
    for arm in arms:
        x, y, z = arm
        cross = np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])  # w x arm = cross @ w
        rows.append(np.hstack([np.eye(3), cross]))
    now, owed = twist.copy(), np.zeros(len(arms))
    for _ in range(100_000):
        approach = [float(n @ row @ now) for n, row in zip(normals, rows, strict=True)]
        may = [i for i in range(len(arms)) if approach[i] < -1e-5 or owed[i] > 1e-5]
        if not may:
            return now
        chances = weights[may] / weights[may].sum()
        i = int(rng.choice(may, p=chances))
        row, n, mu = rows[i], normals[i], frictions[i]
        response = row @ inverse_mass @ row.T
        p = increment
        compresses = approach[i] < -ROUNDING
        if compresses:
            p = min(p, -approach[i] / float(n @ response @ n))
        velocity = row @ now
        slip = velocity - n * (n @ velocity)
        # The tangential impulse that would stop the sliding, cut to the friction cone.
        tangents = np.linalg.svd(n[None])[2][1:]
        wanted = -np.linalg.solve(tangents @ response @ tangents.T, tangents @ (velocity + p * response @ n))
        size = float(np.linalg.norm(wanted))
        if size <= mu * p:
            friction = wanted @ tangents
        elif np.linalg.norm(slip) > 10.0 * mu * p * np.linalg.norm(response, 2):
            friction = -mu * p * slip / np.linalg.norm(slip)
        else:
            friction = mu * p / size * wanted @ tangents
        after = now + inverse_mass @ row.T @ (p * n + friction)
        work = 0.5 * p * (approach[i] + float(n @ row @ after))
        if not compresses and work > owed[i]:  # the last part of what is owed
            now = now + owed[i] / work * (after - now)
            owed[i] = 0.0
            continue
        owed[i] += restitutions[i] ** 2 * -work if compresses else -work
        now = after
    raise AssertionError("no end")
