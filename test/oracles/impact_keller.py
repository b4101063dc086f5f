# SPDX-License-Identifier: Apache-2.0
"""Keller's equations for one contact in space that slides throughout, integrated by SciPy.

State: the body's own velocity, 6 numbers, and nothing else; the contact's velocity and the friction follow
from it at every evaluation. Valid while the contact slides, since the direction of friction is undefined at a
stop. With dp = |slip| ds the stop is at infinite s, and what comes before it can be integrated.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp


def body_velocity_after(
    *,
    mass: float,
    inertia: np.ndarray,
    v: np.ndarray,
    w: np.ndarray,
    arm: np.ndarray,
    normal: np.ndarray,
    mu: float,
    normal_impulse: float,
) -> tuple[np.ndarray, float]:
    """Return the body's velocity, (6,), after ``normal_impulse``, and the least sliding speed met."""
    inverse = np.linalg.inv(inertia)
    slowest = [np.inf]

    def rate(_: float, y: np.ndarray) -> np.ndarray:
        contact = y[:3] + np.cross(y[3:], arm)
        sliding = contact - normal * (normal @ contact)
        speed = np.linalg.norm(sliding)
        slowest[0] = min(slowest[0], float(speed))
        force = normal - mu * sliding / speed
        return np.concatenate([force / mass, inverse @ np.cross(arm, force)])

    solution = solve_ivp(
        rate, (0.0, normal_impulse), np.concatenate([v, w]), method="DOP853", rtol=1e-13, atol=1e-15
    )
    return solution.y[:, -1], slowest[0]


def impulse_to_stop(
    *,
    mass: float,
    inertia: np.ndarray,
    v: np.ndarray,
    w: np.ndarray,
    arm: np.ndarray,
    normal: np.ndarray,
    mu: float,
) -> np.ndarray:
    """Return the impulse, (3,), at which a contact that comes to a stop does."""
    inverse = np.linalg.inv(inertia)

    def slip_of(y: np.ndarray) -> np.ndarray:
        contact = y[:3] + np.cross(y[3:6], arm)
        return contact - normal * (normal @ contact)

    def rate(_: float, y: np.ndarray) -> np.ndarray:
        slip = slip_of(y)
        force = np.linalg.norm(slip) * normal - mu * slip
        return np.concatenate([force / mass, inverse @ np.cross(arm, force), force])

    start = np.concatenate([v, w, np.zeros(3)])
    first = np.linalg.norm(slip_of(start))

    def stopped(_: float, y: np.ndarray) -> float:
        return float(np.linalg.norm(slip_of(y)) - 1e-12 * first)

    stopped.terminal = True
    solution = solve_ivp(
        rate, (0.0, 1e9), start, method="DOP853", rtol=1e-12, atol=1e-14 * first, events=stopped
    )
    assert solution.status == 1
    return solution.y[6:, -1]
