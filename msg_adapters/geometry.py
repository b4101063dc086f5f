"""`geometry_msgs` vectors, quaternions and inertia, to arrays and domain types, and back."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from geometry_msgs.msg import Inertia, Point, Pose, Quaternion, Vector3

from contact_dynamics.rigid_body import MassProperties
from contact_dynamics.validation import check_array

if TYPE_CHECKING:
    from collections.abc import Iterable

    from contact_dynamics.validation import FloatArray


def vector_from_msg(msg: Vector3 | Point) -> FloatArray:
    """Return x, y, z as an array, (3,)."""
    return np.array((msg.x, msg.y, msg.z))


def vector_to_msg(vector: Iterable[float]) -> Vector3:
    """Return three numbers as a message."""
    x, y, z = map(float, vector)
    return Vector3(x=x, y=y, z=z)


def point_to_msg(vector: Iterable[float]) -> Point:
    """Return three coordinates as a message."""
    x, y, z = map(float, vector)
    return Point(x=x, y=y, z=z)


def quaternion_from_msg(msg: Quaternion) -> FloatArray:
    """Return x, y, z, w as an array, (4,)."""
    return np.array((msg.x, msg.y, msg.z, msg.w))


def pose_to_msg(position: Iterable[float], orientation: Iterable[float]) -> Pose:
    """Return a position and a quaternion x, y, z, w as a message."""
    x, y, z, w = map(float, orientation)
    return Pose(position=point_to_msg(position), orientation=Quaternion(x=x, y=y, z=z, w=w))


def mass_properties_from_msg(msg: Inertia) -> tuple[MassProperties, FloatArray]:
    """Return mass properties, and the centre of mass in the body's frame, (3,), m.

    Raises:
        InvalidFieldError: as `MassProperties`, or the centre of mass is not finite.
    """
    inertia = ((msg.ixx, msg.ixy, msg.ixz), (msg.ixy, msg.iyy, msg.iyz), (msg.ixz, msg.iyz, msg.izz))
    mass_properties = MassProperties(mass=msg.m, I_B=np.array(inertia))
    return mass_properties, check_array("inertia.com", vector_from_msg(msg.com), (3,))


def mass_properties_to_msg(mass_properties: MassProperties, p_FB_F: FloatArray) -> Inertia:
    """Return mass properties and the centre of mass in the body's frame as a message."""
    (ixx, ixy, ixz), (_, iyy, iyz), (_, _, izz) = mass_properties.I_B.tolist()
    com = vector_to_msg(p_FB_F)
    return Inertia(m=mass_properties.mass, com=com, ixx=ixx, ixy=ixy, ixz=ixz, iyy=iyy, iyz=iyz, izz=izz)
