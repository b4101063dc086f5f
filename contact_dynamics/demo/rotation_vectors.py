"""Rotation vectors of measured orientations: the small rotations that regressions can treat as coordinates.

A rotation vector is axis times angle, rad. All are in world axes and premultiply: R = Exp(theta) R_reference,
so that at theta = 0 its rate is the angular velocity in world axes. Quaternions are x, y, z, w. Rotations by
half a turn or more have no unique vector: windows must be shorter than that.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray


def rotation_vectors_from(q_reference: FloatArray, q: FloatArray) -> FloatArray:
    """Return theta, (n, 3), rad, world axes, that turns ``q_reference``, (4,), into each of ``q``, (n, 4)."""
    x, y, z, w = q_reference
    u, c = q[:, :3], q[:, 3]
    u_0 = np.array([-x, -y, -z])
    vector = c[:, None] * u_0 + w * u + np.cross(u, u_0)  # of q times the conjugate of the reference
    scalar = c * w - u @ u_0
    vector = np.where(scalar[:, None] < 0.0, -vector, vector)
    length = np.sqrt(np.einsum("ij,ij->i", vector, vector))
    angle = 2.0 * np.arctan2(length, np.abs(scalar))
    # angle / length tends to 2 at no rotation, where both vanish
    ratio = np.divide(angle, length, out=np.full_like(length, 2.0), where=length > 0.0)
    theta: FloatArray = vector * ratio[:, None]
    return theta


def rotated(theta: FloatArray, q: FloatArray) -> FloatArray:
    """Return orientations, (n, 4): ``q``, (4,) or (n, 4), turned by ``theta``, (n, 3), rad, world axes."""
    angle = np.sqrt(np.einsum("ij,ij->i", theta, theta))
    a = theta * (0.5 * np.sinc(angle / (2.0 * np.pi)))[:, None]
    s = np.cos(0.5 * angle)
    u, c = q[..., :3], q[..., 3]
    vector = s[:, None] * u + np.asarray(c)[..., None] * a + np.cross(a, u)
    scalar = s * c - np.einsum("ij,ij->i", a, np.broadcast_to(u, a.shape))
    return np.column_stack([vector, scalar])


def rotation_matrices(q: FloatArray) -> FloatArray:
    """Return rotation matrices, (n, 3, 3), of unit quaternions, (n, 4), x y z w."""
    x, y, z, w = q.T
    rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
    matrices: FloatArray = np.moveaxis(np.array(rows), -1, 0)
    return matrices
