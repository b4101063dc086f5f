# SPDX-License-Identifier: Apache-2.0
"""Planar impacts as the motion of bodies on stiff springs, many at once, in small equal steps of time.

The contact point carries a normal spring that gives back the part e^2 of the work done on it (it unloads
along a line steeper by 1/e^2) and Coulomb's friction: in each step the tangential impulse stops the contact,
or is mu times the normal one if that is not enough. The bodies move and turn meanwhile; as the springs
stiffen, duration and displacement go to zero. Impulse space, its lines and restitution are never mentioned.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np


@dataclass
class Problems:
    """Arrays with an element a problem; the normal is +y, the contact is at ``r`` from the centre of mass."""

    mass: np.ndarray
    inertia: np.ndarray
    r: np.ndarray  # (N, 2)
    v: np.ndarray  # (N, 2)
    w: np.ndarray
    mu: np.ndarray
    e: np.ndarray  # > 0


def velocities_after(problems: Problems, *, duration: float, steps: int) -> np.ndarray:
    """Return v_x, v_y, w of each, (N, 3), after contacts of about ``duration`` s in about ``steps`` steps."""
    m, i, mu = problems.mass, problems.inertia, problems.mu
    stiffness = m * (math.pi / duration) ** 2
    dt = duration / steps
    (v_x, v_y), w = problems.v.T.copy(), problems.w.copy()
    rise, angle = np.zeros(len(m)), np.zeros(len(m))
    peak, loading, done = np.zeros(len(m)), np.ones(len(m), dtype=bool), np.zeros(len(m), dtype=bool)
    r_x, r_y = problems.r.T
    steeper = 1.0 / problems.e**2
    while not done.all():
        arm_x = np.cos(angle) * r_x - np.sin(angle) * r_y
        arm_y = np.sin(angle) * r_x + np.cos(angle) * r_y
        depth = -(rise + arm_y - r_y)
        loading &= (depth >= peak) | (peak == 0.0)
        peak = np.where(loading, np.maximum(peak, depth), peak)
        pressed = np.where(loading, depth, peak - (peak - depth) * steeper)
        done |= ~loading & (pressed <= 0.0)
        normal = np.where(done, 0.0, stiffness * np.maximum(pressed, 0.0) * dt)
        a, b = 1.0 / m + arm_y**2 / i, -arm_x * arm_y / i
        slip = v_x - w * arm_y + b * normal
        tangential = np.clip(-slip / a, -mu * normal, mu * normal)
        v_x = v_x + tangential / m
        v_y = v_y + normal / m
        w = w + (arm_x * normal - arm_y * tangential) / i
        rise = rise + np.where(done, 0.0, v_y * dt)
        angle = angle + np.where(done, 0.0, w * dt)
    return np.column_stack((v_x, v_y, w))
