# SPDX-License-Identifier: Apache-2.0
"""One contact at rest in space, on a round cone: every mode, by looking in all directions of sliding."""

from __future__ import annotations

import numpy as np

DIRECTIONS = 20_000
HALVINGS = 60


def all_modes(
    mass: float,
    inertia: np.ndarray,
    *,
    r: np.ndarray,
    normal: np.ndarray,
    friction: float,
    wrench: np.ndarray,
) -> list[tuple[str, np.ndarray]]:
    """Return letters and the contact point's accelerations, (3,).

    Args:
        mass: kg.
        inertia: (3, 3), kg m^2.
        r: (3,), m, the contact from the centre of mass.
        normal: (3,), unit, into the body.
        friction: Coulomb's mu.
        wrench: (6,), applied force and torque.
    """
    arm = np.array([[0.0, r[2], -r[1]], [-r[2], 0.0, r[0]], [r[1], -r[0], 0.0]])  # alpha x r
    G = np.eye(3) / mass + arm @ np.linalg.inv(inertia) @ arm.T
    b = wrench[:3] / mass + arm @ np.linalg.inv(inertia) @ wrench[3:]
    found = []
    if normal @ b > 0.0:
        found.append(("s", b))
    held = np.linalg.solve(G, -b)
    if friction * (held @ normal) >= np.linalg.norm(held - (held @ normal) * normal):
        found.append(("f", np.zeros(3)))
    one = np.cross(normal, np.eye(3)[int(np.abs(normal).argmin())])
    one /= np.linalg.norm(one)
    two = np.cross(normal, one)

    def under(angles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return, for friction against some directions, the sideways part, normal forces, speeds, motions."""
        ways = np.outer(np.cos(angles), one) + np.outer(np.sin(angles), two)
        of_unit = (normal - friction * ways) @ G.T
        rises = of_unit @ normal
        forces = -(b @ normal) / rises
        motions = b + forces[:, None] * of_unit
        sideways = np.sum(motions * np.cross(ways, normal), axis=1) * rises
        return sideways, forces, np.sum(motions * ways, axis=1), motions

    angles = np.linspace(0.0, 2.0 * np.pi, DIRECTIONS + 1)
    signs = np.sign(under(angles)[0])
    for i in np.flatnonzero(signs[:-1] * signs[1:] <= 0.0):
        low, high = angles[i], angles[i + 1]
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            if np.sign(under(np.array([middle]))[0][0]) == signs[i]:
                low = middle
            else:
                high = middle
        _, forces, speeds, motions = under(np.array([0.5 * (low + high)]))
        if forces[0] > 0.0 and speeds[0] > 0.0:
            found.append(("c", motions[0]))
    return found
