"""All modes of one contact at rest in space, with Coulomb's round cone, from the roots of a polynomial.

The contact point's acceleration is b + G f for a contact force f. The contact sticks with f = -G^-1 b if that
lies in the cone. It slides along d with f = N (n - mu d), where N follows from b_n + N g(d) = 0 with
g(d) = (G (n - mu d))_n, if the tangential acceleration then has the direction d. The part of that
acceleration across d, multiplied by g, is a polynomial of second degree in the cosine and sine of d's angle.
So there are at most four directions.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

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


class Lettered(NamedTuple):
    """A mode of one contact.

    Attributes:
        letter: s, f or c.
        force: (3,).
    """

    letter: str
    force: FloatArray


def modes_of_one(G: FloatArray, b: FloatArray, normal: FloatArray, friction: float) -> list[Lettered]:
    """Return every mode of one contact at rest.

    Args:
        G: (3, 3), the acceleration that a unit force causes.
        b: (3,), its acceleration without force, in units in which the largest component is about 1.
        normal: (3,), unit.
        friction: Coulomb's mu, > 0.
    """
    found = []
    if float(normal @ b) > STRICT:
        found.append(Lettered(SEPARATES, np.zeros(3)))
    held: FloatArray = np.asarray(np.linalg.solve(G, -b), dtype=float)
    pressing = float(held @ normal)
    across = float(np.linalg.norm(held - pressing * normal))
    if across <= friction * pressing * (1.0 + ONE_CONTACT_ON_CONE) + ONE_CONTACT_ZERO * float(
        np.linalg.norm(held)
    ):
        found.append(Lettered(STICKS, held))
    return found + _sliding(G, b, normal, friction, sticks=bool(found) and found[-1].letter == STICKS)


def _sliding(
    G: FloatArray, b: FloatArray, normal: FloatArray, friction: float, *, sticks: bool
) -> list[Lettered]:
    frame = np.array(tangents_towards(normal, b))
    b_n, b_t = float(normal @ b), frame @ b
    if abs(b_n) <= ONE_CONTACT_ZERO:
        b_n = 0.0
    G_n, G_tn, G_tt = float(normal @ G @ normal), frame @ G @ normal, frame @ G @ frame.T
    size = float(np.abs(G).max()) * (1.0 + friction)

    def along(angle: float) -> tuple[FloatArray, FloatArray, float]:
        """Return a direction, the tangential and the normal acceleration for its unit normal force."""
        d = np.array([math.cos(angle), math.sin(angle)])
        return d, (G_tn - friction * (G_tt @ d)) / size, (G_n - friction * float(G_tn @ d)) / size

    def across(angle: float) -> float:
        d, u, g = along(angle)
        return g * float(d[0] * b_t[1] - d[1] * b_t[0]) - b_n * float(d[0] * u[1] - d[1] * u[0])

    found = []
    for angle in _roots(across):
        d, u, g = along(angle)
        if b_n != 0.0:
            press = -b_n / g if abs(g) > ONE_CONTACT_ZERO else -1.0
        elif abs(g) > ONE_CONTACT_ON_CONE:
            press = 0.0
        else:
            turns = float(d[0] * u[1] - d[1] * u[0])
            press = -float(d[0] * b_t[1] - d[1] * b_t[0]) / turns if abs(turns) > ONE_CONTACT_ZERO else -1.0
        speed = float(d @ (b_t + press * u))
        if press < 0.0 or speed <= 0.0 or (speed <= STRICT and sticks):
            continue
        force = press / size * (normal - friction * (d @ frame))
        found.append(Lettered(STAYS if speed > STRICT else STICKS, force))
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
    for root in np.roots(np.where(trial, coefficients, 0.0)):
        if abs(abs(root) - 1.0) > ONE_CONTACT_ON_CIRCLE:
            continue
        angle = _polished(function, math.atan2(root.imag, root.real), coefficients)
        if abs(function(angle)) <= 100.0 * ONE_CONTACT_ZERO * largest and all(
            abs(math.remainder(angle - other, 2.0 * math.pi)) > ONE_CONTACT_SAME_ANGLE for other in found
        ):
            found.append(angle)
    return found


def _polished(
    function: Callable[[float], float], angle: float, coefficients: NDArray[np.complex128]
) -> float:
    orders = np.array([2.0, 1.0, 0.0, -1.0, -2.0])
    for _ in range(_POLISHING):
        slope = float((1j * orders * coefficients * np.exp(1j * orders * angle)).sum().real)
        if slope == 0.0:
            break
        step = function(angle) / slope
        if not abs(step) < ONE_CONTACT_ON_CIRCLE:
            break
        angle -= step
    return angle
