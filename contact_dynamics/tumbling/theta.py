# SPDX-License-Identifier: Apache-2.0
"""Theta functions, whose quotients are the attitude of a tumbling body relative to its angular momentum.

With the z axis along L, the Cayley-Klein parameters alpha = q_w + i q_z and beta = q_x + i q_y of the
attitude of the principal frame are, up to a common positive factor that normalisation removes,

    alpha = e^{i psi} A(z),    beta = -i r e^{i psi} e^{i z} B(z),
    A = sum_j (-1)^j q^{j(2j+1)} e^{2 j xi} e^{-2 i j z},    B = the same with -xi and -z,    r = e^{-xi},

where z = pi u / 2K and psi are linear in time, q = exp(-pi K'/K) and xi = pi x / 2K with sn(x | 1 - m) = c
(Whittaker, Analytical Dynamics, 69 to 71; van Zon and Schofield 2007; these are theta_1 with nome q^2,
shifted by half of its imaginary period, so that nothing is singular for a symmetric body, q = 0, or for spin
about a principal axis, r = 0).

Near the middle axis q tends to 1. Poisson's summation then gives the same functions as a sum of bumps, one
for each time that the motion stays near the middle axis. The nearest six suffice. On the separatrix there are
two.

`Harmonics` and `Bumps` are the two forms, `OneFlip` is the separatrix, `Steady` is spin at a constant rate.
Each takes z, as fraction and whole number, and psi, in half turns, and returns `Values`:

- A and B', with alpha = e^{i psi} A, beta = -i e^{i psi} B' up to a common positive factor;
- C = 2 Re(A B'*) and D = |A|^2 - |B'|^2, to which L_1 and L_3 are proportional;
- tan psi, which says enough about psi, because a common sign does not change an attitude.

C and D are summed separately, as theta_2 and theta_3 with nome q (|A|^2 + |B'|^2 is theta_4). Differences
would lose digits, since a needle spins fast about an axis along which L is small.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

from contact_dynamics.records import Record
from contact_dynamics.tolerances import SMALLEST

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import ModuleType

Values: TypeAlias = "tuple[Any, Any, Any, Any, Any, Any, Any]"
"""Re A, Im A, Re B', Im B', C, D, tan psi: floats for one time, arrays (n,) for many."""

Three: TypeAlias = "tuple[Any, Any, Any]"


@dataclass(frozen=True, slots=True, repr=False)
class Steady(Record):
    """Spin at a constant rate about z."""

    def values(self, functions: ModuleType, z: Any, _: Any, psi: Any) -> Values:
        """Return the values, which do not depend on z."""
        zero = 0.0 * z
        one = zero + 1.0
        return one, zero, zero, zero, zero, one, functions.tan(math.pi * psi)


@dataclass(frozen=True, slots=True, repr=False)
class Harmonics:
    """Theta functions as trigonometric series: polynomials in cos 2z, lowest power first."""

    r: float  # the number e^{-xi}
    A_cos: tuple[float, ...]  # coefficients of Re A
    A_sin: tuple[float, ...]  # coefficients of Im A / sin 2z
    B_cos: tuple[float, ...]  # coefficients of Re B
    B_sin: tuple[float, ...]  # coefficients of Im B / sin 2z
    C: tuple[float, ...]  # coefficients of C / cos z
    D: tuple[float, ...]  # coefficients of D

    def values(self, functions: ModuleType, z: Any, _: Any, psi: Any) -> Values:
        """Return the values for z in turns. They do not depend on whole turns."""
        half = functions.tan(math.pi * z)
        square = half * half
        inverse = 1.0 / (1.0 + square)
        cos, sin = (1.0 - square) * inverse, 2.0 * half * inverse
        cos2, sin2 = 1.0 - 2.0 * sin * sin, 2.0 * sin * cos
        B_re, B_im = _polynomial(self.B_cos, cos2), _polynomial(self.B_sin, cos2) * sin2
        r_cos, r_sin = self.r * cos, self.r * sin
        return (
            _polynomial(self.A_cos, cos2),
            _polynomial(self.A_sin, cos2) * sin2,
            B_re * r_cos - B_im * r_sin,
            B_re * r_sin + B_im * r_cos,
            _polynomial(self.C, cos2) * cos,
            _polynomial(self.D, cos2),
            functions.tan(math.pi * psi),
        )


@dataclass(frozen=True, slots=True, repr=False)
class Bumps:
    """Theta functions after Poisson's summation. The body stays near the middle axis and flips in between."""

    steepness: float  # |log| of the ratio of the two nearest bumps, per half turn of z
    drift: float  # half turns of psi per half turn of z
    g: float  # ratio of the next bump to a bump, at the top of the latter
    A_cos: Three  # amplitudes of the cosines of A, three terms
    A_sin: Three  # amplitudes of the sines of A, three terms
    B_cos: Three  # amplitudes of the cosines of B, three terms
    B_sin: Three  # amplitudes of the sines of B, three terms
    C: float  # value of C at z = 0, without the terms in g
    D: float  # value of D at z = 0, without the terms in g

    def values(self, functions: ModuleType, z: Any, flips: Any, psi: Any) -> Values:
        """Return the values for z in half turns from the middle of a flip, and the number of flips before."""
        side, parity = functions.copysign(1.0, z), 1.0 - 2.0 * (flips % 2.0)
        w = functions.exp(-self.steepness * abs(z))
        even, odd = 1.0 + w, side * (1.0 - w)
        A_re, A_im = self.A_cos[0] * even, self.A_sin[0] * odd
        B_re, B_im = self.B_cos[0] * even, self.B_sin[0] * odd
        g = self.g
        v = g / (w + SMALLEST)  # both vanish where the period is beyond 1e300 rad
        www, vvv = g * w**3, g * v**3
        for k, near, far in ((1, v, g * w * w), (2, g * v * v, g * g * www)):
            even, odd = near + far, side * (near - far)
            A_re, A_im = A_re + self.A_cos[k] * even, A_im + self.A_sin[k] * odd
            B_re, B_im = B_re + self.B_cos[k] * even, B_im + self.B_sin[k] * odd
        C, D = (w - v) - (www - vvv), (w + v) + (www + vvv)
        tangent = functions.tan(math.pi * (psi + self.drift * z))
        return A_re, A_im, parity * B_re, parity * B_im, (self.C * parity) * C, self.D * D, tangent


@dataclass(frozen=True, slots=True, repr=False)
class OneFlip:
    """The separatrix: the body spins about the middle axis, flips once, and spins about it the other way."""

    A: tuple[float, float]  # the two amplitudes of A
    B: tuple[float, float]  # the two amplitudes of B
    C: float  # value of C at u = 0
    D: float  # value of D at u = 0

    def values(self, functions: ModuleType, fraction: Any, whole: Any, psi: Any) -> Values:
        """Return the values for u = whole + fraction, 0 in the middle of the flip."""
        u = whole + fraction
        w = functions.exp(-abs(u))
        even, odd = 1.0 + w, functions.copysign(1.0 - w, u)
        tangent = functions.tan(math.pi * psi)
        (A_cos, A_sin), (B_cos, B_sin) = self.A, self.B
        return A_cos * even, A_sin * odd, B_cos * even, B_sin * odd, self.C * w, self.D * w, tangent


def _polynomial(coefficients: Sequence[float], x: Any) -> Any:
    value = coefficients[-1] if coefficients else 0.0
    for coefficient in coefficients[-2::-1]:
        value = value * x + coefficient
    return value
