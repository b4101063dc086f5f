"""Many torque-free rotations, set up to be asked at times: the formulas of one, over arrays and in doubles.

The constants of the rotations and of their theta functions take most of the time. Whoever asks for several
times of the same rotations sets them up once.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.numerics.arithmetic import ARRAYS, FloatArray
from contact_dynamics.tolerances import MOTIONLESS, SMALLEST
from contact_dynamics.tumbling.attitude_form import SWITCH, bumps, harmonics, zeros
from contact_dynamics.tumbling.elliptic import average_over_period, carlson_rf

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from contact_dynamics.tumbling.theta import Bumps, Harmonics


@dataclass(frozen=True, slots=True)
class Tumbles:
    """The numbers of `polhode.Tumble` for many rotations, in arrays (n,), in Jacobi's axes of each."""

    axes: NDArray[np.intp]  # (n, 3), which of the given axes is 1, 2, 3
    signs: FloatArray  # (n, 3), and whether it points along or against it
    moments: FloatArray  # (n, 3)
    L: FloatArray
    m: FloatArray
    a2: FloatArray
    c2: FloatArray
    z_rate: FloatArray  # rad/s
    z_offset: FloatArray  # rad
    quarter: FloatArray
    precession: FloatArray
    steady: FloatArray  # bool


def tumbles_of_many(given: FloatArray, w_P: FloatArray) -> Tumbles:
    """Return the constants of n rotations, from moments and angular velocities in principal axes, (n, 3)."""
    rows = np.arange(len(w_P))
    order = np.argsort(given, axis=1)
    small, middle, large = (given[rows, order[:, k]] for k in range(3))
    w_small, w_large = w_P[rows, order[:, 0]], w_P[rows, order[:, 2]]
    low, high, both = middle - small, large - middle, large - small
    from_middle = large * high * w_large**2 - small * low * w_small**2
    major = from_middle >= 0.0
    axes = np.where(major[:, None], order, order[:, ::-1])
    I1, I2, I3 = np.where(major, small, large), middle, np.where(major, large, small)
    gap21, gap32, gap31 = np.where(major, (low, high, both), (-high, -low, -both))
    w1, w2, w3 = (w_P[rows, axes[:, k]] for k in range(3))
    signs = np.ones((len(w_P), 3))
    signs[:, 0], signs[:, 2] = np.copysign(1.0, w1), np.copysign(1.0, w3)
    even = (axes[:, 1] - axes[:, 0]) % 3 == 1
    signs[:, 1] = signs[:, 0] * signs[:, 2] * np.where(even, 1.0, -1.0)
    d1 = I2 * gap21 * w2**2 + I3 * gap31 * w3**2
    d3 = I1 * gap31 * w1**2 + I2 * gap32 * w2**2
    momenta = I1 * w1, I2 * w2, I3 * w3
    squared = momenta[0] ** 2 + momenta[1] ** 2 + momenta[2] ** 2
    a2, b2, c2 = I1 * d3 / (gap31 * squared), I2 * d3 / (gap32 * squared), I3 * d1 / (gap31 * squared)
    steady = ~(a2 > MOTIONLESS) | ~(abs(gap32) * w3**2 + abs(gap21) * w1**2 > 0.0)
    # Steady rows get the numbers of some tumble, so that the iterations end.
    a2, b2, c2 = (np.where(steady, 0.5, x) for x in (a2, b2, c2))
    m = np.where(steady, 0.5, np.maximum(d3 * gap21 / (d1 * gap32), SMALLEST))
    m1 = np.where(steady, 0.5, np.maximum(from_middle * gap31 / (d1 * gap32), SMALLEST))
    L = np.sqrt(squared)
    sn = np.where(steady, 0.0, signs[:, 1] * momenta[1] / (L * np.sqrt(b2)))
    cn2 = np.where(steady, 1.0, momenta[0] ** 2 / (squared * a2))
    dn2 = np.where(steady, 1.0, np.maximum(momenta[2] ** 2 / (squared * c2), SMALLEST))
    u0 = sn * carlson_rf(cn2, dn2, np.ones_like(sn), numbers=ARRAYS)
    quarter, average = average_over_period(np.sqrt(m1), b2 / a2, 1.0 / I1, b2 / (a2 * I2), numbers=ARRAYS)
    omega_p = np.where(major, 1.0, -1.0) * np.sqrt(d1 * gap32 / (I1 * I2 * I3))
    return Tumbles(
        axes=axes,
        signs=signs,
        moments=np.column_stack((I1, I2, I3)),
        L=L,
        m=m,
        a2=a2,
        c2=c2,
        z_rate=omega_p * quarter,
        z_offset=u0 * quarter,
        quarter=quarter,
        precession=L * average,
        steady=steady,
    )


@dataclass(frozen=True, slots=True)
class Turns:
    """Rotations of n bodies from time 0 on, each about its own principal axes, as `turns_of_many` makes them.

    Attributes:
        w_P: (n, 3), rad/s, at time 0, principal axes.
        tumbles: Their constants.
        rows: Which of them have a trigonometric series, and which have bumps, (n,), bool.
        forms: The theta functions of the two kinds, or None if there are none of a kind.
        begin: (4, n), the attitudes at time 0.
    """

    w_P: FloatArray
    tumbles: Tumbles
    rows: tuple[NDArray[np.bool_], NDArray[np.bool_]]
    forms: tuple[Harmonics | None, Bumps | None]
    begin: FloatArray

    def at(self, times: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return quaternions, (n, 4), and angular velocities, (n, 3), rad/s, at times (n,), s."""
        r, w_P = self.tumbles, self.w_P
        end = _values(r, self.rows, self.forms, times)
        x0, y0, z0, w0 = self.begin
        x1, y1, z1, w1 = _attitudes(end)
        turned = np.stack(
            (
                w0 * x1 - x0 * w1 - y0 * z1 + z0 * y1,
                w0 * y1 + x0 * z1 - y0 * w1 - z0 * x1,
                w0 * z1 - x0 * y1 + y0 * x1 - z0 * w1,
            ),
            axis=1,
        )
        norm2 = end[0] ** 2 + end[1] ** 2 + end[2] ** 2 + end[3] ** 2
        momenta = np.stack((end[4], 2.0 * (end[0] * end[3] - end[1] * end[2]), end[5]))
        rates = (momenta * (r.L / norm2) / r.moments.T).T
        q, w_then = np.empty((len(w_P), 4)), np.empty((len(w_P), 3))
        np.put_along_axis(q, r.axes, r.signs * turned, axis=1)
        q[:, 3] = w0 * w1 + x0 * x1 + y0 * y1 + z0 * z1
        q /= np.sqrt(np.einsum("ij,ij->i", q, q))[:, None]
        np.put_along_axis(w_then, r.axes, r.signs * rates, axis=1)
        if r.steady.any():
            spin, half = w_P[r.steady], 0.5 * times[r.steady]
            rate = np.sqrt(np.einsum("ij,ij->i", spin, spin))
            q[r.steady, :3] = spin * (np.sin(rate * half) / np.maximum(rate, SMALLEST))[:, None]
            q[r.steady, 3] = np.cos(rate * half)
            w_then[r.steady] = spin
        return q, w_then


def turns_of_many(moments: FloatArray, w_P: FloatArray) -> Turns:
    """Return rotations from principal moments and angular velocities, (n, 3) each, in the same axes.

    Rows of steady spin divide by zero here and in `Turns.at`. Who calls these ignores it (`numpy.errstate`).
    """
    r = tumbles_of_many(moments, w_P)
    xi, eta = (zero * r.quarter for zero in zeros(r.a2, r.c2, r.m, ARRAYS))
    by_bumps = 2.0 * (xi + eta) <= SWITCH
    rows = ~by_bumps, by_bumps
    first, second = (
        (xi[some], eta[some], (np.sqrt(r.a2[some]), np.sqrt(r.c2[some]))) if some.any() else None
        for some in rows
    )
    forms = (
        None if first is None else harmonics(*first, functions=np),
        None if second is None else bumps(*second, functions=np),
    )
    begin = _attitudes(_values(r, rows, forms, np.zeros(len(w_P))))
    return Turns(w_P=w_P, tumbles=r, rows=rows, forms=forms, begin=begin)


def _values(
    r: Tumbles,
    rows: tuple[NDArray[np.bool_], NDArray[np.bool_]],
    forms: tuple[Harmonics | None, Bumps | None],
    times: FloatArray,
) -> FloatArray:
    """Return `theta.Values` as (7, n)."""
    values = np.empty((7, len(times)))
    z, psi = r.z_rate * times + r.z_offset, 0.5 * (r.precession - r.z_rate) * times / np.pi
    for some, form, unit in zip(rows, forms, (2.0 * np.pi, np.pi), strict=True):
        if form is not None:
            turns = z[some] / unit
            whole = np.rint(turns)
            each = form.values(np, turns - whole, whole, psi[some])
            for value, row in zip(values, each, strict=True):
                value[some] = row  # one number where no term of a series matters, as in symmetric bodies
    return values


def _attitudes(values: FloatArray) -> FloatArray:
    """Return quaternions (4, n) of any length, x y z w, of Jacobi's axes in L's."""
    A_re, A_im, B_re, B_im, _, _, tangent = values
    return np.stack(
        (B_im + tangent * B_re, tangent * B_im - B_re, A_im + tangent * A_re, A_re - tangent * A_im)
    )
