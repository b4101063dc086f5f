"""Many rotations at once: quaternions x, y, z, w, (n, 4), matrices, (n, 3, 3), and rotation vectors, (n, 3).

A rotation vector is axis times angle, rad. All are in world axes and come after the attitude: Exp(theta) R.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray


def matrices_of(q: FloatArray) -> FloatArray:
    """Return the rotation matrices, (n, 3, 3), of unit quaternions, (n, 4)."""
    x, y, z, w = q.T
    R = np.empty((len(q), 3, 3))
    R[:, 0, 0] = 1.0 - 2.0 * (y * y + z * z)
    R[:, 1, 1] = 1.0 - 2.0 * (x * x + z * z)
    R[:, 2, 2] = 1.0 - 2.0 * (x * x + y * y)
    R[:, 0, 1], R[:, 1, 0] = 2.0 * (x * y - w * z), 2.0 * (x * y + w * z)
    R[:, 0, 2], R[:, 2, 0] = 2.0 * (x * z + w * y), 2.0 * (x * z - w * y)
    R[:, 1, 2], R[:, 2, 1] = 2.0 * (y * z - w * x), 2.0 * (y * z + w * x)
    return R


def cross_matrices(vectors: FloatArray) -> FloatArray:
    """Return the matrices, (n, 3, 3), of the cross products of vectors, (n, 3)."""
    crosses = np.zeros((len(vectors), 3, 3))
    crosses[:, 2, 1], crosses[:, 0, 2], crosses[:, 1, 0] = vectors.T
    crosses -= crosses.transpose(0, 2, 1)
    return crosses


def rotation_vectors(q: FloatArray, q_from: FloatArray) -> FloatArray:
    """Return the rotation vectors, (n, 3), at most pi long, that turn ``q_from`` into ``q``, (n, 4).

    ``q_from`` is (n, 4), or (4,) for all.
    """
    q_from = np.broadcast_to(q_from, q.shape)
    u, w, u_from, w_from = q[:, :3], q[:, 3:], q_from[:, :3], q_from[:, 3:]
    vector = w_from * u - w * u_from - np.cross(u, u_from)  # of q times the conjugate of q_from
    scalar = np.einsum("ij,ij->i", q, q_from)
    sine = np.sqrt(np.einsum("ij,ij->i", vector, vector))
    angle = 2.0 * np.arctan2(sine, np.abs(scalar))
    ratio = np.divide(angle, sine, out=np.full(len(sine), 2.0), where=sine > 0.0)  # tends to 2 at no turn
    theta: FloatArray = vector * np.copysign(ratio, scalar)[:, None]
    return theta


def turned(q: FloatArray, theta: FloatArray) -> FloatArray:
    """Return the quaternions, (n, 4), of attitudes ``q`` turned by rotation vectors, (n, 3).

    ``q`` is (n, 4), or (4,) for all.
    """
    q = np.broadcast_to(q, (len(theta), 4))
    angle = np.sqrt(np.einsum("ij,ij->i", theta, theta))
    a = theta * (0.5 * np.sinc(angle / (2.0 * np.pi)))[:, None]
    c = np.cos(0.5 * angle)
    u, w = q[:, :3], q[:, 3]
    vector = c[:, None] * u + w[:, None] * a + np.cross(a, u)
    return np.column_stack([vector, c * w - np.einsum("ij,ij->i", a, u)])


def make_continuous(q: FloatArray, first: FloatArray) -> None:
    """Choose of q and -q, one attitude, the one nearer to the row before, and at first to ``first``, (4,)."""
    if len(q) == 0:
        return
    signs = np.empty(len(q))
    signs[0] = q[0] @ first
    np.einsum("ij,ij->i", q[1:], q[:-1], out=signs[1:])
    np.copysign(1.0, signs, out=signs)
    np.cumprod(signs, out=signs)
    q *= signs[:, None]
