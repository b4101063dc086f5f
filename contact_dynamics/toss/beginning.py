"""In which directions contacts begin to slide that slide along their own accelerations.

Friction is against the direction, so that the acceleration depends on it. To put the acceleration's direction
in the place of the other, again and again, leads there where friction is far exceeded. Where it is hardly
exceeded, accelerations are small, a small turn of friction turns them a lot, and that goes in circles. Here
Newton's method finds all directions at once.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.numerics.vectors import cross, dot
from contact_dynamics.tolerances import BEGINNING_ROUNDING, BEGINNING_TURN
from contact_dynamics.toss.forces import Free, pushed_by_contacts
from contact_dynamics.toss.solid import arm_of, pose_of

if TYPE_CHECKING:
    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.toss.held import Held
    from contact_dynamics.toss.solid import Numbers, Solid
    from contact_dynamics.validation import FloatArray

_MAX_STEPS: Final = 12
_FARTHEST: Final = 0.5
"""rad. The largest turn of a step: a friction cone is round."""


def turned_along_accelerations(solid: Solid, y: Numbers, mode: tuple[Held, ...]) -> tuple[Held, ...]:
    """Return a mode whose contacts that begin to slide do so along their accelerations, if that is found."""
    which = [k for k, one in enumerate(mode) if one.begins]
    if not which:
        return mode
    enough = 0.1 * BEGINNING_ROUNDING * (1.0 + math.hypot(*solid.gravity))
    pose = pose_of(solid, y)

    def sideways(tried: tuple[Held, ...]) -> FloatArray:
        """Return the accelerations across the directions of sliding, m/s^2."""
        rates = pushed_by_contacts(solid, y, tried).rates
        moved = Free(pose, (rates[7], rates[8], rates[9]), (rates[10], rates[11], rates[12]))
        found = []
        for k in which:
            touch, n = tried[k].touch, solid.flats[tried[k].touch[0]].normal
            across = cross(n, tried[k].towards)
            found.append(dot(across, moved.at(solid, touch, arm_of(solid, pose, touch))))
        return np.array(found)

    for _ in range(_MAX_STEPS):
        off = sideways(mode)
        if np.abs(off).max() <= enough:
            break
        slopes = [(sideways(_turned(solid, mode, {k: BEGINNING_TURN})) - off) / BEGINNING_TURN for k in which]
        turns = np.linalg.lstsq(np.array(slopes).T, -off, rcond=None)[0]
        largest = float(np.abs(turns).max())
        if largest > _FARTHEST:
            turns *= _FARTHEST / largest
        mode = _turned(solid, mode, dict(zip(which, turns.tolist(), strict=True)))
    return mode


def _turned(solid: Solid, mode: tuple[Held, ...], turns: dict[int, float]) -> tuple[Held, ...]:
    """Return a mode with some directions of sliding turned about their normals, rad."""
    return tuple(
        one._replace(towards=_about(solid.flats[one.touch[0]].normal, one.towards, turns[k]))
        if k in turns
        else one
        for k, one in enumerate(mode)
    )


def _about(n: Vector3, d: Vector3, angle: float) -> Vector3:
    e, c, s = cross(n, d), math.cos(angle), math.sin(angle)
    return (c * d[0] + s * e[0], c * d[1] + s * e[1], c * d[2] + s * e[2])
