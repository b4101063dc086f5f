"""The attitude of a tumbling body about its angular momentum, as quotients of theta functions.

With the z axis along L, the Cayley-Klein parameters alpha = q_w + i q_z and beta = q_x + i q_y of the
attitude of the principal frame are, up to a common positive factor that normalisation removes,

    alpha = e^{i psi} A(z),    beta = -i r e^{i psi} e^{i z} B(z),
    A = sum_j (-1)^j q^{j(2j+1)} e^{2 j xi} e^{-2 i j z},    B = the same with -xi and -z,    r = e^{-xi},

where z = pi u / 2K and psi are linear in time, q = exp(-pi K'/K) and xi = pi x / 2K with sn(x | 1 - m) = c
(Whittaker, Analytical Dynamics, 69 to 71; van Zon and Schofield 2007; these are theta_1 with nome q^2,
shifted by half of its imaginary period, so that nothing is singular for a symmetric body, q = 0, or for spin
about a principal axis, r = 0).

Near the middle axis q tends to 1. Poisson's summation then gives the same functions as a sum of bumps, one
for each stay near the middle axis, of which the nearest six suffice; the separatrix is the case of two.

`Harmonics` and `Bumps` are the two forms, `OneFlip` is the separatrix, `Steady` is spin at a constant rate.
Each turns times into (Re A, Im A, Re B', Im B', tan psi) with alpha = e^{i psi} A and beta = -i e^{i psi} B',
up to a common positive factor. Of psi the tangent is enough, because a common sign is no part of an attitude.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

if TYPE_CHECKING:
    from contact_dynamics.tumbling.double_double import LinearPhase
    from contact_dynamics.validation import FloatArray

Point: TypeAlias = "tuple[float, float, float, float, float]"
Points: TypeAlias = "tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]"


@dataclass(frozen=True, slots=True)
class Steady:
    """Spin at a constant rate about z."""

    psi: LinearPhase  # half turns

    def point(self, seconds: float) -> Point:
        """Return Re A, Im A, Re B', Im B', tan psi at a time, s."""
        return 1.0, 0.0, 0.0, 0.0, math.tan(math.pi * self.psi.fraction(seconds)[0])

    def points(self, seconds: FloatArray) -> Points:
        """Return `point` for times (n,), s."""
        zero = np.zeros_like(seconds)
        return zero + 1.0, zero, zero, zero, np.tan(np.pi * self.psi.fractions(seconds)[0])


@dataclass(frozen=True, slots=True)
class Harmonics:
    """Theta functions as trigonometric series: polynomials in cos 2z, lowest power first."""

    z: LinearPhase  # turns
    psi: LinearPhase  # half turns
    r: float  # e^{-xi}
    A_cos: tuple[float, ...]  # Re A
    A_sin: tuple[float, ...]  # Im A / sin 2z
    B_cos: tuple[float, ...]  # Re B
    B_sin: tuple[float, ...]  # Im B / sin 2z

    def point(self, seconds: float) -> Point:
        """Return Re A, Im A, Re B', Im B', tan psi at a time, s."""
        z = 2.0 * math.pi * self.z.fraction(seconds)[0]
        cos, sin = math.cos(z), math.sin(z)
        cos2, sin2 = 1.0 - 2.0 * sin * sin, 2.0 * sin * cos
        A_re = A_im = B_re = B_im = 0.0
        for k in reversed(range(len(self.A_cos))):
            A_re = A_re * cos2 + self.A_cos[k]
            B_re = B_re * cos2 + self.B_cos[k]
        for k in reversed(range(len(self.A_sin))):
            A_im = A_im * cos2 + self.A_sin[k]
            B_im = B_im * cos2 + self.B_sin[k]
        B_im *= sin2
        cos, sin = self.r * cos, self.r * sin
        tangent = math.tan(math.pi * self.psi.fraction(seconds)[0])
        return A_re, A_im * sin2, B_re * cos - B_im * sin, B_re * sin + B_im * cos, tangent

    def points(self, seconds: FloatArray) -> Points:
        """Return `point` for times (n,), s."""
        half = np.tan(np.pi * self.z.fractions(seconds)[0])
        square = half * half
        inverse = 1.0 / (1.0 + square)
        cos, sin = (1.0 - square) * inverse, 2.0 * half * inverse
        cos2, sin2 = 1.0 - 2.0 * sin * sin, 2.0 * sin * cos
        B_re, B_im = _polynomial(self.B_cos, cos2), _polynomial(self.B_sin, cos2) * sin2
        cos *= self.r
        sin *= self.r
        return (
            _polynomial(self.A_cos, cos2),
            _polynomial(self.A_sin, cos2) * sin2,
            B_re * cos - B_im * sin,
            B_re * sin + B_im * cos,
            np.tan(np.pi * self.psi.fractions(seconds)[0]),
        )


@dataclass(frozen=True, slots=True)
class Bumps:
    """Theta functions after Poisson's summation: stays near the middle axis, and a flip between each two."""

    z: LinearPhase  # half turns; a whole number at the middle of a flip
    psi: LinearPhase  # half turns
    steepness: float  # |log| of the ratio of the two nearest bumps, per half turn of z
    drift: float  # half turns of psi per half turn of z
    g: float  # ratio of a bump to the next at its own top; 0 where the next is below the last bit
    A_cos: tuple[float, float, float]
    A_sin: tuple[float, float, float]
    B_cos: tuple[float, float, float]
    B_sin: tuple[float, float, float]

    def point(self, seconds: float) -> Point:
        """Return Re A, Im A, Re B', Im B', tan psi at a time, s."""
        z, flips = self.z.fraction(seconds)
        side = math.copysign(1.0, z)
        parity = -1.0 if flips % 2.0 else 1.0
        w = math.exp(-self.steepness * abs(z))
        even, odd, g = 1.0 + w, side * (1.0 - w), self.g
        A_re, A_im = self.A_cos[0] * even, self.A_sin[0] * odd
        B_re, B_im = self.B_cos[0] * even, self.B_sin[0] * odd
        if g:
            v = g / w
            for near, far, k in ((v, g * w * w, 1), (g * v * v, (g * w) ** 3, 2)):
                even, odd = near + far, side * (near - far)
                A_re += self.A_cos[k] * even
                A_im += self.A_sin[k] * odd
                B_re += self.B_cos[k] * even
                B_im += self.B_sin[k] * odd
        tangent = math.tan(math.pi * (self.psi.fraction(seconds)[0] + self.drift * z))
        return A_re, A_im, parity * B_re, parity * B_im, tangent

    def points(self, seconds: FloatArray) -> Points:
        """Return `point` for times (n,), s."""
        z, flips = self.z.fractions(seconds)
        side = np.copysign(1.0, z)
        parity = 1.0 - 2.0 * np.remainder(flips, 2.0)
        w = np.exp(-self.steepness * np.abs(z))
        even, odd, g = 1.0 + w, side * (1.0 - w), self.g
        A_re, A_im = self.A_cos[0] * even, self.A_sin[0] * odd
        B_re, B_im = self.B_cos[0] * even, self.B_sin[0] * odd
        if g:
            v = g / w
            for near, far, k in ((v, g * w * w, 1), (g * v * v, (g * w) ** 3, 2)):
                even, odd = near + far, side * (near - far)
                A_re += self.A_cos[k] * even
                A_im += self.A_sin[k] * odd
                B_re += self.B_cos[k] * even
                B_im += self.B_sin[k] * odd
        psi = self.psi.fractions(seconds)[0] + self.drift * z
        return A_re, A_im, parity * B_re, parity * B_im, np.tan(np.pi * psi)


@dataclass(frozen=True, slots=True)
class OneFlip:
    """The separatrix: from spin about the middle axis, by one flip, to spin about it the other way round."""

    u: LinearPhase  # dimensionless time, 0 at the middle of the flip
    psi: LinearPhase  # half turns
    A: tuple[float, float]
    B: tuple[float, float]

    def point(self, seconds: float) -> Point:
        """Return Re A, Im A, Re B', Im B', tan psi at a time, s."""
        u = sum(self.u.fraction(seconds))
        w = math.exp(-abs(u))
        even, odd = 1.0 + w, math.copysign(1.0 - w, u)
        tangent = math.tan(math.pi * self.psi.fraction(seconds)[0])
        return self.A[0] * even, self.A[1] * odd, self.B[0] * even, self.B[1] * odd, tangent

    def points(self, seconds: FloatArray) -> Points:
        """Return `point` for times (n,), s."""
        rest, whole = self.u.fractions(seconds)
        u = rest + whole
        w = np.exp(-np.abs(u))
        even, odd = 1.0 + w, np.copysign(1.0 - w, u)
        tangent = np.tan(np.pi * self.psi.fractions(seconds)[0])
        return self.A[0] * even, self.A[1] * odd, self.B[0] * even, self.B[1] * odd, tangent


def _polynomial(coefficients: tuple[float, ...], x: FloatArray) -> FloatArray:
    value = np.full_like(x, coefficients[-1] if coefficients else 0.0)
    for coefficient in coefficients[-2::-1]:
        value *= x
        value += coefficient
    return value
