# SPDX-License-Identifier: Apache-2.0
"""Many rotations at once are quaternions x, y, z, w, (n, 4), matrices, (n, 3, 3), rotation vectors, (n, 3).

A rotation vector is axis times angle, rad. It is in world axes and turns the attitude R into Exp(theta) R.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.rotations.one import rotation_matrix, rows_of

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray


def crosses(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return cross products of vectors, whose shapes end in 3: those of `numpy.cross` in half of its time."""
    c: FloatArray = np.empty(np.broadcast_shapes(a.shape, b.shape))
    x, y, z = a[..., 0], a[..., 1], a[..., 2]
    u, v, w = b[..., 0], b[..., 1], b[..., 2]
    c[..., 0], c[..., 1], c[..., 2] = y * w - z * v, z * u - x * w, x * v - y * u
    return c


def matrices_of(q: FloatArray) -> FloatArray:
    """Return the rotation matrices, (n, 3, 3), of unit quaternions, (n, 4)."""
    if len(q) == 1:  # floats are faster
        return rotation_matrix(q[0])[None]
    R = np.empty((len(q), 3, 3))
    R.transpose(1, 2, 0)[:] = rows_of(*q.T)
    return R


def products(p: FloatArray, q: FloatArray) -> FloatArray:
    """Return Hamilton's products, (n, 4): the rotations ``q``, each followed by one of ``p``, (n, 4).

    ``q`` is (n, 4), or (4,) for all. The two cases may differ in the last bit, because NumPy sums a product
    of matrices in another order than one of rows.
    """
    x, s = p[:, :3], p[:, 3:]
    u, w = q[..., :3], q[..., 3:]
    inner = x @ u if q.ndim == 1 else np.einsum("ij,ij->i", x, u)
    return np.column_stack([s * u + w * x + crosses(x, u), s[:, 0] * w[..., 0] - inner])


def rotated(q: FloatArray, vector: FloatArray) -> FloatArray:
    """Return a vector, (3,), turned by each of the unit quaternions, (n, 4), as (n, 3)."""
    twice = 2.0 * crosses(q[:, :3], vector)
    vectors: FloatArray = vector + q[:, 3:] * twice + crosses(q[:, :3], twice)
    return vectors


def quaternions_of(theta: FloatArray) -> FloatArray:
    """Return the quaternions, (n, 4), of rotation vectors, (n, 3)."""
    return _of_angles(theta, np.linalg.norm(theta, axis=1))


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
    vector = w_from * u - w * u_from - crosses(u, u_from)  # the product of q and the conjugate of q_from
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
    # Not `quaternions_of`: its angles are summed in another order, and fits go by these to the last bit.
    turns = _of_angles(theta, np.sqrt(np.einsum("ij,ij->i", theta, theta)))
    return products(turns, np.broadcast_to(q, turns.shape))


def _of_angles(theta: FloatArray, angles: FloatArray) -> FloatArray:
    """Return the quaternions, (n, 4), of rotation vectors of lengths ``angles``, (n,), rad."""
    vectors = theta * (0.5 * np.sinc(angles / (2.0 * np.pi)))[:, None]
    return np.column_stack([vectors, np.cos(0.5 * angles)])


def make_continuous(q: FloatArray, first: FloatArray) -> None:
    """Give each quaternion the sign nearer to the row before, and the first one that nearer to ``first``."""
    if len(q) == 0:
        return
    signs = np.empty(len(q))
    signs[0] = q[0] @ first
    np.einsum("ij,ij->i", q[1:], q[:-1], out=signs[1:])
    np.copysign(1.0, signs, out=signs)
    np.cumprod(signs, out=signs)
    q *= signs[:, None]
