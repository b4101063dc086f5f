# SPDX-License-Identifier: Apache-2.0
"""Converts vectors, quaternions and inertia of `geometry_msgs` to arrays and domain types, and back."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from geometry_msgs.msg import Inertia, Point, Pose, Quaternion, Vector3

from contact_dynamics.rigid_body.body import MassProperties
from contact_dynamics.validation import check_array

if TYPE_CHECKING:
    from collections.abc import Iterable

    from contact_dynamics.numerics.vectors import Vector3 as Vector
    from contact_dynamics.validation import FloatArray


def vector_from_msg(msg: Vector3 | Point) -> FloatArray:
    """Return x, y, z as an array, (3,)."""
    return np.array((msg.x, msg.y, msg.z))


def vector_to_msg(vector: Iterable[float], *, into: Vector3 | Point | None = None) -> Vector3 | Point:
    """Return three numbers as a message, which is a new `Vector3` unless one to fill is given."""
    msg = Vector3() if into is None else into
    msg.x, msg.y, msg.z = map(float, vector)
    return msg


def quaternion_from_msg(msg: Quaternion) -> FloatArray:
    """Return x, y, z, w as an array, (4,)."""
    return np.array((msg.x, msg.y, msg.z, msg.w))


def quaternion_to_msg(quaternion: Iterable[float], *, into: Quaternion) -> None:
    """Write x, y, z, w into a message."""
    into.x, into.y, into.z, into.w = map(float, quaternion)


def pose_to_msg(position: Iterable[float], orientation: Iterable[float]) -> Pose:
    """Return a position and a quaternion x, y, z, w as a message."""
    msg = Pose()
    vector_to_msg(position, into=msg.position)
    quaternion_to_msg(orientation, into=msg.orientation)
    return msg


def mass_properties_from_msg(msg: Inertia) -> tuple[MassProperties, FloatArray]:
    """Return mass properties, and the centre of mass in the body's frame, (3,), m.

    The errors are those of `MassProperties`, and `InvalidFieldError` if the centre of mass is not finite.
    """
    com = msg.com
    return _mass_properties(
        msg.m, (com.x, com.y, com.z), (msg.ixx, msg.iyy, msg.izz), (msg.ixy, msg.ixz, msg.iyz)
    )


@lru_cache(maxsize=64)  # a client that sends an inertia sends it with every question
def _mass_properties(
    mass: float, com: Vector, moments: Vector, products: Vector
) -> tuple[MassProperties, FloatArray]:
    (ixx, iyy, izz), (ixy, ixz, iyz) = moments, products
    inertia = np.array(((ixx, ixy, ixz), (ixy, iyy, iyz), (ixz, iyz, izz)))
    return MassProperties(mass=mass, I_B=inertia), check_array("inertia.com", com, (3,))
