# SPDX-License-Identifier: Apache-2.0
"""Impact at one contact in space by small equal increments of normal impulse, with implicit Coulomb friction.

Slow and obvious on purpose. In each increment the tangential impulse either stops the contact or, where that
would leave the friction cone, opposes the sliding velocity at the end of the increment. Bodies are whole:
velocities of the body are stepped, the contact's velocity is computed from them. First order in the
increment.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass
class Body:
    mass: float
    inertia: np.ndarray  # (3, 3), world axes
    v: np.ndarray
    w: np.ndarray


def impact(
    body: Body, arm: np.ndarray, normal: np.ndarray, *, mu: float, e: float, law: str, increment: float
) -> np.ndarray:
    """Return the total impulse, (3,), of the law "poisson", "newton" or "energetic"."""
    v, w = body.v.copy(), body.w.copy()
    inverse = np.linalg.inv(body.inertia)
    cross = np.cross(np.eye(3), arm).T  # cross @ x = arm x x
    response = np.eye(3) / body.mass - cross @ inverse @ cross
    total = np.zeros(3)
    first_approach = normal @ (v + np.cross(w, arm))
    due = 0.0
    compressing = True
    for _ in range(10_000_000):
        contact = v + np.cross(w, arm)
        v_n = normal @ contact
        impulse = increment * normal + _friction(contact, response, normal, mu * increment, increment)
        v = v + impulse / body.mass
        w = w + inverse @ np.cross(arm, impulse)
        total = total + impulse
        v_n_next = normal @ (v + np.cross(w, arm))
        work = increment * 0.5 * (v_n + v_n_next)
        amount, share = (work, e**2) if law == "energetic" else (increment, e)
        if compressing:
            due += share * abs(amount)
        else:
            due -= amount
        if v_n_next >= 0.0 and compressing:
            compressing = False
        elif v_n_next < 0.0 and not compressing:
            compressing = True
        if not compressing and (v_n_next >= -e * first_approach if law == "newton" else due <= 0.0):
            return total
    raise AssertionError("the impact does not end")


def _friction(
    contact: np.ndarray, response: np.ndarray, normal: np.ndarray, limit: float, increment: float
) -> np.ndarray:
    """Return the tangential impulse of one increment, (3,)."""
    tangents = np.linalg.svd(normal[None, :])[2][1:]
    k = tangents @ response @ tangents.T
    free = tangents @ (contact + response @ normal * increment)
    hold = -np.linalg.solve(k, free)
    if np.linalg.norm(hold) <= limit:
        return hold @ tangents
    # f = -limit u/|u| with u = free + K f: u (1 + limit K/|u|) = free, solved for |u| by bisection.
    low, high = 0.0, float(np.linalg.norm(free))
    for _ in range(60):
        speed = 0.5 * (low + high)
        u = np.linalg.solve(speed * np.eye(2) + limit * k, free) * speed
        if np.linalg.norm(u) > speed:
            low = speed
        else:
            high = speed
    u = np.linalg.solve(speed * np.eye(2) + limit * k, free)
    return -limit * u / np.linalg.norm(u) @ tangents
