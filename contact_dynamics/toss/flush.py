"""The accelerations of a body that slides with three or more corners flush on one flat.

This is the case in which a toss spends most of its contact time, so it has formulas of its own. The body
turns about the flat's normal alone. With the arms s in the plane, the height h of the centre of mass, the
sliding directions d, and j = I n, the balance of force and moment is

    sum f = -m g_n,    sum f (s x n + mu h n x d)_t = alpha j_t + w^2 (n x j)_t,
    alpha j_n = -mu sum f (s x d) . n,

for the normal forces f. Of all forces that balance, the least are taken, as in `forces`.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from contact_dynamics.numerics.vectors import Vector3, dot
from contact_dynamics.rotations.one import rows_of
from contact_dynamics.tolerances import SAME_FORCES, SLIDING_DIRECTION_SPEED
from contact_dynamics.toss.solid import times, transposed_times

if TYPE_CHECKING:
    from contact_dynamics.toss.solid import Held, Numbers, Solid

_DIRECTION_SURE: Final = 1e6 * SLIDING_DIRECTION_SPEED
"""m/s. A contact that slides faster has a direction of its own, to 1e-6."""


def flush_sliding(
    solid: Solid, y: Numbers, mode: tuple[Held, ...]
) -> tuple[Vector3, Vector3, list[Vector3]] | None:
    """Return the accelerations, m/s^2 and rad/s^2, and the forces, N, at sliding contacts on one flat.

    The result is None if the corners are on one line, so that they do not keep the body flush.
    """
    flat = solid.flats[mode[0].touch[0]]
    n, (t1, t2), mu = flat.normal, flat.tangents, flat.friction
    x, yy, z, w = y[3], y[4], y[5], y[6]
    scale = 1.0 / math.sqrt(x * x + yy * yy + z * z + w * w)
    a, b, c = rows_of(scale * x, scale * yy, scale * z, scale * w)
    rows = (a, b, c)
    first, second, up = transposed_times(rows, t1), transposed_times(rows, t2), transposed_times(rows, n)
    j = times(solid.inertia, up)
    j1, j2, jn = dot(j, first), dot(j, second), dot(j, up)
    v1, v2 = dot(t1, (y[7], y[8], y[9])), dot(t2, (y[7], y[8], y[9]))
    spin = y[10] * n[0] + y[11] * n[1] + y[12] * n[2]
    high = dot(n, (y[0], y[1], y[2])) - flat.level
    e = SLIDING_DIRECTION_SPEED
    directions, pulls, twists = [], [], []
    for touch, _, towards, begins in mode:
        p, q, r = solid.corners[touch[1]]
        s, t = p * first[0] + q * first[1] + r * first[2], p * second[0] + q * second[1] + r * second[2]
        u, v = v1 - spin * t, v2 + spin * s
        if begins:
            u, v = dot(towards, t1), dot(towards, t2)
        elif abs(u) + abs(v) < _DIRECTION_SURE:
            u, v = u + e * dot(towards, t1), v + e * dot(towards, t2)
        speed = math.sqrt(u * u + v * v)
        if speed > 0.0:
            u, v = u / speed, v / speed
        twist = mu * (s * v - t * u)
        two = t - mu * high * v + j1 / jn * twist
        three = -s + mu * high * u + j2 / jn * twist
        directions.append((u, v))
        twists.append(twist)
        pulls.append((two, three))
    g1, g2, gn = dot(t1, solid.gravity), dot(t2, solid.gravity), dot(n, solid.gravity)
    wanted = -solid.mass * gn, -spin * spin * j2, spin * spin * j1
    shares = _shares(pulls, wanted)
    if shares is None:
        return None
    k1, k2, k3 = shares
    turn = f1 = f2 = 0.0
    forces = []
    for (u, v), (two, three), twist in zip(directions, pulls, twists, strict=True):
        f = k1 + k2 * two + k3 * three
        turn -= f * twist
        x, yy = -mu * f * u, -mu * f * v
        f1, f2 = f1 + x, f2 + yy
        forces.append(
            (
                f * n[0] + x * t1[0] + yy * t2[0],
                f * n[1] + x * t1[1] + yy * t2[1],
                f * n[2] + x * t1[2] + yy * t2[2],
            )
        )
    turn /= jn
    a1, a2 = g1 + f1 / solid.mass, g2 + f2 / solid.mass
    return (
        (a1 * t1[0] + a2 * t2[0], a1 * t1[1] + a2 * t2[1], a1 * t1[2] + a2 * t2[2]),
        (turn * n[0], turn * n[1], turn * n[2]),
        forces,
    )


def _shares(pulls: list[tuple[float, float]], wanted: Vector3) -> Vector3 | None:
    """Return the multipliers of the three equations for the least normal forces, or None on a line."""
    s11 = float(len(pulls))
    s12 = s13 = s22 = s23 = s33 = 0.0
    for two, three in pulls:
        s12, s13, s22 = s12 + two, s13 + three, s22 + two * two
        s23, s33 = s23 + two * three, s33 + three * three
    A, B, C = s22 * s33 - s23 * s23, s13 * s23 - s12 * s33, s12 * s23 - s13 * s22
    det = s11 * A + s12 * B + s13 * C
    if not det > SAME_FORCES * s11 * s22 * s33:
        return None
    D, E, F = s11 * s33 - s13 * s13, s12 * s13 - s11 * s23, s11 * s22 - s12 * s12
    x, y, z = wanted
    return (
        (A * x + B * y + C * z) / det,
        (B * x + D * y + E * z) / det,
        (C * x + E * y + F * z) / det,
    )


def is_flush(mode: tuple[Held, ...]) -> bool:
    """Return whether three or more contacts slide on one flat."""
    return len(mode) > 2 and all(one.slides and one.touch[0] == mode[0].touch[0] for one in mode)
