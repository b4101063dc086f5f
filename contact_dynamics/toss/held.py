"""A contact that stays, as a contact mode says: it sticks or rolls, or it slides, and in which direction."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from contact_dynamics.numerics.vectors import Vector3, dot
from contact_dynamics.tolerances import SLIDING_DIRECTION_SPEED

if TYPE_CHECKING:
    from contact_dynamics.toss.solid import Touch


class Held(NamedTuple):
    """A contact that stays.

    Attributes:
        touch: The corner and the flat.
        slides: Whether it slides. If it does not, it sticks, or it rolls if it is rounded.
        towards: Unit, world axes, the direction in which sliding begins, or zero if the contact sticks.
        begins: Whether it has just begun to slide, so that friction is against ``towards``. The velocity has
            no sure direction yet, and friction against it would turn in no time.
    """

    touch: Touch
    slides: bool = False
    towards: Vector3 = (0.0, 0.0, 0.0)
    begins: bool = False


def sliding_direction(velocity: Vector3, normal: Vector3, towards: Vector3) -> Vector3:
    """Return the unit direction in which a contact slides, from its velocity, m/s."""
    v_n = dot(velocity, normal)
    e = SLIDING_DIRECTION_SPEED
    x = velocity[0] - v_n * normal[0] + e * towards[0]
    y = velocity[1] - v_n * normal[1] + e * towards[1]
    z = velocity[2] - v_n * normal[2] + e * towards[2]
    size = math.sqrt(x * x + y * y + z * z)
    return (x / size, y / size, z / size) if size > 0.0 else towards
