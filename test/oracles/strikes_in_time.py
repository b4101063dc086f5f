# SPDX-License-Identifier: Apache-2.0
"""A body falls on the floor, by brute force: small steps of time, and an impulse where a corner sinks in.

Slow, obvious, and sharing nothing with the package. Between strikes Euler's equations are stepped by Runge
and Kutta; the step in which a corner gets below the floor is shortened until it ends at the strike. The
impulse is frictionless in closed form, or that of `impact_increments`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from oracles import impact_increments
from oracles.rigid_flight import matrix, rate


class Toss(NamedTuple):
    mass: float
    moments: np.ndarray  # (3,), kg m^2, about the body's axes
    corners: np.ndarray  # (k, 3), m, body axes
    p: np.ndarray
    q: np.ndarray  # x, y, z, w
    v: np.ndarray
    w: np.ndarray  # rad/s, world axes


class Strike(NamedTuple):
    time: float
    corner: int
    v: np.ndarray  # just after
    w: np.ndarray  # just after, world axes


def strikes(
    toss: Toss, *, e: float, mu: float = 0.0, gravity: float = 9.80665, until: float, step: float = 5e-5
) -> list[Strike]:
    """The strikes within ``until`` s, under Poisson's law."""
    y = np.concatenate([toss.p, toss.v, [toss.q[3], *toss.q[:3]], matrix(toss.q).T @ toss.w])
    found = []
    time = 0.0
    while time < until:
        after = stepped(toss, y, step, gravity)
        corner = lowest_sinking(toss, after)
        if corner is None:
            y, time = after, time + step
            continue
        short = step
        low = 0.0
        while short - low > 1e-13:
            middle = 0.5 * (low + short)
            if lowest_sinking(toss, stepped(toss, y, middle, gravity)) is None:
                low = middle
            else:
                short = middle
        y, time = stepped(toss, y, short, gravity), time + short
        corner = lowest_sinking(toss, y)
        assert corner is not None
        y = struck(toss, y, corner, e=e, mu=mu)
        _, R, v, w = parts(y)
        found.append(Strike(time, corner, v, R @ w))
    return found


def parts(y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Position, rotation matrix, velocity, angular velocity in body axes."""
    return y[:3], matrix(np.array([*y[7:10], y[6]])), y[3:6], y[10:]


def stepped(toss: Toss, y: np.ndarray, h: float, gravity: float) -> np.ndarray:
    """One step of Runge and Kutta."""
    fall = np.array([0.0, 0.0, -gravity])

    def f(z: np.ndarray) -> np.ndarray:
        return np.concatenate([z[3:6], fall, rate(z[6:], toss.moments)])

    k1 = f(y)
    k2 = f(y + 0.5 * h * k1)
    k3 = f(y + 0.5 * h * k2)
    k4 = f(y + h * k3)
    y = y + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    y[6:10] /= np.linalg.norm(y[6:10])
    return y


def lowest_sinking(toss: Toss, y: np.ndarray) -> int | None:
    """The lowest corner that is below the floor and sinks."""
    p, R, v, w = parts(y)
    arms = toss.corners @ R.T
    heights = p[2] + arms[:, 2]
    rates = v[2] + np.cross(R @ w, arms)[:, 2]
    below = [i for i in range(len(arms)) if heights[i] < 0.0 and rates[i] < 0.0]
    return min(below, key=lambda i: float(heights[i])) if below else None


def struck(toss: Toss, y: np.ndarray, corner: int, *, e: float, mu: float) -> np.ndarray:
    """The state just after a corner's strike."""
    _, R, v, w = parts(y)
    arm, normal = R @ toss.corners[corner], np.array([0.0, 0.0, 1.0])
    inertia = R @ np.diag(toss.moments) @ R.T
    contact = v + np.cross(R @ w, arm)
    lever = np.linalg.solve(inertia, np.cross(arm, normal))
    size = -(1.0 + e) * contact[2] / (1.0 / toss.mass + normal @ np.cross(lever, arm))
    impulse = size * normal
    if mu > 0.0:
        body = impact_increments.Body(mass=toss.mass, inertia=inertia, v=v, w=R @ w)
        impulse = impact_increments.impact(
            body, arm, normal, mu=mu, e=e, law="poisson", increment=size / 1000.0
        )
    y = y.copy()
    y[3:6] += impulse / toss.mass
    y[10:] += R.T @ np.linalg.solve(inertia, np.cross(arm, impulse))
    return y
