# SPDX-License-Identifier: Apache-2.0
"""All modes of one contact at rest in space, with Coulomb's round cone, from the roots of a polynomial.

The contact point's acceleration is b + G f for a contact force f. The contact sticks with f = -G^-1 b if that
lies in the cone. It slides along d with f = N (n - mu d), where N follows from b_n + N g(d) = 0 with
g(d) = (G (n - mu d))_n, if the tangential acceleration then has the direction d. The part of that
acceleration across d, multiplied by g, is a polynomial of second degree in the cosine and sine of d's angle.
So there are at most four directions.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact_modes.letters import SEPARATES, STAYS, STICKS
from contact_dynamics.numerics.vectors import tangents_towards
from contact_dynamics.tolerances import (
    ONE_CONTACT_ON_CIRCLE,
    ONE_CONTACT_ON_CONE,
    ONE_CONTACT_SAME_ANGLE,
    ONE_CONTACT_ZERO,
    STRICT,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from contact_dynamics.validation import FloatArray

_POLISHING: Final = 8
"""The number of Newton's steps from a root of the polynomial. Two are enough for a single root."""


def modes_of_one(
    G: FloatArray, b: FloatArray, normal: FloatArray, friction: float, holding: float
) -> list[tuple[str, FloatArray]]:
    """Return every mode of one contact at rest, which has friction and ``holding`` > 0 where it sticks.

    A unit force causes the acceleration G, (3, 3). Without force it is b, (3,), whose largest component is
    about 1.
    """
    found = []
    if float(normal @ b) > STRICT:
        found.append((SEPARATES, np.zeros(3)))
    held: FloatArray = np.asarray(np.linalg.solve(G, -b), dtype=float)
    pressing = float(held @ normal)
    across = float(np.linalg.norm(held - pressing * normal))
    if across <= holding * pressing * (1.0 + ONE_CONTACT_ON_CONE) + ONE_CONTACT_ZERO * float(
        np.linalg.norm(held)
    ):
        found.append((STICKS, held))
    return found + _sliding(G, b, normal, friction, sticks=bool(found) and found[-1][0] == STICKS)


def _sliding(
    G: FloatArray, b: FloatArray, normal: FloatArray, friction: float, *, sticks: bool
) -> list[tuple[str, FloatArray]]:
    frame = np.array(tangents_towards(normal, b))
    b_n, (b_x, b_y) = float(normal @ b), (frame @ b).tolist()
    if abs(b_n) <= ONE_CONTACT_ZERO:
        b_n = 0.0
    G_n, (G_xn, G_yn) = float(normal @ G @ normal), (frame @ G @ normal).tolist()
    (G_xx, G_xy), (_, G_yy) = (frame @ G @ frame.T).tolist()
    size = float(np.abs(G).max()) * (1.0 + friction)

    def along(x: float, y: float) -> tuple[float, float, float]:
        """Return the acceleration along both tangents and the normal for a direction's unit normal force."""
        return (
            (G_xn - friction * (G_xx * x + G_xy * y)) / size,
            (G_yn - friction * (G_xy * x + G_yy * y)) / size,
            (G_n - friction * (G_xn * x + G_yn * y)) / size,
        )

    def across(angle: float) -> float:
        x, y = math.cos(angle), math.sin(angle)
        u, v, g = along(x, y)
        value: float = g * (x * b_y - y * b_x) - b_n * (x * v - y * u)
        return value

    found = []
    for angle in _roots(across):
        x, y = math.cos(angle), math.sin(angle)
        u, v, g = along(x, y)
        if b_n != 0.0:
            press = -b_n / g if abs(g) > ONE_CONTACT_ZERO else -1.0
        elif abs(g) > ONE_CONTACT_ON_CONE:
            press = 0.0
        else:
            turns = x * v - y * u
            press = -(x * b_y - y * b_x) / turns if abs(turns) > ONE_CONTACT_ZERO else -1.0
        speed = x * (b_x + press * u) + y * (b_y + press * v)
        if press < 0.0 or speed <= 0.0 or (speed <= STRICT and sticks):
            continue
        force = press / size * (normal - friction * (x * frame[0] + y * frame[1]))
        found.append((STAYS if speed > STRICT else STICKS, force))
        sticks |= speed <= STRICT
    return found


def _roots(function: Callable[[float], float]) -> list[float]:
    """Return the zeros, rad, of a trigonometric polynomial of second degree."""
    angles = 2.0 * math.pi * np.arange(5) / 5.0
    samples = np.array([function(angle) for angle in angles.tolist()])
    terms: NDArray[np.complex128] = np.asarray(np.fft.fft(samples) / 5.0, dtype=np.complex128)
    coefficients = terms[[2, 1, 0, 4, 3]]  # coefficients of z^4 ... z^0, z = exp(i angle)
    largest = float(np.abs(coefficients).max())
    if largest <= ONE_CONTACT_ZERO**2:
        return []
    found: list[float] = []
    trial = np.abs(coefficients) > ONE_CONTACT_ZERO * largest
    own = coefficients.tolist()
    for root in np.roots(np.where(trial, coefficients, 0.0)):
        if abs(abs(root) - 1.0) > ONE_CONTACT_ON_CIRCLE:
            continue
        angle = _polished(function, math.atan2(root.imag, root.real), own)
        if abs(function(angle)) <= 100.0 * ONE_CONTACT_ZERO * largest and all(
            abs(math.remainder(angle - other, 2.0 * math.pi)) > ONE_CONTACT_SAME_ANGLE for other in found
        ):
            found.append(angle)
    return found


def _polished(function: Callable[[float], float], angle: float, coefficients: list[complex]) -> float:
    of_two, of_one, _, of_minus_one, of_minus_two = coefficients
    twice, once = 2.0 * (of_minus_two.imag - of_two.imag), of_minus_one.imag - of_one.imag
    twice_across, once_across = -2.0 * (of_two.real + of_minus_two.real), -(of_one.real + of_minus_one.real)
    for _ in range(_POLISHING):
        slope = (
            twice * math.cos(2.0 * angle)
            + twice_across * math.sin(2.0 * angle)
            + once * math.cos(angle)
            + once_across * math.sin(angle)
        )
        if slope == 0.0:
            break
        step = function(angle) / slope
        if not abs(step) < ONE_CONTACT_ON_CIRCLE:
            break
        angle -= step
    return angle
