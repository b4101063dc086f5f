# SPDX-License-Identifier: Apache-2.0
"""This file calculates with one rotation: a unit quaternion x, y, z, w, as a tuple, or a matrix, (3, 3)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.validation import FloatArray

Quaternion: TypeAlias = "tuple[float, float, float, float]"
Vector: TypeAlias = "tuple[float, float, float]"


def product(p: Quaternion, q: Quaternion) -> Quaternion:
    """Return Hamilton's product: the rotation ``q`` followed by ``p``."""
    px, py, pz, pw = p
    qx, qy, qz, qw = q
    return (
        pw * qx + px * qw + py * qz - pz * qy,
        pw * qy - px * qz + py * qw + pz * qx,
        pw * qz + px * qy - py * qx + pz * qw,
        pw * qw - px * qx - py * qy - pz * qz,
    )


def conjugate(q: Quaternion) -> Quaternion:
    """Return the opposite rotation."""
    return (-q[0], -q[1], -q[2], q[3])


def normalised(q: Sequence[float]) -> Quaternion:
    """Return ``q`` scaled to norm 1."""
    x, y, z, w = q
    scale = 1.0 / math.sqrt(x * x + y * y + z * z + w * w)
    return (scale * x, scale * y, scale * z, scale * w)


def nearer(q: Quaternion, to: Quaternion) -> Quaternion:
    """Return ``q`` or -``q``, which are the same attitude, whichever is nearer to another quaternion."""
    x, y, z, w = q
    return q if x * to[0] + y * to[1] + z * to[2] + w * to[3] >= 0.0 else (-x, -y, -z, -w)


def rotated(q: Quaternion, vector: Sequence[float]) -> Vector:
    """Return the vector turned by ``q``."""
    x, y, z, w = q
    a, b, c = vector
    d, e, f = 2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)
    return (a + w * d + y * f - z * e, b + w * e + z * d - x * f, c + w * f + x * e - y * d)


def from_rows(rows: Sequence[Sequence[float]]) -> Quaternion:
    """Return the quaternion of a rotation matrix, by the largest of its four components (Shepperd 1978)."""
    (a, b, c), (d, e, f), (g, h, i) = rows
    candidates = (
        (1.0 + a - e - i, d + b, c + g, h - f),
        (d + b, 1.0 - a + e - i, h + f, c - g),
        (c + g, h + f, 1.0 - a - e + i, d - b),
        (h - f, c - g, d - b, 1.0 + a + e + i),
    )
    return normalised(max((row for row in enumerate(candidates)), key=lambda row: row[1][row[0]])[1])


def left_matrix(q: Quaternion) -> FloatArray:
    """Return the (4, 4) matrix of ``p -> q p``."""
    x, y, z, w = q
    return np.array([[w, -z, y, x], [z, w, -x, y], [-y, x, w, z], [-x, -y, -z, w]])


def right_matrix(q: Quaternion) -> FloatArray:
    """Return the (4, 4) matrix of ``p -> p q``."""
    x, y, z, w = q
    return np.array([[w, z, -y, x], [-z, w, x, y], [y, -x, w, z], [-x, -y, -z, w]])


def from_z_onto(direction: Sequence[float]) -> Quaternion:
    """Return a rotation that takes the z axis to a unit vector."""
    x, y, z = direction
    if z < 0.0:  # by way of a half-turn about x, to stay clear of the opposite of z
        flipped = from_z_onto((x, -y, -z))
        return product((1.0, 0.0, 0.0, 0.0), flipped)
    return normalised((-y, x, 0.0, 1.0 + z))


def rows_of(x: float, y: float, z: float, w: float) -> tuple[Vector, Vector, Vector]:
    """Return the three rows of the rotation matrix of a unit quaternion."""
    return (
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
        (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
        (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
    )


def rotation_matrix(q: FloatArray) -> FloatArray:
    """Return the (3, 3) rotation matrix of a unit quaternion x, y, z, w."""
    return np.array(rows_of(*q.tolist()))


def cross_matrix(vector: FloatArray) -> FloatArray:
    """Return the (3, 3) matrix R of the cross product, R a = vector x a (lecture 27, eq. 7)."""
    x, y, z = vector.tolist()
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
