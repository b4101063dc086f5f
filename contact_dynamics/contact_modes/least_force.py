"""The least forces that balance a wrench where many do: one choice, symmetric and finite.

Among the x >= 0 with sum x_i c_i = w the one of least sum of squares is x_i = max(0, c_i . y) for the y in
R^3 that minimises sum x_i^2 / 2 - w . y: three unknowns, however many forces. Newton's method finds it in a
few steps, because that function is convex and quadratic in pieces.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from contact_dynamics.contact_modes.cone import Vector3, cross, dot

if TYPE_CHECKING:
    from collections.abc import Sequence

_MOST_STEPS: Final = 100
_BALANCED: Final = 1e-15  # relative to the wrench: what is then left over is rounding
_DAMPING: Final = 1e-6  # relative to the curvature: keeps the first steps finite where few forces act
_DESCENT: Final = 1e-4  # part of the promised descent that a step must bring (Armijo 1966)
_SHORTEST: Final = 1e-9  # of a step; below it rounding hides all descent


def least_force(columns: Sequence[Vector3], target: Vector3, absent: Sequence[Vector3]) -> list[float]:
    """Return the least x >= 0 with sum x_i columns_i = target.

    Args:
        columns: Unit vectors whose positive combinations hold ``target`` in their relative interior.
        target: What to balance.
        absent: Orthonormal directions orthogonal to all columns; the part of ``target`` there is left out.
    """
    for direction in absent:
        target = _plus(target, -dot(direction, target), direction)
    size = math.sqrt(dot(target, target))
    y = target
    value, gradient, x = _function(columns, target, y)
    for _ in range(_MOST_STEPS):
        off = math.sqrt(dot(gradient, gradient))
        if off <= _BALANCED * size:
            break
        step = _newton_step(columns, x, gradient, absent, min(_DAMPING, off / size))
        slope = dot(step, gradient)
        length = 1.0
        trial = _function(columns, target, _plus(y, length, step))
        while trial[0] > value + _DESCENT * length * slope and length > _SHORTEST:
            length *= 0.5
            trial = _function(columns, target, _plus(y, length, step))
        if length <= _SHORTEST:
            break
        y = _plus(y, length, step)
        value, gradient, x = trial
    return x


def _function(columns: Sequence[Vector3], target: Vector3, y: Vector3) -> tuple[float, Vector3, list[float]]:
    """Return value and gradient of the function that y minimises, and the forces that belong to y."""
    x = [max(0.0, c[0] * y[0] + c[1] * y[1] + c[2] * y[2]) for c in columns]
    g_x, g_y, g_z = -target[0], -target[1], -target[2]
    squares = 0.0
    for force, c in zip(x, columns, strict=True):
        if force > 0.0:
            squares += force * force
            g_x += force * c[0]
            g_y += force * c[1]
            g_z += force * c[2]
    return 0.5 * squares - dot(target, y), (g_x, g_y, g_z), x


def _newton_step(
    columns: Sequence[Vector3],
    x: Sequence[float],
    gradient: Vector3,
    absent: Sequence[Vector3],
    damping: float,
) -> Vector3:
    acting = [c for force, c in zip(x, columns, strict=True) if force > 0.0]
    small = damping * len(acting)
    one, two, three = (
        [sum(c[i] * c[j] for c in (*acting, *absent)) + (small if i == j else 0.0) for j in range(3)]
        for i in range(3)
    )
    a, b, c = (one[0], one[1], one[2]), (two[0], two[1], two[2]), (three[0], three[1], three[2])
    rows = (cross(b, c), cross(c, a), cross(a, b))
    det = dot(a, rows[0])
    return (
        -(rows[0][0] * gradient[0] + rows[1][0] * gradient[1] + rows[2][0] * gradient[2]) / det,
        -(rows[0][1] * gradient[0] + rows[1][1] * gradient[1] + rows[2][1] * gradient[2]) / det,
        -(rows[0][2] * gradient[0] + rows[1][2] * gradient[1] + rows[2][2] * gradient[2]) / det,
    )


def _plus(a: Vector3, factor: float, b: Vector3) -> Vector3:
    return (a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2])
