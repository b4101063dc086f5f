# SPDX-License-Identifier: Apache-2.0
"""Impacts in space as the motion of bodies on stiff springs, many at once, in small equal steps of time.

As in `impact_spring_plane`; the tangential impulse of a step stops the contact, or where that would leave the
friction cone, it is mu times the normal one against the sliding velocity. Bodies move and turn by small
angles meanwhile, their inertia keeps its axes. A contact that is compressed twice is not what this is for.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np


@dataclass
class Problems:
    """Arrays with an element a problem; the normal is +z, the contact is at ``r`` from the centre of mass."""

    mass: np.ndarray
    inertia: np.ndarray  # (N, 3, 3)
    r: np.ndarray  # (N, 3)
    v: np.ndarray  # (N, 3)
    w: np.ndarray  # (N, 3)
    mu: np.ndarray
    e: np.ndarray  # > 0


def velocities_after(problems: Problems, *, duration: float, steps: int) -> np.ndarray:
    """Return velocities, (N, 6), after contacts of about ``duration`` s in about ``steps`` steps."""
    m, mu = problems.mass, problems.mu
    inverse = np.linalg.inv(problems.inertia)
    stiffness = m * (math.pi / duration) ** 2
    dt = duration / steps
    v, w = problems.v.copy(), problems.w.copy()
    moved, turned = np.zeros_like(v), np.zeros_like(w)
    count = len(m)
    peak, loading, done = np.zeros(count), np.ones(count, dtype=bool), np.zeros(count, dtype=bool)
    steeper = 1.0 / problems.e**2
    while not done.all():
        arm = problems.r + np.cross(turned, problems.r)
        contact = v + np.cross(w, arm)
        depth = problems.r[:, 2] - arm[:, 2] - moved[:, 2]
        loading &= (depth >= peak) | (peak == 0.0)
        peak = np.where(loading, np.maximum(peak, depth), peak)
        pressed = np.where(loading, depth, peak - (peak - depth) * steeper)
        done |= ~loading & (pressed <= 0.0)
        normal = np.where(done, 0.0, stiffness * np.maximum(pressed, 0.0) * dt)

        x, y, z = arm.T
        zero = np.zeros(count)
        skew = np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]).transpose(2, 0, 1)
        response = skew.transpose(0, 2, 1) @ inverse @ skew
        response[:, range(3), range(3)] += (1.0 / m)[:, None]
        slip = contact[:, :2] + response[:, :2, 2] * normal[:, None]
        a, b, d = response[:, 0, 0], response[:, 0, 1], response[:, 1, 1]
        determinant = a * d - b * b
        hold = np.column_stack(
            ((b * slip[:, 1] - d * slip[:, 0]) / determinant, (b * slip[:, 0] - a * slip[:, 1]) / determinant)
        )
        most = mu * normal
        inside = np.linalg.norm(hold, axis=1) <= most
        sliding = -most[:, None] * slip / (np.linalg.norm(slip, axis=1) + 1e-300)[:, None]
        impulse = np.column_stack((np.where(inside[:, None], hold, sliding), normal))
        v = v + impulse / m[:, None]
        w = w + np.einsum("nij,nj->ni", inverse, np.cross(arm, impulse))
        on = ~done[:, None]
        moved, turned = moved + np.where(on, v * dt, 0.0), turned + np.where(on, w * dt, 0.0)
    return np.concatenate((v, w), axis=1)
