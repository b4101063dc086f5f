# SPDX-License-Identifier: Apache-2.0
"""Computes many free motions together, each at its own time, such as samples of an uncertain state.

The formulas are those for one motion, over arrays and in doubles. Errors of attitude grow by about 1e-16 of
the angle turned, times the sensitivity of the motion. A motion that is exactly on the separatrix is computed
as if it were 1e-300 off it.

Most of the time is spent on the constants of the rotations and of their theta functions.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.numerics.arithmetic import ARRAYS, FloatArray
from contact_dynamics.rotations.many import matrices_of, products
from contact_dynamics.tolerances import (
    MOTIONLESS,
    SMALLEST,
    SYMMETRY_TOLERANCE,
    TRIANGLE_TOLERANCE,
    UNIT_LENGTH_TOLERANCE,
)
from contact_dynamics.tumbling.attitude_form import SWITCH, bumps, harmonics, zeros
from contact_dynamics.tumbling.elliptic import average_over_period, carlson_rf
from contact_dynamics.tumbling.motion import Trajectory
from contact_dynamics.validation import check_array, check_magnitude

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

CHUNK: Final = 4096
"""Number of rotations computed at a time. Their intermediate arrays stay in the processor's cache."""

_IN_STEADY_SPIN: Final[Any] = {"divide": "ignore", "invalid": "ignore", "over": "ignore"}
"""NumPy warnings to ignore: rows of steady spin divide by zero, and are computed separately."""


def states_of_many(
    I_B: ArrayLike,
    *,
    p_WB_W: ArrayLike,
    q_WB: ArrayLike,
    v_WB_W: ArrayLike,
    w_WB_W: ArrayLike,
    seconds: ArrayLike,
    gravity_W: ArrayLike = STANDARD_GRAVITY_W,
) -> Trajectory:
    """Return the states of n bodies, each from its own initial state at its own time: row i is body i.

    Principal axes are computed in double precision. If I_B is not diagonal, rounding its entries changes the
    small moment of a needle by 1e-16 of the large one.

    Args:
        I_B: (3, 3) for all bodies, or (n, 3, 3), kg m^2, about the centre of mass, body axes.
        p_WB_W: (n, 3), m, positions of the centres of mass, world.
        q_WB: (n, 4), unit quaternions x, y, z, w, body to world.
        v_WB_W: (n, 3), m/s, velocities of the centres of mass, world axes.
        w_WB_W: (n, 3), rad/s, angular velocities, world axes.
        seconds: (n,), or one number for all bodies, s, of either sign.
        gravity_W: (3,) for all bodies, or (n, 3), m/s^2, world axes.

    Raises:
        InvalidFieldError: an array has a wrong shape, a number is not finite, a quaternion is not a unit
            quaternion, or an inertia is not symmetric and positive definite.
    """
    w = check_magnitude("w_WB_W", check_array("w_WB_W", w_WB_W, (None, 3)))
    n = len(w)
    p, v = _rows("p_WB_W", p_WB_W, n, (3,)), _rows("v_WB_W", v_WB_W, n, (3,))
    q = _unit(_rows("q_WB", q_WB, n, (4,)))
    given = check_array("I_B", I_B, (3, 3)) if np.ndim(I_B) == 2 else _rows("I_B", I_B, n, (3, 3))
    moments, R_BP = _principal(given)
    R_WP = matrices_of(q) @ R_BP
    one = np.ndim(gravity_W) == 1
    gravity = check_array("gravity_W", gravity_W, (3,)) if one else _rows("gravity_W", gravity_W, n, (3,))
    times = np.broadcast_to(_times(seconds, n), (n,))
    # The turn is in principal axes at time 0. As a rotation of the world it is R_WP turn R_WP^T.
    turn, w_P = rotations_of_many(moments, np.einsum("nij,ni->nj", R_WP, w), times)
    then = products(np.column_stack([np.einsum("nij,nj->ni", R_WP, turn[:, :3]), turn[:, 3]]), q)
    elapsed = times[:, None]
    return Trajectory(
        seconds=times.copy(),
        p_WB_W=p + elapsed * (v + (0.5 * elapsed) * gravity),
        q_WB=then,
        v_WB_W=v + elapsed * gravity,
        w_WB_W=np.einsum("nij,nj->ni", matrices_of(then) @ R_BP, w_P),
    )


def _rows(field: str, value: ArrayLike, n: int, shape: tuple[int, ...]) -> FloatArray:
    """Return finite numbers, (n, *shape). An error names the row of a number that is not finite."""
    rows = check_array(field, value, (None, *shape))
    if len(rows) != n:
        raise InvalidFieldError(field, f"{len(rows)} rows", f"{n}, one for each body")
    return rows


def _times(seconds: ArrayLike, n: int) -> FloatArray:
    rows = check_array("seconds", seconds, ()) if np.ndim(seconds) == 0 else _rows("seconds", seconds, n, ())
    return check_magnitude("seconds", rows)


def _unit(q: FloatArray) -> FloatArray:
    """Return quaternions (n, 4) scaled to norm 1, or reject those whose norm is out of tolerance."""
    norms = np.sqrt(np.einsum("ni,ni->n", q, q))
    off = np.flatnonzero(np.abs(norms - 1.0) > UNIT_LENGTH_TOLERANCE)
    if len(off):
        raise InvalidFieldError(
            f"q_WB[{off[0]}]", f"norm {norms[off[0]]:g}", f"1 within {UNIT_LENGTH_TOLERANCE:g}"
        )
    unit: FloatArray = q / norms[:, None]
    return unit


def _principal(I_B: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return moments, (3,) or (n, 3), ascending, and right-handed axes, columns of (3, 3) or (n, 3, 3)."""
    apart = np.abs(I_B - np.swapaxes(I_B, -1, -2)).max(axis=(-1, -2))
    bent = np.flatnonzero(apart > SYMMETRY_TOLERANCE * np.abs(I_B).max(axis=(-1, -2)))
    if len(bent):
        raise InvalidFieldError("I_B", I_B.reshape(-1, 3, 3)[bent[0]].tolist(), "a symmetric matrix")
    moments, axes = np.linalg.eigh(I_B)
    if moments.size and not float(moments.min()) > 0.0:
        raise InvalidFieldError("I_B", f"a principal moment of {moments.min():g}", "numbers > 0")
    above = moments[..., 2] - moments[..., 0] - moments[..., 1] > TRIANGLE_TOLERANCE * moments[..., 2]
    if above.any():
        found = moments.reshape(-1, 3)[np.atleast_1d(above).argmax()].tolist()
        raise InvalidFieldError("I_B", f"principal moments {found}", "those of a body: I1 + I2 >= I3")
    axes[..., 2] *= np.linalg.det(axes)[..., None]
    return moments, axes


def rotations_of_many(
    moments: ArrayLike, w_P: ArrayLike, seconds: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Return the rotations of bodies: quaternions (n, 4), and angular velocities (n, 3), rad/s.

    All are in each body's principal axes P: the quaternion, x y z w, transforms P at that time into P at time
    0.

    Args:
        moments: (3,) for all bodies, or (n, 3), kg m^2, principal moments in any order.
        w_P: (n, 3), rad/s, angular velocities at time 0, in right-handed principal axes in that order.
        seconds: (n,), or one number for all bodies, s.

    Raises:
        InvalidFieldError: an array has a wrong shape, a number is not finite, or a moment is not > 0.
    """
    w, given = _checked(moments, w_P)
    n = len(w)
    times = np.broadcast_to(_times(seconds, n), (n,))
    q, w_then = np.empty((n, 4)), np.empty((n, 3))
    with np.errstate(**_IN_STEADY_SPIN):  # set after
        for start in range(0, n, CHUNK):
            part = slice(start, start + CHUNK)
            q[part], w_then[part] = _turned(given[part], w[part], times[part])
    return q, w_then


def flips_of_many(moments: ArrayLike, w_P: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return the time, s, (n,), of one flip of each body, and the times between flips, (n,).

    Every zero of the component along the middle axis counts as a flip, in any regime. Steady spin has no
    flips, and its times are NaN. Arguments and errors are those of `rotations_of_many`.
    """
    w, given = _checked(moments, w_P)
    with np.errstate(**_IN_STEADY_SPIN):
        r = tumbles_of_many(given, w)
        rate = np.where(r.steady, np.nan, r.z_rate)
        return -r.z_offset / rate, np.divide(np.pi, np.abs(rate))


def _checked(moments: ArrayLike, w_P: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return the angular velocities and the moments, (n, 3) each."""
    w = check_magnitude("w_P", check_array("w_P", w_P, (None, 3)))
    given = check_array("moments", moments, (3,) if np.ndim(moments) == 1 else (len(w), 3))
    if not (given > 0.0).all():
        raise InvalidFieldError("moments", float(given.min()), "numbers > 0")
    return w, np.broadcast_to(given, w.shape)


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


def _turned(moments: FloatArray, w_P: FloatArray, times: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return `rotations_of_many`, for (n, 3), (n, 3) and (n,). Rows of steady spin divide by zero."""
    r = tumbles_of_many(moments, w_P)
    xi, eta = (zero * r.quarter for zero in zeros(r.a2, r.c2, r.m, ARRAYS))
    by_bumps = 2.0 * (xi + eta) <= SWITCH
    begin, end = np.empty((2, 7, len(w_P)))
    for some, unit, form_of in ((~by_bumps, 2.0 * np.pi, harmonics), (by_bumps, np.pi, bumps)):
        if some.any():
            peaks = np.sqrt(r.a2[some]), np.sqrt(r.c2[some])
            form = form_of(xi[some], eta[some], peaks, functions=np)
            for values, seconds in ((begin, np.zeros(len(w_P))), (end, times)):
                turns = (r.z_rate * seconds + r.z_offset)[some] / unit
                whole, psi = np.rint(turns), 0.5 * (r.precession - r.z_rate) * seconds / np.pi
                each = form.values(np, turns - whole, whole, psi[some])
                for value, row in zip(values, each, strict=True):
                    value[some] = row  # one number where no term of a series matters, as in symmetric bodies
    x0, y0, z0, w0 = _attitudes(begin)
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


def _attitudes(values: FloatArray) -> FloatArray:
    """Return quaternions (4, n) of any length, x y z w, of Jacobi's axes in L's."""
    A_re, A_im, B_re, B_im, _, _, tangent = values
    return np.stack(
        (B_im + tangent * B_re, tangent * B_im - B_re, A_im + tangent * A_re, A_re - tangent * A_im)
    )
