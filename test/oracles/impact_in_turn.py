# SPDX-License-Identifier: Apache-2.0
"""Frictionless strikes in turn, in exact fractions: each takes a normal impulse (1 + e) v / k.

Corners that tie share an impulse equally, which then acts at their mean place.
"""

from __future__ import annotations

from fractions import Fraction

Vector = tuple[Fraction, Fraction, Fraction]


def strikes(
    *,
    mass: Fraction,
    moments: Vector,
    v_z: Fraction,
    corners: list[tuple[Fraction, Fraction]],
    e: Fraction,
    priority: tuple[int, ...] | None,
    tolerance: Fraction,
) -> tuple[tuple[int, ...], Vector]:
    """Return which corners of a level body strike the floor below, in order, and v_z, w_x, w_y afterwards.

    Each time the first in ``priority`` that approaches is struck, or without one all that are fastest.
    """
    w_x, w_y = Fraction(0), Fraction(0)
    order: list[int] = []
    while True:
        speeds = [v_z + w_x * y - w_y * x for x, y in corners]
        approaching = [i for i in (priority or range(len(corners))) if speeds[i] < -tolerance]
        if not approaching:
            return tuple(order), (v_z, w_x, w_y)
        fastest = min(speeds[i] for i in approaching)
        struck = approaching[:1] if priority else [i for i in approaching if speeds[i] == fastest]
        x, y = (sum((corners[i][k] for i in struck), Fraction(0)) / len(struck) for k in (0, 1))
        impulse = -(1 + e) * speeds[struck[0]] / (1 / mass + y * y / moments[0] + x * x / moments[1])
        v_z, w_x, w_y = v_z + impulse / mass, w_x + y * impulse / moments[0], w_y - x * impulse / moments[1]
        order += struck
