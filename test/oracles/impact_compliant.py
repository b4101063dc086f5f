# SPDX-License-Identifier: Apache-2.0
"""Impact of a body in space as the motion of a body on a stiff spring, integrated in time.

The contact point carries a normal spring that gives back the part e^2 of the work done on it (it unloads
along a line steeper by 1/e^2) and Coulomb friction with its direction smoothed below a small sliding speed.
The body moves and turns meanwhile; as the spring stiffens, duration and displacement go to zero and the
energetic law's rigid answer remains. Impulse, normal impulse, restitution are never mentioned.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp


@dataclass
class Problem:
    mass: float
    inertia: np.ndarray  # (3, 3), world axes, at the start
    v: np.ndarray
    w: np.ndarray
    arm: np.ndarray  # contact from the centre of mass, world axes, at the start
    normal: np.ndarray
    mu: float
    e: float  # > 0


def velocity_after(problem: Problem, *, duration: float, smoothing: float) -> np.ndarray:
    """Return the body's velocity, (6,), after a contact that lasts about ``duration`` s.

    Friction has its full size where sliding is faster than a few ``smoothing``, m/s.
    """
    stiffness = problem.mass * (math.pi / duration) ** 2
    start = np.concatenate([problem.arm, np.eye(3).ravel(), problem.v, problem.w])
    depth_0 = problem.normal @ problem.arm
    inverse = np.linalg.inv(problem.inertia)

    def contact(y: np.ndarray) -> tuple[np.ndarray, np.ndarray, float, float]:
        """Return rotation, contact arm, indentation and its rate."""
        turned = y[3:12].reshape(3, 3)
        arm = turned @ problem.arm
        centre = y[:3] - problem.arm  # displacement of the centre of mass
        indentation = -(problem.normal @ (centre + arm) - depth_0)
        rate = -float(problem.normal @ (y[12:15] + np.cross(y[15:18], arm)))
        return turned, arm, float(indentation), rate

    def motion(force: float, y: np.ndarray) -> np.ndarray:
        turned, arm, _, _ = contact(y)
        v, w = y[12:15], y[15:18]
        velocity = v + np.cross(w, arm)
        sliding = velocity - problem.normal * (problem.normal @ velocity)
        push = force * (problem.normal - problem.mu * sliding / math.sqrt(sliding @ sliding + smoothing**2))
        inertia_inverse = turned @ inverse @ turned.T
        gyroscopic = np.cross(w, turned @ problem.inertia @ turned.T @ w)
        skew = np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])
        return np.concatenate(
            [
                v,
                (skew @ turned).ravel(),
                push / problem.mass,
                inertia_inverse @ (np.cross(arm, push) - gyroscopic),
            ]
        )

    def load(_: float, y: np.ndarray) -> np.ndarray:
        return motion(stiffness * max(contact(y)[2], 0.0), y)

    def turns(_: float, y: np.ndarray) -> float:
        return contact(y)[3]

    turns.terminal, turns.direction = True, -1.0
    options = {"method": "LSODA", "rtol": 1e-9, "atol": 1e-12}
    loading = solve_ivp(load, (0.0, 1e3 * duration), start, events=turns, **options)
    deepest = loading.y[:, -1]
    peak = contact(deepest)[2]

    def unload(_: float, y: np.ndarray) -> np.ndarray:
        return motion(stiffness * max(peak - (peak - contact(y)[2]) / problem.e**2, 0.0), y)

    def free(_: float, y: np.ndarray) -> float:
        return peak - (peak - contact(y)[2]) / problem.e**2

    free.terminal, free.direction = True, -1.0
    unloading = solve_ivp(unload, (0.0, 1e3 * duration), deepest, events=free, **options)
    return unloading.y[12:18, -1]
