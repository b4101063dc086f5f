# SPDX-License-Identifier: Apache-2.0
"""How a point of a body moves over a surface that moves: two rigid motions as power series of the time.

The answer is read from the series of the point's coordinates in the surface's own axes, so that no formula
for relative accelerations is used.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class RigidMotion(NamedTuple):
    """A rigid motion near time 0, world axes; the velocity and acceleration are those of ``point``."""

    point: np.ndarray
    v: np.ndarray
    w: np.ndarray
    a: np.ndarray
    alpha: np.ndarray

    def rotation(self) -> list[np.ndarray]:
        """The series of the rotation since time 0: its coefficients of t^0, t^1 and t^2."""
        spin, more = cross_matrix(self.w), cross_matrix(self.alpha)
        return [np.eye(3), spin, 0.5 * (more + spin @ spin)]

    def place_of(self, material: np.ndarray) -> list[np.ndarray]:
        """The series of where a material point is, which is at ``material`` at time 0."""
        moved = [turn @ (material - self.point) for turn in self.rotation()]
        return [self.point + moved[0], self.v + moved[1], 0.5 * self.a + moved[2]]

    def at(self, material: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The velocity and the acceleration of a material point."""
        _, velocity, half = self.place_of(material)
        return velocity, 2.0 * half


def over(body: RigidMotion, surface: RigidMotion, contact: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The velocity and acceleration, in the surface's axes, of the body's material point at a contact."""
    apart = [
        one - other for one, other in zip(body.place_of(contact), surface.place_of(contact), strict=True)
    ]
    back = [turn.T for turn in surface.rotation()]
    velocity = back[0] @ apart[1] + back[1] @ apart[0]
    return velocity, 2.0 * (back[0] @ apart[2] + back[1] @ apart[1] + back[2] @ apart[0])


def cross_matrix(a: np.ndarray) -> np.ndarray:
    """The matrix whose product with b is the cross product of a and b."""
    x, y, z = a
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
